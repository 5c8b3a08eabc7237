/* SPDX-License-Identifier: BSD-3-Clause */
/* What the verbs that take photos with a rig share: sensor, operator, pictures and illuminations as files. */
#ifndef OPTLA_RIG_RUN_H
#define OPTLA_RIG_RUN_H

#include "cli.h"

#include "optla/image.h"
#include "optla/op.h"
#include "optla/rig.h"

/* How photos are taken: the rig operator's options and the name of the sensor. */
typedef struct {
	size_t size;
	const char *sensor; /* NULL: the rig's own, if its file names one; "none": noiseless */
} cli_sensor_options;
extern const optla_option_table cli_sensor_table;
extern const cli_topic cli_sensor_topic;

/* Field of pictures that are written for looking at. */
typedef struct {
	size_t size;
	double brightness; /* 0: automatic */
} cli_picture_options;
extern const optla_option_table cli_picture_table;

/* Without --sensor: the one that the rig file names. */
void cli_default_sensor(const optla_rig_info *info, cli_sensor_options *sensor);
/* Puts the sensor of that name and the run's seed into options. stream: operators of one run draw their own noise. */
optla_status cli_take_sensor(const cli_run *run, const cli_sensor_options *sensor, uint64_t stream,
                             optla_rig_operator_options *options);
const char *cli_channel_name(optla_channel channel);

/* Writes a LINEAR image: as it is to .exr, .tif, .pfm, .npy; for .png brought to display brightness. */
optla_status cli_save_picture(const cli_run *run, const optla_image *image, const cli_picture_options *options, const char *path);
/* OPTLA_ERR_ARG before the work when the name has an ending that no picture (or illumination) can be written to. */
optla_status cli_check_picture(const cli_run *run, const char *path);
optla_status cli_check_lights(const cli_run *run, const char *path);
/* The same when the lights aren't on a grid and the name is that of a picture. */
optla_status cli_check_grid(const cli_run *run, size_t light_width, const char *path);
/* OPTLA_ERR_UNSUPPORTED when the rig can't answer Tᵀ, which that method needs. */
optla_status cli_check_transpose(const cli_run *run, const optla_rig_info *info, const char *method);
/* The default number of iterations, or that of all lights where there are fewer. */
int cli_iterations(const optla_rig_info *info, int iterations);

/* Lights of a rig or model: n lights, on a grid of width x height if width isn't 0. */
typedef struct {
	size_t n, width, height;
} cli_lights;

/* values: n per channel, channel-major. .csv: a line for each light; .npy: n x channels; else a picture on the grid. */
optla_status cli_save_lights(const cli_run *run, const cli_lights *lights, const double *values, size_t channels,
                             const cli_picture_options *options, const char *path);
/* 3 when the spec names a colour image and the camera has colours, else 1. */
optla_status cli_light_channels(const cli_run *run, const char *spec, size_t camera_channels, size_t *channels);

/* Numbers of what the photos have cost. */
void cli_cost(cli_run *run, uint64_t photos, double exposure_s);

#endif
