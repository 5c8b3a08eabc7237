/* SPDX-License-Identifier: BSD-3-Clause */
/* Numeric assertions over Check: both values with 17 digits, the relative error and the index of the worst entry. */
#ifndef OPTLA_TEST_NEAR_H
#define OPTLA_TEST_NEAR_H

#include "optla/base.h"

#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define status_is(call, code)                                                                                                \
	do {                                                                                                                     \
		const optla_status got_ = (call);                                                                                    \
		ck_assert_msg(got_ == (code), "%s: got '%s', wanted '%s'", #call, optla_status_name(got_), optla_status_name(code)); \
	} while (0)
#define ok(call) status_is(call, OPTLA_OK)

#define near_rel(a, b, tol)                                                                                            \
	do {                                                                                                               \
		const double a_ = (a), b_ = (b), e_ = fabs(a_ - b_) / fmax(fabs(b_), 1e-300);                                  \
		ck_assert_msg(a_ == b_ || e_ <= (tol), "%s = %.17g, wanted %.17g: relative error %.3g > %.3g", #a, a_, b_, e_, \
		              (double)(tol));                                                                                  \
	} while (0)
#define near_abs(a, b, tol)                                                                                       \
	do {                                                                                                          \
		const double a_ = (a), b_ = (b), e_ = fabs(a_ - b_);                                                      \
		ck_assert_msg(e_ <= (tol), "%s = %.17g, wanted %.17g: error %.3g > %.3g", #a, a_, b_, e_, (double)(tol)); \
	} while (0)
/* Arrays of double: every |a - b| <= tol * max|b|. */
#define near_array(a, b, n, tol) near_array_((a), (b), (n), (tol), #a, __FILE__, __LINE__)
static inline void near_array_(const double *a, const double *b, size_t n, double tol, const char *name, const char *file,
                               int line)
{
	double scale = 0, worst = -1;
	size_t at = 0;
	for (size_t k = 0; k < n; k++) scale = fmax(scale, fabs(b[k]));
	for (size_t k = 0; k < n; k++) {
		const double e = isfinite(a[k]) ? fabs(a[k] - b[k]) : INFINITY;
		if (e > worst) worst = e, at = k;
	}
	ck_assert_msg(n == 0 || worst <= tol * scale, "%s:%d: %s[%zu] = %.17g, wanted %.17g: error %.3g of scale %.3g > %.3g", file,
	              line, name, at, a[at], b[at], worst, scale, tol);
}

/* Remembers the last error's text, to compare messages. */
typedef struct {
	optla_status code;
	char text[1024];
	int count;
} error_store;

static inline void error_keep(void *user, optla_status code, const char *where, const char *message)
{
	(void)where;
	error_store *s = user;
	s->code = code;
	s->count++;
	snprintf(s->text, sizeof s->text, "%s", message);
}

/* A context that stores errors; threads = 0: default. */
static inline optla_ctx *test_ctx(error_store *store, int threads)
{
	optla_ctx *ctx;
	const optla_ctx_desc d = {.size = sizeof d, .error = store ? error_keep : NULL, .error_user = store, .threads = threads};
	ok(optla_ctx_create(&ctx, &d));
	return ctx;
}

/* An allocator with a budget: the k-th allocation fails (for tests of every error path). */
typedef struct {
	long left, live;
} alloc_budget;

static inline void *budget_alloc(void *user, size_t bytes)
{
	alloc_budget *b = user;
	if (b->left-- <= 0) return NULL;
	b->live++;
	return malloc(bytes);
}

static inline void budget_free(void *user, void *p)
{
	alloc_budget *b = user;
	if (p) b->live--;
	free(p);
}

/* Ends a case that needs a real capture which this machine hasn't got, e.g. skip_without(OPTLA_SHARED_DATA "/diligent-ball").
   The summary counts it as skipped, and as failed where the captures are present. Written past stdio: the case runs in a fork. */
#define skip_without(path)                                                        \
	do {                                                                          \
		if (access((path), R_OK)) {                                               \
			dprintf(STDOUT_FILENO, "# skipped: %s needs %s\n", __func__, (path)); \
			return;                                                               \
		}                                                                         \
	} while (0)

static inline int run_suite(Suite *suite)
{
	SRunner *runner = srunner_create(suite);
	srunner_set_tap(runner, "-");
	srunner_run_all(runner, CK_SILENT);
	const int failed = srunner_ntests_failed(runner);
	srunner_free(runner);
	return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

#endif
