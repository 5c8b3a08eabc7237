/* SPDX-License-Identifier: BSD-3-Clause */
/* Products of a run: photos within the budget, their cost and noise; and what ends a run. */
#include "run.h"

#include <math.h>

static optla_op_cost difference(optla_op_cost now, optla_op_cost then)
{
	now.applies -= then.applies;
	now.forward_columns -= then.forward_columns;
	now.transpose_columns -= then.transpose_columns;
	now.photos -= then.photos;
	now.exposure_s -= then.exposure_s;
	now.seconds -= then.seconds;
	return now;
}

optla_op_cost optla_krylov_cost_(const optla_krylov *run)
{
	optla_op_cost c = difference(optla_op_cost_so_far(run->op), run->cost_op0);
	if (run->high) {
		const optla_op_cost h = difference(optla_op_cost_so_far(run->high), run->cost_high0);
		c.applies += h.applies;
		c.forward_columns += h.forward_columns;
		c.transpose_columns += h.transpose_columns;
		c.photos += h.photos;
		c.exposure_s += h.exposure_s;
		c.seconds += h.seconds;
	}
	return c;
}

uint64_t optla_krylov_photos_(const optla_krylov *run) { return run->photos_before + optla_krylov_cost_(run).photos; }

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
	if (optla_krylov_photos_(run) + price <= (uint64_t)run->opt.max_photos) return true;
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
		OPTLA_TRY(optla_op_apply(run->high, OPTLA_FORWARD, p, h));
		OPTLA_TRY(optla_op_apply(run->reduce, OPTLA_FORWARD, optla_block_const(h), d));
	} else {
		OPTLA_TRY(optla_op_apply(run->op, OPTLA_FORWARD, p, d));
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
	return *within ? optla_op_apply(run->op, OPTLA_CONJ_TRANSPOSE, r, s) : OPTLA_OK;
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
