/* SPDX-License-Identifier: BSD-3-Clause */
/* Which light reaches a camera pixel most (Eq. 1.11). */
#include "optla/relight.h"
#include "relight/truth_walk.h"

#include <math.h>

enum { CHUNK_ROWS = 512 };

/* Running maximum and sum of the rows of one chunk, over the columns of one block. */
static void look_chunk(optla_cblock columns, size_t first_column, size_t first, size_t rows, uint32_t *light, double *best,
                       double *sum)
{
	double t[CHUNK_ROWS];
	for (size_t j = 0; j < columns.ncols; j++) {
		optla_rows_(columns, j, first, rows, t);
		for (size_t m = 0; m < rows; m++) {
			sum[first + m] += t[m];
			if (t[m] > best[first + m]) { /* ties: the first light */
				best[first + m] = t[m];
				light[first + m] = (uint32_t)(first_column + j);
			}
		}
	}
}

static void look(optla_ctx *ctx, optla_cblock columns, size_t first_column, uint32_t *light, double *best, double *sum)
{
#pragma omp parallel for num_threads(optla_ctx_threads(ctx)) schedule(static)
	for (size_t m = 0; m < columns.nrows; m += CHUNK_ROWS)
		look_chunk(columns, first_column, m, optla_min_(CHUNK_ROWS, columns.nrows - m), light, best, sum);
}

static optla_status walk(optla_ctx *ctx, optla_walk *w, uint32_t *light, double *best, double *sum)
{
	for (size_t m = 0; m < w->nrows; m++) best[m] = -INFINITY, sum[m] = 0, light[m] = 0;
	for (bool more;;) {
		optla_cblock columns;
		const size_t first = w->first;
		OPTLA_TRY(optla_walk_next_(w, &columns, &more));
		if (!more) return OPTLA_OK;
		look(ctx, columns, first, light, best, sum);
	}
}

optla_status optla_correspondence(optla_op *t, uint32_t *light, double *strength, double *share)
{
	optla_ctx *ctx = optla_op_ctx(t);
	const size_t nrows = optla_op_nrows(t);
	OPTLA_CHECK(ctx, optla_op_ncols(t) <= UINT32_MAX, OPTLA_ERR_ARG,
	            "operator '%s' has %zu columns: too many to number in 32 bits", optla_op_name(t), optla_op_ncols(t));
	optla_walk w;
	OPTLA_TRY(optla_walk_begin_(t, &w));
	double *best = optla_array_(ctx, nrows, sizeof *best), *sum = best ? optla_array_(ctx, nrows, sizeof *sum) : NULL;
	const optla_status s = sum ? walk(ctx, &w, light, best, sum) : OPTLA_ERR_NOMEM;
	for (size_t m = 0; OPTLA_OK == s && m < nrows; m++) {
		if (strength) strength[m] = best[m];
		if (share) share[m] = sum[m] > 0 ? best[m] / sum[m] : 0;
	}
	optla_free(ctx, best);
	optla_free(ctx, sum);
	optla_walk_end_(&w);
	return s;
}
