/* SPDX-License-Identifier: BSD-3-Clause */
/* What the generic layer promises: checks with their messages, costs, life, oracles that find what is wrong, and no memory. */
#include "op_kinds.h"

static optla_op *small_dense(optla_ctx *ctx, size_t m, size_t n, optla_scalar type)
{
	optla_block t;
	optla_op *op = make_dense(ctx, m, n, type, &t);
	free(t.data);
	return op;
}

/* ---- checks ---- */

START_TEST(shapes_are_checked)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	optla_op *op = small_dense(ctx, 4, 3, OPTLA_F64);
	double x[16] = {0}, y[16] = {0};
	float f[16] = {0};
	status_is(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(x, 4, 1, OPTLA_F64), optla_block_(y, 4, 1, OPTLA_F64)),
	          OPTLA_ERR_SHAPE);
	ck_assert_str_eq(e.text, "operator 'dense' is 4 x 3: it cannot map 4 x 1 to 4 x 1");
	status_is(optla_op_apply(op, OPTLA_TRANSPOSE, optla_cblock_(x, 4, 2, OPTLA_F64), optla_block_(y, 3, 1, OPTLA_F64)),
	          OPTLA_ERR_SHAPE);
	ck_assert_str_eq(e.text, "operator 'dense' is 4 x 3: its transpose cannot map 4 x 2 to 3 x 1");
	status_is(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(f, 3, 1, OPTLA_F32), optla_block_(y, 4, 1, OPTLA_F64)),
	          OPTLA_ERR_SHAPE);
	ck_assert_str_eq(e.text, "operator 'dense' is f64: cannot map f32 to f64");
	const optla_cblock tight = {x, 3, 2, 2, OPTLA_F64};
	status_is(optla_op_apply(op, OPTLA_FORWARD, tight, optla_block_(y, 4, 2, OPTLA_F64)), OPTLA_ERR_SHAPE);
	ck_assert_str_eq(e.text, "x is 3 x 2 but its columns are only 2 scalars apart");
	status_is(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(NULL, 3, 1, OPTLA_F64), optla_block_(y, 4, 1, OPTLA_F64)),
	          OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "x is 3 x 1 without data");
	status_is(optla_op_apply(op, (optla_trans)7, optla_cblock_(x, 3, 1, OPTLA_F64), optla_block_(y, 4, 1, OPTLA_F64)),
	          OPTLA_ERR_ARG);
	status_is(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(x, 3, 1, (optla_scalar)9), optla_block_(y, 4, 1, OPTLA_F64)),
	          OPTLA_ERR_SHAPE);
	status_is(optla_op_to_dense(op, optla_block_(y, 3, 3, OPTLA_F64)), OPTLA_ERR_SHAPE);
	ck_assert_str_eq(e.text, "operator 'dense' is 4 x 3 f64: cannot fill 3 x 3 f64");
	ok(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(x, 3, 0, OPTLA_F64), optla_block_(y, 4, 0, OPTLA_F64)));
	optla_op_unref(&op);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(bad_numbers_are_found)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	for (int type = OPTLA_F32; type <= OPTLA_C64; type++) {
		optla_op *op = small_dense(ctx, 5, 40, (optla_scalar)type);
		const optla_block x = block_random(40, 3, (optla_scalar)type, 1, false), y = block_new(5, 3, (optla_scalar)type);
		static const size_t rows[] = {0, 17, 39};
		for (size_t k = 0; k < 3; k++) {
			const double complex was = block_get(optla_block_const(x), rows[k], 2);
			const union {
				double parts[2];
				double complex number;
			} bad = {{1, NAN}};
			block_put(x, rows[k], 2, kind_is_complex((optla_scalar)type) ? bad.number : INFINITY);
			status_is(optla_op_apply(op, OPTLA_FORWARD, optla_block_const(x), y), OPTLA_ERR_ARG);
			char want[80];
			snprintf(want, sizeof want, "at row %zu, column 2; all numbers must be finite", rows[k]);
			ck_assert_msg(strstr(e.text, want), "'%s' lacks '%s'", e.text, want);
			block_put(x, rows[k], 2, was);
		}
		ok(optla_op_apply(op, OPTLA_FORWARD, optla_block_const(x), y));
		free(x.data);
		free(y.data);
		optla_op_unref(&op);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(light_is_not_negative)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	optla_op *op = test_light_op(ctx, block_random(4, 3, OPTLA_F32, 1, true), NULL);
	float x[6] = {1, 0, 2, 0, 0, -1e-20f}, y[8];
	status_is(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(x, 3, 2, OPTLA_F32), optla_block_(y, 4, 2, OPTLA_F32)),
	          OPTLA_ERR_ARG);
	ck_assert_str_eq(
	    e.text, "operator 'light' takes light only: x is negative at row 2, column 1 (optla_op_signed() splits signed patterns)");
	const double low[2] = {2, 0}, under[2] = {1.5, 1}, wrong[2] = {INFINITY, 1}, high[2] = {3, 1};
	x[5] = 0;
	status_is(optla_op_expose(op, OPTLA_FORWARD, optla_cblock_(x, 3, 2, OPTLA_F32), low, optla_block_(y, 4, 2, OPTLA_F32)),
	          OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "full power 0 of column 1 must be positive and at least its largest entry, 0");
	status_is(optla_op_expose(op, OPTLA_FORWARD, optla_cblock_(x, 3, 2, OPTLA_F32), under, optla_block_(y, 4, 2, OPTLA_F32)),
	          OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "full power 1.5 of column 0 must be positive and at least its largest entry, 2");
	status_is(optla_op_expose(op, OPTLA_FORWARD, optla_cblock_(x, 3, 2, OPTLA_F32), wrong, optla_block_(y, 4, 2, OPTLA_F32)),
	          OPTLA_ERR_ARG);
	ok(optla_op_expose(op, OPTLA_FORWARD, optla_cblock_(x, 3, 2, OPTLA_F32), high, optla_block_(y, 4, 2, OPTLA_F32)));
	optla_op_unref(&op);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(overlap_is_refused)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_op *op = small_dense(ctx, 4, 4, OPTLA_F64);
	double v[12] = {0};
	status_is(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(v, 4, 1, OPTLA_F64), optla_block_(v, 4, 1, OPTLA_F64)),
	          OPTLA_ERR_ARG);
	status_is(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(v, 4, 1, OPTLA_F64), optla_block_(v + 3, 4, 1, OPTLA_F64)),
	          OPTLA_ERR_ARG);
	ok(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(v, 4, 1, OPTLA_F64), optla_block_(v + 4, 4, 1, OPTLA_F64)));
	optla_op_unref(&op);
	optla_ctx_destroy(&ctx);
}
END_TEST

static optla_status answer_zero(void *user, optla_trans trans, optla_cblock x, optla_block y)
{
	(void)user, (void)trans, (void)x;
	for (size_t j = 0; j < y.ncols; j++)
		for (size_t i = 0; i < y.nrows; i++) block_put(y, i, j, 0);
	return OPTLA_OK;
}

START_TEST(a_missing_transpose_is_said)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	optla_op *op, *out = NULL;
	const optla_op_desc d = {.size = sizeof d,
	                         .name = "one way",
	                         .nrows = 2,
	                         .ncols = 2,
	                         .type = OPTLA_F64,
	                         .flags = OPTLA_OP_NO_TRANSPOSE,
	                         .apply = answer_zero};
	ok(optla_op_create(ctx, &op, &d));
	double x[2] = {1, 1}, y[2];
	ok(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(x, 2, 1, OPTLA_F64), optla_block_(y, 2, 1, OPTLA_F64)));
	status_is(optla_op_apply(op, OPTLA_TRANSPOSE, optla_cblock_(x, 2, 1, OPTLA_F64), optla_block_(y, 2, 1, OPTLA_F64)),
	          OPTLA_ERR_UNSUPPORTED);
	ck_assert_str_eq(e.text, "operator 'one way' has no transpose: its camera and projector can't change places");
	status_is(optla_op_adjoint(op, &out), OPTLA_ERR_UNSUPPORTED);
	double rel;
	status_is(optla_op_check_adjoint(op, 1, &rel), OPTLA_ERR_UNSUPPORTED);
	/* a product inherits what its factors can't do */
	ok(optla_op_product(op, op, &out));
	ck_assert_uint_eq(optla_op_flags(out), OPTLA_OP_NO_TRANSPOSE);
	optla_op_unref(&out);
	optla_op_unref(&op);
	optla_ctx_destroy(&ctx);
}
END_TEST

static void count_destroy(void *user) { ++*(int *)user; }

START_TEST(create_refuses_nonsense_and_destroys)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	int destroyed = 0;
	const optla_op_desc good = {.size = sizeof good,
	                            .nrows = 2,
	                            .ncols = 3,
	                            .type = OPTLA_F64,
	                            .user = &destroyed,
	                            .apply = answer_zero,
	                            .destroy = count_destroy};
	optla_op_desc bad[8];
	for (size_t k = 0; k < 8; k++) bad[k] = good;
	bad[0].size = 8;
	bad[1].apply = NULL;
	bad[2].expose = test_light_expose;
	bad[3].type = (optla_scalar)4;
	bad[4].flags = OPTLA_OP_SYMMETRIC;
	bad[5].frequency_hz = -1;
	bad[6].nparts = 1;
	bad[7].type = OPTLA_C32, bad[7].flags = OPTLA_OP_NONNEGATIVE;
	optla_op *op;
	for (size_t k = 0; k < 8; k++) {
		status_is(optla_op_create(ctx, &op, &bad[k]), OPTLA_ERR_ARG);
		ck_assert_ptr_null(op);
		ck_assert_int_eq(destroyed, (int)k + 1);
	}
	ok(optla_op_create(ctx, &op, &good));
	optla_op *second = optla_op_ref(op);
	optla_op_unref(&op);
	ck_assert_ptr_null(op);
	ck_assert_int_eq(destroyed, 8);
	ck_assert_str_eq(optla_op_name(second), "unnamed");
	optla_op_unref(&second);
	ck_assert_int_eq(destroyed, 9);
	optla_op_unref(&second);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(constructors_refuse_what_does_not_fit)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	optla_op *a = small_dense(ctx, 4, 3, OPTLA_F64), *b = small_dense(ctx, 4, 3, OPTLA_F64),
	         *c = small_dense(ctx, 3, 2, OPTLA_F32), *out;
	status_is(optla_op_product(a, b, &out), OPTLA_ERR_SHAPE);
	ck_assert_str_eq(e.text, "no product of 'dense', 4 x 3 f64, with 'dense', 4 x 3 f64");
	status_is(optla_op_product(a, c, &out), OPTLA_ERR_SHAPE);
	ck_assert_ptr_null(out);
	double v[6] = {1, 2, 3, 4, 5, 6};
	status_is(optla_op_lowrank(ctx, optla_cblock_(v, 2, 2, OPTLA_F64), optla_cblock_(v, 3, 1, OPTLA_F64), &out), OPTLA_ERR_SHAPE);
	status_is(optla_op_signed(a, (optla_split)3, &out), OPTLA_ERR_ARG);
	optla_op_unref(&a);
	optla_op_unref(&b);
	optla_op_unref(&c);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(sparse_input_is_checked)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	optla_op *op;
	double v[4] = {1, 2, 3, 4};
	const uint64_t start[3] = {0, 2, 4}, late[3] = {1, 2, 4}, falling[3] = {0, 5, 4};
	const uint32_t column[4] = {0, 2, 1, 2}, outside[4] = {0, 3, 1, 2}, twice[4] = {0, 0, 1, 2}, mixed[4] = {2, 0, 1, 2};
	const optla_cblock values = optla_cblock_(v, 4, 1, OPTLA_F64);
	status_is(optla_op_sparse(ctx, 2, 3, late, column, values, &op), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "row_start[0] is 1, not 0");
	status_is(optla_op_sparse(ctx, 2, 3, falling, column, values, &op), OPTLA_ERR_ARG);
	status_is(optla_op_sparse(ctx, 2, 3, start, outside, values, &op), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "column 3 of entry 1 in row 0 is outside of 0 .. 2");
	status_is(optla_op_sparse(ctx, 2, 3, start, twice, values, &op), OPTLA_ERR_ARG);
	status_is(optla_op_sparse(ctx, 2, 3, start, mixed, values, &op), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "columns of row 0 must ascend without repetition: 0 comes after 2");
	status_is(optla_op_sparse(ctx, 2, 3, start, column, optla_cblock_(v, 3, 1, OPTLA_F64), &op), OPTLA_ERR_SHAPE);
	v[2] = NAN;
	status_is(optla_op_sparse(ctx, 2, 3, start, column, values, &op), OPTLA_ERR_ARG);
	ck_assert_ptr_null(op);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- costs ---- */

START_TEST(costs_count_each_part_once)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	test_light *l;
	optla_op *light = test_light_op(ctx, block_random(6, 6, OPTLA_F64, 1, true), &l), *plain = small_dense(ctx, 6, 6, OPTLA_F64);
	optla_op *pair, *square, *split;
	ok(optla_op_signed(light, OPTLA_SPLIT_SIGNED, &split));
	ok(optla_op_product(split, plain, &pair));
	ok(optla_op_product(pair, pair, &square));
	const optla_block x = block_random(6, 5, OPTLA_F64, 2, false), y = block_new(6, 5, OPTLA_F64);
	ok(optla_op_apply(square, OPTLA_FORWARD, optla_block_const(x), y));
	const optla_op_cost c = optla_op_cost_so_far(square);
	ck_assert_uint_eq(c.applies, 1);
	ck_assert_uint_eq(c.forward_columns, 5);
	ck_assert_uint_eq(c.transpose_columns, 0);
	/* two passes of five columns: two photos for each through the light, one product for each through the matrix */
	ck_assert_uint_eq(c.photos, 2 * 5 * 2 + 2 * 5);
	near_abs(c.exposure_s, 0.25 * 20, 1e-15);
	ck_assert(c.seconds > 0);
	ck_assert_uint_eq(optla_op_cost_so_far(square).photos, c.photos);
	ck_assert_uint_eq(optla_op_cost_so_far(light).photos, 20);
	ck_assert_uint_eq(optla_op_cost_so_far(plain).photos, 10);
	/* a product that fails costs nothing more in the generic layer */
	block_put(x, 0, 0, NAN);
	status_is(optla_op_apply(plain, OPTLA_TRANSPOSE, optla_block_const(x), y), OPTLA_ERR_ARG);
	ck_assert_uint_eq(optla_op_cost_so_far(plain).transpose_columns, 0);
	optla_op_unref(&square);
	optla_op_unref(&pair);
	optla_op_unref(&split);
	optla_op_unref(&plain);
	optla_op_unref(&light);
	free(x.data);
	free(y.data);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(noise_passes_through)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	test_light *l;
	optla_op *light = test_light_op(ctx, block_random(6, 6, OPTLA_F64, 1, true), &l), *adjoint, *checked, *product, *plain;
	double twos[36] = {0};
	for (size_t k = 0; k < 6; k++) twos[7 * k] = 2;
	ok(optla_op_dense(ctx, optla_cblock_(twos, 6, 6, OPTLA_F64), true, &plain));
	l->read = 0.1;
	ok(optla_op_adjoint(light, &adjoint));
	ok(optla_op_checked(adjoint, &checked));
	ok(optla_op_product(plain, light, &product));
	const optla_block x = block_random(6, 1, OPTLA_F64, 2, true), y = block_new(6, 1, OPTLA_F64);
	ok(optla_op_apply(checked, OPTLA_TRANSPOSE, optla_block_const(x), y));
	ck_assert(l->noise > 0);
	ck_assert(optla_op_noise(checked) == l->noise);
	ok(optla_op_apply(product, OPTLA_FORWARD, optla_block_const(x), y));
	near_rel(optla_op_noise(product), 2 * l->noise, 1e-12); /* the matrix doubles light and error alike */
	ck_assert(optla_op_noise(plain) == 0);
	optla_op_unref(&product);
	optla_op_unref(&checked);
	optla_op_unref(&adjoint);
	optla_op_unref(&light);
	optla_op_unref(&plain);
	free(x.data);
	free(y.data);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- oracles that must find faults ---- */

typedef enum { FAULT_TRANSPOSE, FAULT_SQUARE, FAULT_INPUT, FAULT_UNSET, FAULT_NEGATIVE, FAULT_CONJ } fault;

static optla_status faulty(void *user, optla_trans trans, optla_cblock x, optla_block y)
{
	const fault f = *(const fault *)user;
	for (size_t j = 0; j < y.ncols; j++)
		for (size_t i = 0; i < y.nrows; i++) {
			double complex v = block_get(x, i, j);
			if (f == FAULT_TRANSPOSE && trans != OPTLA_FORWARD && i == 3) v = 0;
			if (f == FAULT_CONJ) v *= trans == OPTLA_FORWARD ? I : -I; /* answers Tᴴ where Tᵀ is asked for */
			if (f == FAULT_SQUARE) v *= v;
			if (f == FAULT_NEGATIVE && i == 4) v = -1;
			if (f == FAULT_UNSET && i == 5 && j == 1) continue;
			block_put(y, i, j, v);
		}
	if (f == FAULT_INPUT) ((double *)(uintptr_t)x.data)[2] += 1;
	return OPTLA_OK;
}

static optla_op *faulty_op(optla_ctx *ctx, fault *f, optla_scalar type)
{
	const optla_op_desc d = {.size = sizeof d,
	                         .name = "faulty",
	                         .nrows = 8,
	                         .ncols = 8,
	                         .type = type,
	                         .flags = *f == FAULT_NEGATIVE ? OPTLA_OP_NONNEGATIVE : 0u,
	                         .user = f,
	                         .apply = faulty};
	optla_op *op;
	ok(optla_op_create(ctx, &op, &d));
	return op;
}

START_TEST(oracles_find_faults)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	fault f = FAULT_TRANSPOSE, g = FAULT_SQUARE, h = FAULT_CONJ;
	optla_op *op = faulty_op(ctx, &f, OPTLA_F64);
	double rel;
	ok(optla_op_check_adjoint(op, 1, &rel));
	ck_assert_double_gt(rel, 1e-3);
	ok(optla_op_check_linear(op, 1, &rel));
	ck_assert_double_lt(rel, 1e-15);
	optla_op_unref(&op);
	op = faulty_op(ctx, &g, OPTLA_F64);
	ok(optla_op_check_linear(op, 1, &rel));
	ck_assert_double_gt(rel, 1e-2);
	optla_op_unref(&op);
	op = faulty_op(ctx, &h, OPTLA_C64);
	ok(optla_op_check_adjoint(op, 1, &rel));
	ck_assert_double_gt(rel, 1e-2);
	optla_op_unref(&op);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(checked_finds_faults)
{
	static const struct {
		fault f;
		const char *text;
	} cases[] = {{FAULT_INPUT, "operator 'faulty' changed its input x at row 2, column 0"},
	             {FAULT_UNSET, "operator 'faulty' left y at row 5, column 1 unset or not finite"},
	             {FAULT_NEGATIVE, "operator 'faulty' answered negative light, y = -1 at row 4, column 0"}};
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	for (size_t k = 0; k < 3; k++) {
		fault f = cases[k].f;
		optla_op *op = faulty_op(ctx, &f, OPTLA_F64), *checked;
		ok(optla_op_checked(op, &checked));
		const optla_block x = block_random(8, 2, OPTLA_F64, 1, true), y = block_new(8, 2, OPTLA_F64);
		status_is(optla_op_apply(checked, OPTLA_FORWARD, optla_block_const(x), y), OPTLA_ERR_DEVICE);
		ck_assert_str_eq(e.text, cases[k].text);
		optla_op_unref(&checked);
		optla_op_unref(&op);
		free(x.data);
		free(y.data);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- no memory ---- */

/* Makes and uses one operator of each kind; the first failure is passed on. Nothing here may assert. */
static optla_status use_kind(optla_ctx *ctx, int kind, const char *npy)
{
	double a[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, x[8] = {1, 2, 3, 4, 1, 2, 3, 4}, y[8];
	const uint64_t start[4] = {0, 1, 2, 3};
	const uint32_t column[3] = {0, 1, 3};
	const optla_cblock m = optla_cblock_(a, 3, 4, OPTLA_F64);
	optla_op *base = NULL, *op = NULL, *unused = NULL;
	optla_status s = optla_op_dense(ctx, m, true, &base);
	if (OPTLA_OK == s && kind == 0) op = optla_op_ref(base);
	if (OPTLA_OK == s && kind == 1) s = optla_op_sparse(ctx, 3, 4, start, column, optla_cblock_(a, 3, 1, OPTLA_F64), &op);
	if (OPTLA_OK == s && kind == 2)
		s = optla_op_lowrank(ctx, optla_cblock_(a, 3, 2, OPTLA_F64), optla_cblock_(a, 4, 2, OPTLA_F64), &op);
	if (OPTLA_OK == s && kind == 3) {
		s = optla_op_dense(ctx, optla_cblock_(a, 4, 3, OPTLA_F64), true, &unused);
		optla_op *wide = NULL;
		if (OPTLA_OK == s) s = optla_op_product(base, unused, &wide);
		if (OPTLA_OK == s) s = optla_op_product(wide, base, &op);
		optla_op_unref(&wide);
		optla_op_unref(&unused);
	}
	if (OPTLA_OK == s && kind == 4) {
		s = optla_op_adjoint(base, &unused);
		if (OPTLA_OK == s) s = optla_op_adjoint(unused, &op);
		optla_op_unref(&unused);
	}
	if (OPTLA_OK == s && kind == 5) s = optla_op_checked(base, &op);
	if (OPTLA_OK == s && kind == 6) s = optla_op_signed(base, OPTLA_SPLIT_SIGNED, &op);
	if (OPTLA_OK == s && kind == 7) s = optla_op_signed(base, OPTLA_SPLIT_AUTO, &op);
	if (OPTLA_OK == s && kind == 8) s = optla_op_map(ctx, npy, &op);
	if (OPTLA_OK == s) s = optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(x, 4, 2, OPTLA_F64), optla_block_(y, 3, 2, OPTLA_F64));
	if (OPTLA_OK == s)
		s = optla_op_apply(op, OPTLA_TRANSPOSE, optla_cblock_(x, 3, 2, OPTLA_F64), optla_block_(y, 4, 2, OPTLA_F64));
	double rel;
	if (OPTLA_OK == s) s = optla_op_check_adjoint(op, 1, &rel);
	if (OPTLA_OK == s) s = optla_op_check_linear(op, 1, &rel);
	if (OPTLA_OK == s) s = optla_op_to_dense(op, optla_block_(a, 3, 4, OPTLA_F64));
	optla_op_unref(&op);
	optla_op_unref(&base);
	return s;
}

START_TEST(every_allocation_may_fail)
{
	char path[] = "/tmp/optla-test-XXXXXX";
	ck_assert_int_ge(mkstemp(path), 0);
	const optla_block t = block_random(3, 4, OPTLA_F64, 1, false);
	write_npy(path, optla_block_const(t), true);
	free(t.data);
	bool done = false;
	long k = 0;
	for (; !done; k++) {
		alloc_budget b = {.left = k};
		optla_ctx *ctx = NULL;
		const optla_ctx_desc d = {.size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b, .threads = 2};
		optla_status s = optla_ctx_create(&ctx, &d);
		if (OPTLA_OK == s) s = use_kind(ctx, _i, path);
		optla_ctx_destroy(&ctx);
		ck_assert_msg(s == OPTLA_ERR_NOMEM || s == OPTLA_OK, "allocation %ld: %s", k, optla_status_name(s));
		ck_assert_msg(b.live == 0, "allocation %ld: %ld blocks leak", k, b.live);
		done = s == OPTLA_OK && b.left > 0;
	}
	ck_assert_int_gt(k, 8); /* the loop did make allocations fail */
	remove(path);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("op_rules");
	TCase *t = tcase_create("rules");
	tcase_add_test(t, shapes_are_checked);
	tcase_add_test(t, bad_numbers_are_found);
	tcase_add_test(t, light_is_not_negative);
	tcase_add_test(t, overlap_is_refused);
	tcase_add_test(t, a_missing_transpose_is_said);
	tcase_add_test(t, create_refuses_nonsense_and_destroys);
	tcase_add_test(t, constructors_refuse_what_does_not_fit);
	tcase_add_test(t, sparse_input_is_checked);
	tcase_add_test(t, costs_count_each_part_once);
	tcase_add_test(t, noise_passes_through);
	tcase_add_test(t, oracles_find_faults);
	tcase_add_test(t, checked_finds_faults);
	tcase_add_loop_test(t, every_allocation_may_fail, 0, 9);
	suite_add_tcase(s, t);
	return run_suite(s);
}
