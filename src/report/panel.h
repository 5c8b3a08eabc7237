/* SPDX-License-Identifier: BSD-3-Clause */
/* Contact sheets of pictures with captions, and pictures of differences. */
#ifndef OPTLA_PANEL_H
#define OPTLA_PANEL_H

#include "base/base_impl.h"
#include "optla/image.h"

typedef struct {
	const optla_image *image; /* DISPLAY, 1 or 3 channels; NULL: an empty place */
	const char *caption;      /* below the picture, '\n' starts a new line; NULL: none */
} optla_panel;

/* Row by row, `columns` in a row, each picture `cell_px` wide (whole zoom factors when it is smaller than that) on white. */
optla_status optla_panel_sheet_(optla_ctx *ctx, const optla_panel *panels, size_t count, size_t columns, size_t cell_px,
                                optla_image **out);

/* display = sRGB(amplification * exposure * |a - b|), channel by channel: black where a and b agree. a, b LINEAR of one shape. */
optla_status optla_panel_difference_(const optla_image *a, const optla_image *b, double exposure, double amplification,
                                     optla_image **out);

#endif
