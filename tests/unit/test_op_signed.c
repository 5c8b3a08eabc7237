/* SPDX-License-Identifier: BSD-3-Clause */
/* Signed patterns from light: exactness, photos, ambient light, noise, and the choice between the two ways. */
#include "op_kinds.h"

enum { M = 300, N = 64 };

typedef struct {
	optla_ctx *ctx;
	optla_block t;
	test_light *light;
	optla_op *light_op, *op;
} rig;

static rig setup(optla_split split, double ambient, double read, double per_light)
{
	rig r = {.ctx = test_ctx(NULL, 2), .t = block_random(M, N, OPTLA_F64, 1, true)};
	r.light_op = test_light_op(r.ctx, block_random(M, N, OPTLA_F64, 1, true), &r.light);
	r.light->ambient = ambient;
	r.light->read = read;
	r.light->per_light = per_light;
	ok(optla_op_signed(r.light_op, split, &r.op));
	return r;
}

static void teardown(rig *r)
{
	optla_op_unref(&r->op);
	optla_op_unref(&r->light_op);
	free(r->t.data);
	optla_ctx_destroy(&r->ctx);
}

static uint64_t photos(const rig *r) { return optla_op_cost_so_far(r->op).photos; }

START_TEST(photos_are_counted_exactly)
{
	rig s = setup(OPTLA_SPLIT_SIGNED, 0.3, 0, 0), o = setup(OPTLA_SPLIT_OFFSET, 0.3, 0, 0);
	const optla_block x = block_random(N, 21, OPTLA_F64, 2, false), y = block_random(M, 21, OPTLA_F64, 3, false);
	const optla_block tx = block_new(M, 21, OPTLA_F64), ty = block_new(N, 21, OPTLA_F64);
	memset((double *)x.data + 4 * N, 0, N * sizeof(double)); /* a column of zeros costs photos like any other */
	for (int round = 1; round <= 2; round++) {
		ok(optla_op_apply(s.op, OPTLA_FORWARD, optla_block_const(x), tx));
		ck_assert_uint_eq(photos(&s), 2 * 21 * (uint64_t)(2 * round - 1));
		ok(optla_op_apply(s.op, OPTLA_TRANSPOSE, optla_block_const(y), ty));
		ck_assert_uint_eq(photos(&s), 2 * 21 * (uint64_t)(2 * round));
		ok(optla_op_apply(o.op, OPTLA_FORWARD, optla_block_const(x), tx));
		ck_assert_uint_eq(photos(&o), round == 1 ? 21 + 2 : 3 * 21 + 4);
		ok(optla_op_apply(o.op, OPTLA_TRANSPOSE, optla_block_const(y), ty));
		ck_assert_uint_eq(photos(&o), 21 * (uint64_t)(2 * round) + 4);
	}
	uint64_t by_sign, by_offset;
	optla_op_signed_counts(s.op, &by_sign, &by_offset);
	ck_assert_uint_eq(by_sign, 84);
	ck_assert_uint_eq(by_offset, 0);
	optla_op_signed_counts(o.op, &by_sign, &by_offset);
	ck_assert_uint_eq(by_sign, 0);
	ck_assert_uint_eq(by_offset, 84);
	optla_op_signed_counts(o.light_op, &by_sign, &by_offset);
	ck_assert_uint_eq(by_offset, 0);
	free(x.data);
	free(y.data);
	free(tx.data);
	free(ty.data);
	teardown(&s);
	teardown(&o);
}
END_TEST

/* Patterns at the edges: zero, constant negative, non-negative, non-positive, one entry, tiny, huge. */
START_TEST(edge_patterns_are_exact)
{
	rig r = setup((optla_split)_i, 0.7, 0, 0);
	const optla_block x = block_random(N, 7, OPTLA_F64, 2, false), y = block_new(M, 7, OPTLA_F64);
	for (size_t i = 0; i < N; i++) {
		const double v = optla_get_(optla_block_const(x), i, 0);
		block_put(x, i, 0, 0);
		block_put(x, i, 1, -2);
		block_put(x, i, 2, fabs(v));
		block_put(x, i, 3, -fabs(v));
		block_put(x, i, 4, i == 9 ? -1 : 0);
		block_put(x, i, 5, 1e-200 * v);
		block_put(x, i, 6, 1e200 * v);
	}
	const optla_block want = block_product(OPTLA_FORWARD, optla_block_const(r.t), optla_block_const(x));
	ok(optla_op_apply(r.op, OPTLA_FORWARD, optla_block_const(x), y));
	for (size_t j = 0; j < 7; j++) {
		/* rounding of the two photos that are subtracted: about N/2 + ambient light times max |p| each */
		double largest = 0, worst = 0;
		for (size_t i = 0; i < N; i++) largest = fmax(largest, fabs(creal(block_get(optla_block_const(x), i, j))));
		for (size_t i = 0; i < M; i++)
			worst = fmax(worst, cabs(block_get(optla_block_const(y), i, j) - block_get(optla_block_const(want), i, j)));
		ck_assert_msg(worst <= 4e-16 * N * fmax(largest, j ? 0 : 1), "pattern %zu: error %.3g of %.3g", j, worst, largest);
	}
	free(x.data);
	free(y.data);
	free(want.data);
	teardown(&r);
}
END_TEST

/* The stated noise is the noise: rms error over many products within 5 standard errors. A product's squared error is a sum of M
   terms; with P products the relative standard error of the mean square is sqrt(2 / (M P)) where errors are independent, but y(1)
   and y(0) are shared by all products of an operator, so each product gets an operator of its own. */
START_TEST(noise_is_as_stated)
{
	enum { PRODUCTS = 40 };
	double squares = 0, stated = 0;
	for (size_t k = 0; k < PRODUCTS; k++) {
		rig r = setup(_i ? OPTLA_SPLIT_OFFSET : OPTLA_SPLIT_SIGNED, 0.2, 0.05, 0.01);
		r.light->seed = k;
		const optla_block x = block_random(N, 1, OPTLA_F64, 100 + k, false), y = block_new(M, 1, OPTLA_F64);
		const optla_block want = block_product(OPTLA_FORWARD, optla_block_const(r.t), optla_block_const(x));
		ok(optla_op_apply(r.op, OPTLA_FORWARD, optla_block_const(x), y));
		for (size_t i = 0; i < M; i++)
			squares += pow(cabs(block_get(optla_block_const(y), i, 0) - block_get(optla_block_const(want), i, 0)), 2);
		stated += pow(optla_op_noise(r.op), 2);
		free(x.data);
		free(y.data);
		free(want.data);
		teardown(&r);
	}
	near_rel(squares, stated, 5 * sqrt(2.0 / (M * PRODUCTS)));
}
END_TEST

START_TEST(auto_takes_offset_when_exact)
{
	rig r = setup(OPTLA_SPLIT_AUTO, 0.2, 0, 0);
	const optla_block x = block_random(N, 12, OPTLA_F64, 2, false), y = block_new(M, 12, OPTLA_F64);
	ok(optla_op_apply(r.op, OPTLA_FORWARD, optla_block_const(x), y));
	ck_assert_uint_eq(photos(&r), 12 + 2);
	free(x.data);
	free(y.data);
	teardown(&r);
}
END_TEST

/* With read noise alone the variances are 2 max|p|² (signed) and m² + c² + (m - c)² (offset, m = max p - min p, c = -min p): offset is
   taken up to twice the former. For max p = 1 and -min p = c: 2 (1 + c + c²) <= 4, c <= 0.618. */
START_TEST(auto_follows_the_variances)
{
	static const struct {
		double lowest;
		bool offset;
	} cases[] = {{0, true}, {0.3, true}, {0.6, true}, {0.63, false}, {1, false}};
	rig r = setup(OPTLA_SPLIT_AUTO, 0.2, 0.05, 0);
	const optla_block x = block_new(N, 5, OPTLA_F64), y = block_new(M, 5, OPTLA_F64);
	for (size_t j = 0; j < 5; j++) {
		block_put(x, 0, j, 1);
		block_put(x, 1, j, -cases[j].lowest);
	}
	uint64_t sign_before = 0, offset_before = 0, by_sign, by_offset;
	for (size_t j = 0; j < 5; j++) {
		ok(optla_op_apply(r.op, OPTLA_FORWARD, optla_columns_(optla_block_const(x), j, 1), optla_columns_mut_(y, j, 1)));
		optla_op_signed_counts(r.op, &by_sign, &by_offset);
		ck_assert_uint_eq(by_offset - offset_before, cases[j].offset);
		ck_assert_uint_eq(by_sign - sign_before, !cases[j].offset);
		sign_before = by_sign;
		offset_before = by_offset;
	}
	/* as a block: the ways are mixed, the answers the same as far as the noise goes */
	ok(optla_op_apply(r.op, OPTLA_FORWARD, optla_block_const(x), y));
	optla_op_signed_counts(r.op, &by_sign, &by_offset);
	ck_assert_uint_eq(by_sign, 4);
	ck_assert_uint_eq(by_offset, 6);
	ck_assert_uint_eq(photos(&r), 2 * 4 + 6 + 2);
	free(x.data);
	free(y.data);
	teardown(&r);
}
END_TEST

/* Photon noise: the lifted pattern carries c N more light, all of it noisy. A single dark pixel on a bright pattern goes by offset,
   a random pattern by sign. */
START_TEST(auto_counts_photons)
{
	rig r = setup(OPTLA_SPLIT_AUTO, 0, 0.001, 1);
	const optla_block x = block_random(N, 2, OPTLA_F64, 2, false), y = block_new(M, 2, OPTLA_F64);
	for (size_t i = 0; i < N; i++) block_put(x, i, 0, i ? 1 : -0.01);
	uint64_t by_sign, by_offset;
	ok(optla_op_apply(r.op, OPTLA_FORWARD, optla_columns_(optla_block_const(x), 0, 1), optla_columns_mut_(y, 0, 1)));
	optla_op_signed_counts(r.op, &by_sign, &by_offset);
	ck_assert_uint_eq(by_offset, 1);
	ok(optla_op_apply(r.op, OPTLA_FORWARD, optla_columns_(optla_block_const(x), 1, 1), optla_columns_mut_(y, 1, 1)));
	optla_op_signed_counts(r.op, &by_sign, &by_offset);
	ck_assert_uint_eq(by_sign, 1);
	free(x.data);
	free(y.data);
	teardown(&r);
}
END_TEST

START_TEST(complex_patterns_are_not_split)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_block t;
	optla_op *a = make_dense(ctx, 3, 3, OPTLA_C32, &t), *op;
	status_is(optla_op_signed(a, OPTLA_SPLIT_SIGNED, &op), OPTLA_ERR_UNSUPPORTED);
	ck_assert_ptr_null(op);
	optla_op_unref(&a);
	free(t.data);
	optla_ctx_destroy(&ctx);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("op_signed");
	TCase *t = tcase_create("signed");
	tcase_add_test(t, photos_are_counted_exactly);
	tcase_add_loop_test(t, edge_patterns_are_exact, OPTLA_SPLIT_SIGNED, OPTLA_SPLIT_AUTO + 1);
	tcase_add_loop_test(t, noise_is_as_stated, 0, 2);
	tcase_add_test(t, auto_takes_offset_when_exact);
	tcase_add_test(t, auto_follows_the_variances);
	tcase_add_test(t, auto_counts_photons);
	tcase_add_test(t, complex_patterns_are_not_split);
	tcase_set_timeout(t, 60);
	suite_add_tcase(s, t);
	return run_suite(s);
}
