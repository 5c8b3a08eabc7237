/* SPDX-License-Identifier: BSD-3-Clause */
/* Krylov runs on disk: saved, resumed, spoiled. */
#include "krylov/run.h"
#include "spectrum.h"

#include <unistd.h>

static void same_columns(optla_cblock a, optla_cblock b)
{
	ck_assert_uint_eq(a.ncols, b.ncols);
	for (size_t k = 0; k < a.ncols; k++)
		for (size_t m = 0; m < a.nrows; m++) ck_assert(optla_get_(a, m, k) == optla_get_(b, m, k));
}

START_TEST(a_resumed_run_is_the_uninterrupted_one)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	double s[20], *target = random_matrix(30, 1, 8);
	harmonic(s, 20);
	double *t = with_spectrum(ctx, 30, 20, s, 20, false);
	optla_op *op = dense(ctx, t, 30, 20);
	char path[] = "/tmp/optla_krylov_XXXXXX";
	ck_assert_int_ge(mkstemp(path), 0);
	const optla_krylov_method methods[] = {OPTLA_KRYLOV_ARNOLDI, OPTLA_KRYLOV_SVD, OPTLA_KRYLOV_GMRES};
	for (int w = 0; w < 3; w++) {
		optla_krylov_options o = optla_krylov_defaults;
		const optla_krylov_problem problem = {.size = sizeof problem, .op = op, .target = target};
		o.iterations = 12;
		optla_krylov *whole = started(op, methods[w], &o, target), *part, *rest;
		ok(optla_krylov_run(whole));
		o.iterations = 5;
		part = started(op, methods[w], &o, target);
		ok(optla_krylov_run(part));
		ok(optla_krylov_save(part, path));
		o.iterations = 12;
		ok(optla_krylov_resume(&problem, &o, path, &rest));
		ok(optla_krylov_run(rest));
		optla_cblock d[2], p[2];
		ok(optla_krylov_bases(whole, &d[0], &p[0], NULL));
		ok(optla_krylov_bases(rest, &d[1], &p[1], NULL));
		same_columns(d[0], d[1]);
		same_columns(p[0], p[1]);
		const optla_krylov_info a = optla_krylov_get_info(whole), b = optla_krylov_get_info(rest);
		ck_assert_uint_eq(a.photos, b.photos);
		ck_assert(a.residual == b.residual);
		if (methods[w] != OPTLA_KRYLOV_GMRES) { /* nothing left to photograph: the result is that of the options given now */
			optla_krylov *same;
			o.iterations = 5;
			o.rank = 3;
			ok(optla_krylov_resume(&problem, &o, path, &same));
			ok(optla_krylov_run(same));
			ck_assert_int_eq(optla_krylov_get_info(same).stop, OPTLA_STOP_ITERATIONS);
			ok(optla_krylov_bases(same, &d[1], NULL, NULL));
			ck_assert_uint_eq(d[1].ncols, 3);
			optla_krylov_destroy(&same);
		}
		if (methods[w] == OPTLA_KRYLOV_GMRES) { /* another target is another run */
			target[0] += 1;
			optla_krylov *wrong;
			status_is(optla_krylov_resume(&problem, &o, path, &wrong), OPTLA_ERR_ARG);
			ck_assert_ptr_null(wrong);
		}
		optla_krylov_destroy(&whole);
		optla_krylov_destroy(&part);
		optla_krylov_destroy(&rest);
	}
	unlink(path);
	optla_op_unref(&op);
	free(t), free(target);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* The file cut off after each 97th byte: always an error. */
START_TEST(spoiled_files_are_errors)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 0);
	double s[6];
	harmonic(s, 6);
	double *t = with_spectrum(ctx, 8, 6, s, 6, false);
	optla_op *op = dense(ctx, t, 8, 6);
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = 3;
	optla_krylov *run = started(op, OPTLA_KRYLOV_ARNOLDI, &o, NULL), *again;
	ok(optla_krylov_run(run));
	char path[] = "/tmp/optla_krylov_XXXXXX";
	ck_assert_int_ge(mkstemp(path), 0);
	ok(optla_krylov_save(run, path));
	FILE *f = fopen(path, "rb");
	char *bytes = malloc(1 << 20);
	const size_t count = fread(bytes, 1, 1 << 20, f);
	fclose(f);
	ck_assert_uint_gt(count, 1000);
	const optla_krylov_problem problem = {.size = sizeof problem, .op = op};
	for (size_t cut = 0; cut < count; cut += 97) {
		f = fopen(path, "wb");
		ck_assert_uint_eq(fwrite(bytes, 1, cut, f), cut);
		fclose(f);
		status_is(optla_krylov_resume(&problem, &o, path, &again), OPTLA_ERR_INPUT);
		ck_assert_ptr_null(again);
	}
	/* fewer iterations than the file holds; another kind of run; another operator */
	ok(optla_krylov_save(run, path));
	o.iterations = 2;
	status_is(optla_krylov_resume(&problem, &o, path, &again), OPTLA_ERR_ARG);
	ck_assert_ptr_nonnull(strstr(e.text, "has 3 iterations already"));
	o.iterations = 3;
	optla_op *other = dense(ctx, t, 6, 6);
	const optla_krylov_problem wrong = {.size = sizeof wrong, .op = other};
	status_is(optla_krylov_resume(&wrong, &o, path, &again), OPTLA_ERR_INPUT);
	ck_assert_ptr_nonnull(strstr(e.text, "this run needs"));
	status_is(optla_krylov_resume(&problem, &o, "/no/such/file.h5", &again), OPTLA_ERR_INPUT);
	ck_assert_ptr_null(again);
	unlink(path);
	free(bytes), free(t);
	optla_krylov_destroy(&run);
	optla_op_unref(&op);
	optla_op_unref(&other);
	optla_ctx_destroy(&ctx);
}
END_TEST

static optla_ctx *budget_ctx(error_store *e, alloc_budget *b)
{
	const optla_ctx_desc d = {.size = sizeof d,
	                          .alloc = budget_alloc,
	                          .free = budget_free,
	                          .alloc_user = b,
	                          .error = error_keep,
	                          .error_user = e,
	                          .threads = 1};
	optla_ctx *ctx;
	ok(optla_ctx_create(&ctx, &d));
	return ctx;
}

/* Power iteration keeps one column only: the vector and its value must go on as if nothing had been between. */
START_TEST(a_resumed_power_iteration_is_the_uninterrupted_one)
{
	for (int symmetric = 0; symmetric <= 1; symmetric++) {
		optla_ctx *ctx = test_ctx(NULL, 0);
		double s[10], v[2][10], value[2];
		harmonic(s, 10);
		double *t = with_spectrum(ctx, 10, 10, s, 10, symmetric);
		optla_op *op = dense(ctx, t, 10, 10);
		const optla_krylov_problem problem = {.size = sizeof problem, .op = op};
		optla_krylov_options o = optla_krylov_defaults;
		o.symmetric = symmetric;
		o.iterations = 9;
		optla_krylov *whole = started(op, OPTLA_KRYLOV_POWER, &o, NULL), *rest;
		ok(optla_krylov_run(whole));
		o.iterations = 4;
		optla_krylov *part = started(op, OPTLA_KRYLOV_POWER, &o, NULL);
		ok(optla_krylov_run(part));
		char path[] = "/tmp/optla_krylov_XXXXXX";
		ck_assert_int_ge(mkstemp(path), 0);
		ok(optla_krylov_save(part, path));
		o.iterations = 9;
		ok(optla_krylov_resume(&problem, &o, path, &rest));
		ck_assert_uint_eq(optla_krylov_get_info(rest).iterations, 4);
		ok(optla_krylov_run(rest));
		ok(optla_krylov_principal(whole, v[0], &value[0]));
		ok(optla_krylov_principal(rest, v[1], &value[1]));
		ck_assert(!memcmp(v[0], v[1], sizeof v[0]));
		ck_assert(value[0] == value[1]);
		const optla_krylov_info a = optla_krylov_get_info(whole), b = optla_krylov_get_info(rest);
		ck_assert_uint_eq(a.photos, b.photos);
		ck_assert_uint_eq(b.iterations, 9);
		ck_assert(a.residual == b.residual);
		unlink(path);
		free(t);
		optla_krylov_destroy(&whole), optla_krylov_destroy(&part), optla_krylov_destroy(&rest);
		optla_op_unref(&op);
		optla_ctx_destroy(&ctx);
	}
}
END_TEST

/* Every number of a state spoiled in turn: the error names file and number. Whole files are written, so the size is right. */
START_TEST(spoiled_numbers_are_errors)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 0);
	double s[6], target[8] = {1, 2, 3, 4, 5, 6, 7, 8};
	harmonic(s, 6);
	double *t = with_spectrum(ctx, 8, 6, s, 6, false);
	optla_op *op = dense(ctx, t, 8, 6);
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = 3;
	const optla_krylov_problem problem = {.size = sizeof problem, .op = op, .target = target};
	char path[] = "/tmp/optla_krylov_XXXXXX";
	ck_assert_int_ge(mkstemp(path), 0);
	for (int method = OPTLA_KRYLOV_POWER; method <= OPTLA_KRYLOV_SVD; method++) {
		optla_krylov *run = started(op, (optla_krylov_method)method, &o, target), *again;
		ok(optla_krylov_run(run));
		const struct {
			const char *name;
			double *at;
			bool negative; /* allowed */
		} numbers[] = {{"residual[1]", run->residuals + 1, false},
		               {"noise[2]", run->noise + 2, false},
		               {"energy[0]", run->energy, false},
		               {"gap[1]", run->gaps ? run->gaps + 1 : NULL, false},
		               {"target_in_basis[1]", run->qt ? run->qt + 1 : NULL, true},
		               {"triangle[7]", run->qr ? run->qr + 2 * run->kmax + 1 : NULL, true},
		               {"scale", &run->scale, false},
		               {"first", &run->first, false},
		               {"value", &run->value, true},
		               {"exposure_s", &run->exposure_s, false}};
		const double wrong[] = {NAN, INFINITY, -INFINITY, -1};
		for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++)
			for (size_t w = 0; numbers[n].at && w < 4; w++) {
				const bool allowed = (3 == w && numbers[n].negative) ||
				                     (1 == w && OPTLA_KRYLOV_POWER == method && numbers[n].at == run->residuals + 1);
				const double kept = *numbers[n].at;
				*numbers[n].at = wrong[w];
				ok(optla_krylov_save(run, path));
				*numbers[n].at = kept;
				status_is(optla_krylov_resume(&problem, &o, path, &again), allowed ? OPTLA_OK : OPTLA_ERR_INPUT);
				ck_assert_msg(allowed || (strstr(e.text, path) && strstr(e.text, numbers[n].name)), "%s: message: %s",
				              numbers[n].name, e.text);
				optla_krylov_destroy(&again);
			}
		optla_krylov_destroy(&run);
	}
	unlink(path);
	free(t);
	optla_op_unref(&op);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
	error_store e = {0};
	alloc_budget b = {.left = 1 << 30};
	optla_ctx *ctx = budget_ctx(&e, &b);
	double s[6], target[8] = {1, 2, 3, 4, 5, 6, 7, 8};
	harmonic(s, 6);
	double *t = with_spectrum(ctx, 8, 6, s, 6, false);
	optla_op *op = dense(ctx, t, 8, 6);
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = 3;
	const optla_krylov_problem problem = {.size = sizeof problem, .op = op, .target = target};
	char path[] = "/tmp/optla_krylov_XXXXXX";
	ck_assert_int_ge(mkstemp(path), 0);
	for (int method = OPTLA_KRYLOV_POWER; method <= OPTLA_KRYLOV_SVD; method++) {
		b.left = 1 << 30;
		optla_krylov *run = started(op, (optla_krylov_method)method, &o, target), *again = NULL;
		ok(optla_krylov_run(run));
		ok(optla_krylov_save(run, path)); /* the file is there when its successor fails */
		for (int resume = 0; resume <= 1; resume++) {
			long failures = 0;
			for (long k = 0;; k++) {
				const long before = b.live;
				b.left = k;
				const optla_status got = resume ? optla_krylov_resume(&problem, &o, path, &again) : optla_krylov_save(run, path);
				const bool whole = b.left >= 0; /* none was refused, not even one whose failure is no error */
				if (got) {
					status_is(got, OPTLA_ERR_NOMEM);
					ck_assert_ptr_null(again);
					failures++;
				}
				if (whole) ok(got);
				optla_krylov_destroy(&again);
				if (!resume) ck_assert_int_eq(b.live, before); /* files that were read stay noted in the context */
				if (whole) break;
			}
			ck_assert_int_ge(failures, 3);
		}
		optla_krylov_destroy(&run);
	}
	unlink(path);
	free(t);
	optla_op_unref(&op);
	optla_ctx_destroy(&ctx);
	ck_assert_int_eq(b.live, 0);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("krylov_state");
	TCase *t = tcase_create("krylov_state");
	tcase_set_timeout(t, 60);
	tcase_add_test(t, a_resumed_run_is_the_uninterrupted_one);
	tcase_add_test(t, a_resumed_power_iteration_is_the_uninterrupted_one);
	tcase_add_test(t, spoiled_files_are_errors);
	tcase_add_test(t, spoiled_numbers_are_errors);
	tcase_add_test(t, every_allocation_may_fail);
	suite_add_tcase(s, t);
	return run_suite(s);
}
