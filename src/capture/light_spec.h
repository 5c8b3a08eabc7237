/* SPDX-License-Identifier: BSD-3-Clause */
/* Illumination vectors from a description on the command line: one parser for rigs and models. */
#ifndef OPTLA_LIGHT_SPEC_H
#define OPTLA_LIGHT_SPEC_H

#include "base/base_impl.h"
#include "optla/image.h"

/* What a description can refer to. */
typedef struct {
	size_t nlights;
	size_t grid_width, grid_height; /* 0: the lights aren't on a grid */
	const double *direction;        /* nlights x 3 unit vectors, camera frame; NULL: not known */
} optla_light_layout;

/* p: nlights numbers >= 0 for each channel, channel-major; channels 1 or 3. The forms are those of optla_rig_light_vector(). */
optla_status optla_light_spec_(optla_ctx *ctx, const optla_light_layout *lights, const char *spec, size_t channels, double *p);

/* The parts below serve optla_light_spec_() and tests. */

/* An image with values as fractions of full power: display values decoded, raw counts divided by the white count. In place. */
optla_status optla_light_linear_(optla_image *image, const char *path);
/* Latitude-longitude environment to lights, see light_sphere.c for the convention. */
optla_status optla_light_environment_(optla_ctx *ctx, const optla_light_layout *lights, const optla_image *environment,
                                      const char *path, size_t channels, double *p);
/* The three lights nearest to a direction, by inverse angle, weights summing to 1; p is one channel of nlights. */
optla_status optla_light_point_(optla_ctx *ctx, const optla_light_layout *lights, double azimuth_deg, double elevation_deg,
                                double *p);
/* The same for a unit vector. exclude: this light doesn't count (its number, or nlights for none). */
optla_status optla_light_toward_(optla_ctx *ctx, const optla_light_layout *lights, const double toward[3], size_t exclude,
                                 double *p);
/* Twice the median angle between a light and its nearest neighbour: directions farther than this from every light are taken as
   not covered by the rig. pi for fewer than two lights. OPTLA_ERR_NOMEM. */
optla_status optla_light_reach_(optla_ctx *ctx, const optla_light_layout *lights, double *reach_rad);

#endif
