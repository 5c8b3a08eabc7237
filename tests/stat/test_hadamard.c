/* SPDX-License-Identifier: BSD-3-Clause */
/* Multiplexing: how much better T is captured with Hadamard patterns than with single lights, when read noise dominates.
 *
 * Y. Schechner, S. Nayar, P. Belhumeur, Multiplexing for optimal lighting, PAMI 2007. With n lights and photos of variance σ²:
 *
 *   signed, two photos for each product (Eq. 2.4): d_j = T h_j + e_j, var e_j = 2 σ², and T is estimated by D Hᵀ / n, so that its
 *   entries have variance 2 σ² / n. A single light through the same operator: 2 σ². Gain in signal to noise √n, photos equal.
 *
 *   offset, one photo at twice the power of a single light, T h_j = y(h_j + 1) - y(1) - y(0): T's columns but the first have
 *   ((n - 1) 4 + 2) σ² / n², about 4 σ² / n. One photo of a single light has σ². Gain n / √(4 n - 2), which is √n / 2: that of the S-matrix,
 *   (n + 1) / (2 √n), but for terms of order 1 / n. The first column carries the noise of the reference frames y(1), y(0).
 */
#include "near.h"
#include "optla/relight.h"
#include "optla/rig.h"

enum { CAMERA = 16, PROJECTOR = 8, N = PROJECTOR * PROJECTOR, SEEDS = 8 };

/* Photons' own noise is 1e-3 of the read noise' variance (at most 1.3e7 electrons against (1e5)²), nothing is clipped (10 σ above
   zero) and rounding to whole counts is 1e-11. */
static const optla_sensor noisy = {.size = sizeof noisy,
                                   .psi_e_per_j = 1,
                                   .gain_e_per_dn = 1,
                                   .read_noise_dn = 1e5,
                                   .black_level_dn = 1e6,
                                   .full_well_e = 1.6e7,
                                   .bits = 24};

/* Squared relative error of all of T, mean over the seeds, and photos of one capture. method: SINGLE or HADAMARD; split < 0: the light
   operator itself. */
static double captured_error(optla_rig *rig, optla_capture method, int split, uint64_t *photos)
{
	optla_op *truth;
	ok(optla_rig_truth(rig, OPTLA_CHANNEL_GREY, &truth));
	const size_t ks[] = {N};
	double sum = 0;
	for (uint64_t seed = 1; seed <= SEEDS; seed++) {
		optla_rig_operator_options o = optla_rig_operator_defaults;
		o.channel = OPTLA_CHANNEL_GREY;
		o.type = OPTLA_F64;
		o.sensor = &noisy;
		o.seed = seed;
		if (split >= 0) o.split = (optla_split)split;
		optla_op *op;
		if (split >= 0)
			ok(optla_rig_operator(rig, &o, &op));
		else
			ok(optla_rig_light_operator(rig, &o, &op));
		const optla_capture_options capture = {.size = sizeof capture, .seed = seed, .ks = ks, .nks = 1};
		optla_capture_point at;
		ok(optla_capture_curve(method, op, NULL, truth, PROJECTOR, PROJECTOR, &capture, &at));
		sum += at.relative_error * at.relative_error;
		*photos = at.photos;
		optla_op_unref(&op);
	}
	optla_op_unref(&truth);
	return sum / SEEDS;
}

/* Each mean square is over 256 pixels x 64 lights x 8 seeds = 131 000 independent numbers: its standard error is sqrt(2 / 131 000) =
   0.39 %, that of the gain (square root of a ratio of two) 0.28 %. 1.4 % is five of them. */
START_TEST(signed_gain_is_the_root_of_n)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	optla_rig *rig;
	uint64_t photos_single, photos_hadamard;
	ok(optla_rig_corner(ctx, CAMERA, PROJECTOR, false, &rig));
	const double single = captured_error(rig, OPTLA_CAPTURE_SINGLE, OPTLA_SPLIT_SIGNED, &photos_single);
	const double hadamard = captured_error(rig, OPTLA_CAPTURE_HADAMARD, OPTLA_SPLIT_SIGNED, &photos_hadamard);
	ck_assert_uint_eq(photos_single, 2 * N);
	ck_assert_uint_eq(photos_hadamard, 2 * N);
	near_rel(sqrt(single / hadamard), sqrt(N), 0.014);
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* Sum over columns, in σ²: the n - 1 ordinary ones and the first. The first has the patterns' photos, ((n - 1) 4 + 1) / n², and the
   reference frames: y(1) enters n - 1 products of n, y(0) all of them. Those are 256 x 8 numbers each that make a third of the whole: the
   standard error of the sum is a third of sqrt(2 / 2048 / 2), 0.74 %, that of the gain 0.4 % with the single lights' own. */
static double offset_variance(double n)
{
	const double ordinary = ((n - 1) * 4 + 2) / (n * n), lit = (n - 1) / n;
	return (n - 1) * ordinary + ((n - 1) * 4 + 1) / (n * n) + lit * lit + 1;
}

START_TEST(offset_gain_is_that_of_the_s_matrix)
{
	optla_ctx *ctx = test_ctx(NULL, 0);
	optla_rig *rig;
	uint64_t photos_single, photos_hadamard;
	ok(optla_rig_corner(ctx, CAMERA, PROJECTOR, false, &rig));
	const double single = captured_error(rig, OPTLA_CAPTURE_SINGLE, -1, &photos_single);
	const double hadamard = captured_error(rig, OPTLA_CAPTURE_HADAMARD, OPTLA_SPLIT_OFFSET, &photos_hadamard);
	ck_assert_uint_eq(photos_single, N);
	ck_assert_uint_eq(photos_hadamard, N + 2);
	near_rel(sqrt(single / hadamard), sqrt(N / offset_variance(N)), 0.02); /* five standard errors */
	/* without the first column the gain is the S-matrix' to 1 / n: the two formulas, n = 64 */
	near_rel(N / sqrt(4.0 * N - 2), (N + 1) / (2 * sqrt(N)), 1.5 / N);
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("hadamard");
	TCase *gain = tcase_create("gain");
	tcase_add_test(gain, signed_gain_is_the_root_of_n);
	tcase_add_test(gain, offset_gain_is_that_of_the_s_matrix);
	tcase_set_timeout(gain, 120);
	suite_add_tcase(suite, gain);
	return run_suite(suite);
}
