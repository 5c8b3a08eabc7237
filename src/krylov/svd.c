/* SPDX-License-Identifier: BSD-3-Clause */
/* Leading singular triplets by Golub-Kahan bidiagonalisation with full re-orthogonalisation on both sides (G. H. Golub and W. Kahan,
   J. SIAM Numer. Anal. 2, 1965): D = T P = Q R, s_k = Tᵀ q_k, and the SVD of the small R = X Σ Yᵀ gives U = Q X, V = P Y.
   For symmetric T the eigenvectors of Pᵀ T P (Rayleigh-Ritz) serve, at half the photos. */
#include "run.h"

#include <math.h>
#include <string.h>

/* q_k: what is new in photo k; R(:, k). *dark: nothing is. */
static optla_status next_left(optla_krylov *run, bool *dark)
{
	const size_t k = run->k;
	const optla_block q = optla_columns_mut_(run->r, k, 1);
	double *column = run->qr + k * run->kmax, before, after;
	memset(column, 0, run->kmax * sizeof *column);
	optla_copy_column_(optla_block_const(run->d), k, q, 0);
	OPTLA_TRY(optla_ortho_(run, optla_block_const(run->r), k, q, &before, &after, column));
	*dark = after <= optla_ortho_dirt_(run->type) * run->scale;
	if (*dark) {
		bool found;
		OPTLA_TRY(optla_ortho_fresh_(run, optla_block_const(run->r), k, q, &found));
		if (!found) optla_clear_(q, 0);
		return OPTLA_OK;
	}
	optla_scale_(q, 0, 1 / after);
	column[k] = after;
	return OPTLA_OK;
}

static optla_status next_right(optla_krylov *run)
{
	const size_t k = run->k; /* photo k-1 has been taken in */
	const optla_block p = optla_columns_mut_(run->p, k, 1);
	double before, after;
	optla_copy_column_(optla_block_const(run->s), k - 1, p, 0);
	OPTLA_TRY(optla_ortho_(run, optla_block_const(run->p), k, p, &before, &after, NULL));
	run->have_next = true;
	run->fresh = after <= optla_ortho_dirt_(run->type) * run->scale;
	if (!run->fresh) {
		optla_scale_(p, 0, 1 / after);
		return OPTLA_OK;
	}
	bool found;
	OPTLA_TRY(optla_ortho_fresh_(run, optla_block_const(run->p), k, p, &found));
	if (!found) optla_krylov_finish_(run, OPTLA_STOP_BREAKDOWN); /* P spans everything */
	return OPTLA_OK;
}

optla_status optla_svd_step_(optla_krylov *run)
{
	const size_t k = run->k;
	bool within, dark;
	if (!optla_krylov_affordable_(run, true, true)) return OPTLA_OK; /* a triplet needs both sides */
	OPTLA_TRY(optla_krylov_photo_(run, k, &within));
	if (!within) return OPTLA_OK;
	OPTLA_TRY(next_left(run, &dark));
	if (dark && run->fresh) { /* a random direction outside P shows nothing new: T = D Pᵀ */
		optla_krylov_finish_(run, OPTLA_STOP_BREAKDOWN);
		return OPTLA_OK;
	}
	OPTLA_TRY(
	    optla_krylov_back_(run, optla_columns_(optla_block_const(run->r), k, 1), optla_columns_mut_(run->s, k, 1), &within));
	if (!within) return OPTLA_OK;
	run->k++;
	OPTLA_TRY(next_right(run));
	run->residuals[k] = 0;
	if (run->opt.tolerance > 0) OPTLA_TRY(optla_svd_residual_(run, &run->residuals[k]));
	optla_krylov_judge_(run);
	return OPTLA_OK;
}

/* The small problem: values (k), coefficients of U and V in their bases (k x k each). */
static optla_status small_svd(const optla_krylov *run, double *values, double *x, double *y)
{
	const size_t k = run->k;
	optla_ctx *ctx = run->ctx;
	double *a = optla_calloc_(ctx, k * k, sizeof *a), *yt = optla_array_(ctx, k * k, sizeof *yt);
	optla_status status = a && yt ? OPTLA_OK : OPTLA_ERR_NOMEM;
	for (size_t j = 0; !status && j < k; j++) memcpy(a + j * k, run->qr + j * run->kmax, (j + 1) * sizeof *a);
	if (!status) status = optla_svd_(ctx, a, k, k, values, x, yt);
	for (size_t j = 0; !status && j < k; j++)
		for (size_t l = 0; l < k; l++) y[j + l * k] = yt[l + j * k];
	optla_free(ctx, a);
	optla_free(ctx, yt);
	return status;
}

/* Rayleigh-Ritz: H = Pᵀ D, symmetrised; values by |λ|, x = sign(λ) y. */
static optla_status small_eigen(const optla_krylov *run, double *values, double *x, double *y)
{
	const size_t k = run->k;
	optla_ctx *ctx = run->ctx;
	double *h = optla_array_(ctx, k * k, sizeof *h), *w = optla_array_(ctx, k, sizeof *w),
	       *v = optla_array_(ctx, k * k, sizeof *v);
	optla_status status = h && w && v ? OPTLA_OK : OPTLA_ERR_NOMEM;
	for (size_t j = 0; !status && j < k; j++)
		for (size_t l = 0; l < k; l++) h[l + j * k] = optla_dot_(optla_block_const(run->p), l, optla_block_const(run->d), j);
	for (size_t j = 0; !status && j < k; j++)
		for (size_t l = 0; l < j; l++) h[l + j * k] = h[j + l * k] = 0.5 * (h[l + j * k] + h[j + l * k]);
	if (!status) status = optla_eigh_(ctx, h, k, w, v);
	for (size_t j = 0, lo = 0, hi = k; !status && j < k; j++) { /* ascending eigenvalues: the largest |λ| is at an end */
		const size_t from = fabs(w[lo]) > fabs(w[hi - 1]) ? lo++ : --hi;
		values[j] = fabs(w[from]);
		for (size_t l = 0; l < k; l++) {
			y[l + j * k] = v[l + from * k];
			x[l + j * k] = w[from] < 0 ? -y[l + j * k] : y[l + j * k];
		}
	}
	optla_free(ctx, h);
	optla_free(ctx, w);
	optla_free(ctx, v);
	return status;
}

/* Coefficients of left vectors belong to Q (kept in r) or, for symmetric T, to P. */
static optla_cblock left_basis(const optla_krylov *run) { return optla_block_const(run->opt.symmetric ? run->p : run->r); }

/* The columns of the result (info.rank), or before there is one as many as asked for. */
static size_t wanted(const optla_krylov *run)
{
	const size_t k = run->rank ? optla_min_(run->rank, run->k) : run->k;
	return run->opt.rank ? optla_min_((size_t)run->opt.rank, k) : k;
}

/* max(||T v - σ u||, ||Tᵀ u - σ v||) / σ_1, T v = D y and Tᵀ u = S x being sums of photos that were taken. t: scratch columns. */
static optla_status triplet_residual(const optla_krylov *run, size_t j, const double *values, const double *x, const double *y,
                                     optla_block t[3], double *residual)
{
	const size_t k = run->k;
	const double *xj = x + j * k, *yj = y + j * k;
	const optla_block left = t[0], right = t[1];
	optla_block image = t[2];
	OPTLA_TRY(optla_rotate_(run, left_basis(run), k, xj, left));
	OPTLA_TRY(optla_rotate_(run, optla_block_const(run->p), k, yj, right));
	image.nrows = run->nrows;
	OPTLA_TRY(optla_rotate_(run, optla_block_const(run->d), k, yj, image));
	optla_axpy_(-values[j], optla_block_const(left), 0, image, 0);
	double worst = optla_norm_(optla_block_const(image), 0);
	if (!run->opt.symmetric) {
		image.nrows = run->ncols;
		OPTLA_TRY(optla_rotate_(run, optla_block_const(run->s), k, xj, image));
		optla_axpy_(-values[j], optla_block_const(right), 0, image, 0);
		worst = fmax(worst, optla_norm_(optla_block_const(image), 0));
	}
	*residual = values[0] > 0 ? worst / values[0] : 0;
	return OPTLA_OK;
}

static optla_status triplets(const optla_krylov *run, double *values, optla_block *left, optla_block *right, double *residual,
                             double *worst)
{
	optla_ctx *ctx = run->ctx;
	const size_t k = run->k, n = wanted(run), bytes = optla_scalar_bytes(run->type), m = optla_max_(run->nrows, run->ncols);
	double *v = optla_array_(ctx, k, sizeof *v), *x = optla_array_(ctx, k * k, sizeof *x),
	       *y = optla_array_(ctx, k * k, sizeof *y);
	optla_block t[3] = {optla_block_(optla_array_(ctx, run->nrows, bytes), run->nrows, 1, run->type),
	                    optla_block_(optla_array_(ctx, run->ncols, bytes), run->ncols, 1, run->type),
	                    optla_block_(optla_array_(ctx, m, bytes), m, 1, run->type)};
	optla_status status = v && x && y && t[0].data && t[1].data && t[2].data ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!status && k) status = run->opt.symmetric ? small_eigen(run, v, x, y) : small_svd(run, v, x, y);
	if (!status && values) memcpy(values, v, n * sizeof *v);
	if (!status && left && left->data) status = optla_rotate_(run, left_basis(run), k, x, optla_columns_mut_(*left, 0, n));
	if (!status && right && right->data)
		status = optla_rotate_(run, optla_block_const(run->p), k, y, optla_columns_mut_(*right, 0, n));
	for (size_t j = 0; !status && j < n && (residual || worst); j++) {
		double r = 0;
		status = triplet_residual(run, j, v, x, y, t, &r);
		if (residual) residual[j] = r;
		if (worst) *worst = fmax(*worst, r);
	}
	for (int j = 0; j < 3; j++) optla_free(ctx, t[j].data);
	optla_free(ctx, v);
	optla_free(ctx, x);
	optla_free(ctx, y);
	return status;
}

optla_status optla_svd_residual_(optla_krylov *run, double *residual)
{
	*residual = 0;
	return triplets(run, NULL, NULL, NULL, NULL, residual);
}

optla_status optla_krylov_triplets(const optla_krylov *run, double *values, optla_block left, optla_block right, double *residual)
{
	optla_ctx *ctx = run->ctx;
	OPTLA_CHECK(ctx, run->method == OPTLA_KRYLOV_SVD, OPTLA_ERR_ARG, "only an SVD run has singular triplets");
	const size_t n = wanted(run);
	OPTLA_CHECK(ctx, !left.data || (left.nrows == run->nrows && left.ncols >= n && left.type == run->type), OPTLA_ERR_SHAPE,
	            "left vectors are %zu x %zu: the block is %zu x %zu", run->nrows, n, left.nrows, left.ncols);
	OPTLA_CHECK(ctx, !right.data || (right.nrows == run->ncols && right.ncols >= n && right.type == run->type), OPTLA_ERR_SHAPE,
	            "right vectors are %zu x %zu: the block is %zu x %zu", run->ncols, n, right.nrows, right.ncols);
	return triplets(run, values, &left, &right, residual, NULL);
}
