/* SPDX-License-Identifier: BSD-3-Clause */
/* The image: kinds, curves, exposure, grey, resampling, signed colours. */
#include "near.h"
#include "optla/image.h"

static optla_image *make(optla_ctx *ctx, size_t w, size_t h, size_t c, optla_image_kind kind)
{
	optla_image *m;
	ok(optla_image_create(ctx, w, h, c, kind, &m));
	return m;
}

/* Reproducible values in [lo, hi). */
static void fill(optla_image *m, float lo, float hi)
{
	uint32_t v = 99;
	for (size_t k = 0; k < m->width * m->height * m->channels; k++) {
		v = v * 1664525u + 1013904223u;
		m->data[k] = lo + (hi - lo) * (float)(v >> 8) * 0x1p-24f;
	}
}

static double mean_of(const optla_image *m, size_t channel)
{
	double sum = 0;
	for (size_t p = 0; p < m->width * m->height; p++) sum += m->data[p * m->channels + channel];
	return sum / (double)(m->width * m->height);
}

START_TEST(sizes_and_kinds_are_checked)
{
	error_store e = {0};
	optla_ctx *ctx;
	const optla_ctx_desc d = {
	    .size = sizeof d, .error = error_keep, .error_user = &e, .memory_limit_bytes = 1 << 20, .threads = 1};
	ok(optla_ctx_create(&ctx, &d));
	optla_image *m = (optla_image *)&d;
	status_is(optla_image_create(ctx, 0, 4, 1, OPTLA_IMAGE_LINEAR, &m), OPTLA_ERR_ARG);
	ck_assert_ptr_null(m);
	status_is(optla_image_create(ctx, 4, 4, 5, OPTLA_IMAGE_LINEAR, &m), OPTLA_ERR_ARG);
	status_is(optla_image_create(ctx, 4, 4, 0, OPTLA_IMAGE_LINEAR, &m), OPTLA_ERR_ARG);
	status_is(optla_image_create(ctx, 4, 4, 1, (optla_image_kind)7, &m), OPTLA_ERR_ARG);
	status_is(optla_image_create(ctx, 513, 512, 1, OPTLA_IMAGE_LINEAR, &m), OPTLA_ERR_ARG);
	ck_assert_ptr_nonnull(strstr(e.text, "513 x 512 x 1"));
	status_is(optla_image_create(ctx, SIZE_MAX / 2, SIZE_MAX / 2, 4, OPTLA_IMAGE_LINEAR, &m), OPTLA_ERR_ARG);
	ok(optla_image_create(ctx, 512, 512, 1, OPTLA_IMAGE_RAW_DN, &m));
	for (size_t k = 0; k < 512 * 512; k++) ck_assert(0 == m->data[k]);
	optla_image_set_kind(m, OPTLA_IMAGE_RAW_DN, 4095);
	optla_image *copy;
	ok(optla_image_copy(m, &copy));
	ck_assert_double_eq(copy->white_dn, 4095);
	optla_image_set_kind(m, OPTLA_IMAGE_LINEAR, 4095);
	ck_assert_double_eq(m->white_dn, 0);
	optla_image_destroy(&copy);
	optla_image_destroy(&m);
	ck_assert_ptr_null(m);
	optla_image_destroy(&m);
	optla_image_destroy(NULL);
	ck_assert_str_eq(optla_image_kind_name(OPTLA_IMAGE_RAW_DN), "raw_dn");
	ck_assert_str_eq(optla_image_kind_name((optla_image_kind)9), "unknown");
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(counts_become_linear_and_alpha_stays)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_image *m = make(ctx, 2, 1, 4, OPTLA_IMAGE_RAW_DN);
	const float counts[8] = {64, 100, 4095, 0.5f, 60, 64.5f, 65, 1}, wanted[8] = {0, 9, 1007.75f, 0.5f, -1, 0.125f, 0.25f, 1};
	memcpy(m->data, counts, sizeof counts);
	m->white_dn = 4095;
	ok(optla_image_linearize(m, 64, 0.25));
	ck_assert_mem_eq(m->data, wanted, sizeof wanted); /* all numbers are exact in binary */
	ck_assert_int_eq(m->kind, OPTLA_IMAGE_LINEAR);
	ck_assert_double_eq(m->white_dn, 0);
	status_is(optla_image_linearize(m, 64, 0.25), OPTLA_ERR_ARG);
	optla_image_set_kind(m, OPTLA_IMAGE_RAW_DN, 1);
	status_is(optla_image_linearize(m, NAN, 1), OPTLA_ERR_ARG);
	status_is(optla_image_linearize(m, 0, 0), OPTLA_ERR_ARG);
	optla_image_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(the_srgb_curve_has_its_known_values)
{
	/* From the formulas of IEC 61966-2-1 evaluated in double precision elsewhere; half an ulp of a float is 6e-8. */
	static const struct {
		double linear, display;
	} known[] = {{0, 0},
	             {0.001, 0.01292},
	             {0.003, 0.03876},
	             {0.18, 0.46135612950044165},
	             {0.21404114048223255, 0.5},
	             {0.5, 0.73535698305244945},
	             {1, 1}};
	enum { N = sizeof known / sizeof *known };
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_image *m = make(ctx, N, 1, 1, OPTLA_IMAGE_LINEAR);
	for (int k = 0; k < N; k++) m->data[k] = (float)(known[k].linear / 4);
	ok(optla_image_to_display(m, 4));
	for (int k = 0; k < N; k++) near_rel(m->data[k], known[k].display, 1.2e-7); /* rounding of the input and of the output */
	ok(optla_image_display_to_linear(m));
	/* The slope of the inverse curve, at most 2.4 relative, takes the rounding along. */
	for (int k = 0; k < N; k++) near_rel(m->data[k], known[k].linear, 4e-7);
	ck_assert_int_eq(m->kind, OPTLA_IMAGE_LINEAR);
	optla_image_destroy(&m);
	m = make(ctx, 4, 1, 1, OPTLA_IMAGE_LINEAR);
	const float wild[4] = {-1, 3, NAN, INFINITY}, tame[4] = {0, 1, 0, 1};
	memcpy(m->data, wild, sizeof wild);
	ok(optla_image_to_display(m, 1));
	ck_assert_mem_eq(m->data, tame, sizeof tame);
	status_is(optla_image_to_display(m, 1), OPTLA_ERR_ARG);
	optla_image_set_kind(m, OPTLA_IMAGE_LINEAR, 0);
	status_is(optla_image_to_display(m, NAN), OPTLA_ERR_ARG);
	status_is(optla_image_to_display(m, -1), OPTLA_ERR_ARG);
	status_is(optla_image_display_to_linear(m), OPTLA_ERR_ARG);
	optla_image_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

static int by_value(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

START_TEST(auto_exposure_is_the_quantile_of_sorted_pixels)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	optla_image *m = make(ctx, 37, 11, 3, OPTLA_IMAGE_LINEAR);
	enum { N = 37 * 11 };
	fill(m, -0.5f, 2);
	for (size_t p = 0; p < N; p += 5) m->data[3 * p] *= 1e-20f, m->data[3 * p + 1] *= 1e-30f, m->data[3 * p + 2] = -1;
	float sorted[N];
	for (size_t p = 0; p < N; p++) sorted[p] = fmaxf(0, fmaxf(m->data[3 * p], fmaxf(m->data[3 * p + 1], m->data[3 * p + 2])));
	qsort(sorted, N, sizeof *sorted, by_value);
	const double quantiles[] = {0.3, 0.5, 0.9, 0.995, 1};
	for (size_t k = 0; k < sizeof quantiles / sizeof *quantiles; k++) {
		const float wanted = sorted[(size_t)(quantiles[k] * (N - 1) + 0.5)];
		ck_assert_double_eq(optla_image_auto_exposure(m, quantiles[k]), 1 / (double)wanted);
	}
	for (size_t k = 0; k < 3 * N; k++) m->data[k] = 0;
	ck_assert_double_eq(optla_image_auto_exposure(m, 0.995), 1);
	m->data[100] = 8; /* one light in the dark */
	m->data[103] = NAN;
	m->data[200] = INFINITY;
	ck_assert_double_eq(optla_image_auto_exposure(m, 0.5), 0.125);
	for (size_t k = 0; k < 3 * N; k++) m->data[k] = NAN;
	ck_assert_double_eq(optla_image_auto_exposure(m, 0.5), 1);
	ck_assert_int_eq(e.count, 0);
	optla_image_set_kind(m, OPTLA_IMAGE_DISPLAY, 0);
	ck_assert_double_eq(optla_image_auto_exposure(m, 0.5), 1);
	ck_assert_int_eq(e.code, OPTLA_ERR_ARG);
	optla_image_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(grey_is_the_mean_of_the_colours)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	for (size_t channels = 1; channels <= 4; channels++) {
		optla_image *m = make(ctx, 2, 1, channels, OPTLA_IMAGE_RAW_DN), *grey;
		m->white_dn = 100;
		for (size_t k = 0; k < 2 * channels; k++) m->data[k] = (float)(k * k);
		ok(optla_image_grey(m, &grey));
		const float wanted[5][2] = {{0, 0}, {0, 1}, {0, 4}, {5.f / 3, 50.f / 3}, {5.f / 3, 77.f / 3}};
		ck_assert_uint_eq(grey->channels, 1);
		ck_assert_double_eq(grey->white_dn, 100);
		ck_assert_mem_eq(grey->data, wanted[channels], 2 * sizeof(float));
		optla_image_destroy(&grey);
		optla_image_set_kind(m, OPTLA_IMAGE_DISPLAY, 0);
		status_is(optla_image_grey(m, &grey), OPTLA_ERR_ARG);
		optla_image_destroy(&m);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(resizing_gives_hand_computed_values)
{
	static const struct {
		size_t from, to;
		float in[6], out[6];
	} known[] = {
	    {4, 2, {1, 3, 5, 9}, {2, 7}}, {3, 2, {0, 6, 3}, {2, 4}}, /* (0 + 6/2) / 1.5, (6/2 + 3) / 1.5 */
	    {2, 4, {0, 8}, {0, 2, 6, 8}},                            /* centres -1/4, 1/4, 3/4, 5/4 */
	    {2, 3, {0, 6}, {0, 3, 6}},                               /* centres -1/6, 1/2, 7/6 */
	    {1, 3, {5}, {5, 5, 5}},       {5, 1, {1, 2, 3, 4, 10}, {4}}, {3, 3, {1, 2, 4}, {1, 2, 4}},
	};
	optla_ctx *ctx = test_ctx(NULL, 1);
	for (size_t k = 0; k < sizeof known / sizeof *known; k++)
		for (int vertical = 0; vertical < 2; vertical++) {
			const size_t from = known[k].from, to = known[k].to;
			optla_image *m = make(ctx, vertical ? 1 : from, vertical ? from : 1, 1, OPTLA_IMAGE_LINEAR), *r;
			memcpy(m->data, known[k].in, from * sizeof(float));
			ok(optla_image_resize(m, vertical ? 1 : to, vertical ? to : 1, &r));
			for (size_t i = 0; i < to; i++) near_abs(r->data[i], known[k].out[i], 1e-6); /* a few ulp of numbers below 10 */
			optla_image_destroy(&m);
			optla_image_destroy(&r);
		}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(resizing_by_whole_factors_keeps_the_mean)
{
	static const size_t sizes[][4] = {{12, 8, 4, 4}, {12, 8, 36, 16}, {12, 8, 6, 24}, {12, 8, 1, 1}, {5, 7, 5, 21}, {9, 3, 3, 3}};
	optla_ctx *ctx = test_ctx(NULL, 2);
	for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
		optla_image *m = make(ctx, sizes[k][0], sizes[k][1], 3, OPTLA_IMAGE_RAW_DN), *r;
		fill(m, 0, 1000);
		m->white_dn = 1000;
		ok(optla_image_resize(m, sizes[k][2], sizes[k][3], &r));
		ck_assert_double_eq(r->white_dn, 1000);
		/* Each float is rounded twice, by at most 6e-8; the mean of many is no worse. */
		for (size_t c = 0; c < 3; c++) near_rel(mean_of(r, c), mean_of(m, c), 1.2e-7);
		optla_image_destroy(&m);
		optla_image_destroy(&r);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(resizing_keeps_constants_and_range_at_odd_factors)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_image *m = make(ctx, 13, 7, 1, OPTLA_IMAGE_LINEAR), *r;
	for (size_t w = 1; w < 30; w += 3)
		for (size_t h = 1; h < 17; h += 2) {
			for (size_t k = 0; k < 13 * 7; k++) m->data[k] = 0.7f;
			ok(optla_image_resize(m, w, h, &r));
			for (size_t k = 0; k < w * h; k++) near_rel(r->data[k], 0.7f, 2.4e-7); /* two roundings of 1.2e-7 */
			optla_image_destroy(&r);
			fill(m, 1, 2);
			ok(optla_image_resize(m, w, h, &r));
			for (size_t k = 0; k < w * h; k++) ck_assert(r->data[k] >= 1 && r->data[k] <= 2);
			optla_image_destroy(&r);
		}
	status_is(optla_image_resize(m, 0, 3, &r), OPTLA_ERR_ARG);
	ck_assert_ptr_null(r);
	optla_image_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(signed_colours_are_red_white_blue)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_image *m = make(ctx, 6, 1, 1, OPTLA_IMAGE_LINEAR), *c;
	const float values[6] = {0, 2, -2, 1, -4, NAN};
	const float at_2[18] = {1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 0.5f, 0.5f, 0, 0, 1, 0, 0, 0};
	const float at_4[18] = {1, 1, 1, 1, 0.5f, 0.5f, 0.5f, 0.5f, 1, 1, 0.75f, 0.75f, 0, 0, 1, 0, 0, 0};
	memcpy(m->data, values, sizeof values);
	ok(optla_image_signed_colours(m, 2, &c));
	ck_assert_int_eq(c->kind, OPTLA_IMAGE_DISPLAY);
	ck_assert_mem_eq(c->data, at_2, sizeof at_2);
	optla_image_destroy(&c);
	ok(optla_image_signed_colours(m, 0, &c)); /* the largest is 4 */
	ck_assert_mem_eq(c->data, at_4, sizeof at_4);
	optla_image_destroy(&c);
	status_is(optla_image_signed_colours(m, -1, &c), OPTLA_ERR_ARG);
	memset(m->data, 0, sizeof values);
	ok(optla_image_signed_colours(m, 0, &c));
	for (size_t k = 0; k < 18; k++) ck_assert(1 == c->data[k]);
	optla_image_destroy(&c);
	optla_image_destroy(&m);
	m = make(ctx, 2, 1, 3, OPTLA_IMAGE_LINEAR);
	status_is(optla_image_signed_colours(m, 1, &c), OPTLA_ERR_SHAPE);
	optla_image_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* Everything that runs in parallel; the result's bytes. */
static optla_image *all_steps(int threads, optla_ctx **ctx)
{
	*ctx = test_ctx(NULL, threads);
	optla_image *m = make(*ctx, 61, 43, 3, OPTLA_IMAGE_RAW_DN), *small, *large, *grey;
	fill(m, 0, 65535);
	ok(optla_image_linearize(m, 100, 1e-4));
	ok(optla_image_resize(m, 20, 30, &small));
	ok(optla_image_resize(small, 45, 77, &large));
	ok(optla_image_grey(large, &grey));
	ok(optla_image_to_display(grey, optla_image_auto_exposure(grey, 0.9)));
	optla_image_destroy(&m);
	optla_image_destroy(&small);
	optla_image_destroy(&large);
	return grey;
}

START_TEST(same_bytes_for_any_number_of_threads)
{
	optla_ctx *one, *other;
	optla_image *a = all_steps(1, &one);
	const int threads[] = {2, 7};
	for (int k = 0; k < 2; k++) {
		optla_image *b = all_steps(threads[k], &other);
		ck_assert_mem_eq(a->data, b->data, 45 * 77 * sizeof(float));
		optla_image_destroy(&b);
		optla_ctx_destroy(&other);
	}
	optla_image_destroy(&a);
	optla_ctx_destroy(&one);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
	alloc_budget b = {0};
	optla_status s = OPTLA_ERR_NOMEM;
	for (long k = 1; OPTLA_OK != s; k++) {
		b = (alloc_budget){.left = k};
		const optla_ctx_desc d = {.size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b, .threads = 2};
		optla_ctx *ctx;
		optla_image *m[5] = {NULL};
		ok(optla_ctx_create(&ctx, &d));
		s = optla_image_create(ctx, 6, 5, 3, OPTLA_IMAGE_LINEAR, &m[0]);
		if (!s) s = optla_image_copy(m[0], &m[1]);
		if (!s) s = optla_image_resize(m[0], 3, 9, &m[2]);
		if (!s) s = optla_image_grey(m[0], &m[3]);
		if (!s) s = optla_image_signed_colours(m[3], 1, &m[4]);
		ck_assert(OPTLA_OK == s || OPTLA_ERR_NOMEM == s);
		for (int i = 0; i < 5; i++) optla_image_destroy(&m[i]);
		optla_ctx_destroy(&ctx);
		ck_assert_int_eq(b.live, 0);
	}
	ck_assert_int_eq(b.left, 0); /* the last round used its budget up: none was left untested */
}
END_TEST

int main(void)
{
	Suite *s = suite_create("image");
	TCase *t = tcase_create("image");
	tcase_set_timeout(t, 60);
	tcase_add_test(t, sizes_and_kinds_are_checked);
	tcase_add_test(t, counts_become_linear_and_alpha_stays);
	tcase_add_test(t, the_srgb_curve_has_its_known_values);
	tcase_add_test(t, auto_exposure_is_the_quantile_of_sorted_pixels);
	tcase_add_test(t, grey_is_the_mean_of_the_colours);
	tcase_add_test(t, resizing_gives_hand_computed_values);
	tcase_add_test(t, resizing_by_whole_factors_keeps_the_mean);
	tcase_add_test(t, resizing_keeps_constants_and_range_at_odd_factors);
	tcase_add_test(t, signed_colours_are_red_white_blue);
	tcase_add_test(t, same_bytes_for_any_number_of_threads);
	tcase_add_test(t, every_allocation_may_fail);
	suite_add_tcase(s, t);
	return run_suite(s);
}
