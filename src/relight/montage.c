/* SPDX-License-Identifier: BSD-3-Clause */
/* The components of a captured transport as one picture, like Fig. 2.6. */
#include "capture/light_spec.h"
#include "optla/relight.h"

#include <math.h>

enum { TILE = 160, GAP = 8, DISC_TILE = 2 * TILE }; /* discs are drawn twice as large and averaged down */

static const float background = 0.88F; /* where there is no light to show */

/* ---- one component as a picture of signed colours ---- */

static optla_status colours(optla_image *values, optla_image **out)
{
	const optla_status s = optla_image_signed_colours(values, 0, out);
	optla_image_destroy(&values);
	return s;
}

/* Samples on the model's own pixels, channels averaged: of photos (count = npixels*channels) or of their grey version. */
static optla_status camera_picture(const optla_model *m, const float *v, size_t count, optla_image **out)
{
	optla_image *grey;
	const size_t channels = count / m->npixels;
	OPTLA_TRY(optla_image_create(m->ctx, m->width, m->height, 1, OPTLA_IMAGE_LINEAR, &grey));
	for (size_t k = 0; k < m->npixels; k++)
		for (size_t c = 0; c < channels; c++) grey->data[m->pixel[k]] += v[c * m->npixels + k] / (float)channels;
	return colours(grey, out);
}

static optla_status grid_picture(optla_ctx *ctx, const float *v, size_t width, size_t height, optla_image **out)
{
	optla_image *grey;
	OPTLA_TRY(optla_image_create(ctx, width, height, 1, OPTLA_IMAGE_LINEAR, &grey));
	for (size_t k = 0; k < width * height; k++) grey->data[k] = v[k];
	return colours(grey, out);
}

/* Angle from the direction towards the camera (0, 0, -1), drawn along the direction's way in the picture. */
static void disc_position(const double d[3], double *x, double *y, double *angle)
{
	const double across = hypot(d[0], d[1]);
	*angle = atan2(across, -d[2]);
	*x = across > 0 ? *angle * d[0] / across : 0;
	*y = across > 0 ? *angle * d[1] / across : 0;
}

static void draw_disc(optla_image *grey, bool *covered, double x, double y, double radius, float value)
{
	const double side = (double)grey->width;
	const size_t x0 = (size_t)optla_clamp_(x - radius, 0, side), x1 = (size_t)optla_clamp_(x + radius + 1, 0, side);
	const size_t y0 = (size_t)optla_clamp_(y - radius, 0, side), y1 = (size_t)optla_clamp_(y + radius + 1, 0, side);
	for (size_t py = y0; py < y1; py++)
		for (size_t px = x0; px < x1; px++)
			if (hypot((double)px - x, (double)py - y) <= radius) {
				grey->data[py * grey->width + px] = value;
				covered[py * grey->width + px] = true;
			}
}

static void draw_discs(const optla_model *m, const float *v, double reach_rad, optla_image *grey, bool *covered)
{
	double widest = 0, x, y, angle;
	for (size_t n = 0; n < m->nlights; n++) {
		disc_position(m->light_direction + 3 * n, &x, &y, &angle);
		widest = fmax(widest, angle);
	}
	const double spacing_rad = fmin(reach_rad / 2, 1), scale = 0.5 * DISC_TILE / (widest + spacing_rad); /* pixels per radian */
	for (size_t n = 0; n < m->nlights; n++) {
		disc_position(m->light_direction + 3 * n, &x, &y, &angle);
		draw_disc(grey, covered, 0.5 * DISC_TILE + scale * x, 0.5 * DISC_TILE + scale * y, 0.48 * scale * spacing_rad, v[n]);
	}
}

static void paint_background(const bool *covered, optla_image *rgb)
{
	for (size_t k = 0; k < rgb->width * rgb->height; k++)
		for (size_t c = 0; !covered[k] && c < 3; c++) rgb->data[3 * k + c] = background;
}

static optla_status disc_picture(const optla_model *m, const float *v, optla_image **out)
{
	const optla_light_layout lights = {.nlights = m->nlights, .direction = m->light_direction};
	double reach_rad;
	OPTLA_TRY(optla_light_reach_(m->ctx, &lights, &reach_rad));
	optla_image *grey;
	OPTLA_TRY(optla_image_create(m->ctx, DISC_TILE, DISC_TILE, 1, OPTLA_IMAGE_LINEAR, &grey));
	bool *covered = optla_calloc_(m->ctx, (size_t)DISC_TILE * DISC_TILE, sizeof *covered);
	if (!covered) {
		optla_image_destroy(&grey);
		return OPTLA_ERR_NOMEM;
	}
	draw_discs(m, v, reach_rad, grey, covered);
	const optla_status s = colours(grey, out);
	if (OPTLA_OK == s) paint_background(covered, *out);
	optla_free(m->ctx, covered);
	return s;
}

static optla_status light_picture(const optla_model *m, const float *v, optla_image **out)
{
	if (m->light_width) return grid_picture(m->ctx, v, m->light_width, m->light_height, out);
	return m->light_direction ? disc_picture(m, v, out) : grid_picture(m->ctx, v, m->nlights, 1, out);
}

/* ---- the sheet ---- */

typedef enum { ROW_PHOTO, ROW_ILLUMINATION, ROW_DUAL_LIGHT, ROW_DUAL_PHOTO, NROWS } sheet_row;

static bool thumbs_are_drawable(const optla_model *m)
{
	return m->thumb_width * m->thumb_height == m->nthumb || m->nthumb == m->npixels || m->nthumb == m->npixels * m->channels;
}

static bool has_row(const optla_model *m, sheet_row row)
{
	if (ROW_DUAL_LIGHT == row) return m->dual_light && thumbs_are_drawable(m);
	return ROW_DUAL_PHOTO != row || m->dual_photo;
}

static optla_status picture(const optla_model *m, sheet_row row, size_t k, optla_image **out)
{
	const size_t nrows = m->npixels * m->channels;
	switch (row) {
	case ROW_PHOTO: return camera_picture(m, m->photos + k * nrows, nrows, out);
	case ROW_ILLUMINATION: return light_picture(m, m->illuminations + k * m->nlights, out);
	case ROW_DUAL_PHOTO: return light_picture(m, m->dual_photo + k * m->nlights, out);
	default: break;
	}
	const float *r = m->dual_light + k * m->nthumb;
	if (m->thumb_width * m->thumb_height == m->nthumb) return grid_picture(m->ctx, r, m->thumb_width, m->thumb_height, out);
	return camera_picture(m, r, m->nthumb, out);
}

/* Fits a picture into the tile with its top left corner at (x0, y0) and takes it away. */
static optla_status place(optla_image *sheet, size_t x0, size_t y0, optla_image *p)
{
	const double scale = (double)TILE / (double)optla_max_(p->width, p->height);
	/* a single line of lights fills the tile as stripes */
	const size_t w = (size_t)fmax(1, round(scale * (double)p->width));
	const size_t h = 1 == p->height ? TILE / 4 : (size_t)fmax(1, round(scale * (double)p->height));
	optla_image *fitted;
	const optla_status s = optla_image_resize(p, w, h, &fitted);
	optla_image_destroy(&p);
	OPTLA_TRY(s);
	x0 += (TILE - w) / 2;
	y0 += (TILE - h) / 2;
	for (size_t y = 0; y < h; y++)
		for (size_t k = 0; k < 3 * w; k++) sheet->data[3 * ((y0 + y) * sheet->width + x0) + k] = fitted->data[3 * y * w + k];
	optla_image_destroy(&fitted);
	return OPTLA_OK;
}

static optla_status fill_sheet(const optla_model *m, size_t count, optla_image *sheet)
{
	for (size_t k = 0; k < 3 * sheet->width * sheet->height; k++) sheet->data[k] = background;
	for (size_t row = 0, y = GAP; row < NROWS; row++) {
		if (!has_row(m, (sheet_row)row)) continue;
		for (size_t k = 0; k < count; k++) {
			optla_image *p;
			OPTLA_TRY(picture(m, (sheet_row)row, k, &p));
			OPTLA_TRY(place(sheet, GAP + k * (TILE + GAP), y, p));
		}
		y += TILE + GAP;
	}
	return OPTLA_OK;
}

optla_status optla_model_montage(const optla_model *m, size_t count, optla_image **out)
{
	*out = NULL;
	OPTLA_CHECK(m->ctx, count > 0, OPTLA_ERR_ARG, "a montage of no components");
	const size_t n = optla_min_(count, m->rank);
	size_t rows = 0;
	for (size_t row = 0; row < NROWS; row++) rows += has_row(m, (sheet_row)row);
	OPTLA_TRY(optla_image_create(m->ctx, GAP + n * (TILE + GAP), GAP + rows * (TILE + GAP), 3, OPTLA_IMAGE_DISPLAY, out));
	const optla_status s = fill_sheet(m, n, *out);
	if (OPTLA_OK != s) optla_image_destroy(out);
	return s;
}
