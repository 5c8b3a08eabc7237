/* SPDX-License-Identifier: BSD-3-Clause */
/* Krylov methods on matrices with a known spectrum, judged by LAPACK; budgets, resuming, breakdowns, bad input. */
#include "spectrum.h"

/* ||T - D Pᵀ|| / ||T|| */
static double capture_error(const optla_krylov *run, const double *t, size_t m, size_t n)
{
	optla_cblock d, p;
	ok(optla_krylov_bases(run, &d, &p, NULL));
	double sum = 0, all = 0;
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < m; i++) {
			double x = t[i + j * m];
			all += x * x;
			for (size_t k = 0; k < d.ncols; k++) x -= optla_get_(d, i, k) * optla_get_(p, j, k);
			sum += x * x;
		}
	return all > 0 ? sqrt(sum / all) : sqrt(sum);
}

/* ||PᵀP - 1||_max */
static double orthogonality(optla_cblock p)
{
	double worst = 0;
	for (size_t i = 0; i < p.ncols; i++)
		for (size_t j = 0; j <= i; j++) worst = fmax(worst, fabs(optla_dot_(p, i, p, j) - (i == j)));
	return worst;
}

/* Triplets of a run against LAPACK's: values and vectors (up to sign) to tol of the largest value. */
static void compare_triplets(optla_ctx *ctx, const optla_krylov *run, const double *t, size_t m, size_t n, size_t wanted,
                             double tol)
{
	const size_t k = m < n ? m : n;
	double *s = malloc(k * sizeof *s), *u = malloc(m * k * sizeof *u), *vt = malloc(k * n * sizeof *vt),
	       *values = malloc(k * sizeof *values), *residual = malloc(k * sizeof *residual);
	const optla_block left = optla_block_(malloc(m * k * sizeof(double)), m, k, OPTLA_F64),
	                  right = optla_block_(malloc(n * k * sizeof(double)), n, k, OPTLA_F64);
	ok(optla_svd_(ctx, t, m, n, s, u, vt));
	ok(optla_krylov_triplets(run, values, left, right, residual));
	for (size_t j = 0; j < wanted; j++) {
		near_abs(values[j], s[j], tol * s[0]);
		double cu = 0, cv = 0;
		for (size_t i = 0; i < m; i++) cu += u[i + j * m] * optla_get_(optla_block_const(left), i, j);
		for (size_t i = 0; i < n; i++) cv += vt[j + i * k] * optla_get_(optla_block_const(right), i, j);
		near_abs(fabs(cu), 1, tol);
		near_abs(fabs(cv), 1, tol);
		near_abs(cu, cv, 2 * tol);                   /* the pair has one common sign */
		ck_assert_double_le(residual[j], tol * 100); /* a vector's error is about residual/gap, its cosine's the square */
	}
	free(s), free(u), free(vt), free(values), free(residual), free(left.data), free(right.data);
}

START_TEST(svd_agrees_with_lapack)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	const size_t shapes[][2] = {{60, 40}, {40, 60}, {30, 30}};
	double s[60];
	harmonic(s, 60);
	for (int c = 0; c < 3; c++) {
		const size_t m = shapes[c][0], n = shapes[c][1], k = m < n ? m : n;
		double *t = with_spectrum(ctx, m, n, s, k, false);
		optla_op *op = dense(ctx, t, m, n);
		optla_krylov_options o = optla_krylov_defaults;
		o.rank = (int)k;
		o.iterations =
		    (int)(n > m ? k + 1 : k); /* the first illumination, all ones, has a part outside the row space of a wide T */
		optla_krylov *run = started(op, OPTLA_KRYLOV_SVD, &o, NULL);
		ok(optla_krylov_run(run));
		compare_triplets(ctx, run, t, m, n, k, 1e-10);
		ck_assert_double_lt(capture_error(run, t, m, n), 1e-12); /* K = n: T itself, to 1e4 roundings */
		optla_krylov_destroy(&run);
		optla_op_unref(&op);
		free(t);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(leading_triplets_from_few_photos)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	double s[50];
	for (int j = 0; j < 50; j++) s[j] = pow(0.5, j);
	double *t = with_spectrum(ctx, 120, 50, s, 50, false), *ts = with_spectrum(ctx, 50, 50, s, 50, true);
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = 40;
	o.rank = 5;
	o.tolerance = 1e-12;
	for (int symmetric = 0; symmetric < 2; symmetric++) {
		optla_op *op = dense(ctx, symmetric ? ts : t, symmetric ? 50 : 120, 50);
		o.symmetric = symmetric;
		optla_krylov *run = started(op, OPTLA_KRYLOV_SVD, &o, NULL);
		ok(optla_krylov_run(run));
		const optla_krylov_info info = optla_krylov_get_info(run);
		ck_assert_int_eq(info.stop, OPTLA_STOP_TOLERANCE);
		ck_assert_uint_lt(info.iterations, 35);
		ck_assert_uint_eq(info.rank, 5);
		ck_assert_uint_eq(info.photos, info.iterations * (symmetric ? 1 : 2));
		ck_assert_double_le(info.residual, 1e-12);
		compare_triplets(ctx, run, symmetric ? ts : t, symmetric ? 50 : 120, 50, 5, 1e-10);
		optla_krylov_destroy(&run);
		optla_op_unref(&op);
	}
	free(t), free(ts);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* Repeated, zero and single values: the Krylov space ends early, the run goes on with a fresh direction until T has no more. */
START_TEST(breakdowns)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	const double repeated[6] = {1, 1, 1, 0.5, 0.5, 0.25}, one[1] = {3}, many[12] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
	             zero[1] = {0};
	const struct {
		const double *s;
		size_t count, rank;
	} cases[] = {{repeated, 6, 6}, {one, 1, 1}, {many, 12, 12}, {zero, 1, 0}};
	const optla_krylov_method methods[] = {OPTLA_KRYLOV_ARNOLDI, OPTLA_KRYLOV_SVD};
	for (size_t c = 0; c < sizeof cases / sizeof *cases; c++)
		for (int symmetric = 0; symmetric < 2; symmetric++)
			for (int w = 0; w < 2; w++) {
				const size_t m = symmetric ? 12 : 20, n = 12;
				double *t = with_spectrum(ctx, m, n, cases[c].s, cases[c].count, symmetric);
				optla_op *op = dense(ctx, t, m, n);
				optla_krylov_options o = optla_krylov_defaults;
				o.iterations = 12;
				o.symmetric = symmetric;
				optla_krylov *run = started(op, methods[w], &o, NULL);
				ok(optla_krylov_run(run));
				const optla_krylov_info info = optla_krylov_get_info(run);
				ck_assert_double_lt(capture_error(run, t, m, n), 1e-12);
				ck_assert_msg(info.stop == OPTLA_STOP_BREAKDOWN || cases[c].rank == 12, "case %zu stops by %s", c,
				              optla_stop_name(info.stop));
				/* each start brings at most one dark direction; there are as many starts as the largest multiplicity, and one to see the end */
				ck_assert_uint_le(info.iterations, cases[c].rank + 4);
				optla_cblock p;
				ok(optla_krylov_bases(run, NULL, &p, NULL));
				ck_assert_double_lt(orthogonality(p), 1e-13);
				if (w == 1 && cases[c].rank) {
					double values[12], s[12];
					ok(optla_krylov_triplets(run, values, (optla_block){.data = NULL}, (optla_block){.data = NULL}, NULL));
					ok(optla_svd_(ctx, t, m, n, s, NULL, NULL));
					near_array(values, s, cases[c].rank, 1e-12);
				}
				optla_krylov_destroy(&run);
				optla_op_unref(&op);
				free(t);
			}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(arnoldi_is_near_the_optimum)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	double s[40], tail = 0, all = 0;
	harmonic(s, 40);
	for (int j = 0; j < 40; j++) {
		all += s[j] * s[j];
		if (j >= 10) tail += s[j] * s[j];
	}
	double *t = with_spectrum(ctx, 90, 40, s, 40, false);
	optla_op *op = dense(ctx, t, 90, 40);
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = 10;
	optla_krylov *run = started(op, OPTLA_KRYLOV_ARNOLDI, &o, NULL);
	ok(optla_krylov_run(run));
	const double plain = capture_error(run, t, 90, 40), best = sqrt(tail / all);
	ck_assert_double_ge(plain, best * (1 - 1e-12));
	ck_assert_double_le(plain, 1.5 * best);
	ck_assert_uint_eq(optla_krylov_get_info(run).photos, 20); /* one product with T and one with Tᵀ each, noiseless matrix */
	optla_krylov_destroy(&run);
	/* more photos, truncated to the same rank: closer to the optimum, never better than it */
	o.iterations = 20;
	o.rank = 10;
	run = started(op, OPTLA_KRYLOV_ARNOLDI, &o, NULL);
	ok(optla_krylov_run(run));
	const double truncated = capture_error(run, t, 90, 40);
	ck_assert_double_ge(truncated, best * (1 - 1e-12));
	ck_assert_double_lt(truncated, plain);
	optla_cblock p;
	ok(optla_krylov_bases(run, NULL, &p, NULL));
	ck_assert_uint_eq(p.ncols, 10);
	ck_assert_uint_eq(optla_krylov_get_info(run).rank, 10);
	ck_assert_uint_eq(optla_krylov_get_info(run).iterations, 20);
	ck_assert_double_lt(orthogonality(p), 1e-13);
	optla_krylov_destroy(&run);
	optla_op_unref(&op);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* min over x in span(P) of ||T x - i|| by LAPACK on the same subspace. */
static double lapack_residual(optla_ctx *ctx, const optla_krylov *run, const double *i, size_t m, size_t k)
{
	optla_cblock d;
	ok(optla_krylov_bases(run, &d, NULL, NULL));
	double *y = malloc(k * sizeof *y), *a = malloc(m * k * sizeof *a), sum = 0, norm = 0;
	for (size_t j = 0; j < k; j++) memcpy(a + j * m, (const double *)d.data + j * d.ld, m * sizeof *a);
	ok(optla_lstsq_(ctx, a, m, k, i, 1, 1e-15, y, NULL));
	for (size_t l = 0; l < m; l++) {
		double r = i[l];
		for (size_t j = 0; j < k; j++) r -= a[l + j * m] * y[j];
		sum += r * r;
		norm += i[l] * i[l];
	}
	free(y), free(a);
	return sqrt(sum / norm);
}

START_TEST(gmres_residual_is_lapacks)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	double s[30];
	for (int j = 0; j < 30; j++) s[j] = 1 / (1 + 0.3 * j);
	for (int symmetric = 0; symmetric < 2; symmetric++) {
		const size_t m = symmetric ? 30 : 50;
		double *t = with_spectrum(ctx, m, 30, s, 30, symmetric), *i = random_matrix(m, 1, 5), p[30], residual;
		optla_op *op = dense(ctx, t, m, 30);
		optla_krylov_options o = optla_krylov_defaults;
		o.iterations = 12;
		o.symmetric = symmetric;
		o.tolerance = 1e-9;
		optla_krylov *run = started(op, OPTLA_KRYLOV_GMRES, &o, i);
		ok(optla_krylov_run(run));
		for (size_t k = 1; k <= 12; k++) {
			ok(optla_krylov_solution(run, k, p, &residual));
			near_rel(residual, lapack_residual(ctx, run, i, m, k), 1e-10);
		}
		const optla_krylov_info info = optla_krylov_get_info(run);
		near_rel(info.residual, residual, 1e-10);
		ck_assert_double_gt(info.noise_allowed, 0);
		ck_assert_uint_eq(info.photos, symmetric ? 12 : 24);
		/* the solution itself: T p is as far from i as it says */
		double sum = 0, norm = 0;
		for (size_t l = 0; l < m; l++) {
			double r = i[l];
			for (size_t j = 0; j < 30; j++) r -= t[l + j * m] * p[j];
			sum += r * r;
			norm += i[l] * i[l];
		}
		near_rel(sqrt(sum / norm), residual, 1e-10);
		optla_krylov_destroy(&run);
		optla_op_unref(&op);
		free(t), free(i);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(gmres_inverts_exactly_and_stops)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	double s[20], x[20], i[20], p[20], residual;
	for (int j = 0; j < 20; j++) s[j] = 1 + j % 4; /* four distinct values: the space is invariant after four steps */
	double *t = with_spectrum(ctx, 20, 20, s, 20, false);
	for (int j = 0; j < 20; j++) x[j] = cos(j);
	optla_op *op = dense(ctx, t, 20, 20);
	ok(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(x, 20, 1, OPTLA_F64), optla_block_(i, 20, 1, OPTLA_F64)));
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = 20;
	optla_krylov *run = started(op, OPTLA_KRYLOV_GMRES, &o, i);
	ok(optla_krylov_run(run));
	const optla_krylov_info info = optla_krylov_get_info(run);
	ck_assert_int_eq(info.stop, OPTLA_STOP_BREAKDOWN);
	ck_assert_uint_eq(info.iterations, 4);
	ok(optla_krylov_solution(run, 0, p, &residual));
	ck_assert_double_lt(residual, 1e-12);
	near_array(p, x, 20, 1e-12);
	optla_krylov_destroy(&run);
	optla_op_unref(&op);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(nonnegative_solutions)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	double s[12], i[40], p[12], residual[3];
	harmonic(s, 12);
	double *t = with_spectrum(ctx, 40, 12, s, 12, false), *noise = random_matrix(40, 1, 9);
	memcpy(i, noise, sizeof i); /* any target: its solution has both signs */
	optla_op *op = dense(ctx, t, 40, 12);
	for (int how = 0; how < 3; how++) {
		optla_krylov_options o = optla_krylov_defaults;
		o.iterations = 12;
		o.nonnegative = (optla_nonnegative)how;
		optla_krylov *run = started(op, OPTLA_KRYLOV_GMRES, &o, i);
		ok(optla_krylov_run(run));
		ok(optla_krylov_solution(run, 0, p, &residual[how]));
		double least = 0;
		for (int j = 0; j < 12; j++) least = fmin(least, p[j]);
		if (how == OPTLA_NONNEGATIVE_NONE)
			ck_assert_double_lt(least, -1e-3);
		else
			ck_assert_double_ge(least, 0);
		if (how ==
		    OPTLA_NONNEGATIVE_NNLS) { /* K = n: the optimum over all of p >= 0; gradient Tᵀ(T p - i) >= 0, = 0 where p > 0 */
			for (int j = 0; j < 12; j++) {
				double g = 0;
				for (int l = 0; l < 40; l++) {
					double r = -i[l];
					for (int k = 0; k < 12; k++) r += t[l + k * 40] * p[k];
					g += t[l + j * 40] * r;
				}
				ck_assert_double_ge(g, -1e-9);
				if (p[j] > 1e-9) near_abs(g, 0, 1e-9);
			}
		}
		optla_krylov_destroy(&run);
	}
	ck_assert_double_le(residual[0], residual[2]);
	ck_assert_double_le(residual[2], residual[1]);
	optla_op_unref(&op);
	free(t), free(noise);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(nonnegative_light_makes_the_photo)
{
	/* 12 photos for 60 lights, all singular values alike: most of a light pattern was never photographed. What is sent out must make
	   the target's photo all the same; minimising ||D P' p - i|| alone over p >= 0 misses it by more than its own size. */
	enum { M = 80, N = 60, K = 12 };
	optla_ctx *ctx = test_ctx(NULL, 0);
	double s[N], light[N], i[M] = {0}, p[N], error[3];
	for (int j = 0; j < N; j++) {
		s[j] = 1 - 0.005 * j;
		light[j] = exp(-0.02 * (j - 25) * (j - 25));
	}
	double *t = with_spectrum(ctx, M, N, s, N, false);
	for (int j = 0; j < N; j++)
		for (int m = 0; m < M; m++) i[m] += t[m + j * M] * light[j];
	optla_op *op = dense(ctx, t, M, N);
	for (int how = 0; how < 3; how++) {
		optla_krylov_options o = optla_krylov_defaults;
		o.iterations = K;
		o.nonnegative = (optla_nonnegative)how;
		optla_krylov *run = started(op, OPTLA_KRYLOV_GMRES, &o, i);
		double norm = 0, difference = 0;
		ok(optla_krylov_run(run));
		ok(optla_krylov_solution(run, K, p, NULL));
		for (int m = 0; m < M; m++) {
			double r = -i[m];
			for (int j = 0; j < N; j++) r += t[m + j * M] * p[j];
			difference += r * r;
			norm += i[m] * i[m];
		}
		for (int j = 0; j < N && how == OPTLA_NONNEGATIVE_NNLS; j++) ck_assert_double_ge(p[j], 0);
		error[how] = sqrt(difference / norm);
		optla_krylov_destroy(&run);
	}
	/* GMRES finds the light here to 1e-6, of which the constraint may cost some */
	ck_assert_double_lt(error[OPTLA_NONNEGATIVE_NONE], 1e-5);
	ck_assert_double_lt(error[OPTLA_NONNEGATIVE_NNLS], 2 * error[OPTLA_NONNEGATIVE_NONE] + 1e-7);
	optla_op_unref(&op);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(power_finds_the_principal_vector)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	double s[16], v[16], value;
	for (int j = 0; j < 16; j++) s[j] = pow(0.6, j);
	for (int symmetric = 0; symmetric < 2; symmetric++) {
		const size_t m = symmetric ? 16 : 25;
		double *t = with_spectrum(ctx, m, 16, s, 16, symmetric), u[16 * 25], vt[16 * 16], sv[16];
		optla_op *op = dense(ctx, t, m, 16);
		optla_krylov_options o = optla_krylov_defaults;
		o.iterations = 200;
		o.symmetric = symmetric;
		o.tolerance = 1e-12;
		optla_krylov *run = started(op, OPTLA_KRYLOV_POWER, &o, NULL);
		ok(optla_krylov_run(run));
		const optla_krylov_info info = optla_krylov_get_info(run);
		ck_assert_int_eq(info.stop, OPTLA_STOP_TOLERANCE);
		ok(optla_krylov_principal(run, v, &value));
		ok(optla_svd_(ctx, t, m, 16, sv, u, vt));
		near_rel(value, sv[0], 1e-11);
		double c = 0;
		for (int j = 0; j < 16; j++) c += v[j] * vt[j * 16];
		near_abs(fabs(c), 1, 1e-12);
		optla_krylov_destroy(&run);
		optla_op_unref(&op);
		free(t);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

/* |T| entries: a transport that a projector could have. */
static double *positive_matrix(size_t m, size_t n)
{
	double *t = random_matrix(m, n, 3);
	for (size_t k = 0; k < m * n; k++) t[k] = fabs(t[k]) * exp(-0.3 * (double)(k / m));
	return t;
}

START_TEST(photos_are_counted_and_budgeted)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	double *t = positive_matrix(40, 24);
	double directions[2][24 * 12];
	for (int split = 0; split < 2; split++) {
		optla_op *matrix = dense(ctx, t, 40, 24), *op;
		ok(optla_op_signed(matrix, (optla_split)split, &op));
		optla_krylov_options o = optla_krylov_defaults;
		o.iterations = 12;
		optla_krylov *run = started(op, OPTLA_KRYLOV_ARNOLDI, &o, NULL);
		ok(optla_krylov_run(run));
		/* 4K by sign; 2K and the ones and dark frames of both directions by offset */
		ck_assert_uint_eq(optla_krylov_get_info(run).photos, split == OPTLA_SPLIT_SIGNED ? 48 : 24 + 4);
		optla_cblock p;
		ok(optla_krylov_bases(run, NULL, &p, NULL));
		for (size_t k = 0; k < 12; k++) optla_copy_column_(p, k, optla_block_(directions[split], 24, 12, OPTLA_F64), k);
		optla_krylov_destroy(&run);
		for (int budget = 1; budget < 50; budget += 3) {
			optla_op *light = dense(ctx, t, 40, 24), *pair;
			ok(optla_op_signed(light, (optla_split)split, &pair));
			o.max_photos = budget;
			run = started(pair, OPTLA_KRYLOV_ARNOLDI, &o, NULL);
			ok(optla_krylov_run(run));
			const optla_krylov_info info = optla_krylov_get_info(run);
			ck_assert_uint_le(info.photos, budget);
			ck_assert_uint_eq(info.photos, optla_op_cost_so_far(pair).photos);
			if (info.iterations < 12) ck_assert_int_eq(info.stop, OPTLA_STOP_PHOTOS);
			ck_assert_double_gt(info.residual, 0); /* T has rank 24: what wasn't photographed isn't solved */
			optla_krylov_destroy(&run);
			optla_op_unref(&light);
			optla_op_unref(&pair);
		}
		optla_op_unref(&matrix);
		optla_op_unref(&op);
	}
	near_array(directions[1], directions[0], 24 * 12, 1e-9); /* the same subspace, direction by direction */
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(high_resolution_photos_come_along)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	double *t = positive_matrix(40, 10), low[20 * 10], pair[40];
	uint64_t start[21];
	uint32_t column[40];
	for (size_t m = 0; m < 20; m++) { /* reduce: mean of two neighbours */
		start[m] = 2 * m;
		column[2 * m] = (uint32_t)(2 * m);
		column[2 * m + 1] = (uint32_t)(2 * m + 1);
		pair[2 * m] = pair[2 * m + 1] = 0.5;
		for (size_t n = 0; n < 10; n++) low[m + n * 20] = 0.5 * (t[2 * m + n * 40] + t[2 * m + 1 + n * 40]);
	}
	start[20] = 40;
	optla_op *op = dense(ctx, low, 20, 10), *high = dense(ctx, t, 40, 10), *reduce;
	ok(optla_op_sparse(ctx, 20, 40, start, column, optla_cblock_(pair, 40, 1, OPTLA_F64), &reduce));
	const optla_krylov_problem problem = {.size = sizeof problem, .op = op, .high = high, .reduce = reduce};
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = 6;
	optla_krylov *run, *plain = started(op, OPTLA_KRYLOV_ARNOLDI, &o, NULL);
	ok(optla_krylov_create(&problem, OPTLA_KRYLOV_ARNOLDI, &o, &run));
	ok(optla_krylov_run(run));
	ok(optla_krylov_run(plain));
	ck_assert_uint_eq(optla_krylov_get_info(run).photos, optla_krylov_get_info(plain).photos);
	optla_cblock p, h, p2;
	ok(optla_krylov_bases(run, NULL, &p, &h));
	ok(optla_krylov_bases(plain, NULL, &p2, NULL));
	for (size_t k = 0; k < 6; k++)
		for (size_t m = 0; m < 40; m++) {
			double x = 0; /* h_k = T_high p_k (Eq. 2.10) */
			for (size_t n = 0; n < 10; n++) x += t[m + n * 40] * optla_get_(p, n, k);
			near_abs(optla_get_(h, m, k), x, 1e-12);
			if (m < 10) near_abs(optla_get_(p, m, k), optla_get_(p2, m, k), 1e-11);
		}
	optla_krylov_destroy(&run);
	optla_krylov_destroy(&plain);
	optla_op_unref(&op);
	optla_op_unref(&high);
	optla_op_unref(&reduce);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(bad_input_is_named)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 0);
	double *t = positive_matrix(8, 6), target[8] = {0};
	optla_op *op = dense(ctx, t, 8, 6);
	optla_krylov_problem problem = {.size = sizeof problem, .op = op};
	optla_krylov_options o = optla_krylov_defaults;
	optla_krylov *run;
	o.iterations = 7;
	status_is(optla_krylov_create(&problem, OPTLA_KRYLOV_ARNOLDI, &o, &run), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text,
	                 "7 iterations are wanted, but a 8 x 6 operator has only 6 independent illuminations: ask for no more");
	o.iterations = 4;
	o.symmetric = true;
	status_is(optla_krylov_create(&problem, OPTLA_KRYLOV_ARNOLDI, &o, &run), OPTLA_ERR_SHAPE);
	o.symmetric = false;
	status_is(optla_krylov_create(&problem, OPTLA_KRYLOV_GMRES, &o, &run), OPTLA_ERR_ARG);
	problem.target = target;
	status_is(optla_krylov_create(&problem, OPTLA_KRYLOV_GMRES, &o, &run), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "the target photo is zero everywhere");
	target[3] = NAN;
	status_is(optla_krylov_create(&problem, OPTLA_KRYLOV_GMRES, &o, &run), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "the target photo holds NaN or infinity");
	o.rank = 5;
	status_is(optla_krylov_create(&problem, OPTLA_KRYLOV_ARNOLDI, &o, &run), OPTLA_ERR_ARG);
	o.rank = 0;
	o.tolerance = -1;
	status_is(optla_krylov_create(&problem, OPTLA_KRYLOV_ARNOLDI, &o, &run), OPTLA_ERR_ARG);
	ck_assert_ptr_null(run);
	optla_op_unref(&op);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

static bool stop_at_five(void *user, const optla_progress_event *event)
{
	(void)user;
	return event->done < 5;
}

START_TEST(cancelling_keeps_whole_iterations)
{
	optla_ctx *ctx;
	const optla_ctx_desc d = {.size = sizeof d, .progress = stop_at_five};
	ok(optla_ctx_create(&ctx, &d));
	double *t = positive_matrix(20, 16);
	optla_op *op = dense(ctx, t, 20, 16);
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = 16;
	optla_krylov *run = started(op, OPTLA_KRYLOV_ARNOLDI, &o, NULL);
	status_is(optla_krylov_run(run), OPTLA_ERR_CANCELLED);
	const optla_krylov_info info = optla_krylov_get_info(run);
	ck_assert_int_eq(info.stop, OPTLA_STOP_CANCELLED);
	ck_assert_uint_eq(info.iterations, 5);
	ck_assert_uint_eq(info.rank, 5);
	optla_krylov_destroy(&run);
	optla_op_unref(&op);
	free(t);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(same_bytes_for_any_number_of_threads)
{
	double *t = positive_matrix(5000, 40), first[40 * 10];
	const int threads[] = {1, 2, 7};
	for (int w = 0; w < 3; w++) {
		optla_ctx *ctx = test_ctx(NULL, threads[w]);
		optla_op *op = dense(ctx, t, 5000, 40);
		optla_krylov_options o = optla_krylov_defaults;
		o.iterations = 10;
		optla_krylov *run = started(op, OPTLA_KRYLOV_SVD, &o, NULL);
		ok(optla_krylov_run(run));
		optla_cblock p;
		ok(optla_krylov_bases(run, NULL, &p, NULL));
		if (!w)
			memcpy(first, p.data, sizeof first);
		else
			ck_assert(!memcmp(first, p.data, sizeof first));
		optla_krylov_destroy(&run);
		optla_op_unref(&op);
		optla_ctx_destroy(&ctx);
	}
	free(t);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
	double *t = positive_matrix(8, 6), target[8] = {1, 2, 3, 4, 5, 6, 7, 8};
	for (int method = OPTLA_KRYLOV_POWER; method <= OPTLA_KRYLOV_SVD; method++)
		for (long k = 0;; k++) {
			alloc_budget b = {.left = k};
			const optla_ctx_desc d = {
			    .size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b, .threads = 1};
			optla_ctx *ctx;
			optla_op *op = NULL;
			optla_krylov *run = NULL;
			optla_krylov_options o = optla_krylov_defaults;
			o.iterations = 4;
			o.rank = 2;
			optla_status s = optla_ctx_create(&ctx, &d);
			if (!s) s = optla_op_dense(ctx, optla_cblock_(t, 8, 6, OPTLA_F64), true, &op);
			const optla_krylov_problem problem = {.size = sizeof problem, .op = op, .target = target};
			if (!s) s = optla_krylov_create(&problem, (optla_krylov_method)method, &o, &run);
			if (!s) s = optla_krylov_run(run);
			optla_krylov_destroy(&run);
			optla_op_unref(&op);
			optla_ctx_destroy(&ctx);
			ck_assert_int_eq(b.live, 0);
			if (!s) break;
			ck_assert_int_eq(s, OPTLA_ERR_NOMEM);
		}
	free(t);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("krylov");
	TCase *t = tcase_create("krylov");
	tcase_set_timeout(t, 60);
	tcase_add_test(t, svd_agrees_with_lapack);
	tcase_add_test(t, leading_triplets_from_few_photos);
	tcase_add_test(t, breakdowns);
	tcase_add_test(t, arnoldi_is_near_the_optimum);
	tcase_add_test(t, gmres_residual_is_lapacks);
	tcase_add_test(t, gmres_inverts_exactly_and_stops);
	tcase_add_test(t, nonnegative_solutions);
	tcase_add_test(t, nonnegative_light_makes_the_photo);
	tcase_add_test(t, power_finds_the_principal_vector);
	tcase_add_test(t, photos_are_counted_and_budgeted);
	tcase_add_test(t, high_resolution_photos_come_along);
	tcase_add_test(t, bad_input_is_named);
	tcase_add_test(t, cancelling_keeps_whole_iterations);
	tcase_add_test(t, same_bytes_for_any_number_of_threads);
	tcase_add_test(t, every_allocation_may_fail);
	suite_add_tcase(s, t);
	return run_suite(s);
}
