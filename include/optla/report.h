/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file report.h
 * Plots, pages, and the reproduction of the thesis' figures and tables.
 */
#ifndef OPTLA_REPORT_H
#define OPTLA_REPORT_H

#include "optla/base.h"
#include "optla/image.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
	const char *label;
	const double *x, *y;
	size_t count;
} optla_series;

typedef struct {
	size_t size;
	const char *title, *x_label, *y_label;
	bool log_x, log_y;
	double y_range[2]; /**< only points within are drawn; both 0: all. The CSV holds all in any case */
	const optla_series *series;
	size_t nseries;
	size_t width, height; /**< 0: 720 x 480 */
} optla_plot;

/** Line chart with axes, grid and legend as a DISPLAY image (Cairo). Points that aren't finite (or <= 0 on a log axis) are left out. */
OPTLA_API optla_status optla_plot_draw(optla_ctx *ctx, const optla_plot *plot, optla_image **out);
/** The same numbers as CSV (series,x,y), with the provenance in comment lines. */
OPTLA_API optla_status optla_plot_save_csv(optla_ctx *ctx, const optla_plot *plot, const char *path);

/** Options of `reproduce`. */
typedef struct {
	size_t size;
	const char *out_dir;  /**< pages and pictures go here */
	const char *data_dir; /**< real captures; NULL: only what needs none, said in the page */
	uint64_t seed;
} optla_reproduce_options;

/** Id of figure k ("fig2.9"), NULL after the last; *title what it shows. */
OPTLA_API const char *optla_reproduce_id(size_t k, const char **title);
/**
 * Runs figures or tables and writes DIR/ID/numbers.json, pictures, and a section each into DIR/index.html (sections of earlier runs stay).
 * @param failed number of figures with a number that isn't ok.
 * @return OPTLA_ERR_ARG for an unknown id, which is named together with those that exist.
 */
OPTLA_API optla_status optla_reproduce(optla_ctx *ctx, const char *const *ids, size_t count,
                                       const optla_reproduce_options *options, size_t *failed);

#ifdef __cplusplus
}
#endif
#endif
