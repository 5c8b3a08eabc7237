/* SPDX-License-Identifier: BSD-3-Clause */
/* What the readers and writers of image formats share. Each format decodes from memory and encodes to memory, so that reading files,
   fuzzing and whole-or-not writing are one path each. */
#ifndef OPTLA_IMAGE_CODEC_H
#define OPTLA_IMAGE_CODEC_H

#include "base/base_impl.h"
#include "optla/image.h"

/* The bytes to decode and what to call them in messages. */
typedef struct {
	optla_ctx *ctx;
	const char *name;
	const uint8_t *data;
	size_t count;
} optla_source;

/* A file in memory that libraries read and write through callbacks: a position, and for writing a buffer that grows. */
typedef struct {
	optla_ctx *ctx;
	const char *name; /* of the file to be, for messages */
	uint8_t *data;
	size_t count, capacity, at;
	bool failed; /* memory ran out; reported */
} optla_memory_file;

bool optla_memory_file_write_(optla_memory_file *file, const void *bytes, size_t count); /* at `at`, which moves on */
void optla_memory_file_free_(optla_memory_file *file);

/* ---- what Optla writes beside the samples ---- */

#define OPTLA_KEY_KIND "optla:kind"
#define OPTLA_KEY_WHITE "optla:white_dn"
#define OPTLA_KEY_PROVENANCE "optla:provenance"

/* A kind's name to the kind; false for any other text or NULL. */
bool optla_image_kind_parse_(const char *text, optla_image_kind *kind);
/* White level from text; a missing or senseless one gives fallback. */
double optla_white_parse_(const char *text, double fallback);
void optla_white_format_(double white_dn, char text[32]);

/* Keeps the first `bytes` bytes of what a file says about how it was made. */
optla_status optla_image_take_provenance_(optla_image *image, const char *text, size_t bytes);

/* ---- checks ---- */

/* An image for what a file's header says: sizes over the limit are an OPTLA_ERR_INPUT that names the file. */
optla_status optla_image_start_(const optla_source *source, uint64_t width, uint64_t height, uint64_t channels,
                                optla_image_kind kind, optla_image **out);
/* ---- integer samples: DISPLAY and alpha are 0..1 in the image and 0..largest in files, the others are the same numbers ---- */

/* Row y of an image from 8-bit or (wide) 16-bit integers in the machine's byte order. */
void optla_samples_from_integers_(optla_image *image, const void *row, bool wide, size_t y);
/* Row y rounded to integers 0..largest; those that are 0..1 in the image are clamped first. A sample that doesn't fit, or is NaN, is
   OPTLA_ERR_ARG with its place and value. */
optla_status optla_quantise_row_(const optla_image *image, size_t y, unsigned largest, const optla_memory_file *file,
                                 uint16_t *row);

/* ---- formats: decode reads source, encode fills file (which the caller frees, also after failure) ---- */

optla_status optla_png_decode_(const optla_source *source, optla_image **out);
optla_status optla_png_encode_(const optla_image *image, const char *provenance, optla_memory_file *file);
optla_status optla_tiff_decode_(const optla_source *source, optla_image **out);
optla_status optla_tiff_encode_(const optla_image *image, const char *provenance, optla_memory_file *file);
optla_status optla_exr_decode_(const optla_source *source, optla_image **out);
optla_status optla_exr_encode_(const optla_image *image, const char *provenance, optla_memory_file *file);
optla_status optla_pfm_decode_(const optla_source *source, optla_image **out);
optla_status optla_pfm_encode_(const optla_image *image, optla_memory_file *file);
optla_status optla_raw_decode_(const optla_source *source, optla_image **out);
optla_status optla_npy_image_decode_(const optla_source *source, optla_image **out);
optla_status optla_npy_image_encode_(const optla_image *image, optla_memory_file *file);

#endif
