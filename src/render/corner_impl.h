/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files of the corner share: walls, patches, and sparse lists of which pixel meets which patch. */
#ifndef OPTLA_CORNER_IMPL_H
#define OPTLA_CORNER_IMPL_H

#include "render/corner.h"
#include "render/pinhole.h"

/* Normal axis of each wall and the two axes of its square. */
extern const int optla_wall_normal_[OPTLA_WALLS];
extern const int optla_wall_axes_[OPTLA_WALLS][2];

typedef struct {
	const optla_corner_desc *desc;
	optla_pinhole camera, projector;
	int walls[OPTLA_WALLS], nwalls; /* those there are */
	size_t patches, npatches;       /* per side, in all */
	double pupil_m2;
	double full_power; /* L0 A_p: projector pixel n emits full_power ∫ cos⁴α / f² du, at most 1 */
} optla_corner;

void optla_corner_init_(const optla_corner_desc *desc, optla_corner *corner);
/* Extent {lower, upper} of patch k along its wall's two axes; returns its wall. */
int optla_patch_extent_(const optla_corner *c, size_t patch, double extent[2][2]);
/* The rectangle of a wall with these extents as seen by a pinhole. */
optla_polygon optla_wall_seen_(const optla_pinhole *p, int wall, const double extent[2][2]);
/* Where the ray through uv meets the plane of the wall. */
void optla_wall_hit_(const optla_pinhole *p, int wall, const double uv[2], double world_m[3]);
/* Exchange areas A F of all pairs of patches, npatches x npatches. */
optla_status optla_corner_exchange_(optla_ctx *ctx, const optla_corner *c, double *exchange_m2);

/* cos⁴α / f²: solid angle of a pixel's piece times the cosine at the pupil, per pixel². user: optla_pinhole. */
double optla_pupil_weight_(const void *pinhole, const double uv[2]);

/* A sparse matrix patches x pixels, made of triplets, read by columns. */
typedef struct {
	size_t count, capacity;
	uint32_t *pixel, *patch; /* pixel: until finished */
	double *weight;
	size_t *start; /* npixels + 1 */
} optla_gather;

optla_status optla_gather_add_(optla_ctx *ctx, optla_gather *g, size_t pixel, size_t patch, double weight);
/* Sorts by pixel, keeping the order within. */
optla_status optla_gather_finish_(optla_ctx *ctx, optla_gather *g, size_t npixels);
void optla_gather_free_(optla_ctx *ctx, optla_gather *g);

/* Sum of scale * cos⁴α / f² over pixel ∩ patch. */
optla_status optla_corner_view_(optla_ctx *ctx, const optla_corner *c, const optla_pinhole *p, double scale, optla_gather *g);
/* Energy that each screen patch sends to each wall patch. */
optla_status optla_screen_flux_(optla_ctx *ctx, const optla_corner *c, optla_gather *g);

/* Direct light, added to t (layout of optla_corner_matrix_). */
optla_status optla_projector_direct_(optla_ctx *ctx, const optla_corner *c, double *t);
optla_status optla_screen_direct_(optla_ctx *ctx, const optla_corner *c, double *t);
/* OPTLA_ERR_INPUT when the camera sees the screen itself, whose light this model leaves out. */
optla_status optla_screen_check_hidden_(optla_ctx *ctx, const optla_corner *c);

#endif
