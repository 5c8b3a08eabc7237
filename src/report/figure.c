/* SPDX-License-Identifier: BSD-3-Clause */
/* A figure's text, pictures, numbers and belongings. */
#include "report/figure.h"

#include "io/whole_file.h"

#include <string.h>

optla_status optla_figure_init_(optla_figure *figure, optla_ctx *ctx, const char *id, const char *title,
                                const optla_reproduce_options *options)
{
	*figure = (optla_figure){.ctx = ctx,
	                         .id = id,
	                         .title = title,
	                         .out_dir = options->out_dir,
	                         .data_dir = options->data_dir,
	                         .seed = options->seed,
	                         .numbers = {.ctx = ctx},
	                         .body = {.ctx = ctx}};
	figure->dir = optla_path_join_(ctx, options->out_dir, id);
	optla_status s = figure->dir ? optla_make_dirs_(ctx, figure->dir) : OPTLA_ERR_NOMEM;
	if (OPTLA_OK != s) optla_figure_clear_(figure);
	return s;
}

void optla_figure_clear_(optla_figure *figure)
{
	while (figure->nheld > 0) {
		const optla_figure_held *h = &figure->held[--figure->nheld];
		h->destroy(figure->ctx, h->object);
	}
	optla_free(figure->ctx, figure->held);
	optla_free(figure->ctx, figure->dir);
	optla_numbers_free_(&figure->numbers);
	optla_text_free_(&figure->body);
	figure->held = NULL;
	figure->dir = NULL;
	figure->held_room = 0;
}

optla_status optla_figure_hold_(optla_figure *figure, void *object, void (*destroy)(optla_ctx *ctx, void *object))
{
	if (figure->nheld == figure->held_room) {
		void *held = figure->held;
		const size_t room = 2 * figure->held_room + 16;
		const optla_status s = optla_grow_(figure->ctx, &held, figure->nheld, room, sizeof *figure->held);
		if (OPTLA_OK != s) {
			destroy(figure->ctx, object);
			return s;
		}
		figure->held = held;
		figure->held_room = room;
	}
	figure->held[figure->nheld++] = (optla_figure_held){object, destroy};
	return OPTLA_OK;
}

optla_status optla_figure_doubles_(optla_figure *figure, size_t count, double **out)
{
	*out = optla_calloc_(figure->ctx, count, sizeof **out);
	if (!*out) return OPTLA_ERR_NOMEM;
	const optla_status s = optla_figure_hold_(figure, *out, optla_free);
	if (OPTLA_OK != s) *out = NULL;
	return s;
}

void optla_figure_end_table_(optla_figure *figure)
{
	const char *const end = "</tr>\n";
	const optla_text *t = &figure->body;
	if (t->count >= strlen(end) && !strcmp(t->data + t->count - strlen(end), end)) optla_text_add_(&figure->body, "</table>\n");
}

void optla_figure_row_(optla_figure *figure, bool head, const char *const *cells, size_t count)
{
	const char *const end = "</tr>\n";
	optla_text *t = &figure->body;
	if (t->count < strlen(end) || strcmp(t->data + t->count - strlen(end), end) != 0) optla_text_add_(t, "<table>\n");
	optla_text_add_(t, "<tr>");
	for (size_t k = 0; k < count; k++) {
		optla_text_add_(t, head ? "<th>" : k ? "<td class=n>" : "<td>");
		optla_text_add_html_(t, "%s", cells[k]);
		optla_text_add_(t, head ? "</th>" : "</td>");
	}
	optla_text_add_(t, "%s", end);
}

void optla_figure_heading_(optla_figure *figure, const char *text)
{
	optla_figure_end_table_(figure);
	optla_text_add_(&figure->body, "<h3>");
	optla_text_add_html_(&figure->body, "%s", text);
	optla_text_add_(&figure->body, "</h3>\n");
}

void optla_figure_say_(optla_figure *figure, const char *format, ...)
{
	va_list arguments;
	optla_figure_end_table_(figure);
	optla_text_add_(&figure->body, "<p>");
	va_start(arguments, format);
	optla_text_add_html_v_(&figure->body, format, arguments);
	va_end(arguments);
	optla_text_add_(&figure->body, "</p>\n");
}

/* <figure> with a picture that lies in the figure's folder; csv NULL: no link. Paths are relative to index.html. */
static void show(optla_figure *figure, const optla_image *image, const char *file, const char *csv, const char *caption)
{
	optla_text *t = &figure->body;
	optla_figure_end_table_(figure);
	optla_text_add_(t, "<figure><img src=\"");
	optla_text_add_html_(t, "%s/%s", figure->id, file);
	/* charts are drawn at one and a half times the size they are shown at, to be sharp on fine screens */
	optla_text_add_(t, "\" width=\"%zu\" height=\"%zu\" alt=\"", csv ? image->width * 2 / 3 : image->width,
	                csv ? image->height * 2 / 3 : image->height);
	optla_text_add_html_(t, "%s", caption);
	optla_text_add_(t, "\"><figcaption>");
	optla_text_add_html_(t, "%s", caption);
	if (csv) {
		optla_text_add_(t, " <a href=\"");
		optla_text_add_html_(t, "%s/%s", figure->id, csv);
		optla_text_add_(t, "\">CSV</a>");
	}
	optla_text_add_(t, "</figcaption></figure>\n");
}

static optla_status save(optla_figure *figure, const optla_image *image, const char *file)
{
	char *path = optla_path_join_(figure->ctx, figure->dir, file);
	const optla_status s = path ? optla_image_save(image, path) : OPTLA_ERR_NOMEM;
	optla_free(figure->ctx, path);
	return s;
}

optla_status optla_figure_image_(optla_figure *figure, const optla_image *image, const char *file, const char *caption)
{
	OPTLA_TRY(save(figure, image, file));
	show(figure, image, file, NULL, caption);
	return figure->body.status;
}

static optla_status save_plot(optla_figure *figure, const optla_plot *plot, const optla_image *image, const char *name,
                              const char *caption)
{
	char png[64], csv[64];
	snprintf(png, sizeof png, "%s.png", name);
	snprintf(csv, sizeof csv, "%s.csv", name);
	OPTLA_TRY(save(figure, image, png));
	char *path = optla_path_join_(figure->ctx, figure->dir, csv);
	const optla_status s = path ? optla_plot_save_csv(figure->ctx, plot, path) : OPTLA_ERR_NOMEM;
	optla_free(figure->ctx, path);
	show(figure, image, png, csv, caption);
	return OPTLA_OK == s ? figure->body.status : s;
}

optla_status optla_figure_plot_(optla_figure *figure, const optla_plot *plot, const char *name, const char *caption)
{
	optla_plot large = *plot;
	large.width = (plot->width ? plot->width : 720) * 3 / 2;
	large.height = (plot->height ? plot->height : 480) * 3 / 2;
	optla_image *image;
	OPTLA_TRY(optla_plot_draw(figure->ctx, &large, &image));
	const optla_status s = save_plot(figure, plot, image, name, caption);
	optla_image_destroy(&image);
	return s;
}

optla_status optla_figure_number_(optla_figure *figure, double value, optla_expect expect, const char *name_format, ...)
{
	char name[160];
	va_list arguments;
	va_start(arguments, name_format);
	vsnprintf(name, sizeof name, name_format, arguments);
	va_end(arguments);
	return optla_numbers_add_(&figure->numbers, name, value, expect);
}
