/* SPDX-License-Identifier: BSD-3-Clause */
/* The captured transport T ~ D Pᵀ and where it comes from. */
#include "capture/light_spec.h"
#include "math/dense.h"
#include "relight/model_impl.h"

#include <math.h>
#include <string.h>

optla_status optla_model_check_(optla_ctx *ctx, const optla_model_shape *s, const char *name, optla_status blame)
{
	size_t pixels, rows;
	OPTLA_CHECK(ctx, s->width && s->height && optla_size_mul_(s->width, s->height, &pixels) && pixels <= UINT32_MAX, blame,
	            "%s: %zu x %zu is no size of a picture", name, s->width, s->height);
	OPTLA_CHECK(ctx, s->npixels && s->npixels <= pixels, blame, "%s: %zu pixels in a picture of %zu x %zu", name, s->npixels,
	            s->width, s->height);
	OPTLA_CHECK(ctx, (1 == s->channels || 3 == s->channels) && optla_size_mul_(s->npixels, s->channels, &rows), blame,
	            "%s: %zu channels: pictures have 1 or 3", name, s->channels);
	OPTLA_CHECK(ctx, s->nlights && s->rank, blame, "%s: %zu lights and %zu photos: at least one of each is needed", name,
	            s->nlights, s->rank);
	size_t grid;
	OPTLA_CHECK(ctx, !s->light_width || (optla_size_mul_(s->light_width, s->light_height, &grid) && grid == s->nlights), blame,
	            "%s: a projector of %zu x %zu pixels doesn't have %zu lights", name, s->light_width, s->light_height, s->nlights);
	return OPTLA_OK;
}

void optla_model_destroy(optla_model **model)
{
	if (!model || !*model) return;
	optla_model *m = *model;
	optla_ctx *ctx = m->ctx;
	void *all[] = {m->pixel, m->photos, m->illuminations, m->light_direction, m->thumbnails, m->dual_light, m->dual_photo, m};
	for (size_t i = 0; i < sizeof all / sizeof *all; i++) optla_free(ctx, all[i]);
	*model = NULL;
}

/* The first ncols columns as floats; NULL when memory ran out. */
static float *copy_block(optla_ctx *ctx, optla_cblock from, size_t ncols)
{
	float *to = optla_array_(ctx, from.nrows, ncols * sizeof *to);
	const optla_block out = optla_block_(to, from.nrows, ncols, OPTLA_F32);
	for (size_t k = 0; to && k < ncols; k++) optla_copy_column_(from, k, out, k);
	return to;
}

static void *copy_array(optla_ctx *ctx, const void *from, size_t count, size_t size)
{
	void *to = optla_array_(ctx, count, size);
	if (to) memcpy(to, from, count * size);
	return to;
}

static optla_status check_factors(optla_ctx *ctx, const optla_rig_info *rig, size_t channels, optla_cblock d, optla_cblock p)
{
	OPTLA_CHECK(ctx, d.data && p.data && d.ncols > 0 && d.ncols == p.ncols, OPTLA_ERR_SHAPE,
	            "a model needs as many photos as illuminations, at least one; got %zu and %zu", d.ncols, p.ncols);
	OPTLA_CHECK(ctx, d.nrows == rig->npixels * channels && p.nrows == rig->nlights, OPTLA_ERR_SHAPE,
	            "photos of %zu samples and illuminations of %zu lights; the rig has %zu pixels (x %zu channels) and %zu lights",
	            d.nrows, p.nrows, rig->npixels, channels, rig->nlights);
	OPTLA_CHECK(ctx, d.type <= OPTLA_F64 && p.type <= OPTLA_F64, OPTLA_ERR_UNSUPPORTED, "a model is made of real factors");
	return OPTLA_OK;
}

optla_status optla_model_build_(optla_ctx *ctx, const optla_rig_info *rig, size_t channels, optla_cblock d, optla_cblock p,
                                optla_model **out)
{
	*out = NULL;
	OPTLA_TRY(check_factors(ctx, rig, channels, d, p));
	const optla_model_shape shape = {rig->width,   rig->height, channels,         rig->npixels,
	                                 rig->nlights, d.ncols,     rig->light_width, rig->light_height};
	OPTLA_TRY(optla_model_check_(ctx, &shape, rig->name ? rig->name : "rig", OPTLA_ERR_SHAPE));
	optla_model *m = optla_calloc_(ctx, 1, sizeof *m);
	if (!m) return OPTLA_ERR_NOMEM;
	*m = (optla_model){.ctx = ctx,
	                   .width = rig->width,
	                   .height = rig->height,
	                   .channels = channels,
	                   .npixels = rig->npixels,
	                   .nlights = rig->nlights,
	                   .rank = d.ncols,
	                   .light_width = rig->light_width,
	                   .light_height = rig->light_height};
	m->pixel = copy_array(ctx, rig->pixel, rig->npixels, sizeof *m->pixel);
	m->photos = copy_block(ctx, d, d.ncols);
	m->illuminations = copy_block(ctx, p, p.ncols);
	if (rig->light_direction) m->light_direction = copy_array(ctx, rig->light_direction, 3 * rig->nlights, sizeof(double));
	if (m->pixel && m->photos && m->illuminations && (m->light_direction || !rig->light_direction)) {
		*out = m;
		return OPTLA_OK;
	}
	optla_model_destroy(&m);
	return OPTLA_ERR_NOMEM;
}

optla_status optla_model_create(const optla_rig *rig, size_t channels, optla_cblock photos, optla_cblock illuminations,
                                optla_model **out)
{
	optla_rig_info info;
	optla_rig_get_info(rig, &info);
	return optla_model_build_(optla_rig_ctx(rig), &info, channels, photos, illuminations, out);
}

/* r_k and s_k belong beside d_k unless the run has rotated its result to a smaller rank: then r_1 no longer is d_1 / ||d_1||. */
static bool duals_fit(optla_cblock d, optla_cblock r, optla_cblock s)
{
	if (!r.data || !s.data || r.ncols < d.ncols || s.ncols < d.ncols || r.nrows != d.nrows) return false;
	return optla_dot_(d, 0, r, 0) >= (1 - 1e-4) * optla_norm_(d, 0) * optla_norm_(r, 0); /* 1e-4: well above float rounding */
}

static optla_status add_low_resolution(optla_model *m, optla_cblock d, bool high, bool dual, optla_cblock r, optla_cblock s)
{
	m->nthumb = high || dual ? d.nrows : 0;
	if (high) m->thumbnails = copy_block(m->ctx, d, m->rank);
	if (dual) {
		m->dual_light = copy_block(m->ctx, r, m->rank);
		m->dual_photo = copy_block(m->ctx, s, m->rank);
	}
	return (m->thumbnails || !high) && ((m->dual_light && m->dual_photo) || !dual) ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

optla_status optla_model_from_krylov(const optla_rig *rig, const optla_krylov *run, optla_model **out)
{
	optla_rig_info info;
	optla_cblock d, p, high, r, s;
	*out = NULL;
	optla_rig_get_info(rig, &info);
	OPTLA_TRY(optla_krylov_bases(run, &d, &p, &high));
	OPTLA_TRY(optla_krylov_dual_bases(run, &r, &s));
	const optla_cblock photos = high.data ? high : d;
	OPTLA_TRY(optla_model_build_(optla_rig_ctx(rig), &info, info.npixels ? photos.nrows / info.npixels : 0, photos, p, out));
	const optla_status status = add_low_resolution(*out, d, high.data, duals_fit(d, r, s), r, s);
	if (OPTLA_OK != status) {
		optla_model_destroy(out);
		return status;
	}
	const optla_krylov_info made = optla_krylov_get_info(run);
	(*out)->photos_taken = made.photos;
	(*out)->exposure_s = made.exposure_s;
	return OPTLA_OK;
}

optla_status optla_model_image(const optla_model *m, const float *i, optla_image **out)
{
	OPTLA_TRY(optla_image_create(m->ctx, m->width, m->height, m->channels, OPTLA_IMAGE_LINEAR, out));
	for (size_t c = 0; c < m->channels; c++)
		for (size_t k = 0; k < m->npixels; k++) (*out)->data[m->pixel[k] * m->channels + c] = i[c * m->npixels + k];
	return OPTLA_OK;
}

optla_status optla_model_light_vector(const optla_model *m, const char *spec, size_t channels, double *p)
{
	const optla_light_layout lights = {
	    .nlights = m->nlights, .grid_width = m->light_width, .grid_height = m->light_height, .direction = m->light_direction};
	return optla_light_spec_(m->ctx, &lights, spec, channels, p);
}
