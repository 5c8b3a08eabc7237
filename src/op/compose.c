/* SPDX-License-Identifier: BSD-3-Clause */
/* Operators made of operators: product and adjoint. */
#include "math/dense.h"
#include "op/op_impl.h"

#include <math.h>

typedef struct {
	optla_op *a, *b;
	double
	    gain; /* ||outer y|| / ||inner y|| of the last product: how much the outer operator passes on of the inner one's error */
	bool forward;
} product_op;

static optla_status product_apply(void *user, optla_trans trans, optla_cblock x, optla_block y)
{
	product_op *p = user;
	optla_ctx *ctx = optla_op_ctx(p->a);
	p->forward = trans == OPTLA_FORWARD;
	optla_op *inner = p->forward ? p->b : p->a, *outer = p->forward ? p->a : p->b;
	optla_block t = optla_block_new_(ctx, optla_op_ncols(p->a), x.ncols, x.type);
	if (!t.data) return OPTLA_ERR_NOMEM;
	optla_status status = optla_op_apply(inner, trans, x, t);
	if (OPTLA_OK == status) status = optla_op_apply(outer, trans, optla_block_const(t), y);
	if (OPTLA_OK == status) {
		const size_t last = x.ncols - 1;
		const double in = optla_norm_fro_(optla_columns_(optla_block_const(t), last, 1));
		p->gain = in > 0 ? optla_norm_fro_(optla_columns_(optla_block_const(y), last, 1)) / in : 0;
	}
	optla_free(ctx, t.data);
	return status;
}

/* The errors of both are independent; that of the inner one passes through the outer one. */
static double product_noise(void *user)
{
	const product_op *p = user;
	return hypot(optla_op_noise(p->forward ? p->a : p->b), p->gain * optla_op_noise(p->forward ? p->b : p->a));
}

static void product_destroy(void *user)
{
	product_op *p = user;
	optla_free(optla_op_ctx(p->a), p);
}

optla_status optla_op_product(optla_op *a, optla_op *b, optla_op **out)
{
	*out = NULL;
	optla_ctx *ctx = optla_op_ctx(a);
	OPTLA_CHECK(ctx, optla_op_ncols(a) == optla_op_nrows(b) && optla_op_type(a) == optla_op_type(b), OPTLA_ERR_SHAPE,
	            "no product of '%s', %zu x %zu %s, with '%s', %zu x %zu %s", optla_op_name(a), optla_op_nrows(a),
	            optla_op_ncols(a), optla_scalar_name_(optla_op_type(a)), optla_op_name(b), optla_op_nrows(b), optla_op_ncols(b),
	            optla_scalar_name_(optla_op_type(b)));
	product_op *p = optla_calloc_(ctx, 1, sizeof *p);
	if (!p) return OPTLA_ERR_NOMEM;
	p->a = a;
	p->b = b;
	const optla_op_desc desc = {.size = sizeof desc,
	                            .name = "product",
	                            .nrows = optla_op_nrows(a),
	                            .ncols = optla_op_ncols(b),
	                            .type = optla_op_type(a),
	                            .frequency_hz = fmax(optla_op_frequency_hz(a), optla_op_frequency_hz(b)),
	                            .flags = (optla_op_flags(a) | optla_op_flags(b)) & ~(unsigned)OPTLA_OP_SYMMETRIC,
	                            .user = p,
	                            .apply = product_apply,
	                            .noise = product_noise,
	                            .destroy = product_destroy,
	                            .parts = (optla_op *const[]){a, b},
	                            .nparts = 2};
	return optla_op_create(ctx, out, &desc);
}

/* (Tᴴ) x, and (Tᴴ)ᵀ x = conj(T conj(x)). */
static optla_status conj_forward(optla_op *a, optla_cblock x, optla_block y)
{
	optla_ctx *ctx = optla_op_ctx(a);
	optla_block conj = optla_block_new_(ctx, x.nrows, x.ncols, x.type);
	if (!conj.data) return OPTLA_ERR_NOMEM;
	optla_block_conj_(x, conj);
	const optla_status status = optla_op_apply(a, OPTLA_FORWARD, optla_block_const(conj), y);
	if (OPTLA_OK == status) optla_block_conj_(optla_block_const(y), y);
	optla_free(ctx, conj.data);
	return status;
}

static optla_status adjoint_apply(void *user, optla_trans trans, optla_cblock x, optla_block y)
{
	optla_op *a = user;
	if (trans == OPTLA_FORWARD) return optla_op_apply(a, OPTLA_CONJ_TRANSPOSE, x, y);
	return optla_is_complex_(x.type) ? conj_forward(a, x, y) : optla_op_apply(a, OPTLA_FORWARD, x, y);
}

static optla_status adjoint_expose(void *user, optla_trans trans, optla_cblock x, const double *full_power, optla_block y)
{
	return optla_op_expose(user, trans == OPTLA_FORWARD ? OPTLA_TRANSPOSE : OPTLA_FORWARD, x, full_power, y);
}

static uint64_t adjoint_price(void *user, optla_trans trans)
{
	return optla_op_price(user, trans == OPTLA_FORWARD ? OPTLA_TRANSPOSE : OPTLA_FORWARD);
}

optla_status optla_op_adjoint(optla_op *a, optla_op **out)
{
	*out = NULL;
	OPTLA_CHECK(optla_op_ctx(a), !(optla_op_flags(a) & OPTLA_OP_NO_TRANSPOSE), OPTLA_ERR_UNSUPPORTED,
	            "operator '%s' has no transpose, so no adjoint", optla_op_name(a));
	const bool powered = optla_op_desc_(a)->expose;
	const optla_op_desc desc = {.size = sizeof desc,
	                            .name = "adjoint",
	                            .nrows = optla_op_ncols(a),
	                            .ncols = optla_op_nrows(a),
	                            .type = optla_op_type(a),
	                            .frequency_hz = optla_op_frequency_hz(a),
	                            .flags = optla_op_flags(a),
	                            .user = a,
	                            .apply = powered ? NULL : adjoint_apply,
	                            .expose = powered ? adjoint_expose : NULL,
	                            .price = adjoint_price,
	                            .parts = &a,
	                            .nparts = 1};
	return optla_op_create(optla_op_ctx(a), out, &desc);
}
