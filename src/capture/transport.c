/* SPDX-License-Identifier: BSD-3-Clause */
/* The stored light transport of a rig, and the exact operators made of it. */
#include "capture/rig_impl.h"
#include "math/dense.h"

optla_status optla_transport_create_(optla_ctx *ctx, size_t npixels, size_t channels, size_t nlights, optla_scalar type,
                                     optla_transport **out)
{
	*out = NULL;
	optla_transport *p = optla_calloc_(ctx, 1, sizeof *p);
	if (!p) return OPTLA_ERR_NOMEM;
	size_t rows, count;
	*p = (optla_transport){.ctx = ctx, .npixels = npixels, .channels = channels, .nlights = nlights, .refs = 1};
	if (!optla_size_mul_(npixels, channels, &rows) || !optla_size_mul_(rows, nlights, &count)) rows = count = SIZE_MAX;
	void *data = optla_calloc_(ctx, count, optla_scalar_bytes(type));
	if (!data) {
		optla_free(ctx, p);
		return OPTLA_ERR_NOMEM;
	}
	p->t = optla_block_(data, rows, nlights, type);
	*out = p;
	return OPTLA_OK;
}

static optla_transport *transport_ref(optla_transport *p)
{
#pragma omp atomic
	p->refs++;
	return p;
}

void optla_transport_unref_(optla_transport **transport)
{
	optla_transport *p = *transport;
	*transport = NULL;
	if (!p) return;
	int left;
#pragma omp atomic capture
	left = --p->refs;
	if (left) return;
	optla_free(p->ctx, p->t.data);
	optla_free(p->ctx, p);
}

optla_status optla_channel_check_(optla_ctx *ctx, optla_channel channel, size_t channels)
{
	OPTLA_CHECK(ctx, channel >= OPTLA_CHANNEL_GREY && channel <= OPTLA_CHANNEL_ALL, OPTLA_ERR_ARG, "%d is no channel",
	            (int)channel);
	const bool colour = channel == OPTLA_CHANNEL_RED || channel == OPTLA_CHANNEL_GREEN || channel == OPTLA_CHANNEL_BLUE;
	OPTLA_CHECK(ctx, !colour || channels == 3, OPTLA_ERR_UNSUPPORTED, "this rig's camera has %zu channel%s: ask for grey or all",
	            channels, channels == 1 ? "" : "s");
	return OPTLA_OK;
}

typedef struct {
	optla_transport *transport;
	optla_cblock a; /* rows of the transport, or 'mean' */
	void *mean;
} transport_op;

static optla_status apply(void *user, optla_trans trans, optla_cblock x, optla_block y)
{
	const transport_op *o = user;
	return optla_dense_apply_(o->transport->ctx, trans, o->a, x, y);
}

static void destroy(void *user)
{
	transport_op *o = user;
	optla_ctx *ctx = o->transport->ctx;
	optla_free(ctx, o->mean);
	optla_transport_unref_(&o->transport);
	optla_free(ctx, o);
}

/* Mean of the channels, in double. */
static void fill_mean(const optla_transport *p, optla_block mean)
{
	const optla_cblock t = optla_block_const(p->t);
	const int threads = optla_ctx_threads(p->ctx);
#pragma omp parallel for num_threads(threads) schedule(static)
	for (size_t n = 0; n < p->nlights; n++)
		for (size_t m = 0; m < p->npixels; m++) {
			double sum = 0;
			for (size_t c = 0; c < p->channels; c++) sum += optla_get_(t, c * p->npixels + m, n);
			optla_set_(mean, m, n, sum / (double)p->channels);
		}
}

/* Points a at the channel's rows, or makes their mean. */
static optla_status select_rows(transport_op *o, optla_channel channel)
{
	const optla_transport *p = o->transport;
	o->a = optla_block_const(p->t);
	if (channel == OPTLA_CHANNEL_ALL || p->channels == 1) return OPTLA_OK;
	if (channel == OPTLA_CHANNEL_GREY) {
		o->mean = optla_array_(p->ctx, p->npixels * p->nlights, optla_scalar_bytes(p->t.type));
		if (!o->mean) return OPTLA_ERR_NOMEM;
		const optla_block mean = optla_block_(o->mean, p->npixels, p->nlights, p->t.type);
		fill_mean(p, mean);
		o->a = optla_block_const(mean);
		return OPTLA_OK;
	}
	const size_t first = (size_t)(channel - OPTLA_CHANNEL_RED) * p->npixels;
	o->a.data = (const char *)p->t.data + first * optla_scalar_bytes(p->t.type);
	o->a.nrows = p->npixels;
	return OPTLA_OK;
}

optla_status optla_transport_op_(optla_transport *transport, optla_channel channel, bool symmetric, optla_op **out)
{
	optla_ctx *ctx = transport->ctx;
	*out = NULL;
	OPTLA_TRY(optla_channel_check_(ctx, channel, transport->channels));
	transport_op *o = optla_calloc_(ctx, 1, sizeof *o);
	if (!o) return OPTLA_ERR_NOMEM;
	o->transport = transport_ref(transport);
	const optla_status status = select_rows(o, channel);
	if (status) {
		destroy(o);
		return status;
	}
	const optla_op_desc desc = {.size = sizeof desc,
	                            .name = "light transport",
	                            .nrows = o->a.nrows,
	                            .ncols = transport->nlights,
	                            .type = o->a.type,
	                            .flags = symmetric && o->a.nrows == transport->nlights ? OPTLA_OP_SYMMETRIC : 0u,
	                            .user = o,
	                            .apply = apply,
	                            .destroy = destroy};
	return optla_op_create(ctx, out, &desc);
}
