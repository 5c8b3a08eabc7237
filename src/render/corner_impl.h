/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files of the corner share: walls, patches, and pixels cut into points on walls. */
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
double optla_patch_area_(const optla_corner *c);
/* The rectangle of a wall with these extents as seen by a pinhole. */
optla_polygon optla_wall_seen_(const optla_pinhole *p, int wall, const double extent[2][2]);
/* Where the ray through uv meets the plane of the wall. */
void optla_wall_hit_(const optla_pinhole *p, int wall, const double uv[2], double world_m[3]);
/* Exchange areas A F of all pairs of patches, npatches x npatches. */
void optla_corner_exchange_(optla_ctx *ctx, const optla_corner *c, double *exchange_m2);

/* cos⁴α / f²: solid angle of a pixel's piece times the cosine at the pupil, per pixel². user: optla_pinhole. */
double optla_pupil_weight_(const void *pinhole, const double uv[2]);

enum { OPTLA_FINE = 4 }; /* fine points along a side of a pixel */

typedef struct {
	double x[3], weight; /* weight: ∫ cos⁴α / f² over its part of the image */
} optla_point;

/* The part of one pixel on one wall: as one point at its centre, and as up to OPTLA_FINE² of smaller parts. */
typedef struct {
	optla_point whole;
	double radius_m, area_m2, corner[8][3]; /* its outline on the wall */
	int ncorners, wall;
	size_t pixel, first; /* fine points first .. next piece's first - 1 */
} optla_piece;

typedef struct {
	optla_piece *pieces; /* by pixel; one more than npieces, for its 'first' */
	optla_point *fine;
	size_t npieces, nfine, *start; /* pieces of pixel p: start[p] .. start[p + 1] - 1 */
} optla_pieces;

/* pieces is freed by the caller, on failure as well. */
optla_status optla_pieces_cut_(optla_ctx *ctx, const optla_corner *c, const optla_pinhole *p, optla_pieces *pieces);
void optla_pieces_free_(optla_ctx *ctx, optla_pieces *pieces);

/* Sum of weight * weight' * cosθ cosθ' / (π r²) over two pieces of different walls; symmetric. */
double optla_pieces_exchange_(const optla_pieces *a, const optla_piece *p, const optla_pieces *b, const optla_piece *q);

/* Irradiance at a pixel's pieces for exitance 1 of each patch, times albedo of the channel, weight and scale: npatches x npixels.
   Read the other way it is the light that a pixel's pieces scatter to each patch. */
void optla_corner_gather_(optla_ctx *ctx, const optla_corner *c, const optla_pieces *pieces, size_t npixels, size_t channel,
                          double scale, double *gather);
/* Energy that each screen patch sends to each wall patch, npatches x nlights. */
void optla_screen_flux_(optla_ctx *ctx, const optla_corner *c, double *flux);

/* Light of a projector that two walls scatter in turn, added to t. */
optla_status optla_corner_bounce_(optla_ctx *ctx, const optla_corner *c, const optla_pieces *camera,
                                  const optla_pieces *projector, double *t);

/* Direct light, added to t (layout of optla_corner_matrix_). */
optla_status optla_projector_direct_(optla_ctx *ctx, const optla_corner *c, double *t);
optla_status optla_screen_direct_(optla_ctx *ctx, const optla_corner *c, double *t);
/* OPTLA_ERR_INPUT when the camera sees the screen itself, whose light this model leaves out. */
optla_status optla_screen_check_hidden_(optla_ctx *ctx, const optla_corner *c);

#endif
