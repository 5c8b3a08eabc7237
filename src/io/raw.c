/* SPDX-License-Identifier: BSD-3-Clause */
/* Camera RAW. LibRaw decodes the sensor's counts; the colours between the sensor's filters are interpolated here.

   Light transport is linear, and so must be the way from counts to an image. LibRaw's own development subtracts black, scales, and its
   better interpolations choose directions by content; its linear one rounds down. Here a missing colour is the mean of the pixels of
   that colour among the 3 x 3 neighbours, those beside, above and below counting twice: for a Bayer filter that is bilinear
   interpolation. Nothing is subtracted, scaled, rotated or balanced. */
#include "io/image_codec.h"
#include "io/tiff_extent.h"

#include <libraw/libraw.h>
#include <string.h>

enum { PERIOD = 48 }; /* a whole number of repeats of every filter pattern that LibRaw knows: 2 x 8, 6 x 6, 16 x 16 */

typedef struct {
	const optla_source *source;
	libraw_data_t *raw;
	bool not_raw; /* a TIFF after all */
	bool damaged; /* LibRaw met the end of the file, or codes that can't be, and went on */
	size_t width, height;
	uint8_t channel[PERIOD][PERIOD]; /* of the filter on a pixel */
	optla_image *image;
} raw_reader;

static void on_damage(void *user, const char *file, const int offset)
{
	(void)file;
	(void)offset;
	((raw_reader *)user)->damaged = true;
}

static optla_status told(const raw_reader *r, int result)
{
	optla_ctx *ctx = r->source->ctx;
	if (r->damaged)
		return OPTLA_FAIL(ctx, OPTLA_ERR_INPUT, "%s: camera RAW: the file ends too early or its data are damaged",
		                  r->source->name);
	if (LIBRAW_SUCCESS == result) return OPTLA_OK;
	const bool memory = LIBRAW_UNSUFFICIENT_MEMORY == result;
	return OPTLA_FAIL(ctx, memory ? OPTLA_ERR_NOMEM : OPTLA_ERR_INPUT, "%s: camera RAW: %s", r->source->name,
	                  libraw_strerror(result));
}

static optla_status check_sizes(raw_reader *r)
{
	const libraw_image_sizes_t *s = &r->raw->sizes;
	OPTLA_CHECK(r->source->ctx,
	            s->width && s->height && s->left_margin + s->width <= s->raw_width && s->top_margin + s->height <= s->raw_height,
	            OPTLA_ERR_INPUT, "%s: camera RAW: a picture of %d x %d pixels at (%d, %d) is not within the sensor of %d x %d",
	            r->source->name, s->width, s->height, s->left_margin, s->top_margin, s->raw_width, s->raw_height);
	const double bytes = (double)s->raw_width * s->raw_height * 4 * sizeof(float);
	OPTLA_CHECK(r->source->ctx, bytes <= (double)optla_ctx_memory_limit(r->source->ctx), OPTLA_ERR_INPUT,
	            "%s: camera RAW: a sensor of %d x %d pixels is over the memory limit", r->source->name, s->raw_width,
	            s->raw_height);
	r->width = s->width;
	r->height = s->height;
	return OPTLA_OK;
}

/* Which colour lies over which pixel. */
static optla_status read_filters(raw_reader *r)
{
	const libraw_iparams_t *p = &r->raw->idata;
	OPTLA_CHECK(r->source->ctx, !r->raw->rawdata.ioparams.fuji_width, OPTLA_ERR_UNSUPPORTED,
	            "%s: camera RAW: a sensor with pixels on the diagonal can't be read", r->source->name);
	for (int y = 0; y < PERIOD; y++)
		for (int x = 0; x < PERIOD; x++) {
			const int code = libraw_COLOR(r->raw, y, x);
			const char letter = code >= 0 && code < 4 ? p->cdesc[code] : 0;
			OPTLA_CHECK(r->source->ctx, 'R' == letter || 'G' == letter || 'B' == letter, OPTLA_ERR_UNSUPPORTED,
			            "%s: camera RAW: the sensor's filters are '%.4s'; red, green and blue can be read", r->source->name,
			            p->cdesc);
			r->channel[y][x] = 'R' == letter ? 0 : 'G' == letter ? 1 : 2;
		}
	return OPTLA_OK;
}

typedef struct {
	const uint8_t *first; /* count of the picture's first pixel */
	size_t pitch;         /* bytes of a row */
} counts;

static counts counts_of(const raw_reader *r, const void *alloc, size_t pixel_bytes)
{
	const libraw_image_sizes_t *s = &r->raw->sizes;
	const size_t pitch = s->raw_pitch >= s->raw_width * pixel_bytes ? s->raw_pitch : s->raw_width * pixel_bytes;
	return (counts){(const uint8_t *)alloc + s->top_margin * pitch + s->left_margin * pixel_bytes, pitch};
}

static uint16_t count_at(counts c, size_t y, size_t index)
{
	uint16_t value;
	memcpy(&value, c.first + y * c.pitch + index * sizeof value, sizeof value);
	return value;
}

/* The three colours of pixel (x, y) from its neighbourhood. */
static void interpolate(const raw_reader *r, counts c, size_t x, size_t y, float rgb[3])
{
	unsigned sum[3] = {0}, weight[3] = {0};
	const size_t x0 = x ? x - 1 : 0, x1 = optla_min_(x + 1, r->width - 1), y0 = y ? y - 1 : 0,
	             y1 = optla_min_(y + 1, r->height - 1);
	for (size_t j = y0; j <= y1; j++)
		for (size_t i = x0; i <= x1; i++) {
			const unsigned w = i == x || j == y ? 2 : 1, channel = r->channel[j % PERIOD][i % PERIOD];
			sum[channel] += w * count_at(c, j, i);
			weight[channel] += w;
		}
	for (size_t k = 0; k < 3; k++) rgb[k] = weight[k] ? (float)sum[k] / (float)weight[k] : 0;
	rgb[r->channel[y % PERIOD][x % PERIOD]] = count_at(c, y, x);
}

static void copy_pixels(const raw_reader *r, counts c, size_t in_pixel)
{
	optla_image *m = r->image;
	for (size_t y = 0; y < r->height; y++)
		for (size_t x = 0; x < r->width; x++)
			for (size_t k = 0; k < m->channels; k++)
				m->data[(y * r->width + x) * m->channels + k] = count_at(c, y, x * in_pixel + k);
}

static optla_status fill_image(raw_reader *r)
{
	const libraw_rawdata_t *data = &r->raw->rawdata;
	const int colours = r->raw->idata.colors;
	const bool mosaic = data->raw_image && 1 != colours;
	OPTLA_CHECK(r->source->ctx, data->raw_image || data->color3_image || data->color4_image, OPTLA_ERR_UNSUPPORTED,
	            "%s: camera RAW: its samples aren't 16-bit counts", r->source->name);
	OPTLA_CHECK(r->source->ctx, 1 == colours || 3 == colours, OPTLA_ERR_UNSUPPORTED,
	            "%s: camera RAW: %d colours; 1 and 3 can be read", r->source->name, colours);
	if (mosaic) OPTLA_TRY(read_filters(r));
	OPTLA_TRY(optla_image_start_(r->source, r->width, r->height, (uint64_t)colours, OPTLA_IMAGE_RAW_DN, &r->image));
	r->image->white_dn = r->raw->color.maximum;
	if (!mosaic) {
		const size_t in_pixel = data->raw_image ? 1 : data->color3_image ? 3 : 4;
		const void *alloc = data->raw_image      ? (const void *)data->raw_image
		                    : data->color3_image ? (const void *)data->color3_image
		                                         : (const void *)data->color4_image;
		copy_pixels(r, counts_of(r, alloc, in_pixel * sizeof(uint16_t)), in_pixel);
		return OPTLA_OK;
	}
	const counts c = counts_of(r, data->raw_image, sizeof(uint16_t));
	for (size_t y = 0; y < r->height; y++)
		for (size_t x = 0; x < r->width; x++) interpolate(r, c, x, y, r->image->data + 3 * (y * r->width + x));
	return OPTLA_OK;
}

static optla_status read_all(raw_reader *r)
{
	const optla_source *s = r->source;
	const size_t limit_mb = optla_ctx_memory_limit(s->ctx) >> 20;
	libraw_set_dataerror_handler(r->raw, on_damage, r);
	r->raw->params.max_raw_memory_mb = (unsigned)optla_max_(1, optla_min_(limit_mb, 1u << 20));
	r->damaged = !optla_dng_is_whole_(s->data, s->count);
	OPTLA_TRY(told(r, LIBRAW_SUCCESS));
	const int opened = libraw_open_buffer(r->raw, (void *)(uintptr_t)s->data, s->count);
	r->not_raw = LIBRAW_FILE_UNSUPPORTED == opened && !r->damaged && s->data[0] == s->data[1];
	if (r->not_raw) return OPTLA_ERR_UNSUPPORTED;
	OPTLA_TRY(told(r, opened));
	OPTLA_TRY(check_sizes(r));
	OPTLA_TRY(told(r, libraw_unpack(r->raw)));
	OPTLA_TRY(check_sizes(r)); /* decoders may correct them */
	optla_log_(s->ctx, 1, "%s: %s %s, black level %u, white level %u", s->name, r->raw->idata.make, r->raw->idata.model,
	           r->raw->color.black, r->raw->color.maximum);
	return fill_image(r);
}

optla_status optla_raw_decode_(const optla_source *source, optla_image **out)
{
	*out = NULL;
	raw_reader r = {.source = source};
	r.raw = libraw_init(LIBRAW_OPIONS_NO_DATAERR_CALLBACK | LIBRAW_OPIONS_NO_MEMERR_CALLBACK);
	const optla_status status = r.raw ? read_all(&r) : OPTLA_FAIL(source->ctx, OPTLA_ERR_NOMEM, "LibRaw has no memory");
	if (r.raw) libraw_close(r.raw);
	/* Scanners and cameras' developed pictures have makes and sub-directories too. */
	if (r.not_raw) return optla_tiff_decode_(source, out);
	if (OPTLA_OK != status) optla_image_destroy(&r.image);
	*out = r.image;
	return status;
}
