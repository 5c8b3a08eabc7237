/* SPDX-License-Identifier: BSD-3-Clause */
/* OpenEXR through OpenEXRCore: the first part, scanlines or tiles of the finest level, any lossless or lossy compression that the
   library decodes. The image is the display window: pixels that the data window doesn't cover are zero, those outside are dropped. */
#include "io/image_codec.h"

#include <openexr.h>
#include <string.h>

enum { MOST_CHANNELS = 4, PART = 0 };

typedef struct {
	const optla_source *source;
	exr_context_t file;
	char message[512]; /* what the library said last */
	exr_attr_box2i_t data, display;
	uint64_t width, height; /* of the data window */
	size_t channels;
	const char *names[MOST_CHANNELS];
	optla_image *image;
	float *pixels, *scratch; /* the data window's samples: the image's own or scratch */
	exr_decode_pipeline_t pipeline;
	bool started;
} exr_reader;

static int64_t on_read(exr_const_context_t file, void *user, void *to, uint64_t count, uint64_t offset,
                       exr_stream_error_func_ptr_t fail)
{
	const exr_reader *r = user;
	(void)file;
	(void)fail;
	/* As pread(): fewer bytes at the end. The library asks for more than it needs of the header, and elsewhere checks the count. */
	if (offset >= r->source->count) return 0;
	const size_t n = optla_min_((size_t)count, r->source->count - (size_t)offset);
	memcpy(to, r->source->data + offset, n);
	return (int64_t)n;
}

static int64_t on_size(exr_const_context_t file, void *user)
{
	(void)file;
	return (int64_t)((const exr_reader *)user)->source->count;
}

static void on_error(exr_const_context_t file, exr_result_t code, const char *message)
{
	void *user = NULL;
	(void)code;
	if (!file || EXR_ERR_SUCCESS != exr_get_user_data(file, &user) || !user) return;
	exr_reader *r = user;
	snprintf(r->message, sizeof r->message, "%s", message);
}

/* A result of the library as our status. */
static optla_status told(const exr_reader *r, exr_result_t result)
{
	if (EXR_ERR_SUCCESS == result) return OPTLA_OK;
	const char *text = *r->message ? r->message : exr_get_default_error_message(result);
	const optla_status code = EXR_ERR_FEATURE_NOT_IMPLEMENTED == result ? OPTLA_ERR_UNSUPPORTED
	                          : EXR_ERR_OUT_OF_MEMORY == result         ? OPTLA_ERR_NOMEM
	                                                                    : OPTLA_ERR_INPUT;
	return OPTLA_FAIL(r->source->ctx, code, "%s: OpenEXR: %s", r->source->name, text);
}

static const exr_attr_chlist_entry_t *find(const exr_attr_chlist_t *list, const char *name)
{
	for (int k = 0; k < list->num_channels; k++)
		if (!strcmp(list->entries[k].name.str, name)) return &list->entries[k];
	return NULL;
}

static void list_names(const exr_attr_chlist_t *list, char *text, size_t bytes)
{
	size_t used = 0;
	for (int k = 0; k < list->num_channels && used < bytes; k++)
		used += (size_t)snprintf(text + used, bytes - used, "%s%s", k ? ", " : "", list->entries[k].name.str);
}

/* RGB, else Y, each with A if there is one; other channels (depth, layers) are left out. */
static optla_status choose_channels(exr_reader *r)
{
	static const char *const wanted[2][3] = {{"R", "G", "B"}, {"Y"}};
	static const size_t counts[2] = {3, 1};
	const exr_attr_chlist_t *list = NULL;
	OPTLA_TRY(told(r, exr_get_channels(r->file, PART, &list)));
	for (size_t set = 0; set < 2 && !r->channels; set++) {
		size_t found = 0;
		while (found < counts[set] && find(list, wanted[set][found])) found++;
		if (found < counts[set]) continue;
		for (size_t c = 0; c < found; c++) r->names[c] = wanted[set][c];
		r->channels = found;
	}
	if (!r->channels) {
		char names[256] = "";
		list_names(list, names, sizeof names);
		return OPTLA_FAIL(r->source->ctx, OPTLA_ERR_INPUT, "%s: OpenEXR: neither R, G, B nor Y is among its channels (%s)",
		                  r->source->name, names);
	}
	if (find(list, "A")) r->names[r->channels++] = "A";
	for (size_t c = 0; c < r->channels; c++) {
		const exr_attr_chlist_entry_t *e = find(list, r->names[c]);
		OPTLA_CHECK(r->source->ctx, 1 == e->x_sampling && 1 == e->y_sampling, OPTLA_ERR_UNSUPPORTED,
		            "%s: OpenEXR: channel %s is subsampled by %d x %d, which can't be read", r->source->name, r->names[c],
		            e->x_sampling, e->y_sampling);
	}
	return OPTLA_OK;
}

static bool attribute(const exr_reader *r, const char *key, char *text, size_t bytes)
{
	const exr_attribute_t *a = NULL;
	if (EXR_ERR_SUCCESS != exr_get_attribute_by_name(r->file, PART, key, &a) || !a || EXR_ATTR_STRING != a->type) return false;
	if (a->string->length < 0 || (size_t)a->string->length >= bytes) return false;
	memcpy(text, a->string->str, (size_t)a->string->length);
	text[a->string->length] = 0;
	return true;
}

static optla_status check_windows(exr_reader *r)
{
	optla_ctx *ctx = r->source->ctx;
	OPTLA_TRY(told(r, exr_get_data_window(r->file, PART, &r->data)));
	OPTLA_TRY(told(r, exr_get_display_window(r->file, PART, &r->display)));
	const exr_attr_box2i_t boxes[2] = {r->data, r->display};
	for (int k = 0; k < 2; k++)
		OPTLA_CHECK(ctx, boxes[k].min.x <= boxes[k].max.x && boxes[k].min.y <= boxes[k].max.y, OPTLA_ERR_INPUT,
		            "%s: OpenEXR: its %s window (%d, %d) to (%d, %d) is empty", r->source->name, k ? "display" : "data",
		            boxes[k].min.x, boxes[k].min.y, boxes[k].max.x, boxes[k].max.y);
	r->width = (uint64_t)((int64_t)r->data.max.x - r->data.min.x + 1);
	r->height = (uint64_t)((int64_t)r->data.max.y - r->data.min.y + 1);
	const double bytes = (double)r->width * (double)r->height * (double)r->channels * sizeof(float);
	/* Strides are 32-bit numbers in the library. */
	OPTLA_CHECK(ctx, bytes <= (double)optla_ctx_memory_limit(ctx) && r->width <= INT32_MAX / (MOST_CHANNELS * sizeof(float)),
	            OPTLA_ERR_INPUT, "%s: OpenEXR: its data window of %llu x %llu pixels is over the memory limit of %.3g GiB",
	            r->source->name, (unsigned long long)r->width, (unsigned long long)r->height,
	            (double)optla_ctx_memory_limit(ctx) / 0x1p30);
	return OPTLA_OK;
}

/* The image, and where to decode: into it if the windows are the same, else beside it. */
static optla_status make_image(exr_reader *r)
{
	char text[64];
	optla_image_kind kind = OPTLA_IMAGE_LINEAR;
	if (attribute(r, OPTLA_KEY_KIND, text, sizeof text)) optla_image_kind_parse_(text, &kind);
	const uint64_t width = (uint64_t)((int64_t)r->display.max.x - r->display.min.x + 1),
	               height = (uint64_t)((int64_t)r->display.max.y - r->display.min.y + 1);
	OPTLA_TRY(optla_image_start_(r->source, width, height, r->channels, kind, &r->image));
	if (OPTLA_IMAGE_RAW_DN == kind)
		r->image->white_dn = optla_white_parse_(attribute(r, OPTLA_KEY_WHITE, text, sizeof text) ? text : NULL, 65535);
	const exr_attribute_t *made = NULL;
	if (EXR_ERR_SUCCESS == exr_get_attribute_by_name(r->file, PART, OPTLA_KEY_PROVENANCE, &made) && made &&
	    EXR_ATTR_STRING == made->type && made->string->length > 0)
		OPTLA_TRY(optla_image_take_provenance_(r->image, made->string->str, (size_t)made->string->length));
	if (!memcmp(&r->data, &r->display, sizeof r->data)) {
		r->pixels = r->image->data;
		return OPTLA_OK;
	}
	r->scratch = optla_array_(r->source->ctx, r->width * r->height * r->channels, sizeof *r->scratch);
	r->pixels = r->scratch;
	return r->scratch ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

/* Decodes one chunk to pixel (x, y) of the data window. */
static optla_status decode_chunk(exr_reader *r, const exr_chunk_info_t *chunk, uint64_t x, uint64_t y)
{
	exr_decode_pipeline_t *p = &r->pipeline;
	const size_t limit = optla_ctx_memory_limit(r->source->ctx);
	OPTLA_CHECK(r->source->ctx, chunk->unpacked_size <= limit && chunk->packed_size <= limit, OPTLA_ERR_INPUT,
	            "%s: OpenEXR: a block of %llu bytes is over the memory limit", r->source->name,
	            (unsigned long long)chunk->unpacked_size);
	OPTLA_CHECK(r->source->ctx,
	            chunk->width >= 0 && chunk->height >= 0 && x + (uint64_t)chunk->width <= r->width &&
	                y + (uint64_t)chunk->height <= r->height,
	            OPTLA_ERR_INPUT, "%s: OpenEXR: a block of %d x %d pixels at (%llu, %llu) is outside the data window",
	            r->source->name, chunk->width, chunk->height, (unsigned long long)x, (unsigned long long)y);
	OPTLA_TRY(
	    told(r, r->started ? exr_decoding_update(r->file, PART, chunk, p) : exr_decoding_initialize(r->file, PART, chunk, p)));
	for (int k = 0; k < p->channel_count; k++) {
		exr_coding_channel_info_t *channel = &p->channels[k];
		channel->decode_to_ptr = NULL;
		for (size_t c = 0; c < r->channels; c++) {
			if (strcmp(channel->channel_name, r->names[c])) continue;
			channel->decode_to_ptr = (uint8_t *)(r->pixels + (y * r->width + x) * r->channels + c);
			channel->user_pixel_stride = (int32_t)(r->channels * sizeof(float));
			channel->user_line_stride = (int32_t)(r->width * r->channels * sizeof(float));
			channel->user_bytes_per_element = sizeof(float);
			channel->user_data_type = EXR_PIXEL_FLOAT;
		}
	}
	if (!r->started) OPTLA_TRY(told(r, exr_decoding_choose_default_routines(r->file, PART, p)));
	r->started = true;
	return told(r, exr_decoding_run(r->file, PART, p));
}

static optla_status read_scanlines(exr_reader *r)
{
	int32_t lines = 0;
	OPTLA_TRY(told(r, exr_get_scanlines_per_chunk(r->file, PART, &lines)));
	OPTLA_CHECK(r->source->ctx, lines >= 1, OPTLA_ERR_INPUT, "%s: OpenEXR: %d lines in a block", r->source->name, lines);
	for (uint64_t y = 0; y < r->height; y += (uint64_t)lines) {
		exr_chunk_info_t chunk;
		OPTLA_TRY(told(r, exr_read_scanline_chunk_info(r->file, PART, (int)(r->data.min.y + (int64_t)y), &chunk)));
		OPTLA_TRY(decode_chunk(r, &chunk, 0, y));
	}
	return OPTLA_OK;
}

static optla_status read_tiles(exr_reader *r)
{
	int32_t width = 0, height = 0;
	OPTLA_TRY(told(r, exr_get_tile_sizes(r->file, PART, 0, 0, &width, &height)));
	OPTLA_CHECK(r->source->ctx, width >= 1 && height >= 1, OPTLA_ERR_INPUT, "%s: OpenEXR: tiles of %d x %d pixels",
	            r->source->name, width, height);
	for (uint64_t ty = 0; ty * (uint64_t)height < r->height; ty++)
		for (uint64_t tx = 0; tx * (uint64_t)width < r->width; tx++) {
			exr_chunk_info_t chunk;
			OPTLA_TRY(told(r, exr_read_tile_chunk_info(r->file, PART, (int)tx, (int)ty, 0, 0, &chunk)));
			OPTLA_TRY(decode_chunk(r, &chunk, tx * (uint64_t)width, ty * (uint64_t)height));
		}
	return OPTLA_OK;
}

/* Copies what both windows cover. */
static void place_in_display(const exr_reader *r)
{
	const int64_t dx = (int64_t)r->display.min.x - r->data.min.x, dy = (int64_t)r->display.min.y - r->data.min.y;
	for (size_t y = 0; y < r->image->height; y++) {
		const int64_t from_y = (int64_t)y + dy;
		if (from_y < 0 || (uint64_t)from_y >= r->height) continue;
		const int64_t first = dx < 0 ? -dx : 0, end_x = (int64_t)r->width - dx;
		const int64_t end = end_x < (int64_t)r->image->width ? end_x : (int64_t)r->image->width;
		if (first >= end) continue;
		memcpy(r->image->data + (y * r->image->width + (size_t)first) * r->channels,
		       r->scratch + ((uint64_t)from_y * r->width + (uint64_t)(first + dx)) * r->channels,
		       (size_t)(end - first) * r->channels * sizeof(float));
	}
}

static optla_status read_all(exr_reader *r)
{
	exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
	init.error_handler_fn = on_error;
	init.user_data = r;
	init.read_fn = on_read;
	init.size_fn = on_size;
	init.flags = EXR_CONTEXT_FLAG_STRICT_HEADER | EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION; /* no guessing in broken files */
	exr_storage_t storage;
	int parts = 0;
	OPTLA_TRY(told(r, exr_start_read(&r->file, "memory", &init)));
	OPTLA_TRY(told(r, exr_get_count(r->file, &parts)));
	OPTLA_TRY(told(r, exr_get_storage(r->file, PART, &storage)));
	OPTLA_CHECK(r->source->ctx, EXR_STORAGE_SCANLINE == storage || EXR_STORAGE_TILED == storage, OPTLA_ERR_UNSUPPORTED,
	            "%s: OpenEXR: deep images can't be read", r->source->name);
	if (parts > 1) optla_log_(r->source->ctx, 1, "%s: OpenEXR: the first of %d parts is read", r->source->name, parts);
	OPTLA_TRY(choose_channels(r));
	OPTLA_TRY(check_windows(r));
	OPTLA_TRY(make_image(r));
	OPTLA_TRY(EXR_STORAGE_TILED == storage ? read_tiles(r) : read_scanlines(r));
	if (r->scratch) place_in_display(r);
	return OPTLA_OK;
}

optla_status optla_exr_decode_(const optla_source *source, optla_image **out)
{
	*out = NULL;
	exr_reader r = {.source = source};
	const optla_status status = read_all(&r);
	if (r.pipeline.context) exr_decoding_destroy(r.file, &r.pipeline);
	if (r.file) exr_finish(&r.file);
	optla_free(source->ctx, r.scratch);
	if (OPTLA_OK != status) optla_image_destroy(&r.image);
	*out = r.image;
	return status;
}
