/* SPDX-License-Identifier: BSD-3-Clause */
/* New pictures from a captured transport: relighting (Eqs. 2.7, 2.10) and dual photos (Eq. 1.12). */
#include "optla/relight.h"
#include "math/dense.h"
#include "op/op_impl.h"

optla_status optla_relight_combine(optla_ctx *ctx, const float *d, size_t nrows, size_t ld, size_t k, const float *c, float *y)
{
	OPTLA_CHECK(ctx, ld >= nrows, OPTLA_ERR_SHAPE, "photos of %zu samples can't stand %zu samples apart", nrows, ld);
	const optla_cblock photos = {.data = d, .nrows = nrows, .ncols = k, .ld = ld, .type = OPTLA_F32};
	return optla_dense_apply_(ctx, OPTLA_FORWARD, photos, optla_cblock_(c, k, 1, OPTLA_F32),
	                          optla_block_(y, nrows, 1, OPTLA_F32));
}

static optla_status check_light(const optla_model *m, const float *p, size_t light_channels)
{
	OPTLA_CHECK(m->ctx, 1 == light_channels || m->channels == light_channels, OPTLA_ERR_ARG,
	            "light of %zu channels for photos of %zu: give 1 (white) or as many as the photos have", light_channels,
	            m->channels);
	const size_t n = optla_first_not_finite_(p, m->nlights * light_channels, true);
	OPTLA_CHECK(m->ctx, n == m->nlights * light_channels, OPTLA_ERR_ARG, "light %zu, channel %zu has power %g", n % m->nlights,
	            n / m->nlights, (double)p[n]);
	return OPTLA_OK;
}

optla_status optla_relight(const optla_model *m, const float *p, size_t light_channels, float *i)
{
	OPTLA_TRY(check_light(m, p, light_channels));
	const size_t nrows = m->npixels * m->channels;
	float *c = optla_array_(m->ctx, m->rank * light_channels, sizeof *c);
	if (!c) return OPTLA_ERR_NOMEM;
	/* coordinates of the light in the basis of illuminations, c = Pᵀ p */
	optla_status s = optla_dense_apply_(m->ctx, OPTLA_TRANSPOSE, optla_cblock_(m->illuminations, m->nlights, m->rank, OPTLA_F32),
	                                    optla_cblock_(p, m->nlights, light_channels, OPTLA_F32),
	                                    optla_block_(c, m->rank, light_channels, OPTLA_F32));
	if (OPTLA_OK == s && 1 == light_channels) s = optla_relight_combine(m->ctx, m->photos, nrows, nrows, m->rank, c, i);
	for (size_t k = 0; OPTLA_OK == s && light_channels > 1 && k < light_channels; k++)
		s = optla_relight_combine(m->ctx, m->photos + k * m->npixels, m->npixels, nrows, m->rank, c + k * m->rank,
		                          i + k * m->npixels);
	optla_free(m->ctx, c);
	return s;
}

optla_status optla_dual(const optla_model *m, const float *r, float *s)
{
	const size_t nrows = m->npixels * m->channels;
	const size_t bad = optla_first_not_finite_(r, nrows, true);
	OPTLA_CHECK(m->ctx, bad == nrows, OPTLA_ERR_ARG, "camera sample %zu shines %g", bad, (double)r[bad]);
	float *c = optla_array_(m->ctx, m->rank, sizeof *c);
	if (!c) return OPTLA_ERR_NOMEM;
	const optla_block coordinates = optla_block_(c, m->rank, 1, OPTLA_F32);
	optla_status status = optla_dense_apply_(m->ctx, OPTLA_TRANSPOSE, optla_cblock_(m->photos, nrows, m->rank, OPTLA_F32),
	                                         optla_cblock_(r, nrows, 1, OPTLA_F32), coordinates); /* Dᵀ r */
	if (OPTLA_OK == status)
		status = optla_dense_apply_(m->ctx, OPTLA_FORWARD, optla_cblock_(m->illuminations, m->nlights, m->rank, OPTLA_F32),
		                            optla_block_const(coordinates), optla_block_(s, m->nlights, 1, OPTLA_F32));
	optla_free(m->ctx, c);
	return status;
}
