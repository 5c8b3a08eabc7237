/* SPDX-License-Identifier: BSD-3-Clause */
/* A run on disk: every photo taken, so that a stopped or interrupted run goes on where it was. */
#include "io/h5.h"
#include "run.h"

#include <math.h>
#include <string.h>

static const char *const method_names[] = {"power", "arnoldi", "gmres", "svd"};

/* The blocks of a state: name in the file, block in the run, columns that are filled, and what it is. */
typedef struct {
	const char *name, *help;
	optla_block block;
	size_t columns;
} part;

enum { PARTS = 7 };

static void list_parts(const optla_krylov *run, part parts[PARTS])
{
	const size_t k = run->k, p = run->method == OPTLA_KRYLOV_POWER ? 1 : k + (run->have_next ? 1 : 0),
	             d = run->method == OPTLA_KRYLOV_POWER ? 0 : k;
	const part list[PARTS] = {
	    {"illuminations", "orthonormal illuminations p_k; one more than photos if the next is known", run->p, p},
	    {"photos", "photos d_k = T p_k", run->d, d},
	    {"photos_high", "the same photos at full resolution", run->h, d},
	    {"dual_light", "what shone backwards, r_k", run->r, d},
	    {"dual_photos", "what came back, s_k = Tᵀ r_k", run->s, d},
	    {"photo_basis", "orthonormal basis of the photos", run->q, d},
	    {"target", "target photo i", run->target, run->target.ncols}};
	memcpy(parts, list, sizeof list);
}

typedef struct {
	const char *name;
	double *values;
	size_t count;
	double least; /* allowed: at least this and finite */
} numbers;

enum { NUMBERS = 6 };

static void list_numbers(const optla_krylov *run, numbers out[NUMBERS])
{
	const size_t k = run->k;
	const numbers list[NUMBERS] = {{"residual", run->residuals, k, 0},
	                               {"noise", run->noise, k, 0},
	                               {"energy", run->energy, k, 0},
	                               {"gap", run->gaps, k, 0},
	                               {"target_in_basis", run->qt, k, -INFINITY},
	                               {"triangle", run->qr, k, -INFINITY}};
	memcpy(out, list, sizeof list);
}

/* "triangle" is k columns of kmax entries in the run, k x k in the file. */
static optla_cblock number_block(const optla_krylov *run, const numbers *n)
{
	optla_cblock b = optla_cblock_(n->values, n->count, n->values == run->qr ? n->count : 1, OPTLA_F64);
	if (n->values == run->qr) b.ld = run->kmax;
	return b;
}

static optla_status put_all(const optla_krylov *run, optla_h5 *file)
{
	part parts[PARTS];
	numbers lists[NUMBERS];
	list_parts(run, parts);
	list_numbers(run, lists);
	for (int j = 0; j < PARTS; j++)
		if (parts[j].block.data && parts[j].columns)
			OPTLA_TRY(optla_h5_put_(file, parts[j].name, optla_columns_(optla_block_const(parts[j].block), 0, parts[j].columns),
			                        "1", parts[j].help));
	for (int j = 0; j < NUMBERS; j++)
		if (lists[j].values && lists[j].count)
			OPTLA_TRY(optla_h5_put_(file, lists[j].name, number_block(run, &lists[j]), "1", "per iteration"));
	const optla_krylov_info info = optla_krylov_get_info(run);
	OPTLA_TRY(optla_h5_put_text_(file, "method", method_names[run->method]));
	OPTLA_TRY(optla_h5_put_text_(file, "stop", optla_stop_name(run->stop)));
	OPTLA_TRY(optla_h5_put_number_(file, "iterations", (double)run->k));
	OPTLA_TRY(optla_h5_put_number_(file, "symmetric", run->opt.symmetric));
	OPTLA_TRY(optla_h5_put_number_(file, "have_next", run->have_next));
	OPTLA_TRY(optla_h5_put_number_(file, "fresh", run->fresh));
	OPTLA_TRY(optla_h5_put_number_(file, "scale", run->scale));
	OPTLA_TRY(optla_h5_put_number_(file, "first", run->first));
	OPTLA_TRY(optla_h5_put_number_(file, "value", run->value));
	OPTLA_TRY(optla_h5_put_number_(file, "photos_taken", (double)info.photos));
	return optla_h5_put_number_(file, "exposure_s", info.exposure_s);
}

optla_status optla_krylov_save(const optla_krylov *run, const char *path)
{
	optla_h5 *file;
	OPTLA_TRY(optla_h5_create_(run->ctx, path, "krylov", &file));
	const optla_status status = put_all(run, file), end = optla_h5_finish_(&file, !status);
	return status ? status : end;
}

static optla_status get_part(optla_krylov *run, optla_h5 *file, const char *path, const part *p)
{
	if (!p->block.data || !p->columns) return OPTLA_OK;
	optla_block stored;
	OPTLA_TRY(optla_h5_get_(file, p->name, run->type, &stored));
	optla_status status = OPTLA_OK;
	if (stored.nrows != p->block.nrows || stored.ncols != p->columns)
		status = OPTLA_FAIL(run->ctx, OPTLA_ERR_INPUT, "%s: %s is %zu x %zu, this run needs %zu x %zu", path, p->name,
		                    stored.nrows, stored.ncols, p->block.nrows, p->columns);
	for (size_t k = 0; !status && k < p->columns; k++) {
		optla_copy_column_(optla_block_const(stored), k, p->block, k);
		if (!isfinite(optla_norm_(optla_block_const(stored), k)))
			status = OPTLA_FAIL(run->ctx, OPTLA_ERR_INPUT, "%s: %s holds NaN or infinity", path, p->name);
	}
	optla_free(run->ctx, stored.data);
	return status;
}

/* The residual of the power method alone may be infinite: that of p with pᵀ T p = 0. */
static optla_status check_numbers(const optla_krylov *run, const char *path, const numbers *n, optla_cblock stored)
{
	const bool infinite = run->method == OPTLA_KRYLOV_POWER && n->values == run->residuals;
	for (size_t k = 0; k < stored.ncols; k++)
		for (size_t m = 0; m < stored.nrows; m++) {
			const double v = ((const double *)stored.data)[m + k * stored.ld];
			OPTLA_CHECK(run->ctx, v >= n->least && (isfinite(v) || (infinite && v > 0)), OPTLA_ERR_INPUT,
			            "%s: %s[%zu] is %g: a finite number%s is needed", path, n->name, m + k * stored.nrows, v,
			            n->least < 0 ? "" : " of at least 0");
		}
	return OPTLA_OK;
}

static optla_status get_numbers(optla_krylov *run, optla_h5 *file, const char *path, const numbers *n)
{
	if (!n->values || !n->count) return OPTLA_OK;
	const optla_cblock want = number_block(run, n);
	optla_block stored;
	OPTLA_TRY(optla_h5_get_(file, n->name, OPTLA_F64, &stored));
	optla_status status = OPTLA_OK;
	if (stored.nrows != want.nrows || stored.ncols != want.ncols)
		status = OPTLA_FAIL(run->ctx, OPTLA_ERR_INPUT, "%s: %s is %zu x %zu, %zu x %zu belong to its iterations", path, n->name,
		                    stored.nrows, stored.ncols, want.nrows, want.ncols);
	if (!status) status = check_numbers(run, path, n, optla_block_const(stored));
	for (size_t k = 0; !status && k < want.ncols; k++)
		memcpy(n->values + k * want.ld, (const double *)stored.data + k * stored.ld, want.nrows * sizeof(double));
	optla_free(run->ctx, stored.data);
	return status;
}

/* Whole numbers from 0 to limit. */
static optla_status get_count(optla_krylov *run, optla_h5 *file, const char *path, const char *name, double limit, double *value)
{
	OPTLA_TRY(optla_h5_get_number_(file, name, value));
	OPTLA_CHECK(run->ctx, *value >= 0 && *value <= limit && *value == floor(*value), OPTLA_ERR_INPUT,
	            "%s: %s is %g, a whole number from 0 to %g is needed", path, name, *value, limit);
	return OPTLA_OK;
}

/* Finite numbers from least up. */
static optla_status get_value(optla_krylov *run, optla_h5 *file, const char *path, const char *name, double least, double *value)
{
	OPTLA_TRY(optla_h5_get_number_(file, name, value));
	OPTLA_CHECK(run->ctx, isfinite(*value) && *value >= least, OPTLA_ERR_INPUT, "%s: %s is %g: a finite number%s is needed", path,
	            name, *value, least < 0 ? "" : " of at least 0");
	return OPTLA_OK;
}

static optla_status get_all(optla_krylov *run, optla_h5 *file, const char *path)
{
	double iterations, symmetric, have_next, fresh, photos;
	OPTLA_TRY(get_count(run, file, path, "iterations", 1e6, &iterations));
	OPTLA_CHECK(run->ctx, iterations <= (double)run->kmax, OPTLA_ERR_ARG,
	            "%s has %g iterations already: ask for more than that, not %zu", path, iterations, run->kmax);
	OPTLA_TRY(get_count(run, file, path, "symmetric", 1, &symmetric));
	OPTLA_CHECK(run->ctx, (symmetric != 0) == run->opt.symmetric, OPTLA_ERR_ARG, "%s was made with symmetric = %s", path,
	            symmetric != 0 ? "true" : "false");
	OPTLA_TRY(get_count(run, file, path, "have_next", 1, &have_next));
	OPTLA_TRY(get_count(run, file, path, "fresh", 1, &fresh));
	OPTLA_TRY(get_count(run, file, path, "photos_taken", 1e15, &photos));
	OPTLA_TRY(get_value(run, file, path, "scale", 0, &run->scale));
	OPTLA_TRY(get_value(run, file, path, "first", 0, &run->first));
	OPTLA_TRY(get_value(run, file, path, "value", -INFINITY, &run->value));
	OPTLA_TRY(get_value(run, file, path, "exposure_s", 0, &run->exposure_s));
	run->k = (size_t)iterations;
	run->have_next = have_next != 0;
	run->fresh = fresh != 0;
	run->photos = (uint64_t)photos;
	part parts[PARTS];
	numbers lists[NUMBERS];
	list_parts(run, parts);
	list_numbers(run, lists);
	for (int j = 0; j < PARTS; j++)
		if (parts[j].block.data != run->target.data || !run->target.data) OPTLA_TRY(get_part(run, file, path, &parts[j]));
	for (int j = 0; j < NUMBERS; j++) OPTLA_TRY(get_numbers(run, file, path, &lists[j]));
	return OPTLA_OK;
}

/* GMRES: the photos belong to one target only. */
static optla_status same_target(optla_krylov *run, optla_h5 *file, const char *path)
{
	if (run->method != OPTLA_KRYLOV_GMRES) return OPTLA_OK;
	optla_block stored;
	OPTLA_TRY(optla_h5_get_(file, "target", run->type, &stored));
	bool same = stored.nrows == run->nrows && stored.ncols == 1;
	for (size_t m = 0; same && m < run->nrows; m++)
		same = optla_get_(optla_block_const(stored), m, 0) == optla_get_(optla_block_const(run->target), m, 0);
	optla_free(run->ctx, stored.data);
	OPTLA_CHECK(run->ctx, same, OPTLA_ERR_ARG, "%s was made for another target photo", path);
	return OPTLA_OK;
}

static optla_status method_of(optla_ctx *ctx, optla_h5 *file, const char *path, optla_krylov_method *method)
{
	char *name;
	OPTLA_TRY(optla_h5_get_text_(file, "method", &name));
	int found = -1;
	for (int k = 0; k < 4; k++)
		if (!strcmp(name, method_names[k])) found = k;
	optla_free(ctx, name);
	OPTLA_CHECK(ctx, found >= 0, OPTLA_ERR_INPUT, "%s: its method is none of power, arnoldi, gmres, svd", path);
	*method = (optla_krylov_method)found;
	return OPTLA_OK;
}

static optla_status resume_from(const optla_krylov_problem *problem, const optla_krylov_options *options, optla_h5 *file,
                                const char *path, optla_krylov **out)
{
	optla_ctx *ctx = optla_op_ctx(problem->op);
	optla_krylov_method method = OPTLA_KRYLOV_POWER;
	optla_krylov *run = NULL;
	optla_status status = method_of(ctx, file, path, &method);
	if (!status) status = optla_krylov_create(problem, method, options, &run);
	if (!status) status = get_all(run, file, path);
	if (!status) status = same_target(run, file, path);
	if (status) {
		optla_krylov_destroy(&run);
	} else {
		run->rank = run->k;
		optla_krylov_judge_(run); /* it may have all that is asked for */
	}
	*out = run;
	return status;
}

optla_status optla_krylov_resume(const optla_krylov_problem *problem, const optla_krylov_options *options, const char *path,
                                 optla_krylov **out)
{
	if (!out) return OPTLA_ERR_ARG;
	*out = NULL;
	if (!problem || problem->size != sizeof *problem || !problem->op) return OPTLA_ERR_ARG;
	optla_h5 *file;
	OPTLA_TRY(optla_h5_open_(optla_op_ctx(problem->op), path, "krylov", &file));
	const optla_status status = resume_from(problem, options, file, path, out);
	optla_h5_close_(&file);
	return status;
}

optla_status optla_krylov_resume_bytes_(const optla_krylov_problem *problem, const optla_krylov_options *options,
                                        const void *bytes, size_t count, const char *name, optla_krylov **out)
{
	*out = NULL;
	optla_h5 *file;
	OPTLA_TRY(optla_h5_open_bytes_(optla_op_ctx(problem->op), bytes, count, name, &file));
	const optla_status status = resume_from(problem, options, file, name, out);
	optla_h5_close_(&file);
	return status;
}
