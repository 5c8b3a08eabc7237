/* SPDX-License-Identifier: BSD-3-Clause */
/* One relit photo by kernel Nyström. */
#include "report/nystroem_photo.h"

#include "math/dense.h"
#include "relight/basis.h"

#include <math.h>
#include <string.h>

static const double exponents[] = {0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1, 1.25, 1.6};
static const double tolerances[] = {1e-7, 1e-5, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1};

typedef struct {
	size_t nrows, ncols, k, light;
	size_t *row, *column;      /* random orders of all rows, all columns */
	double *c, *r;             /* nrows x k photos of single lights; ncols x k: rows of T */
	double *w, *b, *x, *photo; /* W^γ, column `light` of R^γ, (W^γ)⁺ of it, the relit photo */
} nystroem;

/* Light that noise made negative counts as none. */
static double bend(double x, double exponent) { return x > 0 ? pow(x, exponent) : 0; }

static optla_status take(optla_figure *figure, nystroem *n, optla_op *single)
{
	double *unit;
	OPTLA_TRY(optla_figure_doubles_(figure, optla_max_(n->nrows, n->ncols), &unit));
	for (size_t j = 0; j < n->k; j++) {
		unit[n->column[j]] = 1;
		OPTLA_TRY(optla_lab_apply_(figure, single, OPTLA_FORWARD, unit, n->c + j * n->nrows));
		unit[n->column[j]] = 0;
		unit[n->row[j]] = 1;
		OPTLA_TRY(optla_lab_apply_(figure, single, OPTLA_TRANSPOSE, unit, n->r + j * n->ncols));
		unit[n->row[j]] = 0;
	}
	return OPTLA_OK;
}

static optla_status relight(optla_figure *figure, nystroem *n, double exponent, double tolerance)
{
	const size_t k = n->k;
	for (size_t j = 0; j < k; j++) {
		for (size_t i = 0; i < k; i++) {
			/* each crossing was photographed from both sides */
			const double t = 0.5 * (n->c[j * n->nrows + n->row[i]] + n->r[i * n->ncols + n->column[j]]);
			n->w[j * k + i] = bend(t, exponent);
		}
		n->b[j] = bend(n->r[j * n->ncols + n->light], exponent);
	}
	OPTLA_TRY(optla_lstsq_(figure->ctx, n->w, k, k, n->b, 1, tolerance, n->x, NULL));
	memset(n->photo, 0, n->nrows * sizeof *n->photo);
	for (size_t j = 0; j < k; j++)
		for (size_t m = 0; m < n->nrows; m++) n->photo[m] += bend(n->c[j * n->nrows + m], exponent) * n->x[j];
	for (size_t m = 0; m < n->nrows; m++) n->photo[m] = bend(n->photo[m], 1 / exponent);
	return OPTLA_OK;
}

static optla_status search(optla_figure *figure, nystroem *n, const double *wanted, double *photo, double *exponent)
{
	double best = INFINITY;
	for (size_t e = 0; e < sizeof exponents / sizeof *exponents; e++)
		for (size_t t = 0; t < sizeof tolerances / sizeof *tolerances; t++) {
			OPTLA_TRY(relight(figure, n, exponents[e], tolerances[t]));
			const double error = optla_lab_relative_(n->photo, wanted, n->nrows);
			if (!(error < best)) continue;
			best = error;
			*exponent = exponents[e];
			memcpy(photo, n->photo, n->nrows * sizeof *photo);
		}
	return OPTLA_OK;
}

optla_status optla_lab_nystroem_photo_(optla_figure *figure, optla_op *single, size_t k, size_t light, const double *wanted,
                                       double *photo, double *exponent)
{
	enum { COLUMNS = 1, ROWS = 2 };
	nystroem n = {.nrows = optla_op_nrows(single), .ncols = optla_op_ncols(single), .k = k, .light = light};
	OPTLA_TRY(optla_figure_doubles_(figure, n.nrows * k, &n.c));
	OPTLA_TRY(optla_figure_doubles_(figure, n.ncols * k, &n.r));
	OPTLA_TRY(optla_figure_doubles_(figure, k * k, &n.w));
	OPTLA_TRY(optla_figure_doubles_(figure, k, &n.b));
	OPTLA_TRY(optla_figure_doubles_(figure, k, &n.x));
	OPTLA_TRY(optla_figure_doubles_(figure, n.nrows, &n.photo));
	optla_status s = optla_permutation_(figure->ctx, figure->seed, COLUMNS, n.ncols, &n.column);
	if (OPTLA_OK == s) s = optla_permutation_(figure->ctx, figure->seed, ROWS, n.nrows, &n.row);
	if (OPTLA_OK == s) s = take(figure, &n, single);
	if (OPTLA_OK == s) s = search(figure, &n, wanted, photo, exponent);
	optla_free(figure->ctx, n.column);
	optla_free(figure->ctx, n.row);
	return s;
}
