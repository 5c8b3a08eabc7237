/* SPDX-License-Identifier: BSD-3-Clause */
/* Light of a diffuse screen beside the corner (Fig. 2.3b): dense T of low rank. Each patch of the screen emits one joule. */
#include "render/corner_impl.h"
#include "render/form_factor.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

/* Extent of screen patch n: {y lower, upper}, {z lower, upper}. Row 0 is the top. */
static void screen_extent(const optla_screen_desc *s, size_t n, double y[2], double z[2])
{
	const double dz = (s->z_m[1] - s->z_m[0]) / (double)s->width, dy = (s->y_m[1] - s->y_m[0]) / (double)s->height;
	z[0] = s->z_m[0] + (double)(n % s->width) * dz;
	z[1] = z[0] + dz;
	y[1] = s->y_m[1] - (double)(n / s->width) * dy;
	y[0] = y[1] - dy;
}

static double screen_area(const optla_screen_desc *s)
{
	return (s->z_m[1] - s->z_m[0]) * (s->y_m[1] - s->y_m[0]) / (double)(s->width * s->height);
}

/* Exchange area between a screen patch and a wall patch. The screen is parallel to 'left' and perpendicular to the others. */
static double screen_exchange(double screen_x, const double y[2], const double z[2], int wall, const double extent[2][2])
{
	if (wall == OPTLA_WALL_LEFT) return optla_exchange_parallel_(y, z, extent[0], extent[1], screen_x);
	const double away[2] = {screen_x - extent[0][1], screen_x - extent[0][0]}; /* of the wall patch from the common line */
	return wall == OPTLA_WALL_FLOOR ? optla_exchange_perpendicular_(y, z, away, extent[1])
	                                : optla_exchange_perpendicular_(z, y, away, extent[1]);
}

void optla_screen_flux_(optla_ctx *ctx, const optla_corner *c, double *flux)
{
	const optla_screen_desc *s = &c->desc->screen;
	const size_t nlights = s->width * s->height, np = c->npatches;
	const double area = screen_area(s);
	const int threads = optla_ctx_threads(ctx);
#pragma omp parallel for num_threads(threads) schedule(static)
	for (size_t n = 0; n < nlights; n++) {
		double y[2], z[2], extent[2][2];
		screen_extent(s, n, y, z);
		for (size_t a = 0; a < np; a++) {
			const int wall = optla_patch_extent_(c, a, extent);
			flux[n * np + a] = screen_exchange(s->x_m, y, z, wall, (const double(*)[2])extent) / area;
		}
	}
}

/* Form factor from a wall point to the screen up to (y, z): sums over a patch's corners with alternating signs give the patch's. */
static double corner_factor(double screen_x, const double point[3], int wall, double y, double z)
{
	const double c = screen_x - point[0];
	if (wall == OPTLA_WALL_LEFT) return optla_point_parallel_(y - point[1], z - point[2], c);
	return wall == OPTLA_WALL_FLOOR ? optla_point_perpendicular_(y, z - point[2], c)
	                                : optla_point_perpendicular_(z, y - point[1], c);
}

/* Adds factor * irradiance of every patch at one point to the row of pixel m. grid: (width + 1) x (height + 1) scratch. */
static void add_point(const optla_corner *c, int wall, const double point[3], double factor, double *grid, double *row)
{
	const optla_screen_desc *s = &c->desc->screen;
	const size_t w = s->width, h = s->height;
	const double dz = (s->z_m[1] - s->z_m[0]) / (double)w, dy = (s->y_m[1] - s->y_m[0]) / (double)h, area = screen_area(s);
	for (size_t j = 0; j <= h; j++)
		for (size_t i = 0; i <= w; i++)
			grid[j * (w + 1) + i] = corner_factor(s->x_m, point, wall, s->y_m[1] - (double)j * dy, s->z_m[0] + (double)i * dz);
	for (size_t j = 0; j < h; j++)
		for (size_t i = 0; i < w; i++) {
			const double *a = grid + j * (w + 1) + i; /* y falls with j */
			const double f = a[1] - a[0] - a[w + 2] + a[w + 1];
			row[j * w + i] += factor * f / area;
		}
}

/* All patches' direct light in pixel m, before albedo: row holds nlights sums. */
static void pixel_direct(const optla_corner *c, int wall, size_t m, double *grid, double *row)
{
	static const double whole[2][2] = {{0, 1}, {0, 1}};
	const double x = (double)(m % c->camera.width), y = (double)(m / c->camera.width);
	const double lower[2] = {x - 0.5, y - 0.5}, upper[2] = {x + 0.5, y + 0.5};
	const optla_polygon square = optla_wall_seen_(&c->camera, wall, whole);
	const optla_polygon piece = optla_polygon_clip_(&square, lower, upper);
	if (piece.n < 3) return;
	optla_node nodes[OPTLA_NODES_MAX];
	const int count = optla_polygon_nodes_(&piece, nodes);
	for (int k = 0; k < count; k++) {
		double point[3];
		optla_wall_hit_(&c->camera, wall, nodes[k].uv, point);
		add_point(c, wall, point, nodes[k].weight * optla_pupil_weight_(&c->camera, nodes[k].uv), grid, row);
	}
}

optla_status optla_screen_direct_(optla_ctx *ctx, const optla_corner *c, double *t)
{
	const optla_screen_desc *s = &c->desc->screen;
	const size_t nlights = s->width * s->height, npixels = c->camera.width * c->camera.height;
	const size_t grid = (s->width + 1) * (s->height + 1), scratch = grid + nlights, blocks = 64;
	double *all = optla_array_(ctx, blocks, scratch * sizeof *all);
	if (!all) return OPTLA_ERR_NOMEM;
	const int threads = optla_ctx_threads(ctx);
#pragma omp parallel for num_threads(threads) schedule(dynamic)
	for (size_t b = 0; b < blocks; b++) {
		double *row = all + b * scratch + grid;
		for (size_t m = b * npixels / blocks; m < (b + 1) * npixels / blocks; m++)
			for (int k = 0; k < c->nwalls; k++) {
				memset(row, 0, nlights * sizeof *row);
				pixel_direct(c, c->walls[k], m, all + b * scratch, row);
				for (size_t i = 0; i < 3; i++) {
					const double factor = c->pupil_m2 * c->desc->albedo[c->walls[k]][i] / PI;
					for (size_t n = 0; n < nlights; n++) t[n * 3 * npixels + i * npixels + m] += factor * row[n];
				}
			}
	}
	optla_free(ctx, all);
	return optla_check_cancel_(ctx);
}

/* Keeps the part of a polygon in camera coordinates where plane · point >= 0. */
static int clip_plane(double (*p)[3], int n, const double plane[3])
{
	double out[OPTLA_POLYGON_MAX][3];
	int kept = 0;
	for (int k = 0; k < n; k++) {
		const double *a = p[k], *b = p[(k + 1) % n];
		const double da = a[0] * plane[0] + a[1] * plane[1] + a[2] * plane[2],
		             db = b[0] * plane[0] + b[1] * plane[1] + b[2] * plane[2];
		if (da >= 0) memcpy(out[kept++], a, sizeof out[0]);
		if ((da >= 0) != (db >= 0)) {
			for (int i = 0; i < 3; i++) out[kept][i] = a[i] + da / (da - db) * (b[i] - a[i]);
			kept++;
		}
	}
	memcpy(p, out, (size_t)kept * sizeof out[0]);
	return kept;
}

optla_status optla_screen_check_hidden_(optla_ctx *ctx, const optla_corner *c)
{
	const optla_screen_desc *s = &c->desc->screen;
	const optla_pinhole *p = &c->camera;
	static const int order[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
	double polygon[OPTLA_POLYGON_MAX][3];
	for (int k = 0; k < 4; k++) {
		const double d[3] = {s->x_m - p->position_m[0], s->y_m[order[k][0]] - p->position_m[1],
		                     s->z_m[order[k][1]] - p->position_m[2]};
		for (int i = 0; i < 3; i++) polygon[k][i] = d[0] * p->axis[i][0] + d[1] * p->axis[i][1] + d[2] * p->axis[i][2];
	}
	const double x = 0.5 * (double)p->width / p->focal_px, y = 0.5 * (double)p->height / p->focal_px;
	const double sides[4][3] = {{1, 0, x}, {-1, 0, x}, {0, 1, y}, {0, -1, y}};
	int n = 4;
	for (int k = 0; k < 4 && n; k++) n = clip_plane(polygon, n, sides[k]);
	OPTLA_CHECK(ctx, n < 3, OPTLA_ERR_INPUT,
	            "%sthe camera sees the screen itself: turn it to the left, or make its field_of_view (%g degrees) smaller",
	            c->desc->where ? c->desc->where : "", c->desc->camera.field_of_view_deg);
	return OPTLA_OK;
}
