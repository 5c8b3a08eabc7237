/* SPDX-License-Identifier: BSD-3-Clause */
/* What a run has found: bases, their truncation to the best rank, the principal vector. */
#include "run.h"

/* G = DᵀD, k x k, of the first k photos. */
static optla_status gram(const optla_krylov *run, size_t k, double *g)
{
	const optla_block t = optla_block_(optla_array_(run->ctx, k * k, optla_scalar_bytes(run->type)), k, k, run->type);
	if (!t.data) return OPTLA_ERR_NOMEM;
	const optla_cblock d = optla_columns_(optla_block_const(run->d), 0, k);
	const optla_status status = optla_dense_apply_(run->ctx, OPTLA_TRANSPOSE, d, d, t);
	for (size_t j = 0; !status && j < k; j++) optla_copy_column_(optla_block_const(t), j, optla_block_(g, k, k, OPTLA_F64), j);
	optla_free(run->ctx, t.data);
	return status;
}

/* The first n = columns of rd eigenvectors, largest first, from ascending ones. */
static void largest_first(double *v, size_t k)
{
	for (size_t j = 0; j < k / 2; j++)
		for (size_t l = 0; l < k; l++) {
			const double t = v[l + j * k];
			v[l + j * k] = v[l + (k - 1 - j) * k];
			v[l + (k - 1 - j) * k] = t;
		}
}

/* Best approximation of rank n of D Pᵀ: with DᵀD = W Λ Wᵀ it is (D W_n)(P W_n)ᵀ, as P is orthonormal. */
optla_status optla_krylov_truncate_(optla_krylov *run)
{
	const size_t k = run->rank;
	if (!run->rd.data || !run->done || k <= (size_t)run->opt.rank) return OPTLA_OK;
	optla_ctx *ctx = run->ctx;
	double *g = optla_array_(ctx, k * k, sizeof *g), *w = optla_array_(ctx, k, sizeof *w),
	       *v = optla_array_(ctx, k * k, sizeof *v);
	optla_status status = g && w && v ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!status) status = gram(run, k, g);
	if (!status) status = optla_eigh_(ctx, g, k, w, v);
	if (!status) largest_first(v, k);
	if (!status) status = optla_rotate_(run, optla_block_const(run->d), k, v, run->rd);
	if (!status) status = optla_rotate_(run, optla_block_const(run->p), k, v, run->rp);
	if (!status && run->high) status = optla_rotate_(run, optla_block_const(run->h), k, v, run->rh);
	optla_free(ctx, g);
	optla_free(ctx, w);
	optla_free(ctx, v);
	return status;
}

/* A run that goes on shows its bases as they are. */
static bool is_rotated(const optla_krylov *run) { return run->rd.data && run->done && (size_t)run->opt.rank < run->rank; }

size_t optla_krylov_columns_(const optla_krylov *run) { return is_rotated(run) ? (size_t)run->opt.rank : run->rank; }

optla_status optla_krylov_bases(const optla_krylov *run, optla_cblock *photos, optla_cblock *illuminations, optla_cblock *high)
{
	OPTLA_CHECK(run->ctx, run->method != OPTLA_KRYLOV_POWER, OPTLA_ERR_ARG, "power iteration keeps no basis");
	const bool rotated = is_rotated(run);
	const size_t n = optla_krylov_columns_(run);
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
