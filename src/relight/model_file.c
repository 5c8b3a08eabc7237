/* SPDX-License-Identifier: BSD-3-Clause */
/* Models as HDF5 (docs/files.md). Whatever a file says is checked against everything else in it before it is believed. */
#include "io/h5.h"
#include "math/dense.h"
#include "relight/model_impl.h"

#include <math.h>
#include <string.h>

/* ---- writing ---- */

static optla_status put_floats(optla_h5 *file, const char *name, const float *data, size_t nrows, size_t ncols, const char *unit,
                               const char *help)
{
	if (!data) return OPTLA_OK;
	return optla_h5_put_(file, name, optla_cblock_(data, nrows, ncols, OPTLA_F32), unit, help);
}

static optla_status put_numbers(optla_h5 *file, const optla_model *m)
{
	const struct {
		const char *name;
		double value;
	} numbers[] = {{"width", (double)m->width},
	               {"height", (double)m->height},
	               {"channels", (double)m->channels},
	               {"light_width", (double)m->light_width},
	               {"light_height", (double)m->light_height},
	               {"thumb_width", (double)m->thumb_width},
	               {"thumb_height", (double)m->thumb_height},
	               {"photos_taken", (double)m->photos_taken},
	               {"exposure_s", m->exposure_s}};
	for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
		OPTLA_TRY(optla_h5_put_number_(file, numbers[k].name, numbers[k].value));
	return OPTLA_OK;
}

static optla_status put_arrays(optla_h5 *file, const optla_model *m)
{
	OPTLA_TRY(optla_h5_put_u32_(file, "pixel", m->pixel, m->npixels, "index y*width + x of each camera pixel, ascending"));
	OPTLA_TRY(put_floats(file, "photos", m->photos, m->npixels * m->channels, m->rank, "1",
	                     "D of T ~ D P^T: one row for each photo, its pixels channel after channel"));
	OPTLA_TRY(put_floats(file, "illuminations", m->illuminations, m->nlights, m->rank, "1",
	                     "P of T ~ D P^T: one row for each illumination"));
	if (m->light_direction)
		OPTLA_TRY(optla_h5_put_(file, "light_direction", optla_cblock_(m->light_direction, 3, m->nlights, OPTLA_F64), "1",
		                        "unit vectors towards each light: x right, y down, z the way the camera looks"));
	OPTLA_TRY(put_floats(file, "thumbnails", m->thumbnails, m->nthumb, m->rank, "1", "low-resolution photos d_k"));
	OPTLA_TRY(put_floats(file, "dual_light", m->dual_light, m->nthumb, m->rank, "1", "r_k: what shone from the camera's side"));
	return put_floats(file, "dual_photo", m->dual_photo, m->nlights, m->rank, "1", "s_k: what arrived at the projector's side");
}

optla_status optla_model_save(const optla_model *m, const char *path)
{
	optla_h5 *file;
	OPTLA_TRY(optla_h5_create_(m->ctx, path, "model", &file));
	optla_status s = put_numbers(file, m);
	if (OPTLA_OK == s) s = put_arrays(file, m);
	const optla_status finished = optla_h5_finish_(&file, OPTLA_OK == s);
	return OPTLA_OK == s ? finished : s;
}

/* ---- reading ---- */

typedef struct {
	optla_ctx *ctx;
	optla_h5 *file;
	const char *path;
	double width, height, channels, light_width, light_height, thumb_width, thumb_height, photos_taken, exposure_s;
	uint32_t *pixel;
	size_t npixels;
	optla_block photos, illuminations, direction, thumbnails, dual_light, dual_photo; /* data NULL: not in the file */
} reader;

static optla_status get_whole(reader *r, const char *name, double most, double *value)
{
	OPTLA_TRY(optla_h5_get_number_(r->file, name, value));
	OPTLA_CHECK(r->ctx, *value >= 0 && *value <= most && *value == floor(*value), OPTLA_ERR_INPUT,
	            "%s: %s is %.17g, wanted a whole number from 0 to %.0f", r->path, name, *value, most);
	return OPTLA_OK;
}

static optla_status get_numbers(reader *r)
{
	const double side = 1 << 24;
	OPTLA_TRY(get_whole(r, "width", side, &r->width));
	OPTLA_TRY(get_whole(r, "height", side, &r->height));
	OPTLA_TRY(get_whole(r, "channels", 3, &r->channels));
	OPTLA_TRY(get_whole(r, "light_width", side, &r->light_width));
	OPTLA_TRY(get_whole(r, "light_height", side, &r->light_height));
	OPTLA_TRY(get_whole(r, "thumb_width", side, &r->thumb_width));
	OPTLA_TRY(get_whole(r, "thumb_height", side, &r->thumb_height));
	OPTLA_TRY(get_whole(r, "photos_taken", 0x1p53, &r->photos_taken));
	OPTLA_TRY(optla_h5_get_number_(r->file, "exposure_s", &r->exposure_s));
	OPTLA_CHECK(r->ctx, isfinite(r->exposure_s) && r->exposure_s >= 0, OPTLA_ERR_INPUT, "%s: exposure_s is %g", r->path,
	            r->exposure_s);
	return OPTLA_OK;
}

static optla_status check_finite(reader *r, const char *name, optla_block b)
{
	const size_t n = b.nrows * b.ncols;
	for (size_t k = 0; k < n; k++) {
		const double v = OPTLA_F32 == b.type ? (double)((const float *)b.data)[k] : ((const double *)b.data)[k];
		OPTLA_CHECK(r->ctx, isfinite(v), OPTLA_ERR_INPUT, "%s: %s[%zu, %zu] is %g", r->path, name, k / b.nrows, k % b.nrows, v);
	}
	return OPTLA_OK;
}

/* A dataset of exactly ncols rows of nrows numbers (SIZE_MAX: any number but none). */
static optla_status get_block(reader *r, const char *name, optla_scalar type, size_t nrows, size_t ncols, optla_block *b)
{
	OPTLA_TRY(optla_h5_get_(r->file, name, type, b));
	OPTLA_CHECK(r->ctx,
	            b->nrows && b->ncols && (SIZE_MAX == nrows || b->nrows == nrows) && (SIZE_MAX == ncols || b->ncols == ncols),
	            OPTLA_ERR_INPUT, "%s: %s is %zu x %zu, the other parts of the model want %zu x %zu", r->path, name, b->ncols,
	            b->nrows, SIZE_MAX == ncols ? b->ncols : ncols, SIZE_MAX == nrows ? b->nrows : nrows);
	return check_finite(r, name, *b);
}

static optla_status check_pixels(reader *r)
{
	for (size_t k = 0; k < r->npixels; k++) {
		OPTLA_CHECK(r->ctx, (double)r->pixel[k] < r->width * r->height, OPTLA_ERR_INPUT,
		            "%s: pixel[%zu] = %u is outside of the picture of %.0f x %.0f", r->path, k, (unsigned)r->pixel[k], r->width,
		            r->height);
		OPTLA_CHECK(r->ctx, 0 == k || r->pixel[k] > r->pixel[k - 1], OPTLA_ERR_INPUT,
		            "%s: pixel[%zu] = %u doesn't ascend from %u", r->path, k, (unsigned)r->pixel[k],
		            (unsigned)r->pixel[k - (k > 0)]);
	}
	return OPTLA_OK;
}

/* Photos and duals are of one size, and on the grid that the file names, if it names one. */
static optla_status check_low_resolution(reader *r)
{
	const size_t nthumb = r->thumbnails.data ? r->thumbnails.nrows : r->dual_light.nrows;
	OPTLA_CHECK(r->ctx, !r->thumbnails.data || !r->dual_light.data || r->thumbnails.nrows == r->dual_light.nrows, OPTLA_ERR_INPUT,
	            "%s: thumbnails have %zu samples, dual_light has %zu", r->path, r->thumbnails.nrows, r->dual_light.nrows);
	OPTLA_CHECK(r->ctx, 0 == r->thumb_width * r->thumb_height || r->thumb_width * r->thumb_height == (double)nthumb,
	            OPTLA_ERR_INPUT, "%s: low-resolution pictures have %zu samples, which isn't %.0f x %.0f", r->path, nthumb,
	            r->thumb_width, r->thumb_height);
	return OPTLA_OK;
}

/* Unit vectors to the accuracy of a measured table: 1e-3. */
static optla_status check_directions(reader *r)
{
	const double *v = r->direction.data;
	for (size_t n = 0; v && n < r->direction.ncols; n++, v += 3) {
		const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
		OPTLA_CHECK(r->ctx, fabs(length - 1) < 1e-3, OPTLA_ERR_INPUT, "%s: light_direction[%zu] has length %g, not 1", r->path, n,
		            length);
	}
	return OPTLA_OK;
}

static optla_status get_optional(reader *r, const char *name, optla_scalar type, size_t nrows, size_t ncols, optla_block *b)
{
	return optla_h5_has_(r->file, name) ? get_block(r, name, type, nrows, ncols, b) : OPTLA_OK;
}

static optla_status get_arrays(reader *r)
{
	OPTLA_TRY(optla_h5_get_u32_(r->file, "pixel", &r->pixel, &r->npixels));
	OPTLA_TRY(check_pixels(r));
	OPTLA_TRY(get_block(r, "photos", OPTLA_F32, r->npixels * (size_t)r->channels, SIZE_MAX, &r->photos));
	const size_t rank = r->photos.ncols;
	OPTLA_TRY(get_block(r, "illuminations", OPTLA_F32, SIZE_MAX, rank, &r->illuminations));
	const size_t nlights = r->illuminations.nrows;
	OPTLA_TRY(get_optional(r, "light_direction", OPTLA_F64, 3, nlights, &r->direction));
	OPTLA_TRY(get_optional(r, "thumbnails", OPTLA_F32, SIZE_MAX, rank, &r->thumbnails));
	OPTLA_TRY(get_optional(r, "dual_light", OPTLA_F32, SIZE_MAX, rank, &r->dual_light));
	OPTLA_TRY(get_optional(r, "dual_photo", OPTLA_F32, nlights, rank, &r->dual_photo));
	OPTLA_CHECK(r->ctx, !r->dual_light.data == !r->dual_photo.data, OPTLA_ERR_INPUT,
	            "%s: dual_light and dual_photo belong together, one is missing", r->path);
	OPTLA_TRY(check_directions(r));
	return check_low_resolution(r);
}

static void *hand_over(optla_block *b)
{
	void *data = b->data;
	b->data = NULL;
	return data;
}

/* The arrays become the model's. */
static optla_status assemble(reader *r, optla_model **out)
{
	const optla_model_shape shape = {(size_t)r->width,       (size_t)r->height, (size_t)r->channels,    r->npixels,
	                                 r->illuminations.nrows, r->photos.ncols,   (size_t)r->light_width, (size_t)r->light_height};
	OPTLA_TRY(optla_model_check_(r->ctx, &shape, r->path, OPTLA_ERR_INPUT));
	optla_model *m = optla_calloc_(r->ctx, 1, sizeof *m);
	if (!m) return OPTLA_ERR_NOMEM;
	*m = (optla_model){.ctx = r->ctx,
	                   .width = shape.width,
	                   .height = shape.height,
	                   .channels = shape.channels,
	                   .npixels = shape.npixels,
	                   .nlights = shape.nlights,
	                   .rank = shape.rank,
	                   .light_width = shape.light_width,
	                   .light_height = shape.light_height,
	                   .pixel = r->pixel,
	                   .photos = hand_over(&r->photos),
	                   .illuminations = hand_over(&r->illuminations),
	                   .light_direction = hand_over(&r->direction),
	                   .nthumb = r->thumbnails.data ? r->thumbnails.nrows : r->dual_light.nrows,
	                   .thumb_width = (size_t)r->thumb_width,
	                   .thumb_height = (size_t)r->thumb_height,
	                   .photos_taken = (uint64_t)r->photos_taken,
	                   .exposure_s = r->exposure_s};
	m->thumbnails = hand_over(&r->thumbnails);
	m->dual_light = hand_over(&r->dual_light);
	m->dual_photo = hand_over(&r->dual_photo);
	r->pixel = NULL;
	*out = m;
	return OPTLA_OK;
}

static optla_status read_model(reader *r, optla_model **out)
{
	optla_status s = get_numbers(r);
	if (OPTLA_OK == s) s = get_arrays(r);
	if (OPTLA_OK == s) s = assemble(r, out);
	optla_h5_close_(&r->file);
	void *all[] = {r->pixel,           r->photos.data,     r->illuminations.data, r->direction.data,
	               r->thumbnails.data, r->dual_light.data, r->dual_photo.data};
	for (size_t k = 0; k < sizeof all / sizeof *all; k++) optla_free(r->ctx, all[k]);
	return s;
}

optla_status optla_model_load(optla_ctx *ctx, const char *path, optla_model **out)
{
	reader r = {.ctx = ctx, .path = path};
	*out = NULL;
	OPTLA_TRY(optla_h5_open_(ctx, path, "model", &r.file));
	return read_model(&r, out);
}

optla_status optla_model_decode_(optla_ctx *ctx, const void *bytes, size_t count, const char *name, optla_model **out)
{
	reader r = {.ctx = ctx, .path = name};
	*out = NULL;
	OPTLA_TRY(optla_h5_open_bytes_(ctx, bytes, count, name, &r.file));
	return read_model(&r, out);
}
