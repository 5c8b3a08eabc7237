/* SPDX-License-Identifier: BSD-3-Clause */
/* The optimum of every rank: sqrt(sum of squares of the singular values left out) (Eckart and Young 1936). It needs all of T and takes
 * no photos. Singular values come from R of a QR factorisation that takes T's longer side in pieces, so squares of T are never
 * formed (which would lose half of the digits) and memory beyond T stays small. */
#include "math/dense.h"
#include "relight/capture_impl.h"

#include <math.h>
#include <string.h>

enum { PIECE_ROWS = 1024 };

/* Entry (i, j) of the tall one of T and Tᵀ. */
static double tall_entry(optla_cblock t, size_t i, size_t j)
{
	return t.nrows >= t.ncols ? optla_get_(t, i, j) : optla_get_(t, j, i);
}

/* r <- R of [r; next rows of T], n x n. stacked: (n + PIECE_ROWS) x n, q the same. */
static optla_status add_piece(optla_ctx *ctx, optla_cblock t, size_t first, size_t rows, size_t n, double *stacked, double *q,
                              double *r)
{
	const size_t height = n + rows;
	for (size_t j = 0; j < n; j++) {
		memcpy(stacked + j * height, r + j * n, n * sizeof *r);
		for (size_t i = 0; i < rows; i++) stacked[j * height + n + i] = tall_entry(t, first + i, j);
	}
	return optla_qr_(ctx, stacked, height, n, q, r);
}

static optla_status triangle(optla_ctx *ctx, optla_cblock t, size_t n, double *stacked, double *q, double *r)
{
	const size_t tall = optla_max_(t.nrows, t.ncols);
	const double started_s = optla_now_s_();
	memset(r, 0, n * n * sizeof *r);
	for (size_t first = 0; first < tall; first += PIECE_ROWS) {
		OPTLA_TRY(add_piece(ctx, t, first, optla_min_(PIECE_ROWS, tall - first), n, stacked, q, r));
		OPTLA_TRY(optla_report_(ctx, "singular values", first, tall, started_s, NULL, 0));
	}
	return OPTLA_OK;
}

static void set_points(const optla_capture_job *job, const double *s, size_t n)
{
	double left = 0, norm = 0;
	for (size_t j = n; j-- > 0;) norm += s[j] * s[j];
	for (size_t i = job->options->nks, j = n; i-- > 0;) {
		while (j > job->options->ks[i]) j--, left += s[j] * s[j]; /* from the smallest up */
		job->points[i].relative_error = norm > 0 ? sqrt(left / norm) : 0;
	}
}

optla_status optla_capture_svd_(const optla_capture_job *job)
{
	optla_ctx *ctx = job->ctx;
	const optla_scalar type = optla_op_type(job->truth);
	const size_t n = optla_min_(job->nrows, job->ncols);
	void *t = optla_array_(ctx, job->nrows * job->ncols, optla_scalar_bytes(type));
	double *stacked = NULL, *q = NULL, *r = NULL, *s = NULL;
	optla_status status = OPTLA_ERR_NOMEM;
	if (t) stacked = optla_array_(ctx, (n + PIECE_ROWS) * n, sizeof *stacked);
	if (stacked) q = optla_array_(ctx, (n + PIECE_ROWS) * n, sizeof *q);
	if (q) r = optla_array_(ctx, n * n, sizeof *r);
	if (r) s = optla_array_(ctx, n, sizeof *s);
	if (s) status = optla_op_to_dense(job->truth, optla_block_(t, job->nrows, job->ncols, type));
	if (OPTLA_OK == status) status = triangle(ctx, optla_cblock_(t, job->nrows, job->ncols, type), n, stacked, q, r);
	if (OPTLA_OK == status) status = optla_svd_(ctx, r, n, n, s, NULL, NULL);
	if (OPTLA_OK == status) set_points(job, s, n);
	optla_free(ctx, t);
	optla_free(ctx, stacked);
	optla_free(ctx, q);
	optla_free(ctx, r);
	optla_free(ctx, s);
	return status;
}
