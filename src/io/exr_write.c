/* SPDX-License-Identifier: BSD-3-Clause */
/* Writing OpenEXR through OpenEXRCore: one part, 32-bit floats, scanlines, ZIP. */
#include "io/image_codec.h"

#include <openexr.h>

typedef struct {
	const optla_image *image;
	optla_memory_file *file;
	exr_context_t exr;
	exr_encode_pipeline_t pipeline;
	bool started;
} exr_writer;

static int64_t on_write(exr_const_context_t exr, void *user, const void *bytes, uint64_t count, uint64_t offset,
                        exr_stream_error_func_ptr_t fail)
{
	exr_writer *w = user;
	w->file->at = (size_t)offset;
	(void)exr;
	(void)fail;
	return optla_memory_file_write_(w->file, bytes, (size_t)count) ? (int64_t)count : -1;
}

/* With a handler of its own the library doesn't remove a file of the name given to exr_start_write(). */
static void on_destroy(exr_const_context_t exr, void *user, int failed)
{
	(void)exr;
	(void)user;
	(void)failed;
}

/* While writing, the library calls this with its lock held, which exr_get_user_data() would wait for: the text can't be kept, the code
   of the failed call says enough. Without a handler the library would print. */
static void on_error(exr_const_context_t exr, exr_result_t code, const char *message)
{
	(void)exr;
	(void)code;
	(void)message;
}

static optla_status told(const exr_writer *w, exr_result_t result)
{
	if (EXR_ERR_SUCCESS == result) return OPTLA_OK;
	if (w->file->failed) return OPTLA_ERR_NOMEM; /* told already */
	return OPTLA_FAIL(w->image->ctx, EXR_ERR_OUT_OF_MEMORY == result ? OPTLA_ERR_NOMEM : OPTLA_ERR_IO, "%s: OpenEXR: %s",
	                  w->file->name, exr_get_default_error_message(result));
}

/* The library wants the channels in the order of the alphabet and gives them back so. */
static const char *const names[4][4] = {{"Y"}, {"A", "Y"}, {"B", "G", "R"}, {"A", "B", "G", "R"}};
static const size_t places[4][4] = {{0}, {1, 0}, {2, 1, 0}, {3, 2, 1, 0}};

static optla_status write_header(exr_writer *w, const char *provenance)
{
	const optla_image *image = w->image;
	int part = 0;
	char white[32];
	OPTLA_TRY(told(w, exr_add_part(w->exr, NULL, EXR_STORAGE_SCANLINE, &part)));
	OPTLA_TRY(told(w, exr_initialize_required_attr_simple(w->exr, part, (int32_t)image->width, (int32_t)image->height,
	                                                      EXR_COMPRESSION_ZIP)));
	for (size_t c = 0; c < image->channels; c++)
		OPTLA_TRY(told(
		    w, exr_add_channel(w->exr, part, names[image->channels - 1][c], EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1)));
	OPTLA_TRY(told(w, exr_attr_set_string(w->exr, part, OPTLA_KEY_KIND, optla_image_kind_name(image->kind))));
	OPTLA_TRY(told(w, exr_attr_set_string(w->exr, part, OPTLA_KEY_PROVENANCE, provenance)));
	optla_white_format_(image->white_dn, white);
	if (OPTLA_IMAGE_RAW_DN == image->kind) OPTLA_TRY(told(w, exr_attr_set_string(w->exr, part, OPTLA_KEY_WHITE, white)));
	return told(w, exr_write_header(w->exr));
}

static optla_status write_chunk(exr_writer *w, size_t y)
{
	const optla_image *image = w->image;
	exr_encode_pipeline_t *p = &w->pipeline;
	exr_chunk_info_t chunk;
	OPTLA_TRY(told(w, exr_write_scanline_chunk_info(w->exr, 0, (int)y, &chunk)));
	OPTLA_TRY(told(w, w->started ? exr_encoding_update(w->exr, 0, &chunk, p) : exr_encoding_initialize(w->exr, 0, &chunk, p)));
	for (size_t c = 0; c < image->channels; c++) {
		exr_coding_channel_info_t *channel = &p->channels[c];
		const float *first = image->data + y * image->width * image->channels + places[image->channels - 1][c];
		channel->encode_from_ptr = (const uint8_t *)first;
		channel->user_bytes_per_element = sizeof(float);
		channel->user_data_type = EXR_PIXEL_FLOAT;
		channel->user_pixel_stride = (int32_t)(image->channels * sizeof(float));
		channel->user_line_stride = (int32_t)(image->width * image->channels * sizeof(float));
	}
	if (!w->started) OPTLA_TRY(told(w, exr_encoding_choose_default_routines(w->exr, 0, p)));
	w->started = true;
	return told(w, exr_encoding_run(w->exr, 0, p));
}

static optla_status write_all(exr_writer *w, const char *provenance)
{
	exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
	init.error_handler_fn = on_error;
	init.user_data = w;
	init.write_fn = on_write;
	init.destroy_fn = on_destroy;
	OPTLA_TRY(told(w, exr_start_write(&w->exr, "memory", EXR_WRITE_FILE_DIRECTLY, &init)));
	OPTLA_TRY(told(w, exr_set_longname_support(w->exr, 1)));
	OPTLA_TRY(write_header(w, provenance));
	int32_t lines = 0;
	OPTLA_TRY(told(w, exr_get_scanlines_per_chunk(w->exr, 0, &lines)));
	for (size_t y = 0; y < w->image->height; y += (size_t)lines) OPTLA_TRY(write_chunk(w, y));
	return OPTLA_OK;
}

optla_status optla_exr_encode_(const optla_image *image, const char *provenance, optla_memory_file *file)
{
	/* Strides are 32-bit numbers in the library. */
	OPTLA_CHECK(image->ctx, image->width <= INT32_MAX / (4 * sizeof(float)) && image->height <= INT32_MAX, OPTLA_ERR_ARG,
	            "%s: %zu x %zu pixels are too many for OpenEXR", file->name, image->width, image->height);
	exr_writer w = {.image = image, .file = file};
	optla_status status = write_all(&w, provenance);
	if (w.pipeline.context) exr_encoding_destroy(w.exr, &w.pipeline);
	if (w.exr) {
		const exr_result_t finished = exr_finish(&w.exr);
		if (OPTLA_OK == status) status = told(&w, finished);
	}
	return status;
}
