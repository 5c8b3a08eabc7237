/* SPDX-License-Identifier: BSD-3-Clause */
/* Writing TIFF through libtiff: 8-bit display values, 16-bit counts, 32-bit linear floats; deflate with a predictor. */
#include "io/tiff_memory.h"

#include <string.h>

typedef struct {
	const optla_image *image;
	optla_memory_file *file;
	optla_tiff_memory memory;
	TIFF *tiff;
	uint16_t *integers;
	void *row; /* libtiff's predictor overwrites it */
	char *description;
} tiff_writer;

static uint16_t bits_of(optla_image_kind kind) { return OPTLA_IMAGE_DISPLAY == kind ? 8 : OPTLA_IMAGE_RAW_DN == kind ? 16 : 32; }

static optla_status told(const tiff_writer *w, int done)
{
	if (done > 0) return OPTLA_OK;
	if (w->file->failed) return OPTLA_ERR_NOMEM; /* told already */
	return OPTLA_FAIL(w->image->ctx, OPTLA_ERR_IO, "%s: TIFF: %s", w->file->name,
	                  *w->memory.message ? w->memory.message : "libtiff can't write it");
}

static optla_status set_fields(tiff_writer *w)
{
	const optla_image *m = w->image;
	TIFF *t = w->tiff;
	const uint16_t unassociated = EXTRASAMPLE_UNASSALPHA;
	const bool is_float = OPTLA_IMAGE_LINEAR == m->kind, rgb = m->channels >= 3;
	int done =
	    TIFFSetField(t, TIFFTAG_IMAGEWIDTH, (uint32_t)m->width) && TIFFSetField(t, TIFFTAG_IMAGELENGTH, (uint32_t)m->height);
	done = done && TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, bits_of(m->kind));
	done = done && TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, is_float ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
	done = done && TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, (uint16_t)m->channels);
	if (0 == m->channels % 2) done = done && TIFFSetField(t, TIFFTAG_EXTRASAMPLES, 1, &unassociated);
	done = done && TIFFSetField(t, TIFFTAG_PHOTOMETRIC, rgb ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
	done = done && TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
	done = done && TIFFSetField(t, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
	done = done && TIFFSetField(t, TIFFTAG_PREDICTOR, is_float ? PREDICTOR_FLOATINGPOINT : PREDICTOR_HORIZONTAL);
	done = done && TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, TIFFDefaultStripSize(t, 0));
	done = done && TIFFSetField(t, TIFFTAG_SOFTWARE, "optla") && TIFFSetField(t, TIFFTAG_IMAGEDESCRIPTION, w->description);
	return told(w, done);
}

static optla_status write_row(tiff_writer *w, size_t y)
{
	const optla_image *m = w->image;
	const size_t n = m->width * m->channels;
	if (OPTLA_IMAGE_LINEAR == m->kind) {
		memcpy(w->row, m->data + y * n, n * sizeof *m->data);
	} else {
		OPTLA_TRY(optla_quantise_row_(m, y, OPTLA_IMAGE_DISPLAY == m->kind ? 255 : 65535, w->file, w->integers));
		if (OPTLA_IMAGE_DISPLAY == m->kind)
			for (size_t k = 0; k < n; k++) ((uint8_t *)w->row)[k] = (uint8_t)w->integers[k];
		else
			memcpy(w->row, w->integers, n * sizeof *w->integers);
	}
	return told(w, TIFFWriteScanline(w->tiff, w->row, (uint32_t)y, 0));
}

static optla_status write_all(tiff_writer *w)
{
	const optla_image *m = w->image;
	optla_ctx *ctx = m->ctx;
	const size_t n = m->width * m->channels;
	/* Offsets of classic TIFF end at 4 GiB; deflate can make noise a little larger. */
	const bool big = (double)n * (double)m->height * (bits_of(m->kind) / 8) > 4.1e9;
	w->integers = optla_array_(ctx, n, sizeof *w->integers);
	w->row = w->integers ? optla_array_(ctx, n, sizeof(float)) : NULL;
	if (!w->row) return OPTLA_ERR_NOMEM;
	w->memory = (optla_tiff_memory){.ctx = ctx, .name = w->file->name, .file = w->file};
	w->tiff = optla_tiff_open_(&w->memory, big ? "w8" : "w");
	OPTLA_TRY(told(w, NULL != w->tiff));
	OPTLA_TRY(set_fields(w));
	for (size_t y = 0; y < m->height; y++) OPTLA_TRY(write_row(w, y));
	return told(w, TIFFWriteDirectory(w->tiff));
}

static char *describe(const optla_image *image, const char *provenance)
{
	char white[32];
	optla_white_format_(image->white_dn, white);
	const bool raw = OPTLA_IMAGE_RAW_DN == image->kind;
	return optla_format_(image->ctx, OPTLA_KEY_KIND "=%s\n%s%s%s%s", optla_image_kind_name(image->kind),
	                     raw ? OPTLA_KEY_WHITE "=" : "", raw ? white : "", raw ? "\n" : "", provenance);
}

optla_status optla_tiff_encode_(const optla_image *image, const char *provenance, optla_memory_file *file)
{
	OPTLA_CHECK(image->ctx, image->width <= INT32_MAX && image->height <= INT32_MAX, OPTLA_ERR_ARG,
	            "%s: %zu x %zu pixels are too many for TIFF", file->name, image->width, image->height);
	tiff_writer w = {.image = image, .file = file};
	w.description = describe(image, provenance);
	const optla_status status = w.description ? write_all(&w) : OPTLA_ERR_NOMEM;
	if (w.tiff) TIFFClose(w.tiff);
	optla_free(image->ctx, w.description);
	optla_free(image->ctx, w.integers);
	optla_free(image->ctx, w.row);
	return status;
}
