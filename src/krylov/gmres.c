/* SPDX-License-Identifier: BSD-3-Clause */
/* Inverse light transport: p = P argmin_y ||D y - i|| (Eq. 2.9), with footnote 3's ways to keep light non-negative.

   On the Krylov space of T from i this is GMRES (Y. Saad and M. H. Schultz, SIAM J. Sci. Stat. Comput. 7, 1986), on that of
   TᵀT from Tᵀi it is LSQR in exact arithmetic (C. C. Paige and M. A. Saunders, ACM TOMS 8, 1982). */
#include "run.h"

#include <math.h>
#include <string.h>

optla_status optla_gmres_update_(optla_krylov *run, size_t k)
{
	const optla_block q = optla_columns_mut_(run->q, k, 1);
	double *column = run->qr + k * run->kmax, before, after;
	memset(column, 0, run->kmax * sizeof *column);
	optla_copy_column_(optla_block_const(run->d), k, q, 0);
	OPTLA_TRY(optla_ortho_(run, optla_block_const(run->q), k, q, &before, &after, column));
	const bool dependent = after <= optla_ortho_dirt_(run->type) * before;
	if (dependent)
		optla_clear_(q, 0);
	else
		optla_scale_(q, 0, 1 / after);
	column[k] = dependent ? 0 : after;
	run->qt[k] = optla_dot_(optla_block_const(run->q), k, optla_block_const(run->target), 0);
	/* r = i - Q Qᵀ i, from the photos themselves */
	const optla_block r = {run->work.data, run->nrows, 1, run->nrows, run->type};
	optla_copy_column_(optla_block_const(run->target), 0, r, 0);
	for (size_t j = 0; j <= k; j++) optla_axpy_(-run->qt[j], optla_block_const(run->q), j, r, 0);
	run->residuals[k] = optla_norm_(optla_block_const(r), 0) / run->target_norm;
	optla_gmres_coefficients_(run, k + 1, run->small);
	run->gaps[k] = optla_noise_gap_(run, k + 1, run->small);
	return OPTLA_OK;
}

void optla_gmres_coefficients_(const optla_krylov *run, size_t k, double *y)
{
	for (size_t j = k; j-- > 0;) { /* R y = Qᵀ i; a dependent photo gets no weight */
		double t = run->qt[j];
		for (size_t l = j + 1; l < k; l++) t -= run->qr[j + l * run->kmax] * y[l];
		const double pivot = run->qr[j + j * run->kmax];
		y[j] = pivot != 0 ? t / pivot : 0;
	}
}

/* p = P y */
static void combine(const optla_krylov *run, size_t k, const double *y, optla_block p)
{
	optla_clear_(p, 0);
	for (size_t j = 0; j < k; j++) optla_axpy_(y[j], optla_block_const(run->p), j, p, 0);
}

/* ||i - D (Pᵀ p)|| / ||i|| */
static double recomputed_residual(const optla_krylov *run, size_t k, optla_cblock p)
{
	const optla_block r = {run->work.data, run->nrows, 1, run->nrows, run->type};
	optla_copy_column_(optla_block_const(run->target), 0, r, 0);
	for (size_t j = 0; j < k; j++)
		optla_axpy_(-optla_dot_(optla_block_const(run->p), j, p, 0), optla_block_const(run->d), j, r, 0);
	return optla_norm_(optla_block_const(r), 0) / run->target_norm;
}

optla_status optla_krylov_solution(const optla_krylov *run, size_t k, void *p, double *residual)
{
	optla_ctx *ctx = run->ctx;
	OPTLA_CHECK(ctx, run->method == OPTLA_KRYLOV_GMRES, OPTLA_ERR_ARG, "only a GMRES run has a solution");
	OPTLA_CHECK(ctx, k <= run->k, OPTLA_ERR_ARG, "a solution from %zu photos is wanted, the run has %zu", k, run->k);
	if (!k) k = run->rank;
	const optla_block x = optla_block_(p, run->ncols, 1, run->type);
	optla_gmres_coefficients_(run, k, run->small);
	combine(run, k, run->small, x);
	if (run->opt.nonnegative == OPTLA_NONNEGATIVE_NNLS && k) OPTLA_TRY(optla_gmres_nonnegative_(run, k, x));
	if (run->opt.nonnegative == OPTLA_NONNEGATIVE_CLAMP)
		for (size_t n = 0; n < run->ncols; n++) optla_set_(x, n, 0, fmax(0, optla_get_(optla_block_const(x), n, 0)));
	if (residual) *residual = recomputed_residual(run, k, optla_block_const(x));
	return OPTLA_OK;
}
