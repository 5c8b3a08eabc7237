/* SPDX-License-Identifier: BSD-3-Clause */
/* Grey photos from colour ones, as an operator (section 2.4). */
#include "capture/rig_impl.h"
#include "math/dense.h"

optla_status optla_rig_grey_reduction(const optla_rig *rig, optla_scalar type, optla_op **out)
{
	optla_ctx *ctx = rig->ctx;
	*out = NULL;
	OPTLA_CHECK(ctx, type == OPTLA_F32 || type == OPTLA_F64, OPTLA_ERR_ARG, "photos are of F32 or F64, %d is neither", (int)type);
	const size_t n = rig->info.npixels, c = rig->info.channels;
	uint64_t *start = optla_array_(ctx, n + 1, sizeof *start);
	uint32_t *column = optla_array_(ctx, n * c, sizeof *column);
	const optla_block values = optla_block_(optla_array_(ctx, n * c, optla_scalar_bytes(type)), n * c, 1, type);
	optla_status status = start && column && values.data ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!status) {
		for (size_t m = 0; m <= n; m++) start[m] = m * c;
		for (size_t k = 0; k < n * c; k++) {
			column[k] = (uint32_t)(k % c * n + k / c);
			optla_set_(values, k, 0, 1.0 / (double)c);
		}
		status = optla_op_sparse(ctx, n, n * c, start, column, optla_block_const(values), out);
	}
	optla_free(ctx, start);
	optla_free(ctx, column);
	optla_free(ctx, values.data);
	return status;
}
