/* SPDX-License-Identifier: BSD-3-Clause */
/* All columns of an operator, block by block. */
#include "relight/truth_walk.h"
#include "math/dense.h"

#include <string.h>

enum { BLOCK_BYTES = 64 << 20, BLOCK_COLUMNS = 64 };

optla_status optla_walk_begin_(optla_op *op, optla_walk *w)
{
	optla_ctx *ctx = optla_op_ctx(op);
	memset(w, 0, sizeof *w);
	w->op = op;
	w->type = optla_op_type(op);
	w->nrows = optla_op_nrows(op);
	w->ncols = optla_op_ncols(op);
	OPTLA_CHECK(ctx, OPTLA_F32 == w->type || OPTLA_F64 == w->type, OPTLA_ERR_UNSUPPORTED,
	            "operator '%s' is complex: this needs a real one", optla_op_name(op));
	const size_t bytes = optla_scalar_bytes(w->type);
	const size_t fit = BLOCK_BYTES / (bytes * (w->nrows + w->ncols) + 1);
	w->block = optla_min_(w->ncols, optla_min_(BLOCK_COLUMNS, optla_max_(1, fit)));
	w->unit = optla_calloc_(ctx, w->ncols * w->block, bytes);
	w->columns = optla_array_(ctx, w->nrows * w->block, bytes);
	if (w->unit && w->columns) return OPTLA_OK;
	optla_walk_end_(w);
	return OPTLA_ERR_NOMEM;
}

static void set_units(optla_walk *w, size_t first, size_t count, double value)
{
	const optla_block unit = optla_block_(w->unit, w->ncols, count, w->type);
	for (size_t j = 0; j < count; j++) optla_set_(unit, first + j, j, value);
}

optla_status optla_walk_next_(optla_walk *w, optla_cblock *columns, bool *more)
{
	const size_t count = optla_min_(w->block, w->ncols - w->first);
	*more = count > 0;
	if (!*more) return OPTLA_OK;
	set_units(w, w->first, count, 1);
	const optla_status s = optla_op_apply(w->op, OPTLA_FORWARD, optla_cblock_(w->unit, w->ncols, count, w->type),
	                                      optla_block_(w->columns, w->nrows, count, w->type));
	set_units(w, w->first, count, 0);
	*columns = optla_cblock_(w->columns, w->nrows, count, w->type);
	w->first += count;
	return s;
}

void optla_walk_end_(optla_walk *w)
{
	optla_ctx *ctx = optla_op_ctx(w->op);
	optla_free(ctx, w->unit);
	optla_free(ctx, w->columns);
	w->unit = w->columns = NULL;
}

void optla_rows_(optla_cblock a, size_t column, size_t first, size_t rows, double *out)
{
	const size_t at = column * a.ld + first;
	if (OPTLA_F32 == a.type) {
		const float *v = (const float *)a.data + at;
		for (size_t m = 0; m < rows; m++) out[m] = (double)v[m];
	} else {
		memcpy(out, (const double *)a.data + at, rows * sizeof *out);
	}
}
