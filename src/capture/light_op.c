/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Photos of a rig (sections 1.2, 2.4). One column is one colour photo: all channels are read out at once and have their own noise;
 * grey is the mean of the channels as read, and the transpose of all channels is the sum of the channels' photos. Energies are
 * E (T x / s + a), s the power of the photo.
 */
#include "capture/light_op.h"
#include "math/dense.h"

#include <math.h>

/* in = column k of x from row 'first' on, divided by the power */
static void load_column(optla_cblock x, size_t first, size_t k, double power, optla_block in)
{
	for (size_t n = 0; n < in.nrows; n++) optla_set_(in, n, 0, optla_get_(x, first + n, k) / power);
}

/* energies[c] = T_c x (or T_cᵀ x_c) of one column, divided by the photo's power. */
static optla_status project(optla_light_op *o, optla_trans trans, optla_cblock x, size_t k, double power)
{
	const bool forward = trans == OPTLA_FORWARD;
	const size_t nin = forward ? o->nlights : o->npixels, nout = forward ? o->npixels : o->nlights;
	const optla_scalar type = optla_op_type(o->channel[0]);
	const optla_block in = optla_block_(o->in, nin, 1, type), out = optla_block_(o->out, nout, 1, type);
	for (size_t c = 0; c < o->nchannels; c++) {
		const bool own_part = !forward && optla_light_is_all_(o);
		if (c == 0 || own_part) load_column(x, own_part ? c * o->npixels : 0, k, power, in);
		OPTLA_TRY(optla_op_apply(o->channel[c], trans, optla_block_const(in), out));
		for (size_t m = 0; m < nout; m++) o->energies[c * nout + m] = optla_get_(optla_block_const(out), m, 0);
	}
	return OPTLA_OK;
}

/* One readout of all channels: products become measured energies. */
static optla_status read_out(optla_light_op *o, size_t count, double energy_j, double ambient)
{
	/* T of a recording can be slightly negative (dark frames subtracted); light can't */
	for (size_t m = 0; m < count; m++) o->energies[m] = energy_j * fmax(0, o->energies[m] + ambient);
	size_t clipped;
	OPTLA_TRY(optla_sensor_expose(o->ctx, &o->sensor, o->energies, count, o->options.seed, o->options.first_readout + o->photos,
	                              o->raw_dn, &clipped));
	if (clipped && !o->told_of_clipping)
		optla_log_(o->ctx, 0,
		           "photo %llu: %zu of %zu samples are saturated, its product is too dark there: lower exposure or ambient light",
		           (unsigned long long)(o->photos + 1), clipped, count);
	o->told_of_clipping = o->told_of_clipping || clipped;
	optla_sensor_invert(&o->sensor, o->raw_dn, count, o->energies);
	return OPTLA_OK;
}

/* sqrt(E ||e||²) of the photo just read, from its own energies: what a real system can know. The variance of a sum of channels is the
   sum of their variances; that of a mean, 1/n² of it. */
static double estimate_noise(const optla_light_op *o, size_t count, double factor)
{
	double variance = 0;
	for (size_t m = 0; m < count; m++) variance += optla_sensor_variance_j2(&o->sensor, fmax(0, o->energies[m]));
	return factor * sqrt(variance) / (optla_light_is_all_(o) ? 1 : (double)o->nchannels);
}

/* Writes the channels of one photo to column k of y: side by side, as their mean, or as their sum. */
static void combine(const optla_light_op *o, optla_trans trans, double factor, optla_block y, size_t k)
{
	const size_t nout = trans == OPTLA_FORWARD ? o->npixels : o->nlights;
	if (trans == OPTLA_FORWARD && optla_light_is_all_(o)) {
		for (size_t m = 0; m < o->nchannels * nout; m++) optla_set_(y, m, k, factor * o->energies[m]);
		return;
	}
	const double share = optla_light_is_all_(o) ? factor : factor / (double)o->nchannels;
	for (size_t m = 0; m < nout; m++) {
		double sum = 0;
		for (size_t c = 0; c < o->nchannels; c++) sum += o->energies[c * nout + m];
		optla_set_(y, m, k, share * sum);
	}
}

static optla_status expose_noisy(optla_light_op *o, optla_trans trans, optla_cblock x, const double *full_power, optla_block y)
{
	const int side = trans == OPTLA_FORWARD ? 0 : 1;
	const size_t count = o->nchannels * (side ? o->nlights : o->npixels);
	for (size_t k = 0; k < x.ncols; k++) {
		OPTLA_TRY(optla_check_cancel_(o->ctx));
		OPTLA_TRY(project(o, trans, x, k, full_power[k]));
		OPTLA_TRY(read_out(o, count, o->energy_j[side], o->ambient[side]));
		o->photos++;
		const double factor = full_power[k] / o->energy_j[side];
		o->last_noise = estimate_noise(o, count, factor);
		combine(o, trans, factor, y, k);
	}
	return OPTLA_OK;
}

/* y += s a, and once for each channel where y sums their photos */
static void add_ambient(const optla_light_op *o, optla_trans trans, const double *full_power, optla_block y)
{
	double a = o->ambient[trans == OPTLA_FORWARD ? 0 : 1];
	if (a <= 0) return;
	if (trans != OPTLA_FORWARD && optla_light_is_all_(o)) a *= (double)o->rig_channels;
	for (size_t k = 0; k < y.ncols; k++)
		for (size_t m = 0; m < y.nrows; m++) optla_set_(y, m, k, optla_get_(optla_block_const(y), m, k) + full_power[k] * a);
}

static optla_status expose_exact(optla_light_op *o, optla_trans trans, optla_cblock x, const double *full_power, optla_block y)
{
	const optla_scalar type = optla_op_type(o->channel[0]);
	if (type == x.type) OPTLA_TRY(optla_op_apply(o->channel[0], trans, x, y));
	for (size_t k = 0; k < x.ncols && type != x.type; k++) {
		const optla_block in = optla_block_(o->in, x.nrows, 1, type), out = optla_block_(o->out, y.nrows, 1, type);
		load_column(x, 0, k, 1, in);
		OPTLA_TRY(optla_op_apply(o->channel[0], trans, optla_block_const(in), out));
		for (size_t m = 0; m < y.nrows; m++) optla_set_(y, m, k, optla_get_(optla_block_const(out), m, 0));
	}
	add_ambient(o, trans, full_power, y);
	o->photos += x.ncols;
	return OPTLA_OK;
}

optla_status optla_light_expose_(void *user, optla_trans trans, optla_cblock x, const double *full_power, optla_block y)
{
	optla_light_op *o = user;
	return o->noisy ? expose_noisy(o, trans, x, full_power, y) : expose_exact(o, trans, x, full_power, y);
}
