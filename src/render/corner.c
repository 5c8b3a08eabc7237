/* SPDX-License-Identifier: BSD-3-Clause */
/* Puts the corner's T together: direct light, and the indirect light of all its patches. */
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

/* All that one channel's indirect light needs. */
typedef struct {
	size_t npatches, npixels, nlights;
	optla_gather view, flux; /* W_c and Φ */
	double *exchange, *kernel, *area, *albedo, *exitance;
} indirect;

static void indirect_free(optla_ctx *ctx, indirect *s)
{
	optla_free(ctx, s->exitance);
	optla_free(ctx, s->albedo);
	optla_free(ctx, s->area);
	optla_free(ctx, s->kernel);
	optla_free(ctx, s->exchange);
	optla_gather_free_(ctx, &s->flux);
	optla_gather_free_(ctx, &s->view);
}

static optla_status indirect_create(optla_ctx *ctx, const optla_corner *c, indirect *s)
{
	const size_t n = c->npatches;
	s->npatches = n;
	s->npixels = optla_corner_npixels_(c->desc);
	s->nlights = optla_corner_nlights_(c->desc);
	s->exchange = optla_array_(ctx, n, n * sizeof(double));
	s->kernel = optla_array_(ctx, n, n * sizeof(double));
	s->area = optla_array_(ctx, n, sizeof(double));
	s->albedo = optla_array_(ctx, n, sizeof(double));
	s->exitance = optla_array_(ctx, n, s->nlights * sizeof(double));
	if (!s->exchange || !s->kernel || !s->area || !s->albedo || !s->exitance) return OPTLA_ERR_NOMEM;
	for (size_t k = 0; k < n; k++) s->area[k] = 1 / ((double)c->patches * (double)c->patches);
	OPTLA_TRY(optla_corner_view_(ctx, c, &c->camera, c->pupil_m2 / PI, &s->view));
	OPTLA_TRY(c->desc->screen_given ? optla_screen_flux_(ctx, c, &s->flux)
	                                : optla_corner_view_(ctx, c, &c->projector, c->full_power, &s->flux));
	return optla_corner_exchange_(ctx, c, s->exchange);
}

/* t += W_cᵀ G Φ, column by column. */
static void add_indirect(optla_ctx *ctx, const indirect *s, double *t, size_t ld)
{
	const int threads = optla_ctx_threads(ctx);
#pragma omp parallel for num_threads(threads) schedule(static)
	for (size_t n = 0; n < s->nlights; n++) {
		double *b = s->exitance + n * s->npatches, *column = t + n * ld;
		memset(b, 0, s->npatches * sizeof *b);
		for (size_t k = s->flux.start[n]; k < s->flux.start[n + 1]; k++) {
			const double *g = s->kernel + s->flux.patch[k] * s->npatches, joule = s->flux.weight[k];
			for (size_t i = 0; i < s->npatches; i++) b[i] += joule * g[i];
		}
		for (size_t m = 0; m < s->npixels; m++) {
			double sum = 0;
			for (size_t k = s->view.start[m]; k < s->view.start[m + 1]; k++) sum += s->view.weight[k] * b[s->view.patch[k]];
			column[m] += sum;
		}
	}
}

static optla_status indirect_light(optla_ctx *ctx, const optla_corner *c, double *t)
{
	indirect s = {0};
	optla_status status = indirect_create(ctx, c, &s);
	for (size_t channel = 0; channel < 3 && !status; channel++) {
		const size_t per_wall = c->patches * c->patches;
		for (size_t k = 0; k < s.npatches; k++) s.albedo[k] = c->desc->albedo[c->walls[k / per_wall]][channel];
		status = optla_radiosity_kernel_(ctx, s.exchange, s.area, s.albedo, s.npatches, s.kernel);
		if (!status) add_indirect(ctx, &s, t + channel * s.npixels, 3 * s.npixels);
		if (!status) status = optla_check_cancel_(ctx);
	}
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
