/* SPDX-License-Identifier: BSD-3-Clause */
/* What a run has found: bases, their truncation to the best rank, the principal vector. */
#include "run.h"

/* out = basis(:, 1..k) w(:, 1..n), w k x n double, largest first taken from the end of ascending eigenvectors v. */
static void rotate(optla_cblock basis, size_t k, const double *v, optla_block out)
{
	for (size_t j = 0; j < out.ncols; j++) {
		optla_clear_(out, j);
		for (size_t l = 0; j < k && l < k; l++) optla_axpy_(v[l + (k - 1 - j) * k], basis, l, out, j);
	}
}

/* Best approximation of rank n of D Pᵀ: with DᵀD = W Λ Wᵀ it is (D W_n)(P W_n)ᵀ, as P is orthonormal. */
optla_status optla_krylov_truncate_(optla_krylov *run)
{
	const size_t k = run->rank;
	if (!run->rd.data || !k || run->done == false) return OPTLA_OK;
	optla_ctx *ctx = run->ctx;
	double *g = optla_array_(ctx, k * k, sizeof *g), *w = optla_array_(ctx, k, sizeof *w),
	       *v = optla_array_(ctx, k * k, sizeof *v);
	optla_status status = g && w && v ? OPTLA_OK : OPTLA_ERR_NOMEM;
	for (size_t j = 0; !status && j < k; j++)
		for (size_t l = 0; l <= j; l++)
			g[l + j * k] = g[j + l * k] = optla_dot_(optla_block_const(run->d), l, optla_block_const(run->d), j);
	if (!status) status = optla_eigh_(ctx, g, k, w, v);
	if (!status) {
		rotate(optla_block_const(run->d), k, v, run->rd);
		rotate(optla_block_const(run->p), k, v, run->rp);
		if (run->high) rotate(optla_block_const(run->h), k, v, run->rh);
	}
	optla_free(ctx, g);
	optla_free(ctx, w);
	optla_free(ctx, v);
	return status;
}

optla_status optla_krylov_bases(const optla_krylov *run, optla_cblock *photos, optla_cblock *illuminations, optla_cblock *high)
{
	OPTLA_CHECK(run->ctx, run->method != OPTLA_KRYLOV_POWER, OPTLA_ERR_ARG, "power iteration keeps no basis");
	const bool rotated = run->rd.data && run->done && (size_t)run->opt.rank < run->rank;
	const size_t n = rotated ? (size_t)run->opt.rank : run->rank;
	if (photos) *photos = optla_columns_(optla_block_const(rotated ? run->rd : run->d), 0, n);
	if (illuminations) *illuminations = optla_columns_(optla_block_const(rotated ? run->rp : run->p), 0, n);
	if (high) {
		*high = optla_block_const(rotated ? run->rh : run->h);
		if (high->data) *high = optla_columns_(*high, 0, n);
	}
	return OPTLA_OK;
}

optla_status optla_krylov_dual_bases(const optla_krylov *run, optla_cblock *r, optla_cblock *s)
{
	OPTLA_CHECK(run->ctx, run->method != OPTLA_KRYLOV_POWER, OPTLA_ERR_ARG, "power iteration keeps no basis");
	const optla_cblock none = {.data = NULL};
	*r = run->r.data ? optla_columns_(optla_block_const(run->r), 0, run->k) : none;
	*s = run->s.data ? optla_columns_(optla_block_const(run->s), 0, run->k) : none;
	return OPTLA_OK;
}

optla_status optla_krylov_principal(const optla_krylov *run, void *vector, double *value)
{
	OPTLA_CHECK(run->ctx, run->method == OPTLA_KRYLOV_POWER, OPTLA_ERR_ARG, "only power iteration has one principal vector");
	if (vector) optla_copy_column_(optla_block_const(run->p), 0, optla_block_(vector, run->ncols, 1, run->type), 0);
	if (value) *value = run->value;
	return OPTLA_OK;
}
