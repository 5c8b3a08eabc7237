/* SPDX-License-Identifier: BSD-3-Clause */
/* Making models, for relight/ alone. */
#ifndef OPTLA_MODEL_IMPL_H
#define OPTLA_MODEL_IMPL_H

#include "base/base_impl.h"
#include "optla/relight.h"

/* Sizes that must fit together. */
typedef struct {
	size_t width, height, channels, npixels, nlights, rank, light_width, light_height;
} optla_model_shape;

/* name is used in messages, blame is the status of a misfit. */
optla_status optla_model_check_(optla_ctx *ctx, const optla_model_shape *shape, const char *name, optla_status blame);
/* Model of plain factors for a described rig. */
optla_status optla_model_build_(optla_ctx *ctx, const optla_rig_info *rig, size_t channels, optla_cblock photos,
                                optla_cblock illuminations, optla_model **out);
/* As optla_model_load() from the bytes of a file. */
optla_status optla_model_decode_(optla_ctx *ctx, const void *bytes, size_t count, const char *name, optla_model **out);

#endif
