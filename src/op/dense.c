/* SPDX-License-Identifier: BSD-3-Clause */
/* Operators made of dense matrices in memory: the matrix itself, and the product of two thin ones. */
#include "math/dense.h"
#include "op/op_impl.h"

typedef struct {
	optla_ctx *ctx;
	optla_cblock a;
	void *copy; /* NULL when a is borrowed */
} dense_op;

static optla_status dense_apply(void *user, optla_trans trans, optla_cblock x, optla_block y)
{
	const dense_op *d = user;
	return optla_dense_apply_(d->ctx, trans, d->a, x, y);
}

static void dense_destroy(void *user)
{
	dense_op *d = user;
	optla_free(d->ctx, d->copy);
	optla_free(d->ctx, d);
}

optla_status optla_op_dense(optla_ctx *ctx, optla_cblock a, bool copy, optla_op **out)
{
	*out = NULL;
	OPTLA_TRY(optla_block_check_(ctx, "the matrix", a));
	dense_op *d = optla_calloc_(ctx, 1, sizeof *d);
	if (!d) return OPTLA_ERR_NOMEM;
	d->ctx = ctx;
	d->a = a;
	if (copy) {
		const optla_block own = optla_block_copy_(ctx, a);
		d->copy = own.data;
		d->a = optla_block_const(own);
		if (!own.data) {
			dense_destroy(d);
			return OPTLA_ERR_NOMEM;
		}
	}
	const optla_op_desc desc = {.size = sizeof desc,
	                            .name = "dense",
	                            .nrows = a.nrows,
	                            .ncols = a.ncols,
	                            .type = a.type,
	                            .user = d,
	                            .apply = dense_apply,
	                            .destroy = dense_destroy};
	return optla_op_create(ctx, out, &desc);
}

typedef struct {
	optla_ctx *ctx;
	optla_block left, right;
} lowrank_op;

/* L (Rᵀ x) or R (Lᵀ x) */
static optla_status lowrank_apply(void *user, optla_trans trans, optla_cblock x, optla_block y)
{
	const lowrank_op *l = user;
	const optla_cblock first = optla_block_const(trans == OPTLA_FORWARD ? l->right : l->left);
	const optla_cblock second = optla_block_const(trans == OPTLA_FORWARD ? l->left : l->right);
	optla_block t = optla_block_new_(l->ctx, first.ncols, x.ncols, x.type);
	if (!t.data) return OPTLA_ERR_NOMEM;
	optla_status status = optla_dense_apply_(l->ctx, OPTLA_TRANSPOSE, first, x, t);
	if (OPTLA_OK == status) status = optla_dense_apply_(l->ctx, OPTLA_FORWARD, second, optla_block_const(t), y);
	optla_free(l->ctx, t.data);
	return status;
}

static void lowrank_destroy(void *user)
{
	lowrank_op *l = user;
	optla_free(l->ctx, l->left.data);
	optla_free(l->ctx, l->right.data);
	optla_free(l->ctx, l);
}

optla_status optla_op_lowrank(optla_ctx *ctx, optla_cblock left, optla_cblock right, optla_op **out)
{
	*out = NULL;
	OPTLA_TRY(optla_block_check_(ctx, "the left factor", left));
	OPTLA_TRY(optla_block_check_(ctx, "the right factor", right));
	OPTLA_CHECK(ctx, left.ncols == right.ncols && left.type == right.type, OPTLA_ERR_SHAPE,
	            "left factor %zu x %zu (%s) and right factor %zu x %zu (%s) must have the same number of columns and type",
	            left.nrows, left.ncols, optla_scalar_name_(left.type), right.nrows, right.ncols, optla_scalar_name_(right.type));
	lowrank_op *l = optla_calloc_(ctx, 1, sizeof *l);
	if (!l) return OPTLA_ERR_NOMEM;
	l->ctx = ctx;
	l->left = optla_block_copy_(ctx, left);
	l->right = optla_block_copy_(ctx, right);
	if (!l->left.data || !l->right.data) {
		lowrank_destroy(l);
		return OPTLA_ERR_NOMEM;
	}
	const optla_op_desc desc = {.size = sizeof desc,
	                            .name = "low rank",
	                            .nrows = left.nrows,
	                            .ncols = right.nrows,
	                            .type = left.type,
	                            .user = l,
	                            .apply = lowrank_apply,
	                            .destroy = lowrank_destroy};
	return optla_op_create(ctx, out, &desc);
}
