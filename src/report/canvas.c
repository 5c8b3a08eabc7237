/* SPDX-License-Identifier: BSD-3-Clause */
/* Cairo surfaces to and from images. */
#include "report/canvas.h"

#include "report/text.h"

#include <math.h>
#include <string.h>

static optla_status cairo_failed(optla_ctx *ctx, cairo_status_t status)
{
	return OPTLA_FAIL(ctx, status == CAIRO_STATUS_NO_MEMORY ? OPTLA_ERR_NOMEM : OPTLA_ERR_DEVICE, "drawing failed: %s",
	                  cairo_status_to_string(status));
}

optla_status optla_canvas_begin_(optla_ctx *ctx, size_t width, size_t height, cairo_t **out)
{
	*out = NULL;
	OPTLA_CHECK(ctx, width >= 1 && height >= 1 && width <= 32767 && height <= 32767, OPTLA_ERR_ARG,
	            "a drawing of %zu x %zu pixels: each side must be from 1 to 32767", width, height);
	cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width, (int)height);
	cairo_t *canvas = cairo_create(surface);
	cairo_surface_destroy(surface); /* the canvas holds its own reference */
	if (cairo_status(canvas)) {
		const optla_status s = cairo_failed(ctx, cairo_status(canvas));
		cairo_destroy(canvas);
		return s;
	}
	optla_canvas_colour_(canvas, 0xffffff);
	cairo_paint(canvas);
	*out = canvas;
	return OPTLA_OK;
}

/* Surface pixels are native-endian 0x00rrggbb. */
static void read_surface(cairo_surface_t *surface, optla_image *image)
{
	const unsigned char *bytes = cairo_image_surface_get_data(surface);
	const size_t stride = (size_t)cairo_image_surface_get_stride(surface);
	for (size_t y = 0; y < image->height; y++)
		for (size_t x = 0; x < image->width; x++) {
			uint32_t pixel;
			memcpy(&pixel, bytes + y * stride + 4 * x, 4);
			float *sample = image->data + 3 * (y * image->width + x);
			for (int c = 0; c < 3; c++) sample[c] = (float)((pixel >> (16 - 8 * c)) & 255) / 255;
		}
}

optla_status optla_canvas_finish_(optla_ctx *ctx, cairo_t **canvas, optla_image **out)
{
	if (out) *out = NULL;
	if (!*canvas) return OPTLA_OK;
	cairo_surface_t *surface = cairo_get_target(*canvas);
	cairo_surface_flush(surface);
	optla_status s = OPTLA_OK;
	if (out && cairo_status(*canvas)) s = cairo_failed(ctx, cairo_status(*canvas));
	if (out && OPTLA_OK == s)
		s = optla_image_create(ctx, (size_t)cairo_image_surface_get_width(surface),
		                       (size_t)cairo_image_surface_get_height(surface), 3, OPTLA_IMAGE_DISPLAY, out);
	if (out && *out) read_surface(surface, *out);
	cairo_destroy(*canvas);
	*canvas = NULL;
	return s;
}

void optla_canvas_colour_(cairo_t *canvas, unsigned colour)
{
	cairo_set_source_rgb(canvas, (colour >> 16 & 255) / 255.0, (colour >> 8 & 255) / 255.0, (colour & 255) / 255.0);
}

/* Cairo stops drawing for good at the first malformed byte, so text is cleaned (and cut at the buffer's end) before. */
static void set_font(cairo_t *canvas, optla_font font, const char *text, char clean[512])
{
	size_t used = 0;
	while (text && *text) {
		const size_t n = optla_utf8_length_(text);
		if (used + 5 > 512) break;
		if (n)
			memcpy(clean + used, text, n);
		else
			clean[used] = '?';
		used += n ? n : 1;
		text += n ? n : 1;
	}
	clean[used] = 0;
	cairo_select_font_face(canvas, "sans", CAIRO_FONT_SLANT_NORMAL,
	                       font.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
	cairo_set_font_size(canvas, font.size_px);
}

double optla_canvas_text_width_(cairo_t *canvas, optla_font font, const char *text)
{
	char clean[512];
	cairo_text_extents_t extents;
	set_font(canvas, font, text, clean);
	cairo_text_extents(canvas, clean, &extents);
	return extents.x_advance;
}

void optla_canvas_text_(cairo_t *canvas, double x, double y, optla_font font, const char *text)
{
	char clean[512];
	cairo_text_extents_t extents;
	set_font(canvas, font, text, clean);
	cairo_text_extents(canvas, clean, &extents);
	cairo_move_to(canvas, x - font.align * extents.x_advance, y);
	cairo_show_text(canvas, clean);
}

static uint32_t display_byte(float value)
{
	return (uint32_t)lrint(255 * optla_clamp_(isfinite(value) ? (double)value : 0, 0, 1));
}

optla_status optla_canvas_image_(optla_ctx *ctx, cairo_t *canvas, const optla_image *image, double x, double y, double zoom)
{
	OPTLA_CHECK(ctx, image->kind == OPTLA_IMAGE_DISPLAY && (image->channels == 1 || image->channels == 3), OPTLA_ERR_ARG,
	            "a drawing takes display-referred pictures of 1 or 3 channels, this one is %s with %zu",
	            optla_image_kind_name(image->kind), image->channels);
	cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)image->width, (int)image->height);
	if (cairo_surface_status(surface)) {
		const optla_status s = cairo_failed(ctx, cairo_surface_status(surface));
		cairo_surface_destroy(surface);
		return s;
	}
	unsigned char *bytes = cairo_image_surface_get_data(surface);
	const size_t stride = (size_t)cairo_image_surface_get_stride(surface);
	for (size_t row = 0; row < image->height; row++)
		for (size_t column = 0; column < image->width; column++) {
			const float *v = image->data + image->channels * (row * image->width + column);
			const bool grey = image->channels == 1;
			const uint32_t pixel = display_byte(v[0]) << 16 | display_byte(v[grey ? 0 : 1]) << 8 | display_byte(v[grey ? 0 : 2]);
			memcpy(bytes + row * stride + 4 * column, &pixel, 4);
		}
	cairo_surface_mark_dirty(surface);
	cairo_save(canvas);
	cairo_translate(canvas, x, y);
	cairo_scale(canvas, zoom, zoom);
	cairo_set_source_surface(canvas, surface, 0, 0);
	cairo_pattern_set_filter(cairo_get_source(canvas), zoom < 1 ? CAIRO_FILTER_GOOD : CAIRO_FILTER_NEAREST);
	cairo_rectangle(canvas, 0, 0, (double)image->width, (double)image->height);
	cairo_fill(canvas);
	cairo_restore(canvas);
	cairo_surface_destroy(surface);
	return OPTLA_OK;
}
