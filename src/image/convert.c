/* SPDX-License-Identifier: BSD-3-Clause */
/* From counts to linear to display values and back, and the exposure that shows a picture well.
   sRGB: IEC 61966-2-1:1999, Multimedia systems and equipment - Colour measurement and management, part 2-1. */
#include "base/base_impl.h"
#include "image/image_impl.h"

#include <math.h>
#include <string.h>

static optla_status check_kind(const optla_image *image, optla_image_kind wanted, const char *doing)
{
	OPTLA_CHECK(image->ctx, wanted == image->kind, OPTLA_ERR_ARG, "%s needs an image of kind %s, this one is %s", doing,
	            optla_image_kind_name(wanted), optla_image_kind_name(image->kind));
	return OPTLA_OK;
}

size_t optla_image_colours_(const optla_image *image) { return 0 == image->channels % 2 ? image->channels - 1 : image->channels; }

optla_status optla_image_linearize(optla_image *image, double black_dn, double scale)
{
	OPTLA_TRY(check_kind(image, OPTLA_IMAGE_RAW_DN, "linearizing"));
	OPTLA_CHECK(image->ctx, isfinite(black_dn) && isfinite(scale) && scale > 0, OPTLA_ERR_ARG,
	            "black level %g and scale %g: finite numbers and a positive scale are needed", black_dn, scale);
	const size_t pixels = image->width * image->height, colours = optla_image_colours_(image);
#pragma omp parallel for num_threads(optla_ctx_threads(image->ctx)) schedule(static)
	for (size_t p = 0; p < pixels; p++) {
		float *v = image->data + p * image->channels;
		for (size_t c = 0; c < colours; c++) v[c] = (float)((v[c] - black_dn) * scale);
	}
	optla_image_set_kind(image, OPTLA_IMAGE_LINEAR, 0);
	return OPTLA_OK;
}

double optla_srgb_encode_(double linear) { return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055; }

double optla_srgb_decode_(double display) { return display <= 0.04045 ? display / 12.92 : pow((display + 0.055) / 1.055, 2.4); }

/* NaN becomes black: a display has no sign for it. */
static double clamp_to_unit(double v) { return v > 0 ? fmin(v, 1) : 0; }

optla_status optla_image_to_display(optla_image *image, double exposure)
{
	OPTLA_TRY(check_kind(image, OPTLA_IMAGE_LINEAR, "encoding for display"));
	OPTLA_CHECK(image->ctx, isfinite(exposure) && exposure > 0, OPTLA_ERR_ARG, "exposure %g is not a positive number", exposure);
	const size_t pixels = image->width * image->height, colours = optla_image_colours_(image);
#pragma omp parallel for num_threads(optla_ctx_threads(image->ctx)) schedule(static)
	for (size_t p = 0; p < pixels; p++) {
		float *v = image->data + p * image->channels;
		for (size_t c = 0; c < colours; c++) v[c] = (float)optla_srgb_encode_(clamp_to_unit(exposure * v[c]));
		for (size_t c = colours; c < image->channels; c++) v[c] = (float)clamp_to_unit(v[c]);
	}
	image->kind = OPTLA_IMAGE_DISPLAY;
	return OPTLA_OK;
}

optla_status optla_image_display_to_linear(optla_image *image)
{
	OPTLA_TRY(check_kind(image, OPTLA_IMAGE_DISPLAY, "decoding display values"));
	const size_t pixels = image->width * image->height, colours = optla_image_colours_(image);
#pragma omp parallel for num_threads(optla_ctx_threads(image->ctx)) schedule(static)
	for (size_t p = 0; p < pixels; p++) {
		float *v = image->data + p * image->channels;
		for (size_t c = 0; c < colours; c++) v[c] = (float)optla_srgb_decode_(v[c]);
	}
	image->kind = OPTLA_IMAGE_LINEAR;
	return OPTLA_OK;
}

/* Largest colour of a pixel as the bits of a float that is not negative, which sort as the floats do; not finite: not counted. */
static bool brightest_bits(const optla_image *image, size_t pixel, uint32_t *bits)
{
	const float *v = image->data + pixel * image->channels;
	float most = 0;
	for (size_t c = 0; c < optla_image_colours_(image); c++) {
		if (!isfinite(v[c])) return false;
		most = fmaxf(most, v[c]);
	}
	memcpy(bits, &most, sizeof *bits);
	return true;
}

enum { DIGIT_BITS = 11, DIGITS = 3, DIGIT_VALUES = 1 << DIGIT_BITS };

/* The value of the given rank (0 = smallest) by counting one digit of the bit pattern after the other: no sorting, no memory. */
static float brightness_of_rank(const optla_image *image, size_t rank)
{
	uint32_t prefix = 0;
	for (int digit = DIGITS - 1; digit >= 0; digit--) {
		const int shift = digit * DIGIT_BITS;
		size_t seen[DIGIT_VALUES] = {0};
		for (size_t p = 0; p < image->width * image->height; p++) {
			uint32_t bits;
			const bool counts = brightest_bits(image, p, &bits);
			if (counts && (uint64_t)bits >> (shift + DIGIT_BITS) == (uint64_t)prefix >> (shift + DIGIT_BITS))
				seen[bits >> shift & (DIGIT_VALUES - 1)]++;
		}
		uint32_t value = 0;
		while (value < DIGIT_VALUES - 1 && rank >= seen[value]) rank -= seen[value++];
		prefix |= value << shift;
	}
	float result;
	memcpy(&result, &prefix, sizeof result);
	return result;
}

double optla_image_auto_exposure(const optla_image *image, double quantile)
{
	if (OPTLA_OK != check_kind(image, OPTLA_IMAGE_LINEAR, "choosing an exposure")) return 1;
	size_t counted = 0;
	for (size_t p = 0; p < image->width * image->height; p++) {
		uint32_t bits;
		counted += brightest_bits(image, p, &bits);
	}
	if (!counted) return 1;
	const double last = (double)(counted - 1), place = quantile >= 0 && quantile <= 1 ? quantile * last : last;
	float bright = brightness_of_rank(image, (size_t)(place + 0.5));
	/* More black pixels than the quantile leaves out: the brightest pixel decides. */
	if (bright <= 0) bright = brightness_of_rank(image, counted - 1);
	return bright > 0 ? 1 / (double)bright : 1;
}

optla_status optla_image_grey(const optla_image *image, optla_image **out)
{
	*out = NULL;
	OPTLA_CHECK(image->ctx, OPTLA_IMAGE_DISPLAY != image->kind, OPTLA_ERR_ARG,
	            "the mean of display values means nothing: convert with optla_image_display_to_linear() first");
	OPTLA_TRY(optla_image_create(image->ctx, image->width, image->height, 1, image->kind, out));
	(*out)->white_dn = image->white_dn;
	float *grey = (*out)->data;
	const size_t pixels = image->width * image->height, colours = optla_image_colours_(image);
#pragma omp parallel for num_threads(optla_ctx_threads(image->ctx)) schedule(static)
	for (size_t p = 0; p < pixels; p++) {
		double sum = 0;
		for (size_t c = 0; c < colours; c++) sum += image->data[p * image->channels + c];
		grey[p] = (float)(sum / (double)colours);
	}
	return OPTLA_OK;
}

static void signed_colour(double t, float rgb[3])
{
	const float fade = (float)(1 - fabs(t));
	rgb[0] = t < 0 ? fade : 1;
	rgb[1] = fade;
	rgb[2] = t > 0 ? fade : 1;
}

optla_status optla_image_signed_colours(const optla_image *image, double scale, optla_image **out)
{
	*out = NULL;
	OPTLA_CHECK(image->ctx, 1 == image->channels, OPTLA_ERR_SHAPE, "signed colours need one channel, not %zu", image->channels);
	OPTLA_CHECK(image->ctx, isfinite(scale) && scale >= 0, OPTLA_ERR_ARG, "scale %g is not a number >= 0", scale);
	const size_t pixels = image->width * image->height;
	double full = scale;
	for (size_t p = 0; scale <= 0 && p < pixels; p++)
		if (isfinite(image->data[p])) full = fmax(full, fabs(image->data[p]));
	OPTLA_TRY(optla_image_create(image->ctx, image->width, image->height, 3, OPTLA_IMAGE_DISPLAY, out));
	for (size_t p = 0; p < pixels; p++) {
		const double v = image->data[p];
		float *rgb = (*out)->data + 3 * p;
		if (isnan(v))
			rgb[0] = rgb[1] = rgb[2] = 0; /* black: no colour of the scale */
		else
			signed_colour(full > 0 ? optla_clamp_(v / full, -1, 1) : 0, rgb);
	}
	return OPTLA_OK;
}
