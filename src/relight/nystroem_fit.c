/* SPDX-License-Identifier: BSD-3-Clause */
/* T_k = (C^γ (W^γ)⁺ R^γ)^(1/γ): the exponent and the tolerance of the pseudo-inverse that come nearest to the truth. */
#include "math/dense.h"
#include "relight/nystroem.h"
#include "relight/truth_walk.h"

#include <math.h>
#include <omp.h>
#include <string.h>

enum { GOLDEN_STEPS = 8 };

static const double tolerances[] = {1e-7, 1e-3, 1e-2, 3e-2, 1e-1};
static const double exponents[] = {0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1, 1.25, 1.6};
enum { NTOLERANCES = sizeof tolerances / sizeof *tolerances, NEXPONENTS = sizeof exponents / sizeof *exponents };

/* ---- the approximation for one k, exponent and tolerance ---- */

/* x^γ to float accuracy: T is no better known, and it is three times as fast. */
static double power(double x, double exponent) { return x > 0 ? (double)powf((float)x, (float)exponent) : 0; }

/* f(x) = x^γ; light that noise made negative counts as none. Without a kernel f is the identity. */
static double forward_kernel(const optla_nystroem *y, double x, double exponent) { return y->kernel ? power(x, exponent) : x; }

/* W^γ = U S Vᵀ and R^γ. The two photos of a crossing are averaged. */
static optla_status factor(optla_nystroem *y, size_t k, double exponent)
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
static void set_middle(optla_nystroem *y, size_t k, double tolerance)
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

/* Squared error and squared norm of up to OPTLA_NYSTROEM_CHUNK rows of one column. cg: rows x k with leading dimension ldc. */
static void chunk_error(const optla_nystroem *y, const double *cg, size_t ldc, size_t k, double exponent, const double *middle,
                        const double *truth, size_t rows, double sums[2])
{
	double t[OPTLA_NYSTROEM_CHUNK] = {0};
	for (size_t a = 0; a < k; a++)
		for (size_t m = 0; m < rows; m++) t[m] += cg[a * ldc + m] * middle[a];
	if (y->kernel)
		for (size_t m = 0; m < rows; m++) t[m] = power(t[m], 1 / exponent);
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
static double sample_error(optla_nystroem *y, size_t k, double exponent)
{
	const size_t nchunks = (y->nsample + OPTLA_NYSTROEM_CHUNK - 1) / OPTLA_NYSTROEM_CHUNK;
	memset(y->chunk_sum, 0, 2 * nchunks * sizeof *y->chunk_sum);
#pragma omp parallel for num_threads(optla_ctx_threads(y->job->ctx)) schedule(static)
	for (size_t c = 0; c < nchunks; c++)
		for (size_t n = 0, first = c * OPTLA_NYSTROEM_CHUNK; n < y->job->ncols; n++)
			chunk_error(y, y->cg + first, y->nsample, k, exponent, y->middle + n * k, y->sample + n * y->nsample + first,
			            optla_min_(OPTLA_NYSTROEM_CHUNK, y->nsample - first), y->chunk_sum + 2 * c);
	return error_of(y->chunk_sum, nchunks);
}

/* ---- search ---- */

/* Best tolerance (or the given one, if > 0) for one exponent. */
static optla_status try_exponent(optla_nystroem *y, size_t k, double exponent, double only_tolerance, optla_nystroem_choice *best)
{
	OPTLA_TRY(factor(y, k, exponent));
	for (size_t a = 0; a < k; a++)
		for (size_t i = 0; i < y->nsample; i++)
			y->cg[a * y->nsample + i] = forward_kernel(y, optla_get_(optla_block_const(y->c), y->sample_row[i], a), exponent);
	*best = (optla_nystroem_choice){exponent, 0, INFINITY};
	for (size_t i = 0; i < NTOLERANCES; i++) {
		if (only_tolerance > 0 && tolerances[i] != only_tolerance) continue;
		set_middle(y, k, tolerances[i]);
		const double error = sample_error(y, k, exponent);
		if (error < best->error) best->tolerance = tolerances[i], best->error = error;
	}
	return OPTLA_OK;
}

/* Golden section on log γ between the neighbours of the best exponent of the list. */
static optla_status refine(optla_nystroem *y, size_t k, double lower, double upper, optla_nystroem_choice *best)
{
	const double golden = 0.61803398874989485;
	const double tolerance = best->tolerance;
	double a = log(lower), b = log(upper), x[2] = {b - golden * (b - a), a + golden * (b - a)};
	optla_nystroem_choice c[2];
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

optla_status optla_nystroem_search_(optla_nystroem *y, size_t k, optla_nystroem_choice *best)
{
	if (!y->kernel) return try_exponent(y, k, 1, 0, best);
	size_t at = 0;
	*best = (optla_nystroem_choice){1, 0, INFINITY};
	for (size_t i = 0; i < NEXPONENTS; i++) {
		optla_nystroem_choice c;
		OPTLA_TRY(try_exponent(y, k, exponents[i], 0, &c));
		if (c.error < best->error) *best = c, at = i;
	}
	return refine(y, k, exponents[at ? at - 1 : 0], exponents[at + 1 < NEXPONENTS ? at + 1 : at], best);
}

/* ---- error against all of the truth ---- */

static void full_chunk(const optla_nystroem *y, size_t c, optla_cblock columns, size_t first_column, size_t k,
                       optla_nystroem_choice best)
{
	const size_t first = c * OPTLA_NYSTROEM_CHUNK, rows = optla_min_(OPTLA_NYSTROEM_CHUNK, y->job->nrows - first);
	double truth[OPTLA_NYSTROEM_CHUNK], *cg = y->cg + (size_t)omp_get_thread_num() * OPTLA_NYSTROEM_CHUNK * k;
	for (size_t a = 0; a < k; a++)
		for (size_t m = 0; m < rows; m++)
			cg[a * OPTLA_NYSTROEM_CHUNK + m] =
			    forward_kernel(y, optla_get_(optla_block_const(y->c), first + m, a), best.exponent);
	for (size_t j = 0; j < columns.ncols; j++) {
		optla_rows_(columns, j, first, rows, truth);
		chunk_error(y, cg, OPTLA_NYSTROEM_CHUNK, k, best.exponent, y->middle + (first_column + j) * k, truth, rows,
		            y->chunk_sum + 2 * c);
	}
}

optla_status optla_nystroem_error_(optla_nystroem *y, size_t k, optla_nystroem_choice best, double *error)
{
	const size_t nchunks = (y->job->nrows + OPTLA_NYSTROEM_CHUNK - 1) / OPTLA_NYSTROEM_CHUNK;
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
