/* SPDX-License-Identifier: BSD-3-Clause */
/* A pinhole camera or projector in the world, and convex polygons on its image plane. Camera frame: x right, y down, z forward;
   pixel (x, y) covers x ± ½, y ± ½. */
#ifndef OPTLA_PINHOLE_H
#define OPTLA_PINHOLE_H

#include "base/base_impl.h"
#include "scene/corner_desc.h"

typedef struct {
	double position_m[3];
	double axis[3][3]; /* right, down, forward: unit vectors in the world */
	double focal_px, centre_px[2];
	size_t width, height;
} optla_pinhole;

/* desc has been checked. */
void optla_pinhole_init_(const optla_pinhole_desc *desc, optla_pinhole *pinhole);
/* Image position of a world point; *depth_m is its distance along the optical axis (<= 0: behind, uv is meaningless). */
void optla_pinhole_project_(const optla_pinhole *p, const double world_m[3], double uv[2], double *depth_m);
/* Direction in the world of the ray through uv, scaled to depth 1 (its length is 1/cos α). */
void optla_pinhole_ray_(const optla_pinhole *p, const double uv[2], double direction[3]);
/* cos α of the ray through uv with the optical axis. */
double optla_pinhole_cosine_(const optla_pinhole *p, const double uv[2]);

/* ---- convex polygons ---- */

enum { OPTLA_POLYGON_MAX = 16 };
typedef struct {
	double p[OPTLA_POLYGON_MAX][2];
	int n;
} optla_polygon;

/* The part inside [lower, upper] (both coordinates). At most four corners more. */
optla_polygon optla_polygon_clip_(const optla_polygon *polygon, const double lower[2], const double upper[2]);
double optla_polygon_area_(const optla_polygon *polygon);

typedef struct {
	double uv[2], weight;
} optla_node;
enum { OPTLA_NODES_MAX = 7 * (OPTLA_POLYGON_MAX - 2) };
/* Quadrature over the polygon, exact for polynomials up to degree 5 on each triangle of its fan. Returns the number of nodes. */
int optla_polygon_nodes_(const optla_polygon *polygon, optla_node nodes[OPTLA_NODES_MAX]);

typedef double (*optla_integrand)(const void *user, const double uv[2]);
double optla_polygon_integrate_(const optla_polygon *polygon, optla_integrand f, const void *user);

typedef optla_status (*optla_pixel_sink)(void *user, size_t pixel, double value);
/* Cuts a polygon of image coordinates along the pixel borders and gives the integral over each piece to the sink. */
optla_status optla_pinhole_scan_(const optla_pinhole *p, const optla_polygon *polygon, optla_integrand f, const void *f_user,
                                 optla_pixel_sink sink, void *sink_user);

#endif
