/* SPDX-License-Identifier: BSD-3-Clause */
/* Line charts. Colours: M. Okabe and K. Ito, Color universal design (2008), told apart by colour-blind readers; each series also has its
   own dash and marker, so a print in grey can be read. The legend has a column of its own beside the axes: it never hides a line. */
#include "optla/report.h"

#include "report/axis.h"
#include "report/canvas.h"

#include <math.h>
#include <string.h>

enum { STYLES = 8, MARKERS_PER_LINE = 24, GREY_TEXT = 0x333333, GREY_GRID = 0xdcdcdc, GREY_MINOR = 0xf0f0f0 };

static const unsigned colours[STYLES] = {0x0072b2, 0xd55e00, 0x009e73, 0x000000, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x8c8c8c};
static const double dashes[STYLES][4] = {{0},          {8, 3, 0, 0},  {2.5, 2.5, 0, 0},   {10, 3, 2.5, 3},
                                         {5, 2, 0, 0}, {12, 4, 0, 0}, {1.5, 2.5, 6, 2.5}, {3, 1.5, 0, 0}};

/* Everything in pixels; unit: size of one pixel of the default 720 x 480 chart. */
typedef struct {
	const optla_plot *plot;
	optla_axis x, y;
	double unit, left, top, width, height, legend_left;
} layout;

static optla_font font(const layout *l, double size, double align)
{
	return (optla_font){.size_px = size * l->unit, .align = align};
}

static double tick_width(cairo_t *canvas, const layout *l, const optla_tick *t)
{
	return optla_canvas_text_width_(canvas, font(l, 12, 0), t->label) +
	       optla_canvas_text_width_(canvas, font(l, 9, 0), t->exponent);
}

static void draw_tick_label(cairo_t *canvas, const layout *l, const optla_tick *t, double x, double y, double align)
{
	const double start = x - align * tick_width(canvas, l, t), label = optla_canvas_text_width_(canvas, font(l, 12, 0), t->label);
	optla_canvas_text_(canvas, start, y, font(l, 12, 0), t->label);
	if (t->exponent[0]) optla_canvas_text_(canvas, start + label, y - 5 * l->unit, font(l, 9, 0), t->exponent);
}

static optla_status check_plot(optla_ctx *ctx, const optla_plot *plot)
{
	OPTLA_CHECK(ctx, plot->size == sizeof *plot, OPTLA_ERR_ARG, "optla_plot.size is %zu, this library knows %zu", plot->size,
	            sizeof *plot);
	for (size_t k = 0; k < plot->nseries; k++)
		OPTLA_CHECK(ctx, plot->series[k].count == 0 || (plot->series[k].x && plot->series[k].y), OPTLA_ERR_ARG,
		            "series %zu ('%s') has %zu points but no data", k, plot->series[k].label ? plot->series[k].label : "",
		            plot->series[k].count);
	return OPTLA_OK;
}

static bool shown(const optla_plot *plot, const optla_series *s, size_t k)
{
	const bool whole = plot->y_range[0] == 0 && plot->y_range[1] == 0;
	return optla_axis_shows_(plot->log_x, s->x[k]) && optla_axis_shows_(plot->log_y, s->y[k]) &&
	       (whole || (s->y[k] >= plot->y_range[0] && s->y[k] <= plot->y_range[1]));
}

static void init_axes(layout *l)
{
	double xl = INFINITY, xh = -INFINITY, yl = INFINITY, yh = -INFINITY;
	for (size_t i = 0; i < l->plot->nseries; i++) {
		const optla_series *s = &l->plot->series[i];
		for (size_t k = 0; k < s->count; k++) {
			if (!shown(l->plot, s, k)) continue;
			xl = fmin(xl, s->x[k]);
			xh = fmax(xh, s->x[k]);
			yl = fmin(yl, s->y[k]);
			yh = fmax(yh, s->y[k]);
		}
	}
	optla_axis_init_(&l->x, l->plot->log_x, xl, xh, 7);
	optla_axis_init_(&l->y, l->plot->log_y, yl, yh, 6);
}

static void init_layout(layout *l, cairo_t *canvas, double width, double height)
{
	double labels = 0, legend = 0;
	for (size_t k = 0; k < l->y.count; k++)
		if (l->y.tick[k].major) labels = fmax(labels, tick_width(canvas, l, &l->y.tick[k]));
	for (size_t k = 0; k < l->plot->nseries && l->plot->nseries > 1; k++)
		legend = fmax(legend, 50 * l->unit + optla_canvas_text_width_(canvas, font(l, 12, 0), l->plot->series[k].label));
	legend = fmin(legend, 0.4 * width);
	l->left = labels + 42 * l->unit;
	l->top = (l->plot->title ? 40 : 16) * l->unit;
	l->width = fmax(width - l->left - legend - 22 * l->unit, 8);
	l->height = fmax(height - l->top - 54 * l->unit, 8);
	l->legend_left = l->left + l->width + 14 * l->unit;
}

static double at_x(const layout *l, double value) { return l->left + l->width * optla_axis_position_(&l->x, value); }
static double at_y(const layout *l, double value) { return l->top + l->height * (1 - optla_axis_position_(&l->y, value)); }

static void line(cairo_t *canvas, double x0, double y0, double x1, double y1)
{
	/* hair lines on pixel centres stay one pixel wide */
	cairo_move_to(canvas, floor(x0) + 0.5, floor(y0) + 0.5);
	cairo_line_to(canvas, floor(x1) + 0.5, floor(y1) + 0.5);
	cairo_stroke(canvas);
}

static void draw_grid(cairo_t *canvas, const layout *l, bool major)
{
	cairo_set_line_width(canvas, l->unit);
	optla_canvas_colour_(canvas, major ? GREY_GRID : GREY_MINOR);
	for (size_t k = 0; k < l->x.count; k++)
		if (l->x.tick[k].major == major)
			line(canvas, at_x(l, l->x.tick[k].value), l->top, at_x(l, l->x.tick[k].value), l->top + l->height);
	for (size_t k = 0; k < l->y.count; k++)
		if (l->y.tick[k].major == major)
			line(canvas, l->left, at_y(l, l->y.tick[k].value), l->left + l->width, at_y(l, l->y.tick[k].value));
}

static void draw_axes(cairo_t *canvas, const layout *l)
{
	const optla_plot *p = l->plot;
	const double bottom = l->top + l->height, u = l->unit;
	optla_canvas_colour_(canvas, GREY_TEXT);
	cairo_set_line_width(canvas, u);
	line(canvas, l->left, l->top, l->left, bottom);
	line(canvas, l->left, bottom, l->left + l->width, bottom);
	double free_from = -INFINITY; /* labels that would touch the one before are left out */
	for (size_t k = 0; k < l->x.count; k++) {
		const optla_tick *t = &l->x.tick[k];
		const double x = at_x(l, t->value), half = tick_width(canvas, l, t) / 2;
		if (!t->major || x - half < free_from) continue;
		draw_tick_label(canvas, l, t, x, bottom + 18 * u, 0.5);
		free_from = x + half + 6 * u;
	}
	double free_below = INFINITY;
	for (size_t k = 0; k < l->y.count; k++) {
		const optla_tick *t = &l->y.tick[k];
		const double y = at_y(l, t->value);
		if (!t->major || y > free_below) continue;
		draw_tick_label(canvas, l, t, l->left - 6 * u, y + 4 * u, 1);
		free_below = y - 14 * u;
	}
	if (p->title) {
		optla_font f = font(l, 14, 0);
		f.bold = true;
		optla_canvas_text_(canvas, l->left, 24 * u, f, p->title);
	}
	if (p->x_label) optla_canvas_text_(canvas, l->left + l->width / 2, bottom + 42 * u, font(l, 13, 0.5), p->x_label);
	if (!p->y_label) return;
	cairo_save(canvas);
	cairo_translate(canvas, 18 * u, l->top + l->height / 2);
	cairo_rotate(canvas, -1.57079632679489662);
	optla_canvas_text_(canvas, 0, 0, font(l, 13, 0.5), p->y_label);
	cairo_restore(canvas);
}

static void polygon(cairo_t *canvas, double x, double y, double r, int corners, double turn)
{
	for (int k = 0; k < corners; k++) {
		const double a = 6.28318530717958648 * (k + turn) / corners;
		cairo_line_to(canvas, x + r * sin(a), y - r * cos(a));
	}
	cairo_close_path(canvas);
}

static void draw_marker(cairo_t *canvas, const layout *l, size_t style, double x, double y)
{
	const double r = 4 * l->unit;
	cairo_new_path(canvas);
	switch (style % STYLES) {
	case 0: cairo_arc(canvas, x, y, 0.85 * r, 0, 6.28318530717958648); break;
	case 1: polygon(canvas, x, y, 1.15 * r, 4, 0.5); break;
	case 2: polygon(canvas, x, y, 1.25 * r, 3, 0); break;
	case 3: polygon(canvas, x, y, 1.2 * r, 4, 0); break;
	case 4: polygon(canvas, x, y, 1.25 * r, 3, 0.5); break;
	case 5: polygon(canvas, x, y, 1.1 * r, 5, 0); break;
	case 6: polygon(canvas, x, y, 1.1 * r, 6, 0); break;
	default: polygon(canvas, x, y, 0.9 * r, 4, 0.5); break;
	}
	cairo_fill(canvas);
}

static void set_style(cairo_t *canvas, const layout *l, size_t k)
{
	double dash[4];
	int count = 0;
	for (; count < 4 && dashes[k % STYLES][count] > 0; count++) dash[count] = dashes[k % STYLES][count] * l->unit;
	optla_canvas_colour_(canvas, colours[k % STYLES]);
	cairo_set_line_width(canvas, 1.8 * l->unit);
	cairo_set_dash(canvas, dash, count, 0);
	cairo_set_line_join(canvas, CAIRO_LINE_JOIN_ROUND);
}

static void draw_series(cairo_t *canvas, const layout *l, size_t k)
{
	const optla_series *s = &l->plot->series[k];
	set_style(canvas, l, k);
	bool pen_down = false;
	for (size_t i = 0; i < s->count; i++) {
		const bool here = shown(l->plot, s, i);
		if (here && pen_down) cairo_line_to(canvas, at_x(l, s->x[i]), at_y(l, s->y[i]));
		if (here && !pen_down) cairo_move_to(canvas, at_x(l, s->x[i]), at_y(l, s->y[i]));
		pen_down = here;
	}
	cairo_stroke(canvas);
	cairo_set_dash(canvas, NULL, 0, 0);
	/* long lines get every n-th marker, each series starting at another point so that they don't stack up */
	const size_t every = s->count > MARKERS_PER_LINE ? (s->count + MARKERS_PER_LINE - 1) / MARKERS_PER_LINE : 1;
	for (size_t i = k % every; i < s->count; i += every)
		if (shown(l->plot, s, i)) draw_marker(canvas, l, k, at_x(l, s->x[i]), at_y(l, s->y[i]));
}

static void draw_legend(cairo_t *canvas, const layout *l)
{
	for (size_t k = 0; k < l->plot->nseries && l->plot->nseries > 1; k++) {
		const double y = l->top + (12 + 22 * (double)k) * l->unit, x = l->legend_left;
		set_style(canvas, l, k);
		cairo_move_to(canvas, x, y);
		cairo_line_to(canvas, x + 30 * l->unit, y);
		cairo_stroke(canvas);
		cairo_set_dash(canvas, NULL, 0, 0);
		draw_marker(canvas, l, k, x + 15 * l->unit, y);
		optla_canvas_colour_(canvas, GREY_TEXT);
		optla_canvas_text_(canvas, x + 37 * l->unit, y + 4 * l->unit, font(l, 12, 0), l->plot->series[k].label);
	}
}

optla_status optla_plot_draw(optla_ctx *ctx, const optla_plot *plot, optla_image **out)
{
	*out = NULL;
	OPTLA_TRY(check_plot(ctx, plot));
	const size_t width = plot->width ? plot->width : 720, height = plot->height ? plot->height : 480;
	cairo_t *canvas;
	OPTLA_TRY(optla_canvas_begin_(ctx, width, height, &canvas));
	layout l = {.plot = plot, .unit = fmax(fmin((double)width / 720, (double)height / 480), 0.5)};
	init_axes(&l);
	init_layout(&l, canvas, (double)width, (double)height);
	draw_grid(canvas, &l, false);
	draw_grid(canvas, &l, true);
	draw_axes(canvas, &l);
	for (size_t k = 0; k < plot->nseries; k++) draw_series(canvas, &l, k);
	draw_legend(canvas, &l);
	return optla_canvas_finish_(ctx, &canvas, out);
}
