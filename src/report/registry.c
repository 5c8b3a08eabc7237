/* SPDX-License-Identifier: BSD-3-Clause */
/* The figures and tables that can be reproduced: a new one is a file with its function and a line here. */
#include "report/figure.h"

#include "io/whole_file.h"
#include "report/page.h"

#include <string.h>

typedef struct {
	const char *id, *title;
	optla_figure_fn run;
} entry;

static const entry entries[] = {
    {"fig2.2", "Optical power iteration", optla_figure_power_iteration_},
    {"fig2.6", "Optical Arnoldi in action: its illuminations and photos", optla_figure_arnoldi_bases_},
    {"fig2.9", "Error of captured transport against photos and exposure time", optla_figure_capture_errors_},
    {"fig2.10", "Relighting with few photos", optla_figure_relighting_},
    {"fig2.12", "One light that imitates another, by optical GMRES", optla_figure_impostor_},
    {"eq2.11", "Relative errors by method and number of iterations", optla_figure_relative_errors_},
};
enum { ENTRIES = sizeof entries / sizeof *entries };

const char *optla_reproduce_id(size_t k, const char **title)
{
	if (title) *title = k < ENTRIES ? entries[k].title : NULL;
	return k < ENTRIES ? entries[k].id : NULL;
}

static const entry *find_entry(const char *id)
{
	for (size_t k = 0; k < ENTRIES; k++)
		if (!strcmp(entries[k].id, id)) return &entries[k];
	return NULL;
}

static optla_status check_ids(optla_ctx *ctx, const char *const *ids, size_t count)
{
	char known[256] = "";
	for (size_t k = 0, used = 0; k < ENTRIES; k++)
		used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", k ? ", " : "", entries[k].id);
	for (size_t k = 0; k < count; k++)
		OPTLA_CHECK(ctx, ids[k] && find_entry(ids[k]), OPTLA_ERR_ARG,
		            "'%s' is not a figure or table that can be reproduced: there are %s", ids[k] ? ids[k] : "", known);
	return OPTLA_OK;
}

static optla_status reproduce_one(optla_ctx *ctx, const entry *e, const optla_reproduce_options *options, bool *failed)
{
	optla_figure figure;
	const double started = optla_now_s_();
	OPTLA_TRY(optla_figure_init_(&figure, ctx, e->id, e->title, options));
	optla_status s = e->run(&figure);
	if (OPTLA_OK == s) s = optla_page_save_section_(&figure, optla_now_s_() - started);
	*failed = optla_numbers_failed_(&figure.numbers) > 0;
	for (size_t k = 0; k < figure.numbers.count; k++)
		if (!optla_number_ok_(&figure.numbers.item[k]))
			optla_log_(ctx, 0, "%s: %s = %g is not within %g .. %g", e->id, figure.numbers.item[k].name,
			           figure.numbers.item[k].value, figure.numbers.item[k].low, figure.numbers.item[k].high);
	optla_figure_clear_(&figure);
	return s;
}

optla_status optla_reproduce(optla_ctx *ctx, const char *const *ids, size_t count, const optla_reproduce_options *options,
                             size_t *failed)
{
	if (failed) *failed = 0;
	OPTLA_CHECK(ctx, options && options->size == sizeof *options, OPTLA_ERR_ARG,
	            "optla_reproduce_options.size is %zu, this library knows %zu", options ? options->size : 0, sizeof *options);
	OPTLA_CHECK(ctx, options->out_dir, OPTLA_ERR_ARG, "no folder given for the page (out_dir)");
	OPTLA_CHECK(ctx, options->seed <= INT64_MAX, OPTLA_ERR_ARG, "seed %llu does not fit in a JSON integer: at most %lld",
	            (unsigned long long)options->seed, (long long)INT64_MAX);
	OPTLA_TRY(check_ids(ctx, ids, count));
	const double started = optla_now_s_();
	for (size_t k = 0; k < count; k++) {
		bool not_ok;
		optla_log_(ctx, 1, "%s", ids[k]);
		OPTLA_TRY(reproduce_one(ctx, find_entry(ids[k]), options, &not_ok));
		if (failed) *failed += not_ok;
		/* after each one, so that a run that is stopped leaves a page of what is done */
		OPTLA_TRY(optla_page_save_index_(ctx, options->out_dir));
		OPTLA_TRY(optla_report_(ctx, "reproduce", k + 1, count, started, NULL, 0));
	}
	return OPTLA_OK;
}
