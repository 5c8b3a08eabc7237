/* SPDX-License-Identifier: BSD-3-Clause */
/* Puts the corner's T together: direct light, and the indirect light of all its patches. */
#include "math/dense.h"
#include "render/corner_impl.h"
#include "render/radiosity.h"

#include <string.h>

#define PI 3.14159265358979323846

size_t optla_corner_npixels_(const optla_corner_desc *d) { return d->camera.width * d->camera.height; }

size_t optla_corner_nlights_(const optla_corner_desc *d)
{
	if (d->screen_given) return d->screen.width * d->screen.height;
	const optla_pinhole_desc *p = d->coaxial ? &d->camera : &d->projector;
	return p->width * p->height;
}

/* All that indirect light needs. */
typedef struct {
	size_t npatches, npixels, nlights;
	optla_pieces camera, projector;
	double *exchange, *area, *albedo;
	double *gather;   /* npatches x npixels */
	double *flux;     /* npatches x nlights */
	double *exitance; /* npatches x nlights */
	double *light;    /* npixels x nlights */
} indirect;

static void indirect_free(optla_ctx *ctx, indirect *s)
{
	optla_free(ctx, s->light);
	optla_free(ctx, s->exitance);
	optla_free(ctx, s->flux);
	optla_free(ctx, s->gather);
	optla_free(ctx, s->albedo);
	optla_free(ctx, s->area);
	optla_free(ctx, s->exchange);
	optla_pieces_free_(ctx, &s->projector);
	optla_pieces_free_(ctx, &s->camera);
}

static optla_status indirect_create(optla_ctx *ctx, const optla_corner *c, indirect *s)
{
	const size_t n = c->npatches;
	s->npatches = n;
	s->npixels = optla_corner_npixels_(c->desc);
	s->nlights = optla_corner_nlights_(c->desc);
	s->exchange = optla_array_(ctx, n, n * sizeof(double));
	s->area = optla_array_(ctx, n, sizeof(double));
	s->albedo = optla_array_(ctx, n, sizeof(double));
	s->gather = optla_array_(ctx, s->npixels, n * sizeof(double));
	s->flux = optla_array_(ctx, s->nlights, n * sizeof(double));
	s->exitance = optla_array_(ctx, s->nlights, n * sizeof(double));
	s->light = optla_array_(ctx, s->nlights, s->npixels * sizeof(double));
	if (!s->exchange || !s->area || !s->albedo || !s->gather || !s->flux || !s->exitance || !s->light) return OPTLA_ERR_NOMEM;
	for (size_t k = 0; k < n; k++) s->area[k] = optla_patch_area_(c);
	optla_corner_exchange_(ctx, c, s->exchange);
	OPTLA_TRY(optla_pieces_cut_(ctx, c, &c->camera, &s->camera));
	return c->desc->screen_given ? OPTLA_OK : optla_pieces_cut_(ctx, c, &c->projector, &s->projector);
}

/* t += A_c/π V_cᵀ B, B the exitance of patches that the light (of a projector: its first scattering) falls on. */
static optla_status add_patches(optla_ctx *ctx, const optla_corner *c, indirect *s, size_t channel, double *t)
{
	const size_t n = s->npatches, per_wall = c->patches * c->patches;
	for (size_t k = 0; k < n; k++) s->albedo[k] = c->desc->albedo[c->walls[k / per_wall]][channel];
	if (c->desc->screen_given)
		optla_screen_flux_(ctx, c, s->flux);
	else
		optla_corner_gather_(ctx, c, &s->projector, s->nlights, channel, c->full_power, s->flux);
	OPTLA_TRY(optla_radiosity_solve_(ctx, s->exchange, s->area, s->albedo, n, s->flux, s->nlights, s->exitance));
	optla_corner_gather_(ctx, c, &s->camera, s->npixels, channel, c->pupil_m2 / PI, s->gather);
	OPTLA_TRY(optla_dense_apply_(ctx, OPTLA_TRANSPOSE, optla_cblock_(s->gather, n, s->npixels, OPTLA_F64),
	                             optla_cblock_(s->exitance, n, s->nlights, OPTLA_F64),
	                             optla_block_(s->light, s->npixels, s->nlights, OPTLA_F64)));
	for (size_t k = 0; k < s->nlights; k++)
		for (size_t m = 0; m < s->npixels; m++) t[(k * 3 + channel) * s->npixels + m] += s->light[k * s->npixels + m];
	return optla_check_cancel_(ctx);
}

static optla_status indirect_light(optla_ctx *ctx, const optla_corner *c, double *t)
{
	indirect s = {0};
	optla_status status = indirect_create(ctx, c, &s);
	if (!status && !c->desc->screen_given) status = optla_corner_bounce_(ctx, c, &s.camera, &s.projector, t);
	for (size_t channel = 0; channel < 3 && !status; channel++) status = add_patches(ctx, c, &s, channel, t);
	indirect_free(ctx, &s);
	return status;
}

/* Rounding in different orders must not spoil the symmetry of the formulas. */
static void symmetrise(double *t, size_t n)
{
	const size_t ld = 3 * n;
	for (size_t channel = 0; channel < 3; channel++)
		for (size_t j = 0; j < n; j++)
			for (size_t i = 0; i < j; i++) {
				double *a = &t[j * ld + channel * n + i], *b = &t[i * ld + channel * n + j];
				*a = *b = (*a + *b) / 2;
			}
}

optla_status optla_corner_matrix_(optla_ctx *ctx, const optla_corner_desc *desc, unsigned parts, double *t)
{
	OPTLA_TRY(optla_corner_check_(ctx, desc));
	optla_corner c;
	optla_corner_init_(desc, &c);
	if (desc->screen_given) OPTLA_TRY(optla_screen_check_hidden_(ctx, &c));
	memset(t, 0, 3 * optla_corner_npixels_(desc) * optla_corner_nlights_(desc) * sizeof *t);
	if (parts & OPTLA_CORNER_DIRECT)
		OPTLA_TRY(desc->screen_given ? optla_screen_direct_(ctx, &c, t) : optla_projector_direct_(ctx, &c, t));
	if (parts & OPTLA_CORNER_INDIRECT) OPTLA_TRY(indirect_light(ctx, &c, t));
	if (desc->coaxial) symmetrise(t, optla_corner_npixels_(desc));
	return OPTLA_OK;
}
