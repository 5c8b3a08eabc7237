/* SPDX-License-Identifier: BSD-3-Clause */
/* min ||A x - b|| with x >= 0: the active-set method of C. L. Lawson and R. J. Hanson, Solving Least Squares Problems (1974), chapter 23.

   A tall A is first reduced to its triangular factor, so that the work of an iteration depends on n alone. Two guards make it finite
   in floating point: a column that depends on the passive ones is turned away, and the method ends when the residual no longer falls. */
#include "math/dense.h"

#include <float.h>
#include <lapacke.h>
#include <math.h>
#include <string.h>

typedef struct {
	const double *g; /* m x n: A, or its triangular factor */
	const double *c; /* m: b, or Qᵀ b */
	size_t m, n, npassive;
	size_t *passive;   /* columns with x > 0, the newest last */
	bool *is_passive;  /* n */
	bool *turned_away; /* n: not tried again before the residual has changed */
	double *qr;        /* m x n workspace for the passive columns */
	double *tau, *z, *r, *work;
	lapack_int lwork;
} nnls_state;

static double norm2(size_t n, const double *v)
{
	const double one = optla_norm_(optla_cblock_(v, n, 1, OPTLA_F64), 0);
	return one * one;
}

/* r = c - G x; returns ||r||² */
static double update_residual(nnls_state *s, const double *x)
{
	memcpy(s->r, s->c, s->m * sizeof *s->r);
	for (size_t j = 0; j < s->n; j++)
		if (x[j] != 0)
			for (size_t i = 0; i < s->m; i++) s->r[i] -= s->g[j * s->m + i] * x[j];
	return norm2(s->m, s->r);
}

/* Column of steepest descent: largest w_j = g_j · r beyond rounding, n if there is none. */
static size_t steepest(nnls_state *s, double norm_c)
{
	size_t best = s->n;
	double largest = 0;
	for (size_t j = 0; j < s->n; j++) {
		if (s->is_passive[j] || s->turned_away[j]) continue;
		const optla_cblock g = optla_cblock_(s->g + j * s->m, s->m, 1, OPTLA_F64), r = optla_cblock_(s->r, s->m, 1, OPTLA_F64);
		const double w = optla_dot_(g, 0, r, 0), rounding = 10 * DBL_EPSILON * (double)s->m * optla_norm_(g, 0) * norm_c;
		if (w > rounding && w > largest) largest = w, best = j;
	}
	return best;
}

/* z = least squares solution on the passive columns; false when the newest of them depends on the others. */
static bool solve_passive(nnls_state *s)
{
	const size_t p = s->npassive;
	if (p > s->m) return false;
	const lapack_int M = (lapack_int)s->m, P = (lapack_int)p;
	for (size_t k = 0; k < p; k++) memcpy(s->qr + k * s->m, s->g + s->passive[k] * s->m, s->m * sizeof *s->qr);
	memcpy(s->z, s->c, s->m * sizeof *s->z);
	if (!p) return true;
	const double newest = sqrt(norm2(s->m, s->qr + (p - 1) * s->m));
	if (LAPACKE_dgeqrf_work(LAPACK_COL_MAJOR, M, P, s->qr, M, s->tau, s->work, s->lwork)) return false;
	if (fabs(s->qr[(p - 1) * s->m + p - 1]) <= 10 * DBL_EPSILON * (double)s->m * newest) return false;
	if (LAPACKE_dormqr_work(LAPACK_COL_MAJOR, 'L', 'T', M, 1, P, s->qr, M, s->tau, s->z, M, s->work, s->lwork)) return false;
	return !LAPACKE_dtrtrs_work(LAPACK_COL_MAJOR, 'U', 'N', 'N', P, 1, s->qr, M, s->z, M);
}

static void remove_passive(nnls_state *s, size_t k)
{
	s->is_passive[s->passive[k]] = false;
	s->npassive--;
	memmove(s->passive + k, s->passive + k + 1, (s->npassive - k) * sizeof *s->passive);
}

static bool all_positive(const nnls_state *s)
{
	for (size_t k = 0; k < s->npassive; k++)
		if (!(s->z[k] > 0)) return false;
	return true;
}

/* Goes from x towards z until a coefficient meets zero, and makes that one active. */
static void step_to_boundary(nnls_state *s, double *x)
{
	double alpha = 1;
	size_t first = s->npassive;
	for (size_t k = 0; k < s->npassive; k++) {
		const double from = x[s->passive[k]];
		if (s->z[k] > 0) continue;
		const double a = from > 0 ? from / (from - s->z[k]) : 0;
		if (first == s->npassive || a < alpha) alpha = a, first = k;
	}
	for (size_t k = s->npassive; k-- > 0;) {
		double *v = &x[s->passive[k]];
		*v += alpha * (s->z[k] - *v);
		if (k == first || !(*v > 0)) {
			*v = 0;
			remove_passive(s, k);
		}
	}
}

/* Brings column j in and solves until all passive coefficients are positive. False: j is of no use. */
static bool enter(nnls_state *s, size_t j, double *x)
{
	s->is_passive[j] = true;
	s->passive[s->npassive++] = j;
	if (!solve_passive(s) || !(s->z[s->npassive - 1] > 0)) {
		remove_passive(s, s->npassive - 1);
		return false;
	}
	while (!all_positive(s)) {
		step_to_boundary(s, x);
		if (!solve_passive(s)) return false;
	}
	memset(x, 0, s->n * sizeof *x);
	for (size_t k = 0; k < s->npassive; k++) x[s->passive[k]] = s->z[k];
	return true;
}

static void iterate(nnls_state *s, double *x, double *saved)
{
	const double norm_c = sqrt(norm2(s->m, s->c));
	double squares = update_residual(s, x);
	for (;;) {
		const size_t j = steepest(s, norm_c);
		if (j == s->n) return;
		memcpy(saved, x, s->n * sizeof *x);
		if (!enter(s, j, x)) {
			s->turned_away[j] = true;
			update_residual(s, x);
			continue;
		}
		const double now = update_residual(s, x);
		if (!(now < squares)) { /* rounding is all that's left */
			memcpy(x, saved, s->n * sizeof *x);
			return;
		}
		squares = now;
		memset(s->turned_away, 0, s->n * sizeof *s->turned_away);
	}
}

/* Triangular factor and Qᵀ b of a tall A. */
static optla_status reduce(optla_ctx *ctx, const double *a, size_t m, size_t n, const double *b, double *r, double *c)
{
	double *q = optla_array_(ctx, m * n, sizeof *q);
	const optla_status status = q ? optla_qr_(ctx, a, m, n, q, r) : OPTLA_ERR_NOMEM;
	for (size_t j = 0; OPTLA_OK == status && j < n; j++)
		c[j] = optla_dot_(optla_cblock_(q, m, n, OPTLA_F64), j, optla_cblock_(b, m, 1, OPTLA_F64), 0);
	optla_free(ctx, q);
	return status;
}

static double true_residual(const double *a, size_t m, size_t n, const double *b, const double *x)
{
	double squares = 0;
	for (size_t i = 0; i < m; i++) {
		double r = b[i];
		for (size_t j = 0; j < n; j++)
			if (x[j] != 0) r -= a[j * m + i] * x[j];
		squares += r * r;
	}
	return sqrt(squares);
}

optla_status optla_nnls_(optla_ctx *ctx, const double *a, size_t m, size_t n, const double *b, double *x, double *residual)
{
	const bool tall = m > n;
	const size_t rows = tall ? n : m;
	nnls_state s = {.g = a, .c = b, .m = rows, .n = n, .lwork = (lapack_int)(64 * (n + 1))};
	double *factor = optla_array_(ctx, tall ? n * n : 0, sizeof *factor), *c = optla_array_(ctx, rows, sizeof *c);
	double *saved = optla_array_(ctx, n, sizeof *saved);
	s.passive = optla_calloc_(ctx, n, sizeof *s.passive);
	s.is_passive = optla_calloc_(ctx, n, sizeof *s.is_passive);
	s.turned_away = optla_calloc_(ctx, n, sizeof *s.turned_away);
	s.qr = optla_array_(ctx, rows * n, sizeof *s.qr);
	s.tau = optla_array_(ctx, n, sizeof *s.tau);
	s.z = optla_array_(ctx, rows, sizeof *s.z);
	s.r = optla_array_(ctx, rows, sizeof *s.r);
	s.work = optla_array_(ctx, (size_t)s.lwork, sizeof *s.work);
	optla_status status = OPTLA_ERR_NOMEM;
	if (factor && c && saved && s.passive && s.is_passive && s.turned_away && s.qr && s.tau && s.z && s.r && s.work) {
		status = tall ? reduce(ctx, a, m, n, b, factor, c) : OPTLA_OK;
		if (tall) s.g = factor, s.c = c;
		memset(x, 0, n * sizeof *x);
		if (OPTLA_OK == status) iterate(&s, x, saved);
		if (residual) *residual = true_residual(a, m, n, b, x);
	}
	void *all[] = {factor, c, saved, s.passive, s.is_passive, s.turned_away, s.qr, s.tau, s.z, s.r, s.work};
	for (size_t k = 0; k < sizeof all / sizeof *all; k++) optla_free(ctx, all[k]);
	return status;
}
