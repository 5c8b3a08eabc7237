/* SPDX-License-Identifier: BSD-3-Clause */
/* Contact sheets and differences. */
#include "report/panel.h"

#include "report/canvas.h"

#include <math.h>
#include <string.h>

enum { GAP = 10, LINE = 17, CAPTION_PX = 13 };

static size_t caption_lines(const char *caption)
{
	size_t lines = caption && *caption ? 1 : 0;
	for (; caption && *caption; caption++) lines += *caption == '\n';
	return lines;
}

/* Small pictures grow by whole factors, so that their pixels stay square and alike; large ones shrink. */
static double zoom_of(const optla_image *image, size_t cell_px)
{
	const double zoom = (double)cell_px / (double)image->width;
	return zoom >= 1 ? floor(zoom) : zoom;
}

static size_t shown_height(const optla_panel *panel, size_t cell_px)
{
	return panel->image ? (size_t)ceil(zoom_of(panel->image, cell_px) * (double)panel->image->height) : 0;
}

/* Height of the pictures and number of caption lines of one row. */
static void row_size(const optla_panel *panels, size_t count, size_t cell_px, size_t *height, size_t *lines)
{
	*height = *lines = 0;
	for (size_t k = 0; k < count; k++) {
		*height = optla_max_(*height, shown_height(&panels[k], cell_px));
		*lines = optla_max_(*lines, caption_lines(panels[k].caption));
	}
}

static void draw_caption(cairo_t *canvas, double x, double y, const char *caption)
{
	char line[256];
	while (caption && *caption) {
		const size_t n = strcspn(caption, "\n");
		snprintf(line, sizeof line, "%.*s", (int)n, caption);
		optla_canvas_text_(canvas, x, y, (optla_font){.size_px = CAPTION_PX}, line);
		caption += n + (caption[n] == '\n');
		y += LINE;
	}
}

static optla_status draw_row(optla_ctx *ctx, cairo_t *canvas, const optla_panel *panels, size_t count, size_t cell_px, double y)
{
	size_t height, lines;
	row_size(panels, count, cell_px, &height, &lines);
	for (size_t k = 0; k < count; k++) {
		const double x = (double)(GAP + k * (cell_px + GAP));
		if (panels[k].image) {
			const double zoom = zoom_of(panels[k].image, cell_px);
			OPTLA_TRY(optla_canvas_image_(ctx, canvas, panels[k].image, x, y, zoom));
			/* a hair line around it: pictures may be as white as the sheet */
			optla_canvas_colour_(canvas, 0xcccccc);
			cairo_set_line_width(canvas, 1);
			cairo_rectangle(canvas, x - 0.5, y - 0.5, zoom * (double)panels[k].image->width + 1,
			                zoom * (double)panels[k].image->height + 1);
			cairo_stroke(canvas);
		}
		optla_canvas_colour_(canvas, 0x222222);
		draw_caption(canvas, x, y + (double)height + LINE - 3, panels[k].caption);
	}
	return OPTLA_OK;
}

optla_status optla_panel_sheet_(optla_ctx *ctx, const optla_panel *panels, size_t count, size_t columns, size_t cell_px,
                                optla_image **out)
{
	*out = NULL;
	OPTLA_CHECK(ctx, count && columns && cell_px, OPTLA_ERR_ARG,
	            "a sheet of %zu pictures, %zu in a row, %zu pixels wide: none may be 0", count, columns, cell_px);
	size_t height, lines, total = GAP;
	for (size_t k = 0; k < count; k += columns) {
		row_size(panels + k, optla_min_(columns, count - k), cell_px, &height, &lines);
		total += height + lines * LINE + GAP;
	}
	cairo_t *canvas;
	OPTLA_TRY(optla_canvas_begin_(ctx, GAP + columns * (cell_px + GAP), total, &canvas));
	optla_status s = OPTLA_OK;
	double y = GAP;
	for (size_t k = 0; k < count && OPTLA_OK == s; k += columns) {
		const size_t n = optla_min_(columns, count - k);
		s = draw_row(ctx, canvas, panels + k, n, cell_px, y);
		row_size(panels + k, n, cell_px, &height, &lines);
		y += (double)(height + lines * LINE + GAP);
	}
	const optla_status finished = optla_canvas_finish_(ctx, &canvas, OPTLA_OK == s ? out : NULL);
	return OPTLA_OK == s ? finished : s;
}

optla_status optla_panel_difference_(const optla_image *a, const optla_image *b, double exposure, double amplification,
                                     optla_image **out)
{
	*out = NULL;
	OPTLA_CHECK(a->ctx, a->kind == OPTLA_IMAGE_LINEAR && b->kind == OPTLA_IMAGE_LINEAR, OPTLA_ERR_ARG,
	            "a difference needs linear pictures, these are %s and %s", optla_image_kind_name(a->kind),
	            optla_image_kind_name(b->kind));
	OPTLA_CHECK(a->ctx, a->width == b->width && a->height == b->height && a->channels == b->channels, OPTLA_ERR_SHAPE,
	            "a difference of %zu x %zu x %zu and %zu x %zu x %zu samples", a->width, a->height, a->channels, b->width,
	            b->height, b->channels);
	OPTLA_TRY(optla_image_copy(a, out));
	const size_t count = a->width * a->height * a->channels;
	for (size_t k = 0; k < count; k++) (*out)->data[k] = fabsf(a->data[k] - b->data[k]);
	const optla_status s = optla_image_to_display(*out, exposure * amplification);
	if (OPTLA_OK != s) optla_image_destroy(out);
	return s;
}
