/* SPDX-License-Identifier: BSD-3-Clause */
/* Direct light of a projector: footprints of its pixels, cut along the camera's pixel borders on the camera's image plane. */
#include "render/corner_impl.h"

#include <math.h>

#define PI 3.14159265358979323846

typedef struct {
	const optla_corner *corner;
	int wall;
} wall_view;

/* Irradiance at the point seen through uv times the camera's cos⁴α_c / f_c². */
static double seen_irradiance(const void *user, const double uv[2])
{
	const wall_view *v = user;
	const optla_pinhole *p = &v->corner->projector;
	double x[3], d[3], r2 = 0, axial = 0;
	optla_wall_hit_(&v->corner->camera, v->wall, uv, x);
	for (int k = 0; k < 3; k++) {
		d[k] = x[k] - p->position_m[k];
		r2 += d[k] * d[k];
		axial += d[k] * p->axis[2][k];
	}
	const double cos_surface = fabs(d[optla_wall_normal_[v->wall]]) / sqrt(r2), cos_projector = axial / sqrt(r2);
	return v->corner->full_power * cos_projector * cos_surface / r2 * optla_pupil_weight_(&v->corner->camera, uv);
}

typedef struct {
	double *column; /* of t */
	size_t npixels;
	double factor[3]; /* A_c ρ / π */
} direct_sink;

static optla_status add_direct(void *user, size_t pixel, double value)
{
	const direct_sink *s = user;
	for (size_t c = 0; c < 3; c++) s->column[c * s->npixels + pixel] += s->factor[c] * value;
	return OPTLA_OK;
}

/* What projector pixel (x, y) lights of a wall, on the camera's image plane. */
static optla_polygon footprint(const optla_corner *c, int wall, size_t x, size_t y)
{
	static const double whole[2][2] = {{0, 1}, {0, 1}};
	const double lower[2] = {(double)x - 0.5, (double)y - 0.5}, upper[2] = {(double)x + 0.5, (double)y + 0.5};
	const optla_polygon square = optla_wall_seen_(&c->projector, wall, whole);
	optla_polygon g = optla_polygon_clip_(&square, lower, upper);
	for (int k = 0; k < g.n; k++) {
		double point[3], depth;
		optla_wall_hit_(&c->projector, wall, g.p[k], point);
		optla_pinhole_project_(&c->camera, point, g.p[k], &depth);
	}
	return g;
}

optla_status optla_projector_direct_(optla_ctx *ctx, const optla_corner *c, double *t)
{
	const size_t width = c->projector.width, nlights = width * c->projector.height, npixels = c->camera.width * c->camera.height;
	const int threads = optla_ctx_threads(ctx);
#pragma omp parallel for num_threads(threads) schedule(static)
	for (size_t n = 0; n < nlights; n++)
		for (int k = 0; k < c->nwalls; k++) {
			const int wall = c->walls[k];
			const wall_view view = {c, wall};
			direct_sink sink = {.column = t + n * 3 * npixels, .npixels = npixels};
			for (int i = 0; i < 3; i++) sink.factor[i] = c->pupil_m2 * c->desc->albedo[wall][i] / PI;
			const optla_polygon g = footprint(c, wall, n % width, n / width);
			if (g.n >= 3) (void)optla_pinhole_scan_(&c->camera, &g, seen_irradiance, &view, add_direct, &sink); /* can't fail */
		}
	return optla_check_cancel_(ctx);
}
