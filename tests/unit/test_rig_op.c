/* SPDX-License-Identifier: BSD-3-Clause */
/* The operators of a rig, on a small corner: exact ones, light, power, noise, options, lifetime. */
#include "math/dense.h"
#include "near.h"
#include "optla/rig.h"

static optla_rig *corner(optla_ctx *ctx)
{
	optla_rig *rig;
	ok(optla_rig_corner(ctx, 8, 6, false, &rig));
	return rig;
}

START_TEST(operator_is_exact_without_a_sensor)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_rig *rig = corner(ctx);
	const optla_channel channels[] = {OPTLA_CHANNEL_GREY, OPTLA_CHANNEL_GREEN, OPTLA_CHANNEL_ALL};
	const optla_split splits[] = {OPTLA_SPLIT_SIGNED, OPTLA_SPLIT_OFFSET, OPTLA_SPLIT_AUTO};
	for (int c = 0; c < 3; c++)
		for (int s = 0; s < 6; s++) {
			optla_rig_operator_options o = optla_rig_operator_defaults;
			optla_op *op, *truth;
			o.channel = channels[c];
			o.split = splits[s % 3];
			o.type = s < 3 ? OPTLA_F64 : OPTLA_F32;
			o.ambient = 0.7;
			ok(optla_rig_operator(rig, &o, &op));
			ok(optla_rig_truth(rig, o.channel, &truth));
			double rel;
			ok(optla_op_check_adjoint(op, 5, &rel));
			ck_assert_double_lt(rel, s < 3 ? 1e-12 : 1e-6);
			ck_assert_double_eq(optla_op_noise(op), 0);
			const size_t m = optla_op_nrows(op), n = optla_op_ncols(op);
			double *a = malloc(m * n * 8), *b = malloc(m * n * 8);
			ok(optla_op_to_dense(truth, optla_block_(b, m, n, OPTLA_F64)));
			ok(optla_op_to_dense(op, optla_block_(a, m, n, o.type)));
			double worst = 0, scale = 0;
			for (size_t k = 0; k < m * n; k++) {
				const double v = s < 3 ? a[k] : (double)((float *)a)[k];
				worst = fmax(worst, fabs(v - b[k]));
				scale = fmax(scale, b[k]);
			}
			/* ambient light of 0.7 of T1, some 36 times the largest entry, cancels to rounding in either way */
			ck_assert_msg(worst < (s < 3 ? 1e-13 : 1e-5) * scale, "channel %d, split %d: off by %g of %g", c, s, worst, scale);
			free(b);
			free(a);
			optla_op_unref(&truth);
			optla_op_unref(&op);
		}
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(light_operator_keeps_ambient_light_and_power)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_rig *rig = corner(ctx);
	optla_op *op, *truth;
	optla_rig_operator_options o = optla_rig_operator_defaults;
	o.type = OPTLA_F64;
	o.ambient = 0.25;
	o.exposure = 3;
	ok(optla_rig_light_operator(rig, &o, &op));
	ok(optla_rig_truth(rig, OPTLA_CHANNEL_ALL, &truth));
	enum { M = 64, N = 36 };
	double ones[N], t1[3 * M], brightest = 0, x[2 * N] = {0}, y[2 * M], tx[3 * M], power[2] = {8, 2};
	for (int n = 0; n < N; n++) ones[n] = 1;
	ok(optla_op_apply(truth, OPTLA_FORWARD, optla_cblock_(ones, N, 1, OPTLA_F64), optla_block_(t1, 3 * M, 1, OPTLA_F64)));
	for (int m = 0; m < 3 * M; m++) brightest = fmax(brightest, t1[m]);
	x[3] = 4;
	ok(optla_op_apply(truth, OPTLA_FORWARD, optla_cblock_(x, N, 1, OPTLA_F64), optla_block_(tx, 3 * M, 1, OPTLA_F64)));
	ok(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(x, N, 2, OPTLA_F64), optla_block_(y, M, 2, OPTLA_F64)));
	for (int m = 0; m < M; m++) { /* max(x) a, and for zero light the dark frame at scale 1 */
		near_rel(y[m], (tx[m] + tx[M + m] + tx[2 * M + m]) / 3 + 4 * 0.25 * brightest, 1e-12);
		near_rel(y[M + m], 0.25 * brightest, 1e-12);
	}
	ok(optla_op_expose(op, OPTLA_FORWARD, optla_cblock_(x, N, 2, OPTLA_F64), power, optla_block_(y, M, 2, OPTLA_F64)));
	near_rel(y[5], (tx[5] + tx[M + 5] + tx[2 * M + 5]) / 3 + 8 * 0.25 * brightest, 1e-12);
	near_rel(y[M + 5], 2 * 0.25 * brightest, 1e-12);
	const optla_op_cost cost = optla_op_cost_so_far(op);
	ck_assert_uint_eq(cost.photos, 4);
	near_rel(cost.exposure_s, 4 * 3 / 13.0, 1e-12);
	x[0] = -1e-9;
	status_is(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(x, N, 1, OPTLA_F64), optla_block_(y, M, 1, OPTLA_F64)),
	          OPTLA_ERR_ARG);
	optla_op_unref(&truth);
	optla_op_unref(&op);
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
}
END_TEST

static void count_saturation(void *user, int level, const char *message)
{
	*(int *)user += level == 0 && strstr(message, "samples are saturated");
}

START_TEST(photos_fill_the_sensor_as_told)
{
	/* All lights on at full_scale s: the brightest pixel holds s of the capacity; at exposure 2/s it is clipped there, and said to be. */
	int warnings = 0;
	const optla_ctx_desc desc = {.size = sizeof desc, .log = count_saturation, .log_user = &warnings, .threads = 1};
	optla_ctx *ctx;
	ok(optla_ctx_create(&ctx, &desc));
	optla_rig *rig = corner(ctx);
	enum { M = 64, N = 36 };
	double ones[N], y[3 * M], clean[3 * M];
	for (int n = 0; n < N; n++) ones[n] = 1;
	optla_rig_operator_options o = optla_rig_operator_defaults;
	o.type = OPTLA_F64;
	o.channel = OPTLA_CHANNEL_ALL;
	optla_op *op;
	ok(optla_rig_light_operator(rig, &o, &op));
	ok(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(ones, N, 1, OPTLA_F64), optla_block_(clean, 3 * M, 1, OPTLA_F64)));
	optla_op_unref(&op);
	double brightest = 0;
	for (int m = 0; m < 3 * M; m++) brightest = fmax(brightest, clean[m]);
	o.sensor = optla_sensor_preset("dslr-14bit");
	const double full[2] = {0.8, 0.5}, exposure[2] = {1, 4};
	for (int k = 0; k < 2; k++) {
		o.full_scale = full[k];
		o.exposure = exposure[k];
		ok(optla_rig_light_operator(rig, &o, &op));
		ok(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(ones, N, 1, OPTLA_F64), optla_block_(y, 3 * M, 1, OPTLA_F64)));
		double largest = 0;
		for (int m = 0; m < 3 * M; m++) largest = fmax(largest, y[m]);
		/* exposure 4 at full scale 0.5: energies up to twice the capacity, clipped at half of T1's brightest.
		   5 standard errors of a well of 60 000 e: 2 %; counts are whole: 1e-4 */
		near_rel(largest, k ? brightest / 2 : brightest, k ? 1e-4 : 0.02);
		ok(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(ones, N, 1, OPTLA_F64), optla_block_(y, 3 * M, 1, OPTLA_F64)));
		ck_assert_int_eq(warnings, k); /* once for each operator, however many photos are clipped */
		optla_op_unref(&op);
	}
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(noise_is_independent_of_threads_and_changes_with_photos)
{
	enum { M = 192, N = 36 };
	double first[4 * M], y[4 * M], later[4 * M], x[4 * N];
	for (int k = 0; k < 4 * N; k++) x[k] = (k % 7) / 7.0 + 0.1 * (k / N);
	const int threads[3] = {1, 2, 7};
	for (int t = 0; t < 3; t++) {
		optla_ctx *ctx = test_ctx(NULL, threads[t]);
		optla_rig *rig = corner(ctx);
		optla_rig_operator_options o = optla_rig_operator_defaults;
		o.type = OPTLA_F64;
		o.channel = OPTLA_CHANNEL_ALL;
		o.sensor = optla_sensor_preset("video-8bit");
		optla_op *op;
		ok(optla_rig_light_operator(rig, &o, &op));
		ok(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(x, N, 4, OPTLA_F64), optla_block_(y, M, 4, OPTLA_F64)));
		if (t) ck_assert_mem_eq(y, first, sizeof y);
		memcpy(first, y, sizeof y);
		ok(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(x, N, 4, OPTLA_F64), optla_block_(y, M, 4, OPTLA_F64)));
		ck_assert_mem_ne(y, first, sizeof y); /* another readout */
		optla_op *resumed;
		o.first_readout = 4;
		ok(optla_rig_light_operator(rig, &o, &resumed));
		ok(optla_op_apply(resumed, OPTLA_FORWARD, optla_cblock_(x, N, 4, OPTLA_F64), optla_block_(later, M, 4, OPTLA_F64)));
		ck_assert_mem_eq(later, y, sizeof y); /* goes on where the first four photos ended */
		optla_op_unref(&resumed);
		ck_assert(optla_op_flags(op) & OPTLA_OP_STOCHASTIC);
		optla_op_unref(&op);
		optla_rig_destroy(&rig);
		optla_ctx_destroy(&ctx);
	}
}
END_TEST

/* Grey photos are the means of colour ones: T of grey, which is made by itself, is the reduction times T of all channels. */
START_TEST(grey_reduction_makes_grey_of_colour)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_rig *rig = corner(ctx);
	optla_op *grey, *all;
	optla_rig_info info;
	optla_rig_get_info(rig, &info);
	ck_assert_uint_eq(info.channels, 3);
	ok(optla_rig_truth(rig, OPTLA_CHANNEL_GREY, &grey));
	ok(optla_rig_truth(rig, OPTLA_CHANNEL_ALL, &all));
	const size_t m = info.npixels, h = m * info.channels, n = info.nlights;
	double *g = malloc(m * n * 8), *a = malloc(h * n * 8), *mean = malloc(m * n * 8);
	ok(optla_op_to_dense(grey, optla_block_(g, m, n, OPTLA_F64)));
	ok(optla_op_to_dense(all, optla_block_(a, h, n, OPTLA_F64)));
	for (int f = 0; f < 2; f++) {
		const optla_scalar type = f ? OPTLA_F32 : OPTLA_F64;
		optla_op *reduce;
		double rel;
		ok(optla_rig_grey_reduction(rig, type, &reduce));
		ck_assert_int_eq(optla_op_type(reduce), type);
		ck_assert_uint_eq(optla_op_nrows(reduce), m);
		ck_assert_uint_eq(optla_op_ncols(reduce), h);
		ok(optla_op_check_adjoint(reduce, 5, &rel));
		ck_assert_double_lt(rel, f ? 1e-6 : 1e-12);
		if (!f) {
			ok(optla_op_apply(reduce, OPTLA_FORWARD, optla_cblock_(a, h, n, OPTLA_F64), optla_block_(mean, m, n, OPTLA_F64)));
			for (size_t k = 0; k < m * n; k++)
				near_abs(mean[k], g[k], 7e-16 * fabs(g[k])); /* a product and two sums on either side: six roundings of 1.1e-16 */
		}
		optla_op_unref(&reduce);
	}
	free(mean), free(a), free(g);
	optla_op *none;
	status_is(optla_rig_grey_reduction(rig, (optla_scalar)77, &none), OPTLA_ERR_ARG);
	ck_assert_ptr_null(none);
	optla_op_unref(&grey);
	optla_op_unref(&all);
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(options_are_checked)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	optla_rig *rig = corner(ctx);
	optla_op *op;
	optla_rig_operator_options o = optla_rig_operator_defaults;
	o.full_scale = 1.5;
	status_is(optla_rig_operator(rig, &o, &op), OPTLA_ERR_ARG);
	ck_assert_ptr_nonnull(strstr(e.text, "'full-scale' is 1.5"));
	o = optla_rig_operator_defaults;
	o.type = OPTLA_C32;
	status_is(optla_rig_operator(rig, &o, &op), OPTLA_ERR_ARG);
	o = optla_rig_operator_defaults;
	o.channel = (optla_channel)9;
	status_is(optla_rig_operator(rig, &o, &op), OPTLA_ERR_ARG);
	o = optla_rig_operator_defaults;
	optla_sensor s = *optla_sensor_preset("ccd-12bit");
	s.bits = 99;
	o.sensor = &s;
	status_is(optla_rig_operator(rig, &o, &op), OPTLA_ERR_ARG);
	ck_assert_ptr_null(op);
	optla_image *image;
	ok(optla_image_create(ctx, 3, 3, 1, OPTLA_IMAGE_LINEAR, &image));
	double v[64];
	status_is(optla_rig_values(rig, image, OPTLA_CHANNEL_GREY, v), OPTLA_ERR_SHAPE);
	ck_assert_ptr_nonnull(strstr(e.text, "the image is 3 x 3, the rig's camera 8 x 8"));
	optla_image_destroy(&image);
	optla_rig *none;
	status_is(optla_rig_corner(ctx, 0, 4, false, &none), OPTLA_ERR_ARG);
	status_is(optla_rig_corner(ctx, 5, 4, true, &none), OPTLA_ERR_ARG);
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(operators_outlive_their_rig)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_rig *rig;
	optla_op *op, *truth;
	ok(optla_rig_corner(ctx, 6, 6, true, &rig));
	ok(optla_rig_operator(rig, NULL, &op));
	ok(optla_rig_truth(rig, OPTLA_CHANNEL_BLUE, &truth));
	ck_assert(optla_op_flags(truth) & OPTLA_OP_SYMMETRIC);
	ck_assert(optla_op_flags(op) & OPTLA_OP_SYMMETRIC);
	optla_rig_destroy(&rig);
	double rel;
	ok(optla_op_check_adjoint(op, 1, &rel));
	ok(optla_op_check_adjoint(truth, 1, &rel));
	ck_assert_double_lt(rel, 1e-12);
	optla_op_unref(&op);
	optla_op_unref(&truth);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(every_allocation_of_a_corner_may_fail)
{
	for (long k = 0;; k++) {
		alloc_budget b = {.left = 1000000};
		const optla_ctx_desc d = {.size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b, .threads = 1};
		optla_ctx *ctx;
		optla_rig *rig;
		ok(optla_ctx_create(&ctx, &d));
		b.left = k;
		optla_op *reduce = NULL;
		optla_status s = optla_rig_corner(ctx, 3, 2, false, &rig);
		if (s) ck_assert_ptr_null(rig);
		if (!s) s = optla_rig_grey_reduction(rig, OPTLA_F32, &reduce);
		b.left = 1000000;
		if (s) ck_assert_ptr_null(reduce);
		optla_op_unref(&reduce);
		optla_rig_destroy(&rig);
		optla_ctx_destroy(&ctx);
		ck_assert_msg(b.live == 0, "allocation %ld: %ld leaked", k, b.live);
		if (!s) {
			ck_assert_int_gt(k, 20);
			return;
		}
		ck_assert_msg(s == OPTLA_ERR_NOMEM, "allocation %ld: '%s'", k, optla_status_name(s));
	}
}
END_TEST

int main(void)
{
	Suite *s = suite_create("rig_op");
	TCase *t = tcase_create("rig_op");
	tcase_set_timeout(t, 240);
	tcase_add_test(t, operator_is_exact_without_a_sensor);
	tcase_add_test(t, light_operator_keeps_ambient_light_and_power);
	tcase_add_test(t, photos_fill_the_sensor_as_told);
	tcase_add_test(t, noise_is_independent_of_threads_and_changes_with_photos);
	tcase_add_test(t, grey_reduction_makes_grey_of_colour);
	tcase_add_test(t, options_are_checked);
	tcase_add_test(t, operators_outlive_their_rig);
	tcase_add_test(t, every_allocation_of_a_corner_may_fail);
	suite_add_tcase(s, t);
	return run_suite(s);
}
