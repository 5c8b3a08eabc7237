/* SPDX-License-Identifier: BSD-3-Clause */
/* Walking over all columns of an operator in blocks that fit in memory: what error curves and correspondences are made of. */
#ifndef OPTLA_TRUTH_WALK_H
#define OPTLA_TRUTH_WALK_H

#include "base/base_impl.h"
#include "optla/op.h"

typedef struct {
	optla_op *op;
	optla_scalar type;
	size_t nrows, ncols, block; /* columns in one step */
	size_t first;               /* of the current block */
	void *unit, *columns;       /* ncols x block unit vectors; nrows x block products */
} optla_walk;

/* Real operators only. Columns are products with unit vectors. */
optla_status optla_walk_begin_(optla_op *op, optla_walk *walk);
/* Next block of columns first .. first + ncols - 1; *more false after the last. The view lives until the next step. */
optla_status optla_walk_next_(optla_walk *walk, optla_cblock *columns, bool *more);
void optla_walk_end_(optla_walk *walk);

/* Rows first .. first + rows - 1 of one column, as doubles. */
void optla_rows_(optla_cblock a, size_t column, size_t first, size_t rows, double *out);

#endif
