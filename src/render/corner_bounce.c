/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Light that one wall sends to another, pixel by pixel: T is a sum over pairs of pieces of pixels. Near an edge that light is sharp
 * (1/r² between neighbours), too sharp for patches. A pair far apart for its size is two points; a nearer one many points each; for
 * neighbours one side is many points and the other its outline, in closed form. Both sides are treated alike, so a coaxial T stays
 * symmetric.
 */
#include "render/corner_impl.h"

#include <math.h>

#define PI 3.14159265358979323846
/* Distances in radii of the larger piece. Taking pieces for points costs about (radius/r)²/4 of the pair's light. */
#define FAR 10.0
#define NEAR 3.0

static double distance(const double a[3], const double b[3])
{
	double sum = 0;
	for (int k = 0; k < 3; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
	return sqrt(sum);
}

/* cosθ cosθ' / (π r²) between points of two walls: their distances from each other's wall are coordinates. */
static inline double kernel(const double x[3], int normal_x, const double y[3], int normal_y)
{
	const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]}, r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
	return fabs(d[normal_x] * d[normal_y]) / (PI * r2 * r2);
}

/* Form factor from a point with this normal axis to a flat outline: half the sum of the angles its sides are seen under, each times the
   cosine between the normals of the side's plane and of the surface (J. H. Lambert, Photometria, 1760). */
static double outline_factor(const double x[3], int normal, const optla_piece *q)
{
	double sum = 0, a[3], b[3];
	for (int i = 0; i < 3; i++) b[i] = q->corner[q->ncorners - 1][i] - x[i];
	for (int k = 0; k < q->ncorners; k++) {
		double dot = 0;
		for (int i = 0; i < 3; i++) {
			a[i] = b[i];
			b[i] = q->corner[k][i] - x[i];
			dot += a[i] * b[i];
		}
		const double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
		const double sine = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
		if (sine > 0) sum += atan2(sine, dot) * c[normal] / sine;
	}
	return fabs(sum) / (2 * PI);
}

/* Points of p against the outline of q, whose weight is spread evenly. */
static double half_exchange(const optla_pieces *a, const optla_piece *p, const optla_piece *q)
{
	double sum = 0;
	for (size_t i = p->first; i < p[1].first; i++)
		sum += a->fine[i].weight * outline_factor(a->fine[i].x, optla_wall_normal_[p->wall], q);
	return q->whole.weight / q->area_m2 * sum;
}

double optla_pieces_exchange_(const optla_pieces *a, const optla_piece *p, const optla_pieces *b, const optla_piece *q)
{
	const int np = optla_wall_normal_[p->wall], nq = optla_wall_normal_[q->wall];
	const double r = distance(p->whole.x, q->whole.x), radius = fmax(p->radius_m, q->radius_m);
	if (r > FAR * radius) return p->whole.weight * q->whole.weight * kernel(p->whole.x, np, q->whole.x, nq);
	/* the smaller one as points: a sliver along an edge is small for the other's points, which would miss what is right before it */
	if (r < NEAR * radius && p->area_m2 == q->area_m2) return (half_exchange(a, p, q) + half_exchange(b, q, p)) / 2;
	if (r < NEAR * radius) return p->area_m2 < q->area_m2 ? half_exchange(a, p, q) : half_exchange(b, q, p);
	double sum = 0;
	for (size_t i = p->first; i < p[1].first; i++)
		for (size_t j = q->first; j < q[1].first; j++)
			sum += a->fine[i].weight * b->fine[j].weight * kernel(a->fine[i].x, np, b->fine[j].x, nq);
	return sum;
}

static void add_column(const optla_corner *c, const optla_pieces *camera, const optla_pieces *projector, size_t n, double *column)
{
	const size_t npixels = c->camera.width * c->camera.height;
	const double factor = c->pupil_m2 / PI * c->full_power;
	for (size_t j = projector->start[n]; j < projector->start[n + 1]; j++) {
		const optla_piece *q = &projector->pieces[j];
		for (size_t i = 0; i < camera->npieces; i++) {
			const optla_piece *p = &camera->pieces[i];
			if (p->wall == q->wall) continue;
			const double value = factor * optla_pieces_exchange_(camera, p, projector, q);
			for (size_t k = 0; k < 3; k++)
				column[k * npixels + p->pixel] += c->desc->albedo[p->wall][k] * c->desc->albedo[q->wall][k] * value;
		}
	}
}

optla_status optla_corner_bounce_(optla_ctx *ctx, const optla_corner *c, const optla_pieces *camera,
                                  const optla_pieces *projector, double *t)
{
	const size_t nlights = c->projector.width * c->projector.height, ld = 3 * c->camera.width * c->camera.height;
	const int threads = optla_ctx_threads(ctx);
#pragma omp parallel for num_threads(threads) schedule(dynamic, 4)
	for (size_t n = 0; n < nlights; n++) add_column(c, camera, projector, n, t + n * ld);
	return optla_check_cancel_(ctx);
}
