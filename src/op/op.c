/* SPDX-License-Identifier: BSD-3-Clause */
/* The operator: life, checks, products, costs. Whatever a kind of operator may rely on is checked here, once. */
#include "op/op_impl.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

struct optla_op {
	optla_ctx *ctx;
	optla_op_desc desc;
	atomic_size_t references;
	char *name;
	optla_op **parts;
	double *power; /* full power of each column, for apply made of expose */
	size_t npower;
	bool visited; /* mark of a walk over the graph of parts */
	optla_op_cost cost;
};

static optla_status check_desc(optla_ctx *ctx, const optla_op_desc *d)
{
	OPTLA_CHECK(ctx, d->size == sizeof *d, OPTLA_ERR_ARG, "optla_op_desc.size is %zu, not %zu", d->size, sizeof *d);
	OPTLA_CHECK(ctx, !d->apply != !d->expose, OPTLA_ERR_ARG, "operator '%s' must have either apply or expose",
	            d->name ? d->name : "unnamed");
	OPTLA_CHECK(ctx, optla_scalar_bytes(d->type), OPTLA_ERR_ARG, "scalar type %d is none of f32, f64, c32, c64", (int)d->type);
	OPTLA_CHECK(ctx, !(d->flags & OPTLA_OP_NONNEGATIVE) || !optla_is_complex_(d->type), OPTLA_ERR_ARG,
	            "an operator that takes light only can't be of type %s", optla_scalar_name_(d->type));
	OPTLA_CHECK(ctx, !(d->flags & OPTLA_OP_SYMMETRIC) || d->nrows == d->ncols, OPTLA_ERR_ARG,
	            "a symmetric operator can't be %zu x %zu", d->nrows, d->ncols);
	OPTLA_CHECK(ctx, isfinite(d->frequency_hz) && d->frequency_hz >= 0, OPTLA_ERR_ARG,
	            "modulation frequency %g Hz; it must be >= 0", d->frequency_hz);
	for (size_t k = 0; k < d->nparts; k++)
		OPTLA_CHECK(ctx, d->parts && d->parts[k], OPTLA_ERR_ARG, "part %zu of the operator is NULL", k);
	return OPTLA_OK;
}

static void free_op(optla_op *op)
{
	optla_ctx *ctx = op->ctx;
	optla_free(ctx, op->power);
	optla_free(ctx, op->parts);
	optla_free(ctx, op->name);
	optla_free(ctx, op);
}

static optla_status make(optla_ctx *ctx, const optla_op_desc *d, optla_op **out)
{
	OPTLA_TRY(check_desc(ctx, d));
	optla_op *op = optla_calloc_(ctx, 1, sizeof *op);
	if (!op) return OPTLA_ERR_NOMEM;
	op->ctx = ctx;
	op->name = optla_strdup_(ctx, d->name ? d->name : "unnamed");
	op->parts = optla_array_(ctx, d->nparts, sizeof *op->parts);
	if (!op->name || !op->parts) {
		free_op(op);
		return OPTLA_ERR_NOMEM;
	}
	op->desc = *d;
	op->desc.name = op->name;
	op->desc.parts = op->parts;
	for (size_t k = 0; k < d->nparts; k++) op->parts[k] = optla_op_ref(d->parts[k]);
	atomic_init(&op->references, 1);
	*out = op;
	return OPTLA_OK;
}

optla_status optla_op_create(optla_ctx *ctx, optla_op **out, const optla_op_desc *desc)
{
	*out = NULL;
	const optla_status status = make(ctx, desc, out);
	if (OPTLA_OK != status && desc->destroy) desc->destroy(desc->user);
	return status;
}

optla_op *optla_op_ref(optla_op *op)
{
	if (op) atomic_fetch_add(&op->references, 1);
	return op;
}

void optla_op_unref(optla_op **op)
{
	if (!op || !*op) return;
	optla_op *o = *op;
	*op = NULL;
	if (atomic_fetch_sub(&o->references, 1) > 1) return;
	if (o->desc.destroy) o->desc.destroy(o->desc.user);
	for (size_t k = 0; k < o->desc.nparts; k++) optla_op_unref(&o->parts[k]);
	free_op(o);
}

optla_ctx *optla_op_ctx(const optla_op *op) { return op->ctx; }
const char *optla_op_name(const optla_op *op) { return op->name; }
size_t optla_op_nrows(const optla_op *op) { return op->desc.nrows; }
size_t optla_op_ncols(const optla_op *op) { return op->desc.ncols; }
optla_scalar optla_op_type(const optla_op *op) { return op->desc.type; }
unsigned optla_op_flags(const optla_op *op) { return op->desc.flags; }
double optla_op_frequency_hz(const optla_op *op) { return op->desc.frequency_hz; }
const optla_op_desc *optla_op_desc_(const optla_op *op) { return &op->desc; }

/* ---- products ---- */

static size_t span_bytes(optla_cblock b)
{
	return b.nrows && b.ncols ? ((b.ncols - 1) * b.ld + b.nrows) * optla_scalar_bytes(b.type) : 0;
}

static bool overlap(optla_cblock x, optla_cblock y)
{
	const uintptr_t a = (uintptr_t)x.data, b = (uintptr_t)y.data;
	return span_bytes(x) && span_bytes(y) && a < b + span_bytes(y) && b < a + span_bytes(x);
}

static optla_status check_shapes(const optla_op *op, optla_trans trans, optla_cblock x, optla_cblock y)
{
	const optla_op_desc *d = &op->desc;
	OPTLA_CHECK(op->ctx, trans == OPTLA_FORWARD || trans == OPTLA_TRANSPOSE || trans == OPTLA_CONJ_TRANSPOSE, OPTLA_ERR_ARG,
	            "%d is none of forward, transpose, conjugate transpose", (int)trans);
	OPTLA_TRY(optla_block_check_(op->ctx, "x", x));
	OPTLA_TRY(optla_block_check_(op->ctx, "y", y));
	OPTLA_CHECK(op->ctx, x.type == d->type && y.type == d->type, OPTLA_ERR_SHAPE, "operator '%s' is %s: cannot map %s to %s",
	            op->name, optla_scalar_name_(d->type), optla_scalar_name_(x.type), optla_scalar_name_(y.type));
	const size_t in = trans == OPTLA_FORWARD ? d->ncols : d->nrows, out = trans == OPTLA_FORWARD ? d->nrows : d->ncols;
	OPTLA_CHECK(op->ctx, x.nrows == in && y.nrows == out && x.ncols == y.ncols, OPTLA_ERR_SHAPE,
	            "operator '%s' is %zu x %zu: %s cannot map %zu x %zu to %zu x %zu", op->name, d->nrows, d->ncols,
	            trans == OPTLA_FORWARD ? "it" : "its transpose", x.nrows, x.ncols, y.nrows, y.ncols);
	OPTLA_CHECK(op->ctx, trans == OPTLA_FORWARD || !(d->flags & OPTLA_OP_NO_TRANSPOSE), OPTLA_ERR_UNSUPPORTED,
	            "operator '%s' has no transpose: its camera and projector can't change places", op->name);
	OPTLA_CHECK(op->ctx, !overlap(x, y), OPTLA_ERR_ARG, "x and y of operator '%s' overlap", op->name);
	return OPTLA_OK;
}

static optla_status check_light(const optla_op *op, optla_cblock x)
{
	if (!(op->desc.flags & OPTLA_OP_NONNEGATIVE)) return OPTLA_OK;
	for (size_t j = 0; j < x.ncols; j++) {
		const char *column = (const char *)x.data + j * x.ld * optla_scalar_bytes(x.type);
		const size_t i = optla_first_negative_(column, x.nrows, x.type == OPTLA_F32);
		OPTLA_CHECK(
		    op->ctx, i == x.nrows, OPTLA_ERR_ARG,
		    "operator '%s' takes light only: x is negative at row %zu, column %zu (optla_op_signed() splits signed patterns)",
		    op->name, i, j);
	}
	return OPTLA_OK;
}

static double largest(optla_cblock x, size_t j)
{
	double m = 0;
	for (size_t i = 0; i < x.nrows; i++) {
		const double v =
		    x.type == OPTLA_F32 ? (double)((const float *)x.data)[j * x.ld + i] : ((const double *)x.data)[j * x.ld + i];
		if (v > m) m = v;
	}
	return m;
}

/* Full power of each column as the caller wants it, or the brightest entry of the column. */
static optla_status choose_power(optla_op *op, optla_cblock x, const double **full_power)
{
	if (*full_power) {
		for (size_t j = 0; j < x.ncols; j++) {
			const double p = (*full_power)[j], m = largest(x, j);
			OPTLA_CHECK(op->ctx, isfinite(p) && p > 0 && p >= m, OPTLA_ERR_ARG,
			            "full power %g of column %zu must be positive and at least its largest entry, %g", p, j, m);
		}
		return OPTLA_OK;
	}
	if (op->npower < x.ncols) {
		optla_free(op->ctx, op->power);
		op->npower = 0;
		op->power = optla_array_(op->ctx, x.ncols, sizeof *op->power);
		if (!op->power) return OPTLA_ERR_NOMEM;
		op->npower = x.ncols;
	}
	for (size_t j = 0; j < x.ncols; j++) {
		const double m = largest(x, j);
		op->power[j] = m > 0 ? m : 1;
	}
	*full_power = op->power;
	return OPTLA_OK;
}

static optla_status call(optla_op *op, optla_trans trans, optla_cblock x, const double *full_power, optla_block y)
{
	if (!op->desc.expose) return op->desc.apply(op->desc.user, trans, x, y);
	OPTLA_TRY(choose_power(op, x, &full_power));
	return op->desc.expose(op->desc.user, trans, x, full_power, y);
}

/* Tᴴ x = conj(Tᵀ conj(x)) */
static optla_status call_adjoint(optla_op *op, optla_cblock x, optla_block y)
{
	optla_block conj = optla_block_new_(op->ctx, x.nrows, x.ncols, x.type);
	if (!conj.data) return OPTLA_ERR_NOMEM;
	optla_block_conj_(x, conj);
	const optla_status status = call(op, OPTLA_TRANSPOSE, optla_block_const(conj), NULL, y);
	if (OPTLA_OK == status) optla_block_conj_(optla_block_const(y), y);
	optla_free(op->ctx, conj.data);
	return status;
}

static optla_status product(optla_op *op, optla_trans trans, optla_cblock x, const double *full_power, optla_block y)
{
	OPTLA_TRY(check_shapes(op, trans, x, optla_block_const(y)));
	OPTLA_TRY(optla_block_check_finite_(op->ctx, "x", x));
	OPTLA_TRY(check_light(op, x));
	OPTLA_TRY(optla_check_cancel_(op->ctx));
	if (!x.ncols) return OPTLA_OK;
	const double start_s = optla_now_s_();
	const bool is_complex = optla_is_complex_(x.type);
	if (trans == OPTLA_CONJ_TRANSPOSE && !is_complex) trans = OPTLA_TRANSPOSE;
	const optla_status status = trans == OPTLA_CONJ_TRANSPOSE ? call_adjoint(op, x, y) : call(op, trans, x, full_power, y);
	op->cost.seconds += optla_now_s_() - start_s;
	if (OPTLA_OK != status) return status;
	op->cost.applies++;
	*(trans == OPTLA_FORWARD ? &op->cost.forward_columns : &op->cost.transpose_columns) += x.ncols;
	return OPTLA_OK;
}

optla_status optla_op_apply(optla_op *op, optla_trans trans, optla_cblock x, optla_block y)
{
	return product(op, trans, x, NULL, y);
}

optla_status optla_op_expose(optla_op *op, optla_trans trans, optla_cblock x, const double *full_power, optla_block y)
{
	return product(op, trans, x, full_power, y);
}

/* ---- costs ---- */

/* Adds photos and exposure of op and its parts, each one once however often it is used. */
static void add_cost(optla_op *op, optla_op_cost *total)
{
	if (op->visited) return;
	op->visited = true;
	if (op->desc.cost)
		op->desc.cost(op->desc.user, total);
	else if (!op->desc.nparts)
		total->photos += op->cost.forward_columns + op->cost.transpose_columns;
	for (size_t k = 0; k < op->desc.nparts; k++) add_cost(op->parts[k], total);
}

static void clear_marks(optla_op *op)
{
	if (!op->visited) return;
	op->visited = false;
	for (size_t k = 0; k < op->desc.nparts; k++) clear_marks(op->parts[k]);
}

optla_op_cost optla_op_cost_so_far(optla_op *op)
{
	optla_op_cost cost = op->cost;
	add_cost(op, &cost);
	clear_marks(op);
	return cost;
}

uint64_t optla_op_price(const optla_op *op, optla_trans trans)
{
	if (op->desc.price) return op->desc.price(op->desc.user, trans);
	uint64_t sum = op->desc.nparts ? 0 : 1;
	for (size_t k = 0; k < op->desc.nparts; k++) sum += optla_op_price(op->parts[k], trans);
	return sum;
}

double optla_op_noise(optla_op *op)
{
	if (op->desc.noise) return op->desc.noise(op->desc.user);
	return op->desc.nparts == 1 ? optla_op_noise(op->parts[0]) : 0;
}
