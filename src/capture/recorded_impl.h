/* SPDX-License-Identifier: BSD-3-Clause */
/* Making T of a recording, in steps: frames, pixels, photos, illuminations, lights. */
#ifndef OPTLA_RECORDED_IMPL_H
#define OPTLA_RECORDED_IMPL_H

#include "capture/rig_open.h"

typedef struct {
	optla_ctx *ctx;
	const optla_manifest *m;
	char *root;                     /* folder that file names start from */
	size_t width, height, channels; /* of the photos as read; alpha is no channel */
	size_t crop[4];                 /* x, y, width, height */
	optla_image_kind kind;          /* of the photos */
	double file_white_dn;           /* as their files say */
	double scale_dn;                /* count that the file's white is: samples are divided by it before the response */
	double saturation_dn;           /* samples from here on count as saturated */
	double *dark; /* linear value of black of each sample of the crop, channel-major; NULL: black_linear for all */
	double black_linear, white_linear; /* their difference is 1 in T */
	size_t saturated, worst_count, worst_photo;
	optla_rig *rig;
	float *y; /* linearised photos: (channels * npixels) x nphotos */
} optla_recorded;

/* Path of a file that the manifest names; NULL when memory ran out. */
char *optla_recorded_path_(const optla_recorded *r, const char *name);
/* OPTLA_ERR_INPUT that names up to five of the photos that aren't there. */
optla_status optla_recorded_check_files_(const optla_recorded *r);

/* Linear value of a count: response curve, not yet minus black. */
double optla_recorded_linear_(const optla_recorded *r, double dn);

/* First photo: size, levels; then mask, dark frames. Sets the rig's camera. */
optla_status optla_recorded_frame_(optla_recorded *r);
/* All photos into y. */
optla_status optla_recorded_photos_(optla_recorded *r);
/* T = Y X⁺ into the rig's transport. */
optla_status optla_recorded_solve_(optla_recorded *r);
/* Directions, grid. */
optla_status optla_recorded_lights_(optla_recorded *r);

/* Reads count photos; each must have the recording's size. node k names it in messages. */
optla_status optla_recorded_load_(const optla_recorded *r, const char *const *names, const optla_yaml_node *nodes, size_t count,
                                  optla_image **images);
/* Counts of sample c of pixel index (of the crop) in an image as read. */
double optla_recorded_dn_(const optla_recorded *r, const optla_image *image, size_t pixel, size_t c);

#endif
