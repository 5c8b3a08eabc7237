/* SPDX-License-Identifier: BSD-3-Clause */
/* The parts of the Nystroem captures: nystroem.c takes photos, nystroem_fit.c makes the best of them. */
#ifndef OPTLA_NYSTROEM_H
#define OPTLA_NYSTROEM_H

#include "relight/capture_impl.h"

enum { OPTLA_NYSTROEM_CHUNK = 256 }; /* rows that are summed together */

typedef struct {
	const optla_capture_job *job;
	bool kernel;
	size_t most;                        /* largest k */
	size_t *column, *row, *sample_row;  /* random orders: of all columns; of all rows, twice */
	size_t nsample;                     /* rows of the sample */
	optla_block c, r, unit;             /* nrows x most; ncols x most (row i of T is column i); one unit vector */
	double *sample;                     /* nsample x ncols: rows of the truth */
	double *cg, *w, *u, *s, *vt, *rg;   /* C^γ; W^γ and its SVD; R^γ as ncols x k */
	double *middle, *mixed, *chunk_sum; /* (W^γ)⁺ R^γ, k x ncols, by column; its factor; sums of the chunks */
} optla_nystroem;

/* Exponent (1 without a kernel) and tolerance with the smallest error on the sample, for the first k rows and columns. */
typedef struct {
	double exponent, tolerance, error;
} optla_nystroem_choice;

optla_status optla_nystroem_search_(optla_nystroem *y, size_t k, optla_nystroem_choice *best);
/* Relative error of that choice against all of the truth. */
optla_status optla_nystroem_error_(optla_nystroem *y, size_t k, optla_nystroem_choice choice, double *error);

#endif
