/* SPDX-License-Identifier: BSD-3-Clause */
/* An operator that trusts nobody: everything goes on to another one whose answers are checked. For new devices and for tests. */
#include "math/dense.h"
#include "op/op_impl.h"

#include <math.h>
#include <string.h>

typedef struct {
	optla_op *a;
	optla_block before; /* x as it was */
	size_t capacity;    /* columns */
} checked_op;

static const char *column(optla_cblock b, size_t j) { return (const char *)b.data + j * b.ld * optla_scalar_bytes(b.type); }

static void fill_nan(optla_block y)
{
	const size_t n = y.nrows * (optla_is_complex_(y.type) ? 2 : 1);
	for (size_t j = 0; j < y.ncols; j++) {
		char *c = (char *)y.data + j * y.ld * optla_scalar_bytes(y.type);
		for (size_t i = 0; i < n; i++)
			if (optla_is_single_(y.type))
				((float *)(void *)c)[i] = NAN;
			else
				((double *)(void *)c)[i] = NAN;
	}
}

static optla_status check_input_kept(const checked_op *c, optla_cblock before, optla_cblock x)
{
	const size_t bytes = optla_scalar_bytes(x.type);
	for (size_t j = 0; j < x.ncols; j++) {
		const char *was = column(before, j), *is = column(x, j);
		if (!x.nrows || !memcmp(was, is, x.nrows * bytes)) continue;
		size_t i = 0;
		while (!memcmp(was + i * bytes, is + i * bytes, bytes)) i++;
		return OPTLA_FAIL(optla_op_ctx(c->a), OPTLA_ERR_DEVICE, "operator '%s' changed its input x at row %zu, column %zu",
		                  optla_op_name(c->a), i, j);
	}
	return OPTLA_OK;
}

static optla_status check_output(const checked_op *c, optla_cblock y)
{
	optla_ctx *ctx = optla_op_ctx(c->a);
	const size_t parts = optla_is_complex_(y.type) ? 2 : 1, n = y.nrows * parts;
	const bool single = optla_is_single_(y.type);
	/* noise around zero is honest; light without noise is not negative */
	const bool light = (optla_op_flags(c->a) & (OPTLA_OP_NONNEGATIVE | OPTLA_OP_STOCHASTIC)) == OPTLA_OP_NONNEGATIVE;
	for (size_t j = 0; j < y.ncols; j++) {
		size_t i = optla_first_not_finite_(column(y, j), n, single);
		OPTLA_CHECK(ctx, i == n, OPTLA_ERR_DEVICE, "operator '%s' left y at row %zu, column %zu unset or not finite",
		            optla_op_name(c->a), i / parts, j);
		if (!light) continue;
		i = optla_first_negative_(column(y, j), n, single);
		OPTLA_CHECK(ctx, i == n, OPTLA_ERR_DEVICE, "operator '%s' answered negative light, y = %g at row %zu, column %zu",
		            optla_op_name(c->a), optla_get_(y, i, j), i, j);
	}
	return OPTLA_OK;
}

static optla_status copy_input(checked_op *c, optla_cblock x, optla_cblock *before)
{
	const size_t rows = optla_max_(optla_op_nrows(c->a), optla_op_ncols(c->a)), bytes = optla_scalar_bytes(x.type);
	if (c->capacity < x.ncols) {
		optla_free(optla_op_ctx(c->a), c->before.data);
		c->capacity = 0;
		c->before = optla_block_new_(optla_op_ctx(c->a), rows, x.ncols, x.type);
		if (!c->before.data) return OPTLA_ERR_NOMEM;
		c->capacity = x.ncols;
	}
	*before = optla_cblock_(c->before.data, x.nrows, x.ncols, x.type);
	for (size_t j = 0; x.nrows && j < x.ncols; j++)
		memcpy((char *)c->before.data + j * x.nrows * bytes, column(x, j), x.nrows * bytes);
	return OPTLA_OK;
}

static optla_status checked_expose(void *user, optla_trans trans, optla_cblock x, const double *full_power, optla_block y)
{
	checked_op *c = user;
	optla_cblock before;
	OPTLA_TRY(copy_input(c, x, &before));
	fill_nan(y);
	OPTLA_TRY(optla_op_expose(c->a, trans, x, full_power, y));
	OPTLA_TRY(check_input_kept(c, before, x));
	return check_output(c, optla_block_const(y));
}

static optla_status checked_apply(void *user, optla_trans trans, optla_cblock x, optla_block y)
{
	return checked_expose(user, trans, x, NULL, y);
}

static void checked_destroy(void *user)
{
	checked_op *c = user;
	optla_ctx *ctx = optla_op_ctx(c->a);
	optla_free(ctx, c->before.data);
	optla_free(ctx, c);
}

optla_status optla_op_checked(optla_op *a, optla_op **out)
{
	*out = NULL;
	optla_ctx *ctx = optla_op_ctx(a);
	checked_op *c = optla_calloc_(ctx, 1, sizeof *c);
	if (!c) return OPTLA_ERR_NOMEM;
	c->a = a;
	const bool powered = optla_op_desc_(a)->expose;
	const optla_op_desc desc = {.size = sizeof desc,
	                            .name = "checked",
	                            .nrows = optla_op_nrows(a),
	                            .ncols = optla_op_ncols(a),
	                            .type = optla_op_type(a),
	                            .frequency_hz = optla_op_frequency_hz(a),
	                            .flags = optla_op_flags(a),
	                            .user = c,
	                            .apply = powered ? NULL : checked_apply,
	                            .expose = powered ? checked_expose : NULL,
	                            .destroy = checked_destroy,
	                            .parts = &a,
	                            .nparts = 1};
	return optla_op_create(ctx, out, &desc);
}
