/* SPDX-License-Identifier: BSD-3-Clause */
/* The small problem whose saved runs fuzz_seeds writes and fuzz_krylov reads. */
#ifndef OPTLA_FUZZ_KRYLOV_PROBLEM_H
#define OPTLA_FUZZ_KRYLOV_PROBLEM_H

#include "optla/krylov.h"

#include <stdlib.h>

enum { FUZZ_ROWS = 5, FUZZ_COLUMNS = 4 };

/* The arrays must stay until the operator is gone. */
static inline optla_op *fuzz_op(optla_ctx *ctx, double matrix[FUZZ_ROWS * FUZZ_COLUMNS], double target[FUZZ_ROWS])
{
	for (int k = 0; k < FUZZ_ROWS * FUZZ_COLUMNS; k++) matrix[k] = (double)(k * 37 % 61) / 61;
	for (int k = 0; k < FUZZ_ROWS; k++) target[k] = 1 + (double)k / FUZZ_ROWS;
	const optla_cblock t = {matrix, FUZZ_ROWS, FUZZ_COLUMNS, FUZZ_ROWS, OPTLA_F64};
	optla_op *op;
	if (OPTLA_OK != optla_op_dense(ctx, t, false, &op)) abort();
	return op;
}

#endif
