/* SPDX-License-Identifier: BSD-3-Clause */
/* Dense kernels at awkward sizes, vectors, LAPACK wrappers by their defining equations, NNLS by its optimality conditions. */
#include "op_kinds.h"

#include <float.h>

/* ---- products ---- */

/* Sizes around the widths of the kernels: 1, 4, 8, 16, 64 rows and columns and their neighbours, tiles, nothing at all. */
START_TEST(products_at_awkward_sizes)
{
	static const size_t sizes[][3] = {{1, 1, 1},    {3, 1, 2},     {1, 9, 3},      {7, 8, 9},     {8, 7, 8},
	                                  {15, 4, 4},   {16, 16, 16},  {17, 33, 5},    {63, 65, 1},   {64, 64, 12},
	                                  {4097, 3, 1}, {4095, 12, 9}, {300, 129, 70}, {5, 300, 11},  {0, 3, 2},
	                                  {3, 0, 2},    {3, 2, 0},     {70, 131, 4},   {513, 128, 8}, {9000, 5, 2}};
	optla_ctx *ctx = test_ctx(NULL, 2);
	for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
		for (int trans = OPTLA_FORWARD; trans <= OPTLA_CONJ_TRANSPOSE; trans++) {
			const size_t m = sizes[k][0], n = sizes[k][1], r = sizes[k][2];
			const optla_scalar type = (optla_scalar)_i;
			optla_block a = block_random(m + 1, n, type, k, false); /* a leading dimension of its own */
			a.nrows = m;
			const optla_block x = block_random(trans == OPTLA_FORWARD ? n : m, r, type, k + 100, false);
			const optla_block y = block_random(trans == OPTLA_FORWARD ? m : n, r, type, 5, false);
			const optla_block want = block_product((optla_trans)trans, optla_block_const(a), optla_block_const(x));
			ok(optla_dense_apply_(ctx, (optla_trans)trans, optla_block_const(a), optla_block_const(x), y));
			/* independent rounding errors in sums of up to 9000 products: sqrt(9000) eps */
			const double e = block_error(optla_block_const(y), optla_block_const(want)),
			             allowed = kind_is_single(type) ? 5.7e-6 : 1.1e-14;
			ck_assert_msg(e <= allowed, "%zu x %zu times %zu, direction %d, type %d: error %.3g", m, n, r, trans, _i, e);
			free(a.data);
			free(x.data);
			free(y.data);
			free(want.data);
		}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(large_products_are_the_same_for_any_threads)
{
	static const int threads[] = {1, 2, 7};
	static const size_t columns[] = {1, 3, 9, 70};
	const size_t m = 20011, n = 150;
	const optla_block a = block_random(m, n, (optla_scalar)_i, 1, false);
	for (size_t c = 0; c < 4; c++)
		for (int trans = OPTLA_FORWARD; trans <= OPTLA_CONJ_TRANSPOSE; trans++) {
			const size_t in = trans == OPTLA_FORWARD ? n : m, out = trans == OPTLA_FORWARD ? m : n;
			const optla_block x = block_random(in, columns[c], a.type, 2, true);
			const optla_block y[2] = {block_new(out, columns[c], a.type), block_new(out, columns[c], a.type)};
			for (size_t k = 0; k < 3; k++) {
				optla_ctx *ctx = test_ctx(NULL, threads[k]);
				ok(optla_dense_apply_(ctx, (optla_trans)trans, optla_block_const(a), optla_block_const(x), y[k > 0]));
				ck_assert(!k || !memcmp(y[0].data, y[1].data, out * columns[c] * optla_scalar_bytes(a.type)));
				optla_ctx_destroy(&ctx);
			}
			free(x.data);
			free(y[0].data);
			free(y[1].data);
		}
	free(a.data);
}
END_TEST

/* ---- vectors ---- */

START_TEST(vectors_follow_their_formulas)
{
	for (int type = OPTLA_F32; type <= OPTLA_F64; type++) {
		const size_t n = 1013;
		const optla_block a = block_random(n, 2, (optla_scalar)type, 1, false), b = block_random(n, 2, OPTLA_F64, 2, false);
		double dot = 0, squares = 0, mixed = 0;
		for (size_t i = 0; i < n; i++) {
			const double p = optla_get_(optla_block_const(a), i, 0), q = optla_get_(optla_block_const(a), i, 1);
			dot += p * q;
			squares += q * q;
			mixed += p * optla_get_(optla_block_const(b), i, 1);
		}
		/* sums of 1013 doubles in another order: sqrt(1013) eps of the norms, about 32 times the values */
		near_abs(optla_dot_(optla_block_const(a), 0, optla_block_const(a), 1), dot, 1e-11);
		near_abs(optla_dot_(optla_block_const(a), 0, optla_block_const(b), 1), mixed, 1e-11);
		near_rel(optla_norm_(optla_block_const(a), 1), sqrt(squares), 1e-14);
		near_rel(optla_norm_fro_(optla_block_const(a)), hypot(optla_norm_(optla_block_const(a), 0), sqrt(squares)), 1e-14);
		const optla_block c = block_new(n, 2, OPTLA_F64);
		optla_copy_column_(optla_block_const(a), 1, c, 0);
		optla_copy_column_(optla_block_const(b), 0, c, 1);
		optla_scale_(c, 0, -0.5);
		optla_axpy_(2, optla_block_const(a), 0, c, 1);
		for (size_t i = 0; i < n; i++) {
			ck_assert(optla_get_(optla_block_const(c), i, 0) == -0.5 * optla_get_(optla_block_const(a), i, 1));
			ck_assert(optla_get_(optla_block_const(c), i, 1) ==
			          optla_get_(optla_block_const(b), i, 0) + 2 * optla_get_(optla_block_const(a), i, 0));
		}
		free(a.data);
		free(b.data);
		free(c.data);
	}
	const float f[4] = {3, 4, 0, 12};
	near_rel(optla_norm_fro_(optla_cblock_(f, 2, 1, OPTLA_C32)), 13, 1e-15);
}
END_TEST

/* ---- LAPACK ---- */

static double *normal(size_t n, uint64_t seed) { return block_random(n, 1, OPTLA_F64, seed, false).data; }

/* max |A B - C|; A m x k, B k x n */
static double product_error(const double *a, const double *b, const double *c, size_t m, size_t k, size_t n)
{
	double worst = 0;
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < m; i++) {
			double s = -c[j * m + i];
			for (size_t l = 0; l < k; l++) s += a[l * m + i] * b[j * k + l];
			worst = fmax(worst, fabs(s));
		}
	return worst;
}

/* max |Qᵀ Q - I|, Q m x n */
static double orthogonality(const double *q, size_t m, size_t n)
{
	double worst = 0;
	for (size_t i = 0; i < n; i++)
		for (size_t j = 0; j < n; j++) {
			double s = i == j ? -1 : 0;
			for (size_t k = 0; k < m; k++) s += q[i * m + k] * q[j * m + k];
			worst = fmax(worst, fabs(s));
		}
	return worst;
}

enum { BACKWARD = 100 }; /* LAPACK's backward errors are below this many eps times the norm at these sizes (p(n) ~ n, n <= 40) */

START_TEST(svd_reconstructs)
{
	static const size_t sizes[][2] = {{1, 1}, {40, 7}, {7, 40}, {20, 20}};
	const size_t m = sizes[_i][0], n = sizes[_i][1], k = m < n ? m : n;
	optla_ctx *ctx = test_ctx(NULL, 1);
	double *a = normal(m * n, 1), *s = calloc(k, 8), *only = calloc(k, 8), *u = calloc(m * k, 8), *vt = calloc(k * n, 8);
	double *was = memcpy(calloc(m * n, 8), a, m * n * 8), *v = calloc(n * k, 8);
	ok(optla_svd_(ctx, a, m, n, s, u, vt));
	ck_assert_mem_eq(a, was, m * n * 8);
	ok(optla_svd_(ctx, a, m, n, only, NULL, NULL));
	near_array(only, s, k, BACKWARD * DBL_EPSILON);
	for (size_t j = 1; j < k; j++) ck_assert(s[j] <= s[j - 1] && s[j] >= 0);
	for (size_t j = 0; j < k; j++)
		for (size_t i = 0; i < n; i++) v[j * n + i] = vt[i * k + j];
	ck_assert_double_le(orthogonality(u, m, k), BACKWARD * DBL_EPSILON);
	ck_assert_double_le(orthogonality(v, n, k), BACKWARD * DBL_EPSILON);
	for (size_t j = 0; j < k; j++)
		for (size_t i = 0; i < m; i++) u[j * m + i] *= s[j];
	ck_assert_double_le(product_error(u, vt, a, m, k, n), BACKWARD * DBL_EPSILON * s[0]);
	void *all[] = {a, s, only, u, vt, was, v};
	for (size_t j = 0; j < 7; j++) free(all[j]);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(qr_reconstructs)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	const size_t m = 40, n = 9;
	double *a = normal(m * n, 1), q[40 * 9], r[81];
	if (_i) memcpy(a + 5 * m, a, m * sizeof *a); /* dependent columns: Q stays orthonormal */
	ok(optla_qr_(ctx, a, m, n, q, r));
	ck_assert_double_le(orthogonality(q, m, n), BACKWARD * DBL_EPSILON);
	ck_assert_double_le(product_error(q, r, a, m, n, n), BACKWARD * DBL_EPSILON * 10);
	for (size_t j = 0; j < n; j++)
		for (size_t i = j + 1; i < n; i++) ck_assert(r[j * n + i] == 0);
	status_is(optla_qr_(ctx, a, 3, 4, q, r), OPTLA_ERR_SHAPE);
	free(a);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* x is the minimum-norm least squares solution: Aᵀ(A x - b) = 0, and x is orthogonal to the null space (in the range of Aᵀ). */
START_TEST(lstsq_solves_every_shape)
{
	static const size_t sizes[][3] = {{20, 6, 6}, {6, 20, 6}, {12, 12, 12}, {20, 8, 5}, {8, 20, 5}}; /* m, n, rank */
	const size_t m = sizes[_i][0], n = sizes[_i][1], rank = sizes[_i][2], nrhs = 3;
	optla_ctx *ctx = test_ctx(NULL, 1);
	double *a = normal(m * n, 1), *b = normal(m * nrhs, 2), *x = calloc(n * nrhs, 8), *at = calloc(n * m, 8), *r = calloc(m, 8);
	for (size_t j = rank; j < (m < n ? m : n); j++) /* columns (rows of a wide A) beyond the rank repeat the first ones */
		for (size_t i = 0; i < (m < n ? n : m); i++) {
			if (m < n)
				a[i * m + j] = a[i * m + j - rank];
			else
				a[j * m + i] = a[(j - rank) * m + i];
		}
	size_t found;
	ok(optla_lstsq_(ctx, a, m, n, b, nrhs, 1e-12, x, &found));
	ck_assert_uint_eq(found, rank);
	for (size_t c = 0; c < nrhs; c++) {
		for (size_t i = 0; i < m; i++) {
			r[i] = -b[c * m + i];
			for (size_t j = 0; j < n; j++) r[i] += a[j * m + i] * x[c * n + j];
		}
		for (size_t j = 0; j < n; j++) {
			double g = 0;
			for (size_t i = 0; i < m; i++) g += a[j * m + i] * r[i];
			near_abs(g, 0, 1e-12); /* condition numbers here are below 1e2, norms below 10: 1e3 eps with room */
		}
	}
	/* x = Aᵀ w for some w: its distance from the range of Aᵀ */
	for (size_t i = 0; i < m; i++)
		for (size_t j = 0; j < n; j++) at[i * n + j] = a[j * m + i];
	double *w = calloc(m * nrhs, 8);
	ok(optla_lstsq_(ctx, at, n, m, x, nrhs, 1e-12, w, NULL));
	ck_assert_double_le(product_error(at, w, x, n, m, nrhs), 1e-12);
	void *all[] = {a, b, x, at, r, w};
	for (size_t j = 0; j < 6; j++) free(all[j]);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(lstsq_of_nothing_is_zero)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	const double zero[12] = {0}, b[4] = {1, 2, 3, 4};
	double x[3] = {9, 9, 9};
	size_t rank = 9;
	ok(optla_lstsq_(ctx, zero, 4, 3, b, 1, 1e-12, x, &rank));
	ck_assert_uint_eq(rank, 0);
	ck_assert(x[0] == 0 && x[1] == 0 && x[2] == 0);
	x[0] = 9;
	ok(optla_lstsq_(ctx, zero, 0, 3, b, 1, 1e-12, x, &rank));
	ck_assert(x[0] == 0 && rank == 0);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(eigh_reconstructs)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	const size_t n = 25;
	double *a = normal(n * n, 1), *w = calloc(n, 8), *v = calloc(n * n, 8), *vw = calloc(n * n, 8);
	for (size_t i = 0; i < n; i++)
		for (size_t j = 0; j < i; j++) a[i * n + j] = a[j * n + i];
	ok(optla_eigh_(ctx, a, n, w, v));
	for (size_t j = 1; j < n; j++) ck_assert(w[j - 1] <= w[j]);
	ck_assert_double_le(orthogonality(v, n, n), BACKWARD * DBL_EPSILON);
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < n; i++) vw[j * n + i] = v[j * n + i] * w[j];
	ck_assert_double_le(product_error(a, v, vw, n, n, n), BACKWARD * DBL_EPSILON * 10);
	free(a);
	free(w);
	free(v);
	free(vw);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(solve_solves_or_says_singular)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	const size_t n = 15;
	double *a = normal(n * n, 1), *b = normal(n * 2, 2), x[30];
	ok(optla_solve_(ctx, a, n, b, 2, x));
	ck_assert_double_le(product_error(a, x, b, n, n, 2), 1e-11); /* backward error times ||A|| ||x||, which is below 1e3 here */
	memset(a + 3 * n, 0, n * sizeof *a);
	status_is(optla_solve_(ctx, a, n, b, 2, x), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "the 15 x 15 matrix is singular: pivot 4 is zero");
	free(a);
	free(b);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- NNLS ---- */

/* Smallest residual over all 2^n sets of allowed columns whose least squares solution is non-negative: the definition. */
static double brute_force(optla_ctx *ctx, const double *a, size_t m, size_t n, const double *b)
{
	double best = INFINITY, *part = calloc(m * n + 1, 8), *x = calloc(n + 1, 8);
	for (unsigned set = 0; set < 1u << n; set++) {
		size_t p = 0;
		bool positive = true;
		for (size_t j = 0; j < n; j++)
			if (set >> j & 1) memcpy(part + p++ * m, a + j * m, m * 8);
		ok(optla_lstsq_(ctx, part, m, p, b, 1, 1e-12, x, NULL));
		for (size_t j = 0; j < p; j++) positive = positive && x[j] >= 0;
		double squares = 0;
		for (size_t i = 0; i < m; i++) {
			double r = b[i];
			for (size_t j = 0; j < p; j++) r -= part[j * m + i] * x[j];
			squares += r * r;
		}
		if (positive) best = fmin(best, squares);
	}
	free(part);
	free(x);
	return sqrt(best);
}

/* Karush-Kuhn-Tucker: x >= 0, w = Aᵀ(b - A x) <= 0, and w_j = 0 where x_j > 0. Together they are sufficient for the minimum. */
static void check_kkt(const double *a, size_t m, size_t n, const double *b, const double *x, double residual)
{
	double squares = 0, *r = calloc(m + 1, 8), norm_b = 0;
	for (size_t i = 0; i < m; i++) {
		r[i] = b[i];
		for (size_t j = 0; j < n; j++) r[i] -= a[j * m + i] * x[j];
		squares += r[i] * r[i];
		norm_b = hypot(norm_b, b[i]);
	}
	near_abs(residual, sqrt(squares), 1e-13 * fmax(norm_b, 1));
	for (size_t j = 0; j < n; j++) {
		double w = 0, norm_a = 0;
		for (size_t i = 0; i < m; i++) w += a[j * m + i] * r[i], norm_a = hypot(norm_a, a[j * m + i]);
		/* least squares residuals are orthogonal to the columns up to rounding in Q: p(m, n) eps ||a_j|| ||b|| */
		const double rounding = 1e-12 * norm_a * norm_b;
		ck_assert_msg(x[j] >= 0, "x[%zu] = %g", j, x[j]);
		ck_assert_msg(w <= rounding, "w[%zu] = %g > %g with x = %g: the residual could fall", j, w, rounding, x[j]);
		ck_assert_msg(x[j] == 0 || w >= -rounding, "w[%zu] = %g with x = %g: not stationary", j, w, x[j]);
	}
	free(r);
}

typedef enum { NNLS_PLAIN, NNLS_POSITIVE, NNLS_REPEATED, NNLS_OPPOSITE, NNLS_ZERO_COLUMN, NNLS_NEARLY, NNLS_KINDS } nnls_kind;

static void make_nnls(nnls_kind kind, size_t m, size_t n, double *a, double *b, uint64_t seed)
{
	const optla_block ra = block_random(m, n, OPTLA_F64, seed, kind == NNLS_POSITIVE);
	const optla_block rb = block_random(m, 1, OPTLA_F64, seed + 1000, false);
	memcpy(a, ra.data, m * n * 8);
	memcpy(b, rb.data, m * 8);
	for (size_t i = 0; n > 1 && i < m; i++) {
		if (kind == NNLS_REPEATED) a[(n - 1) * m + i] = a[i];
		if (kind == NNLS_OPPOSITE) a[(n - 1) * m + i] = -a[i];
		if (kind == NNLS_ZERO_COLUMN) a[m + i] = 0;
		if (kind == NNLS_NEARLY) a[(n - 1) * m + i] = a[i] * (1 + 1e-15 * (double)i);
	}
	free(ra.data);
	free(rb.data);
}

START_TEST(nnls_is_optimal)
{
	static const size_t sizes[][2] = {{8, 5}, {5, 8}, {30, 7}, {1, 4}, {6, 6}, {4, 1}, {2, 8}};
	optla_ctx *ctx = test_ctx(NULL, 1);
	for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
		for (uint64_t seed = 0; seed < 12; seed++) {
			const size_t m = sizes[k][0], n = sizes[k][1];
			double a[256], b[32], x[8], residual;
			make_nnls((nnls_kind)_i, m, n, a, b, seed);
			ok(optla_nnls_(ctx, a, m, n, b, x, &residual));
			check_kkt(a, m, n, b, x, residual);
			const double best = brute_force(ctx, a, m, n, b);
			near_abs(residual, best,
			         1e-10); /* brute force through an SVD with rcond 1e-12: rounding grows by condition <= 1e3 here */
		}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(nnls_of_light_transport_size)
{
	/* tall and correlated as photo bases are: columns near each other, condition about 1e4 */
	optla_ctx *ctx = test_ctx(NULL, 2);
	const size_t m = 5000, n = 60;
	double *a = calloc(m * n, 8), *b = calloc(m, 8), *x = calloc(n, 8), residual;
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < m; i++) {
			const double d = (double)i / (double)m - (double)j / (double)n;
			a[j * m + i] = exp(-200 * d * d);
		}
	for (size_t i = 0; i < m; i++) b[i] = i / 500 % 2 ? 1 : 0.1;
	ok(optla_nnls_(ctx, a, m, n, b, x, &residual));
	check_kkt(a, m, n, b, x, residual);
	size_t positive = 0;
	for (size_t j = 0; j < n; j++) positive += x[j] > 0;
	ck_assert(positive > 5 && positive < n); /* both kinds of constraint occur */
	ok(optla_nnls_(ctx, a, m, n, (memset(b, 0, m * 8), b), x, &residual));
	ck_assert(residual == 0);
	for (size_t j = 0; j < n; j++) ck_assert(x[j] == 0);
	free(a);
	free(b);
	free(x);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- no memory ---- */

static optla_status use_all(optla_ctx *ctx)
{
	double a[12] = {1, 2, 3, 4, 5, 7, 7, 8, 1, 3, 1, 1}, b[8] = {1, 2, 3, 4}, x[16], s[4], u[16], vt[16];
	const double square[4] = {2, 1, 1, 3};
	OPTLA_TRY(optla_svd_(ctx, a, 4, 3, s, u, vt));
	OPTLA_TRY(optla_qr_(ctx, a, 4, 3, u, vt));
	OPTLA_TRY(optla_lstsq_(ctx, a, 4, 3, b, 1, 1e-12, x, NULL));
	OPTLA_TRY(optla_eigh_(ctx, square, 2, s, u));
	OPTLA_TRY(optla_solve_(ctx, square, 2, b, 1, x));
	OPTLA_TRY(optla_nnls_(ctx, a, 4, 3, b, x, NULL));
	OPTLA_TRY(optla_nnls_(ctx, a, 3, 4, b, x, NULL));
	return optla_dense_apply_(ctx, OPTLA_TRANSPOSE, optla_cblock_(a, 4, 3, OPTLA_F64), optla_cblock_(b, 4, 1, OPTLA_F64),
	                          optla_block_(x, 3, 1, OPTLA_F64));
}

START_TEST(every_allocation_may_fail)
{
	long k = 0;
	for (bool done = false; !done; k++) {
		alloc_budget budget = {.left = k};
		optla_ctx *ctx = NULL;
		const optla_ctx_desc d = {
		    .size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &budget, .threads = 2};
		optla_status s = optla_ctx_create(&ctx, &d);
		if (OPTLA_OK == s) s = use_all(ctx);
		optla_ctx_destroy(&ctx);
		ck_assert_msg(s == OPTLA_ERR_NOMEM || s == OPTLA_OK, "allocation %ld: %s", k, optla_status_name(s));
		ck_assert_msg(budget.live == 0, "allocation %ld: %ld blocks leak", k, budget.live);
		done = s == OPTLA_OK;
	}
	ck_assert_int_gt(k, 30);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("dense");
	TCase *t = tcase_create("dense");
	tcase_add_loop_test(t, products_at_awkward_sizes, OPTLA_F32, OPTLA_C64 + 1);
	tcase_add_loop_test(t, large_products_are_the_same_for_any_threads, OPTLA_F32, OPTLA_C64 + 1);
	tcase_add_test(t, vectors_follow_their_formulas);
	tcase_add_loop_test(t, svd_reconstructs, 0, 4);
	tcase_add_loop_test(t, qr_reconstructs, 0, 2);
	tcase_add_loop_test(t, lstsq_solves_every_shape, 0, 5);
	tcase_add_test(t, lstsq_of_nothing_is_zero);
	tcase_add_test(t, eigh_reconstructs);
	tcase_add_test(t, solve_solves_or_says_singular);
	tcase_add_loop_test(t, nnls_is_optimal, 0, NNLS_KINDS);
	tcase_add_test(t, nnls_of_light_transport_size);
	tcase_add_test(t, every_allocation_may_fail);
	tcase_set_timeout(t, 120);
	suite_add_tcase(s, t);
	return run_suite(s);
}
