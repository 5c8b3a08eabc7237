/* SPDX-License-Identifier: BSD-3-Clause */
/* Every kind of operator and scalar type against the definition of a product. */
#include "op_kinds.h"

enum { M = 503, N = 77, BLOCK = 9, CASES = OP_KINDS * 4 };

/* Rounding: sums of up to 503 products, whose errors are independent: sqrt(503) eps = 1.4e-6 (float), 2.5e-15 (double) of the largest
   entry at most. Splitting subtracts photos of light from each other that are larger than T p by about sqrt(503) = 22. */
static double splitting(const op_kind *kind)
{
	return kind->make == make_signed || kind->make == make_offset || kind->make == make_auto ? 30 : 1;
}

static double tolerance(const op_kind *kind, optla_scalar type)
{
	return (kind_is_single(type) ? 1.4e-6 : 2.5e-15) * splitting(kind);
}

static optla_op *make(int i, optla_ctx *ctx, const op_kind **kind, optla_block *t)
{
	*kind = &op_kinds[i / 4];
	t->data = NULL;
	return (*kind)->make(ctx, M, N, (optla_scalar)(i % 4), t);
}

static bool takes_light(const optla_op *op) { return optla_op_flags(op) & OPTLA_OP_NONNEGATIVE; }

START_TEST(products_follow_the_definition)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	const op_kind *kind;
	optla_block t;
	optla_op *op = make(_i, ctx, &kind, &t);
	for (int trans = OPTLA_FORWARD; op && trans <= OPTLA_CONJ_TRANSPOSE; trans++) {
		const size_t in = trans == OPTLA_FORWARD ? N : M, out = trans == OPTLA_FORWARD ? M : N;
		const optla_block x = block_random(in, BLOCK, optla_op_type(op), 20, takes_light(op));
		const optla_block y = block_new(out, BLOCK, optla_op_type(op));
		const optla_block want = block_product((optla_trans)trans, optla_block_const(t), optla_block_const(x));
		ok(optla_op_apply(op, (optla_trans)trans, optla_block_const(x), y));
		const double e = block_error(optla_block_const(y), optla_block_const(want));
		ck_assert_msg(e <= tolerance(kind, optla_op_type(op)), "%s, type %d, direction %d: error %.3g", kind->name, _i % 4, trans,
		              e);
		free(x.data);
		free(y.data);
		free(want.data);
	}
	optla_op_unref(&op);
	free(t.data);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(adjoint_and_linearity_hold)
{
	/* 1e-6 (float): what the rounding of M products allows, sqrt(M) eps = 1.4e-6, relative to the product of norms, which for random
	   vectors is far above the inner product. 1e-12 (double) by the same count with room for the offset split. */
	optla_ctx *ctx = test_ctx(NULL, 2);
	const op_kind *kind;
	optla_block t;
	optla_op *op = make(_i, ctx, &kind, &t);
	const double allowed = kind_is_single((optla_scalar)(_i % 4)) ? 1e-6 : 1e-12;
	for (uint64_t seed = 0; op && seed < 3; seed++) {
		double rel = -1;
		ok(optla_op_check_adjoint(op, seed, &rel));
		ck_assert_msg(rel >= 0 && rel < allowed, "%s, type %d: adjoint off by %.3g", kind->name, _i % 4, rel);
		ok(optla_op_check_linear(op, seed, &rel));
		ck_assert_msg(rel >= 0 && rel < allowed * splitting(kind), "%s, type %d: linearity off by %.3g", kind->name, _i % 4, rel);
	}
	optla_op_unref(&op);
	free(t.data);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(a_block_is_its_columns)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	const op_kind *kind;
	optla_block t;
	optla_op *op = make(_i, ctx, &kind, &t);
	for (int trans = OPTLA_FORWARD; op && trans <= OPTLA_CONJ_TRANSPOSE; trans++) {
		const size_t in = trans == OPTLA_FORWARD ? N : M, out = trans == OPTLA_FORWARD ? M : N;
		/* columns further apart than they are long: what lies between must stay */
		optla_block x = block_random(in + 3, BLOCK, optla_op_type(op), 21, takes_light(op)),
		            y = block_new(out + 2, BLOCK, x.type);
		optla_block single = block_new(out, BLOCK, x.type);
		x.nrows = in;
		memset(y.data, 0x5a, y.ld * y.ncols * optla_scalar_bytes(y.type));
		const optla_block gap = {(char *)y.data + out * optla_scalar_bytes(y.type), 2, BLOCK, y.ld, y.type};
		y.nrows = out;
		ok(optla_op_apply(op, (optla_trans)trans, optla_block_const(x), y));
		for (size_t j = 0; j < BLOCK; j++)
			ok(optla_op_apply(op, (optla_trans)trans, optla_columns_(optla_block_const(x), j, 1),
			                  optla_columns_mut_(single, j, 1)));
		const double e = block_error(optla_block_const(y), optla_block_const(single));
		ck_assert_msg(e <= tolerance(kind, x.type), "%s, type %d, direction %d: error %.3g", kind->name, _i % 4, trans, e);
		unsigned char untouched[32];
		memset(untouched, 0x5a, sizeof untouched);
		for (size_t j = 0; j < BLOCK; j++)
			ck_assert_mem_eq((char *)gap.data + j * gap.ld * optla_scalar_bytes(y.type), untouched,
			                 2 * optla_scalar_bytes(y.type));
		free(x.data);
		free(y.data);
		free(single.data);
	}
	optla_op_unref(&op);
	free(t.data);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(any_number_of_threads_gives_the_same_bytes)
{
	static const int threads[] = {1, 2, 7};
	optla_block first[2][2] = {{{0}}};
	for (size_t k = 0; k < 3; k++) {
		optla_ctx *ctx = test_ctx(NULL, threads[k]);
		const op_kind *kind;
		optla_block t;
		optla_op *op = make(_i, ctx, &kind, &t);
		for (int trans = OPTLA_FORWARD; op && trans <= OPTLA_TRANSPOSE; trans++)
			for (size_t wide = 0; wide < 2; wide++) {
				const size_t in = trans == OPTLA_FORWARD ? N : M, out = trans == OPTLA_FORWARD ? M : N, ncols = wide ? 13 : 1;
				const optla_block x = block_random(in, ncols, optla_op_type(op), 22, takes_light(op)),
				                  y = block_new(out, ncols, x.type);
				ok(optla_op_apply(op, (optla_trans)trans, optla_block_const(x), y));
				if (k) {
					ck_assert_msg(!memcmp(y.data, first[trans][wide].data, out * ncols * optla_scalar_bytes(y.type)),
					              "%s, type %d, direction %d: %d threads differ from 1", kind->name, _i % 4, trans, threads[k]);
					free(y.data);
				} else
					first[trans][wide] = y;
				free(x.data);
			}
		optla_op_unref(&op);
		free(t.data);
		optla_ctx_destroy(&ctx);
	}
	for (size_t k = 0; k < 4; k++) free(first[k / 2][k % 2].data);
}
END_TEST

START_TEST(input_stays_and_output_is_complete)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	const op_kind *kind;
	optla_block t;
	optla_op *op = make(_i, ctx, &kind, &t), *checked = NULL;
	if (op) ok(optla_op_checked(op, &checked));
	for (int trans = OPTLA_FORWARD; op && trans <= OPTLA_CONJ_TRANSPOSE; trans++) {
		const size_t in = trans == OPTLA_FORWARD ? N : M, out = trans == OPTLA_FORWARD ? M : N;
		const optla_block x = block_random(in, 3, optla_op_type(op), 23, takes_light(op)), y = block_new(out, 3, x.type);
		ok(optla_op_apply(checked, (optla_trans)trans, optla_block_const(x), y));
		free(x.data);
		free(y.data);
	}
	optla_op_unref(&checked);
	optla_op_unref(&op);
	free(t.data);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(to_dense_gives_the_matrix)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	const op_kind *kind;
	optla_block t;
	optla_op *op = make(_i, ctx, &kind, &t);
	if (op) {
		const optla_block all = block_new(M, N, optla_op_type(op));
		ok(optla_op_to_dense(op, all));
		const double e = block_error(optla_block_const(all), optla_block_const(t));
		ck_assert_msg(e <= tolerance(kind, all.type), "%s, type %d: error %.3g", kind->name, _i % 4, e);
		free(all.data);
	}
	optla_op_unref(&op);
	free(t.data);
	optla_ctx_destroy(&ctx);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("op");
	TCase *t = tcase_create("kinds");
	tcase_add_loop_test(t, products_follow_the_definition, 0, CASES);
	tcase_add_loop_test(t, adjoint_and_linearity_hold, 0, CASES);
	tcase_add_loop_test(t, a_block_is_its_columns, 0, CASES);
	tcase_add_loop_test(t, any_number_of_threads_gives_the_same_bytes, 0, CASES);
	tcase_add_loop_test(t, input_stays_and_output_is_complete, 0, CASES);
	tcase_add_loop_test(t, to_dense_gives_the_matrix, 0, CASES);
	tcase_set_timeout(t, 60);
	suite_add_tcase(s, t);
	return run_suite(s);
}
