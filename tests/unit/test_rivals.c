/* SPDX-License-Identifier: BSD-3-Clause */
/* Errors of approximations, correspondences, and the rival ways to capture T. */
#include "base/random.h"
#include "math/dense.h"
#include "near.h"
#include "optla/relight.h"
#include "relight/basis.h"

#include <float.h>

static double random_number(uint64_t stream, size_t k)
{
	return optla_rand_u01_((optla_rand){.seed = 11, .stream_hi = OPTLA_RAND_TEST}, stream, (uint32_t)k, 0);
}

/* m x n of the given rank (0: full), non-negative, column-major, double. */
static double *random_matrix(size_t m, size_t n, size_t rank)
{
	double *a = calloc(m * n, sizeof *a);
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < m; i++) {
			if (!rank) a[j * m + i] = random_number(1, j * m + i);
			for (size_t k = 0; k < rank; k++) a[j * m + i] += random_number(2, k * m + i) * random_number(3, k * n + j);
		}
	return a;
}

static optla_op *dense(optla_ctx *ctx, const double *a, size_t m, size_t n)
{
	optla_op *op;
	ok(optla_op_dense(ctx, optla_cblock_(a, m, n, OPTLA_F64), true, &op));
	return op;
}

static optla_op *dense_float(optla_ctx *ctx, const double *a, size_t m, size_t n)
{
	float *f = malloc(m * n * sizeof *f);
	optla_op *op;
	for (size_t k = 0; k < m * n; k++) f[k] = (float)a[k];
	ok(optla_op_dense(ctx, optla_cblock_(f, m, n, OPTLA_F32), true, &op));
	free(f);
	return op;
}

static double norm(const double *a, size_t n)
{
	double s = 0;
	for (size_t k = 0; k < n; k++) s += a[k] * a[k];
	return sqrt(s);
}

START_TEST(relative_error_is_the_frobenius_norm)
{
	enum { M = 1100, N = 70 }; /* more than two chunks of rows, more than one block of columns */
	optla_ctx *ctx = test_ctx(NULL, 2);
	double *a = random_matrix(M, N, 0), *b = random_matrix(M, N, 3), *d = malloc(M * N * sizeof *d), error;
	for (size_t k = 0; k < M * N; k++) d[k] = a[k] - b[k];
	optla_op *x = dense(ctx, a, M, N), *y = dense(ctx, b, M, N);
	ok(optla_relative_error(x, y, &error));
	near_rel(error, norm(d, M * N) / norm(b, M * N), 1e-12); /* sums of 77000 doubles */
	ok(optla_relative_error(x, x, &error));
	ck_assert_double_eq(error, 0);
	optla_op_unref(&x);
	optla_op_unref(&y);
	free(a);
	free(b);
	free(d);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(relative_errors_of_factors_for_every_k)
{
	enum { M = 700, N = 9, K = 5 };
	optla_ctx *ctx = test_ctx(NULL, 2);
	double *t = random_matrix(M, N, 0), *d = random_matrix(M, K, 2), *p = random_matrix(N, K, 4), errors[K];
	optla_op *truth = dense(ctx, t, M, N);
	ok(optla_relative_errors(optla_cblock_(d, M, K, OPTLA_F64), optla_cblock_(p, N, K, OPTLA_F64), truth, errors));
	double *left = malloc(M * N * sizeof *left);
	memcpy(left, t, M * N * sizeof *left);
	for (size_t k = 0; k < K; k++) {
		for (size_t j = 0; j < N; j++)
			for (size_t i = 0; i < M; i++) left[j * M + i] -= d[k * M + i] * p[k * N + j];
		near_rel(errors[k], norm(left, M * N) / norm(t, M * N), 1e-12);
	}
	optla_op_unref(&truth);
	free(t);
	free(d);
	free(p);
	free(left);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(errors_do_not_depend_on_threads)
{
	enum { M = 3000, N = 130, K = 4 };
	double *t = random_matrix(M, N, 0), *d = random_matrix(M, K, 2), *p = random_matrix(N, K, 4), errors[3][K], one[3];
	const int threads[] = {1, 2, 7};
	for (int q = 0; q < 3; q++) {
		optla_ctx *ctx = test_ctx(NULL, threads[q]);
		optla_op *truth = dense_float(ctx, t, M, N), *low;
		ok(optla_op_lowrank(ctx, optla_cblock_(d, M, K, OPTLA_F64), optla_cblock_(p, N, K, OPTLA_F64), &low));
		ok(optla_relative_errors(optla_cblock_(d, M, K, OPTLA_F64), optla_cblock_(p, N, K, OPTLA_F64), truth, errors[q]));
		ok(optla_relative_error(low, truth, &one[q]));
		optla_op_unref(&truth);
		optla_op_unref(&low);
		optla_ctx_destroy(&ctx);
	}
	for (int q = 1; q < 3; q++) {
		ck_assert_mem_eq(errors[q], errors[0], sizeof errors[0]);
		ck_assert_mem_eq(&one[q], &one[0], sizeof one[0]);
	}
	near_rel(one[0], errors[0][K - 1], 1e-12); /* two ways to the same number */
	free(t);
	free(d);
	free(p);
}
END_TEST

START_TEST(correspondence_against_brute_force)
{
	enum { M = 1500, N = 90 };
	optla_ctx *ctx = test_ctx(NULL, 2);
	double *t = random_matrix(M, N, 0), strength[M], share[M];
	uint32_t light[M];
	for (size_t j = 0; j < N; j++) t[j * M + 3] = 0; /* a pixel that sees nothing */
	t[20 * M + 5] = t[30 * M + 5] = 2;               /* two equal lights */
	optla_op *op = dense(ctx, t, M, N);
	ok(optla_correspondence(op, light, strength, share));
	for (size_t i = 0; i < M; i++) {
		size_t best = 0;
		double sum = 0;
		for (size_t j = 0; j < N; j++) {
			sum += t[j * M + i];
			if (t[j * M + i] > t[best * M + i]) best = j;
		}
		ck_assert_uint_eq(light[i], best);
		ck_assert_double_eq(strength[i], t[best * M + i]);
		near_abs(share[i], sum > 0 ? strength[i] / sum : 0, 1e-15);
	}
	ck_assert_uint_eq(light[5], 20);
	ok(optla_correspondence(op, light, NULL, NULL));
	optla_op_unref(&op);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- bases ---- */

/* Orthonormal q, and q r = pattern. */
static void check_basis(optla_capture method, size_t n, size_t width, size_t height)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_basis b;
	ok(optla_basis_create_(ctx, method, n, width, height, n, 5, &b));
	for (size_t j = 0; j < n; j++)
		for (size_t k = 0; k <= j; k++) {
			double dot = 0;
			for (size_t i = 0; i < n; i++) dot += b.q[j * n + i] * b.q[k * n + i];
			near_abs(dot, j == k, 1e-12);
		}
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < n; i++) {
			double back = b.r ? 0 : b.q[j * n + i] * b.scale[j];
			for (size_t k = 0; b.r && k <= j; k++) back += b.q[k * n + i] * b.r[j * n + k];
			near_abs(back, b.pattern[j * n + i], 1e-12);
			ck_assert(fabs(b.pattern[j * n + i]) <= 1);
		}
	optla_basis_free_(&b);
	optla_ctx_destroy(&ctx);
}

START_TEST(bases_are_complete)
{
	check_basis(OPTLA_CAPTURE_SINGLE, 17, 0, 0);
	check_basis(OPTLA_CAPTURE_DCT, 17, 0, 0);
	check_basis(OPTLA_CAPTURE_DCT, 6 * 5, 6, 5);
	check_basis(OPTLA_CAPTURE_HADAMARD, 8 * 4, 8, 4);
	check_basis(OPTLA_CAPTURE_HADAMARD, 6 * 5, 6, 5);
	check_basis(OPTLA_CAPTURE_HADAMARD, 96, 0, 0);
	check_basis(OPTLA_CAPTURE_HADAMARD, 1, 0, 0);
}
END_TEST

START_TEST(waves_come_by_increasing_frequency)
{
	/* Along a line, pattern j of either basis changes its sign j times. */
	enum { N = 16 };
	optla_ctx *ctx = test_ctx(NULL, 1);
	const optla_capture methods[] = {OPTLA_CAPTURE_DCT, OPTLA_CAPTURE_HADAMARD};
	for (int m = 0; m < 2; m++) {
		optla_basis b;
		ok(optla_basis_create_(ctx, methods[m], N, 0, 0, N, 5, &b));
		for (size_t j = 0; j < N; j++) {
			size_t changes = 0;
			for (size_t i = 1; i < N; i++) changes += b.pattern[j * N + i] * b.pattern[j * N + i - 1] < 0;
			ck_assert_uint_eq(changes, j);
		}
		optla_basis_free_(&b);
	}
	/* On a grid of 8 x 2 the first vertical wave (frequency 1/2) comes after the horizontal ones up to 4/8. */
	optla_basis b;
	ok(optla_basis_create_(ctx, OPTLA_CAPTURE_DCT, 16, 8, 2, 16, 5, &b));
	near_abs(b.pattern[4 * 16 + 0], b.pattern[4 * 16 + 8], 1e-15);  /* (4, 0): the same in both rows */
	near_abs(b.pattern[5 * 16 + 0], -b.pattern[5 * 16 + 8], 1e-15); /* (0, 1): opposite */
	optla_basis_free_(&b);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- curves ---- */

START_TEST(brute_force_is_exact_in_the_end)
{
	enum { M = 40, N = 6 * 5 };
	const size_t ks[] = {1, 7, N - 1, N}, grids[][2] = {{0, 0}, {6, 5}};
	const optla_capture methods[] = {OPTLA_CAPTURE_SINGLE, OPTLA_CAPTURE_DCT, OPTLA_CAPTURE_HADAMARD};
	optla_ctx *ctx = test_ctx(NULL, 2);
	double *t = random_matrix(M, N, 0);
	optla_op *exact = dense(ctx, t, M, N), *rounded = dense_float(ctx, t, M, N), *pair;
	ok(optla_op_signed(rounded, OPTLA_SPLIT_SIGNED, &pair));
	const optla_capture_options o = {.size = sizeof o, .seed = 3, .ks = ks, .nks = 4};
	for (size_t m = 0; m < 3; m++)
		for (size_t g = 0; g < 2; g++) {
			optla_capture_point at[4], at_float[4];
			ok(optla_capture_curve(methods[m], exact, NULL, exact, grids[g][0], grids[g][1], &o, at));
			ok(optla_capture_curve(methods[m], pair, NULL, rounded, grids[g][0], grids[g][1], &o, at_float));
			for (size_t i = 0; i < 4; i++) {
				ck_assert_uint_eq(at[i].k, ks[i]);
				ck_assert_uint_eq(at[i].photos, ks[i]);
				ck_assert(at_float[i].photos > ks[i] && at_float[i].photos <= 2 * ks[i]); /* patterns with a negative part: two */
				if (i) ck_assert(at[i].relative_error < at[i - 1].relative_error);
			}
			ck_assert(at[2].relative_error > 1e-3); /* one pattern short of complete */
			near_abs(at[3].relative_error, 0, 1e-13);
			near_abs(at_float[3].relative_error, 0, 1e-5); /* N float products of N terms: about N * 6e-8 */
		}
	optla_op_unref(&exact);
	optla_op_unref(&rounded);
	optla_op_unref(&pair);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* T_k of the first k cosines is T Q Qᵀ: the error is that of the columns of T projected on the rest. */
START_TEST(dct_curve_is_a_projection)
{
	enum { M = 25, N = 12, K = 5 };
	const size_t ks[] = {K};
	optla_ctx *ctx = test_ctx(NULL, 1);
	double *t = random_matrix(M, N, 0), left = 0;
	optla_op *op = dense(ctx, t, M, N);
	const optla_capture_options o = {.size = sizeof o, .ks = ks, .nks = 1};
	optla_capture_point at;
	ok(optla_capture_curve(OPTLA_CAPTURE_DCT, op, NULL, op, 0, 0, &o, &at));
	for (size_t j = K; j < N; j++) /* frequencies not shown */
		for (size_t i = 0; i < M; i++) {
			double c = 0;
			for (size_t n = 0; n < N; n++) c += sqrt(2.0 / N) * cos(acos(-1) * ((double)n + 0.5) * (double)j / N) * t[n * M + i];
			left += c * c;
		}
	near_rel(at.relative_error, sqrt(left) / norm(t, M * N), 1e-12);
	optla_op_unref(&op);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(nystroem_recovers_low_rank)
{
	enum { M = 1300, N = 40, R = 4 };
	const size_t ks[] = {2, R, R + 3};
	optla_ctx *ctx = test_ctx(NULL, 2);
	double *t = random_matrix(M, N, R);
	optla_op *op = dense(ctx, t, M, N);
	const optla_capture_options o = {.size = sizeof o, .seed = 1, .ks = ks, .nks = 3};
	optla_capture_point at[3];
	ok(optla_capture_curve(OPTLA_CAPTURE_NYSTROEM, op, NULL, op, 0, 0, &o, at));
	ck_assert(at[0].relative_error > 1e-2);
	for (size_t i = 0; i < 3; i++) ck_assert_uint_eq(at[i].photos, 2 * ks[i]);
	/* W is as ill-conditioned as chance makes it (here below 1e5): rounding grows by that; less than 1e-7 are then cut off */
	near_abs(at[1].relative_error, 0, 1e-8);
	near_abs(at[2].relative_error, 0, 1e-8);
	optla_op_unref(&op);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* T = (rank-2 matrix)², element by element: the kernel with exponent 1/2 finds it from two rows and columns, without one it can't. */
START_TEST(kernel_nystroem_finds_the_exponent)
{
	enum { M = 1300, N = 40 };
	const size_t ks[] = {2};
	optla_ctx *ctx = test_ctx(NULL, 2);
	double *t = random_matrix(M, N, 2);
	for (size_t k = 0; k < M * N; k++) t[k] *= t[k];
	optla_op *op = dense(ctx, t, M, N);
	const optla_capture_options o = {.size = sizeof o, .seed = 1, .ks = ks, .nks = 1};
	optla_capture_point plain, kernel;
	ok(optla_capture_curve(OPTLA_CAPTURE_NYSTROEM, op, NULL, op, 0, 0, &o, &plain));
	ok(optla_capture_curve(OPTLA_CAPTURE_KERNEL_NYSTROEM, op, NULL, op, 0, 0, &o, &kernel));
	ck_assert(plain.relative_error > 0.02);
	near_abs(kernel.exponent, 0.5, 0.01); /* eight golden sections of the bracket 0.4 .. 0.65 leave 0.01 */
	ck_assert(kernel.relative_error < 0.002);
	optla_op_unref(&op);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(svd_curve_is_the_tail_of_lapack)
{
	const size_t sizes[][2] = {{2500, 17}, {17, 300}, {8, 8}};
	for (size_t q = 0; q < 3; q++) {
		const size_t m = sizes[q][0], n = sizes[q][1], r = m < n ? m : n, ks[] = {1, 3, r};
		optla_ctx *ctx = test_ctx(NULL, 2);
		double *t = random_matrix(m, n, 0), s[17];
		optla_op *op = dense(ctx, t, m, n);
		const optla_capture_options o = {.size = sizeof o, .ks = ks, .nks = 3};
		optla_capture_point at[3];
		ok(optla_capture_curve(OPTLA_CAPTURE_SVD, NULL, NULL, op, 0, 0, &o, at));
		ok(optla_svd_(ctx, t, m, n, s, NULL, NULL));
		for (size_t i = 0; i < 3; i++) {
			near_abs(at[i].relative_error, norm(s + ks[i], r - ks[i]) / norm(s, r), 1e-13);
			ck_assert_uint_eq(at[i].photos, 0);
		}
		optla_op_unref(&op);
		free(t);
		optla_ctx_destroy(&ctx);
	}
}
END_TEST

START_TEST(bad_curves_are_refused)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	double *t = random_matrix(6, 4, 0);
	optla_op *op = dense(ctx, t, 6, 4), *other = dense(ctx, t, 4, 6);
	const size_t good[] = {1, 2}, zero[] = {0}, falling[] = {2, 2}, large[] = {5};
	optla_capture_point at[2];
	optla_capture_options o = {.size = sizeof o, .ks = zero, .nks = 1};
	status_is(optla_capture_curve(OPTLA_CAPTURE_DCT, op, NULL, op, 0, 0, &o, at), OPTLA_ERR_ARG);
	o.ks = large;
	status_is(optla_capture_curve(OPTLA_CAPTURE_DCT, op, NULL, op, 0, 0, &o, at), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "k = 5: DCT on this T allows 1 to 4");
	o.ks = falling, o.nks = 2;
	status_is(optla_capture_curve(OPTLA_CAPTURE_SVD, op, NULL, op, 0, 0, &o, at), OPTLA_ERR_ARG);
	o.ks = good;
	status_is(optla_capture_curve(OPTLA_CAPTURE_DCT, op, NULL, op, 3, 2, &o, at), OPTLA_ERR_SHAPE);
	status_is(optla_capture_curve(OPTLA_CAPTURE_DCT, other, NULL, op, 0, 0, &o, at), OPTLA_ERR_SHAPE);
	status_is(optla_capture_curve((optla_capture)6, op, NULL, op, 0, 0, &o, at), OPTLA_ERR_ARG);
	o.size = 0;
	status_is(optla_capture_curve(OPTLA_CAPTURE_DCT, op, NULL, op, 0, 0, &o, at), OPTLA_ERR_ARG);
	optla_op_unref(&op);
	optla_op_unref(&other);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
	double *t = random_matrix(30, 6, 0);
	const size_t ks[] = {2, 3};
	const optla_capture_options o = {.size = sizeof o, .seed = 1, .ks = ks, .nks = 2};
	for (size_t method = 0; method <= OPTLA_CAPTURE_SVD; method++)
		for (long k = 0, done = 0; !done; k++) {
			alloc_budget b = {.left = 1000};
			const optla_ctx_desc d = {
			    .size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b, .threads = 1};
			optla_ctx *ctx;
			ok(optla_ctx_create(&ctx, &d));
			optla_op *op = dense(ctx, t, 30, 6);
			const long live = b.live;
			optla_capture_point at[2];
			b.left = k;
			const optla_status s = optla_capture_curve((optla_capture)method, op, NULL, op, 0, 0, &o, at);
			ck_assert(OPTLA_OK == s || OPTLA_ERR_NOMEM == s);
			ck_assert_int_eq(b.live, live);
			done = OPTLA_OK == s;
			ck_assert(k > 3 || !done); /* it does allocate */
			optla_op_unref(&op);
			optla_ctx_destroy(&ctx);
			ck_assert_int_eq(b.live, 0);
		}
	free(t);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("rivals");
	TCase *errors = tcase_create("errors"), *curves = tcase_create("curves");
	tcase_add_test(errors, relative_error_is_the_frobenius_norm);
	tcase_add_test(errors, relative_errors_of_factors_for_every_k);
	tcase_add_test(errors, errors_do_not_depend_on_threads);
	tcase_add_test(errors, correspondence_against_brute_force);
	tcase_add_test(curves, bases_are_complete);
	tcase_add_test(curves, waves_come_by_increasing_frequency);
	tcase_add_test(curves, brute_force_is_exact_in_the_end);
	tcase_add_test(curves, dct_curve_is_a_projection);
	tcase_add_test(curves, nystroem_recovers_low_rank);
	tcase_add_test(curves, kernel_nystroem_finds_the_exponent);
	tcase_add_test(curves, svd_curve_is_the_tail_of_lapack);
	tcase_add_test(curves, bad_curves_are_refused);
	tcase_add_test(curves, every_allocation_may_fail);
	tcase_set_timeout(curves, 60);
	suite_add_tcase(suite, errors);
	suite_add_tcase(suite, curves);
	return run_suite(suite);
}
