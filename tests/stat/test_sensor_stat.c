/* SPDX-License-Identifier: BSD-3-Clause */
/* The sensor against Eqs. 1.3-1.8 by z-tests and chi-square, the real frames of EMVA's reference camera, and the noise of a rig's
   photos. A z-test here allows 5 standard errors: 1 false alarm in 1.7 million; seeds are fixed, so there is none. */
#include "math/dense.h"
#include "near.h"
#include "optla/image.h"
#include "optla/rig.h"
#include "optla/sensor.h"

enum { N = 200000 };
#define Z 5.0

/* Mean, variance and fourth central moment of one readout of N equal pixels. */
typedef struct {
	double mean, variance, fourth;
	size_t saturated;
} moments;

static moments readout(optla_ctx *ctx, const optla_sensor *s, double electrons, uint64_t index, float *raw)
{
	double *energy = malloc(N * sizeof *energy);
	float *own = raw ? raw : malloc(N * sizeof *own);
	moments r = {0, 0, 0, 0};
	for (size_t m = 0; m < N; m++) energy[m] = electrons / s->psi_e_per_j;
	ok(optla_sensor_expose(ctx, s, energy, N, 2024, index, own, &r.saturated));
	for (size_t m = 0; m < N; m++) r.mean += (double)own[m] / N;
	for (size_t m = 0; m < N; m++) {
		const double d = (double)own[m] - r.mean;
		r.variance += d * d / (N - 1);
		r.fourth += d * d * d * d / N;
	}
	if (!raw) free(own);
	free(energy);
	return r;
}

/* Standard error of a variance from N samples with this fourth moment. */
static double variance_error(const moments *r) { return sqrt((r->fourth - r->variance * r->variance) / N); }

START_TEST(mean_and_variance_follow_the_photon_transfer_curve)
{
	/* E = x/g + offset, Var = σ² + x/g² + 1/12 (Eqs. 1.3, 1.5, 1.8). Quantisation noise is 1/12 and uncorrelated with the signal when
	   that is spread over a count or more (B. Widrow): σ_total >= 0.6 counts makes the error below 2 exp(-2 π² 0.36) = 1.6e-3 of it. */
	optla_ctx *ctx = test_ctx(NULL, 2);
	const char *names[] = {"dslr-14bit", "ccd-12bit", "video-8bit"};
	const double share[] = {0.001, 0.01, 0.05, 0.2, 0.5, 0.9};
	uint64_t index = 0;
	for (int k = 0; k < 3; k++) {
		const optla_sensor *s = optla_sensor_preset(names[k]);
		for (int i = 0; i < 6; i++) {
			const double e = share[i] * optla_sensor_capacity_e(s), g = s->gain_e_per_dn;
			const double want = s->read_noise_dn * s->read_noise_dn + e / (g * g) + 1.0 / 12;
			if (want - 1.0 / 12 < 0.36) continue;
			const moments r = readout(ctx, s, e, index++, NULL);
			near_abs(r.mean, e / g + s->black_level_dn, Z * sqrt(want / N));
			near_abs(r.variance, want, Z * variance_error(&r) + 1.6e-3 / 12);
			const double energy = e / s->psi_e_per_j, j_per_dn = g / s->psi_e_per_j;
			near_rel(optla_sensor_variance_j2(s, energy), want * j_per_dn * j_per_dn, 1e-12);
			/* Eq. 1.8 from the counts themselves: d(20 log10 v)/dv = 8.69/v, for the signal and half of it for the variance. */
			const double snr = 20 * log10((r.mean - s->black_level_dn) / sqrt(r.variance));
			const double signal = e / g;
			near_abs(snr, optla_sensor_snr_db(s, energy),
			         Z * 8.69 * (sqrt(want / N) / signal + 0.5 * variance_error(&r) / r.variance) + 1e-3);
			ck_assert_uint_eq(r.saturated,
			                  0); /* 0.9 of capacity is more than 20 standard deviations below it but for 8 bit: 10 */
		}
	}
	ck_assert_uint_ge(index, 15);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(slope_of_the_curve_is_the_gain)
{
	/* Photon transfer of 12 levels: variance over mean falls on a line of slope 1/g and intercept σ² + 1/12. */
	optla_ctx *ctx = test_ctx(NULL, 2);
	const optla_sensor *s = optla_sensor_preset("ccd-12bit");
	double chi2 = 0;
	enum { LEVELS = 12 };
	for (int k = 0; k < LEVELS; k++) {
		const moments r = readout(ctx, s, optla_sensor_capacity_e(s) * 0.9 * k / LEVELS, 100 + (uint64_t)k, NULL);
		const double line = s->read_noise_dn * s->read_noise_dn + 1.0 / 12 + (r.mean - s->black_level_dn) / s->gain_e_per_dn;
		chi2 += pow((r.variance - line) / variance_error(&r), 2);
	}
	ck_assert_double_lt(chi2, 46); /* 99.9993 % quantile of chi-square(12) */
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(read_noise_is_gaussian)
{
	/* In the dark, counts of floor(black + σ n + 1/2): cell k has probability Φ((k + ½ - b)/σ) - Φ((k - ½ - b)/σ). */
	optla_ctx *ctx = test_ctx(NULL, 2);
	const optla_sensor *s = optla_sensor_preset("dslr-14bit");
	float *raw = malloc(N * sizeof *raw);
	readout(ctx, s, 0, 300, raw);
	enum { CELLS = 49 }; /* 1000 .. 1048: ± 3.5 σ; the two outer cells take the tails */
	double seen[CELLS] = {0}, chi2 = 0;
	for (size_t m = 0; m < N; m++) {
		const int cell = (int)raw[m] - 1000;
		seen[cell < 0 ? 0 : cell >= CELLS ? CELLS - 1 : cell]++;
	}
	for (int k = 0; k < CELLS; k++) {
		const double lo = (1000 + k - 0.5 - s->black_level_dn) / s->read_noise_dn, hi = lo + 1 / s->read_noise_dn;
		const double below = k ? 0.5 * erfc(-lo / sqrt(2)) : 0, above = k < CELLS - 1 ? 0.5 * erfc(-hi / sqrt(2)) : 1;
		chi2 += pow(seen[k] - N * (above - below), 2) / (N * (above - below));
	}
	ck_assert_double_lt(chi2, 106); /* 99.9997 % quantile of chi-square(48) */
	free(raw);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(photon_noise_is_poisson)
{
	/* One electron a count, no read noise: counts are the electrons themselves (Eq. 1.6). */
	optla_ctx *ctx = test_ctx(NULL, 2);
	const optla_sensor s = {.size = sizeof s, .psi_e_per_j = 5, .gain_e_per_dn = 1, .full_well_e = 1e6, .bits = 16};
	const double means[] = {0.7, 6, 40};
	float *raw = malloc(N * sizeof *raw);
	for (int k = 0; k < 3; k++) {
		readout(ctx, &s, means[k], 400 + (uint64_t)k, raw);
		enum { CELLS = 100 };
		double seen[CELLS] = {0}, chi2 = 0, rest = N, tail = 0;
		int cells = 0;
		for (size_t m = 0; m < N; m++) seen[raw[m] < CELLS ? (int)raw[m] : CELLS - 1]++;
		for (int x = 0; x < CELLS; x++) {
			const double expected = N * exp(x * log(means[k]) - means[k] - lgamma(x + 1.0));
			if (expected < 10) { /* too few for chi-square: together in one cell */
				tail += seen[x];
				continue;
			}
			chi2 += pow(seen[x] - expected, 2) / expected;
			rest -= expected;
			cells++;
		}
		if (rest > 1) chi2 += pow(tail - rest, 2) / rest;
		ck_assert_msg(chi2 < cells + Z * sqrt(2.0 * cells) + 10, "mean %g: chi-square %g of %d cells", means[k], chi2, cells);
	}
	free(raw);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(quantisation_error_is_uniform)
{
	/* Many electrons a count, smooth over them: x/g - round(x/g) is even over ±½. Electrons come from the same draw read twice: once
	   at a gain of 1 (exact), once at 64; read noise is off. */
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_sensor s = {.size = sizeof s, .psi_e_per_j = 1, .gain_e_per_dn = 1, .full_well_e = 1e9, .bits = 24};
	float *electrons = malloc(N * sizeof *electrons), *counts = malloc(N * sizeof *counts);
	readout(ctx, &s, 50000, 500, electrons); /* standard deviation 224 e: 3.5 counts of 64 e */
	s.gain_e_per_dn = 64;
	readout(ctx, &s, 50000, 500, counts);
	double seen[64] = {0}, chi2 = 0, square = 0;
	for (size_t m = 0; m < N; m++) {
		const double error = (double)counts[m] - (double)electrons[m] / 64;
		ck_assert(error > -0.5 - 1e-9 && error <= 0.5 + 1e-9);
		seen[(int)floor((error + 0.5) * 64 - 1e-6 + 64) % 64]++; /* 64 values are possible */
		square += error * error / N;
	}
	for (int k = 0; k < 64; k++) chi2 += pow(seen[k] - N / 64.0, 2) / (N / 64.0);
	ck_assert_double_lt(chi2, 127); /* 99.9996 % quantile of chi-square(63) */
	/* b²/12, plus (1/64)²/6 for 64 steps with one at +½; variance of e²: 1/180 */
	near_abs(square, 1.0 / 12, Z * sqrt(1.0 / 180 / N) + 1.0 / 4096);
	free(counts);
	free(electrons);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(clipping_takes_the_expected_share)
{
	/* At the mean equal to the clipping level half is clipped: by full well, and by the ADC. Poisson of mean µ >= 1e4 is normal to 1/√µ. */
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_sensor s = *optla_sensor_preset("ccd-12bit");
	for (int k = 0; k < 2; k++) {
		if (k) s.full_well_e = 9000; /* 2513.97 counts: 2513 is the largest */
		const double top = k ? floor(9000 / s.gain_e_per_dn) : 4095, g = s.gain_e_per_dn;
		const double e = (top + 0.5 - s.black_level_dn) * g; /* rounding up to top + 1 begins here */
		const double sd = sqrt(e / (g * g) + s.read_noise_dn * s.read_noise_dn);
		float *raw = malloc(N * sizeof *raw);
		const moments r = readout(ctx, &s, e, 600 + (uint64_t)k, raw);
		/* P(x > mean) of a Poisson variable is ½ - 1/(6 √(2 π µ)) to the next order: within 1/√(2 π µ) of ½ in any case */
		near_abs((double)r.saturated / N, 0.5, Z * 0.5 / sqrt(N) + 1 / sqrt(2 * 3.14159265 * e));
		for (size_t m = 0; m < N; m++) ck_assert(raw[m] <= (float)top);
		/* mean of min(X, top), X normal about top + ½: top + ½ - E max(0, X - top) ... = top - sd/√(2π) + 1/4 up to 0.3 counts */
		near_abs(r.mean, top + 0.25 - sd / sqrt(2 * 3.14159265), Z * sd / sqrt(N) + 0.3);
		free(raw);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- the real camera ---- */

#define EMVA OPTLA_SHARED_DATA "/emva1288-ccd12/"
enum { LEVELS_MAX = 64 };

typedef struct {
	double exposure_ns, photons;
	char file[2][128];
	int files;
} emva_set;

/* Reads 'b exposure photons', 'd exposure' and 'i file' lines. */
static int read_list(emva_set *bright, int *nbright, emva_set *dark, int *ndark)
{
	FILE *f = fopen(EMVA "subset.txt", "r");
	if (!f) return 0;
	char line[256], kind, name[128];
	emva_set *set = NULL;
	*nbright = *ndark = 0;
	while (fgets(line, sizeof line, f)) {
		double a, b = 0;
		if ((line[0] == 'b' || line[0] == 'd') && sscanf(line, "%c %lf %lf", &kind, &a, &b) >= 2) {
			set = kind == 'b' ? &bright[(*nbright)++] : &dark[(*ndark)++];
			*set = (emva_set){.exposure_ns = a, .photons = b};
			ck_assert_int_lt(*nbright + *ndark, LEVELS_MAX);
		} else if (set && sscanf(line, "i %127s", name) == 1) {
			if (set->files < 2) snprintf(set->file[set->files], sizeof set->file[0], "%s", name);
			set->files++;
		}
	}
	fclose(f);
	return 1;
}

START_TEST(real_camera_gives_its_gain_back)
{
	skip_without(OPTLA_SHARED_DATA "/emva1288-ccd12");
	static emva_set bright[LEVELS_MAX], dark[LEVELS_MAX];
	int nbright, ndark;
	ck_assert(read_list(bright, &nbright, dark, &ndark));
	optla_ctx *ctx = test_ctx(NULL, 0);
	optla_photon_transfer_level levels[LEVELS_MAX];
	optla_image *images[4 * LEVELS_MAX];
	char paths[4 * LEVELS_MAX][256];
	const char *list[4 * LEVELS_MAX];
	size_t n = 0;
	for (int b = 0; b < nbright; b++)
		for (int d = 0; d < ndark; d++) {
			if (bright[b].files != 2 || dark[d].files != 2 || bright[b].exposure_ns != dark[d].exposure_ns) continue;
			for (int i = 0; i < 4; i++) {
				snprintf(paths[4 * n + (size_t)i], sizeof paths[0], EMVA "%s", i < 2 ? bright[b].file[i] : dark[d].file[i - 2]);
				list[4 * n + (size_t)i] = paths[4 * n + (size_t)i];
			}
			levels[n++].photons_per_pixel = bright[b].photons;
		}
	ck_assert_uint_eq(n, 13);
	ok(optla_image_load_stack(ctx, list, 4 * n, images));
	for (size_t k = 0; k < n; k++) {
		for (int i = 0; i < 2; i++) {
			levels[k].bright[i] = images[4 * k + (size_t)i]->data;
			levels[k].dark[i] = images[4 * k + 2 + (size_t)i]->data;
		}
		levels[k].count = images[4 * k]->width * images[4 * k]->height;
		ck_assert_uint_eq(levels[k].count, 640 * 480);
	}
	optla_photon_transfer t;
	optla_sensor s = {.bits = 12};
	ok(optla_sensor_measure(ctx, levels, n, &t, &s));
	printf("# EMVA CCD: K %.4f DN/e, QE %.3f, read noise %.2f e, black %.2f DN, full well %.0f e, saturation %.1f DN, "
	       "linearity %.3f %%, %zu levels\n",
	       t.gain_dn_per_e, t.quantum_efficiency, t.read_noise_e, t.black_level_dn, t.full_well_e, t.saturation_dn,
	       100 * t.linearity_error, t.levels_used);
	near_rel(t.gain_dn_per_e, 0.277, 0.02); /* from all 300 frames, by an independent calculation */
	ck_assert_double_lt(t.linearity_error, 0.003);
	ck_assert_uint_eq(t.levels_used, 7);
	/* Bounds that hold for any camera of this kind: a 12-bit CCD of 1/2-inch class reads with 5 to 20 e; its ADC ends at 4095 counts,
	   so the well seen is at most 4095/K and, with levels 9 % of it apart, at least 85 % of that; silicon of a front-lit CCD turns
	   20 to 70 % of visible photons into electrons. */
	ck_assert(t.read_noise_e > 5 && t.read_noise_e < 20);
	ck_assert(t.full_well_e < 4095 / t.gain_dn_per_e && t.full_well_e > 0.85 * 4095 / t.gain_dn_per_e);
	ck_assert(t.quantum_efficiency > 0.2 && t.quantum_efficiency < 0.7);
	/* The preset is this camera. */
	const optla_sensor *preset = optla_sensor_preset("ccd-12bit");
	near_rel(s.gain_e_per_dn, preset->gain_e_per_dn, 0.005);
	near_rel(s.read_noise_dn, preset->read_noise_dn, 0.01);
	near_abs(s.black_level_dn, preset->black_level_dn, 0.05);
	near_rel(s.psi_e_per_j, preset->psi_e_per_j, 0.01);
	ok(optla_sensor_check(ctx, &s));
	for (size_t k = 0; k < 4 * n; k++) optla_image_destroy(&images[k]);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- photos of a rig ---- */

enum { M = 64, L = 36, RUNS = 400 };

/* Mean and variance of y over RUNS photos of x, against exact + ambient and against the estimate of the operator. */
static void check_photos(optla_rig *rig, optla_rig_operator_options o, optla_trans trans)
{
	optla_op *noisy, *exact;
	ok(optla_rig_light_operator(rig, &o, &noisy));
	o.sensor = NULL;
	ok(optla_rig_light_operator(rig, &o, &exact));
	const size_t nin = trans == OPTLA_FORWARD ? optla_op_ncols(noisy) : optla_op_nrows(noisy),
	             nout = trans == OPTLA_FORWARD ? optla_op_nrows(noisy) : optla_op_ncols(noisy);
	double *x = malloc(nin * sizeof *x), *want = malloc(nout * sizeof *want), *y = malloc(nout * sizeof *y),
	       *sum = calloc(nout, sizeof *sum), total = 0, estimate = 0, square_sum = 0;
	for (size_t k = 0; k < nin; k++) x[k] = 0.2 + (double)(k % 5) / 3;
	const optla_cblock in = optla_cblock_(x, nin, 1, OPTLA_F64);
	ok(optla_op_apply(exact, trans, in, optla_block_(want, nout, 1, OPTLA_F64)));
	for (int r = 0; r < RUNS; r++) {
		ok(optla_op_apply(noisy, trans, in, optla_block_(y, nout, 1, OPTLA_F64)));
		double norm2 = 0;
		for (size_t m = 0; m < nout; m++) {
			sum[m] += y[m] - want[m];
			norm2 += (y[m] - want[m]) * (y[m] - want[m]);
		}
		total += norm2 / RUNS;
		square_sum += norm2 * norm2 / RUNS;
		estimate += optla_op_noise(noisy) * optla_op_noise(noisy) / RUNS;
	}
	/* E ||e||² as estimated from each photo against what the errors are; standard error from the spread of the runs. The estimate
	   itself is off by no more than the photo's own noise, much less. */
	near_abs(total, estimate, Z * sqrt((square_sum - total * total) / RUNS) + 1e-3 * estimate);
	/* No bias: the sum over all samples of the mean error against its standard error. */
	double bias = 0;
	for (size_t m = 0; m < nout; m++) bias += sum[m] / RUNS;
	near_abs(bias, 0, Z * sqrt(total / RUNS));
	free(sum);
	free(y);
	free(want);
	free(x);
	optla_op_unref(&exact);
	optla_op_unref(&noisy);
}

START_TEST(photos_of_a_rig_are_unbiased_and_know_their_noise)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_rig *rig;
	ok(optla_rig_corner(ctx, 8, 6, false, &rig));
	const optla_channel channels[] = {OPTLA_CHANNEL_GREY, OPTLA_CHANNEL_RED, OPTLA_CHANNEL_ALL};
	for (int c = 0; c < 3; c++)
		for (int t = 0; t < 2; t++) {
			optla_rig_operator_options o = optla_rig_operator_defaults;
			o.type = OPTLA_F64;
			o.channel = channels[c];
			o.sensor = optla_sensor_preset("ccd-12bit");
			o.ambient = t ? 0.1 : 0;
			o.exposure = t ? 0.5 : 1;
			o.seed = (uint64_t)(10 * c + t);
			check_photos(rig, o, t ? OPTLA_TRANSPOSE : OPTLA_FORWARD);
		}
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(ambient_light_cancels_in_both_splittings)
{
	/* The mean of signed products under strong ambient light is T x: the ambient light, 30 times the signal here, is gone to the
	   standard error of RUNS products. */
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_rig *rig;
	ok(optla_rig_corner(ctx, 8, 6, false, &rig));
	optla_op *truth;
	ok(optla_rig_truth(rig, OPTLA_CHANNEL_GREY, &truth));
	const optla_split splits[] = {OPTLA_SPLIT_SIGNED, OPTLA_SPLIT_OFFSET};
	for (int k = 0; k < 2; k++) {
		optla_rig_operator_options o = optla_rig_operator_defaults;
		o.type = OPTLA_F64;
		o.sensor = optla_sensor_preset("dslr-14bit");
		o.full_scale = 0.3;
		o.ambient = 1;
		o.split = splits[k];
		double x[L], want[M], y[M], bias = 0, square = 0;
		for (int n = 0; n < L; n++) x[n] = n % 2 ? 1 : -1;
		ok(optla_op_apply(truth, OPTLA_FORWARD, optla_cblock_(x, L, 1, OPTLA_F64), optla_block_(want, M, 1, OPTLA_F64)));
		for (int r = 0; r < RUNS; r++) {
			optla_op *op; /* made anew: T1 and the dark frame of the offset splitting are taken once for each operator */
			o.seed = (uint64_t)(1000 + r);
			ok(optla_rig_operator(rig, &o, &op));
			ok(optla_op_apply(op, OPTLA_FORWARD, optla_cblock_(x, L, 1, OPTLA_F64), optla_block_(y, M, 1, OPTLA_F64)));
			double mean = 0;
			for (int m = 0; m < M; m++) mean += (y[m] - want[m]) / M;
			bias += mean / RUNS;
			square += mean * mean / RUNS;
			optla_op_unref(&op);
		}
		near_abs(bias, 0, Z * sqrt(square / RUNS));
		double scale = 0;
		for (int m = 0; m < M; m++) scale = fmax(scale, fabs(want[m]));
		ck_assert_double_lt(sqrt(square / RUNS), 1e-2 * scale); /* the test would see a thousandth of the ambient light */
	}
	optla_op_unref(&truth);
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("sensor_stat");
	TCase *t = tcase_create("sensor_stat");
	tcase_set_timeout(t, 240);
	tcase_add_test(t, mean_and_variance_follow_the_photon_transfer_curve);
	tcase_add_test(t, slope_of_the_curve_is_the_gain);
	tcase_add_test(t, read_noise_is_gaussian);
	tcase_add_test(t, photon_noise_is_poisson);
	tcase_add_test(t, quantisation_error_is_uniform);
	tcase_add_test(t, clipping_takes_the_expected_share);
	tcase_add_test(t, real_camera_gives_its_gain_back);
	tcase_add_test(t, photos_of_a_rig_are_unbiased_and_know_their_noise);
	tcase_add_test(t, ambient_light_cancels_in_both_splittings);
	suite_add_tcase(s, t);
	return run_suite(s);
}
