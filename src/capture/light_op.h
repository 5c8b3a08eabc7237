/* SPDX-License-Identifier: BSD-3-Clause */
/* The light operator of a rig: one photo for each column. op_rig.c makes it, light_op.c exposes. */
#ifndef OPTLA_LIGHT_OP_H
#define OPTLA_LIGHT_OP_H

#include "base/base_impl.h"
#include "optla/rig.h"

enum { OPTLA_LIGHT_CHANNELS_MAX = 4 };

typedef struct {
	optla_ctx *ctx;
	optla_rig_operator_options options;
	bool noisy;
	optla_sensor sensor;
	size_t nchannels;                            /* operators below: noisy: channels that one photo reads out; else 1 */
	optla_op *channel[OPTLA_LIGHT_CHANNELS_MAX]; /* exact T of each, or of what was asked for */
	size_t npixels, nlights, rig_channels;
	double nominal_s;
	double energy_j[2]; /* noisy: of full power for one photo; [0] forward, [1] transpose */
	double ambient[2];  /* a in the units of T1, of Tᵀ1 */
	uint64_t photos;
	bool told_of_clipping;
	double last_noise;
	double *in, *out; /* one column in the transport's type */
	double *energies; /* noisy: one column of each channel */
	float *raw_dn;    /* the same in counts */
} optla_light_op;

/* As optla_op_desc.expose. */
optla_status optla_light_expose_(void *user, optla_trans trans, optla_cblock x, const double *full_power, optla_block y);
static inline bool optla_light_is_all_(const optla_light_op *o) { return o->options.channel == OPTLA_CHANNEL_ALL; }

#endif
