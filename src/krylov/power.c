/* SPDX-License-Identifier: BSD-3-Clause */
/* Optical power iteration (Algorithm 1): project the photo, take the next one. For T that isn't symmetric the same on Tᵀ T
   (Eq. 2.6), which converges to the principal right singular vector. */
#include "run.h"

#include <math.h>

/* Noise makes dark pixels negative; light can't be. Only where the operator takes light as it is, not through a signed pair. */
static void keep_light(const optla_krylov *run, optla_block v)
{
	if (!(optla_op_flags(run->op) & OPTLA_OP_NONNEGATIVE)) return;
	for (size_t m = 0; m < v.nrows; m++)
		if (optla_get_(optla_block_const(v), m, 0) < 0) optla_set_(v, m, 0, 0);
}

/* Below this the change from photo to photo is the noise of the photo. */
static bool only_noise(const optla_krylov *run, size_t k, double lambda)
{
	return run->opt.noise_stop && run->noise[k] > 0 && run->residuals[k] * fabs(lambda) <= sqrt(2) * run->noise[k];
}

optla_status optla_power_step_(optla_krylov *run)
{
	const size_t k = run->k;
	bool within;
	OPTLA_TRY(optla_krylov_photo_(run, k, &within)); /* i_k = T p_k */
	if (!within) return OPTLA_OK;
	optla_block w = run->d;
	if (!run->opt.symmetric) {
		keep_light(run, run->d);
		OPTLA_TRY(optla_krylov_back_(run, optla_block_const(run->d), run->s, &within)); /* Tᵀ (T p_k) */
		if (!within) return OPTLA_OK;
		run->noise[k] = optla_op_noise(run->op);
		w = run->s;
	}
	const double lambda = optla_dot_(optla_block_const(run->p), 0, optla_block_const(w), 0),
	             norm = optla_norm_(optla_block_const(w), 0);
	if (norm <= 0) {
		run->value = 0;
		run->residuals[k] = 0;
		run->k++;
		optla_krylov_finish_(run, OPTLA_STOP_BREAKDOWN); /* T p = 0: the eigenvalue is 0 */
		return OPTLA_OK;
	}
	optla_scale_(run->p, 0, -lambda); /* p := w - λ p, the residual; then the next p */
	optla_axpy_(1, optla_block_const(w), 0, run->p, 0);
	run->residuals[k] = optla_norm_(optla_block_const(run->p), 0) / fabs(lambda);
	run->value = run->opt.symmetric ? lambda : sqrt(fabs(lambda));
	optla_copy_column_(optla_block_const(w), 0, run->p, 0);
	keep_light(run, run->p);
	optla_scale_(run->p, 0, 1 / optla_norm_(optla_block_const(run->p), 0)); /* p_{k+1} = i_k / ||i_k|| */
	run->k++;
	if (only_noise(run, k, lambda)) optla_krylov_finish_(run, OPTLA_STOP_NOISE);
	optla_krylov_judge_(run);
	return OPTLA_OK;
}
