/* SPDX-License-Identifier: BSD-3-Clause */
/* The operators of a rig: options, light power, creation. */
#include "capture/light_op.h"
#include "capture/rig_impl.h"
#include "math/dense.h"

#include <math.h>

const optla_rig_operator_options optla_rig_operator_defaults = {.size = sizeof(optla_rig_operator_options),
                                                                .channel = OPTLA_CHANNEL_GREY,
                                                                .type = OPTLA_F32,
                                                                .full_scale = 0.8,
                                                                .exposure = 1,
                                                                .split = OPTLA_SPLIT_AUTO,
                                                                .seed = 1};

#define FIELD(field) offsetof(optla_rig_operator_options, field)
static const optla_option fields[] = {
    {"channel", FIELD(channel), OPTLA_OPTION_ENUM, "", 0, 0, "grey|red|green|blue|all", "camera samples that are rows of T"},
    {"full-scale", FIELD(full_scale), OPTLA_OPTION_DOUBLE, "", 1e-6, 1, NULL,
     "share of the sensor's capacity that the brightest pixel fills with all lights on"},
    {"exposure", FIELD(exposure), OPTLA_OPTION_DOUBLE, "", 1e-6, 1e6, NULL,
     "exposure time as a multiple of the rig's nominal one"},
    {"ambient", FIELD(ambient), OPTLA_OPTION_DOUBLE, "", 0, 1e6, NULL,
     "ambient light as a fraction of the brightest pixel's light"},
    {"split", FIELD(split), OPTLA_OPTION_ENUM, "", 0, 0, "signed|offset|auto", "how signed patterns become light"},
    {"seed", FIELD(seed), OPTLA_OPTION_U64, "", 0, 18446744073709551615.0, NULL, "seed of the sensor's noise"},
};
const optla_option_table optla_rig_operator_table = {"optla_rig_operator_options", sizeof(optla_rig_operator_options),
                                                     &optla_rig_operator_defaults, fields, sizeof fields / sizeof *fields};

static void destroy(void *user)
{
	optla_light_op *o = user;
	for (size_t c = 0; c < OPTLA_LIGHT_CHANNELS_MAX; c++) optla_op_unref(&o->channel[c]);
	optla_free(o->ctx, o->raw_dn);
	optla_free(o->ctx, o->energies);
	optla_free(o->ctx, o->out);
	optla_free(o->ctx, o->in);
	optla_free(o->ctx, o);
}

static void cost(void *user, optla_op_cost *cost)
{
	const optla_light_op *o = user;
	cost->photos += o->photos;
	cost->exposure_s += (double)o->photos * o->options.exposure * o->nominal_s;
}

static double noise(void *user) { return ((const optla_light_op *)user)->last_noise; }

/* Brightest pixel of any channel of the rig with everything at full power: what fixes the power, whatever channel is asked for. */
static optla_status find_brightest(const optla_rig *rig, optla_trans trans, double *brightest)
{
	optla_ctx *ctx = rig->ctx;
	const optla_transport *p = rig->transport;
	const size_t nin = trans == OPTLA_FORWARD ? p->nlights : p->npixels, nout = trans == OPTLA_FORWARD ? p->npixels : p->nlights;
	const optla_block ones = optla_block_(optla_array_(ctx, nin, sizeof(double)), nin, 1, p->t.type);
	const optla_block y = optla_block_(optla_array_(ctx, nout, sizeof(double)), nout, 1, p->t.type);
	optla_status status = ones.data && y.data ? OPTLA_OK : OPTLA_ERR_NOMEM;
	for (size_t n = 0; n < nin && !status; n++) optla_set_(ones, n, 0, 1);
	*brightest = 0;
	for (size_t c = 0; c < p->channels && !status; c++) {
		optla_cblock t = optla_block_const(p->t);
		t.nrows = p->npixels;
		t.data = (const char *)t.data + c * p->npixels * optla_scalar_bytes(t.type);
		status = optla_dense_apply_(ctx, trans, t, optla_block_const(ones), y);
		for (size_t m = 0; m < nout && !status; m++) *brightest = fmax(*brightest, optla_get_(optla_block_const(y), m, 0));
	}
	optla_free(ctx, ones.data);
	optla_free(ctx, y.data);
	return status;
}

/* Full power's energy, and ambient light in the units of T1. */
static optla_status set_power(optla_light_op *o, const optla_rig *rig)
{
	for (int side = 0; side < 2; side++) {
		double brightest;
		OPTLA_TRY(find_brightest(rig, side ? OPTLA_TRANSPOSE : OPTLA_FORWARD, &brightest));
		OPTLA_CHECK(o->ctx, brightest > 0 && isfinite(brightest), OPTLA_ERR_UNSUPPORTED,
		            "with all lights of rig '%s' on, the brightest pixel holds %g: no light power can be chosen", rig->info.name,
		            brightest);
		o->ambient[side] = o->options.ambient * brightest;
		if (o->noisy)
			o->energy_j[side] = o->options.exposure * o->options.full_scale * optla_sensor_capacity_e(&o->sensor) /
			                    o->sensor.psi_e_per_j / brightest;
	}
	return OPTLA_OK;
}

/* Without noise the photo of the mean is the mean of the photos: one product instead of one for each channel. */
static optla_status take_channels(optla_light_op *o, const optla_rig *rig)
{
	const optla_channel asked = o->options.channel;
	const bool several = o->noisy && (asked == OPTLA_CHANNEL_ALL || asked == OPTLA_CHANNEL_GREY);
	o->rig_channels = rig->info.channels;
	o->nchannels = several ? o->rig_channels : 1;
	for (size_t c = 0; c < o->nchannels; c++) {
		optla_channel one = asked;
		if (several) one = o->rig_channels == 1 ? OPTLA_CHANNEL_GREY : (optla_channel)(OPTLA_CHANNEL_RED + (int)c);
		OPTLA_TRY(optla_transport_op_(rig->transport, one, rig->info.symmetric, &o->channel[c]));
	}
	return OPTLA_OK;
}

static optla_status take_workspace(optla_light_op *o)
{
	const size_t rows = optla_op_nrows(o->channel[0]), n = optla_max_(rows, o->nlights);
	o->in = optla_array_(o->ctx, n, sizeof *o->in);
	o->out = optla_array_(o->ctx, n, sizeof *o->out);
	if (!o->in || !o->out) return OPTLA_ERR_NOMEM;
	if (!o->noisy) return OPTLA_OK;
	o->energies = optla_array_(o->ctx, n, o->nchannels * sizeof *o->energies);
	o->raw_dn = optla_array_(o->ctx, n, o->nchannels * sizeof *o->raw_dn);
	return o->energies && o->raw_dn ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

static optla_status check_options(const optla_rig *rig, const optla_rig_operator_options *p)
{
	OPTLA_TRY(optla_options_check(rig->ctx, &optla_rig_operator_table, p));
	OPTLA_CHECK(rig->ctx, p->type == OPTLA_F32 || p->type == OPTLA_F64, OPTLA_ERR_ARG, "a rig's operator is of type f32 or f64");
	if (p->sensor) OPTLA_TRY(optla_sensor_check(rig->ctx, p->sensor));
	return optla_channel_check_(rig->ctx, p->channel, rig->info.channels);
}

static optla_status prepare(optla_light_op *o, const optla_rig *rig)
{
	o->npixels = rig->info.npixels;
	o->nlights = rig->info.nlights;
	o->nominal_s = rig->info.exposure_s;
	o->noisy = o->options.sensor != NULL;
	if (o->noisy) o->sensor = *o->options.sensor;
	o->options.sensor = NULL; /* the caller's; this is our copy */
	OPTLA_TRY(take_channels(o, rig));
	OPTLA_TRY(take_workspace(o));
	return set_power(o, rig);
}

optla_status optla_rig_light_operator(optla_rig *rig, const optla_rig_operator_options *options, optla_op **out)
{
	*out = NULL;
	const optla_rig_operator_options *p = options ? options : &optla_rig_operator_defaults;
	OPTLA_TRY(check_options(rig, p));
	optla_light_op *o = optla_calloc_(rig->ctx, 1, sizeof *o);
	if (!o) return OPTLA_ERR_NOMEM;
	o->ctx = rig->ctx;
	o->options = *p;
	const optla_status status = prepare(o, rig);
	if (status) {
		destroy(o);
		return status;
	}
	const size_t nrows = optla_light_is_all_(o) ? rig->info.channels * o->npixels : o->npixels;
	unsigned flags = OPTLA_OP_NONNEGATIVE;
	if (o->noisy) flags |= OPTLA_OP_STOCHASTIC;
	if (!rig->info.has_transpose) flags |= OPTLA_OP_NO_TRANSPOSE;
	if (rig->info.symmetric && nrows == o->nlights) flags |= OPTLA_OP_SYMMETRIC;
	const optla_op_desc desc = {.size = sizeof desc,
	                            .name = rig->info.name,
	                            .nrows = nrows,
	                            .ncols = o->nlights,
	                            .type = p->type,
	                            .flags = flags,
	                            .user = o,
	                            .expose = optla_light_expose_,
	                            .destroy = destroy,
	                            .cost = cost,
	                            .noise = o->noisy ? noise : NULL};
	return optla_op_create(rig->ctx, out, &desc);
}

optla_status optla_rig_operator(optla_rig *rig, const optla_rig_operator_options *options, optla_op **out)
{
	*out = NULL;
	optla_op *light;
	OPTLA_TRY(optla_rig_light_operator(rig, options, &light));
	const optla_status status = optla_op_signed(light, options ? options->split : optla_rig_operator_defaults.split, out);
	optla_op_unref(&light);
	return status;
}
