/* SPDX-License-Identifier: BSD-3-Clause */
/* Charts, their CSV, escaping, panels, numbers.json and the page. */
#include "io/whole_file.h"
#include "near.h"
#include "optla/report.h"
#include "report/axis.h"
#include "report/figure.h"
#include "report/page.h"
#include "report/panel.h"

#include <jansson.h>
#include <stdio.h>
#include <unistd.h>

static char dir[64];

static void make_dir(void)
{
	snprintf(dir, sizeof dir, "/tmp/optla-plot-XXXXXX");
	ck_assert_ptr_nonnull(mkdtemp(dir));
}

static void remove_dir(void)
{
	char command[96];
	snprintf(command, sizeof command, "rm -rf '%s'", dir);
	ck_assert_int_eq(system(command), 0);
}

static const char *in_dir(const char *name)
{
	static char path[160];
	snprintf(path, sizeof path, "%s/%s", dir, name);
	return path;
}

/* Number of pixels near a colour (0xrrggbb) in columns x0..x1 and rows y0..y1 (ends excluded). */
static size_t ink(const optla_image *image, unsigned colour, size_t x0, size_t x1, size_t y0, size_t y1)
{
	size_t count = 0;
	for (size_t y = y0; y < y1; y++)
		for (size_t x = x0; x < x1; x++) {
			const float *p = image->data + 3 * (y * image->width + x);
			bool near = true;
			for (int c = 0; c < 3; c++) near = near && fabs((double)p[c] - (colour >> (16 - 8 * c) & 255) / 255.0) < 0.02;
			count += near;
		}
	return count;
}

enum { BLUE = 0x0072b2, VERMILLION = 0xd55e00, WHITE = 0xffffff };

static optla_plot two_lines(const optla_series *series)
{
	return (optla_plot){
	    .size = sizeof(optla_plot), .title = "T", .x_label = "k", .y_label = "error", .series = series, .nseries = 2};
}

START_TEST(chart_has_ink_where_the_data_are)
{
	/* one line along the top, one along the bottom of the axes: their colours must lie in that half of the picture alone */
	optla_ctx *ctx = test_ctx(NULL, 1);
	const double x[] = {0, 1, 2, 3}, high[] = {9, 9, 9, 9}, low[] = {1, 1, 1, 1};
	const optla_series s[] = {{"high", x, high, 4}, {"low", x, low, 4}};
	optla_plot plot = two_lines(s);
	optla_image *image;
	ok(optla_plot_draw(ctx, &plot, &image));
	ck_assert_uint_eq(image->width, 720);
	ck_assert_uint_eq(image->height, 480);
	ck_assert_uint_eq(image->channels, 3);
	ck_assert_int_eq(image->kind, OPTLA_IMAGE_DISPLAY);
	/* up to x = 560 there are axes only; the legend is to the right of them */
	ck_assert_uint_gt(ink(image, BLUE, 0, 560, 0, 120), 400);
	ck_assert_uint_eq(ink(image, BLUE, 0, 560, 120, 480), 0);
	ck_assert_uint_gt(ink(image, VERMILLION, 0, 560, 300, 480), 300);
	ck_assert_uint_eq(ink(image, VERMILLION, 0, 560, 0, 300), 0);
	ck_assert_uint_gt(ink(image, BLUE, 600, 720, 0, 120), 20);
	ck_assert_uint_gt(ink(image, VERMILLION, 600, 720, 0, 120), 20);
	ck_assert_uint_gt(ink(image, WHITE, 0, 720, 0, 480), 720 * 480 / 2);
	optla_image_destroy(&image);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(what_cannot_be_shown_is_left_out)
{
	/* the picture with bad points is, pixel for pixel, the one without them: they count neither for the range nor for markers */
	optla_ctx *ctx = test_ctx(NULL, 1);
	const double x[] = {1, 10, 100, -5, 3, 0, NAN, 2}, y[] = {1, 0.1, 0.01, 1, 0, 1, 1, INFINITY};
	optla_series s[] = {{"a", x, y, 3}, {"b", x, y, 3}};
	optla_plot plot = two_lines(s);
	plot.log_x = plot.log_y = true;
	optla_image *good, *all;
	ok(optla_plot_draw(ctx, &plot, &good));
	s[0].count = s[1].count = 8;
	ok(optla_plot_draw(ctx, &plot, &all));
	ck_assert_int_eq(memcmp(good->data, all->data, sizeof(float) * 720 * 480 * 3), 0);
	optla_image_destroy(&good);
	optla_image_destroy(&all);
	/* nothing to show at all still gives axes */
	s[0].count = s[1].count = 0;
	ok(optla_plot_draw(ctx, &plot, &good));
	ck_assert_uint_lt(ink(good, WHITE, 0, 720, 0, 480), 720 * 480 - 500);
	optla_image_destroy(&good);
	ck_assert(!optla_axis_shows_(true, 0) && !optla_axis_shows_(true, -1) && !optla_axis_shows_(true, NAN));
	ck_assert(optla_axis_shows_(false, 0) && optla_axis_shows_(false, -1) && !optla_axis_shows_(false, INFINITY));
	optla_ctx_destroy(&ctx);
}
END_TEST

static const optla_tick *labelled(const optla_axis *axis, const char *label, const char *exponent)
{
	for (size_t k = 0; k < axis->count; k++)
		if (axis->tick[k].major && !strcmp(axis->tick[k].label, label) && !strcmp(axis->tick[k].exponent, exponent))
			return &axis->tick[k];
	return NULL;
}

START_TEST(ticks_are_round_numbers)
{
	optla_axis a;
	optla_axis_init_(&a, false, 0, 50, 6);
	ck_assert_ptr_nonnull(labelled(&a, "0", ""));
	ck_assert_ptr_nonnull(labelled(&a, "10", ""));
	ck_assert_uint_eq(a.count, 6);
	optla_axis_init_(&a, false, 0.11, 0.19, 6);
	ck_assert_ptr_nonnull(labelled(&a, "0.12", ""));
	optla_axis_init_(&a, false, -3e6, 3e6, 6);
	ck_assert_ptr_nonnull(labelled(&a, "-2·10", "6"));
	optla_axis_init_(&a, true, 1e-9, 1, 6);
	near_rel(labelled(&a, "10", "-6")->value, 1e-6, 1e-12);
	ck_assert_ptr_nonnull(labelled(&a, "1", ""));
	optla_axis_init_(&a, true, 0.02, 0.9, 6);
	ck_assert_ptr_nonnull(labelled(&a, "0.05", ""));
	ck_assert_ptr_nonnull(labelled(&a, "0.1", ""));
	ck_assert_ptr_null(labelled(&a, "0.3", ""));
	optla_axis_init_(&a, true, 0.12, 0.2, 6);
	ck_assert_ptr_nonnull(labelled(&a, "0.14", ""));
}
END_TEST

START_TEST(axes_of_any_range_hold_their_data)
{
	/* from denormal to huge, empty, reversed and single-valued: positions within 0..1, some labelled ticks, all inside */
	const double range[][2] = {{0, 0},         {1, 1},     {-5, -5},   {1, -1},          {1e-300, 1e300}, {-1e300, 1e300},
	                           {1e-300, 1e-5}, {0.1, 0.1}, {3, 3.001}, {1e15, 1e15 + 1}, {-1e-9, 1e-9},   {999, 1001}};
	for (size_t k = 0; k < sizeof range / sizeof *range; k++)
		for (int logarithmic = 0; logarithmic < 2; logarithmic++) {
			const double low = range[k][0], high = range[k][1];
			if (logarithmic && low <= 0) continue;
			optla_axis a;
			optla_axis_init_(&a, logarithmic, low, high, 6);
			ck_assert_double_lt(a.low, a.high);
			size_t major = 0;
			for (size_t t = 0; t < a.count; t++) {
				const double x = optla_axis_position_(&a, a.tick[t].value);
				ck_assert_msg(x > -1e-6 && x < 1 + 1e-6, "range %zu, log %d: tick %g at %g", k, logarithmic, a.tick[t].value, x);
				major += a.tick[t].major;
			}
			ck_assert_msg(major >= 2, "range %zu, log %d: %zu labels", k, logarithmic, major);
			if (low > high) continue;
			const double first = optla_axis_position_(&a, low), last = optla_axis_position_(&a, high);
			ck_assert_msg(first >= 0 && last <= 1, "range %zu, log %d: %g .. %g", k, logarithmic, first, last);
		}
}
END_TEST

START_TEST(wrong_plots_are_errors)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	const optla_series s[] = {{"a", NULL, NULL, 3}, {NULL, NULL, NULL, 0}};
	optla_plot plot = two_lines(s);
	optla_image *image;
	status_is(optla_plot_draw(ctx, &plot, &image), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "series 0 ('a') has 3 points but no data");
	ck_assert_ptr_null(image);
	plot.nseries = 0;
	plot.width = 40000;
	status_is(optla_plot_draw(ctx, &plot, &image), OPTLA_ERR_ARG);
	ck_assert_ptr_nonnull(strstr(e.text, "40000 x 480"));
	plot.size = 1;
	status_is(optla_plot_draw(ctx, &plot, &image), OPTLA_ERR_ARG);
	status_is(optla_plot_save_csv(ctx, &plot, "/tmp/never.csv"), OPTLA_ERR_ARG);
	/* a tiny chart, and text that isn't UTF-8, are drawn all the same */
	plot = two_lines(s + 1);
	plot.nseries = 1;
	plot.width = plot.height = 12;
	plot.title = "\xff\xfe bad";
	ok(optla_plot_draw(ctx, &plot, &image));
	optla_image_destroy(&image);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(charts_need_no_fonts)
{
	/* a machine without fontconfig's configuration or any font (this test runs in a process of its own) */
	setenv("FONTCONFIG_FILE", "/nonexistent", 1);
	setenv("FONTCONFIG_PATH", "/nonexistent", 1);
	setenv("XDG_DATA_HOME", "/nonexistent", 1);
	optla_ctx *ctx = test_ctx(NULL, 1);
	const double x[] = {0, 1}, y[] = {0, 1};
	const optla_series s[] = {{"λ", x, y, 2}, {"b", y, x, 2}};
	const optla_plot plot = two_lines(s);
	optla_image *image;
	ok(optla_plot_draw(ctx, &plot, &image));
	/* the title is there, in Cairo's own outlines */
	ck_assert_uint_gt(720 * 30 - ink(image, WHITE, 0, 720, 0, 30), 20);
	optla_image_destroy(&image);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* One field of a CSV line (quoted or not), the rest in *line. */
static void take_field(const char **line, char field[64])
{
	size_t n = 0;
	const char *s = *line;
	const bool quoted = *s == '"';
	if (quoted) s++;
	while (*s && (quoted ? !(*s == '"' && s[1] != '"') : *s != ',' && *s != '\n')) {
		if (quoted && *s == '"') s++;
		field[n++] = *s++;
	}
	field[n] = 0;
	if (quoted) s++;
	*line = *s == ',' || *s == '\n' ? s + 1 : s;
}

START_TEST(csv_comes_back)
{
	make_dir();
	optla_ctx *ctx = test_ctx(NULL, 1);
	ok(optla_ctx_set_provenance(ctx, "optla reproduce fig2.9", 7, "2026-01-01"));
	const double x[] = {1, 2, 3}, y[] = {0.1, 1.0 / 3, NAN};
	const optla_series s[] = {{"plain", x, y, 3}, {"with, comma and \"quotes\"", x, y, 1}};
	const optla_plot plot = two_lines(s);
	ok(optla_plot_save_csv(ctx, &plot, in_dir("p.csv")));
	void *bytes;
	size_t count;
	ok(optla_read_file_(ctx, in_dir("p.csv"), &bytes, &count));
	const char *line = bytes;
	ck_assert_ptr_nonnull(strstr(line, "# command: optla reproduce fig2.9\n"));
	ck_assert_ptr_nonnull(strstr(line, "# seed: 7\n"));
	while (*line == '#') line = strchr(line, '\n') + 1;
	char field[3][64];
	for (int c = 0; c < 3; c++) take_field(&line, field[c]);
	ck_assert_str_eq(field[0], "series");
	ck_assert_str_eq(field[2], "error");
	for (size_t k = 0; k < 4; k++) {
		for (int c = 0; c < 3; c++) take_field(&line, field[c]);
		ck_assert_str_eq(field[0], s[k / 3].label);
		ck_assert(strtod(field[1], NULL) == x[k % 3]);
		if (k == 2)
			ck_assert_str_eq(field[2], "");
		else
			ck_assert(strtod(field[2], NULL) == y[k % 3]);
	}
	ck_assert_str_eq(line, "");
	optla_free(ctx, bytes);
	optla_ctx_destroy(&ctx);
	remove_dir();
}
END_TEST

#define BAD "\xef\xbf\xbd" /* U+FFFD */

START_TEST(html_is_escaped)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_text t = {.ctx = ctx};
	optla_text_add_html_(&t, "%s & %s", "<b a=\"1\">'x'", "λ\xff\x01\xed\xa0\x80.");
	ck_assert_int_eq(t.status, OPTLA_OK);
	/* each byte that is not part of a UTF-8 character, and each control character, becomes U+FFFD */
	ck_assert_str_eq(t.data, "&lt;b a=&quot;1&quot;&gt;&#39;x&#39; &amp; λ" BAD BAD BAD BAD BAD ".");
	optla_text_free_(&t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(sheets_hold_their_pictures)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_image *red, *sheet;
	ok(optla_image_create(ctx, 5, 4, 3, OPTLA_IMAGE_DISPLAY, &red));
	for (size_t k = 0; k < 20; k++) red->data[3 * k] = 1;
	const optla_panel panels[] = {{red, "one\ntwo"}, {NULL, "none"}, {red, NULL}};
	ok(optla_panel_sheet_(ctx, panels, 3, 2, 53, &sheet));
	/* 53 pixels hold five pixels ten times enlarged: two pictures of 50 x 40 */
	ck_assert_uint_eq(ink(sheet, 0xff0000, 0, sheet->width, 0, sheet->height), 2 * 50 * 40);
	ck_assert_uint_eq(ink(sheet, 0xff0000, 10, 60, 10, 50), 50 * 40);
	optla_image_destroy(&sheet);
	/* a LINEAR picture has no colours to draw */
	optla_image_set_kind(red, OPTLA_IMAGE_LINEAR, 0);
	status_is(optla_panel_sheet_(ctx, panels, 3, 2, 53, &sheet), OPTLA_ERR_ARG);
	status_is(optla_panel_sheet_(ctx, panels, 0, 2, 53, &sheet), OPTLA_ERR_ARG);
	optla_image *other, *difference;
	ok(optla_image_copy(red, &other));
	other->data[4] = 0.03125f;
	ok(optla_panel_difference_(red, other, 2, 16, &difference));
	for (size_t k = 0; k < 60; k++) near_abs((double)difference->data[k], k == 4 ? 1 : 0, 1e-6);
	optla_image_destroy(&difference);
	optla_image_destroy(&other);
	ok(optla_image_create(ctx, 5, 4, 1, OPTLA_IMAGE_LINEAR, &other));
	status_is(optla_panel_difference_(red, other, 1, 1, &difference), OPTLA_ERR_SHAPE);
	optla_image_destroy(&other);
	optla_image_destroy(&red);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(numbers_are_ok_only_within_their_range)
{
	const struct {
		double value;
		optla_expect expect;
		bool good;
	} cases[] = {
	    {1, {"", NAN, 1, 2, ""}, true},
	    {2, {"", NAN, 1, 2, ""}, true},
	    {0.999, {"", NAN, 1, 2, ""}, false},
	    {2.001, {"", NAN, 1, 2, ""}, false},
	    {NAN, {"", NAN, 1, 2, ""}, false},
	    {1e9, optla_expect_at_least_(3, "", ""), true},
	    {1e9, optla_expect_at_most_(3, "", ""), false},
	    {-7, optla_expect_nothing_("", ""), true},
	    {NAN, optla_expect_nothing_("", ""), false},
	    {INFINITY, optla_expect_nothing_("", ""), false},
	    {1, {"", NAN, NAN, 2, ""}, false},
	};
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_numbers numbers = {.ctx = ctx};
	size_t failed = 0;
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		ok(optla_numbers_add_(&numbers, "n", cases[k].value, cases[k].expect));
		ck_assert_msg(optla_number_ok_(&numbers.item[k]) == cases[k].good, "case %zu", k);
		failed += !cases[k].good;
	}
	ck_assert_uint_eq(optla_numbers_failed_(&numbers), failed);
	optla_numbers_free_(&numbers);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* A made-up figure with text that needs escaping and a number that isn't ok; saved under id. */
static optla_status made_up_figure(optla_ctx *ctx, const char *id, double value)
{
	const optla_reproduce_options o = {.size = sizeof o, .out_dir = dir, .seed = 5};
	const double x[] = {1, 2}, y[] = {3, 4};
	const optla_series s[] = {{"<a>", x, y, 2}, {"b", x, x, 2}};
	const optla_plot plot = two_lines(s);
	const char *cells[] = {"<k>", "2"};
	optla_figure f;
	double *held;
	OPTLA_TRY(optla_figure_init_(&f, ctx, id, "Title <&>", &o));
	optla_figure_heading_(&f, "A & B");
	optla_figure_row_(&f, true, cells, 2);
	optla_figure_row_(&f, false, cells, 2);
	optla_figure_say_(&f, "%s", "<script>alert(1)</script>");
	optla_status st = optla_figure_doubles_(&f, 10, &held);
	if (!st) st = optla_figure_plot_(&f, &plot, "plot", "caption \"quoted\"");
	optla_expect e = optla_expect_range_(0, 1, "m", "a < b");
	e.thesis = 0.5;
	if (!st) st = optla_figure_number_(&f, value, e, "first");
	if (!st) st = optla_figure_number_(&f, NAN, optla_expect_nothing_("", "none"), "second");
	if (!st) st = optla_page_save_section_(&f, 1.5);
	if (!st) st = optla_page_save_index_(ctx, dir);
	optla_figure_clear_(&f);
	return st;
}

START_TEST(numbers_json_has_the_agreed_form)
{
	make_dir();
	optla_ctx *ctx = test_ctx(NULL, 1);
	ok(made_up_figure(ctx, "fig2.9", 0.25));
	json_error_t e;
	json_t *root = json_load_file(in_dir("fig2.9/numbers.json"), JSON_REJECT_DUPLICATES, &e);
	ck_assert_msg(root != NULL, "%s", e.text);
	ck_assert_uint_eq(json_object_size(root), 4);
	ck_assert_str_eq(json_string_value(json_object_get(root, "id")), "fig2.9");
	ck_assert_int_eq(json_integer_value(json_object_get(root, "seed")), 5);
	ck_assert(json_real_value(json_object_get(root, "wall_s")) == 1.5);
	json_t *list = json_object_get(root, "numbers"), *n = json_array_get(list, 0);
	ck_assert_uint_eq(json_array_size(list), 2);
	ck_assert_uint_eq(json_object_size(n), 7);
	ck_assert_str_eq(json_string_value(json_object_get(n, "name")), "first");
	ck_assert_str_eq(json_string_value(json_object_get(n, "unit")), "m");
	ck_assert(json_real_value(json_object_get(n, "value")) == 0.25);
	ck_assert(json_real_value(json_object_get(n, "thesis")) == 0.5);
	ck_assert(json_number_value(json_object_get(n, "low")) == 0);
	ck_assert(json_number_value(json_object_get(n, "high")) == 1);
	ck_assert(json_is_true(json_object_get(n, "ok")));
	n = json_array_get(list, 1);
	ck_assert(json_is_null(json_object_get(n, "value")) && json_is_null(json_object_get(n, "thesis")));
	ck_assert(json_is_null(json_object_get(n, "low")) && json_is_false(json_object_get(n, "ok")));
	json_decref(root);
	size_t count, failed;
	ok(optla_numbers_summary_(ctx, in_dir("fig2.9/numbers.json"), &count, &failed));
	ck_assert_uint_eq(count, 2);
	ck_assert_uint_eq(failed, 1);
	ok(optla_write_file_(ctx, in_dir("bad.json"), "{\"id\": ", 7));
	status_is(optla_numbers_summary_(ctx, in_dir("bad.json"), &count, &failed), OPTLA_ERR_INPUT);
	optla_ctx_destroy(&ctx);
	remove_dir();
}
END_TEST

static size_t position(const char *text, const char *part)
{
	const char *p = strstr(text, part);
	ck_assert_msg(p != NULL, "the page has no '%s'", part);
	return (size_t)(p - text);
}

START_TEST(page_keeps_earlier_sections_and_escapes)
{
	make_dir();
	optla_ctx *ctx = test_ctx(NULL, 1);
	ok(optla_ctx_set_provenance(ctx, "optla reproduce '<x>'", 5, "2026-01-01"));
	ok(made_up_figure(ctx, "fig2.9", 0.25));
	ok(made_up_figure(ctx, "fig2.2", 7));
	void *bytes;
	size_t count;
	ok(optla_read_file_(ctx, in_dir("index.html"), &bytes, &count));
	const char *page = bytes;
	/* both figures, in the registry's order, though the second was made later */
	ck_assert_uint_lt(position(page, "<section id=\"fig2.2\">"), position(page, "<section id=\"fig2.9\">"));
	ck_assert_ptr_null(strstr(page, "<script"));
	position(page, "&lt;script&gt;alert(1)&lt;/script&gt;");
	position(page, "<h2>fig2.2 – Title &lt;&amp;&gt;</h2>");
	position(page, "command: optla reproduce &#39;&lt;x&gt;&#39; · date: 2026-01-01");
	position(page, "seed: 5");
	position(page, "<img src=\"fig2.2/plot.png\"");
	position(page, "href=\"fig2.9/plot.csv\"");
	position(page, "a &lt; b");
	position(page, "1 of 2 not ok"); /* fig2.9: the NaN */
	position(page, "2 of 2 not ok"); /* fig2.2: also 7 of 0..1 */
	position(page,
	         "<table>\n<tr><th>&lt;k&gt;</th><th>2</th></tr>\n<tr><td>&lt;k&gt;</td><td class=n>2</td></tr>\n</table>\n<p>");
	/* nothing is fetched from elsewhere, and nothing points outside the folder */
	ck_assert_ptr_null(strstr(page, "http"));
	ck_assert_ptr_null(strstr(page, dir));
	ck_assert_int_eq(access(in_dir("fig2.2/plot.png"), R_OK), 0);
	ck_assert_int_eq(access(in_dir("fig2.9/plot.csv"), R_OK), 0);
	optla_free(ctx, bytes);
	optla_ctx_destroy(&ctx);
	remove_dir();
}
END_TEST

START_TEST(unknown_figures_are_named)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	const optla_reproduce_options o = {.size = sizeof o, .out_dir = "/nonexistent/x", .seed = 1};
	const char *ids[] = {"fig2.2", "fig9.9"};
	size_t failed = 9;
	/* found before anything runs: the folder isn't even made */
	status_is(optla_reproduce(ctx, ids, 2, &o, &failed), OPTLA_ERR_ARG);
	ck_assert_uint_eq(failed, 0);
	ck_assert_ptr_nonnull(strstr(e.text, "'fig9.9'"));
	const char *title;
	size_t k = 0;
	for (const char *id; (id = optla_reproduce_id(k, &title)); k++) {
		ck_assert_ptr_nonnull(strstr(e.text, id));
		ck_assert_ptr_nonnull(title);
	}
	ck_assert_uint_ge(k, 6);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
	make_dir();
	for (long k = 0;; k++) {
		alloc_budget b = {.left = 1000000};
		const optla_ctx_desc d = {.size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b, .threads = 1};
		optla_ctx *ctx;
		ok(optla_ctx_create(&ctx, &d));
		const long live = b.live;
		b.left = k;
		const optla_status s = made_up_figure(ctx, "fig2.9", 0.25);
		const bool enough = b.left > 0;
		b.left = 1000000;
		if (s) ck_assert_int_eq(s, OPTLA_ERR_NOMEM);
		ck_assert_int_eq(b.live, live);
		optla_ctx_destroy(&ctx);
		ck_assert_int_eq(b.live, 0);
		if (enough) {
			ck_assert_int_eq(s, OPTLA_OK);
			break;
		}
	}
	remove_dir();
}
END_TEST

int main(void)
{
	Suite *s = suite_create("plot");
	TCase *t = tcase_create("plot");
	tcase_set_timeout(t, 120);
	tcase_add_test(t, chart_has_ink_where_the_data_are);
	tcase_add_test(t, what_cannot_be_shown_is_left_out);
	tcase_add_test(t, ticks_are_round_numbers);
	tcase_add_test(t, axes_of_any_range_hold_their_data);
	tcase_add_test(t, wrong_plots_are_errors);
	tcase_add_test(t, charts_need_no_fonts);
	tcase_add_test(t, csv_comes_back);
	tcase_add_test(t, html_is_escaped);
	tcase_add_test(t, sheets_hold_their_pictures);
	tcase_add_test(t, numbers_are_ok_only_within_their_range);
	tcase_add_test(t, numbers_json_has_the_agreed_form);
	tcase_add_test(t, page_keeps_earlier_sections_and_escapes);
	tcase_add_test(t, unknown_figures_are_named);
	tcase_add_test(t, every_allocation_may_fail);
	suite_add_tcase(s, t);
	return run_suite(s);
}
