/* SPDX-License-Identifier: BSD-3-Clause */
/* What a pixel's points exchange with all patches of the other walls, by closed form factors. */
#include "render/corner_impl.h"
#include "render/form_factor.h"

#include <string.h>

#define NEAR 4.0 /* a piece this many radii from the other wall or nearer is taken as its finer points */

enum { GRID_MAX = 65 * 65 }; /* 64 patches along a side */

/* column[a] += factor * F from the point to patch a, for the patches of wall 'index': sums over patch corners. */
static void add_wall(const optla_corner *c, const double x[3], int own_wall, int index, double factor, double *column)
{
	const size_t n = c->patches;
	const int wall = c->walls[index], height = optla_wall_normal_[own_wall], side = 3 - height - optla_wall_normal_[wall];
	const bool height_first = optla_wall_axes_[wall][0] == height; /* the axis that runs fastest over the patches */
	double corner[GRID_MAX];
	for (size_t j = 0; j <= n; j++)
		for (size_t i = 0; i <= n; i++) {
			const double u = (double)i / (double)n, v = (double)j / (double)n;
			corner[j * (n + 1) + i] =
			    optla_point_perpendicular_(height_first ? u : v, (height_first ? v : u) - x[side], x[optla_wall_normal_[wall]]);
		}
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < n; i++) {
			const double *k = corner + j * (n + 1) + i;
			column[(size_t)index * n * n + j * n + i] += factor * (k[n + 2] - k[n + 1] - k[1] + k[0]);
		}
}

static void add_piece(const optla_corner *c, const optla_pieces *pieces, const optla_piece *p, double factor, double *column)
{
	for (int k = 0; k < c->nwalls; k++) {
		if (c->walls[k] == p->wall) continue;
		if (p->whole.x[optla_wall_normal_[c->walls[k]]] > NEAR * p->radius_m) {
			add_wall(c, p->whole.x, p->wall, k, factor * p->whole.weight, column);
			continue;
		}
		for (size_t i = p->first; i < p[1].first; i++)
			add_wall(c, pieces->fine[i].x, p->wall, k, factor * pieces->fine[i].weight, column);
	}
}

void optla_corner_gather_(optla_ctx *ctx, const optla_corner *c, const optla_pieces *pieces, size_t npixels, size_t channel,
                          double scale, double *gather)
{
	const int threads = optla_ctx_threads(ctx);
#pragma omp parallel for num_threads(threads) schedule(dynamic, 16)
	for (size_t m = 0; m < npixels; m++) {
		double *column = gather + m * c->npatches;
		memset(column, 0, c->npatches * sizeof *column);
		for (size_t k = pieces->start[m]; k < pieces->start[m + 1]; k++) {
			const optla_piece *p = &pieces->pieces[k];
			add_piece(c, pieces, p, scale * c->desc->albedo[p->wall][channel], column);
		}
	}
}
