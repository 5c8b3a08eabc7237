/* SPDX-License-Identifier: BSD-3-Clause */
/* A run's life: checked and allocated at once, stepped, judged, freed. */
#include "run.h"
#include "base/random.h"

#include <math.h>

static optla_status check_problem(optla_ctx *ctx, const optla_krylov_problem *problem, optla_krylov_method method,
                                  const optla_krylov_options *o)
{
	const size_t nrows = optla_op_nrows(problem->op), ncols = optla_op_ncols(problem->op);
	const optla_scalar type = optla_op_type(problem->op);
	OPTLA_CHECK(ctx, type == OPTLA_F32 || type == OPTLA_F64, OPTLA_ERR_UNSUPPORTED,
	            "Krylov methods need a real operator, '%s' is complex", optla_op_name(problem->op));
	OPTLA_CHECK(ctx, !o->symmetric || nrows == ncols, OPTLA_ERR_SHAPE,
	            "the symmetric form needs a square operator, '%s' is %zu x %zu", optla_op_name(problem->op), nrows, ncols);
	OPTLA_CHECK(ctx, method == OPTLA_KRYLOV_POWER || (size_t)o->iterations <= ncols, OPTLA_ERR_ARG,
	            "%d iterations are wanted, but a %zu x %zu operator has only %zu independent illuminations: ask for no more",
	            o->iterations, nrows, ncols, ncols);
	OPTLA_CHECK(ctx, o->rank <= o->iterations, OPTLA_ERR_ARG, "rank %d is wanted from %d iterations: it can't be larger", o->rank,
	            o->iterations);
	OPTLA_CHECK(ctx, o->symmetric || !(optla_op_flags(problem->op) & OPTLA_OP_NO_TRANSPOSE), OPTLA_ERR_UNSUPPORTED,
	            "operator '%s' can't answer Tᵀ r, which the form for non-symmetric T needs", optla_op_name(problem->op));
	OPTLA_CHECK(ctx, method == OPTLA_KRYLOV_POWER || !(optla_op_flags(problem->op) & OPTLA_OP_NONNEGATIVE), OPTLA_ERR_UNSUPPORTED,
	            "operator '%s' accepts only light: split the sign with optla_op_signed()", optla_op_name(problem->op));
	OPTLA_CHECK(ctx, !problem->high == !problem->reduce, OPTLA_ERR_ARG, "high and reduce come together");
	if (problem->high) {
		OPTLA_CHECK(ctx, method != OPTLA_KRYLOV_POWER, OPTLA_ERR_ARG, "power iteration keeps no high-resolution photos");
		OPTLA_CHECK(ctx,
		            optla_op_ncols(problem->high) == ncols && optla_op_nrows(problem->reduce) == nrows &&
		                optla_op_ncols(problem->reduce) == optla_op_nrows(problem->high),
		            OPTLA_ERR_SHAPE, "reduce (%zu x %zu) times high (%zu x %zu) must be %zu x %zu",
		            optla_op_nrows(problem->reduce), optla_op_ncols(problem->reduce), optla_op_nrows(problem->high),
		            optla_op_ncols(problem->high), nrows, ncols);
		OPTLA_CHECK(ctx, optla_op_type(problem->high) == type && optla_op_type(problem->reduce) == type, OPTLA_ERR_SHAPE,
		            "high and reduce must have the operator's scalar type");
	}
	OPTLA_CHECK(ctx, method != OPTLA_KRYLOV_GMRES || problem->target, OPTLA_ERR_ARG, "GMRES needs a target photo");
	return OPTLA_OK;
}

static bool allocate(optla_krylov *run, optla_block *b, size_t nrows, size_t ncols)
{
	*b = optla_block_(optla_calloc_(run->ctx, ncols, nrows * optla_scalar_bytes(run->type)), nrows, ncols, run->type);
	return b->data;
}

static bool allocate_numbers(optla_krylov *run, double **p, size_t n)
{
	*p = optla_calloc_(run->ctx, n, sizeof **p);
	return *p;
}

/* Everything is asked for, then checked once; destroy frees what there is. */
static optla_status allocate_all(optla_krylov *run)
{
	const bool power = run->method == OPTLA_KRYLOV_POWER, gmres = run->method == OPTLA_KRYLOV_GMRES,
	           svd = run->method == OPTLA_KRYLOV_SVD;
	const bool back = !run->opt.symmetric;
	const size_t k = run->kmax, columns = power ? 1 : k, rank = (size_t)run->opt.rank;
	bool good = allocate(run, &run->p, run->ncols, power ? 1 : k + 1) && allocate(run, &run->d, run->nrows, columns) &&
	            allocate(run, &run->work, optla_max_(run->nrows, run->ncols), 1) && allocate(run, &run->coef, k + 1, 1) &&
	            allocate_numbers(run, &run->residuals, k) && allocate_numbers(run, &run->noise, k) &&
	            allocate_numbers(run, &run->energy, k);
	if (good && run->high) good = allocate(run, &run->h, run->nhigh, columns);
	if (good && back)
		good = allocate(run, &run->s, run->ncols, columns) && (power || allocate(run, &run->r, run->nrows, columns));
	if (good && gmres)
		good = allocate(run, &run->q, run->nrows, k) && allocate(run, &run->target, run->nrows, 1) &&
		       allocate_numbers(run, &run->qt, k) && allocate_numbers(run, &run->gaps, k) &&
		       allocate_numbers(run, &run->small, k);
	if (good && (gmres || svd)) good = allocate_numbers(run, &run->qr, k * k);
	if (good && rank && !gmres && !power)
		good = allocate(run, &run->rd, run->nrows, rank) && allocate(run, &run->rp, run->ncols, rank) &&
		       (!run->high || allocate(run, &run->rh, run->nhigh, rank));
	return good ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

/* Copies a vector and checks that it is finite and not zero; *norm its length. */
static optla_status take_vector(optla_krylov *run, const char *what, const void *from, optla_block to, double *norm)
{
	optla_copy_column_(optla_cblock_(from, to.nrows, 1, run->type), 0, to, 0);
	*norm = optla_norm_(optla_block_const(to), 0);
	OPTLA_CHECK(run->ctx, isfinite(*norm), OPTLA_ERR_ARG, "the %s holds NaN or infinity", what);
	OPTLA_CHECK(run->ctx, *norm > 0, OPTLA_ERR_ARG, "the %s is zero everywhere", what);
	return OPTLA_OK;
}

/* E||R z||² = ||R||_F² for random signs z: one product, no photo. */
static optla_status measure_reduce(optla_krylov *run)
{
	const optla_rand rng = {.seed = 1, .stream_hi = OPTLA_RAND_CHECK};
	const optla_block z = optla_columns_mut_(run->h, 0, 1), y = optla_columns_mut_(run->d, 0, 1);
	for (size_t m = 0; m < run->nhigh; m++) optla_set_(z, m, 0, optla_rand_u01_(rng, m, 0, 0) < 0.5 ? -1 : 1);
	OPTLA_TRY(optla_op_apply(run->reduce, OPTLA_FORWARD, optla_block_const(z), y));
	run->reduce_noise = optla_norm_(optla_block_const(y), 0) / sqrt((double)run->nhigh);
	optla_clear_(z, 0);
	optla_clear_(y, 0);
	return OPTLA_OK;
}

/* First illumination: all ones, the caller's, or for GMRES the target itself (Table 2.1). */
static optla_status start(optla_krylov *run, const optla_krylov_problem *problem)
{
	const optla_block p = optla_columns_mut_(run->p, 0, 1);
	double norm;
	if (run->high) OPTLA_TRY(measure_reduce(run));
	if (run->method == OPTLA_KRYLOV_GMRES) {
		OPTLA_TRY(take_vector(run, "target photo", problem->target, run->target, &run->target_norm));
		return OPTLA_OK; /* the first direction comes from it in the first step, by the same rule as all others */
	}
	if (problem->start) {
		OPTLA_TRY(take_vector(run, "start vector", problem->start, p, &norm));
	} else {
		for (size_t n = 0; n < run->ncols; n++) optla_set_(p, n, 0, 1);
		norm = sqrt((double)run->ncols);
	}
	optla_scale_(p, 0, 1 / norm);
	run->have_next = true;
	return OPTLA_OK;
}

optla_status optla_krylov_create(const optla_krylov_problem *problem, optla_krylov_method method,
                                 const optla_krylov_options *options, optla_krylov **out)
{
	if (!out) return OPTLA_ERR_ARG;
	*out = NULL;
	if (!problem || problem->size != sizeof *problem || !problem->op) return OPTLA_ERR_ARG;
	optla_ctx *ctx = optla_op_ctx(problem->op);
	if (!options) options = &optla_krylov_defaults;
	OPTLA_TRY(optla_options_check(ctx, &optla_krylov_table, options));
	OPTLA_CHECK(ctx, (int)method >= 0 && method <= OPTLA_KRYLOV_SVD, OPTLA_ERR_ARG, "there is no Krylov method %d", (int)method);
	OPTLA_TRY(check_problem(ctx, problem, method, options));
	optla_krylov *run = optla_calloc_(ctx, 1, sizeof *run);
	if (!run) return OPTLA_ERR_NOMEM;
	run->ctx = ctx;
	run->method = method;
	run->opt = *options;
	run->op = optla_op_ref(problem->op);
	run->high = problem->high ? optla_op_ref(problem->high) : NULL;
	run->reduce = problem->reduce ? optla_op_ref(problem->reduce) : NULL;
	run->type = optla_op_type(run->op);
	run->nrows = optla_op_nrows(run->op);
	run->ncols = optla_op_ncols(run->op);
	run->nhigh = run->high ? optla_op_nrows(run->high) : 0;
	run->kmax = (size_t)options->iterations;
	run->stop = OPTLA_STOP_NONE;
	optla_status status = allocate_all(run);
	if (!status) status = start(run, problem);
	if (status) {
		optla_krylov_destroy(&run);
		return status;
	}
	*out = run;
	return OPTLA_OK;
}

void optla_krylov_destroy(optla_krylov **out)
{
	if (!out || !*out) return;
	optla_krylov *run = *out;
	optla_ctx *ctx = run->ctx;
	void *const blocks[] = {run->p.data,  run->d.data,      run->h.data,    run->r.data,    run->s.data,
	                        run->q.data,  run->target.data, run->work.data, run->coef.data, run->rd.data,
	                        run->rp.data, run->rh.data,     run->qr,        run->qt,        run->residuals,
	                        run->noise,   run->gaps,        run->energy,    run->small};
	for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) optla_free(ctx, blocks[k]);
	optla_op_unref(&run->op);
	optla_op_unref(&run->high);
	optla_op_unref(&run->reduce);
	optla_free(ctx, run);
	*out = NULL;
}

static const char *task_name(optla_krylov_method method)
{
	switch (method) {
	case OPTLA_KRYLOV_POWER: return "power iteration";
	case OPTLA_KRYLOV_ARNOLDI: return "Arnoldi";
	case OPTLA_KRYLOV_GMRES: return "GMRES";
	case OPTLA_KRYLOV_SVD: return "singular vectors";
	}
	return "Krylov";
}

static optla_status one_step(optla_krylov *run)
{
	if (run->method == OPTLA_KRYLOV_POWER) return optla_power_step_(run);
	if (run->method == OPTLA_KRYLOV_SVD && !run->opt.symmetric) return optla_svd_step_(run);
	return optla_arnoldi_step_(run);
}

/* Which of the photos make the result. */
static optla_status conclude(optla_krylov *run)
{
	bool useless;
	run->rank = run->k;
	if (run->opt.noise_stop && run->method != OPTLA_KRYLOV_POWER) run->rank = optla_noise_best_(run, &useless);
	if (run->method == OPTLA_KRYLOV_SVD && run->k) OPTLA_TRY(optla_svd_residual_(run, &run->residuals[run->k - 1]));
	return optla_krylov_truncate_(run);
}

optla_status optla_krylov_step(optla_krylov *run, size_t iterations)
{
	const double began = optla_now_s_(), before = run->seconds_total;
	const size_t last = optla_min_(run->kmax, run->k + optla_min_(iterations, run->kmax));
	optla_status status = OPTLA_OK;
	run->stop = run->done ? run->stop : OPTLA_STOP_NONE;
	while (!status && !run->done && run->k < last) {
		status = optla_report_(run->ctx, task_name(run->method), run->k, run->kmax, began, "residual",
		                       run->k ? run->residuals[run->k - 1] : 1);
		if (!status) status = one_step(run);
	}
	if (status == OPTLA_ERR_CANCELLED) run->stop = OPTLA_STOP_CANCELLED;
	const optla_status end = conclude(run);
	run->seconds_total = before + optla_now_s_() - began;
	return status ? status : end;
}

optla_status optla_krylov_run(optla_krylov *run) { return optla_krylov_step(run, run->kmax); }

optla_krylov_info optla_krylov_get_info(const optla_krylov *run)
{
	optla_krylov_info info = {.stop = run->stop,
	                          .iterations = run->k,
	                          .rank = optla_krylov_columns_(run),
	                          .photos = run->photos,
	                          .exposure_s = run->exposure_s,
	                          .seconds_operator = run->seconds_operator,
	                          .seconds_total = run->seconds_total,
	                          .noise_allowed = optla_noise_allowed_(run)};
	const size_t at = run->method == OPTLA_KRYLOV_GMRES ? run->rank : run->k;
	info.residual = at ? run->residuals[at - 1] : 1;
	if (run->method == OPTLA_KRYLOV_GMRES)
		info.residual_true = at ? sqrt(fmax(0, optla_noise_true_residual2_(run, at))) / run->target_norm : 1;
	for (size_t j = 0; j < optla_min_(run->rank, run->method == OPTLA_KRYLOV_POWER ? 0 : run->k); j++)
		info.noise = hypot(info.noise, run->noise[j]);
	if (run->method == OPTLA_KRYLOV_POWER && run->k) info.noise = run->noise[run->k - 1];
	if (run->stop == OPTLA_STOP_NOISE && run->k) info.photos_saved = (run->kmax - run->k) * info.photos / run->k;
	return info;
}
