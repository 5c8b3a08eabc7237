/* SPDX-License-Identifier: BSD-3-Clause */
/* Products of a run: photos within the budget, their cost and noise; and what ends a run. */
#include "run.h"

#include <math.h>

/* A product, and what it has cost: the operator may be used by others between two products of this run. */
static optla_status multiply(optla_krylov *run, optla_op *op, optla_trans trans, optla_cblock x, optla_block y)
{
	const optla_op_cost before = optla_op_cost_so_far(op);
	const optla_status status = optla_op_apply(op, trans, x, y);
	const optla_op_cost after = optla_op_cost_so_far(op);
	run->photos += after.photos - before.photos;
	run->exposure_s += after.exposure_s - before.exposure_s;
	run->seconds_operator += after.seconds - before.seconds;
	return status;
}

void optla_krylov_finish_(optla_krylov *run, optla_stop stop)
{
	run->stop = stop;
	run->done = true;
}

static optla_op *camera(const optla_krylov *run) { return run->high ? run->high : run->op; }

bool optla_krylov_affordable_(optla_krylov *run, bool forward, bool back)
{
	if (!run->opt.max_photos) return true;
	const uint64_t price =
	    (forward ? optla_op_price(camera(run), OPTLA_FORWARD) : 0) + (back ? optla_op_price(run->op, OPTLA_TRANSPOSE) : 0);
	if (run->photos + price <= (uint64_t)run->opt.max_photos) return true;
	optla_krylov_finish_(run, OPTLA_STOP_PHOTOS);
	return false;
}

optla_status optla_krylov_photo_(optla_krylov *run, size_t k, bool *within)
{
	*within = optla_krylov_affordable_(run, true, false);
	if (!*within) return OPTLA_OK;
	const optla_cblock p = optla_columns_(optla_block_const(run->p), run->method == OPTLA_KRYLOV_POWER ? 0 : k, 1);
	const size_t column = run->method == OPTLA_KRYLOV_POWER ? 0 : k;
	const optla_block d = optla_columns_mut_(run->d, column, 1);
	if (run->high) {
		const optla_block h = optla_columns_mut_(run->h, column, 1);
		OPTLA_TRY(multiply(run, run->high, OPTLA_FORWARD, p, h));
		OPTLA_TRY(optla_op_apply(run->reduce, OPTLA_FORWARD, optla_block_const(h), d));
	} else {
		OPTLA_TRY(multiply(run, run->op, OPTLA_FORWARD, p, d));
	}
	const double norm = optla_norm_(optla_block_const(d), 0);
	run->noise[k] = optla_op_noise(camera(run)) * (run->high ? run->reduce_noise : 1);
	run->energy[k] = norm * norm;
	run->scale = fmax(run->scale, norm);
	return OPTLA_OK;
}

optla_status optla_krylov_back_(optla_krylov *run, optla_cblock r, optla_block s, bool *within)
{
	*within = optla_krylov_affordable_(run, false, true);
	return *within ? multiply(run, run->op, OPTLA_CONJ_TRANSPOSE, r, s) : OPTLA_OK;
}

void optla_krylov_judge_(optla_krylov *run)
{
	if (run->done || !run->k) return;
	bool useless = false;
	if (run->opt.noise_stop && run->method != OPTLA_KRYLOV_POWER) optla_noise_best_(run, &useless);
	const bool enough =
	    run->method != OPTLA_KRYLOV_SVD || run->k >= optla_max_((size_t)run->opt.rank, 1); /* of the wanted triplets */
	if (run->opt.tolerance > 0 && enough && run->residuals[run->k - 1] <= run->opt.tolerance)
		optla_krylov_finish_(run, OPTLA_STOP_TOLERANCE);
	else if (useless)
		optla_krylov_finish_(run, OPTLA_STOP_NOISE);
	else if (run->k == run->kmax)
		optla_krylov_finish_(run, OPTLA_STOP_ITERATIONS);
}
