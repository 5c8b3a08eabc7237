/* SPDX-License-Identifier: BSD-3-Clause */
/* Light that diffuse patches send to each other, to the end (C. M. Goral et al., Modeling the interaction of light between diffuse
   surfaces, SIGGRAPH 1984). */
#ifndef OPTLA_RADIOSITY_H
#define OPTLA_RADIOSITY_H

#include "base/base_impl.h"

/**
 * Indirect exitance of each patch for one watt that falls directly on another: with R albedo, A areas, F form factors,
 *
 *     G = (I - R F)⁻¹ R F R A⁻¹ ,     exitance_i = sum_j G_ij watt_j        (1/m², n x n, column-major)
 *
 * which leaves out the first, direct reflection. G is symmetric, and comes out so to the bit.
 * @param exchange_m2 A F, symmetric n x n. @param albedo n values in [0, 1].
 * @return OPTLA_ERR_NOMEM; OPTLA_ERR_ARG when no light ever leaves (closed box of albedo 1).
 */
optla_status optla_radiosity_kernel_(optla_ctx *ctx, const double *exchange_m2, const double *area_m2, const double *albedo,
                                     size_t n, double *kernel);

#endif
