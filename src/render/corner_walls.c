/* SPDX-License-Identifier: BSD-3-Clause */
/* Walls and patches of the corner, what a pinhole sees of them, and their exchange of light. */
#include "render/corner_impl.h"
#include "render/form_factor.h"

#include <math.h>
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

double optla_patch_area_(const optla_corner *c) { return 1 / ((double)c->patches * (double)c->patches); }

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

/* A_i F_ij of two patches: each one's extent away from the edge that their walls share, and along it. */
static double exchange(const optla_corner *c, size_t i, size_t j)
{
	double e[2][2][2], world[2][3][2];
	const int wall[2] = {optla_patch_extent_(c, i, e[0]), optla_patch_extent_(c, j, e[1])};
	if (wall[0] == wall[1]) return 0;
	for (int k = 0; k < 2; k++)
		for (int axis = 0; axis < 2; axis++) memcpy(world[k][optla_wall_axes_[wall[k]][axis]], e[k][axis], sizeof e[k][axis]);
	const int away[2] = {optla_wall_normal_[wall[1]], optla_wall_normal_[wall[0]]}, along = 3 - away[0] - away[1];
	return optla_exchange_perpendicular_(world[0][away[0]], world[0][along], world[1][away[1]], world[1][along]);
}

void optla_corner_exchange_(optla_ctx *ctx, const optla_corner *c, double *exchange_m2)
{
	const size_t n = c->npatches;
	const int threads = optla_ctx_threads(ctx);
#pragma omp parallel for num_threads(threads) schedule(dynamic, 16)
	for (size_t j = 0; j < n; j++) {
		exchange_m2[j * n + j] = 0;
		for (size_t i = 0; i < j; i++) exchange_m2[j * n + i] = exchange_m2[i * n + j] = exchange(c, i, j);
	}
}
