/* SPDX-License-Identifier: BSD-3-Clause */
/* The context, memory, random numbers and option tables. */
#include "base/base_impl.h"
#include "base/random.h"
#include "near.h"

#include <locale.h>

START_TEST(context_defaults)
{
	optla_ctx *ctx;
	ok(optla_ctx_create(&ctx, NULL));
	ck_assert_int_ge(optla_ctx_threads(ctx), 1);
	ck_assert_str_eq(optla_ctx_last_error(ctx), "");
	optla_ctx_destroy(&ctx);
	ck_assert_ptr_null(ctx);
	optla_ctx_destroy(&ctx);
	const optla_ctx_desc wrong = {.size = 1};
	status_is(optla_ctx_create(&ctx, &wrong), OPTLA_ERR_ARG);
}
END_TEST

START_TEST(memory_limit_is_an_error_with_values)
{
	error_store e = {0};
	optla_ctx *ctx;
	const optla_ctx_desc d = {.size = sizeof d, .error = error_keep, .error_user = &e, .memory_limit_bytes = 1024};
	ok(optla_ctx_create(&ctx, &d));
	ck_assert_ptr_null(optla_array_(ctx, 1025, 1));
	ck_assert_int_eq(e.code, OPTLA_ERR_NOMEM);
	ck_assert_ptr_null(optla_array_(ctx, SIZE_MAX / 2, 4));
	ck_assert_ptr_nonnull(strstr(e.text, "does not fit"));
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(random_numbers_have_their_moments)
{
	/* n = 1e5: standard error of a mean is sd/sqrt(n), of a variance var*sqrt((kurtosis+2)/n); 5 standard errors. */
	const optla_rand r = {.seed = 7, .stream_hi = OPTLA_RAND_TEST};
	const double means[] = {0.3, 4, 9.99, 10, 30, 1e3, 1e6};
	const int n = 100000;
	for (size_t m = 0; m < sizeof means / sizeof *means; m++) {
		double sum = 0, sq = 0;
		for (int k = 0; k < n; k++) {
			const double x = optla_rand_poisson_(r, m, (uint32_t)k, 0, means[m]) - means[m];
			sum += x;
			sq += x * x;
		}
		const double mu = means[m];
		near_abs(sum / n, 0, 5 * sqrt(mu / n));
		near_abs(sq / n, mu, 5 * mu * sqrt((2 + 1 / mu) / n));
	}
	double sum = 0, sq = 0;
	for (int k = 0; k < n; k++) {
		const double x = optla_rand_normal_(r, 99, (uint32_t)k, 0);
		sum += x;
		sq += x * x;
	}
	near_abs(sum / n, 0, 5 / sqrt(n));
	near_abs(sq / n, 1, 5 * sqrt(2.0 / n));
}
END_TEST

START_TEST(poisson_distribution_chi_square)
{
	/* Mean 12 exercises the rejection method: 30 cells with expectation > 5, 99.99 % quantile of chi-square(30) is 67. */
	const optla_rand r = {.seed = 11, .stream_hi = OPTLA_RAND_TEST};
	enum { CELLS = 31 };
	double expected[CELLS], seen[CELLS] = {0}, tail = 1, chi2 = 0;
	const int n = 200000;
	for (int k = 0; k < CELLS - 1; k++) {
		expected[k] = exp(k * log(12.0) - 12 - lgamma(k + 1.0));
		tail -= expected[k];
	}
	expected[CELLS - 1] = tail;
	for (int k = 0; k < n; k++) {
		const double x = optla_rand_poisson_(r, 5, (uint32_t)k, 0, 12);
		seen[x < CELLS - 1 ? (int)x : CELLS - 1]++;
	}
	for (int k = 0; k < CELLS; k++) chi2 += pow(seen[k] - n * expected[k], 2) / fmax(n * expected[k], 1);
	ck_assert_double_lt(chi2, 67);
}
END_TEST

typedef struct {
	size_t size;
	int count;
	double share;
	int kind;
	bool loud;
	const char *file;
} sample_options;

static const sample_options sample_defaults = {.size = sizeof(sample_options), .count = 3, .share = 0.5};
static const optla_option sample_fields[] = {
    {"count", offsetof(sample_options, count), OPTLA_OPTION_INT, "", 1, 10, NULL, "how many"},
    {"share", offsetof(sample_options, share), OPTLA_OPTION_DOUBLE, "", 0, 1, NULL, "how much"},
    {"kind", offsetof(sample_options, kind), OPTLA_OPTION_ENUM, "", 0, 0, "red|green|greenish", "which"},
    {"loud", offsetof(sample_options, loud), OPTLA_OPTION_BOOL, "", 0, 0, NULL, "or not"},
    {"file", offsetof(sample_options, file), OPTLA_OPTION_STRING, "FILE", 0, 0, NULL, "a file"},
};
static const optla_option_table sample_table = {"sample", sizeof(sample_options), &sample_defaults, sample_fields, 5};

START_TEST(options_are_checked_and_named)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	sample_options o = sample_defaults;
	ok(optla_options_check(ctx, &sample_table, &o));
	o.share = NAN;
	status_is(optla_options_check(ctx, &sample_table, &o), OPTLA_ERR_ARG);
	ck_assert_ptr_nonnull(strstr(e.text, "option 'share' is nan"));
	o = sample_defaults;
	status_is(optla_option_set(ctx, &sample_table, &o, "count", "11"), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "option 'count': '11' is not a whole number from 1 to 10");
	status_is(optla_option_set(ctx, &sample_table, &o, "kind", "gre"), OPTLA_ERR_ARG);
	ok(optla_option_set(ctx, &sample_table, &o, "kind", "greenish"));
	ck_assert_int_eq(o.kind, 2);
	char text[64];
	ck_assert_str_eq(optla_option_format(&sample_fields[2], &o, text, sizeof text), "greenish");
	o.kind = 0;
	ck_assert_str_eq(optla_option_format(&sample_fields[2], &o, text, sizeof text), "red");
	ok(optla_option_set(ctx, &sample_table, &o, "loud", "true"));
	ck_assert(o.loud);
	status_is(optla_option_set(ctx, &sample_table, &o, "colour", "x"), OPTLA_ERR_ARG);
	o.size = 3;
	status_is(optla_options_check(ctx, &sample_table, &o), OPTLA_ERR_ARG);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(every_allocation_of_the_context_may_fail)
{
	alloc_budget b = {0};
	for (long k = 0;; k++) {
		b = (alloc_budget){.left = k};
		const optla_ctx_desc d = {.size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b};
		optla_ctx *ctx;
		optla_status s = optla_ctx_create(&ctx, &d);
		char *text = NULL;
		if (!s) s = optla_ctx_set_provenance(ctx, "optla test", 5, "2026-01-01");
		if (!s) s = optla_ctx_provenance(ctx, &text);
		if (text) {
			ck_assert_ptr_nonnull(strstr(text, "command: optla test\n"));
			optla_free(ctx, text);
		}
		optla_ctx_destroy(&ctx);
		ck_assert_int_eq(b.live, 0);
		if (!s) break;
		ck_assert_int_eq(s, OPTLA_ERR_NOMEM);
	}
}
END_TEST

static void count_error(void *user, optla_status code, const char *where, const char *message)
{
	(void)code;
	(void)where;
	(void)message;
	++*(int *)user; /* plain: the context's lock guards it */
}

static bool count_progress(void *user, const optla_progress_event *event)
{
	(void)event;
	++*(int *)user;
	return true;
}

START_TEST(handlers_and_allocator_are_called_by_one_thread_at_a_time)
{
	enum { N = 20000 };
	int errors = 0, reports = 0;
	alloc_budget b = {.left = 10L * N};
	const optla_ctx_desc d = {.size = sizeof d,
	                          .error = count_error,
	                          .error_user = &errors,
	                          .progress = count_progress,
	                          .progress_user = &reports,
	                          .alloc = budget_alloc,
	                          .free = budget_free,
	                          .alloc_user = &b};
	optla_ctx *ctx;
	ok(optla_ctx_create(&ctx, &d));
#pragma omp parallel for num_threads(7) schedule(dynamic)
	for (int k = 0; k < N; k++) {
		OPTLA_FAIL(ctx, OPTLA_ERR_ARG, "number %d", k);
		optla_report_(ctx, "test", (uint64_t)k, N, 0, NULL, 0);
		optla_free(ctx, optla_alloc_(ctx, 8));
		optla_note_input_bytes_(ctx, k % 2 ? "odd" : "even", &k, sizeof k);
	}
	ck_assert_int_eq(errors, N);
	ck_assert_int_eq(reports, N);
	optla_ctx_destroy(&ctx);
	ck_assert_int_eq(b.live, 0);
}
END_TEST

START_TEST(a_child_keeps_its_errors_and_inputs_until_the_join)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 4), *child[2];
	char *text;
	for (int k = 0; k < 2; k++) {
		child[k] = optla_ctx_fork_(ctx);
		ck_assert_int_eq(optla_ctx_threads(child[k]), 1);
	}
	optla_note_input_bytes_(child[1], "second", "b", 1);
	optla_note_input_bytes_(child[0], "first", "a", 1);
	OPTLA_FAIL(child[1], OPTLA_ERR_INPUT, "wrong %d%%", 7);
	ck_assert_int_eq(e.count, 0);
	ck_assert_str_eq(optla_ctx_last_error(ctx), "");
	for (int k = 0; k < 2; k++) optla_ctx_join_(&child[k], true);
	ck_assert_int_eq(e.count, 1);
	ck_assert_int_eq(e.code, OPTLA_ERR_INPUT);
	ck_assert_str_eq(e.text, "wrong 7%");
	ok(optla_ctx_provenance(ctx, &text));
	ck_assert_ptr_nonnull(strstr(text, "input: first "));
	ck_assert_ptr_nonnull(strstr(strstr(text, "input: first "), "input: second "));
	optla_free(ctx, text);
	child[0] = optla_ctx_fork_(ctx);
	optla_ctx_cancel(ctx);
	status_is(optla_check_cancel_(child[0]), OPTLA_ERR_CANCELLED);
	optla_ctx_join_(&child[0], false);
	ck_assert_int_eq(e.count, 1);
	optla_ctx_join_(&child[0], true); /* none */
	optla_ctx_destroy(&ctx);
}
END_TEST

/* In the C locale and, where the machine has one, in locales with a decimal comma. */
START_TEST(numbers_have_a_point_in_every_locale)
{
	static const char *const names[] = {"C", "de_DE.UTF-8", "fr_FR.UTF-8"};
	for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
		const locale_t l = newlocale(LC_ALL_MASK, names[k], (locale_t)0);
		if (!l) continue;
		const locale_t old = uselocale(l);
		char text[32], *end;
		const double value = optla_strtod_("-2.5e1,7", &end);
		optla_double_text_(0.125, 17, text, sizeof text);
		uselocale(old);
		freelocale(l);
		ck_assert_double_eq(value, -25);
		ck_assert_str_eq(end, ",7");
		ck_assert_str_eq(text, "0.125");
	}
}
END_TEST

int main(void)
{
	Suite *s = suite_create("base");
	TCase *t = tcase_create("base");
	tcase_set_timeout(t, 60);
	tcase_add_test(t, numbers_have_a_point_in_every_locale);
	tcase_add_test(t, context_defaults);
	tcase_add_test(t, memory_limit_is_an_error_with_values);
	tcase_add_test(t, random_numbers_have_their_moments);
	tcase_add_test(t, poisson_distribution_chi_square);
	tcase_add_test(t, options_are_checked_and_named);
	tcase_add_test(t, every_allocation_of_the_context_may_fail);
	tcase_add_test(t, handlers_and_allocator_are_called_by_one_thread_at_a_time);
	tcase_add_test(t, a_child_keeps_its_errors_and_inputs_until_the_join);
	suite_add_tcase(s, t);
	return run_suite(s);
}
