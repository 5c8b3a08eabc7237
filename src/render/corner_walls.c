/* SPDX-License-Identifier: BSD-3-Clause */
/* Walls and patches of the corner, what a pinhole sees of them, and their exchange of light. */
#include "render/corner_impl.h"
#include "render/form_factor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

const int optla_wall_normal_[OPTLA_WALLS] = {1, 0, 2};
const int optla_wall_axes_[OPTLA_WALLS][2] = {{0, 2}, {1, 2}, {0, 1}};

double optla_pupil_weight_(const void *pinhole, const double uv[2])
{
	const optla_pinhole *p = pinhole;
	const double cosine = optla_pinhole_cosine_(p, uv), square = cosine * cosine;
	return square * square / (p->focal_px * p->focal_px);
}

/* 1 over the largest of all pixels' integrals. */
static double full_power(const optla_pinhole *p)
{
	double largest = 0;
	for (size_t y = 0; y < p->height; y++)
		for (size_t x = 0; x < p->width; x++) {
			const double l = (double)x - 0.5, r = l + 1, t = (double)y - 0.5, b = t + 1;
			const optla_polygon pixel = {{{l, t}, {r, t}, {r, b}, {l, b}}, 4};
			largest = fmax(largest, optla_polygon_integrate_(&pixel, optla_pupil_weight_, p));
		}
	return 1 / largest;
}

void optla_corner_init_(const optla_corner_desc *d, optla_corner *c)
{
	memset(c, 0, sizeof *c);
	c->desc = d;
	optla_pinhole_init_(&d->camera, &c->camera);
	for (int w = 0; w < OPTLA_WALLS; w++)
		if (d->wall[w]) c->walls[c->nwalls++] = w;
	c->patches = d->patches;
	c->npatches = (size_t)c->nwalls * d->patches * d->patches;
	c->pupil_m2 = PI / 4 * d->pupil_m * d->pupil_m;
	if (d->screen_given) return;
	optla_pinhole_init_(d->coaxial ? &d->camera : &d->projector, &c->projector);
	c->full_power = full_power(&c->projector);
}

int optla_patch_extent_(const optla_corner *c, size_t patch, double extent[2][2])
{
	const size_t n = c->patches, k = patch % (n * n), index[2] = {k % n, k / n};
	for (int i = 0; i < 2; i++) {
		extent[i][0] = (double)index[i] / (double)n;
		extent[i][1] = (double)(index[i] + 1) / (double)n;
	}
	return c->walls[patch / (n * n)];
}

optla_polygon optla_wall_seen_(const optla_pinhole *p, int wall, const double extent[2][2])
{
	static const int order[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
	optla_polygon g = {.n = 4};
	for (int k = 0; k < 4; k++) {
		double point[3] = {0, 0, 0}, depth;
		for (int i = 0; i < 2; i++) point[optla_wall_axes_[wall][i]] = extent[i][order[k][i]];
		optla_pinhole_project_(p, point, g.p[k], &depth); /* depth > 0: optla_corner_check_ */
	}
	return g;
}

void optla_wall_hit_(const optla_pinhole *p, int wall, const double uv[2], double world_m[3])
{
	const int a = optla_wall_normal_[wall];
	double ray[3];
	optla_pinhole_ray_(p, uv, ray);
	const double t = -p->position_m[a] / ray[a];
	for (int k = 0; k < 3; k++) world_m[k] = p->position_m[k] + t * ray[k];
	world_m[a] = 0;
}

/* Patches of two walls: distance index from their common edge (either), and difference along it. All pairs of walls share it. */
static optla_status edge_table(optla_ctx *ctx, size_t n, double **table)
{
	*table = optla_array_(ctx, n, n * n * sizeof **table);
	if (!*table) return OPTLA_ERR_NOMEM;
	const double h = 1 / (double)n;
	const double origin[2] = {0, h};
	double *out = *table;
	const int threads = optla_ctx_threads(ctx);
#pragma omp parallel for num_threads(threads) schedule(static)
	for (size_t k = 0; k < n * n; k++) {
		const size_t i = k / n, j = k % n;
		const double a1[2] = {(double)i * h, (double)(i + 1) * h}, a2[2] = {(double)j * h, (double)(j + 1) * h};
		for (size_t d = 0; d < n; d++) {
			const double b2[2] = {(double)d * h, (double)(d + 1) * h};
			/* i <= j as given: the same sum for both orders makes the exchange symmetric to the bit */
			out[k * n + d] =
			    i <= j ? optla_exchange_perpendicular_(a1, origin, a2, b2) : optla_exchange_perpendicular_(a2, origin, a1, b2);
		}
	}
	return OPTLA_OK;
}

/* Index of a patch along a world axis, -1 for its wall's normal. */
static void patch_cell(const optla_corner *c, size_t patch, long cell[3])
{
	const size_t n = c->patches, k = patch % (n * n);
	const int w = c->walls[patch / (n * n)];
	cell[optla_wall_normal_[w]] = -1;
	cell[optla_wall_axes_[w][0]] = (long)(k % n);
	cell[optla_wall_axes_[w][1]] = (long)(k / n);
}

static double exchange(const optla_corner *c, const double *table, size_t i, size_t j)
{
	const size_t n = c->patches;
	const int wi = c->walls[i / (n * n)], wj = c->walls[j / (n * n)];
	if (wi == wj) return 0;
	long a[3], b[3];
	patch_cell(c, i, a);
	patch_cell(c, j, b);
	const int away_i = optla_wall_normal_[wj], away_j = optla_wall_normal_[wi], along = 3 - away_i - away_j;
	const size_t d = (size_t)labs(a[along] - b[along]);
	return table[((size_t)a[away_i] * n + (size_t)b[away_j]) * n + d];
}

optla_status optla_corner_exchange_(optla_ctx *ctx, const optla_corner *c, double *exchange_m2)
{
	double *table;
	OPTLA_TRY(edge_table(ctx, c->patches, &table));
	const int threads = optla_ctx_threads(ctx);
#pragma omp parallel for num_threads(threads) schedule(static)
	for (size_t j = 0; j < c->npatches; j++)
		for (size_t i = 0; i < c->npatches; i++) exchange_m2[j * c->npatches + i] = exchange(c, table, i, j);
	optla_free(ctx, table);
	return OPTLA_OK;
}

typedef struct {
	optla_ctx *ctx;
	optla_gather *gather;
	size_t patch;
	double scale;
} view_sink;

static optla_status add_piece(void *user, size_t pixel, double value)
{
	const view_sink *s = user;
	return optla_gather_add_(s->ctx, s->gather, pixel, s->patch, s->scale * value);
}

optla_status optla_corner_view_(optla_ctx *ctx, const optla_corner *c, const optla_pinhole *p, double scale, optla_gather *g)
{
	for (size_t patch = 0; patch < c->npatches; patch++) {
		double extent[2][2];
		const int wall = optla_patch_extent_(c, patch, extent);
		const optla_polygon seen = optla_wall_seen_(p, wall, (const double(*)[2])extent);
		view_sink s = {ctx, g, patch, scale};
		OPTLA_TRY(optla_pinhole_scan_(p, &seen, optla_pupil_weight_, p, add_piece, &s));
	}
	return optla_gather_finish_(ctx, g, p->width * p->height);
}
