/* SPDX-License-Identifier: BSD-3-Clause */
/* Illumination bases that don't depend on the scene: single lights, cosines, Walsh functions. */
#ifndef OPTLA_BASIS_H
#define OPTLA_BASIS_H

#include "base/base_impl.h"
#include "optla/relight.h"

/* Patterns B = Q R: what is shown, and its orthonormal factor, so that T projected on the first k patterns is
   (T B_k R_k^-1) Q_k^T. R is upper triangular. */
typedef struct {
	optla_ctx *ctx;
	size_t nlights, count;
	double *pattern, *q; /* nlights x count */
	double *r;           /* count x count; NULL: diagonal, of the numbers in scale */
	double *scale;       /* count: ||b_j||; NULL when r is given */
} optla_basis;

/* The first count <= nlights patterns of one basis. seed matters for single lights alone. */
optla_status optla_basis_create_(optla_ctx *ctx, optla_capture method, size_t nlights, size_t grid_width, size_t grid_height,
                                 size_t count, uint64_t seed, optla_basis *basis);
void optla_basis_free_(optla_basis *basis);

/* A random order of 0 .. n-1, a function of seed and stream (Fisher-Yates). */
optla_status optla_permutation_(optla_ctx *ctx, uint64_t seed, uint64_t stream, size_t n, size_t **order);

#endif
