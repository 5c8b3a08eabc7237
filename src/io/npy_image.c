/* SPDX-License-Identifier: BSD-3-Clause */
/* Images as NumPy arrays of height x width [x channels]: uint8 is DISPLAY, uint16 RAW_DN, floats LINEAR, in both directions. */
#include "io/image_codec.h"
#include "io/npy.h"

#include <string.h>

static optla_status kind_of(const optla_source *s, const optla_npy_header *h, optla_image_kind *kind)
{
	if ('u' == h->kind && 1 == h->item_bytes)
		*kind = OPTLA_IMAGE_DISPLAY;
	else if ('u' == h->kind && 2 == h->item_bytes)
		*kind = OPTLA_IMAGE_RAW_DN;
	else if ('f' == h->kind)
		*kind = OPTLA_IMAGE_LINEAR;
	else
		return OPTLA_FAIL(s->ctx, OPTLA_ERR_INPUT,
		                  "%s: NPY: items of type '%c%zu' are no image; u1 (display), u2 (counts) and floats (linear) are",
		                  s->name, h->kind, h->item_bytes);
	return OPTLA_OK;
}

static void copy_samples(const optla_array *array, optla_image *image)
{
	const size_t n = image->width * image->channels;
	const bool display = OPTLA_IMAGE_DISPLAY == image->kind, raw = OPTLA_IMAGE_RAW_DN == image->kind;
	const bool alpha = 0 == image->channels % 2;
	for (size_t k = 0; k < n * image->height; k++) {
		const float v = OPTLA_F32 == array->type ? ((const float *)array->data)[k] : (float)((const double *)array->data)[k];
		const bool in_alpha = alpha && k % image->channels == image->channels - 1;
		image->data[k] = display ? v / 255 : raw && in_alpha ? v / 65535 : v;
	}
}

optla_status optla_npy_image_decode_(const optla_source *s, optla_image **out)
{
	*out = NULL;
	optla_npy_header h;
	optla_image_kind kind = OPTLA_IMAGE_LINEAR;
	optla_array *array = NULL;
	OPTLA_TRY(optla_npy_header_parse_(s->ctx, s->name, s->data, s->count, &h));
	OPTLA_CHECK(s->ctx, 2 == h.ndims || 3 == h.ndims, OPTLA_ERR_INPUT,
	            "%s: NPY: an array of %zu dimensions is no image; height x width [x channels] is", s->name, h.ndims);
	OPTLA_TRY(kind_of(s, &h, &kind));
	OPTLA_TRY(optla_image_start_(s, h.shape[1], h.shape[0], 3 == h.ndims ? h.shape[2] : 1, kind, out));
	(*out)->white_dn = OPTLA_IMAGE_RAW_DN == kind ? 65535 : 0;
	const optla_status status = optla_array_decode(s->ctx, s->data, s->count, s->name, NULL, &array);
	if (OPTLA_OK == status)
		copy_samples(array, *out);
	else
		optla_image_destroy(out);
	optla_array_destroy(&array);
	return status;
}

/* Magic, version 1.0, and a dictionary that ends in a line feed where the data starts at a multiple of 64 bytes (NEP 1). */
static bool write_header(const optla_image *image, optla_memory_file *file)
{
	char text[256];
	const bool little = 1 == (union {
		                         uint16_t word;
		                         uint8_t first;
	                         }){1}
	                             .first;
	const char *type = OPTLA_IMAGE_DISPLAY == image->kind  ? "|u1"
	                   : OPTLA_IMAGE_RAW_DN == image->kind ? (little ? "<u2" : ">u2")
	                                                       : (little ? "<f4" : ">f4");
	int n = snprintf(text, sizeof text, "{'descr': '%s', 'fortran_order': False, 'shape': (%zu, %zu", type, image->height,
	                 image->width);
	n += snprintf(text + n, sizeof text - (size_t)n, image->channels > 1 ? ", %zu), }" : "), }", image->channels);
	const size_t total = ((size_t)n + 11 + 63) / 64 * 64, length = total - 10;
	const uint8_t start[10] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, (uint8_t)(length & 0xff), (uint8_t)(length >> 8)};
	memset(text + n, ' ', length - (size_t)n);
	text[length - 1] = '\n';
	return optla_memory_file_write_(file, start, sizeof start) && optla_memory_file_write_(file, text, length);
}

static optla_status write_integers(const optla_image *image, uint16_t *row, optla_memory_file *file)
{
	const size_t n = image->width * image->channels;
	const bool display = OPTLA_IMAGE_DISPLAY == image->kind;
	for (size_t y = 0; y < image->height; y++) {
		uint8_t *bytes = (uint8_t *)row;
		OPTLA_TRY(optla_quantise_row_(image, y, display ? 255 : 65535, file, row));
		for (size_t k = 0; display && k < n; k++)
			bytes[k] = (uint8_t)row[k]; /* byte k is never behind what is still to be read */
		if (!optla_memory_file_write_(file, row, n * (display ? 1 : 2))) return OPTLA_ERR_NOMEM;
	}
	return OPTLA_OK;
}

optla_status optla_npy_image_encode_(const optla_image *image, optla_memory_file *file)
{
	const size_t n = image->width * image->channels;
	if (!write_header(image, file)) return OPTLA_ERR_NOMEM;
	if (OPTLA_IMAGE_LINEAR == image->kind)
		return optla_memory_file_write_(file, image->data, n * image->height * sizeof *image->data) ? OPTLA_OK : OPTLA_ERR_NOMEM;
	uint16_t *row = optla_array_(image->ctx, n, sizeof *row);
	if (!row) return OPTLA_ERR_NOMEM;
	const optla_status status = write_integers(image, row, file);
	optla_free(image->ctx, row);
	return status;
}
