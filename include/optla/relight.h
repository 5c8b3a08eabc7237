/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file relight.h
 * What a captured T is good for: relighting, dual photos, inverse illumination, correspondence; and rival ways to capture T.
 */
#ifndef OPTLA_RELIGHT_H
#define OPTLA_RELIGHT_H

#include "optla/base.h"
#include "optla/image.h"
#include "optla/krylov.h"
#include "optla/op.h"
#include "optla/rig.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * A captured transport: T ~ D Pᵀ (Eq. 2.7), with what is needed to make pictures of it. D holds channel-major rows: nchannels * npixels;
 * one common P. File: HDF5, kind "model" (docs/files.md).
 */
typedef struct {
	optla_ctx *ctx;
	size_t width, height, channels, npixels, nlights, rank;
	size_t light_width, light_height;
	uint32_t *pixel;                /**< npixels indices y*width + x */
	float *photos;                  /**< D: (npixels*channels) x rank, column-major (photo after photo) */
	float *illuminations;           /**< P: nlights x rank */
	double *light_direction;        /**< nlights x 3, or NULL */
	float *thumbnails;              /**< low-resolution d_k: nthumb x rank; NULL when the photos themselves are what Krylov saw */
	float *dual_light, *dual_photo; /**< r_k (nthumb x rank) and s_k (nlights x rank) of Algorithm 2, or NULL */
	/** Samples of a low-resolution picture: thumb_width*thumb_height, or npixels (grey), npixels*channels, or of a shape not known (0 x 0). */
	size_t nthumb, thumb_width, thumb_height;
	uint64_t photos_taken;
	double exposure_s;
} optla_model;

/** Model of a finished Krylov run (Arnoldi or SVD) on a rig; photo basis: the high-resolution one if the run kept it. */
OPTLA_API optla_status optla_model_from_krylov(const optla_rig *rig, const optla_krylov *run, optla_model **out);
/** Model from plain factors: photos (npixels*channels) x rank, illuminations nlights x rank; copied. */
OPTLA_API optla_status optla_model_create(const optla_rig *rig, size_t channels, optla_cblock photos, optla_cblock illuminations,
                                          optla_model **out);
OPTLA_API void optla_model_destroy(optla_model **model);
OPTLA_API optla_status optla_model_save(const optla_model *model, const char *path);
OPTLA_API optla_status optla_model_load(optla_ctx *ctx, const char *path, optla_model **out);

/**
 * i = D (Pᵀ p)    (Eqs. 2.7, 2.10)
 *
 * @param p nlights values per light channel; light_channels 1 (white light) or model->channels (coloured light), channel-major.
 * @param i npixels*channels values, channel-major. Reads D once: bandwidth bound, 4*rank bytes per sample.
 */
OPTLA_API optla_status optla_relight(const optla_model *model, const float *p, size_t light_channels, float *i);
/** The kernel alone: y = D c, D nrows x k column-major with leading dimension ld. */
OPTLA_API optla_status optla_relight_combine(optla_ctx *ctx, const float *d, size_t nrows, size_t ld, size_t k, const float *c,
                                             float *y);
/** Picture of row values (LINEAR, width x height x channels). */
OPTLA_API optla_status optla_model_image(const optla_model *model, const float *i, optla_image **out);
/** Illumination vector as optla_rig_light_vector() reads it, from the model's own light directions and grid. */
OPTLA_API optla_status optla_model_light_vector(const optla_model *model, const char *spec, size_t channels, double *p);
/**
 * Contact sheet of the first `count` components (at most rank) in rows, signed colours, each with its own full scale, like Fig. 2.6: d_k,
 * p_k and, where the model has them, r_k, s_k. Lights on a grid are its pixels; others are discs at their directions, the middle being
 * the direction towards the camera and the distance from it the angle; without directions they are stripes.
 */
OPTLA_API optla_status optla_model_montage(const optla_model *model, size_t count, optla_image **out);
/** Dual photo s = Tᵀ r ~ P (Dᵀ r) (Eq. 1.12): what the projector sees when the camera shines r (npixels*channels). s: nlights. */
OPTLA_API optla_status optla_dual(const optla_model *model, const float *r, float *s);

/**
 * Correspondence map of Eq. 1.11: n[m] = argmax_n T[m, n], from the rows of any operator.
 * @param light nrows indices. @param strength T[m, n] of it; NULL: not wanted. @param share strength over the row's sum: how
 * direct the transport is (0 where no light arrives); NULL: not wanted. Of equal lights the first is meant. Cost: ncols products.
 */
OPTLA_API optla_status optla_correspondence(optla_op *t, uint32_t *light, double *strength, double *share);

/** Relative error of Eq. 2.11, ||A - T||_F / ||T||_F, of two operators of one shape, by products with unit vectors in blocks. */
OPTLA_API optla_status optla_relative_error(optla_op *approximation, optla_op *truth, double *error);
/** The same for T_k = D(:,1..k) P(:,1..k)ᵀ for every k = 1..rank at once (errors[k-1]); P need not be orthonormal. */
OPTLA_API optla_status optla_relative_errors(optla_cblock d, optla_cblock p, optla_op *truth, double *errors);

/* ---- rival ways to capture T (Fig. 2.9) ---- */

typedef enum {
	OPTLA_CAPTURE_SINGLE, /**< one light at a time, in a random order */
	OPTLA_CAPTURE_DCT,    /**< DCT-II patterns by increasing frequency; on the projector's grid when there is one */
	/** Walsh-Hadamard patterns by increasing sequency, on the grid when both of its sides are powers of two; else in a line, cut from
	    the next power of two, without those that are combinations of earlier ones on the real lights. */
	OPTLA_CAPTURE_HADAMARD,
	/** k random columns and k random rows, T_k = C W⁺ R (Wang et al., SIGGRAPH 2009); the tolerance of the pseudo-inverse is the best
	    of a list against the truth: the method at its best. */
	OPTLA_CAPTURE_NYSTROEM,
	OPTLA_CAPTURE_KERNEL_NYSTROEM, /**< the same on T^γ element-wise, γ too the best of a search against the truth */
	OPTLA_CAPTURE_SVD              /**< the optimum of every rank; needs the truth and takes no photos */
} optla_capture;
OPTLA_API const char *optla_capture_name(optla_capture method);

/** One point of an error curve. */
typedef struct {
	size_t k;        /**< basis photos (brute force), rows and columns (Nystroem), rank (SVD) */
	uint64_t photos; /**< taken for this point; 0 for SVD */
	double exposure_s;
	double relative_error; /**< Eq. 2.11 */
	double exponent;       /**< kernel Nystroem's γ, else 1 */
} optla_capture_point;

typedef struct {
	size_t size;
	uint64_t seed;    /**< of the random choices: single lights, Nystroem's rows and columns */
	const size_t *ks; /**< ascending list of k to report, from 1; at most ncols (Nystroem and SVD: min(nrows, ncols)) */
	size_t nks;
} optla_capture_options;

/**
 * Error curve of one rival. Photos come from `photos` (a signed operator, e.g. optla_rig_operator(); noisy or not; NULL: truth) and photos
 * under single lights, or by single camera pixels, from `single` (the same with a longer exposure, twice in the thesis; NULL: photos);
 * the error is against `truth`. T_k of a brute-force basis is T projected on the span of its first k patterns.
 * @param grid_width,grid_height of the projector; 0: the lights aren't on a grid. @param points options->nks, one for each k.
 * @return OPTLA_ERR_ARG for a bad list of k; OPTLA_ERR_SHAPE; OPTLA_ERR_UNSUPPORTED: complex operators, Nystroem without a transpose.
 */
OPTLA_API optla_status optla_capture_curve(optla_capture method, optla_op *photos, optla_op *single, optla_op *truth,
                                           size_t grid_width, size_t grid_height, const optla_capture_options *options,
                                           optla_capture_point *points);

#ifdef __cplusplus
}
#endif
#endif
