/* SPDX-License-Identifier: BSD-3-Clause */
/* PFM, the portable float map (P. Debevec): "PF" or "Pf", width, height, scale, then floats of the bottom row first.
   A negative scale means little endian. Its size is a unit of light, which a linear image leaves open: it isn't applied. */
#include "io/image_codec.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WORD_BYTES = 31 };

/* The next word of the header and one white space behind it. */
static bool next_word(const optla_source *s, size_t *at, char word[WORD_BYTES + 1])
{
	size_t n = 0;
	while (*at < s->count && isspace(s->data[*at])) ++*at;
	while (*at < s->count && !isspace(s->data[*at])) {
		if (WORD_BYTES == n) return false;
		word[n++] = (char)s->data[(*at)++];
	}
	word[n] = 0;
	if (!n || *at == s->count) return false;
	++*at;
	return true;
}

static optla_status read_size(const optla_source *s, size_t *at, const char *what, uint64_t *size)
{
	char word[WORD_BYTES + 1] = "", *end;
	const bool found = next_word(s, at, word);
	const unsigned long long value = strtoull(word, &end, 10);
	OPTLA_CHECK(s->ctx, found && isdigit((unsigned char)word[0]) && !*end && value >= 1 && value <= UINT32_MAX, OPTLA_ERR_INPUT,
	            "%s: PFM: the %s in the header is '%s', not a number from 1 to 4294967295", s->name, what, word);
	*size = value;
	return OPTLA_OK;
}

static bool machine_is_little(void)
{
	return 1 == (union {
		            uint16_t word;
		            uint8_t first;
	            }){1}
	                .first;
}

static float swapped(const uint8_t *p)
{
	const uint8_t turned[4] = {p[3], p[2], p[1], p[0]};
	float value;
	memcpy(&value, turned, sizeof value);
	return value;
}

static void read_rows(const uint8_t *from, bool little, optla_image *image)
{
	const size_t n = image->width * image->channels;
	for (size_t y = 0; y < image->height; y++) {
		float *row = image->data + (image->height - 1 - y) * n;
		memcpy(row, from + y * n * sizeof *row, n * sizeof *row);
		for (size_t k = 0; little != machine_is_little() && k < n; k++) row[k] = swapped((const uint8_t *)&row[k]);
	}
}

optla_status optla_pfm_decode_(const optla_source *s, optla_image **out)
{
	*out = NULL;
	char word[WORD_BYTES + 1] = "", *end;
	size_t at = 0;
	uint64_t width, height;
	const bool start = next_word(s, &at, word);
	OPTLA_CHECK(s->ctx, start && (!strcmp(word, "PF") || !strcmp(word, "Pf")), OPTLA_ERR_INPUT,
	            "%s: PFM: the header starts with '%s', not PF or Pf", s->name, word);
	const size_t channels = 'F' == word[1] ? 3 : 1;
	OPTLA_TRY(read_size(s, &at, "width", &width));
	OPTLA_TRY(read_size(s, &at, "height", &height));
	const bool found = next_word(s, &at, word);
	const double scale = optla_strtod_(word, &end);
	OPTLA_CHECK(s->ctx, found && !*end && isfinite(scale) && scale != 0, OPTLA_ERR_INPUT,
	            "%s: PFM: the scale in the header is '%s', not a number other than zero", s->name, word);
	/* Both sizes are below 2^32: three channels of floats may still not fit in 64 bits, therefore the comparison in double. */
	const double wanted = (double)width * (double)height * (double)channels * sizeof(float);
	OPTLA_CHECK(s->ctx, wanted == (double)(s->count - at), OPTLA_ERR_INPUT,
	            "%s: PFM: %llu x %llu pixels of %zu channels need %.0f bytes behind the header, there are %zu", s->name,
	            (unsigned long long)width, (unsigned long long)height, channels, wanted, s->count - at);
	OPTLA_TRY(optla_image_start_(s, width, height, channels, OPTLA_IMAGE_LINEAR, out));
	read_rows(s->data + at, scale < 0, *out);
	return OPTLA_OK;
}

optla_status optla_pfm_encode_(const optla_image *image, optla_memory_file *file)
{
	OPTLA_CHECK(image->ctx, 1 == image->channels || 3 == image->channels, OPTLA_ERR_ARG,
	            "%s: PFM holds 1 or 3 channels, not %zu: write .exr", file->name, image->channels);
	OPTLA_CHECK(image->ctx, OPTLA_IMAGE_LINEAR == image->kind, OPTLA_ERR_ARG,
	            "%s: PFM has no room to say that an image is of kind %s: write .exr, .png or .tif", file->name,
	            optla_image_kind_name(image->kind));
	char header[96];
	snprintf(header, sizeof header, "%s\n%zu %zu\n%s\n", 3 == image->channels ? "PF" : "Pf", image->width, image->height,
	         machine_is_little() ? "-1.0" : "1.0");
	const size_t row_bytes = image->width * image->channels * sizeof *image->data;
	bool written = optla_memory_file_write_(file, header, strlen(header));
	for (size_t y = image->height; written && y-- > 0;)
		written = optla_memory_file_write_(file, image->data + y * image->width * image->channels, row_bytes);
	return written ? OPTLA_OK : OPTLA_ERR_NOMEM;
}
