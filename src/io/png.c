/* SPDX-License-Identifier: BSD-3-Clause */
/* PNG (ISO/IEC 15948) through libpng: 1 to 16 bits, palette, transparency, interlacing; checksums and the end must be right. */
#include "io/image_codec.h"

#include <png.h>
#include <setjmp.h>
#include <string.h>

/* Of unpacked texts and profiles. */
enum { MAX_CHUNK_BYTES = 16 << 20 };

/* All that libpng's longjmp may leave behind stands here and not in locals. */
typedef struct {
	const optla_source *source;
	size_t at;
	png_structp png;
	png_infop info;
	uint8_t *rows;
	optla_image *image;
} png_reader;

static void on_read(png_structp png, png_bytep to, size_t count)
{
	png_reader *r = png_get_io_ptr(png);
	if (count > r->source->count - r->at) png_error(png, "the file ends too early");
	memcpy(to, r->source->data + r->at, count);
	r->at += count;
}

static void on_read_error(png_structp png, png_const_charp message)
{
	const png_reader *r = png_get_error_ptr(png);
	OPTLA_FAIL(r->source->ctx, OPTLA_ERR_INPUT, "%s: PNG: %s", r->source->name, message);
	png_longjmp(png, 1);
}

static void on_read_warning(png_structp png, png_const_charp message)
{
	const png_reader *r = png_get_error_ptr(png);
	optla_log_(r->source->ctx, 1, "%s: PNG: %s", r->source->name, message);
}

static const char *text_of(const png_reader *r, const char *key)
{
	png_textp texts = NULL;
	int count = 0;
	png_get_text(r->png, r->info, &texts, &count);
	for (int k = 0; k < count; k++)
		if (!strcmp(texts[k].key, key)) return texts[k].text;
	return NULL;
}

/* Reads the header, asks libpng for 8- or 16-bit samples without palette, and makes the image. */
static optla_status read_header(png_reader *r)
{
	const optla_source *s = r->source;
	png_read_info(r->png, r->info);
	const unsigned depth = png_get_bit_depth(r->png, r->info);
	const double largest = 16 == depth ? 65535 : 255;
	optla_image_kind kind = 16 == depth ? OPTLA_IMAGE_RAW_DN : OPTLA_IMAGE_DISPLAY;
	optla_image_kind_parse_(text_of(r, OPTLA_KEY_KIND), &kind);
	png_set_expand(r->png); /* palette to RGB, fewer bits to 8, a transparent colour to alpha */
	if (16 == depth && (union {
		                   uint16_t word;
		                   uint8_t first;
	                   }){1}
	                       .first)
		png_set_swap(r->png);
	png_set_interlace_handling(r->png);
	const uint32_t width = png_get_image_width(r->png, r->info), height = png_get_image_height(r->png, r->info);
	/* Before libpng makes rows of that width. */
	OPTLA_CHECK(s->ctx, width <= optla_ctx_memory_limit(s->ctx) / 8, OPTLA_ERR_INPUT,
	            "%s: its header says %u x %u pixels, over the memory limit", s->name, width, height);
	png_read_update_info(r->png, r->info);
	OPTLA_TRY(optla_image_start_(s, width, height, png_get_channels(r->png, r->info), kind, &r->image));
	if (OPTLA_IMAGE_RAW_DN == kind) r->image->white_dn = optla_white_parse_(text_of(r, OPTLA_KEY_WHITE), largest);
	const char *made = text_of(r, OPTLA_KEY_PROVENANCE);
	return made ? optla_image_take_provenance_(r->image, made, strlen(made)) : OPTLA_OK;
}

static optla_status read_rows(png_reader *r)
{
	optla_image *image = r->image;
	const size_t row_bytes = png_get_rowbytes(r->png, r->info);
	const bool wide = 16 == png_get_bit_depth(r->png, r->info),
	           interlaced = PNG_INTERLACE_NONE != png_get_interlace_type(r->png, r->info);
	const int passes = interlaced ? PNG_INTERLACE_ADAM7_PASSES : 1;
	/* Later passes of an interlaced image fill in between the pixels of earlier ones. */
	r->rows = optla_calloc_(r->source->ctx, interlaced ? image->height : 1, row_bytes);
	if (!r->rows) return OPTLA_ERR_NOMEM;
	for (int pass = 0; pass < passes; pass++)
		for (size_t y = 0; y < image->height; y++) {
			uint8_t *row = r->rows + (interlaced ? y * row_bytes : 0);
			png_read_row(r->png, row, NULL);
			if (pass == passes - 1) optla_samples_from_integers_(image, row, wide, y);
		}
	png_read_end(r->png, NULL);
	return OPTLA_OK;
}

/* libpng takes memory for a chunk before it reads it, up to 2 GiB: so no chunk may be longer than what is left of the file. */
static optla_status check_chunks(const optla_source *s)
{
	enum { SIGNATURE = 8, LENGTH_NAME_CRC = 12 };
	size_t at = SIGNATURE;
	while (at < s->count && s->count - at >= LENGTH_NAME_CRC) {
		const uint8_t *p = s->data + at;
		const size_t length = (size_t)p[0] << 24 | (size_t)p[1] << 16 | (size_t)p[2] << 8 | p[3],
		             left = s->count - at - LENGTH_NAME_CRC;
		OPTLA_CHECK(s->ctx, length <= left, OPTLA_ERR_INPUT, "%s: PNG: a chunk of %zu bytes, of which %zu are there", s->name,
		            length, left);
		at += LENGTH_NAME_CRC + length;
	}
	return OPTLA_OK;
}

static optla_status read_all(png_reader *r)
{
	if (setjmp(png_jmpbuf(r->png))) return OPTLA_ERR_INPUT; /* on_read_error has told */
	png_set_read_fn(r->png, r, on_read);
	png_set_crc_action(r->png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
	png_set_user_limits(r->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX); /* the context's limit is checked instead */
	png_set_chunk_malloc_max(r->png, MAX_CHUNK_BYTES);
	OPTLA_TRY(read_header(r));
	return read_rows(r);
}

optla_status optla_png_decode_(const optla_source *source, optla_image **out)
{
	*out = NULL;
	OPTLA_TRY(check_chunks(source));
	png_reader r = {.source = source};
	r.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &r, on_read_error, on_read_warning);
	r.info = r.png ? png_create_info_struct(r.png) : NULL;
	const optla_status status = r.info ? read_all(&r) : OPTLA_FAIL(source->ctx, OPTLA_ERR_NOMEM, "libpng has no memory");
	png_destroy_read_struct(&r.png, &r.info, NULL);
	optla_free(source->ctx, r.rows);
	if (OPTLA_OK != status) optla_image_destroy(&r.image);
	*out = r.image;
	return status;
}

/* ---- writing ---- */

typedef struct {
	const optla_image *image;
	optla_memory_file *file;
	png_structp png;
	png_infop info;
	uint16_t *row;
	char white[32];
	const char *provenance;
} png_writer;

static void on_write(png_structp png, png_bytep bytes, size_t count)
{
	png_writer *w = png_get_io_ptr(png);
	if (!optla_memory_file_write_(w->file, bytes, count)) png_longjmp(png, 1);
}

static void on_flush(png_structp png) { (void)png; }

static void on_write_error(png_structp png, png_const_charp message)
{
	const png_writer *w = png_get_error_ptr(png);
	OPTLA_FAIL(w->image->ctx, OPTLA_ERR_IO, "%s: PNG: %s", w->file->name, message);
	png_longjmp(png, 1);
}

static void on_write_warning(png_structp png, png_const_charp message)
{
	const png_writer *w = png_get_error_ptr(png);
	optla_log_(w->image->ctx, 1, "%s: PNG: %s", w->file->name, message);
}

static void write_header(png_writer *w)
{
	static const int colours[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
	const optla_image *image = w->image;
	const bool raw = OPTLA_IMAGE_RAW_DN == image->kind;
	png_set_IHDR(w->png, w->info, (uint32_t)image->width, (uint32_t)image->height, raw ? 16 : 8, colours[image->channels - 1],
	             PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
	if (OPTLA_IMAGE_DISPLAY == image->kind) png_set_sRGB(w->png, w->info, PNG_sRGB_INTENT_RELATIVE);
	png_text texts[3] = {{.compression = PNG_TEXT_COMPRESSION_NONE, .key = (char *)OPTLA_KEY_KIND},
	                     {.compression = PNG_ITXT_COMPRESSION_NONE, .key = (char *)OPTLA_KEY_PROVENANCE},
	                     {.compression = PNG_TEXT_COMPRESSION_NONE, .key = (char *)OPTLA_KEY_WHITE, .text = w->white}};
	texts[0].text = (char *)optla_image_kind_name(image->kind);
	texts[1].text = (char *)w->provenance;
	optla_white_format_(image->white_dn, w->white);
	png_set_text(w->png, w->info, texts, raw ? 3 : 2);
	png_write_info(w->png, w->info);
}

static optla_status write_all(png_writer *w)
{
	if (setjmp(png_jmpbuf(w->png))) return w->file->failed ? OPTLA_ERR_NOMEM : OPTLA_ERR_IO; /* told already */
	const optla_image *image = w->image;
	const bool raw = OPTLA_IMAGE_RAW_DN == image->kind;
	const size_t n = image->width * image->channels;
	png_set_write_fn(w->png, w, on_write, on_flush);
	png_set_user_limits(w->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
	png_set_compression_level(w->png, 4); /* on photos half the time of level 6 for 2 % more bytes */
	write_header(w);
	for (size_t y = 0; y < image->height; y++) {
		uint8_t *bytes = (uint8_t *)w->row;
		OPTLA_TRY(optla_quantise_row_(image, y, raw ? 65535 : 255, w->file, w->row));
		for (size_t k = 0; k < n; k++) {
			const uint16_t v = w->row[k]; /* byte k, or bytes 2k and 2k+1, never lie behind what is still to be read */
			if (raw) {
				bytes[2 * k] = (uint8_t)(v >> 8);
				bytes[2 * k + 1] = (uint8_t)v;
			} else {
				bytes[k] = (uint8_t)v;
			}
		}
		png_write_row(w->png, bytes);
	}
	png_write_end(w->png, w->info);
	return OPTLA_OK;
}

optla_status optla_png_encode_(const optla_image *image, const char *provenance, optla_memory_file *file)
{
	optla_ctx *ctx = image->ctx;
	OPTLA_CHECK(ctx, OPTLA_IMAGE_LINEAR != image->kind, OPTLA_ERR_ARG,
	            "%s: a linear image can't be written as PNG, which holds counts or display values: convert it with "
	            "optla_image_to_display(), or write .exr",
	            file->name);
	OPTLA_CHECK(ctx, image->width <= PNG_UINT_31_MAX && image->height <= PNG_UINT_31_MAX, OPTLA_ERR_ARG,
	            "%s: %zu x %zu pixels are too many for PNG", file->name, image->width, image->height);
	png_writer w = {.image = image, .file = file, .provenance = provenance};
	w.row = optla_array_(ctx, image->width * image->channels, sizeof *w.row);
	if (!w.row) return OPTLA_ERR_NOMEM;
	w.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &w, on_write_error, on_write_warning);
	w.info = w.png ? png_create_info_struct(w.png) : NULL;
	const optla_status status = w.info ? write_all(&w) : OPTLA_FAIL(ctx, OPTLA_ERR_NOMEM, "libpng has no memory");
	png_destroy_write_struct(&w.png, &w.info);
	optla_free(ctx, w.row);
	return status;
}
