/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures of photos and light patterns. */
#include "report/lab.h"

#include "report/canvas.h"

#include <math.h>
#include <string.h>

static void destroy_image(optla_ctx *ctx, void *object)
{
	(void)ctx;
	optla_image *image = object;
	optla_image_destroy(&image);
}

/* Holds *image when status is OPTLA_OK. */
static optla_status hold(optla_figure *figure, optla_status status, optla_image **image)
{
	if (OPTLA_OK != status) {
		optla_image_destroy(image);
		return status;
	}
	status = optla_figure_hold_(figure, *image, destroy_image);
	if (OPTLA_OK != status) *image = NULL;
	return status;
}

/* The part of a picture that holds the pixels of T, with a small border: a masked object fills its picture. */
static optla_status crop(const optla_rig_info *info, const optla_image *image, optla_image **out)
{
	enum { BORDER = 4 };
	size_t x0 = info->width, x1 = 0, y0 = info->height, y1 = 0;
	for (size_t k = 0; k < info->npixels; k++) {
		const size_t x = info->pixel[k] % info->width, y = info->pixel[k] / info->width;
		x0 = optla_min_(x0, x), x1 = optla_max_(x1, x);
		y0 = optla_min_(y0, y), y1 = optla_max_(y1, y);
	}
	x0 -= optla_min_(x0, BORDER), y0 -= optla_min_(y0, BORDER);
	x1 = optla_min_(x1 + BORDER + 1, info->width), y1 = optla_min_(y1 + BORDER + 1, info->height);
	const size_t c = image->channels;
	OPTLA_TRY(optla_image_create(image->ctx, x1 - x0, y1 - y0, c, image->kind, out));
	for (size_t y = y0; y < y1; y++)
		memcpy((*out)->data + (y - y0) * (x1 - x0) * c, image->data + (y * image->width + x0) * c, (x1 - x0) * c * sizeof(float));
	return OPTLA_OK;
}

static optla_status rig_picture(const optla_rig *rig, const double *values, optla_image **out)
{
	optla_rig_info info;
	optla_image *whole;
	optla_rig_get_info(rig, &info);
	*out = NULL;
	OPTLA_TRY(optla_rig_image(rig, values, 1, &whole));
	const optla_status s = crop(&info, whole, out);
	optla_image_destroy(&whole);
	return s;
}

optla_status optla_lab_exposure_(optla_figure *figure, const optla_rig *rig, const double *values, double *exposure)
{
	(void)figure;
	optla_image *image;
	OPTLA_TRY(rig_picture(rig, values, &image));
	*exposure = optla_image_auto_exposure(image, 0.995);
	optla_image_destroy(&image);
	return OPTLA_OK;
}

optla_status optla_lab_photo_(optla_figure *figure, const optla_rig *rig, const double *values, double exposure,
                              optla_image **out)
{
	optla_status s = rig_picture(rig, values, out);
	if (OPTLA_OK == s) s = optla_image_to_display(*out, exposure);
	return hold(figure, s, out);
}

optla_status optla_lab_signed_photo_(optla_figure *figure, const optla_rig *rig, const double *values, optla_image **out)
{
	optla_image *image;
	OPTLA_TRY(rig_picture(rig, values, &image));
	const optla_status s = optla_image_signed_colours(image, 0, out);
	optla_image_destroy(&image);
	return hold(figure, s, out);
}

optla_status optla_lab_difference_(optla_figure *figure, const optla_rig *rig, const double *a, const double *b, double exposure,
                                   double amplification, optla_image **out)
{
	optla_image *ia, *ib = NULL;
	*out = NULL;
	OPTLA_TRY(rig_picture(rig, a, &ia));
	optla_status s = rig_picture(rig, b, &ib);
	if (OPTLA_OK == s) s = optla_panel_difference_(ia, ib, exposure, amplification, out);
	optla_image_destroy(&ia);
	optla_image_destroy(&ib);
	return hold(figure, s, out);
}

/* ---- lights that are known by direction ---- */

enum { DISC_PX = 200 };

/* Seen from the scene towards the camera's side: the direction's x and y on a disc, as an orthographic picture of the hemisphere. */
static optla_status draw_directions(optla_ctx *ctx, const optla_rig_info *info, const double *values, bool with_sign,
                                    optla_image **out)
{
	cairo_t *canvas;
	OPTLA_TRY(optla_canvas_begin_(ctx, DISC_PX, DISC_PX, &canvas));
	const double middle = DISC_PX / 2.0, radius = 0.46 * DISC_PX;
	double scale = 0, reach = 1e-9;
	for (size_t k = 0; k < info->nlights; k++) {
		scale = fmax(scale, fabs(values[k]));
		reach = fmax(reach, hypot(info->light_direction[3 * k], info->light_direction[3 * k + 1]));
	}
	optla_canvas_colour_(canvas, with_sign ? 0xececec : 0x202020);
	cairo_arc(canvas, middle, middle, middle - 1, 0, 6.28318530717958648);
	cairo_fill(canvas);
	for (size_t k = 0; k < info->nlights; k++) {
		const double *l = info->light_direction + 3 * k, v = scale > 0 ? values[k] / scale : 0;
		if (with_sign)
			cairo_set_source_rgb(canvas, v < 0 ? 1 + v : 1, 1 - fabs(v), v > 0 ? 1 - v : 1);
		else
			cairo_set_source_rgb(canvas, fmax(v, 0.05), fmax(v, 0.05), fmax(0.9 * v, 0.05));
		cairo_arc(canvas, middle + radius * l[0] / reach, middle + radius * l[1] / reach, 5.5, 0, 6.28318530717958648);
		cairo_fill(canvas);
	}
	return optla_canvas_finish_(ctx, &canvas, out);
}

static optla_status draw_grid_light(const optla_rig *rig, const double *values, bool with_sign, optla_image **out)
{
	optla_image *image;
	OPTLA_TRY(optla_rig_light_image(rig, values, &image));
	if (with_sign) {
		const optla_status s = optla_image_signed_colours(image, 0, out);
		optla_image_destroy(&image);
		return s;
	}
	*out = image;
	return optla_image_to_display(image, optla_image_auto_exposure(image, 1));
}

optla_status optla_lab_light_(optla_figure *figure, const optla_rig *rig, const double *values, bool with_sign, optla_image **out)
{
	*out = NULL;
	optla_rig_info info;
	optla_rig_get_info(rig, &info);
	if (info.light_width) return hold(figure, draw_grid_light(rig, values, with_sign, out), out);
	OPTLA_CHECK(figure->ctx, info.light_direction, OPTLA_ERR_UNSUPPORTED,
	            "rig '%s' says neither grid nor direction of its lights", info.name);
	return hold(figure, draw_directions(figure->ctx, &info, values, with_sign, out), out);
}

optla_status optla_lab_sheet_(optla_figure *figure, const optla_panel *panels, size_t count, size_t columns, size_t cell_px,
                              const char *file, const char *caption)
{
	optla_image *sheet;
	OPTLA_TRY(hold(figure, optla_panel_sheet_(figure->ctx, panels, count, columns, cell_px, &sheet), &sheet));
	return optla_figure_image_(figure, sheet, file, caption);
}
