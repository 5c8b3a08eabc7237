/* SPDX-License-Identifier: BSD-3-Clause */
/* The page of reproduced figures: plain HTML with its own style, relative pictures, nothing fetched from elsewhere. */
#include "report/page.h"

#include "io/whole_file.h"

#include <string.h>

static const char style[] =
    "body{font:16px/1.5 system-ui,sans-serif;color:#222;background:#fff;max-width:76rem;margin:2rem auto;padding:0 1.2rem}\n"
    "h1{font-size:1.7rem;margin:0 0 .3rem}h2{font-size:1.35rem;margin:3rem 0 .3rem;border-top:2px solid #ddd;padding-top:1rem}\n"
    "h3{font-size:1.05rem;margin:1.6rem 0 .3rem}p{max-width:62rem;margin:.5rem 0}a{color:#0072b2}\n"
    "figure{margin:1rem 0}figure img{max-width:100%;height:auto;image-rendering:auto;border:1px solid #e4e4e4}\n"
    "figcaption{font-size:.9rem;color:#444;max-width:62rem}\n"
    "table{border-collapse:collapse;font-size:.9rem;margin:.8rem 0}th,td{padding:.25rem .7rem;border-bottom:1px solid #e4e4e4;"
    "text-align:left;vertical-align:top}td.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}\n"
    "th{border-bottom:2px solid #bbb}.good{color:#00694d;font-weight:600}.bad{color:#fff;background:#b33c00;font-weight:600;"
    "padding:0 .4em}\n.made{font-size:.85rem;color:#555}.made code{font-size:.85rem;overflow-wrap:anywhere}\n"
    "nav table td:first-child{white-space:nowrap}\n";

/* ---- a section ---- */

/* Lines of the provenance: the inputs can be many, so they are folded. */
static optla_status add_provenance(optla_text *t, double wall_s)
{
	char *provenance;
	OPTLA_TRY(optla_ctx_provenance(t->ctx, &provenance));
	optla_text inputs = {.ctx = t->ctx};
	size_t ninputs = 0;
	optla_text_add_(t, "<p class=made>");
	for (char *rest = provenance, *line; (line = rest) && *line;) {
		rest = strchr(line, '\n');
		if (rest) *rest++ = 0;
		const bool input = !strncmp(line, "input: ", 7);
		optla_text_add_html_(input ? &inputs : t, input ? "%s\n" : "%s · ", input ? line + 7 : line);
		ninputs += input;
	}
	optla_text_add_(t, "took %.1f s</p>\n", wall_s);
	if (ninputs) optla_text_add_(t, "<details class=made><summary>%zu input files</summary><pre>", ninputs);
	if (inputs.data) optla_text_add_bytes_(t, inputs.data, inputs.count);
	if (ninputs) optla_text_add_(t, "</pre></details>\n");
	const optla_status s = inputs.status;
	optla_text_free_(&inputs);
	optla_free(t->ctx, provenance);
	return OPTLA_OK == s ? t->status : s;
}

static void add_value(optla_text *t, double value)
{
	/* whole numbers in full, others to five digits */
	if (fabs(value) < 1e9 && value == floor(value))
		optla_text_add_(t, "%.0f", value == 0 ? 0.0 : value);
	else
		optla_text_add_(t, "%.5g", value);
}

static void add_range(optla_text *t, const optla_number *n)
{
	if (isinf(n->low) && isinf(n->high)) {
		optla_text_add_(t, "reported");
		return;
	}
	if (n->low == n->high) {
		add_value(t, n->low);
		return;
	}
	if (!isinf(n->low)) {
		if (isinf(n->high)) optla_text_add_(t, "≥ ");
		add_value(t, n->low);
	}
	if (!isinf(n->low) && !isinf(n->high)) optla_text_add_(t, " … ");
	if (!isinf(n->high)) {
		if (isinf(n->low)) optla_text_add_(t, "≤ ");
		add_value(t, n->high);
	}
}

static void add_number(optla_text *t, const optla_number *n)
{
	optla_text_add_(t, "<tr><td>");
	optla_text_add_html_(t, "%s", n->name);
	optla_text_add_(t, "</td><td class=n>");
	add_value(t, n->value);
	optla_text_add_html_(t, "%s%s", *n->unit ? " " : "", n->unit);
	optla_text_add_(t, "</td><td class=n>");
	if (isfinite(n->thesis))
		add_value(t, n->thesis);
	else
		optla_text_add_(t, "–");
	optla_text_add_(t, "</td><td class=n>");
	add_range(t, n);
	optla_text_add_(t, "</td><td>%s</td><td>",
	                optla_number_ok_(n) ? "<span class=good>ok</span>" : "<span class=bad>not ok</span>");
	optla_text_add_html_(t, "%s", n->why);
	optla_text_add_(t, "</td></tr>\n");
}

static void add_numbers(optla_text *t, const optla_numbers *numbers)
{
	if (numbers->count == 0) return;
	optla_text_add_(t, "<h3>Numbers</h3>\n<table>\n<tr><th>what</th><th>here</th><th>thesis</th><th>allowed</th><th></th>"
	                   "<th>where the range comes from</th></tr>\n");
	for (size_t k = 0; k < numbers->count; k++) add_number(t, &numbers->item[k]);
	optla_text_add_(t, "</table>\n");
}

static optla_status write_in(optla_ctx *ctx, const char *dir, const char *name, const char *text, size_t count)
{
	char *path = optla_path_join_(ctx, dir, name);
	const optla_status s = path ? optla_write_file_(ctx, path, text, count) : OPTLA_ERR_NOMEM;
	optla_free(ctx, path);
	return s;
}

static optla_status save_numbers(const optla_figure *figure, double wall_s)
{
	char *path = optla_path_join_(figure->ctx, figure->dir, "numbers.json");
	const optla_status s = path ? optla_numbers_save_(&figure->numbers, path, figure->id, figure->seed, wall_s) : OPTLA_ERR_NOMEM;
	optla_free(figure->ctx, path);
	return s;
}

optla_status optla_page_save_section_(optla_figure *figure, double wall_s)
{
	optla_figure_end_table_(figure);
	OPTLA_TRY(figure->body.status);
	optla_text t = {.ctx = figure->ctx};
	optla_text_add_(&t, "<section id=\"");
	optla_text_add_html_(&t, "%s", figure->id);
	optla_text_add_(&t, "\">\n<h2>");
	optla_text_add_html_(&t, "%s – %s", figure->id, figure->title);
	optla_text_add_(&t, "</h2>\n");
	optla_status s = add_provenance(&t, wall_s);
	if (figure->body.data) optla_text_add_bytes_(&t, figure->body.data, figure->body.count);
	add_numbers(&t, &figure->numbers);
	optla_text_add_(&t, "</section>\n");
	if (OPTLA_OK == s) s = t.status;
	/* numbers first: a section never stands in the page without them */
	if (OPTLA_OK == s) s = save_numbers(figure, wall_s);
	if (OPTLA_OK == s) s = write_in(figure->ctx, figure->dir, "section.html", t.data, t.count);
	optla_text_free_(&t);
	return s;
}

/* ---- the index ---- */

static optla_status add_summary(optla_text *t, const char *dir, const char *id, const char *title)
{
	size_t count, failed;
	char *path = optla_path_join_(t->ctx, dir, "numbers.json");
	const optla_status s = path ? optla_numbers_summary_(t->ctx, path, &count, &failed) : OPTLA_ERR_NOMEM;
	optla_free(t->ctx, path);
	OPTLA_TRY(s);
	optla_text_add_(t, "<tr><td><a href=\"#");
	optla_text_add_html_(t, "%s", id);
	optla_text_add_(t, "\">");
	optla_text_add_html_(t, "%s", id);
	optla_text_add_(t, "</a></td><td>");
	optla_text_add_html_(t, "%s", title);
	if (failed)
		optla_text_add_(t, "</td><td><span class=bad>%zu of %zu not ok</span></td></tr>\n", failed, count);
	else
		optla_text_add_(t, "</td><td><span class=good>%zu ok</span></td></tr>\n", count);
	return t->status;
}

static optla_status add_section(optla_text *t, const char *path)
{
	void *bytes;
	size_t count;
	OPTLA_TRY(optla_read_output_(t->ctx, path, &bytes, &count));
	optla_text_add_bytes_(t, bytes, count);
	optla_free(t->ctx, bytes);
	return t->status;
}

/* Collects what out_dir/id holds, if anything. */
static optla_status add_figure(optla_text *nav, optla_text *sections, const char *out_dir, const char *id, const char *title)
{
	char *dir = optla_path_join_(nav->ctx, out_dir, id);
	char *path = dir ? optla_path_join_(nav->ctx, dir, "section.html") : NULL;
	optla_status s = path ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (path && optla_path_exists_(path)) {
		s = add_summary(nav, dir, id, title);
		if (OPTLA_OK == s) s = add_section(sections, path);
	}
	optla_free(nav->ctx, path);
	optla_free(nav->ctx, dir);
	return s;
}

optla_status optla_page_save_(optla_ctx *ctx, const char *out_dir, const char *title, const char *intro_html,
                              const optla_page_entry *entries, size_t count)
{
	optla_text nav = {.ctx = ctx}, sections = {.ctx = ctx}, page = {.ctx = ctx};
	optla_status s = OPTLA_OK;
	for (size_t k = 0; OPTLA_OK == s && k < count; k++) s = add_figure(&nav, &sections, out_dir, entries[k].id, entries[k].title);
	optla_text_add_(
	    &page,
	    "<!doctype html>\n<html lang=en><head><meta charset=utf-8>\n"
	    "<meta name=viewport content=\"width=device-width,initial-scale=1\">\n<title>%s</title>\n<style>\n%s</style></head>\n"
	    "<body>\n<h1>%s</h1>\n<p>%s</p>\n<nav><table>\n",
	    title, style, title, intro_html);
	if (nav.data) optla_text_add_bytes_(&page, nav.data, nav.count);
	optla_text_add_(&page, "</table></nav>\n");
	if (sections.data) optla_text_add_bytes_(&page, sections.data, sections.count);
	optla_text_add_(&page, "</body></html>\n");
	if (OPTLA_OK == s) s = page.status;
	if (OPTLA_OK == s) s = write_in(ctx, out_dir, "index.html", page.data, page.count);
	optla_text_free_(&nav);
	optla_text_free_(&sections);
	optla_text_free_(&page);
	return s;
}

optla_status optla_page_save_index_(optla_ctx *ctx, const char *out_dir)
{
	size_t count = 0;
	while (optla_reproduce_id(count, NULL)) count++;
	optla_page_entry *entries = optla_array_(ctx, count, sizeof *entries);
	if (!entries) return OPTLA_ERR_NOMEM;
	for (size_t k = 0; k < count; k++) entries[k].id = optla_reproduce_id(k, &entries[k].title);
	const optla_status s = optla_page_save_(ctx, out_dir, "Optla: figures and tables",
	                                        "Experiments of the thesis <em>Optical Linear Algebra for Computational Light "
	                                        "Transport</em> (M. O'Toole), run again with "
	                                        "Optla. Each section says what was done, shows what came out, and ends with its "
	                                        "numbers: ours, the thesis' where it gives "
	                                        "one, the range that is allowed and where that range comes from.",
	                                        entries, count);
	optla_free(ctx, entries);
	return s;
}
