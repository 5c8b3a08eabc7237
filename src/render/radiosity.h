/* SPDX-License-Identifier: BSD-3-Clause */
/* Light that diffuse patches send to each other, to the end (C. M. Goral et al., Modeling the interaction of light between diffuse
   surfaces, SIGGRAPH 1984). */
#ifndef OPTLA_RADIOSITY_H
#define OPTLA_RADIOSITY_H

#include "base/base_impl.h"

/**
 * Exitance of patches of which some are lit from outside: with R albedo, A areas, F form factors,
 *
 *     B = (I - R F)⁻¹ R A⁻¹ Φ        (W/m²)
 *
 * @param exchange_m2 A F, symmetric n x n. @param albedo n values in [0, 1].
 * @param flux_w Φ, n x count, column-major: watts from outside on each patch. @param exitance_w_m2 B, n x count.
 * @return OPTLA_ERR_NOMEM; OPTLA_ERR_ARG when light never leaves (closed box of albedo 1).
 */
optla_status optla_radiosity_solve_(optla_ctx *ctx, const double *exchange_m2, const double *area_m2, const double *albedo,
                                    size_t n, const double *flux_w, size_t count, double *exitance_w_m2);

#endif
