/* SPDX-License-Identifier: BSD-3-Clause */
/* Optical Arnoldi (Algorithm 2), for symmetric T and for TᵀT, and the iterations of GMRES (Table 2.1), which differ in the first
   vector alone.

   When the Krylov space is exhausted before K (repeated singular values, a start vector that is poor in directions) the method goes on
   with a random direction outside P; if that one is dark too, T has no more to give. */
#include "run.h"

static bool is_gmres(const optla_krylov *run) { return run->method == OPTLA_KRYLOV_GMRES; }

/* What the next direction comes from: the last photo, or for the first step of GMRES the target. */
static optla_cblock source(const optla_krylov *run)
{
	return run->k ? optla_columns_(optla_block_const(run->d), run->k - 1, 1) : optla_block_const(run->target);
}

/* Non-symmetric form: s = Tᵀ r, r the normalised source (Eq. 2.6). Column of r and s: in GMRES k, else k-1. */
static optla_status shine_back(optla_krylov *run, optla_block w, bool *within)
{
	const size_t column = is_gmres(run) ? run->k : run->k - 1;
	const optla_block r = optla_columns_mut_(run->r, column, 1), s = optla_columns_mut_(run->s, column, 1);
	const optla_cblock from = source(run);
	optla_copy_column_(from, 0, r, 0);
	optla_scale_(r, 0, 1 / optla_norm_(from, 0));
	OPTLA_TRY(optla_krylov_back_(run, optla_block_const(r), s, within));
	if (*within) optla_copy_column_(optla_block_const(s), 0, w, 0);
	return OPTLA_OK;
}

static optla_status take_fresh(optla_krylov *run)
{
	if (is_gmres(run)) { /* the space is invariant: the solution in it is final */
		optla_krylov_finish_(run, OPTLA_STOP_BREAKDOWN);
		return OPTLA_OK;
	}
	const optla_block w = optla_columns_mut_(run->p, run->k, 1);
	bool found;
	OPTLA_TRY(optla_ortho_fresh_(run, optla_block_const(run->p), run->k, w, &found));
	run->fresh = run->have_next = found;
	if (!found) optla_krylov_finish_(run, OPTLA_STOP_BREAKDOWN);
	return OPTLA_OK;
}

/* p_k = ortho(p_1 .. p_{k-1}, w), normalised. */
static optla_status next_direction(optla_krylov *run)
{
	const size_t k = run->k;
	const optla_block w = optla_columns_mut_(run->p, k, 1);
	if (k && run->energy[k - 1] == 0) return take_fresh(run);
	if (!is_gmres(run) && k) run->residuals[k - 1] = k > 1 ? run->residuals[k - 2] : 1; /* until s_k is known, if ever */
	bool within = true;
	if (run->opt.symmetric)
		optla_copy_column_(source(run), 0, w, 0);
	else
		OPTLA_TRY(shine_back(run, w, &within));
	if (!within) return OPTLA_OK;
	double before, after;
	OPTLA_TRY(optla_ortho_(run, optla_block_const(run->p), k, w, &before, &after, NULL));
	if (!is_gmres(run) && k) {
		if (run->first <= 0) run->first = before;
		run->residuals[k - 1] = run->first > 0 ? after / run->first : 0;
	}
	if (after <= optla_ortho_dirt_(run->type) * before || after <= 0) return take_fresh(run);
	optla_scale_(w, 0, 1 / after);
	run->have_next = true;
	run->fresh = false;
	return OPTLA_OK;
}

optla_status optla_arnoldi_step_(optla_krylov *run)
{
	if (!run->have_next) OPTLA_TRY(next_direction(run));
	if (run->done) return OPTLA_OK;
	const size_t k = run->k;
	bool within;
	OPTLA_TRY(optla_krylov_photo_(run, k, &within)); /* d_k = T p_k */
	if (!within) return OPTLA_OK;
	const double dirt = optla_ortho_dirt_(run->type) * run->scale;
	if (run->energy[k] <= dirt * dirt) {
		if (run->fresh || is_gmres(run)) { /* a random direction outside P is dark: T has no more to give */
			optla_krylov_finish_(run, OPTLA_STOP_BREAKDOWN);
			return OPTLA_OK;
		}
		run->energy[k] = 0;
	}
	if (is_gmres(run)) OPTLA_TRY(optla_gmres_update_(run, k));
	run->k++;
	run->have_next = false;
	if (is_gmres(run) && run->residuals[k] <= optla_ortho_dirt_(run->type)) {
		optla_krylov_finish_(run, OPTLA_STOP_BREAKDOWN); /* solved to rounding: the rest of the space is dirt */
		return OPTLA_OK;
	}
	/* Algorithm 2 takes the photos of the next direction within the iteration; GMRES at the start of the next one. */
	if (!is_gmres(run)) OPTLA_TRY(next_direction(run));
	if (run->method == OPTLA_KRYLOV_SVD && run->opt.tolerance > 0) OPTLA_TRY(optla_svd_residual_(run, &run->residuals[k]));
	optla_krylov_judge_(run);
	return OPTLA_OK;
}
