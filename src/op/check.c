/* SPDX-License-Identifier: BSD-3-Clause */
/* Oracles for any operator: is it linear, is its adjoint the adjoint, and what matrix is it? */
#include "base/random.h"
#include "math/dense.h"
#include "op/op_impl.h"

#include <math.h>
#include <string.h>

/* Entry of a block as a complex number. */
typedef struct {
	double re, im;
} number;

static number get(optla_cblock b, size_t i, size_t j)
{
	const size_t parts = optla_is_complex_(b.type) ? 2 : 1, k = parts * (j * b.ld + i);
	const float *f = b.data;
	const double *d = b.data;
	const bool single = optla_is_single_(b.type);
	const number n = {single ? (double)f[k] : d[k], parts < 2 ? 0 : single ? (double)f[k + 1] : d[k + 1]};
	return n;
}

static void put(optla_block b, size_t i, size_t j, number v)
{
	const size_t parts = optla_is_complex_(b.type) ? 2 : 1, k = parts * (j * b.ld + i);
	if (optla_is_single_(b.type)) {
		((float *)b.data)[k] = (float)v.re;
		if (parts > 1) ((float *)b.data)[k + 1] = (float)v.im;
	} else {
		((double *)b.data)[k] = v.re;
		if (parts > 1) ((double *)b.data)[k + 1] = v.im;
	}
}

/* Standard normal numbers, or uniform in [0, 1) for light. */
static void fill_random(optla_block b, uint64_t seed, uint64_t stream, bool light)
{
	const optla_rand r = {.seed = seed, .stream_hi = OPTLA_RAND_CHECK};
	for (size_t j = 0; j < b.ncols; j++)
		for (size_t i = 0; i < b.nrows; i++) {
			const uint64_t at = (stream << 40) + j * b.nrows + i;
			number v = {0, 0};
			v.re = light ? optla_rand_u01_(r, at, 0, 0) : optla_rand_normal_(r, at, 0, 0);
			if (optla_is_complex_(b.type)) v.im = optla_rand_normal_(r, at, 1, 0);
			put(b, i, j, v);
		}
}

/* <a, b> = sum conj(a) b */
static number inner(optla_cblock a, optla_cblock b)
{
	number s = {0, 0};
	for (size_t i = 0; i < a.nrows; i++) {
		const number p = get(a, i, 0), q = get(b, i, 0);
		s.re += p.re * q.re + p.im * q.im;
		s.im += p.re * q.im - p.im * q.re;
	}
	return s;
}

static double norm(optla_block b) { return optla_norm_fro_(optla_block_const(b)); }

optla_status optla_op_check_adjoint(optla_op *op, uint64_t seed, double *rel)
{
	optla_ctx *ctx = optla_op_ctx(op);
	const size_t m = optla_op_nrows(op), n = optla_op_ncols(op);
	const optla_scalar type = optla_op_type(op);
	const bool light = optla_op_flags(op) & OPTLA_OP_NONNEGATIVE;
	optla_block x = optla_block_new_(ctx, n, 1, type), z = optla_block_new_(ctx, n, 1, type);
	optla_block y = optla_block_new_(ctx, m, 1, type), w = optla_block_new_(ctx, m, 1, type);
	optla_status status = OPTLA_ERR_NOMEM;
	*rel = 0;
	if (x.data && z.data && y.data && w.data) {
		fill_random(x, seed, 0, light);
		fill_random(y, seed, 1, light);
		status = optla_op_apply(op, OPTLA_FORWARD, optla_block_const(x), w);
		if (OPTLA_OK == status) status = optla_op_apply(op, OPTLA_CONJ_TRANSPOSE, optla_block_const(y), z);
	}
	if (OPTLA_OK == status) {
		const number a = inner(optla_block_const(y), optla_block_const(w)), b = inner(optla_block_const(z), optla_block_const(x));
		const double scale = fmax(norm(y) * norm(w), norm(z) * norm(x));
		*rel = scale > 0 ? hypot(a.re - b.re, a.im - b.im) / scale : 0;
	}
	optla_free(ctx, x.data);
	optla_free(ctx, y.data);
	optla_free(ctx, z.data);
	optla_free(ctx, w.data);
	return status;
}

/* Column 2 of b = factors a[0], a[1] times columns 0, 1. */
static void combine(optla_block b, const double a[2])
{
	for (size_t i = 0; i < b.nrows; i++) {
		const number p = get(optla_block_const(b), i, 0), q = get(optla_block_const(b), i, 1);
		put(b, i, 2, (number){a[0] * p.re + a[1] * q.re, a[0] * p.im + a[1] * q.im});
	}
}

optla_status optla_op_check_linear(optla_op *op, uint64_t seed, double *rel)
{
	optla_ctx *ctx = optla_op_ctx(op);
	const bool light = optla_op_flags(op) & OPTLA_OP_NONNEGATIVE;
	const optla_rand r = {.seed = seed, .stream_hi = OPTLA_RAND_CHECK};
	const double u = optla_rand_u01_(r, UINT64_C(3) << 40, 0, 0), v = optla_rand_u01_(r, UINT64_C(3) << 40, 1, 0);
	const double a[2] = {0.5 + u, light ? 0.5 + v : -0.5 - v};
	optla_block x = optla_block_new_(ctx, optla_op_ncols(op), 3, optla_op_type(op));
	optla_block y = optla_block_new_(ctx, optla_op_nrows(op), 3, optla_op_type(op));
	optla_status status = OPTLA_ERR_NOMEM;
	*rel = 0;
	if (x.data && y.data) {
		fill_random(optla_columns_mut_(x, 0, 2), seed, 2, light);
		combine(x, a);
		status = optla_op_apply(op, OPTLA_FORWARD, optla_block_const(x), y);
	}
	if (OPTLA_OK == status) {
		double error = 0;
		for (size_t i = 0; i < y.nrows; i++) {
			const optla_cblock c = optla_block_const(y);
			const number p = get(c, i, 0), q = get(c, i, 1), s = get(c, i, 2);
			error = hypot(error, hypot(s.re - a[0] * p.re - a[1] * q.re, s.im - a[0] * p.im - a[1] * q.im));
		}
		const double scale = a[0] * norm(optla_columns_mut_(y, 0, 1)) + fabs(a[1]) * norm(optla_columns_mut_(y, 1, 1));
		*rel = scale > 0 ? error / scale : error;
	}
	optla_free(ctx, x.data);
	optla_free(ctx, y.data);
	return status;
}

optla_status optla_op_to_dense(optla_op *op, optla_block out)
{
	enum { WIDTH = 64 };
	optla_ctx *ctx = optla_op_ctx(op);
	const size_t m = optla_op_nrows(op), n = optla_op_ncols(op), width = optla_min_(WIDTH, n);
	const optla_scalar type = optla_op_type(op);
	OPTLA_TRY(optla_block_check_(ctx, "the matrix to be filled", optla_block_const(out)));
	OPTLA_CHECK(ctx, out.nrows == m && out.ncols == n && out.type == type, OPTLA_ERR_SHAPE,
	            "operator '%s' is %zu x %zu %s: cannot fill %zu x %zu %s", optla_op_name(op), m, n, optla_scalar_name_(type),
	            out.nrows, out.ncols, optla_scalar_name_(out.type));
	optla_block units = optla_block_new_(ctx, n, width, type);
	if (!units.data) return OPTLA_ERR_NOMEM;
	optla_status status = OPTLA_OK;
	for (size_t j = 0; OPTLA_OK == status && j < n; j += width) {
		const size_t count = optla_min_(width, n - j);
		memset(units.data, 0, n * count * optla_scalar_bytes(type));
		for (size_t k = 0; k < count; k++) put(units, j + k, k, (number){1, 0});
		status = optla_op_apply(op, OPTLA_FORWARD, optla_columns_(optla_block_const(units), 0, count),
		                        optla_columns_mut_(out, j, count));
	}
	optla_free(ctx, units.data);
	return status;
}
