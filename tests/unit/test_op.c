/* SPDX-License-Identifier: BSD-3-Clause */
/* Operators: every kind against its definition. */
#include "base/random.h"
#include "math/dense.h"
#include "near.h"
#include "optla/op.h"

static optla_block random_block(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, uint64_t seed)
{
	const optla_rand r = {.seed = seed, .stream_hi = OPTLA_RAND_TEST};
	const size_t parts = type >= OPTLA_C32 ? 2 : 1;
	optla_block b = optla_block_(optla_array_(ctx, m * n, optla_scalar_bytes(type)), m, n, type);
	ck_assert_ptr_nonnull(b.data);
	for (size_t k = 0; k < m * n * parts; k++) {
		const double v = optla_rand_normal_(r, k, 0, 0);
		if (type == OPTLA_F32 || type == OPTLA_C32)
			((float *)b.data)[k] = (float)v;
		else
			((double *)b.data)[k] = v;
	}
	return b;
}

START_TEST(dense_passes_adjoint_and_linear)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	for (int type = OPTLA_F32; type <= OPTLA_C64; type++) {
		optla_block a = random_block(ctx, 1000, 77, (optla_scalar)type, 1);
		optla_op *op;
		double rel;
		ok(optla_op_dense(ctx, optla_block_const(a), true, &op));
		ok(optla_op_check_adjoint(op, 1, &rel));
		const double tol = type == OPTLA_F32 || type == OPTLA_C32 ? 1e-6 : 1e-12;
		near_abs(rel, 0, tol);
		ok(optla_op_check_linear(op, 1, &rel));
		near_abs(rel, 0, tol);
		optla_op_unref(&op);
		optla_free(ctx, a.data);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("op");
	TCase *t = tcase_create("kinds");
	tcase_add_test(t, dense_passes_adjoint_and_linear);
	suite_add_tcase(s, t);
	return run_suite(s);
}
