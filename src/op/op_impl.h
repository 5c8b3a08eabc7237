/* SPDX-License-Identifier: BSD-3-Clause */
/* What the kinds of operator share. */
#ifndef OPTLA_OP_IMPL_H
#define OPTLA_OP_IMPL_H

#include "base/base_impl.h"
#include "optla/op.h"

static inline bool optla_is_complex_(optla_scalar type) { return type == OPTLA_C32 || type == OPTLA_C64; }
static inline bool optla_is_single_(optla_scalar type) { return type == OPTLA_F32 || type == OPTLA_C32; }

/* "f32", "f64", "c32", "c64" */
const char *optla_scalar_name_(optla_scalar type);

/* What the operator was made with; lives as long as it. */
const optla_op_desc *optla_op_desc_(const optla_op *op);

/* OPTLA_ERR_SHAPE unless b is a sound view: known type, ld >= nrows, data where there are entries. */
optla_status optla_block_check_(optla_ctx *ctx, const char *what, optla_cblock b);
/* OPTLA_ERR_ARG at the first NaN or Inf. */
optla_status optla_block_check_finite_(optla_ctx *ctx, const char *what, optla_cblock b);
/* Index of the first scalar part (counting real and imaginary parts) of a column that isn't finite, or n. */
size_t optla_first_not_finite_(const void *data, size_t n, bool single);
size_t optla_first_negative_(const void *data, size_t n, bool single);

/* dst = conj(src), complex only; same shape. */
void optla_block_conj_(optla_cblock src, optla_block dst);
/* dst += src, same shape and type. */
void optla_block_add_(optla_cblock src, optla_block dst);
/* A contiguous copy; data NULL when memory ran out. */
optla_block optla_block_copy_(optla_ctx *ctx, optla_cblock src);
/* A contiguous, uninitialised block; data NULL when memory ran out. */
optla_block optla_block_new_(optla_ctx *ctx, size_t nrows, size_t ncols, optla_scalar type);

#endif
