/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file sensor.h
 * The camera's sensor: radiant energy to raw counts and back (thesis section 1.2).
 *
 *     i_hat = min{ x / g + i_offset + n_read, i_max / g },   x ~ Poisson(Ψ i), then rounded to whole counts     (Eqs. 1.3-1.6)
 *
 * Standard deviation σ of the read noise is in counts, as in Eq. 1.8; the ADC also clips at 0 and 2^bits - 1.
 */
#ifndef OPTLA_SENSOR_H
#define OPTLA_SENSOR_H

#include "optla/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
	size_t size;
	double psi_e_per_j;    /**< Ψ: photoelectrons per joule at the pixel */
	double gain_e_per_dn;  /**< g: photoelectrons per count */
	double read_noise_dn;  /**< σ */
	double black_level_dn; /**< i_offset */
	double full_well_e;    /**< i_max */
	int bits;              /**< of the ADC: 1..24 */
} optla_sensor;

/** "none" is not a sensor: use NULL where a sensor may be left out. Names: "dslr-14bit", "ccd-12bit", "video-8bit". NULL if unknown. */
OPTLA_API const optla_sensor *optla_sensor_preset(const char *name);
/** Name of preset k, NULL after the last; *help says what it stands for. */
OPTLA_API const char *optla_sensor_preset_name(size_t k, const char **help);
/** OPTLA_ERR_ARG with the field, its value and what is allowed. */
OPTLA_API optla_status optla_sensor_check(optla_ctx *ctx, const optla_sensor *sensor);

/** Largest mean number of photoelectrons that is not clipped: min(i_max - g*i_offset, g*(2^bits - 1 - i_offset)). */
OPTLA_API double optla_sensor_capacity_e(const optla_sensor *sensor);

/**
 * One readout: raw_dn[m] = counts for energy_j[m] joules (Eqs. 1.3-1.6). Negative energy is an error.
 * The noise of pixel m is a function of (seed, readout, m): the same for any number of threads; give each photo its own readout.
 * @param raw_dn whole numbers in 0 .. min(2^bits - 1, floor(i_max/g)).
 * @param saturated number of pixels that were clipped above; NULL: not wanted.
 */
OPTLA_API optla_status optla_sensor_expose(optla_ctx *ctx, const optla_sensor *sensor, const double *energy_j, size_t count,
                                           uint64_t seed, uint64_t readout, float *raw_dn, size_t *saturated);
/** Radiometric inverse: energy_j = (raw - i_offset) g / Ψ; negative noise is kept. */
OPTLA_API void optla_sensor_invert(const optla_sensor *sensor, const float *raw_dn, size_t count, double *energy_j);
/** Variance of the inverted energy of a pixel that holds energy_j: (σ² + Ψi/g² + 1/12) g²/Ψ²  (Eq. 1.8 with b = 1). */
OPTLA_API double optla_sensor_variance_j2(const optla_sensor *sensor, double energy_j);
/** Eq. 1.8 in decibels. */
OPTLA_API double optla_sensor_snr_db(const optla_sensor *sensor, double energy_j);

/** One level of a photon transfer measurement: two bright and two dark frames of the same exposure. */
typedef struct {
	const float *bright[2], *dark[2]; /**< counts */
	size_t count;                     /**< pixels of each frame */
	double photons_per_pixel;         /**< mean number that fell on a pixel; 0 if not known */
} optla_photon_transfer_level;

typedef struct {
	double gain_dn_per_e;      /**< K: slope of the least squares line of variance over mean (EMVA 1288, section 6) */
	double quantum_efficiency; /**< from photons, 0 if not known */
	double read_noise_e;       /**< standard deviation in the dark, quantisation removed, extrapolated to zero exposure */
	double black_level_dn;
	double full_well_e;   /**< at the level with the largest temporal variance (EMVA 1288 saturation) */
	double saturation_dn; /**< mean count above black there */
	/** Smallest e such that a straight line over photons stays within relative e of every level between 5 and 70 % of saturation;
	    0 if photons are not known or fewer than three of those levels differ in them. */
	double linearity_error;
	size_t levels_used; /**< levels below 70 % of saturation */
} optla_photon_transfer;

/**
 * Photon transfer curve: mean and temporal variance of frame pairs give the gain, and with the dark frames read noise, full well and
 * linearity (EMVA Standard 1288, release 3.1).
 *
 *     σ²_y - σ²_dark = K (µ_y - µ_dark)
 *
 * @param sensor NULL, or filled with the same numbers: psi_e_per_j from quantum efficiency and the energy of a photon of 550 nm (0 if
 * photons are not known), full_well_e with the black level counted in as in Eq. 1.3; bits stay as given by the caller.
 * @return OPTLA_ERR_ARG with less than three usable levels.
 */
OPTLA_API optla_status optla_sensor_measure(optla_ctx *ctx, const optla_photon_transfer_level *levels, size_t count,
                                            optla_photon_transfer *out, optla_sensor *sensor);

#ifdef __cplusplus
}
#endif
#endif
