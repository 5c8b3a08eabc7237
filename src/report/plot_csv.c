/* SPDX-License-Identifier: BSD-3-Clause */
/* The numbers of a chart as CSV (RFC 4180), with comment lines that say how they were made. */
#include "io/whole_file.h"
#include "optla/report.h"
#include "report/text.h"

#include <math.h>
#include <string.h>

/* Fields with commas, quotes or line ends are quoted; so is an empty one, and one that would look like a comment. */
static void add_field(optla_text *text, const char *field)
{
	if (*field && *field != '#' && !strpbrk(field, ",\"\r\n")) {
		optla_text_add_(text, "%s", field);
		return;
	}
	optla_text_add_(text, "\"");
	for (; *field; field++) {
		if (*field == '"') optla_text_add_(text, "\"");
		optla_text_add_bytes_(text, field, 1);
	}
	optla_text_add_(text, "\"");
}

static void add_number(optla_text *text, double value)
{
	/* 17 digits bring back the same double; what isn't a number is left empty */
	char digits[32];
	optla_double_text_(value, 17, digits, sizeof digits);
	if (isfinite(value)) optla_text_add_(text, "%s", digits);
}

optla_status optla_plot_save_csv(optla_ctx *ctx, const optla_plot *plot, const char *path)
{
	OPTLA_CHECK(ctx, plot->size == sizeof *plot, OPTLA_ERR_ARG, "optla_plot.size is %zu, this library knows %zu", plot->size,
	            sizeof *plot);
	char *provenance;
	OPTLA_TRY(optla_ctx_provenance(ctx, &provenance));
	optla_text text = {.ctx = ctx};
	for (char *rest = provenance, *line; (line = rest) && *line;) {
		rest = strchr(line, '\n');
		if (rest) *rest++ = 0;
		optla_text_add_(&text, "# %s\n", line);
	}
	if (plot->title) optla_text_add_(&text, "# title: %.*s\n", (int)strcspn(plot->title, "\r\n"), plot->title);
	optla_text_add_(&text, "series,");
	add_field(&text, plot->x_label ? plot->x_label : "x");
	optla_text_add_(&text, ",");
	add_field(&text, plot->y_label ? plot->y_label : "y");
	optla_text_add_(&text, "\n");
	for (size_t k = 0; k < plot->nseries; k++)
		for (size_t i = 0; i < plot->series[k].count; i++) {
			add_field(&text, plot->series[k].label ? plot->series[k].label : "");
			optla_text_add_(&text, ",");
			add_number(&text, plot->series[k].x[i]);
			optla_text_add_(&text, ",");
			add_number(&text, plot->series[k].y[i]);
			optla_text_add_(&text, "\n");
		}
	optla_status s = text.status;
	if (OPTLA_OK == s) s = optla_write_file_(ctx, path, text.data, text.count);
	optla_text_free_(&text);
	optla_free(ctx, provenance);
	return s;
}
