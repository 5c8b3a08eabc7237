/* SPDX-License-Identifier: BSD-3-Clause */
/* optla krylov: what a finished run says, how good its result is, and the result as a file. */
#include "krylov_job.h"

#include "inputs.h"

#include "base/base_impl.h"

#include <math.h>

void krylov_say_info(krylov_job *j, const optla_krylov_info *i)
{
	cli_run *run = j->run;
	uint64_t by_sign = 0, by_offset = 0, high_sign = 0, high_offset = 0;
	optla_op_signed_counts(j->op, &by_sign, &by_offset);
	if (j->high) optla_op_signed_counts(j->high, &high_sign, &high_offset);
	by_sign += high_sign;
	by_offset += high_offset;
	cli_text(run, "method", j->method_name);
	cli_text(run, "rig", run->arguments[1]);
	cli_text(run, "channel", cli_channel_name(j->o.op.channel));
	cli_text(run, "sensor", j->o.op.sensor ? j->o.sensor.sensor : "none");
	json_object_set_new(run->numbers, "symmetric", json_boolean(j->o.krylov.symmetric));
	cli_number(run, "nrows", (double)optla_op_nrows(j->op));
	cli_number(run, "ncols", (double)optla_op_ncols(j->op));
	cli_cost(run, i->photos, i->exposure_s);
	cli_number(run, "iterations", (double)i->iterations);
	cli_number(run, "rank", (double)i->rank);
	cli_number(run, "residual", i->residual);
	cli_number(run, "noise", i->noise);
	if (j->method == OPTLA_KRYLOV_GMRES) cli_number(run, "noise_allowed", i->noise_allowed);
	cli_number(run, "seconds_in_operator", i->seconds_operator);
	cli_number(run, "seconds_outside", i->seconds_total - i->seconds_operator);
	cli_text(run, "stop", optla_stop_name(i->stop));
	cli_number(run, "photos_saved", (double)i->photos_saved);
	cli_number(run, "products_split_by_sign", (double)by_sign);
	cli_number(run, "products_split_by_offset", (double)by_offset);
	cli_say(run, "%s on '%s', %s channel%s, T is %zu x %zu%s\n", j->method_name, j->info.name ? j->info.name : run->arguments[1],
	        cli_channel_name(j->o.op.channel), j->high ? " (photos kept in colour)" : "", optla_op_nrows(j->op),
	        optla_op_ncols(j->op), j->o.krylov.symmetric ? ", symmetric" : "");
	cli_say(run, "  iterations       %zu, stopped by: %s\n", i->iterations, optla_stop_name(i->stop));
	cli_say(run, "  rank             %zu\n", i->rank);
	cli_say(run, "  photos           %llu, %.4g s of exposure; products split by sign %llu, by offset %llu\n",
	        (unsigned long long)i->photos, i->exposure_s, (unsigned long long)by_sign, (unsigned long long)by_offset);
	if (i->photos_saved) cli_say(run, "  photos saved     %llu (more could not help)\n", (unsigned long long)i->photos_saved);
	cli_say(run, "  residual         %.4g\n", i->residual);
	if (i->noise > 0) cli_say(run, "  noise            %.4g (expected norm of the error of all photos)\n", i->noise);
	cli_say(run, "  time             %.3f s in products, %.3f s outside\n", i->seconds_operator,
	        i->seconds_total - i->seconds_operator);
}

/* Eq. 2.11 after each iteration, against the exact T. */
static optla_status capture_error(krylov_job *j)
{
	optla_cblock d, p;
	OPTLA_TRY(optla_krylov_bases(j->krylov, &d, &p, NULL));
	if (!d.ncols) return OPTLA_OK;
	double *errors = optla_array_(j->run->ctx, d.ncols, sizeof *errors);
	if (!errors) return OPTLA_ERR_NOMEM;
	const optla_status status = optla_relative_errors(d, p, j->truth, errors);
	if (!status) {
		json_t *list = json_array();
		for (size_t k = 0; k < d.ncols; k++) json_array_append_new(list, json_real(errors[k]));
		cli_number(j->run, "relative_error", errors[d.ncols - 1]);
		json_object_set_new(j->run->numbers, "relative_errors", list);
		cli_say(j->run, "  relative error   %.6g of T (Eq. 2.11)\n", errors[d.ncols - 1]);
	}
	optla_free(j->run->ctx, errors);
	return status;
}

/* ||T p - i|| / ||i|| with the exact T: what a photo without noise would show. */
static optla_status solution_error(krylov_job *j, const void *p)
{
	optla_ctx *ctx = j->run->ctx;
	const size_t n = optla_op_nrows(j->op), cols = optla_op_ncols(j->op);
	const optla_scalar have = optla_op_type(j->op), want = optla_op_type(j->truth);
	void *x = optla_array_(ctx, cols, optla_scalar_bytes(want)), *y = optla_array_(ctx, n, optla_scalar_bytes(want));
	optla_status status = x && y ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!status) {
		for (size_t k = 0; k < cols; k++) cli_set(x, want, k, cli_get(p, have, k));
		status = optla_op_apply(j->truth, OPTLA_FORWARD, (optla_cblock){x, cols, 1, cols, want}, (optla_block){y, n, 1, n, want});
	}
	if (!status) {
		double d2 = 0, i2 = 0;
		for (size_t m = 0; m < n; m++) {
			const double i = cli_get(j->target, have, m), e = cli_get(y, want, m) - i;
			d2 += e * e;
			i2 += i * i;
		}
		cli_number(j->run, "relative_error", sqrt(d2 / i2));
		cli_say(j->run, "  relative error   %.6g of the photo that it makes without noise\n", sqrt(d2 / i2));
	}
	optla_free(ctx, x);
	optla_free(ctx, y);
	return status;
}

/* ---- results ---- */

static optla_status save_capture(krylov_job *j)
{
	if (j->truth) OPTLA_TRY(capture_error(j));
	if (!j->run->shared.out) return OPTLA_OK;
	OPTLA_TRY(optla_model_from_krylov(j->rig, j->krylov, &j->model));
	OPTLA_TRY(optla_model_save(j->model, j->run->shared.out));
	cli_say(j->run, "  model            %s\n", j->run->shared.out);
	return OPTLA_OK;
}

static optla_status save_lights(krylov_job *j)
{
	optla_ctx *ctx = j->run->ctx;
	const size_t n = optla_op_ncols(j->op);
	const optla_scalar type = optla_op_type(j->op);
	void *p = optla_array_(ctx, n, optla_scalar_bytes(type));
	j->lights = optla_array_(ctx, n, sizeof *j->lights);
	optla_status status = p && j->lights ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!status && j->method == OPTLA_KRYLOV_GMRES) {
		double residual;
		status = optla_krylov_solution(j->krylov, 0, p, &residual);
		if (!status) {
			cli_number(j->run, "residual", residual);
			cli_say(j->run, "  residual         %.6g of the illumination as it is written\n", residual);
		}
		if (!status && j->truth) status = solution_error(j, p);
	} else if (!status) {
		double value;
		status = optla_krylov_principal(j->krylov, p, &value);
		if (!status) {
			cli_number(j->run, "value", value);
			cli_say(j->run, "  %s   %.8g\n", j->o.krylov.symmetric ? "eigenvalue    " : "singular value", value);
		}
	}
	const cli_lights lights = {n, j->info.light_width, j->info.light_height};
	for (size_t k = 0; !status && k < n; k++) j->lights[k] = cli_get(p, type, k);
	if (!status && j->run->shared.out) status = cli_save_lights(j->run, &lights, j->lights, 1, &j->o.picture, j->run->shared.out);
	if (!status && j->run->shared.out) cli_say(j->run, "  illumination     %s\n", j->run->shared.out);
	optla_free(ctx, p);
	return status;
}

optla_status krylov_save_result(krylov_job *j) { return krylov_is_capture(j) ? save_capture(j) : save_lights(j); }
