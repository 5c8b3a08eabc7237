/* SPDX-License-Identifier: BSD-3-Clause */
/* Errors of approximations of T (Eq. 2.11).
 *
 * The residual T - D P^T is formed and its squares are summed; expanding the square instead would be cheaper and lose half of
 * the digits where the approximation is good. Rows are cut into chunks of fixed size, chunks are summed in order: the result
 * doesn't depend on the number of threads. */
#include "math/dense.h"
#include "optla/relight.h"
#include "relight/truth_walk.h"

#include <math.h>
#include <omp.h>
#include <string.h>

enum { CHUNK_ROWS = 512, LANES = 8 };

/* Fixed order of sums, and four to eight of them at once. */
static double sum_squares(const double *r, size_t n)
{
	double s[LANES] = {0}, total = 0;
	size_t m = 0;
	for (; m + LANES <= n; m += LANES)
		for (size_t j = 0; j < LANES; j++) s[j] += r[m + j] * r[m + j];
	for (; m < n; m++) total += r[m] * r[m];
	for (size_t j = 0; j < LANES; j++) total += s[j];
	return total;
}

/* r -= f d; returns the sum of squares of the new r. Rows past n are zero in both. */
static double subtract(const double *restrict d, double f, double *restrict r)
{
	double s[LANES] = {0}, total = 0;
	for (size_t m = 0; m < CHUNK_ROWS; m += LANES)
		for (size_t j = 0; j < LANES; j++) {
			r[m + j] -= f * d[m + j];
			s[j] += r[m + j] * r[m + j];
		}
	for (size_t j = 0; j < LANES; j++) total += s[j];
	return total;
}

static void load_chunk(optla_cblock a, size_t column, size_t first, size_t rows, double *out)
{
	optla_rows_(a, column, first, rows, out);
	memset(out + rows, 0, (CHUNK_ROWS - rows) * sizeof *out);
}

typedef struct {
	optla_cblock d, p;
	size_t nchunks;
	double *chunk_squares; /* nchunks x (K + 1): of T, then of the residual after k = 1..K */
	double *scratch;       /* threads x CHUNK_ROWS x (K + 1): D's rows of the chunk as doubles, and the residual */
} residual_task;

static void residual_chunk(const residual_task *t, size_t chunk, optla_cblock columns, size_t first_column)
{
	const size_t K = t->d.ncols, first = chunk * CHUNK_ROWS, rows = optla_min_(CHUNK_ROWS, t->d.nrows - first);
	double *squares = t->chunk_squares + chunk * (K + 1);
	double *d = t->scratch + (size_t)omp_get_thread_num() * CHUNK_ROWS * (K + 1), *r = d + K * CHUNK_ROWS;
	for (size_t k = 0; k < K; k++) load_chunk(t->d, k, first, rows, d + k * CHUNK_ROWS);
	for (size_t j = 0; j < columns.ncols; j++) {
		load_chunk(columns, j, first, rows, r);
		squares[0] += sum_squares(r, rows);
		for (size_t k = 0; k < K; k++) squares[k + 1] += subtract(d + k * CHUNK_ROWS, optla_get_(t->p, first_column + j, k), r);
	}
}

static optla_status walk_residuals(optla_ctx *ctx, residual_task *t, optla_op *truth)
{
	optla_walk w;
	OPTLA_TRY(optla_walk_begin_(truth, &w));
	const double started_s = optla_now_s_();
	optla_status s;
	for (bool more = true;;) {
		optla_cblock columns;
		const size_t first = w.first;
		s = optla_walk_next_(&w, &columns, &more);
		if (OPTLA_OK != s || !more) break;
#pragma omp parallel for num_threads(optla_ctx_threads(ctx)) schedule(static)
		for (size_t chunk = 0; chunk < t->nchunks; chunk++) residual_chunk(t, chunk, columns, first);
		s = optla_report_(ctx, "relative error", w.first, w.ncols, started_s, NULL, 0);
		if (OPTLA_OK != s) break;
	}
	optla_walk_end_(&w);
	return s;
}

static optla_status finish(optla_ctx *ctx, const residual_task *t, optla_op *truth, double *errors)
{
	const size_t K = t->d.ncols;
	double norm = 0;
	for (size_t c = 0; c < t->nchunks; c++) norm += t->chunk_squares[c * (K + 1)];
	OPTLA_CHECK(ctx, norm > 0, OPTLA_ERR_ARG, "operator '%s' is zero: a relative error has no meaning", optla_op_name(truth));
	for (size_t k = 1; k <= K; k++) {
		double left = 0;
		for (size_t c = 0; c < t->nchunks; c++) left += t->chunk_squares[c * (K + 1) + k];
		errors[k - 1] = sqrt(left / norm);
	}
	return OPTLA_OK;
}

static optla_status check_factors(optla_ctx *ctx, optla_cblock d, optla_cblock p, optla_op *truth)
{
	OPTLA_CHECK(ctx, d.nrows == optla_op_nrows(truth) && p.nrows == optla_op_ncols(truth) && d.ncols == p.ncols && d.ncols > 0,
	            OPTLA_ERR_SHAPE, "photos %zu x %zu and illuminations %zu x %zu don't make a matrix of %zu x %zu like '%s'",
	            d.nrows, d.ncols, p.nrows, p.ncols, optla_op_nrows(truth), optla_op_ncols(truth), optla_op_name(truth));
	OPTLA_CHECK(ctx, d.type <= OPTLA_F64 && p.type <= OPTLA_F64, OPTLA_ERR_UNSUPPORTED,
	            "errors of complex factors aren't offered");
	return OPTLA_OK;
}

optla_status optla_relative_errors(optla_cblock d, optla_cblock p, optla_op *truth, double *errors)
{
	optla_ctx *ctx = optla_op_ctx(truth);
	OPTLA_TRY(check_factors(ctx, d, p, truth));
	residual_task t = {.d = d, .p = p, .nchunks = (d.nrows + CHUNK_ROWS - 1) / CHUNK_ROWS};
	t.chunk_squares = optla_calloc_(ctx, t.nchunks * (d.ncols + 1), sizeof *t.chunk_squares);
	t.scratch = optla_array_(ctx, (size_t)optla_ctx_threads(ctx) * CHUNK_ROWS, (d.ncols + 1) * sizeof *t.scratch);
	optla_status s = t.chunk_squares && t.scratch ? walk_residuals(ctx, &t, truth) : OPTLA_ERR_NOMEM;
	if (OPTLA_OK == s) s = finish(ctx, &t, truth, errors);
	optla_free(ctx, t.chunk_squares);
	optla_free(ctx, t.scratch);
	return s;
}

/* ---- two operators ---- */

/* ||x_j - y_j||² and ||y_j||² */
static void compare_columns(optla_cblock x, optla_cblock y, size_t j, double squares[2])
{
	double a[CHUNK_ROWS], b[CHUNK_ROWS];
	squares[0] = squares[1] = 0;
	for (size_t first = 0; first < x.nrows; first += CHUNK_ROWS) {
		const size_t rows = optla_min_(CHUNK_ROWS, x.nrows - first);
		load_chunk(x, j, first, rows, a);
		load_chunk(y, j, first, rows, b);
		squares[1] += sum_squares(b, rows);
		squares[0] += subtract(b, 1, a);
	}
}

static optla_status walk_both(optla_ctx *ctx, optla_walk *a, optla_walk *b, double *squares, double *error)
{
	double difference = 0, norm = 0;
	for (bool more;;) {
		optla_cblock x, y;
		OPTLA_TRY(optla_walk_next_(a, &x, &more));
		OPTLA_TRY(optla_walk_next_(b, &y, &more));
		if (!more) break;
#pragma omp parallel for num_threads(optla_ctx_threads(ctx)) schedule(static)
		for (size_t j = 0; j < x.ncols; j++) compare_columns(x, y, j, squares + 2 * j);
		for (size_t j = 0; j < x.ncols; j++) {
			difference += squares[2 * j];
			norm += squares[2 * j + 1];
		}
	}
	OPTLA_CHECK(ctx, norm > 0, OPTLA_ERR_ARG, "operator '%s' is zero: a relative error has no meaning", optla_op_name(b->op));
	*error = sqrt(difference / norm);
	return OPTLA_OK;
}

static optla_status compare(optla_ctx *ctx, optla_walk *a, optla_walk *b, double *error)
{
	a->block = b->block = optla_min_(a->block, b->block);
	double *squares = optla_array_(ctx, a->block, 2 * sizeof *squares);
	if (!squares) return OPTLA_ERR_NOMEM;
	const optla_status s = walk_both(ctx, a, b, squares, error);
	optla_free(ctx, squares);
	return s;
}

optla_status optla_relative_error(optla_op *approximation, optla_op *truth, double *error)
{
	optla_ctx *ctx = optla_op_ctx(truth);
	OPTLA_CHECK(ctx,
	            optla_op_nrows(approximation) == optla_op_nrows(truth) && optla_op_ncols(approximation) == optla_op_ncols(truth),
	            OPTLA_ERR_SHAPE, "operator '%s' is %zu x %zu and '%s' is %zu x %zu: they can't be compared",
	            optla_op_name(approximation), optla_op_nrows(approximation), optla_op_ncols(approximation), optla_op_name(truth),
	            optla_op_nrows(truth), optla_op_ncols(truth));
	optla_walk a, b;
	OPTLA_TRY(optla_walk_begin_(approximation, &a));
	optla_status s = optla_walk_begin_(truth, &b);
	if (OPTLA_OK == s) {
		s = compare(ctx, &a, &b, error);
		optla_walk_end_(&b);
	}
	optla_walk_end_(&a);
	return s;
}
