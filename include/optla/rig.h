/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file rig.h
 * A rig: projector, scene and camera that answer exposures, and the operator made of exposures.
 *
 * A rig file is YAML (docs/rigs.md lists every key). Two kinds: `recorded` - photos on disk with the illumination each was taken
 * under - and `analytic` - a diffuse corner whose light transport is known exactly.
 */
#ifndef OPTLA_RIG_H
#define OPTLA_RIG_H

#include "optla/base.h"
#include "optla/image.h"
#include "optla/op.h"
#include "optla/sensor.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct optla_rig optla_rig;

typedef enum { OPTLA_RIG_RECORDED, OPTLA_RIG_ANALYTIC } optla_rig_kind;

/** Which camera samples an operator of the rig has. */
typedef enum {
	OPTLA_CHANNEL_GREY, /**< mean of the colour channels */
	OPTLA_CHANNEL_RED,
	OPTLA_CHANNEL_GREEN,
	OPTLA_CHANNEL_BLUE,
	OPTLA_CHANNEL_ALL /**< rows of red, then green, then blue: npixels * channels rows */
} optla_channel;

/** What a rig is. Pointers live as long as the rig. */
typedef struct {
	const char *name, *path;
	optla_rig_kind kind;
	size_t width, height, channels;   /**< of the camera */
	size_t npixels;                   /**< camera pixels that are rows of T (inside the mask) */
	const uint32_t *pixel;            /**< npixels indices y*width + x, ascending */
	size_t nlights;                   /**< columns of T: projector pixels or lights */
	size_t light_width, light_height; /**< of the projector; 0: lights aren't on a grid */
	const double *
	    light_direction; /**< nlights x 3 unit vectors towards each light, camera frame (x right, y down, z forward); NULL: not known */
	bool has_transpose;                /**< the arrangement can answer Tᵀ r */
	bool symmetric;                    /**< T = Tᵀ (coaxial) */
	size_t nphotos, saturated_samples; /**< recorded: photos read and samples inside the mask at or above the saturation count */
	double exposure_s;                 /**< nominal exposure of one photo */
	const char *sensor;                /**< name of the sensor preset that the rig file suggests; NULL: none */
} optla_rig_info;

typedef struct {
	size_t size;
	const char *data_dir; /**< replaces the manifest's data_root; NULL: as in the file */
} optla_rig_open_options;

/**
 * Opens a rig file; photos of a recorded rig are read now (in parallel) and T is made of them:
 *
 *     T = Y X⁺,   column j of Y the linearised photo j, column j of X its illumination vector       (Eq. 1.1)
 *
 * (for one light at a time that is simply the photos).
 * @param options NULL for defaults.
 * @return OPTLA_ERR_INPUT with file, line, key, the value found and those allowed.
 */
OPTLA_API optla_status optla_rig_open(optla_ctx *ctx, const char *path, const optla_rig_open_options *options, optla_rig **out);
/** The analytic corner without a file: camera_size² pixels, projector_size² pixels; coaxial: both in one place (symmetric T). */
OPTLA_API optla_status optla_rig_corner(optla_ctx *ctx, size_t camera_size, size_t projector_size, bool coaxial, optla_rig **out);
OPTLA_API void optla_rig_destroy(optla_rig **rig);
OPTLA_API optla_ctx *optla_rig_ctx(const optla_rig *rig);
OPTLA_API void optla_rig_get_info(const optla_rig *rig, optla_rig_info *info);

/** Exact T of one channel (or all), unit free: what a noiseless, unlimited sensor would say. F64 for analytic, F32 for recorded rigs.
    The reference of Eq. 2.11. The operator keeps what it needs of the rig alive. */
OPTLA_API optla_status optla_rig_truth(optla_rig *rig, optla_channel channel, optla_op **out);

/** How photos are taken when a product is asked for. */
typedef struct {
	size_t size;
	optla_channel channel;
	optla_scalar type;          /**< F32 or F64 */
	const optla_sensor *sensor; /**< NULL: noiseless, unlimited */
	/** Share of the sensor's capacity that the brightest pixel fills with all lights at full power at the nominal exposure
	    (section 2.4 uses 0.8); this fixes the light's power. */
	double full_scale;
	double exposure; /**< exposure time of each photo as a multiple of the nominal one */
	double ambient;  /**< ambient light as a fraction of full_scale, uniform over pixels (Eq. 1.3's a) */
	optla_split split;
	uint64_t seed;
	/** Number of the first photo's readout: a run that goes on from a file starts behind the photos taken, so that no noise is drawn twice. */
	uint64_t first_readout;
} optla_rig_operator_options;
OPTLA_API extern const optla_rig_operator_options optla_rig_operator_defaults;
OPTLA_API extern const optla_option_table optla_rig_operator_table;

/**
 * The light operator: accepts only x >= 0. Each column is scaled to the projector's full power (max x = 1), exposed once, read
 * out once, inverted radiometrically, scaled back:
 *
 *     y = max(x) (sensor⁻¹(sensor(E (T x/max(x) + a)))) / E,   E the energy of full power for one exposure
 *
 * so y holds T x plus max(x)·a plus noise. x = 0 gives the dark frame (ambient light and noise, scale 1). optla_op_expose() replaces
 * max(x) by a power of the caller's choice (>= max(x)), so that two photos can hold the same ambient light. For Tᵀ the roles swap and
 * the projector's side has a sensor of the same kind with its own full power. Ambient light enters both directions.
 *
 * A column is one colour photo: each channel is read out with noise of its own, grey is their mean, and Tᵀ of all channels their sum.
 * Saturated samples are clipped as a real sensor's; the first photo that has some is told of by a warning (level 0).
 * What a recording says to be darker than black (dark frames subtracted) is 0 to the sensor.
 */
OPTLA_API optla_status optla_rig_light_operator(optla_rig *rig, const optla_rig_operator_options *options, optla_op **out);
/** optla_op_signed() of the light operator: what Krylov methods use. */
OPTLA_API optla_status optla_rig_operator(optla_rig *rig, const optla_rig_operator_options *options, optla_op **out);

/**
 * Mean of the channels of each pixel, npixels x (npixels * channels), sparse: grey photos from those of OPTLA_CHANNEL_ALL, the `reduce` of
 * optla_krylov_problem (Eq. 2.10, grey illumination of section 2.4). With one channel it is the identity.
 */
OPTLA_API optla_status optla_rig_grey_reduction(const optla_rig *rig, optla_scalar type, optla_op **out);

/** Image (width x height, the given number of channels) from row values of an operator: pixels outside the mask are 0. values: npixels *
    channels, channel-major as OPTLA_CHANNEL_ALL. Kind LINEAR. */
OPTLA_API optla_status optla_rig_image(const optla_rig *rig, const double *values, size_t channels, optla_image **out);
/** The converse: row values of an image of the camera's size (one channel, or as many as asked for). */
OPTLA_API optla_status optla_rig_values(const optla_rig *rig, const optla_image *image, optla_channel channel, double *values);
/** Light values as an image on the projector's grid; OPTLA_ERR_UNSUPPORTED when lights aren't on a grid. */
OPTLA_API optla_status optla_rig_light_image(const optla_rig *rig, const double *values, optla_image **out);

/**
 * Illumination vector from a description:
 *   - "all"
 *   - "light:7" (from 0), "light:7=0.5,9=1"
 *   - "FILE.npy", ".npz", ".h5", ".csv", ".txt": nlights numbers, or coloured: nlights x 3 (R G B of each light; arrays may also be
 *     3 x nlights). In text, # starts a comment.
 *   - an image of the projector's size; display values are decoded, raw counts divided by the white count
 *   - "env:FILE": a latitude-longitude environment image. Each light gets the integral of radiance over its Voronoi cell (mean radiance
 *     x solid angle). What lies farther from every light than twice the median angle between neighbouring lights is ignored: the rig
 *     can't light from there.
 *   - "point:AZIMUTH,ELEVATION" (degrees): the three nearest lights, weighted by inverse angle, summing to 1; an error out of reach.
 *
 * Angles are seen from the scene: azimuth 0 is the way the camera looks, 90 right, 180 (or -180) towards the camera; elevation is up.
 * An environment image has azimuth -180..180 from left to right and elevation 90..-90 from top to bottom: its middle lies behind the
 * scene as the camera sees it.
 * @param p nlights numbers >= 0 per channel; channels: 1 or 3 (colour light, channel-major). White sources light all channels alike;
 * coloured ones are averaged for one channel (images) or refused (numbers).
 * @return OPTLA_ERR_ARG, OPTLA_ERR_INPUT (file, line or pixel), OPTLA_ERR_SHAPE, OPTLA_ERR_UNSUPPORTED without grid or directions.
 */
OPTLA_API optla_status optla_rig_light_vector(optla_rig *rig, const char *spec, size_t channels, double *p);

#ifdef __cplusplus
}
#endif
#endif
