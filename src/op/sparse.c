/* SPDX-License-Identifier: BSD-3-Clause */
/* Sparse matrix in compressed rows. Both directions of a product are made of whole rows, one thread for each, so the order of a sum
   never depends on the threads. For that the transpose is kept beside the matrix: scattering into y from several threads would
   need a private y for each of them (at 10⁶ columns more than most matrices) and would read memory at random. */
#include "math/sparse.h"
#include "math/dense.h"
#include "op/op_impl.h"

typedef struct {
	optla_ctx *ctx;
	optla_csr a, at;
} sparse_op;

static optla_status sparse_apply(void *user, optla_trans trans, optla_cblock x, optla_block y)
{
	const sparse_op *s = user;
	optla_csr_apply_(s->ctx, trans == OPTLA_FORWARD ? &s->a : &s->at, x, y);
	return OPTLA_OK;
}

static void sparse_destroy(void *user)
{
	sparse_op *s = user;
	optla_csr_clear_(s->ctx, &s->a);
	optla_csr_clear_(s->ctx, &s->at);
	optla_free(s->ctx, s);
}

static optla_status check_rows(optla_ctx *ctx, size_t nrows, size_t ncols, const uint64_t *row_start, const uint32_t *column,
                               size_t count)
{
	OPTLA_CHECK(ctx, row_start[0] == 0, OPTLA_ERR_ARG, "row_start[0] is %llu, not 0", (unsigned long long)row_start[0]);
	for (size_t i = 0; i < nrows; i++)
		OPTLA_CHECK(ctx, row_start[i] <= row_start[i + 1] && row_start[i + 1] <= count, OPTLA_ERR_ARG,
		            "row_start[%zu] is %llu; it must lie between row_start[%zu] = %llu and the number of values, %zu", i + 1,
		            (unsigned long long)row_start[i + 1], i, (unsigned long long)row_start[i], count);
	for (size_t i = 0; i < nrows; i++)
		for (uint64_t k = row_start[i]; k < row_start[i + 1]; k++) {
			OPTLA_CHECK(ctx, column[k] < ncols, OPTLA_ERR_ARG, "column %lu of entry %llu in row %zu is outside of 0 .. %zu",
			            (unsigned long)column[k], (unsigned long long)k, i, ncols - 1);
			OPTLA_CHECK(ctx, k == row_start[i] || column[k - 1] < column[k], OPTLA_ERR_ARG,
			            "columns of row %zu must ascend without repetition: %lu comes after %lu", i, (unsigned long)column[k],
			            (unsigned long)column[k - 1]);
		}
	return OPTLA_OK;
}

optla_status optla_op_sparse(optla_ctx *ctx, size_t nrows, size_t ncols, const uint64_t *row_start, const uint32_t *column,
                             optla_cblock values, optla_op **out)
{
	*out = NULL;
	OPTLA_CHECK(ctx, row_start, OPTLA_ERR_ARG, "row_start is NULL");
	OPTLA_TRY(optla_block_check_(ctx, "the values", values));
	OPTLA_CHECK(ctx, nrows <= UINT32_MAX && ncols <= UINT32_MAX, OPTLA_ERR_SHAPE,
	            "a sparse matrix has at most %lu rows and columns, not %zu x %zu", (unsigned long)UINT32_MAX, nrows, ncols);
	OPTLA_CHECK(ctx, row_start[nrows] == values.nrows && values.ncols == 1, OPTLA_ERR_SHAPE,
	            "row_start ends with %llu entries but the values are %zu x %zu", (unsigned long long)row_start[nrows],
	            values.nrows, values.ncols);
	OPTLA_CHECK(ctx, column || !values.nrows, OPTLA_ERR_ARG, "column is NULL");
	OPTLA_TRY(check_rows(ctx, nrows, ncols, row_start, column, values.nrows));
	OPTLA_TRY(optla_block_check_finite_(ctx, "the sparse matrix", values));
	sparse_op *s = optla_calloc_(ctx, 1, sizeof *s);
	if (!s) return OPTLA_ERR_NOMEM;
	s->ctx = ctx;
	optla_status status = optla_csr_copy_(ctx, nrows, ncols, row_start, column, values, &s->a);
	if (OPTLA_OK == status) status = optla_csr_transpose_(ctx, &s->a, &s->at);
	if (OPTLA_OK != status) {
		sparse_destroy(s);
		return status;
	}
	const optla_op_desc desc = {.size = sizeof desc,
	                            .name = "sparse",
	                            .nrows = nrows,
	                            .ncols = ncols,
	                            .type = values.type,
	                            .user = s,
	                            .apply = sparse_apply,
	                            .destroy = sparse_destroy};
	return optla_op_create(ctx, out, &desc);
}
