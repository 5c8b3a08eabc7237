/* SPDX-License-Identifier: BSD-3-Clause */
/* TIFF through libtiff: 8- and 16-bit integers and 32-bit floats, grey or RGB with or without alpha, in strips or tiles, samples
   together or in planes, in all compressions that libtiff was built with. The first image of the file. */
#include "io/tiff_memory.h"

#include <string.h>

typedef struct {
	const optla_source *source;
	optla_tiff_memory memory;
	TIFF *tiff;
	uint32_t width, height;
	uint16_t bits, samples, format, photometric, planar;
	uint32_t block_width, block_height; /* a tile, or a strip as wide as the image */
	optla_image *image;
	uint8_t *block;
	tmsize_t block_bytes;
} tiff_reader;

static optla_status fail(const tiff_reader *r, const char *what)
{
	const char *text = r->memory.cut ? "the file ends too early" : *r->memory.message ? r->memory.message : what;
	return OPTLA_FAIL(r->source->ctx, OPTLA_ERR_INPUT, "%s: TIFF: %s", r->source->name, text);
}

/* "key=value" on a line of its own in the description that Optla writes. */
static bool description_value(const tiff_reader *r, const char *key, char *value, size_t bytes)
{
	const char *text = NULL;
	const size_t n = strlen(key);
	if (!TIFFGetField(r->tiff, TIFFTAG_IMAGEDESCRIPTION, &text) || !text) return false;
	for (const char *line = text; line; line = strchr(line, '\n')) {
		if ('\n' == *line) line++;
		if (strncmp(line, key, n) || '=' != line[n]) continue;
		const size_t length = strcspn(line + n + 1, "\n");
		if (length >= bytes) return false;
		memcpy(value, line + n + 1, length);
		value[length] = 0;
		return true;
	}
	return false;
}

static optla_status read_fields(tiff_reader *r)
{
	uint16_t compression = COMPRESSION_NONE;
	TIFF *t = r->tiff;
	if (!TIFFGetField(t, TIFFTAG_IMAGEWIDTH, &r->width) || !TIFFGetField(t, TIFFTAG_IMAGELENGTH, &r->height))
		return fail(r, "width or height is missing");
	TIFFGetFieldDefaulted(t, TIFFTAG_BITSPERSAMPLE, &r->bits);
	TIFFGetFieldDefaulted(t, TIFFTAG_SAMPLESPERPIXEL, &r->samples);
	TIFFGetFieldDefaulted(t, TIFFTAG_SAMPLEFORMAT, &r->format);
	TIFFGetFieldDefaulted(t, TIFFTAG_PLANARCONFIG, &r->planar);
	TIFFGetFieldDefaulted(t, TIFFTAG_COMPRESSION, &compression);
	if (!TIFFGetField(t, TIFFTAG_PHOTOMETRIC, &r->photometric))
		r->photometric = r->samples < 3 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB;
	if (COMPRESSION_JPEG == compression && PHOTOMETRIC_YCBCR == r->photometric && PLANARCONFIG_CONTIG == r->planar) {
		TIFFSetField(t, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB); /* the codec converts */
		r->photometric = PHOTOMETRIC_RGB;
	}
	return OPTLA_OK;
}

static optla_status check_fields(const tiff_reader *r)
{
	optla_ctx *ctx = r->source->ctx;
	const char *name = r->source->name;
	const bool rgb = PHOTOMETRIC_RGB == r->photometric, is_float = SAMPLEFORMAT_IEEEFP == r->format;
	const bool grey = PHOTOMETRIC_MINISBLACK == r->photometric || PHOTOMETRIC_MINISWHITE == r->photometric;
	OPTLA_CHECK(ctx, rgb || grey, OPTLA_ERR_INPUT, "%s: TIFF: photometric interpretation %u; grey and RGB can be read", name,
	            r->photometric);
	const unsigned fewest = rgb ? 3 : 1;
	OPTLA_CHECK(ctx, r->samples == fewest || r->samples == fewest + 1, OPTLA_ERR_INPUT,
	            "%s: TIFF: %u samples in a pixel; %u, or %u with alpha, can be read", name, r->samples, fewest, fewest + 1);
	OPTLA_CHECK(ctx, PLANARCONFIG_CONTIG == r->planar || PLANARCONFIG_SEPARATE == r->planar, OPTLA_ERR_INPUT,
	            "%s: TIFF: planar configuration %u is unknown", name, r->planar);
	const bool integer = SAMPLEFORMAT_UINT == r->format || SAMPLEFORMAT_VOID == r->format;
	OPTLA_CHECK(ctx, (integer && (8 == r->bits || 16 == r->bits)) || (is_float && 32 == r->bits), OPTLA_ERR_INPUT,
	            "%s: TIFF: %u bits of sample format %u; unsigned integers of 8 or 16 bits and floats of 32 can be read", name,
	            r->bits, r->format);
	return OPTLA_OK;
}

static optla_status make_image(tiff_reader *r)
{
	char text[64];
	optla_image_kind kind = 8 == r->bits ? OPTLA_IMAGE_DISPLAY : 16 == r->bits ? OPTLA_IMAGE_RAW_DN : OPTLA_IMAGE_LINEAR;
	if (description_value(r, OPTLA_KEY_KIND, text, sizeof text)) optla_image_kind_parse_(text, &kind);
	OPTLA_TRY(optla_image_start_(r->source, r->width, r->height, r->samples, kind, &r->image));
	if (OPTLA_IMAGE_RAW_DN == kind)
		r->image->white_dn = optla_white_parse_(description_value(r, OPTLA_KEY_WHITE, text, sizeof text) ? text : NULL,
		                                        8 == r->bits ? 255 : 65535);
	const char *description = NULL; /* ours ends with the provenance, whose first line is this one */
	const char *made = TIFFGetField(r->tiff, TIFFTAG_IMAGEDESCRIPTION, &description) && description
	                       ? strstr(description, "creator: optla")
	                       : NULL;
	return made ? optla_image_take_provenance_(r->image, made, strlen(made)) : OPTLA_OK;
}

static optla_status make_block(tiff_reader *r)
{
	const bool tiled = TIFFIsTiled(r->tiff);
	if (tiled) {
		if (!TIFFGetField(r->tiff, TIFFTAG_TILEWIDTH, &r->block_width) ||
		    !TIFFGetField(r->tiff, TIFFTAG_TILELENGTH, &r->block_height))
			return fail(r, "the size of its tiles is missing");
	} else {
		r->block_width = r->width;
		TIFFGetFieldDefaulted(r->tiff, TIFFTAG_ROWSPERSTRIP, &r->block_height);
		r->block_height = r->block_height < r->height ? r->block_height : r->height;
	}
	r->block_bytes = tiled ? TIFFTileSize(r->tiff) : TIFFStripSize(r->tiff);
	const uint64_t in_block = PLANARCONFIG_CONTIG == r->planar ? r->samples : 1;
	const double wanted = (double)r->block_width * (double)r->block_height * (double)in_block * (r->bits / 8);
	if (r->block_bytes <= 0 || !r->block_width || !r->block_height || wanted != (double)r->block_bytes)
		return fail(r, "the size of its strips or tiles makes no sense");
	OPTLA_CHECK(r->source->ctx, (size_t)r->block_bytes <= optla_ctx_memory_limit(r->source->ctx), OPTLA_ERR_INPUT,
	            "%s: TIFF: a strip or tile of %lld bytes is over the memory limit", r->source->name, (long long)r->block_bytes);
	r->block = optla_alloc_(r->source->ctx, (size_t)r->block_bytes);
	return r->block ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

/* n samples of one row, `step` floats apart. */
static void convert(const tiff_reader *r, const uint8_t *from, size_t n, float *to, size_t step)
{
	uint16_t word;
	if (32 == r->bits)
		for (size_t k = 0; k < n; k++) memcpy(&to[k * step], from + 4 * k, sizeof *to);
	else if (16 == r->bits)
		for (size_t k = 0; k < n; k++) {
			memcpy(&word, from + 2 * k, sizeof word);
			to[k * step] = word;
		}
	else
		for (size_t k = 0; k < n; k++) to[k * step] = from[k];
}

/* The part of the block at (x, y) that lies in the image; plane counts where samples are in planes. */
static void place_block(const tiff_reader *r, uint32_t x, uint32_t y, uint16_t plane)
{
	const bool together = PLANARCONFIG_CONTIG == r->planar;
	const size_t in_block = together ? r->samples : 1, columns = optla_min_(r->block_width, r->width - x);
	const size_t rows = optla_min_(r->block_height, r->height - y), row_bytes = r->block_width * in_block * (r->bits / 8);
	for (size_t k = 0; k < rows; k++) {
		float *to = r->image->data + ((y + k) * r->width + x) * r->samples + plane;
		convert(r, r->block + k * row_bytes, columns * in_block, to, together ? 1 : r->samples);
	}
}

static optla_status read_block(tiff_reader *r, uint32_t x, uint32_t y, uint16_t plane)
{
	const bool tiled = TIFFIsTiled(r->tiff);
	/* The last strip holds only the rows that are left; a tile is always whole. */
	const uint64_t rows = tiled ? r->block_height : optla_min_(r->block_height, r->height - y);
	const tmsize_t wanted = (tmsize_t)((uint64_t)r->block_bytes / r->block_height * rows);
	const tmsize_t n = tiled ? TIFFReadEncodedTile(r->tiff, TIFFComputeTile(r->tiff, x, y, 0, plane), r->block, wanted)
	                         : TIFFReadEncodedStrip(r->tiff, TIFFComputeStrip(r->tiff, y, plane), r->block, wanted);
	if (n != wanted || r->memory.cut) return fail(r, "a strip or tile is shorter than the image needs");
	place_block(r, x, y, plane);
	return OPTLA_OK;
}

/* From numbers in the file to samples of the image's kind: 0..1 for DISPLAY and alpha; MINISWHITE the other way round. */
static void finish_samples(const tiff_reader *r)
{
	optla_image *m = r->image;
	const size_t n = m->width * m->height * m->channels;
	const float largest = 8 == r->bits ? 255 : 65535;
	const bool alpha = 0 == m->channels % 2, integer = 32 != r->bits;
	if (PHOTOMETRIC_MINISWHITE == r->photometric && integer)
		for (size_t k = 0; k < n; k += m->channels) m->data[k] = largest - m->data[k];
	if (integer && OPTLA_IMAGE_DISPLAY == m->kind)
		for (size_t k = 0; k < n; k++) m->data[k] /= largest;
	else if (integer && alpha)
		for (size_t k = m->channels - 1; k < n; k += m->channels) m->data[k] /= largest;
}

static optla_status read_all(tiff_reader *r)
{
	r->memory =
	    (optla_tiff_memory){.ctx = r->source->ctx, .name = r->source->name, .data = r->source->data, .count = r->source->count};
	r->tiff = optla_tiff_open_(&r->memory, "r");
	if (!r->tiff || r->memory.cut) return fail(r, "libtiff can't open it");
	OPTLA_TRY(read_fields(r));
	OPTLA_TRY(check_fields(r));
	OPTLA_TRY(make_image(r));
	OPTLA_TRY(make_block(r));
	const uint16_t planes = PLANARCONFIG_CONTIG == r->planar ? 1 : r->samples;
	for (uint16_t plane = 0; plane < planes; plane++)
		for (uint64_t y = 0; y < r->height; y += r->block_height)
			for (uint64_t x = 0; x < r->width; x += r->block_width) OPTLA_TRY(read_block(r, (uint32_t)x, (uint32_t)y, plane));
	finish_samples(r);
	if (!TIFFLastDirectory(r->tiff))
		optla_log_(r->source->ctx, 1, "%s: TIFF: the first of several images is read", r->source->name);
	return OPTLA_OK;
}

optla_status optla_tiff_decode_(const optla_source *source, optla_image **out)
{
	*out = NULL;
	tiff_reader r = {.source = source};
	const optla_status status = read_all(&r);
	if (r.tiff) TIFFClose(r.tiff);
	optla_free(source->ctx, r.block);
	if (OPTLA_OK != status) optla_image_destroy(&r.image);
	*out = r.image;
	return status;
}
