/* SPDX-License-Identifier: BSD-3-Clause */
/* A sensor's constants from pairs of evenly lit frames. EMVA Standard 1288, Standard for Characterization of Image Sensors and
   Cameras, release 3.1 (2016), section 6. The difference of two frames holds the temporal noise alone: fixed patterns cancel. */
#include "base/base_impl.h"
#include "capture/photon.h"
#include "optla/sensor.h"

#include <math.h>
#include <string.h>

typedef struct {
	double photons, mean, variance, dark_mean, dark_variance; /* counts, counts² */
} level;

/* var = <(y1 - y2)²>/2 - (<y1> - <y2>)²/2: the second term removes a flicker of the lamp between the frames. */
static void pair_statistics(const float *const y[2], size_t count, double *mean, double *variance)
{
	double sum[2] = {0, 0}, square = 0;
	for (size_t m = 0; m < count; m++) {
		const double d = (double)y[0][m] - (double)y[1][m];
		sum[0] += (double)y[0][m];
		sum[1] += (double)y[1][m];
		square += d * d;
	}
	const double n = (double)count, difference = (sum[0] - sum[1]) / n;
	*mean = (sum[0] + sum[1]) / (2 * n);
	*variance = (square / n - difference * difference) / 2;
}

/* Least squares line y = a + b x of n points. False when all x are the same. */
static bool fit_line(const double *x, const double *y, size_t n, double *a, double *b)
{
	double mx = 0, my = 0, xx = 0, xy = 0;
	for (size_t k = 0; k < n; k++) {
		mx += x[k] / (double)n;
		my += y[k] / (double)n;
	}
	for (size_t k = 0; k < n; k++) {
		xx += (x[k] - mx) * (x[k] - mx);
		xy += (x[k] - mx) * (y[k] - my);
	}
	*b = xx > 0 ? xy / xx : 0;
	*a = my - *b * mx;
	return xx > 0;
}

/* Value at x = 0 of the line through the points; their mean when x says nothing. */
static double intercept(const double *x, const double *y, size_t n)
{
	double a, b;
	fit_line(x, y, n, &a, &b);
	return a;
}

/* Largest |a + b x - y| / y of a line. */
static double worst_deviation(const double *x, const double *y, size_t n, double a, double b)
{
	double worst = 0;
	for (size_t k = 0; k < n; k++) worst = fmax(worst, fabs(a + b * x[k] - y[k]) / y[k]);
	return worst;
}

/* Levels at two photon numbers show how well levels repeat, not how straight the response is. */
static bool three_differ(const double *x, size_t n)
{
	size_t second = 0;
	for (size_t k = 1; k < n; k++) {
		if (x[k] == x[0] || (second && x[k] == x[second])) continue;
		if (second) return true;
		second = k;
	}
	return false;
}

/*
 * Straightness: the smallest e such that some line stays within relative e of every point. The best line misses three points by
 * +e, -e, +e of their values (P. L. Chebyshev's alternation; x ascending), so trying all triples finds it:
 * a + b x_k = y_k (1 + s_k e), s = +1, -1, +1.
 */
static double straightness(const double *x, const double *y, size_t n)
{
	double best = INFINITY;
	for (size_t i = 0; i < n; i++)
		for (size_t j = i + 1; j < n; j++)
			for (size_t k = j + 1; k < n; k++) {
				const double t = (x[j] - x[i]) / (x[k] - x[i]); /* eliminate a and b: value at j from those at i and k */
				const double e = (y[j] - (1 - t) * y[i] - t * y[k]) / ((1 - t) * y[i] + y[j] + t * y[k]);
				const double yi = y[i] * (1 + e), yk = y[k] * (1 + e), b = (yk - yi) / (x[k] - x[i]);
				if (isfinite(b)) best = fmin(best, worst_deviation(x, y, n, yi - b * x[i], b));
			}
	return best;
}

static optla_status check_level(optla_ctx *ctx, const optla_photon_transfer_level *l, size_t k)
{
	OPTLA_CHECK(ctx, l->bright[0] && l->bright[1] && l->dark[0] && l->dark[1] && l->count >= 2, OPTLA_ERR_ARG,
	            "level %zu: two bright and two dark frames of at least 2 pixels are needed", k);
	OPTLA_CHECK(ctx, l->photons_per_pixel >= 0 && isfinite(l->photons_per_pixel), OPTLA_ERR_ARG,
	            "level %zu: photons_per_pixel is %g: allowed is a number >= 0", k, l->photons_per_pixel);
	return OPTLA_OK;
}

static optla_status measure_levels(optla_ctx *ctx, const optla_photon_transfer_level *levels, size_t count, level *out)
{
	for (size_t k = 0; k < count; k++) {
		OPTLA_TRY(check_level(ctx, &levels[k], k));
		level *l = &out[k];
		l->photons = levels[k].photons_per_pixel;
		pair_statistics(levels[k].bright, levels[k].count, &l->mean, &l->variance);
		pair_statistics(levels[k].dark, levels[k].count, &l->dark_mean, &l->dark_variance);
		OPTLA_CHECK(ctx, isfinite(l->mean + l->variance + l->dark_mean + l->dark_variance), OPTLA_ERR_ARG,
		            "level %zu: the frames hold NaN or infinity", k);
	}
	return OPTLA_OK;
}

/* Sorts by mean (insertion: there are tens of levels). */
static void sort_levels(level *l, size_t count)
{
	for (size_t i = 1; i < count; i++)
		for (size_t j = i; j > 0 && l[j].mean < l[j - 1].mean; j--) {
			const level t = l[j];
			l[j] = l[j - 1];
			l[j - 1] = t;
		}
}

/* Index of the level with the largest temporal variance: EMVA's saturation. */
static size_t saturation_level(const level *l, size_t count)
{
	size_t at = 0;
	for (size_t k = 1; k < count; k++)
		if (l[k].variance > l[at].variance) at = k;
	return at;
}

/* Response and linearity from photon numbers: mean above black over photons, levels between 5 and 70 % of saturation (below 5 % a
   relative deviation says more about the lamp's shutter than about the sensor, so EMVA leaves those out as well). */
static void measure_response(const level *l, size_t used, double saturation_dn, double *scratch, optla_photon_transfer *out)
{
	double *x = scratch, *y = scratch + used, a, slope;
	size_t n = 0;
	for (size_t k = 0; k < used; k++) {
		const double mean = l[k].mean - l[k].dark_mean;
		if (l[k].photons <= 0) return;
		if (mean < 0.05 * saturation_dn) continue;
		x[n] = l[k].photons;
		y[n++] = mean;
	}
	if (n < 2 || !fit_line(x, y, n, &a, &slope)) return;
	out->quantum_efficiency = slope / out->gain_dn_per_e;
	if (three_differ(x, n)) out->linearity_error = straightness(x, y, n);
}

/* Dark frames of all levels, extrapolated to zero exposure over the photon number, which exposure time is proportional to. */
static void measure_dark(const level *l, size_t count, double *scratch, optla_photon_transfer *out)
{
	double *x = scratch, *y = scratch + count;
	for (size_t k = 0; k < count; k++) x[k] = l[k].photons;
	for (size_t k = 0; k < count; k++) y[k] = l[k].dark_mean;
	out->black_level_dn = intercept(x, y, count);
	for (size_t k = 0; k < count; k++) y[k] = l[k].dark_variance;
	out->read_noise_e = sqrt(fmax(0, intercept(x, y, count) - 1.0 / 12)) / out->gain_dn_per_e;
}

static optla_status measure_gain(optla_ctx *ctx, const level *l, size_t used, double *scratch, optla_photon_transfer *out)
{
	double *x = scratch, *y = scratch + used, a;
	for (size_t k = 0; k < used; k++) {
		x[k] = l[k].mean - l[k].dark_mean;
		y[k] = l[k].variance - l[k].dark_variance;
	}
	const bool spread = fit_line(x, y, used, &a, &out->gain_dn_per_e);
	OPTLA_CHECK(ctx, spread && out->gain_dn_per_e > 0, OPTLA_ERR_ARG,
	            "the variance of the %zu levels below 70 %% of saturation does not grow with their mean (slope %g): "
	            "these frames show no photon noise",
	            used, out->gain_dn_per_e);
	return OPTLA_OK;
}

static void fill_sensor(const optla_photon_transfer *t, optla_sensor *s)
{
	s->size = sizeof *s;
	s->psi_e_per_j = t->quantum_efficiency / OPTLA_PHOTON_550NM_J;
	s->gain_e_per_dn = 1 / t->gain_dn_per_e;
	s->read_noise_dn = t->read_noise_e * t->gain_dn_per_e;
	s->black_level_dn = t->black_level_dn;
	s->full_well_e = t->full_well_e + t->black_level_dn / t->gain_dn_per_e; /* Eq. 1.3 counts the black level in */
}

static optla_status measure(optla_ctx *ctx, level *l, size_t count, double *scratch, optla_photon_transfer *out)
{
	sort_levels(l, count);
	const level *top = &l[saturation_level(l, count)];
	out->saturation_dn = top->mean - top->dark_mean;
	size_t used = 0;
	while (used < count && l[used].mean - l[used].dark_mean < 0.7 * out->saturation_dn) used++;
	OPTLA_CHECK(ctx, used >= 3, OPTLA_ERR_ARG,
	            "%zu of %zu levels are below 70 %% of saturation (%g counts above black): a photon transfer curve needs 3", used,
	            count, out->saturation_dn);
	out->levels_used = used;
	OPTLA_TRY(measure_gain(ctx, l, used, scratch, out));
	out->full_well_e = out->saturation_dn / out->gain_dn_per_e;
	measure_response(l, used, out->saturation_dn, scratch, out);
	measure_dark(l, count, scratch, out);
	return OPTLA_OK;
}

optla_status optla_sensor_measure(optla_ctx *ctx, const optla_photon_transfer_level *levels, size_t count,
                                  optla_photon_transfer *out, optla_sensor *sensor)
{
	memset(out, 0, sizeof *out);
	level *l = optla_calloc_(ctx, count, sizeof *l);
	double *scratch = optla_calloc_(ctx, count, 2 * sizeof *scratch);
	optla_status status = l && scratch ? measure_levels(ctx, levels, count, l) : OPTLA_ERR_NOMEM;
	if (!status) status = count ? measure(ctx, l, count, scratch, out) : OPTLA_FAIL(ctx, OPTLA_ERR_ARG, "no levels given");
	if (!status && sensor) fill_sensor(out, sensor);
	optla_free(ctx, scratch);
	optla_free(ctx, l);
	return status;
}
