/* SPDX-License-Identifier: BSD-3-Clause */
/* Krylov runs on disk: saved, resumed, spoiled. */
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

int main(void)
{
	Suite *s = suite_create("krylov_state");
	TCase *t = tcase_create("krylov_state");
	tcase_set_timeout(t, 60);
	tcase_add_test(t, a_resumed_run_is_the_uninterrupted_one);
	tcase_add_test(t, spoiled_files_are_errors);
	suite_add_tcase(s, t);
	return run_suite(s);
}
