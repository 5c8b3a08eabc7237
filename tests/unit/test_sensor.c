/* SPDX-License-Identifier: BSD-3-Clause */
/* The sensor's fixed sides: presets, checks, clipping, threads, the inverse; photon transfer on frames with known statistics. */
#include "near.h"
#include "optla/sensor.h"

static optla_sensor ideal(void)
{
	return (optla_sensor){.size = sizeof(optla_sensor),
	                      .psi_e_per_j = 2,
	                      .gain_e_per_dn = 0.5,
	                      .read_noise_dn = 0,
	                      .black_level_dn = 10,
	                      .full_well_e = 1e9,
	                      .bits = 12};
}

START_TEST(presets_are_valid_and_named)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	size_t n = 0;
	const char *help = NULL;
	for (const char *name; (name = optla_sensor_preset_name(n, &help)); n++) {
		const optla_sensor *s = optla_sensor_preset(name);
		ck_assert_ptr_nonnull(s);
		ok(optla_sensor_check(ctx, s));
		ck_assert_uint_gt(strlen(help), 10);
		/* Best SNR of one pixel, all electrons of a full well: between 10 and 60 dB for any real sensor. */
		const double snr = optla_sensor_snr_db(s, optla_sensor_capacity_e(s) / s->psi_e_per_j);
		ck_assert_msg(snr > 10 && snr < 60, "%s: %g dB", name, snr);
	}
	ck_assert_uint_eq(n, 3);
	ck_assert_ptr_null(optla_sensor_preset("none"));
	ck_assert_ptr_null(optla_sensor_preset(NULL));
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(wrong_fields_are_named)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	optla_sensor s = ideal();
	s.bits = 25;
	status_is(optla_sensor_check(ctx, &s), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "sensor: bits is 25: allowed is 1 to 24");
	s = ideal();
	s.read_noise_dn = -1;
	status_is(optla_sensor_check(ctx, &s), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "sensor: read_noise_dn is -1: allowed is a number >= 0");
	s = ideal();
	s.psi_e_per_j = NAN;
	status_is(optla_sensor_check(ctx, &s), OPTLA_ERR_ARG);
	s = ideal();
	s.gain_e_per_dn = INFINITY;
	status_is(optla_sensor_check(ctx, &s), OPTLA_ERR_ARG);
	s = ideal();
	s.full_well_e = 0;
	status_is(optla_sensor_check(ctx, &s), OPTLA_ERR_ARG);
	s = ideal();
	s.black_level_dn = 5000;
	status_is(optla_sensor_check(ctx, &s), OPTLA_ERR_ARG);
	ck_assert_ptr_nonnull(strstr(e.text, "black level 5000 leaves no room below the largest count 4095"));
	s = ideal();
	s.size = 8;
	status_is(optla_sensor_check(ctx, &s), OPTLA_ERR_ARG);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(energies_must_be_light)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	const optla_sensor s = ideal();
	float dn[2];
	const double bad[3][2] = {{1, -1e-9}, {1, NAN}, {INFINITY, 1}};
	for (int k = 0; k < 3; k++) status_is(optla_sensor_expose(ctx, &s, bad[k], 2, 1, 1, dn, NULL), OPTLA_ERR_ARG);
	ck_assert_ptr_nonnull(strstr(e.text, "the energy of pixel 0 is inf J"));
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(clips_at_adc_and_full_well)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_sensor s = ideal();
	const double energy[3] = {0, 1e6, 1e9};
	float dn[3];
	size_t saturated;
	ok(optla_sensor_expose(ctx, &s, energy, 3, 1, 1, dn, &saturated));
	ck_assert_float_eq(dn[0], 10);
	ck_assert_float_eq(dn[1], 4095);
	ck_assert_float_eq(dn[2], 4095);
	ck_assert_uint_eq(saturated, 2);
	near_rel(optla_sensor_capacity_e(&s), 0.5 * (4095 - 10), 1e-15);
	s.full_well_e = 1000.3; /* i_max / g = 2000.6: the largest whole count below is 2000 */
	ok(optla_sensor_expose(ctx, &s, energy, 3, 1, 1, dn, &saturated));
	ck_assert_float_eq(dn[2], 2000);
	near_rel(optla_sensor_capacity_e(&s), 1000.3 - 5, 1e-15);
	s.read_noise_dn = 100; /* clipped at zero below, not counted as saturated */
	double dark[400] = {0};
	float raw[400];
	ok(optla_sensor_expose(ctx, &s, dark, 400, 1, 1, raw, &saturated));
	int zeros = 0;
	for (int m = 0; m < 400; m++) {
		ck_assert(raw[m] >= 0 && raw[m] == floorf(raw[m]));
		zeros += raw[m] == 0;
	}
	ck_assert_int_gt(zeros, 100); /* P(N(10, 100) < 0.5) = 0.46 */
	ck_assert_uint_eq(saturated, 0);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(noise_is_a_function_of_seed_readout_and_pixel)
{
	enum { N = 5000 };
	static double energy[N];
	static float a[N], b[N];
	const optla_sensor *s = optla_sensor_preset("dslr-14bit");
	for (int m = 0; m < N; m++) energy[m] = m * 10 / s->psi_e_per_j;
	const int threads[] = {1, 2, 7};
	for (int t = 0; t < 3; t++) {
		optla_ctx *ctx = test_ctx(NULL, threads[t]);
		ok(optla_sensor_expose(ctx, s, energy, N, 5, 3, t ? b : a, NULL));
		if (t) ck_assert_mem_eq(a, b, sizeof a);
		optla_ctx_destroy(&ctx);
	}
	optla_ctx *ctx = test_ctx(NULL, 1);
	ok(optla_sensor_expose(ctx, s, energy, 100, 5, 3, b, NULL)); /* a part of the image is that part of the whole */
	ck_assert_mem_eq(a, b, 100 * sizeof *a);
	const struct {
		uint64_t seed, readout;
	} other[] = {{6, 3}, {5, 4}, {5, 3 + (1ull << 32)}};
	for (int k = 0; k < 3; k++) {
		int same = 0;
		ok(optla_sensor_expose(ctx, s, energy, N, other[k].seed, other[k].readout, b, NULL));
		for (int m = 0; m < N; m++) same += a[m] == b[m];
		ck_assert_int_lt(same, N / 4); /* read noise of 6.8 counts alone makes equality a matter of 4 % */
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(inverse_undoes_the_means)
{
	const optla_sensor s = ideal();
	const float dn[3] = {10, 14, 4};
	const double want[3] = {0, 1, -1.5}; /* (dn - 10) 0.5 / 2 */
	double got[3];
	optla_sensor_invert(&s, dn, 3, got);
	near_array(got, want, 3, 1e-15);
	/* Eq. 1.8 by hand: 100 J are 200 e, 400 counts; variance 0 + 200/0.25 + 1/12 counts². */
	near_rel(optla_sensor_snr_db(&s, 100), 20 * log10(400 / sqrt(800 + 1.0 / 12)), 1e-14);
	near_rel(optla_sensor_variance_j2(&s, 100), (800 + 1.0 / 12) / 16, 1e-14);
}
END_TEST

enum { PIXELS = 40000, LEVELS = 12 };

/* Frames of the model itself, as a measurement would take them: exposure raises photons and dark signal alike. */
static optla_status measure_model(optla_ctx *ctx, const optla_sensor *s, bool photons, optla_photon_transfer *t,
                                  optla_sensor *back)
{
	float *frames = malloc(sizeof *frames * PIXELS * LEVELS * 4);
	double *energy = malloc(sizeof *energy * PIXELS);
	optla_photon_transfer_level levels[LEVELS];
	optla_status status = OPTLA_OK;
	for (int k = 0; k < LEVELS && !status; k++) {
		float *f = frames + (size_t)k * 4 * PIXELS;
		const double electrons = 1.2 * optla_sensor_capacity_e(s) * (k + 0.3) / LEVELS;
		levels[k] = (optla_photon_transfer_level){.bright = {f, f + PIXELS},
		                                          .dark = {f + 2 * PIXELS, f + 3 * PIXELS},
		                                          .count = PIXELS,
		                                          .photons_per_pixel = photons ? 2 * electrons : 0};
		for (int i = 0; i < 4 && !status; i++) {
			for (int m = 0; m < PIXELS; m++) energy[m] = i < 2 ? electrons / s->psi_e_per_j : 0;
			status = optla_sensor_expose(ctx, s, energy, PIXELS, 9, (uint64_t)(4 * k + i), f + i * PIXELS, NULL);
		}
	}
	if (!status) status = optla_sensor_measure(ctx, levels, LEVELS, t, back);
	free(energy);
	free(frames);
	return status;
}

START_TEST(photon_transfer_gives_the_model_back)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	const optla_sensor *s = optla_sensor_preset("ccd-12bit");
	optla_photon_transfer t;
	optla_sensor back = {.bits = s->bits};
	ok(measure_model(ctx, s, true, &t, &back));
	/* A variance from 40 000 pairs has a standard error of sqrt(2/40000) = 0.7 %; the slope over 7 levels about 0.6 %: 5 of them. */
	near_rel(t.gain_dn_per_e, 1 / s->gain_e_per_dn, 0.03);
	near_rel(t.quantum_efficiency, 0.5, 0.03);
	near_rel(t.read_noise_e, s->read_noise_dn * s->gain_e_per_dn,
	         0.05); /* read noise 0.5 % from its variance, and the gain's error */
	near_abs(t.black_level_dn, s->black_level_dn, 5 * 3.1 / sqrt(2 * PIXELS) * 2); /* intercept: twice a level's standard error */
	ck_assert_double_lt(t.linearity_error, 1e-3); /* means are known to 1/sqrt(2 N signal) < 0.02 % */
	ck_assert_uint_ge(t.levels_used, 5);
	/* Saturation: the last level below the ADC's top, levels are a tenth of the capacity apart. */
	near_rel(t.full_well_e, optla_sensor_capacity_e(s), 0.15);
	near_rel(back.gain_e_per_dn, 1 / t.gain_dn_per_e, 1e-15);
	near_rel(back.full_well_e, t.full_well_e + t.black_level_dn / t.gain_dn_per_e, 1e-15);
	ck_assert_int_eq(back.bits, 12);
	ok(optla_sensor_check(ctx, &back));
	ok(measure_model(ctx, s, false, &t, &back));
	ck_assert_double_eq(t.quantum_efficiency, 0);
	ck_assert_double_eq(t.linearity_error, 0);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(linearity_is_the_distance_to_the_best_line)
{
	/* Noiseless means with the pattern +1 %, -1 %, +1 % about a line: the best line's largest deviation is that 1 %. */
	enum { N = 5 };
	optla_ctx *ctx = test_ctx(NULL, 1);
	static float bright[N + 1][2][2], dark[2][2] = {{10, 10}, {10, 10}};
	optla_photon_transfer_level levels[N + 1];
	const double mean[N + 1] = {1010, 1980, 3030, 4000, 5000, 9000};
	for (int k = 0; k <= N; k++) {
		/* deviations ±d in antiphase: mean difference 0, variance 4 d² / 2 */
		const float d = k == N ? 200 : (float)sqrt(mean[k] / 2) / 10;
		for (int i = 0; i < 2; i++)
			for (int m = 0; m < 2; m++) bright[k][i][m] = 10 + (float)mean[k] + ((i + m) % 2 ? d : -d);
		levels[k] = (optla_photon_transfer_level){.bright = {bright[k][0], bright[k][1]},
		                                          .dark = {dark[0], dark[1]},
		                                          .count = 2,
		                                          .photons_per_pixel = 1000.0 * (k + 1)};
	}
	optla_photon_transfer t;
	ok(optla_sensor_measure(ctx, levels, N + 1, &t, NULL));
	near_rel(t.linearity_error, 0.01, 1e-5); /* floats hold counts to 6e-8, their differences of 20 counts to 1e-6 */
	ck_assert_uint_eq(t.levels_used, N);
	near_rel(t.saturation_dn, 9000, 1e-6);
	/* two photon numbers, in orders in which they name no line, one line, several: not known */
	for (int order = 0; order < 3; order++) {
		static const double photons[3][N] = {{1000, 2000, 1000, 1000, 1000}, {1000, 1000, 1000, 2000, 2000}, {2, 1, 2, 1, 2}};
		for (int k = 0; k < N; k++) levels[k].photons_per_pixel = photons[order][k];
		ok(optla_sensor_measure(ctx, levels, N + 1, &t, NULL));
		ck_assert_double_eq(t.linearity_error, 0);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(photon_transfer_refuses_what_it_cannot_use)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	float f[4] = {1, 2, 3, 4};
	optla_photon_transfer_level l[4];
	for (int k = 0; k < 4; k++) l[k] = (optla_photon_transfer_level){.bright = {f, f}, .dark = {f, f}, .count = 4};
	optla_photon_transfer t;
	status_is(optla_sensor_measure(ctx, l, 0, &t, NULL), OPTLA_ERR_ARG);
	status_is(optla_sensor_measure(ctx, l, 4, &t, NULL), OPTLA_ERR_ARG);
	ck_assert_ptr_nonnull(strstr(e.text, "a photon transfer curve needs 3"));
	l[2].dark[1] = NULL;
	status_is(optla_sensor_measure(ctx, l, 4, &t, NULL), OPTLA_ERR_ARG);
	ck_assert_ptr_nonnull(strstr(e.text, "level 2: two bright and two dark frames"));
	l[2].dark[1] = f;
	f[3] = NAN;
	status_is(optla_sensor_measure(ctx, l, 4, &t, NULL), OPTLA_ERR_ARG);
	ck_assert_ptr_nonnull(strstr(e.text, "level 0: the frames hold NaN"));
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
	for (long k = 0;; k++) {
		alloc_budget b = {.left = 1000};
		const optla_ctx_desc d = {.size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b, .threads = 1};
		optla_ctx *ctx;
		ok(optla_ctx_create(&ctx, &d));
		static float f[2][2] = {{1, 2}, {2, 1}};
		const optla_photon_transfer_level l = {.bright = {f[0], f[1]}, .dark = {f[0], f[1]}, .count = 2};
		optla_photon_transfer t;
		b.left = k;
		const optla_status s = optla_sensor_measure(ctx, &l, 1, &t, NULL);
		optla_ctx_destroy(&ctx);
		ck_assert_int_eq(b.live, 0);
		if (s == OPTLA_ERR_ARG) break; /* all allocations were made: one level is too few */
		ck_assert_int_eq(s, OPTLA_ERR_NOMEM);
	}
}
END_TEST

int main(void)
{
	Suite *s = suite_create("sensor");
	TCase *t = tcase_create("sensor");
	tcase_set_timeout(t, 60);
	tcase_add_test(t, presets_are_valid_and_named);
	tcase_add_test(t, wrong_fields_are_named);
	tcase_add_test(t, energies_must_be_light);
	tcase_add_test(t, clips_at_adc_and_full_well);
	tcase_add_test(t, noise_is_a_function_of_seed_readout_and_pixel);
	tcase_add_test(t, inverse_undoes_the_means);
	tcase_add_test(t, photon_transfer_gives_the_model_back);
	tcase_add_test(t, linearity_is_the_distance_to_the_best_line);
	tcase_add_test(t, photon_transfer_refuses_what_it_cannot_use);
	tcase_add_test(t, every_allocation_may_fail);
	suite_add_tcase(s, t);
	return run_suite(s);
}
