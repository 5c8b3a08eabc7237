/* SPDX-License-Identifier: BSD-3-Clause */
#include "render/pinhole.h"

#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double c[3])
{
	c[0] = a[1] * b[2] - a[2] * b[1];
	c[1] = a[2] * b[0] - a[0] * b[2];
	c[2] = a[0] * b[1] - a[1] * b[0];
}

static void normalise(double a[3])
{
	const double n = sqrt(dot(a, a));
	for (int k = 0; k < 3; k++) a[k] /= n;
}

void optla_pinhole_init_(const optla_pinhole_desc *d, optla_pinhole *p)
{
	double(*axis)[3] = p->axis;
	for (int k = 0; k < 3; k++) {
		p->position_m[k] = d->position_m[k];
		axis[2][k] = d->look_at_m[k] - d->position_m[k];
	}
	normalise(axis[2]);
	cross(axis[2], d->up, axis[0]);
	normalise(axis[0]);
	cross(axis[2], axis[0], axis[1]);
	p->width = d->width;
	p->height = d->height;
	p->focal_px = 0.5 * (double)d->width / tan(d->field_of_view_deg * 3.14159265358979323846 / 360);
	p->centre_px[0] = ((double)d->width - 1) / 2;
	p->centre_px[1] = ((double)d->height - 1) / 2;
}

void optla_pinhole_project_(const optla_pinhole *p, const double world_m[3], double uv[2], double *depth_m)
{
	double d[3];
	for (int k = 0; k < 3; k++) d[k] = world_m[k] - p->position_m[k];
	*depth_m = dot(d, p->axis[2]);
	for (int k = 0; k < 2; k++) uv[k] = p->centre_px[k] + p->focal_px * dot(d, p->axis[k]) / *depth_m;
}

void optla_pinhole_ray_(const optla_pinhole *p, const double uv[2], double direction[3])
{
	const double x = (uv[0] - p->centre_px[0]) / p->focal_px, y = (uv[1] - p->centre_px[1]) / p->focal_px;
	for (int k = 0; k < 3; k++) direction[k] = x * p->axis[0][k] + y * p->axis[1][k] + p->axis[2][k];
}

double optla_pinhole_cosine_(const optla_pinhole *p, const double uv[2])
{
	const double x = (uv[0] - p->centre_px[0]) / p->focal_px, y = (uv[1] - p->centre_px[1]) / p->focal_px;
	return 1 / sqrt(1 + x * x + y * y);
}

/* One step of I. E. Sutherland, G. W. Hodgman, Reentrant polygon clipping, CACM 17 (1974): keeps sign*(p[axis] - at) >= 0. */
static void clip_half(optla_polygon *g, int axis, double at, double sign)
{
	optla_polygon r = {.n = 0};
	for (int k = 0; k < g->n; k++) {
		const double *a = g->p[k], *b = g->p[(k + 1) % g->n];
		const double da = sign * (a[axis] - at), db = sign * (b[axis] - at);
		if (da >= 0 && r.n < OPTLA_POLYGON_MAX) memcpy(r.p[r.n++], a, sizeof r.p[0]);
		if ((da >= 0) != (db >= 0) && r.n < OPTLA_POLYGON_MAX) {
			const double t = da / (da - db);
			r.p[r.n][axis] = at;
			r.p[r.n++][1 - axis] = a[1 - axis] + t * (b[1 - axis] - a[1 - axis]);
		}
	}
	*g = r;
}

optla_polygon optla_polygon_clip_(const optla_polygon *polygon, const double lower[2], const double upper[2])
{
	optla_polygon g = *polygon;
	for (int axis = 0; axis < 2; axis++) {
		clip_half(&g, axis, lower[axis], 1);
		clip_half(&g, axis, upper[axis], -1);
	}
	return g;
}

static double triangle_area(const double a[2], const double b[2], const double c[2])
{
	return 0.5 * fabs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

double optla_polygon_area_(const optla_polygon *g)
{
	double sum = 0;
	for (int k = 2; k < g->n; k++) sum += triangle_area(g->p[0], g->p[k - 1], g->p[k]);
	return sum;
}

/* Seven points, degree 5: J. Radon, Zur mechanischen Kubatur, Monatshefte für Mathematik 52 (1948). */
static void triangle_nodes(const double *const corner[3], optla_node nodes[7])
{
	const double root = sqrt(15), area = triangle_area(corner[0], corner[1], corner[2]);
	const double t[2] = {(6 - root) / 21, (6 + root) / 21}, weight[2] = {(155 - root) / 1200, (155 + root) / 1200};
	double sum[2];
	for (int i = 0; i < 2; i++) {
		sum[i] = corner[0][i] + corner[1][i] + corner[2][i];
		nodes[6].uv[i] = sum[i] / 3;
	}
	nodes[6].weight = area * 9 / 40;
	for (int k = 0; k < 6; k++) { /* barycentric t, t, 1 - 2 t */
		for (int i = 0; i < 2; i++) nodes[k].uv[i] = t[k / 3] * sum[i] + (1 - 3 * t[k / 3]) * corner[k % 3][i];
		nodes[k].weight = area * weight[k / 3];
	}
}

int optla_polygon_nodes_(const optla_polygon *g, optla_node nodes[OPTLA_NODES_MAX])
{
	int n = 0;
	for (int k = 2; k < g->n; k++, n += 7) triangle_nodes((const double *const[3]){g->p[0], g->p[k - 1], g->p[k]}, nodes + n);
	return n;
}

double optla_polygon_integrate_(const optla_polygon *g, optla_integrand f, const void *user)
{
	optla_node nodes[OPTLA_NODES_MAX];
	const int n = optla_polygon_nodes_(g, nodes);
	double sum = 0;
	for (int k = 0; k < n; k++) sum += nodes[k].weight * f(user, nodes[k].uv);
	return sum;
}

/* First and last pixel along one axis that the polygon may touch; false when outside the image. */
static bool pixel_range(const optla_polygon *g, int axis, size_t size, size_t range[2])
{
	double lo = INFINITY, hi = -INFINITY;
	for (int k = 0; k < g->n; k++) {
		lo = fmin(lo, g->p[k][axis]);
		hi = fmax(hi, g->p[k][axis]);
	}
	if (!(hi > -0.5) || !(lo < (double)size - 0.5)) return false;
	range[0] = (size_t)fmax(0, floor(lo + 0.5));
	range[1] = (size_t)fmin((double)size - 1, floor(hi + 0.5));
	return true;
}

optla_status optla_pinhole_scan_(const optla_pinhole *p, const optla_polygon *polygon, optla_integrand f, const void *f_user,
                                 optla_pixel_sink sink, void *sink_user)
{
	size_t xs[2], ys[2];
	if (!pixel_range(polygon, 0, p->width, xs) || !pixel_range(polygon, 1, p->height, ys)) return OPTLA_OK;
	for (size_t y = ys[0]; y <= ys[1]; y++)
		for (size_t x = xs[0]; x <= xs[1]; x++) {
			const double lower[2] = {(double)x - 0.5, (double)y - 0.5}, upper[2] = {(double)x + 0.5, (double)y + 0.5};
			const optla_polygon piece = optla_polygon_clip_(polygon, lower, upper);
			/* slivers below 1e-12 of a pixel are rounding of a shared border */
			if (piece.n < 3 || optla_polygon_area_(&piece) < 1e-12) continue;
			OPTLA_TRY(sink(sink_user, y * p->width + x, optla_polygon_integrate_(&piece, f, f_user)));
		}
	return OPTLA_OK;
}
