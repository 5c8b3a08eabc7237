/* SPDX-License-Identifier: BSD-3-Clause */
/* The inside of a rig: what it says of itself, and its light transport, which operators share with it. */
#ifndef OPTLA_RIG_IMPL_H
#define OPTLA_RIG_IMPL_H

#include "base/base_impl.h"
#include "optla/rig.h"

/* T of all channels, (channels * npixels) x nlights, channel after channel; counted, so that operators outlive their rig. */
typedef struct optla_transport optla_transport;
struct optla_transport {
	optla_ctx *ctx;
	size_t npixels, channels, nlights;
	optla_block t;
	int refs; /* changed atomically */
};

optla_status optla_transport_create_(optla_ctx *ctx, size_t npixels, size_t channels, size_t nlights, optla_scalar type,
                                     optla_transport **out);
void optla_transport_unref_(optla_transport **transport);

struct optla_rig {
	optla_ctx *ctx;
	optla_rig_info info;
	char *name, *path, *sensor;
	uint32_t *pixel;
	double *light_direction;
	optla_transport *transport;
};

/* A rig with copies of the texts (path, sensor may be NULL) and no transport yet. */
optla_status optla_rig_create_(optla_ctx *ctx, const char *name, const char *path, const char *sensor, optla_rig **out);

/* y = T x of a single channel, or of the mean or all of them: an operator that shares the transport. */
optla_status optla_transport_op_(optla_transport *transport, optla_channel channel, bool symmetric, optla_op **out);
/* OPTLA_ERR_ARG for no channel, OPTLA_ERR_UNSUPPORTED for a colour that the rig doesn't have. */
optla_status optla_channel_check_(optla_ctx *ctx, optla_channel channel, size_t channels);

#endif
