/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file image.h
 * Images that know what their numbers mean, and their files.
 *
 * Samples are 32-bit floats (16-bit counts are exact), row-major, channels interleaved: sample (x, y, c) is
 * data[(y*width + x)*channels + c]. Pixel (x, y) has its centre at integer coordinates; (0, 0) is the centre of the
 * top-left pixel.
 */
#ifndef OPTLA_IMAGE_H
#define OPTLA_IMAGE_H

#include "optla/base.h"
#include "optla/op.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What a sample means. Functions check it; converting is explicit. */
typedef enum {
	OPTLA_IMAGE_RAW_DN, /**< raw counts of a sensor, black level and all (Eq. 1.3) */
	OPTLA_IMAGE_LINEAR, /**< proportional to radiant energy, unit left open (or joules where the docs say so) */
	OPTLA_IMAGE_DISPLAY /**< 0..1, encoded for looking at (sRGB transfer curve) */
} optla_image_kind;

typedef struct {
	optla_ctx *ctx;
	size_t width, height,
	    channels; /**< channels: 1 grey, 2 grey + alpha, 3 RGB, 4 RGB + alpha; alpha is 0..1 whatever the kind */
	optla_image_kind kind;
	double white_dn; /**< RAW_DN: count at which a sample is certainly saturated; else 0 */
	float *data;     /**< owned */
	char *
	    provenance; /**< how the file that it was read from says it was made, lines of "key: value"; NULL if it doesn't say; owned */
} optla_image;

/** Zero-filled image. @return OPTLA_ERR_ARG for an empty or too large size, OPTLA_ERR_NOMEM. */
OPTLA_API optla_status optla_image_create(optla_ctx *ctx, size_t width, size_t height, size_t channels, optla_image_kind kind,
                                          optla_image **out);
OPTLA_API optla_status optla_image_copy(const optla_image *image, optla_image **out);
/** Accepts NULL; clears the pointer. */
OPTLA_API void optla_image_destroy(optla_image **image);
OPTLA_API const char *optla_image_kind_name(optla_image_kind kind);

/* ---- meaning ---- */

/** linear = (dn - black_dn) * scale, alpha stays. Only for RAW_DN; the result is LINEAR, negative noise is kept. In place. */
OPTLA_API optla_status optla_image_linearize(optla_image *image, double black_dn, double scale);
/** display = sRGB(min(1, exposure * linear)), clamped to 0..1; NaN becomes 0. Only for LINEAR. In place. */
OPTLA_API optla_status optla_image_to_display(optla_image *image, double exposure);
/** linear = sRGB⁻¹(display). Only for DISPLAY. In place. */
OPTLA_API optla_status optla_image_display_to_linear(optla_image *image);
/** Exposure that brings the given quantile (0..1, e.g. 0.995) of each pixel's largest colour to 1, or the brightest pixel where that
    quantile is 0; 1 for a black image. Samples that aren't finite don't count. LINEAR only: another kind is reported and answered by 1. */
OPTLA_API double optla_image_auto_exposure(const optla_image *image, double quantile);
/** Mean of the colour channels (not alpha) as a new one-channel image of the same kind (RAW_DN or LINEAR). */
OPTLA_API optla_status optla_image_grey(const optla_image *image, optla_image **out);
/** Resampling to width x height, each axis on its own: mean over the covered area where it shrinks, linear interpolation between centres
    where it grows. Whole factors keep the image's mean. DISPLAY is resampled as it is. */
OPTLA_API optla_status optla_image_resize(const optla_image *image, size_t width, size_t height, optla_image **out);
/** False colours of a signed one-channel image, as in Fig. 2.6: red positive, blue negative, white zero; |value| = scale is full
    colour (scale 0: the largest |value|). NaN is black. The result is a DISPLAY image with three channels. */
OPTLA_API optla_status optla_image_signed_colours(const optla_image *image, double scale, optla_image **out);

/* ---- files ---- */

/**
 * Reads PNG (1 to 16 bits), TIFF (8/16 bit, 32-bit float), OpenEXR (half, float, integer; R G B A or Y A of the first part), PFM,
 * 2- or 3-D NPY (height x width [x channels]), or camera RAW through LibRaw; found from the content, not the name. Files that end too
 * early are errors, also where the pixels are all there.
 *
 * Kind: 16-bit integers and camera RAW are RAW_DN, fewer bits DISPLAY, floats LINEAR; a PNG/TIFF/EXR that Optla wrote says its own
 * kind and that is believed. Use optla_image_set_kind() where you know better.
 *
 * OpenEXR: the image is the display window; what the data window doesn't cover is zero. Camera RAW: counts as the sensor gave them, black
 * level and all, unrotated, without white balance; missing colours are interpolated linearly (bilinear for Bayer), so that sums of photos
 * stay sums; white_dn is the camera's white level.
 * @return OPTLA_ERR_INPUT with the file's name and what is wrong in it; OPTLA_ERR_UNSUPPORTED for what the format allows and Optla can't
 *         read (deep or subsampled EXR, sensors other than RGB); OPTLA_ERR_IO when it can't be read.
 */
OPTLA_API optla_status optla_image_load(optla_ctx *ctx, const char *path, optla_image **out);
/** As optla_image_load() from bytes in memory; name is used in messages. Never reads outside bytes[0..count). */
OPTLA_API optla_status optla_image_decode(optla_ctx *ctx, const void *bytes, size_t count, const char *name, optla_image **out);
/** Reads count files with the context's threads; out[k] are all set, or all NULL after a failure (the first by index is reported).
    Images, error and the inputs in the provenance are the same for any number of threads. Reports progress; can be cancelled. */
OPTLA_API optla_status optla_image_load_stack(optla_ctx *ctx, const char *const *paths, size_t count, optla_image **out);
/** Declares what the samples mean, without changing them; white_dn matters for RAW_DN alone. */
OPTLA_API void optla_image_set_kind(optla_image *image, optla_image_kind kind, double white_dn);

/**
 * Writes by the ending of the name, whole or not at all: .png (8 bit for DISPLAY, 16 bit for RAW_DN; LINEAR is an error that says
 * to convert or to use .exr), .tif (as PNG, and float for LINEAR), .exr (float), .pfm (LINEAR alone), .npy (as .tif). Counts are rounded to
 * integers; DISPLAY is clamped to 0..1. Carries the kind, white level and provenance where the format has room (PNG text, TIFF
 * description, EXR attribute; NPY says the kind by its type, PFM nothing).
 * @return OPTLA_ERR_ARG for an unknown ending, or a kind or sample that the format can't hold; OPTLA_ERR_IO.
 */
OPTLA_API optla_status optla_image_save(const optla_image *image, const char *path);

/* ---- arrays and matrices ---- */

/** An n-dimensional array as NPY/NPZ/HDF5 hold it, converted to a scalar type; C order. */
typedef struct {
	optla_ctx *ctx;
	size_t ndim, dims[8];
	optla_scalar type; /**< integers and bool come as F64 (exact up to 2^53), f2/f4 as F32 */
	void *data;        /**< owned */
} optla_array;

OPTLA_API void optla_array_destroy(optla_array **array);
/** .npy; .npz with the member as "file.npz:name"; HDF5 dataset as "file.h5:path"; without a name the only one there is. */
OPTLA_API optla_status optla_array_load(optla_ctx *ctx, const char *path, optla_array **out);
/** As optla_array_load() from the bytes of one .npy, .npz or .h5 file; member may be NULL. */
OPTLA_API optla_status optla_array_decode(optla_ctx *ctx, const void *bytes, size_t count, const char *name, const char *member,
                                          optla_array **out);
/** .npy or .npz ("file.npz:name", one member). Whole or not at all. */
OPTLA_API optla_status optla_array_save(const optla_array *array, const char *path);

/** What a file is, from its content. */
typedef enum {
	OPTLA_FILE_UNKNOWN,
	OPTLA_FILE_PNG,
	OPTLA_FILE_TIFF,
	OPTLA_FILE_EXR,
	OPTLA_FILE_PFM,
	OPTLA_FILE_NPY,
	OPTLA_FILE_NPZ,
	OPTLA_FILE_HDF5,
	OPTLA_FILE_RAW,
	OPTLA_FILE_YAML
} optla_file_type;
/** YAML is anything that is text and starts like a mapping. A directory or unreadable file is an error. */
OPTLA_API optla_status optla_file_type_of(optla_ctx *ctx, const char *path, optla_file_type *type);

#ifdef __cplusplus
}
#endif
#endif
