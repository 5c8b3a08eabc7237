/* SPDX-License-Identifier: BSD-3-Clause */
/* Error curves (Eq. 2.11) of optical Arnoldi and its rivals on one rig. */
#ifndef OPTLA_CURVES_H
#define OPTLA_CURVES_H

#include "report/lab.h"

typedef enum {
	OPTLA_CURVE_ARNOLDI,
	OPTLA_CURVE_OFFSET,
	OPTLA_CURVE_SVD,
	OPTLA_CURVE_NYSTROEM,
	OPTLA_CURVE_KERNEL,
	OPTLA_CURVE_DCT,
	OPTLA_CURVE_HADAMARD,
	OPTLA_CURVE_SINGLE,
	OPTLA_CURVES
} optla_curve_method;

typedef struct {
	const char *label;
	size_t count;
	double *k, *photos, *exposure_s, *error, *exponent;
} optla_curve;

typedef struct {
	optla_rig *rig;
	optla_channel channel;
	const char *sensor; /* name of a preset; NULL: noiseless */
	size_t iterations;  /* of Arnoldi */
	const size_t *ks;   /* where the rivals are looked at */
	size_t nks;
} optla_curves_job;

/**
 * All curves. Arnoldi and the brute-force bases take signed pairs of photos (Eq. 2.4); OFFSET is Arnoldi with one photo for each
 * product, made positive by an offset. Single lights, columns and rows are one photo each, exposed
 * twice as long, as in section 2.5.1: k iterations of Arnoldi and k rows and columns of Nystroem then take the same exposure time. The
 * optimum takes no photos: it is given those of Arnoldi for the same k.
 */
optla_status optla_curves_measure_(optla_figure *figure, const optla_curves_job *job, optla_curve curves[OPTLA_CURVES]);
/* Error at k; NaN if the curve has no such point. */
double optla_curve_error_(const optla_curve *curve, size_t k);

#endif
