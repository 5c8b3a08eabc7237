/* SPDX-License-Identifier: BSD-3-Clause */
/* Resampling, one axis after the other: where an axis shrinks, an output pixel is the mean over the area that it covers; where it
   grows, the linear interpolation between the two nearest centres (the border pixel outside them). Whole factors keep the mean. */
#include "base/base_impl.h"
#include "optla/image.h"

#include <math.h>
#include <string.h>

/* Output k is sum over j < count[k] of weight[k*stride + j] * input[first[k] + j]. */
typedef struct {
	size_t stride, *first, *count;
	double *weight;
} axis_weights;

static void axis_free(optla_ctx *ctx, axis_weights *a)
{
	optla_free(ctx, a->first);
	optla_free(ctx, a->count);
	optla_free(ctx, a->weight);
}

static void shrink_weights(size_t from, size_t to, size_t k, axis_weights *a)
{
	const double step = (double)from / (double)to, left = (double)k * step, right = left + step;
	const size_t first = optla_min_((size_t)left, from - 1), end = optla_min_((size_t)ceil(right), from);
	a->first[k] = first;
	a->count[k] = optla_min_(optla_max_(end, first + 1) - first, a->stride);
	double sum = 0;
	for (size_t j = 0; j < a->count[k]; j++) {
		const double pixel = (double)(first + j), covered = fmin(pixel + 1, right) - fmax(pixel, left);
		a->weight[k * a->stride + j] = fmax(covered, 0);
		sum += fmax(covered, 0);
	}
	for (size_t j = 0; j < a->count[k]; j++) a->weight[k * a->stride + j] /= sum;
}

static void grow_weights(size_t from, size_t to, size_t k, axis_weights *a)
{
	const double centre = ((double)k + 0.5) * (double)from / (double)to - 0.5,
	             place = optla_clamp_(centre, 0, (double)(from - 1));
	const size_t first = (size_t)place;
	const double share = place - (double)first;
	a->first[k] = first;
	a->count[k] = share > 0 ? 2 : 1; /* a whole place is at most from - 1, so that there is a pixel behind every other one */
	a->weight[k * a->stride] = 1 - share;
	a->weight[k * a->stride + 1] = share;
}

static optla_status axis_make(optla_ctx *ctx, size_t from, size_t to, axis_weights *a)
{
	a->stride = to < from ? from / to + 2 : 2;
	a->first = optla_array_(ctx, to, sizeof *a->first);
	a->count = a->first ? optla_array_(ctx, to, sizeof *a->count) : NULL;
	size_t weights;
	OPTLA_CHECK(ctx, optla_size_mul_(to, a->stride, &weights), OPTLA_ERR_NOMEM, "%zu outputs are too many", to);
	a->weight = a->count ? optla_array_(ctx, weights, sizeof *a->weight) : NULL;
	if (!a->weight) return OPTLA_ERR_NOMEM;
	for (size_t k = 0; k < to; k++)
		if (to < from)
			shrink_weights(from, to, k, a);
		else
			grow_weights(from, to, k, a);
	return OPTLA_OK;
}

/* One row: to has `width` pixels. */
static void resample_row(const float *from, size_t channels, const axis_weights *a, size_t width, float *to)
{
	for (size_t x = 0; x < width; x++) {
		double sum[4] = {0};
		for (size_t j = 0; j < a->count[x]; j++)
			for (size_t c = 0; c < channels; c++)
				sum[c] += a->weight[x * a->stride + j] * (double)from[(a->first[x] + j) * channels + c];
		for (size_t c = 0; c < channels; c++) to[x * channels + c] = (float)sum[c];
	}
}

/* Output row y from rows of n floats. */
static void mix_rows(const float *rows, size_t n, const axis_weights *a, size_t y, float *to)
{
	for (size_t i = 0; i < n; i++) {
		double sum = 0;
		for (size_t j = 0; j < a->count[y]; j++) sum += a->weight[y * a->stride + j] * (double)rows[(a->first[y] + j) * n + i];
		to[i] = (float)sum;
	}
}

static void resample(const optla_image *image, const axis_weights *ax, const axis_weights *ay, float *middle, optla_image *out)
{
	const int threads = optla_ctx_threads(image->ctx);
	const size_t n = out->width * image->channels, n_in = image->width * image->channels;
#pragma omp parallel for num_threads(threads) schedule(static)
	for (size_t y = 0; y < image->height; y++)
		resample_row(image->data + y * n_in, image->channels, ax, out->width, middle + y * n);
#pragma omp parallel for num_threads(threads) schedule(static)
	for (size_t y = 0; y < out->height; y++) mix_rows(middle, n, ay, y, out->data + y * n);
}

optla_status optla_image_resize(const optla_image *image, size_t width, size_t height, optla_image **out)
{
	optla_ctx *ctx = image->ctx;
	if (width == image->width && height == image->height) return optla_image_copy(image, out);
	OPTLA_TRY(optla_image_create(ctx, width, height, image->channels, image->kind, out));
	(*out)->white_dn = image->white_dn;
	axis_weights ax = {0}, ay = {0};
	float *middle = optla_array_(ctx, width * image->channels, image->height * sizeof *middle);
	optla_status status = middle ? axis_make(ctx, image->width, width, &ax) : OPTLA_ERR_NOMEM;
	if (OPTLA_OK == status) status = axis_make(ctx, image->height, height, &ay);
	if (OPTLA_OK == status)
		resample(image, &ax, &ay, middle, *out);
	else
		optla_image_destroy(out);
	axis_free(ctx, &ax);
	axis_free(ctx, &ay);
	optla_free(ctx, middle);
	return status;
}
