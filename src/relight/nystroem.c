/* SPDX-License-Identifier: BSD-3-Clause */
/* Nystroem capture: k random columns C, k random rows R and where they cross, W, give T_k = C W⁺ R; with a kernel the same is done
 * to T^γ, element by element: T_k = (C^γ (W^γ)⁺ R^γ)^(1/γ).  J. Wang, Y. Dong, X. Tong, Z. Lin, B. Guo, Kernel Nyström method for
 * light transport, SIGGRAPH 2009.
 *
 * Columns are photos under single lights, rows are photos from the projector's side under single camera pixels. Two things are left
 * open by the method: the exponent and the tolerance of the pseudo-inverse. Both are chosen as the best against the truth, on a
 * random sample of its rows, so the curve shows the method at its best; a capture that doesn't know the truth does worse. */
#include "math/dense.h"
#include "relight/basis.h"
#include "relight/capture_impl.h"
#include "relight/truth_walk.h"

#include <math.h>
#include <omp.h>
#include <string.h>

enum { SAMPLE_ROWS = 1024, CHUNK_ROWS = 256, GOLDEN_STEPS = 8, STREAM_COLUMNS = 1, STREAM_ROWS = 2, STREAM_SAMPLE = 3 };

static const double tolerances[] = {1e-7, 1e-5, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1};
static const double exponents[] = {0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1, 1.25, 1.6};
enum { NTOLERANCES = sizeof tolerances / sizeof *tolerances, NEXPONENTS = sizeof exponents / sizeof *exponents };

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
} nystroem;

/* ---- capture ---- */

static optla_status take(nystroem *y, optla_trans trans, size_t which, optla_block to)
{
	optla_op *op = y->job->single;
	const size_t n = OPTLA_FORWARD == trans ? y->job->ncols : y->job->nrows;
	const optla_block unit = optla_block_(y->unit.data, n, 1, y->unit.type);
	optla_set_(unit, which, 0, 1);
	const optla_status s = optla_op_apply(op, trans, optla_block_const(unit), to);
	optla_set_(unit, which, 0, 0);
	return s;
}

static optla_status take_all(nystroem *y)
{
	const optla_capture_options *o = y->job->options;
	const optla_op_cost before = optla_op_cost_so_far(y->job->single);
	const double started_s = optla_now_s_();
	for (size_t i = 0, k = 0; i < o->nks; i++) {
		for (; k < o->ks[i]; k++) {
			OPTLA_TRY(take(y, OPTLA_FORWARD, y->column[k], optla_columns_mut_(y->c, k, 1)));
			OPTLA_TRY(take(y, OPTLA_TRANSPOSE, y->row[k], optla_columns_mut_(y->r, k, 1)));
		}
		optla_capture_note_cost_(y->job, i, y->job->single, before);
		OPTLA_TRY(optla_report_(y->job->ctx, "Nystroem capture", k, y->most, started_s, NULL, 0));
	}
	return OPTLA_OK;
}

static optla_status take_sample(nystroem *y)
{
	optla_walk w;
	OPTLA_TRY(optla_walk_begin_(y->job->truth, &w));
	optla_status s;
	for (bool more = true;;) {
		optla_cblock columns;
		const size_t first = w.first;
		s = optla_walk_next_(&w, &columns, &more);
		if (OPTLA_OK != s || !more) break;
		for (size_t j = 0; j < columns.ncols; j++)
			for (size_t i = 0; i < y->nsample; i++)
				y->sample[(first + j) * y->nsample + i] = optla_get_(columns, y->sample_row[i], j);
	}
	optla_walk_end_(&w);
	return s;
}

/* ---- the approximation for one k, exponent and tolerance ---- */

/* f(x) = x^γ; light that noise made negative counts as none. Without a kernel f is the identity. */
static double forward_kernel(const nystroem *y, double x, double exponent)
{
	if (!y->kernel) return x;
	return x > 0 ? pow(x, exponent) : 0;
}

/* W^γ = U S Vᵀ and R^γ. The two photos of a crossing are averaged. */
static optla_status factor(nystroem *y, size_t k, double exponent)
{
	const optla_cblock c = optla_block_const(y->c), r = optla_block_const(y->r);
	for (size_t j = 0; j < k; j++)
		for (size_t i = 0; i < k; i++) {
			const double t = 0.5 * (optla_get_(c, y->row[i], j) + optla_get_(r, y->column[j], i));
			y->w[j * k + i] = forward_kernel(y, t, exponent);
		}
	for (size_t i = 0; i < k; i++)
		for (size_t n = 0; n < y->job->ncols; n++)
			y->rg[i * y->job->ncols + n] = forward_kernel(y, optla_get_(r, n, i), exponent);
	return optla_svd_(y->job->ctx, y->w, k, k, y->s, y->u, y->vt);
}

/* middle = V S⁺ Uᵀ R^γ, singular values below tolerance * largest count as zero. Column n of it stands together. */
static void set_middle(nystroem *y, size_t k, double tolerance)
{
	const size_t ncols = y->job->ncols;
	for (size_t a = 0; a < k; a++) /* mixed = V S⁺ Uᵀ, k x k */
		for (size_t b = 0; b < k; b++) {
			double sum = 0;
			for (size_t q = 0; q < k && y->s[q] > tolerance * y->s[0]; q++) sum += y->vt[a * k + q] * y->u[q * k + b] / y->s[q];
			y->mixed[b * k + a] = sum;
		}
	memset(y->middle, 0, k * ncols * sizeof *y->middle);
#pragma omp parallel for num_threads(optla_ctx_threads(y->job->ctx)) schedule(static)
	for (size_t n = 0; n < ncols; n++)
		for (size_t b = 0; b < k; b++) {
			const double f = y->rg[b * ncols + n];
			for (size_t a = 0; a < k; a++) y->middle[n * k + a] += y->mixed[b * k + a] * f;
		}
}

/* Squared error and squared norm of up to CHUNK_ROWS rows of one column. cg: rows x k with leading dimension ldc. */
static void chunk_error(const nystroem *y, const double *cg, size_t ldc, size_t k, double exponent, const double *middle,
                        const double *truth, size_t rows, double sums[2])
{
	double t[CHUNK_ROWS] = {0};
	for (size_t a = 0; a < k; a++)
		for (size_t m = 0; m < rows; m++) t[m] += cg[a * ldc + m] * middle[a];
	if (y->kernel)
		for (size_t m = 0; m < rows; m++) t[m] = t[m] > 0 ? pow(t[m], 1 / exponent) : 0;
	for (size_t m = 0; m < rows; m++) {
		sums[0] += (t[m] - truth[m]) * (t[m] - truth[m]);
		sums[1] += truth[m] * truth[m];
	}
}

static double error_of(const double *chunk_sum, size_t nchunks)
{
	double difference = 0, norm = 0;
	for (size_t c = 0; c < nchunks; c++) {
		difference += chunk_sum[2 * c];
		norm += chunk_sum[2 * c + 1];
	}
	return norm > 0 ? sqrt(difference / norm) : NAN;
}

/* Error on the sample. cg must hold C^γ of the sample's rows. */
static double sample_error(nystroem *y, size_t k, double exponent)
{
	const size_t nchunks = (y->nsample + CHUNK_ROWS - 1) / CHUNK_ROWS;
	memset(y->chunk_sum, 0, 2 * nchunks * sizeof *y->chunk_sum);
#pragma omp parallel for num_threads(optla_ctx_threads(y->job->ctx)) schedule(static)
	for (size_t c = 0; c < nchunks; c++)
		for (size_t n = 0, first = c * CHUNK_ROWS; n < y->job->ncols; n++)
			chunk_error(y, y->cg + first, y->nsample, k, exponent, y->middle + n * k, y->sample + n * y->nsample + first,
			            optla_min_(CHUNK_ROWS, y->nsample - first), y->chunk_sum + 2 * c);
	return error_of(y->chunk_sum, nchunks);
}

/* ---- search ---- */

typedef struct {
	double exponent, tolerance, error;
} choice;

/* Best tolerance (or the given one, if > 0) for one exponent. */
static optla_status try_exponent(nystroem *y, size_t k, double exponent, double only_tolerance, choice *best)
{
	OPTLA_TRY(factor(y, k, exponent));
	for (size_t a = 0; a < k; a++)
		for (size_t i = 0; i < y->nsample; i++)
			y->cg[a * y->nsample + i] = forward_kernel(y, optla_get_(optla_block_const(y->c), y->sample_row[i], a), exponent);
	*best = (choice){exponent, 0, INFINITY};
	for (size_t i = 0; i < NTOLERANCES; i++) {
		if (only_tolerance > 0 && tolerances[i] != only_tolerance) continue;
		set_middle(y, k, tolerances[i]);
		const double error = sample_error(y, k, exponent);
		if (error < best->error) best->tolerance = tolerances[i], best->error = error;
	}
	return OPTLA_OK;
}

/* Golden section on log γ between the neighbours of the best exponent of the list. */
static optla_status refine(nystroem *y, size_t k, double lower, double upper, choice *best)
{
	const double golden = 0.61803398874989485;
	const double tolerance = best->tolerance;
	double a = log(lower), b = log(upper), x[2] = {b - golden * (b - a), a + golden * (b - a)};
	choice c[2];
	for (int i = 0; i < 2; i++) OPTLA_TRY(try_exponent(y, k, exp(x[i]), tolerance, &c[i]));
	for (int step = 0; step < GOLDEN_STEPS; step++) {
		const int keep = c[0].error < c[1].error ? 0 : 1, move = 1 - keep;
		*(keep ? &a : &b) = x[move];
		x[move] = x[keep], c[move] = c[keep];
		x[keep] = keep ? a + golden * (b - a) : b - golden * (b - a);
		OPTLA_TRY(try_exponent(y, k, exp(x[keep]), tolerance, &c[keep]));
		for (int i = 0; i < 2; i++)
			if (c[i].error < best->error) *best = c[i];
	}
	return OPTLA_OK;
}

static optla_status search(nystroem *y, size_t k, choice *best)
{
	if (!y->kernel) return try_exponent(y, k, 1, 0, best);
	size_t at = 0;
	*best = (choice){1, 0, INFINITY};
	for (size_t i = 0; i < NEXPONENTS; i++) {
		choice c;
		OPTLA_TRY(try_exponent(y, k, exponents[i], 0, &c));
		if (c.error < best->error) *best = c, at = i;
	}
	return refine(y, k, exponents[at ? at - 1 : 0], exponents[at + 1 < NEXPONENTS ? at + 1 : at], best);
}

/* ---- error against all of the truth ---- */

static void full_chunk(const nystroem *y, size_t c, optla_cblock columns, size_t first_column, size_t k, choice best)
{
	const size_t first = c * CHUNK_ROWS, rows = optla_min_(CHUNK_ROWS, y->job->nrows - first);
	double truth[CHUNK_ROWS], *cg = y->cg + (size_t)omp_get_thread_num() * CHUNK_ROWS * k;
	for (size_t a = 0; a < k; a++)
		for (size_t m = 0; m < rows; m++)
			cg[a * CHUNK_ROWS + m] = forward_kernel(y, optla_get_(optla_block_const(y->c), first + m, a), best.exponent);
	for (size_t j = 0; j < columns.ncols; j++) {
		optla_rows_(columns, j, first, rows, truth);
		chunk_error(y, cg, CHUNK_ROWS, k, best.exponent, y->middle + (first_column + j) * k, truth, rows, y->chunk_sum + 2 * c);
	}
}

static optla_status full_error(nystroem *y, size_t k, choice best, double *error)
{
	const size_t nchunks = (y->job->nrows + CHUNK_ROWS - 1) / CHUNK_ROWS;
	optla_walk w;
	OPTLA_TRY(factor(y, k, best.exponent));
	set_middle(y, k, best.tolerance);
	OPTLA_TRY(optla_walk_begin_(y->job->truth, &w));
	memset(y->chunk_sum, 0, 2 * nchunks * sizeof *y->chunk_sum);
	optla_status s;
	for (bool more = true;;) {
		optla_cblock columns;
		const size_t first = w.first;
		s = optla_walk_next_(&w, &columns, &more);
		if (OPTLA_OK != s || !more) break;
#pragma omp parallel for num_threads(optla_ctx_threads(y->job->ctx)) schedule(static)
		for (size_t c = 0; c < nchunks; c++) full_chunk(y, c, columns, first, k, best);
	}
	optla_walk_end_(&w);
	*error = error_of(y->chunk_sum, nchunks);
	return s;
}

static optla_status curve(nystroem *y)
{
	const optla_capture_options *o = y->job->options;
	OPTLA_TRY(take_all(y));
	OPTLA_TRY(take_sample(y));
	const double started_s = optla_now_s_();
	for (size_t i = 0; i < o->nks; i++) {
		choice best;
		OPTLA_TRY(search(y, o->ks[i], &best));
		OPTLA_TRY(full_error(y, o->ks[i], best, &y->job->points[i].relative_error));
		y->job->points[i].exponent = best.exponent;
		OPTLA_TRY(optla_report_(y->job->ctx, "Nystroem errors", i + 1, o->nks, started_s, "relative error", best.error));
	}
	return OPTLA_OK;
}

/* ---- memory ---- */

static void release(nystroem *y)
{
	void *all[] = {y->column, y->row, y->sample_row, y->c.data, y->r.data, y->unit.data, y->sample, y->cg,
	               y->w,      y->u,   y->s,          y->vt,     y->rg,     y->middle,    y->mixed,  y->chunk_sum};
	for (size_t i = 0; i < sizeof all / sizeof *all; i++) optla_free(y->job->ctx, all[i]);
}

static void *block_of(optla_ctx *ctx, size_t nrows, size_t ncols, optla_scalar type, optla_block *out)
{
	*out = optla_block_(optla_calloc_(ctx, nrows * ncols, optla_scalar_bytes(type)), nrows, ncols, type);
	return out->data;
}

static optla_status reserve(nystroem *y)
{
	const optla_capture_job *job = y->job;
	optla_ctx *ctx = job->ctx;
	const optla_scalar type = optla_op_type(job->single);
	const size_t k = y->most, nchunks = (job->nrows + CHUNK_ROWS - 1) / CHUNK_ROWS, bytes = sizeof(double);
	const size_t cg_rows = optla_max_(y->nsample, CHUNK_ROWS * (size_t)optla_ctx_threads(ctx));
	OPTLA_TRY(optla_permutation_(ctx, job->options->seed, STREAM_COLUMNS, job->ncols, &y->column));
	OPTLA_TRY(optla_permutation_(ctx, job->options->seed, STREAM_ROWS, job->nrows, &y->row));
	OPTLA_TRY(optla_permutation_(ctx, job->options->seed, STREAM_SAMPLE, job->nrows, &y->sample_row));
	const bool ok = block_of(ctx, job->nrows, k, type, &y->c) && block_of(ctx, job->ncols, k, type, &y->r) &&
	                block_of(ctx, optla_max_(job->nrows, job->ncols), 1, type, &y->unit) &&
	                (y->sample = optla_array_(ctx, y->nsample * job->ncols, bytes)) &&
	                (y->cg = optla_array_(ctx, cg_rows * k, bytes)) && (y->w = optla_array_(ctx, k * k, bytes)) &&
	                (y->u = optla_array_(ctx, k * k, bytes)) && (y->s = optla_array_(ctx, k, bytes)) &&
	                (y->vt = optla_array_(ctx, k * k, bytes)) && (y->rg = optla_array_(ctx, k * job->ncols, bytes)) &&
	                (y->middle = optla_array_(ctx, k * job->ncols, bytes)) && (y->mixed = optla_array_(ctx, k * k, bytes)) &&
	                (y->chunk_sum = optla_array_(ctx, 2 * nchunks, bytes));
	return ok ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

optla_status optla_capture_nystroem_(const optla_capture_job *job, bool kernel)
{
	nystroem y = {.job = job,
	              .kernel = kernel,
	              .most = job->options->ks[job->options->nks - 1],
	              .nsample = optla_min_(SAMPLE_ROWS, job->nrows)};
	OPTLA_CHECK(job->ctx, !(optla_op_flags(job->single) & OPTLA_OP_NO_TRANSPOSE), OPTLA_ERR_UNSUPPORTED,
	            "the Nystroem methods need rows of T, and '%s' has no transpose", optla_op_name(job->single));
	optla_status s = reserve(&y);
	if (OPTLA_OK == s) s = curve(&y);
	release(&y);
	return s;
}
