/* SPDX-License-Identifier: BSD-3-Clause */
/* Drawing with Cairo into DISPLAY images: surface, text and pictures. Text uses Cairo's toy "sans"; on a machine without any font
   Cairo draws with its built-in outlines, so nothing here fails for want of one. */
#ifndef OPTLA_CANVAS_H
#define OPTLA_CANVAS_H

#include "base/base_impl.h"
#include "optla/image.h"

#include <cairo.h>

/* A white surface. OPTLA_ERR_ARG over Cairo's 32767 pixels. */
optla_status optla_canvas_begin_(optla_ctx *ctx, size_t width, size_t height, cairo_t **out);
/* Frees and clears *canvas whatever happens; out NULL: only that. */
optla_status optla_canvas_finish_(optla_ctx *ctx, cairo_t **canvas, optla_image **out);

typedef struct {
	double size_px, align; /* align: 0 = x is the left end, 0.5 the middle, 1 the right end */
	bool bold;
} optla_font;

/* Bytes that aren't UTF-8 are drawn as '?'. y is the baseline. */
void optla_canvas_text_(cairo_t *canvas, double x, double y, optla_font font, const char *text);
double optla_canvas_text_width_(cairo_t *canvas, optla_font font, const char *text);
/* A DISPLAY image of 1 or 3 channels at (x, y), each sample `zoom` pixels wide: enlarged without smoothing. */
optla_status optla_canvas_image_(optla_ctx *ctx, cairo_t *canvas, const optla_image *image, double x, double y, double zoom);
/* colour 0xrrggbb */
void optla_canvas_colour_(cairo_t *canvas, unsigned colour);

#endif
