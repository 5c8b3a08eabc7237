/* SPDX-License-Identifier: BSD-3-Clause */
/* Sparse matrices in compressed rows. */
#ifndef OPTLA_SPARSE_H
#define OPTLA_SPARSE_H

#include "base/base_impl.h"
#include "optla/op.h"

typedef struct {
	size_t nrows, ncols;
	optla_scalar type;
	uint64_t *row_start; /* nrows + 1 */
	uint32_t *column;    /* row_start[nrows] */
	void *values;        /* row_start[nrows] scalars */
} optla_csr;

/* The input has been checked. On failure *a is empty. */
optla_status optla_csr_copy_(optla_ctx *ctx, size_t nrows, size_t ncols, const uint64_t *row_start, const uint32_t *column,
                             optla_cblock values, optla_csr *a);
/* Without conjugation; columns of each row of the result ascend. On failure *at is empty. */
optla_status optla_csr_transpose_(optla_ctx *ctx, const optla_csr *a, optla_csr *at);
void optla_csr_clear_(optla_ctx *ctx, optla_csr *a);
/* y = A x; sums in double for real types, in the order of the columns. */
void optla_csr_apply_(optla_ctx *ctx, const optla_csr *a, optla_cblock x, optla_block y);

#endif
