/* SPDX-License-Identifier: BSD-3-Clause */
/* Parts that the image formats share: memory files, the kind as text, size checks, quantisation. */
#include "io/image_codec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool optla_memory_file_write_(optla_memory_file *file, const void *bytes, size_t count)
{
	if (file->failed || count > SIZE_MAX / 2 - file->at) return false;
	const size_t end = file->at + count;
	if (end > file->capacity) {
		void *data = file->data;
		const size_t capacity = optla_max_(end, file->capacity + file->capacity / 2 + 4096);
		if (OPTLA_OK != optla_grow_(file->ctx, &data, file->count, capacity, 1)) {
			file->failed = true;
			return false;
		}
		file->data = data;
		file->capacity = capacity;
	}
	if (file->at > file->count) memset(file->data + file->count, 0, file->at - file->count);
	if (count) memcpy(file->data + file->at, bytes, count);
	file->at = end;
	file->count = optla_max_(file->count, end);
	return true;
}

void optla_memory_file_free_(optla_memory_file *file)
{
	optla_free(file->ctx, file->data);
	file->data = NULL;
	file->count = file->capacity = file->at = 0;
}

bool optla_image_kind_parse_(const char *text, optla_image_kind *kind)
{
	static const optla_image_kind kinds[] = {OPTLA_IMAGE_RAW_DN, OPTLA_IMAGE_LINEAR, OPTLA_IMAGE_DISPLAY};
	for (size_t k = 0; text && k < sizeof kinds / sizeof *kinds; k++)
		if (!strcmp(text, optla_image_kind_name(kinds[k]))) {
			*kind = kinds[k];
			return true;
		}
	return false;
}

double optla_white_parse_(const char *text, double fallback)
{
	char *end = NULL;
	const double white = text ? optla_strtod_(text, &end) : 0;
	return text && end != text && !*end && isfinite(white) && white > 0 ? white : fallback;
}

void optla_white_format_(double white_dn, char text[32]) { optla_double_text_(white_dn, 17, text, 32); }

optla_status optla_image_take_provenance_(optla_image *image, const char *text, size_t bytes)
{
	image->provenance = optla_calloc_(image->ctx, bytes + 1, 1);
	if (!image->provenance) return OPTLA_ERR_NOMEM;
	memcpy(image->provenance, text, bytes);
	return OPTLA_OK;
}

optla_status optla_image_start_(const optla_source *source, uint64_t width, uint64_t height, uint64_t channels,
                                optla_image_kind kind, optla_image **out)
{
	optla_ctx *ctx = source->ctx;
	OPTLA_CHECK(ctx, width && height, OPTLA_ERR_INPUT, "%s: an image of %llu x %llu pixels is empty", source->name,
	            (unsigned long long)width, (unsigned long long)height);
	OPTLA_CHECK(ctx, channels >= 1 && channels <= 4, OPTLA_ERR_INPUT, "%s: %llu channels; 1 to 4 can be read", source->name,
	            (unsigned long long)channels);
	const double bytes = (double)width * (double)height * (double)channels * sizeof(float);
	OPTLA_CHECK(ctx, bytes <= (double)optla_ctx_memory_limit(ctx), OPTLA_ERR_INPUT,
	            "%s: its header says %llu x %llu x %llu samples, which are %.3g GiB and over the memory limit of %.3g GiB",
	            source->name, (unsigned long long)width, (unsigned long long)height, (unsigned long long)channels, bytes / 0x1p30,
	            (double)optla_ctx_memory_limit(ctx) / 0x1p30);
	return optla_image_create(ctx, (size_t)width, (size_t)height, (size_t)channels, kind, out);
}

void optla_samples_from_integers_(optla_image *image, const void *row, bool wide, size_t y)
{
	const size_t channels = image->channels, n = image->width * channels;
	const float largest = wide ? 65535 : 255;
	const uint8_t *bytes = row;
	const uint16_t *words = row;
	float *to = image->data + y * n;
	if (wide)
		for (size_t k = 0; k < n; k++) to[k] = words[k];
	else
		for (size_t k = 0; k < n; k++) to[k] = bytes[k];
	if (OPTLA_IMAGE_DISPLAY == image->kind)
		for (size_t k = 0; k < n; k++) to[k] /= largest;
	else if (0 == channels % 2)
		for (size_t k = channels - 1; k < n; k += channels) to[k] /= largest;
}

optla_status optla_quantise_row_(const optla_image *image, size_t y, unsigned largest, const optla_memory_file *file,
                                 uint16_t *row)
{
	const size_t channels = image->channels, n = image->width * channels;
	const float *from = image->data + y * n;
	const bool display = OPTLA_IMAGE_DISPLAY == image->kind, alpha = 0 == channels % 2;
	for (size_t k = 0; k < n; k++) {
		double value = from[k];
		if (display || (alpha && k % channels == channels - 1))
			value = largest * (isnan(value) ? value : optla_clamp_(value, 0, 1));
		value = nearbyint(value);
		OPTLA_CHECK(image->ctx, value >= 0 && value <= largest, OPTLA_ERR_ARG,
		            "%s: sample (%zu, %zu, %zu) is %g, which this format can't hold as an integer of 0 to %u; .exr can",
		            file->name, k / channels, y, k % channels, (double)from[k], largest);
		row[k] = (uint16_t)value;
	}
	return OPTLA_OK;
}
