/* SPDX-License-Identifier: BSD-3-Clause */
/* A photo relit by kernel Nyström: the rival of Fig. 2.10 (d). */
#ifndef OPTLA_NYSTROEM_PHOTO_H
#define OPTLA_NYSTROEM_PHOTO_H

#include "report/lab.h"

/**
 * Column `light` of T_k = (C^γ (W^γ)⁺ R^γ)^(1/γ), C and R being k random columns and rows taken through `single` (J. Wang et al., Kernel
 * Nyström method for light transport, SIGGRAPH 2009). Exponent and tolerance of the pseudo-inverse are those that come nearest to `wanted`
 * (nrows): the method at its best.
 */
optla_status optla_lab_nystroem_photo_(optla_figure *figure, optla_op *single, size_t k, size_t light, const double *wanted,
                                       double *photo, double *exponent);

#endif
