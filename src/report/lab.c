/* SPDX-License-Identifier: BSD-3-Clause */
/* Operators, runs and measures of the experiments. */
#include "report/lab.h"

#include "math/dense.h"

#include <math.h>

static void destroy_op(optla_ctx *ctx, void *object)
{
	(void)ctx;
	optla_op *op = object;
	optla_op_unref(&op);
}

static void destroy_run(optla_ctx *ctx, void *object)
{
	(void)ctx;
	optla_krylov *run = object;
	optla_krylov_destroy(&run);
}

optla_status optla_lab_floats_(optla_figure *figure, size_t count, float **out)
{
	*out = optla_calloc_(figure->ctx, count, sizeof **out);
	if (!*out) return OPTLA_ERR_NOMEM;
	const optla_status s = optla_figure_hold_(figure, *out, optla_free);
	if (OPTLA_OK != s) *out = NULL;
	return s;
}

static optla_status hold_op(optla_figure *figure, optla_status status, optla_op **op)
{
	OPTLA_TRY(status);
	status = optla_figure_hold_(figure, *op, destroy_op);
	if (OPTLA_OK != status) *op = NULL;
	return status;
}

optla_status optla_lab_truth_(optla_figure *figure, optla_rig *rig, optla_channel channel, optla_op **op)
{
	return hold_op(figure, optla_rig_truth(rig, channel, op), op);
}

optla_rig_operator_options optla_lab_camera_(const optla_figure *figure, optla_channel channel, const char *sensor)
{
	optla_rig_operator_options o = optla_rig_operator_defaults;
	o.channel = channel;
	o.sensor = sensor ? optla_sensor_preset(sensor) : NULL;
	o.split = OPTLA_SPLIT_SIGNED;
	o.seed = figure->seed;
	return o;
}

/* F64 where T is known in F64. */
static optla_rig_operator_options with_type(const optla_rig *rig, const optla_rig_operator_options *options)
{
	optla_rig_info info;
	optla_rig_get_info(rig, &info);
	optla_rig_operator_options o = *options;
	o.type = info.kind == OPTLA_RIG_RECORDED ? OPTLA_F32 : OPTLA_F64;
	return o;
}

optla_status optla_lab_photos_(optla_figure *figure, optla_rig *rig, const optla_rig_operator_options *options, optla_op **op)
{
	const optla_rig_operator_options o = with_type(rig, options);
	return hold_op(figure, optla_rig_operator(rig, &o, op), op);
}

optla_status optla_lab_light_photos_(optla_figure *figure, optla_rig *rig, const optla_rig_operator_options *options,
                                     optla_op **op)
{
	const optla_rig_operator_options o = with_type(rig, options);
	return hold_op(figure, optla_rig_light_operator(rig, &o, op), op);
}

optla_status optla_lab_dense_(optla_figure *figure, const double *matrix, size_t nrows, size_t ncols, optla_op **op)
{
	return hold_op(figure, optla_op_dense(figure->ctx, optla_cblock_(matrix, nrows, ncols, OPTLA_F64), false, op), op);
}

/* A new block of the operator's type with the values of x (zeros if NULL); the caller frees .data. */
static optla_status make_block(optla_ctx *ctx, optla_scalar type, const double *x, size_t n, optla_block *block)
{
	*block = optla_block_(optla_calloc_(ctx, n, optla_scalar_bytes(type)), n, 1, type);
	if (!block->data) return OPTLA_ERR_NOMEM;
	if (x) optla_copy_column_(optla_cblock_(x, n, 1, OPTLA_F64), 0, *block, 0);
	return OPTLA_OK;
}

optla_status optla_lab_matrix_(optla_figure *figure, optla_op *op, double **matrix)
{
	const size_t m = optla_op_nrows(op), n = optla_op_ncols(op);
	OPTLA_TRY(optla_figure_doubles_(figure, m * n, matrix));
	if (optla_op_type(op) == OPTLA_F64) return optla_op_to_dense(op, optla_block_(*matrix, m, n, OPTLA_F64));
	optla_block narrow =
	    optla_block_(optla_calloc_(figure->ctx, m * n, optla_scalar_bytes(optla_op_type(op))), m, n, optla_op_type(op));
	if (!narrow.data) return OPTLA_ERR_NOMEM;
	const optla_status s = optla_op_to_dense(op, narrow);
	const optla_block wide = optla_block_(*matrix, m, n, OPTLA_F64);
	for (size_t k = 0; k < n && OPTLA_OK == s; k++) optla_copy_column_(optla_block_const(narrow), k, wide, k);
	optla_free(figure->ctx, narrow.data);
	return s;
}

optla_status optla_lab_apply_(optla_figure *figure, optla_op *op, optla_trans trans, const double *x, double *y)
{
	const size_t m = optla_op_nrows(op), n = optla_op_ncols(op);
	const size_t in = trans == OPTLA_FORWARD ? n : m, out = trans == OPTLA_FORWARD ? m : n;
	optla_block bx = {0}, by = {0};
	optla_status s = make_block(figure->ctx, optla_op_type(op), x, in, &bx);
	if (OPTLA_OK == s) s = make_block(figure->ctx, optla_op_type(op), NULL, out, &by);
	if (OPTLA_OK == s) s = optla_op_apply(op, trans, optla_block_const(bx), by);
	if (OPTLA_OK == s) optla_copy_column_(optla_block_const(by), 0, optla_block_(y, out, 1, OPTLA_F64), 0);
	optla_free(figure->ctx, bx.data);
	optla_free(figure->ctx, by.data);
	return s;
}

optla_status optla_lab_create_(optla_figure *figure, optla_op *op, optla_krylov_method method,
                               const optla_krylov_options *options, const double *start, const double *target, optla_krylov **run)
{
	*run = NULL;
	optla_block s = {0}, t = {0};
	optla_status status = OPTLA_OK;
	if (start) status = make_block(figure->ctx, optla_op_type(op), start, optla_op_ncols(op), &s);
	if (target && OPTLA_OK == status) status = make_block(figure->ctx, optla_op_type(op), target, optla_op_nrows(op), &t);
	const optla_krylov_problem problem = {.size = sizeof problem, .op = op, .start = s.data, .target = t.data};
	if (OPTLA_OK == status) status = optla_krylov_create(&problem, method, options, run);
	optla_free(figure->ctx, s.data);
	optla_free(figure->ctx, t.data);
	OPTLA_TRY(status);
	return optla_figure_hold_(figure, *run, destroy_run);
}

optla_status optla_lab_run_(optla_figure *figure, optla_op *op, optla_krylov_method method, const optla_krylov_options *options,
                            const double *start, const double *target, optla_krylov **run)
{
	OPTLA_TRY(optla_lab_create_(figure, op, method, options, start, target, run));
	return optla_krylov_run(*run);
}

double optla_lab_norm_(const double *x, size_t n) { return optla_norm_(optla_cblock_(x, n, 1, OPTLA_F64), 0); }

double optla_lab_dot_(const double *x, const double *y, size_t n)
{
	return optla_dot_(optla_cblock_(x, n, 1, OPTLA_F64), 0, optla_cblock_(y, n, 1, OPTLA_F64), 0);
}

static double difference(const double *a, const double *b, size_t n)
{
	double sum = 0;
	for (size_t k = 0; k < n; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
	return sqrt(sum);
}

double optla_lab_relative_(const double *a, const double *b, size_t n) { return difference(a, b, n) / optla_lab_norm_(b, n); }

double optla_lab_psnr_db_(const double *a, const double *b, size_t n)
{
	double peak = 0;
	for (size_t k = 0; k < n; k++) peak = fmax(peak, b[k]);
	return 20 * log10(peak * sqrt((double)n) / difference(a, b, n));
}
