/* SPDX-License-Identifier: BSD-3-Clause */
/* One figure or table that is being reproduced: what it may use, what it says, shows and measures, and what it holds until its end. A
   figure is one file with one function and one line in the table of registry.c. */
#ifndef OPTLA_FIGURE_H
#define OPTLA_FIGURE_H

#include "optla/report.h"

#include "report/numbers.h"
#include "report/text.h"

typedef struct {
	void *object;
	void (*destroy)(optla_ctx *ctx, void *object);
} optla_figure_held;

typedef struct {
	optla_ctx *ctx;
	const char *id, *title;
	const char *out_dir, *data_dir; /* data_dir NULL: no real captures */
	char *dir;                      /* out_dir/id */
	uint64_t seed;
	optla_numbers numbers;
	optla_text body; /* HTML between the section's heading and its table of numbers */
	optla_figure_held *held;
	size_t nheld, held_room;
} optla_figure;

typedef optla_status (*optla_figure_fn)(optla_figure *figure);

/* Makes the folder. On failure nothing is held. */
optla_status optla_figure_init_(optla_figure *figure, optla_ctx *ctx, const char *id, const char *title,
                                const optla_reproduce_options *options);
void optla_figure_clear_(optla_figure *figure);

/* ---- what it holds: freed in reverse order by optla_figure_clear_() ---- */

/* Takes the object, also on failure (then it is destroyed at once). */
optla_status optla_figure_hold_(optla_figure *figure, void *object, void (*destroy)(optla_ctx *ctx, void *object));
/* count doubles, zeroed. */
optla_status optla_figure_doubles_(optla_figure *figure, size_t count, double **out);

/* ---- what it says and shows; all text is escaped ---- */

void optla_figure_heading_(optla_figure *figure, const char *text);
/* One paragraph. */
void optla_figure_say_(optla_figure *figure, const char *format, ...) OPTLA_PRINTF(2, 3);
/* A row of a table; a table starts at the first row after anything else. */
void optla_figure_row_(optla_figure *figure, bool head, const char *const *cells, size_t count);
/* Ends an open table; all other functions do so themselves. */
void optla_figure_end_table_(optla_figure *figure);
/* Writes a DISPLAY image as FILE (.png) in the figure's folder. */
optla_status optla_figure_image_(optla_figure *figure, const optla_image *image, const char *file, const char *caption);
/* Writes NAME.png and NAME.csv. */
optla_status optla_figure_plot_(optla_figure *figure, const optla_plot *plot, const char *name, const char *caption);

/* ---- what it measures ---- */

optla_status optla_figure_number_(optla_figure *figure, double value, optla_expect expect, const char *name_format, ...)
    OPTLA_PRINTF(4, 5);

/* The figures, in the order of the page; NULL after the last. */
optla_figure_fn optla_figure_function_(size_t k);

optla_status optla_figure_power_iteration_(optla_figure *figure);
optla_status optla_figure_arnoldi_bases_(optla_figure *figure);
optla_status optla_figure_capture_errors_(optla_figure *figure);
optla_status optla_figure_relighting_(optla_figure *figure);
optla_status optla_figure_impostor_(optla_figure *figure);
optla_status optla_figure_relative_errors_(optla_figure *figure);

#endif
