/* SPDX-License-Identifier: BSD-3-Clause */
/* Pixels cut into points on walls. */
#include "render/corner_impl.h"

#include <math.h>
#include <string.h>

void optla_pieces_free_(optla_ctx *ctx, optla_pieces *s)
{
	optla_free(ctx, s->start);
	optla_free(ctx, s->fine);
	optla_free(ctx, s->pieces);
	memset(s, 0, sizeof *s);
}

/* The part of a wall within a rectangle of the image, as a point at its centre of area; false when there is none. */
static bool cut(const optla_pinhole *p, int wall, const optla_polygon *square, const double lower[2], const double upper[2],
                optla_polygon *part, optla_point *out)
{
	*part = optla_polygon_clip_(square, lower, upper);
	const double area = part->n < 3 ? 0 : optla_polygon_area_(part);
	if (area < 1e-12) return false; /* of a pixel: rounding of a shared border */
	optla_node nodes[OPTLA_NODES_MAX];
	const int n = optla_polygon_nodes_(part, nodes);
	double centre[2] = {0, 0};
	out->weight = 0;
	for (int k = 0; k < n; k++) {
		for (int i = 0; i < 2; i++) centre[i] += nodes[k].weight / area * nodes[k].uv[i];
		out->weight += nodes[k].weight * optla_pupil_weight_(p, nodes[k].uv);
	}
	optla_wall_hit_(p, wall, centre, out->x);
	return true;
}

static double distance(const double a[3], const double b[3])
{
	double sum = 0;
	for (int k = 0; k < 3; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
	return sqrt(sum);
}

/* Outline on the wall, its area, and the largest distance from the centre. A wall square cut by a pixel has at most 8 corners. */
static void outline(const optla_pinhole *p, const optla_polygon *part, optla_piece *q)
{
	const int *axes = optla_wall_axes_[q->wall];
	double twice = 0;
	q->ncorners = part->n;
	q->radius_m = 0;
	for (int k = 0; k < part->n; k++) {
		optla_wall_hit_(p, q->wall, part->p[k], q->corner[k]);
		q->radius_m = fmax(q->radius_m, distance(q->corner[k], q->whole.x));
	}
	for (int k = 0; k < part->n; k++) {
		const double *u = q->corner[k], *v = q->corner[(k + 1) % part->n];
		twice += u[axes[0]] * v[axes[1]] - v[axes[0]] * u[axes[1]];
	}
	q->area_m2 = fabs(twice) / 2;
}

/* All pieces of a pixel. square: each wall as the pinhole sees it. */
static void cut_pixel(const optla_corner *c, const optla_pinhole *p, const optla_polygon *square, size_t pixel, optla_pieces *s)
{
	const double x = (double)(pixel % p->width) - 0.5, y = (double)(pixel / p->width) - 0.5, step = 1.0 / OPTLA_FINE;
	const double lower[2] = {x, y}, upper[2] = {x + 1, y + 1};
	optla_polygon part, small;
	for (int k = 0; k < c->nwalls; k++) {
		const int wall = c->walls[k];
		optla_piece *q = &s->pieces[s->npieces];
		if (!cut(p, wall, &square[k], lower, upper, &part, &q->whole)) continue;
		q->wall = wall;
		outline(p, &part, q);
		q->pixel = pixel;
		q->first = s->nfine;
		for (int f = 0; f < OPTLA_FINE * OPTLA_FINE; f++) {
			const double l[2] = {x + step * (f % OPTLA_FINE), y + step * (double)(f / OPTLA_FINE)},
			             u[2] = {l[0] + step, l[1] + step};
			if (cut(p, wall, &part, l, u, &small, &s->fine[s->nfine])) s->nfine++;
		}
		s->npieces++;
	}
}

optla_status optla_pieces_cut_(optla_ctx *ctx, const optla_corner *c, const optla_pinhole *p, optla_pieces *s)
{
	static const double whole[2][2] = {{0, 1}, {0, 1}};
	const size_t npixels = p->width * p->height, most = npixels * (size_t)c->nwalls;
	s->pieces = optla_array_(ctx, most + 1, sizeof *s->pieces);
	s->fine = optla_array_(ctx, most, OPTLA_FINE * OPTLA_FINE * sizeof *s->fine);
	s->start = optla_array_(ctx, npixels + 1, sizeof *s->start);
	if (!s->pieces || !s->fine || !s->start) return OPTLA_ERR_NOMEM;
	optla_polygon square[OPTLA_WALLS];
	for (int k = 0; k < c->nwalls; k++) square[k] = optla_wall_seen_(p, c->walls[k], whole);
	for (size_t pixel = 0; pixel < npixels; pixel++) {
		s->start[pixel] = s->npieces;
		cut_pixel(c, p, square, pixel, s);
	}
	s->start[npixels] = s->npieces;
	s->pieces[s->npieces] = (optla_piece){.first = s->nfine};
	return OPTLA_OK;
}
