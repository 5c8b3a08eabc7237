/* SPDX-License-Identifier: BSD-3-Clause */
/* The sensor of thesis section 1.2: photon noise, gain, black level, read noise, full well, ADC - and its radiometric inverse. */
#include "optla/sensor.h"
#include "base/base_impl.h"
#include "base/random.h"
#include "capture/photon.h"

#include <math.h>
#include <string.h>

typedef struct {
	const char *name, *help;
	optla_sensor sensor;
} preset;

static const preset presets[] = {
    /* Canon EOS 5D Mark II (section 2.4) at ISO 100: published photon-transfer measurements give about 64 600 e full well, 4.1 e
       per count, 28 e read noise; raw files have black at 1024 and clip near 15 760. */
    {"dslr-14bit",
     "14-bit digital SLR like the Canon EOS 5D Mark II at ISO 100",
     {.size = sizeof(optla_sensor),
      .psi_e_per_j = 0.33 / OPTLA_PHOTON_550NM_J,
      .gain_e_per_dn = 4.1,
      .read_noise_dn = 6.8,
      .black_level_dn = 1024,
      .full_well_e = 64600,
      .bits = 14}},
    /* Basler's 12-bit CCD of the EMVA 1288 reference set 001, as optla_sensor_measure() finds it. Its ADC clips at
       14 600 e, before the well, of which nothing more can be known. */
    {"ccd-12bit",
     "12-bit machine-vision CCD, measured from the EMVA 1288 reference frames",
     {.size = sizeof(optla_sensor),
      .psi_e_per_j = 0.453 / OPTLA_PHOTON_550NM_J,
      .gain_e_per_dn = 3.58,
      .read_noise_dn = 3.06,
      .black_level_dn = 14.7,
      .full_well_e = 15000,
      .bits = 12}},
    /* A small-pixel video camera that hands out 8 linear bits: a well of 10 000 e spread over 240 counts. */
    {"video-8bit",
     "8-bit linear video camera: low dynamic range, quantisation as large as read noise",
     {.size = sizeof(optla_sensor),
      .psi_e_per_j = 0.5 / OPTLA_PHOTON_550NM_J,
      .gain_e_per_dn = 41.7,
      .read_noise_dn = 0.36,
      .black_level_dn = 8,
      .full_well_e = 10400,
      .bits = 8}},
};
enum { PRESETS = sizeof presets / sizeof *presets };

const optla_sensor *optla_sensor_preset(const char *name)
{
	for (size_t k = 0; name && k < PRESETS; k++)
		if (!strcmp(presets[k].name, name)) return &presets[k].sensor;
	return NULL;
}

const char *optla_sensor_preset_name(size_t k, const char **help)
{
	if (k >= PRESETS) return NULL;
	if (help) *help = presets[k].help;
	return presets[k].name;
}

static double adc_top_dn(const optla_sensor *s) { return ldexp(1, s->bits) - 1; }

/* Largest count there can be: the ADC's, or the full well's (Eq. 1.3). */
static double top_dn(const optla_sensor *s) { return fmin(adc_top_dn(s), floor(s->full_well_e / s->gain_e_per_dn)); }

static optla_status check_field(optla_ctx *ctx, const char *name, double value, bool good, const char *allowed)
{
	OPTLA_CHECK(ctx, good && isfinite(value), OPTLA_ERR_ARG, "sensor: %s is %g: allowed is %s", name, value, allowed);
	return OPTLA_OK;
}

optla_status optla_sensor_check(optla_ctx *ctx, const optla_sensor *s)
{
	OPTLA_CHECK(ctx, s->size == sizeof *s, OPTLA_ERR_ARG, "optla_sensor has size %zu, this library knows %zu", s->size,
	            sizeof *s);
	OPTLA_TRY(check_field(ctx, "psi_e_per_j", s->psi_e_per_j, s->psi_e_per_j > 0, "a number > 0"));
	OPTLA_TRY(check_field(ctx, "gain_e_per_dn", s->gain_e_per_dn, s->gain_e_per_dn > 0, "a number > 0"));
	OPTLA_TRY(check_field(ctx, "read_noise_dn", s->read_noise_dn, s->read_noise_dn >= 0, "a number >= 0"));
	OPTLA_TRY(check_field(ctx, "black_level_dn", s->black_level_dn, s->black_level_dn >= 0, "a number >= 0"));
	OPTLA_TRY(check_field(ctx, "full_well_e", s->full_well_e, s->full_well_e > 0, "a number > 0"));
	OPTLA_TRY(check_field(ctx, "bits", s->bits, s->bits >= 1 && s->bits <= 24, "1 to 24"));
	OPTLA_CHECK(ctx, optla_sensor_capacity_e(s) > 0, OPTLA_ERR_ARG,
	            "sensor: black level %g leaves no room below the largest count %g (full_well_e %g / gain_e_per_dn %g, %d bits)",
	            s->black_level_dn, top_dn(s), s->full_well_e, s->gain_e_per_dn, s->bits);
	return OPTLA_OK;
}

double optla_sensor_capacity_e(const optla_sensor *s)
{
	return fmin(s->full_well_e - s->gain_e_per_dn * s->black_level_dn, s->gain_e_per_dn * (adc_top_dn(s) - s->black_level_dn));
}

static optla_status check_energies(optla_ctx *ctx, const double *energy_j, size_t count)
{
	for (size_t m = 0; m < count; m++)
		OPTLA_CHECK(ctx, energy_j[m] >= 0 && isfinite(energy_j[m]), OPTLA_ERR_ARG,
		            "the energy of pixel %zu is %g J: a sensor can only be given a finite energy >= 0", m, energy_j[m]);
	return OPTLA_OK;
}

/* The counts of one pixel before clipping above. Streams hold the pixel below bit 40 and the upper half of the readout above. */
static double read_pixel(const optla_sensor *s, optla_rand r, uint64_t readout, size_t pixel, double energy_j)
{
	const uint64_t stream = (uint64_t)pixel ^ (readout >> 32 << 40);
	const uint32_t index = (uint32_t)readout;
	const double read = s->read_noise_dn > 0 ? s->read_noise_dn * optla_rand_normal_(r, stream, index, 0) : 0;
	const double x = optla_rand_poisson_(r, stream, index, 1, s->psi_e_per_j * energy_j); /* Eq. 1.6 */
	return floor(x / s->gain_e_per_dn + s->black_level_dn + read + 0.5);                  /* Eqs. 1.3, 1.5: rounded to counts */
}

optla_status optla_sensor_expose(optla_ctx *ctx, const optla_sensor *s, const double *energy_j, size_t count, uint64_t seed,
                                 uint64_t readout, float *raw_dn, size_t *saturated)
{
	OPTLA_TRY(optla_sensor_check(ctx, s));
	OPTLA_TRY(check_energies(ctx, energy_j, count));
	const optla_rand r = {.seed = seed, .stream_hi = OPTLA_RAND_SENSOR};
	const double top = top_dn(s);
	size_t clipped = 0; /* a sum of whole numbers: the same in any order */
#pragma omp parallel for num_threads(optla_ctx_threads(ctx)) schedule(static) reduction(+ : clipped)
	for (size_t m = 0; m < count; m++) {
		const double dn = read_pixel(s, r, readout, m, energy_j[m]);
		clipped += dn > top;
		raw_dn[m] = (float)optla_clamp_(dn, 0, top);
	}
	if (saturated) *saturated = clipped;
	return OPTLA_OK;
}

void optla_sensor_invert(const optla_sensor *s, const float *raw_dn, size_t count, double *energy_j)
{
	const double j_per_dn = s->gain_e_per_dn / s->psi_e_per_j;
	for (size_t m = 0; m < count; m++) energy_j[m] = (raw_dn[m] - s->black_level_dn) * j_per_dn;
}

/* Variance in counts² at a mean number of photoelectrons: read noise, photon noise, quantisation of one count (Eq. 1.8). */
static double variance_dn2(const optla_sensor *s, double electrons)
{
	const double g = s->gain_e_per_dn;
	return s->read_noise_dn * s->read_noise_dn + electrons / (g * g) + 1.0 / 12;
}

double optla_sensor_variance_j2(const optla_sensor *s, double energy_j)
{
	const double j_per_dn = s->gain_e_per_dn / s->psi_e_per_j;
	return variance_dn2(s, s->psi_e_per_j * energy_j) * j_per_dn * j_per_dn;
}

double optla_sensor_snr_db(const optla_sensor *s, double energy_j)
{
	const double electrons = s->psi_e_per_j * energy_j;
	return 20 * log10(electrons / s->gain_e_per_dn / sqrt(variance_dn2(s, electrons)));
}
