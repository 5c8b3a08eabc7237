/* SPDX-License-Identifier: BSD-3-Clause */
/* Small dense problems through LAPACK (E. Anderson et al., LAPACK Users' Guide, 3rd ed., SIAM 1999). All memory, workspaces
   included, comes from the context: the _work variants of LAPACKE allocate nothing. */
#include "math/dense.h"

#include <lapacke.h>
#include <limits.h>
#include <string.h>

#define COL LAPACK_COL_MAJOR

static optla_status check_sizes(optla_ctx *ctx, size_t m, size_t n, size_t nrhs)
{
	OPTLA_CHECK(ctx, m <= INT_MAX && n <= INT_MAX && nrhs <= INT_MAX, OPTLA_ERR_ARG,
	            "LAPACK takes at most %d rows and columns, not %zu x %zu with %zu right-hand sides", INT_MAX, m, n, nrhs);
	return OPTLA_OK;
}

static optla_status lapack_status(optla_ctx *ctx, const char *routine, lapack_int info)
{
	OPTLA_CHECK(ctx, !info, OPTLA_ERR_DEVICE,
	            info < 0 ? "LAPACK's %s refuses argument %d (NaN in the matrix?)" : "LAPACK's %s failed: info = %d", routine,
	            info < 0 ? -(int)info : (int)info);
	return OPTLA_OK;
}

/* A workspace of the size that LAPACK answered to a query. */
static double *workspace(optla_ctx *ctx, double size, lapack_int *lwork)
{
	*lwork = (lapack_int)size;
	return optla_array_(ctx, (size_t)size, sizeof(double));
}

static double *copy(optla_ctx *ctx, const double *a, size_t count)
{
	double *b = optla_array_(ctx, count, sizeof *b);
	if (b && count) memcpy(b, a, count * sizeof *b);
	return b;
}

optla_status optla_svd_(optla_ctx *ctx, const double *a, size_t m, size_t n, double *s, double *u, double *vt)
{
	OPTLA_TRY(check_sizes(ctx, m, n, 0));
	const size_t k = optla_min_(m, n);
	if (!k) return OPTLA_OK;
	const lapack_int M = (lapack_int)m, N = (lapack_int)n, K = (lapack_int)k;
	const char ju = u ? 'S' : 'N', jv = vt ? 'S' : 'N';
	double size = 0, *work = NULL, *b = copy(ctx, a, m * n);
	lapack_int lwork = 0, info = 0;
	optla_status status = b ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (b) {
		info = LAPACKE_dgesvd_work(COL, ju, jv, M, N, b, M, s, u, M, vt, K, &size, -1);
		work = workspace(ctx, size, &lwork);
		if (!work) status = OPTLA_ERR_NOMEM;
	}
	if (work) {
		if (!info) info = LAPACKE_dgesvd_work(COL, ju, jv, M, N, b, M, s, u, M, vt, K, work, lwork);
		status = lapack_status(ctx, "dgesvd", info);
	}
	optla_free(ctx, work);
	optla_free(ctx, b);
	return status;
}

static void upper_triangle(const double *a, size_t m, size_t n, double *r)
{
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < n; i++) r[j * n + i] = i <= j ? a[j * m + i] : 0;
}

optla_status optla_qr_(optla_ctx *ctx, const double *a, size_t m, size_t n, double *q, double *r)
{
	OPTLA_TRY(check_sizes(ctx, m, n, 0));
	OPTLA_CHECK(ctx, m >= n, OPTLA_ERR_SHAPE, "a thin QR needs at least as many rows as columns, not %zu x %zu", m, n);
	if (!n) return OPTLA_OK;
	const lapack_int M = (lapack_int)m, N = (lapack_int)n;
	double size[2] = {0}, *work = NULL, *tau = optla_array_(ctx, n, sizeof *tau);
	lapack_int lwork = 0, info = 0;
	if (tau) {
		memcpy(q, a, m * n * sizeof *q);
		info = LAPACKE_dgeqrf_work(COL, M, N, q, M, tau, &size[0], -1);
		if (!info) info = LAPACKE_dorgqr_work(COL, M, N, N, q, M, tau, &size[1], -1);
		work = workspace(ctx, size[0] > size[1] ? size[0] : size[1], &lwork);
	}
	optla_status status = OPTLA_ERR_NOMEM;
	if (work) {
		if (!info) info = LAPACKE_dgeqrf_work(COL, M, N, q, M, tau, work, lwork);
		if (!info) upper_triangle(q, m, n, r);
		if (!info) info = LAPACKE_dorgqr_work(COL, M, N, N, q, M, tau, work, lwork);
		status = lapack_status(ctx, "dgeqrf/dorgqr", info);
	}
	optla_free(ctx, work);
	optla_free(ctx, tau);
	return status;
}

optla_status optla_lstsq_(optla_ctx *ctx, const double *a, size_t m, size_t n, const double *b, size_t nrhs, double rcond,
                          double *x, size_t *rank)
{
	OPTLA_TRY(check_sizes(ctx, m, n, nrhs));
	if (rank) *rank = 0;
	if (!m || !n || !nrhs) {
		if (n && nrhs) memset(x, 0, n * nrhs * sizeof *x);
		return OPTLA_OK;
	}
	const size_t ld = optla_max_(m, n), k = optla_min_(m, n);
	const lapack_int M = (lapack_int)m, N = (lapack_int)n, R = (lapack_int)nrhs, L = (lapack_int)ld;
	double size = 0, *work = NULL, *c = copy(ctx, a, m * n);
	double *rhs = optla_calloc_(ctx, ld * nrhs, sizeof *rhs), *s = optla_array_(ctx, k, sizeof *s);
	lapack_int lwork = 0, info = 0, found = 0;
	if (c && rhs && s) {
		info = LAPACKE_dgelss_work(COL, M, N, R, c, M, rhs, L, s, rcond, &found, &size, -1);
		work = workspace(ctx, size, &lwork);
	}
	optla_status status = OPTLA_ERR_NOMEM;
	if (work) {
		for (size_t j = 0; j < nrhs; j++) memcpy(rhs + j * ld, b + j * m, m * sizeof *b);
		if (!info) info = LAPACKE_dgelss_work(COL, M, N, R, c, M, rhs, L, s, rcond, &found, work, lwork);
		status = lapack_status(ctx, "dgelss", info);
		for (size_t j = 0; j < nrhs; j++) memcpy(x + j * n, rhs + j * ld, n * sizeof *x);
		if (rank) *rank = (size_t)found;
	}
	optla_free(ctx, work);
	optla_free(ctx, s);
	optla_free(ctx, rhs);
	optla_free(ctx, c);
	return status;
}

optla_status optla_eigh_(optla_ctx *ctx, const double *a, size_t n, double *w, double *v)
{
	OPTLA_TRY(check_sizes(ctx, n, n, 0));
	if (!n) return OPTLA_OK;
	const lapack_int N = (lapack_int)n;
	double size = 0;
	memcpy(v, a, n * n * sizeof *v);
	lapack_int lwork = 0, info = LAPACKE_dsyev_work(COL, 'V', 'U', N, v, N, w, &size, -1);
	double *work = workspace(ctx, size, &lwork);
	if (!work) return OPTLA_ERR_NOMEM;
	if (!info) info = LAPACKE_dsyev_work(COL, 'V', 'U', N, v, N, w, work, lwork);
	optla_free(ctx, work);
	return lapack_status(ctx, "dsyev", info);
}

optla_status optla_solve_(optla_ctx *ctx, const double *a, size_t n, const double *b, size_t nrhs, double *x)
{
	OPTLA_TRY(check_sizes(ctx, n, n, nrhs));
	if (!n || !nrhs) return OPTLA_OK;
	double *lu = copy(ctx, a, n * n);
	lapack_int *pivot = optla_array_(ctx, n, sizeof *pivot), info = 0;
	const bool have = lu && pivot;
	if (have) {
		memmove(x, b, n * nrhs * sizeof *x);
		info = LAPACKE_dgesv_work(COL, (lapack_int)n, (lapack_int)nrhs, lu, (lapack_int)n, pivot, x, (lapack_int)n);
	}
	optla_free(ctx, pivot);
	optla_free(ctx, lu);
	if (!have) return OPTLA_ERR_NOMEM;
	OPTLA_CHECK(ctx, info <= 0, OPTLA_ERR_ARG, "the %zu x %zu matrix is singular: pivot %d is zero", n, n, (int)info);
	return lapack_status(ctx, "dgesv", info);
}
