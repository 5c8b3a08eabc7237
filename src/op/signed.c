/* SPDX-License-Identifier: BSD-3-Clause */
/* Signed patterns from light: as the difference of two photos (M. O'Toole, K. N. Kutulakos, Optical computing for fast light
   transport analysis, SIGGRAPH Asia 2010; Eqs. 2.3, 2.4), or from one photo of the pattern lifted by a constant.

   With full power m a photo of x holds y = T x + m (ambient + noise). Hence

       signed:  T p = y(p₊) - y(p₋)                           both at m = max |p|
       offset:  T p = y(p + c 1) - c y(1) - (m - c) y(0)      c = max(0, -min p), m = max(p + c 1)

   y(1) and the dark frame y(0) are taken once, at m = 1. */
#include "math/dense.h"
#include "op/op_impl.h"

#include <math.h>
#include <string.h>

enum { BATCH = 8 }; /* patterns given to the light operator at once; bounds the memory for photos */

/* y(1) and y(0) of one direction. */
typedef struct {
	bool captured;
	optla_block frames; /* column 0: y(1), column 1: y(0) */
	double lit_noise, dark_noise;
} reference;

typedef struct {
	optla_ctx *ctx;
	optla_op *light;
	optla_split split;
	reference forward, transposed;
	optla_block pattern, photo; /* workspace, grown on need */
	uint64_t by_sign, by_offset;
	double noise;
} signed_op;

typedef struct {
	double offset, power, largest, sum, sum_abs;
} pattern_range;

static pattern_range range_of(optla_cblock x, size_t j)
{
	double lo = 0, hi = -INFINITY;
	pattern_range r = {0};
	for (size_t i = 0; i < x.nrows; i++) {
		const double v = optla_get_(x, i, j);
		lo = fmin(lo, v);
		hi = fmax(hi, v);
		r.sum += v;
		r.sum_abs += fabs(v);
	}
	r.offset = -lo;
	r.largest = x.nrows ? fmax(-lo, hi) : 0;
	r.power = x.nrows ? hi + r.offset : 0;
	if (!(r.largest > 0)) r.largest = 1;
	if (!(r.power > 0)) r.power = 1; /* a constant pattern <= 0 becomes darkness */
	return r;
}

static optla_status grow(signed_op *s, optla_block *b, size_t nrows, size_t ncols)
{
	const optla_scalar type = optla_op_type(s->light);
	if (!b->data || b->ld * b->ncols < nrows * ncols) {
		optla_free(s->ctx, b->data);
		*b = optla_block_new_(s->ctx, nrows, ncols, type);
		if (!b->data) return OPTLA_ERR_NOMEM;
	}
	return OPTLA_OK;
}

static optla_block view(optla_block workspace, size_t nrows, size_t ncols)
{
	return optla_block_(workspace.data, nrows, ncols, workspace.type);
}

static optla_status capture_frame(signed_op *s, optla_trans trans, double value, optla_block frame, double *noise)
{
	const size_t n = trans == OPTLA_FORWARD ? optla_op_ncols(s->light) : optla_op_nrows(s->light);
	OPTLA_TRY(grow(s, &s->pattern, n, 1));
	const optla_block x = view(s->pattern, n, 1);
	const double power = 1;
	for (size_t i = 0; i < n; i++) optla_set_(x, i, 0, value);
	OPTLA_TRY(optla_op_expose(s->light, trans, optla_block_const(x), &power, frame));
	*noise = optla_op_noise(s->light);
	return OPTLA_OK;
}

static optla_status capture_reference(signed_op *s, optla_trans trans, reference **out)
{
	reference *r = *out = trans == OPTLA_FORWARD ? &s->forward : &s->transposed;
	if (r->captured) return OPTLA_OK;
	const size_t n = trans == OPTLA_FORWARD ? optla_op_nrows(s->light) : optla_op_ncols(s->light);
	OPTLA_TRY(grow(s, &r->frames, n, 2));
	OPTLA_TRY(capture_frame(s, trans, 1, optla_columns_mut_(r->frames, 0, 1), &r->lit_noise));
	OPTLA_TRY(capture_frame(s, trans, 0, optla_columns_mut_(r->frames, 1, 1), &r->dark_noise));
	r->captured = true;
	return OPTLA_OK;
}

/* Variance of a photo of x at power m: read noise and ambient light grow with m², photon noise with m times the light, which is
   taken as proportional to sum x. Both factors follow from the frames y(0) and y(1). */
static bool offset_is_better(const reference *r, size_t n, pattern_range p)
{
	const double a = r->dark_noise * r->dark_noise, b = fmax(r->lit_noise * r->lit_noise - a, 0) / (double)n;
	if (a == 0 && b == 0) return true;
	const double m = p.power, c = p.offset, rest = m - c;
	const double by_sign = 2 * a * p.largest * p.largest + b * p.largest * p.sum_abs;
	const double by_offset = a * m * m + b * m * (p.sum + c * (double)n) + c * c * (a + b * (double)n) + rest * rest * a;
	return by_offset <= 2 * by_sign;
}

static optla_status apply_signed(signed_op *s, optla_trans trans, optla_cblock x, optla_block y, const pattern_range *ranges)
{
	double power[BATCH], noise[2];
	OPTLA_TRY(grow(s, &s->pattern, x.nrows, x.ncols));
	OPTLA_TRY(grow(s, &s->photo, y.nrows, y.ncols));
	const optla_block part = view(s->pattern, x.nrows, x.ncols), photo = view(s->photo, y.nrows, y.ncols);
	for (size_t j = 0; j < x.ncols; j++) power[j] = ranges[j].largest;
	for (int sign = 0; sign < 2; sign++) {
		for (size_t j = 0; j < x.ncols; j++)
			for (size_t i = 0; i < x.nrows; i++)
				optla_set_(part, i, j, fmax(sign ? -optla_get_(x, i, j) : optla_get_(x, i, j), 0));
		OPTLA_TRY(optla_op_expose(s->light, trans, optla_block_const(part), power, sign ? photo : y));
		noise[sign] = optla_op_noise(s->light);
	}
	for (size_t j = 0; j < y.ncols; j++) optla_axpy_(-1, optla_block_const(photo), j, y, j);
	s->noise = hypot(noise[0], noise[1]);
	s->by_sign += x.ncols;
	return OPTLA_OK;
}

static optla_status apply_offset(signed_op *s, optla_trans trans, optla_cblock x, optla_block y, const pattern_range *ranges)
{
	double power[BATCH];
	reference *r;
	OPTLA_TRY(capture_reference(s, trans, &r));
	OPTLA_TRY(grow(s, &s->pattern, x.nrows, x.ncols));
	const optla_block lifted = view(s->pattern, x.nrows, x.ncols);
	for (size_t j = 0; j < x.ncols; j++) {
		power[j] = 0;
		for (size_t i = 0; i < x.nrows; i++) {
			optla_set_(lifted, i, j, fmax(optla_get_(x, i, j) + ranges[j].offset, 0));
			power[j] = fmax(power[j], optla_get_(optla_block_const(lifted), i, j)); /* as rounded to the scalar type */
		}
		if (!(power[j] > 0)) power[j] = 1;
	}
	OPTLA_TRY(optla_op_expose(s->light, trans, optla_block_const(lifted), power, y));
	const optla_cblock frames = optla_block_const(r->frames);
	for (size_t j = 0; j < y.ncols; j++) {
		const double c = ranges[j].offset, rest = power[j] - c;
		for (size_t i = 0; i < y.nrows; i++)
			optla_set_(y, i, j,
			           optla_get_(optla_block_const(y), i, j) - c * optla_get_(frames, i, 0) - rest * optla_get_(frames, i, 1));
	}
	const size_t last = x.ncols - 1;
	s->noise = hypot(optla_op_noise(s->light),
	                 hypot(ranges[last].offset * r->lit_noise, (power[last] - ranges[last].offset) * r->dark_noise));
	s->by_offset += x.ncols;
	return OPTLA_OK;
}

static optla_status choose(signed_op *s, optla_trans trans, pattern_range p, size_t n, bool *offset)
{
	*offset = s->split == OPTLA_SPLIT_OFFSET;
	if (s->split != OPTLA_SPLIT_AUTO) return OPTLA_OK;
	reference *r;
	OPTLA_TRY(capture_reference(s, trans, &r));
	*offset = offset_is_better(r, n, p);
	return OPTLA_OK;
}

static optla_status signed_apply(void *user, optla_trans trans, optla_cblock x, optla_block y)
{
	signed_op *s = user;
	pattern_range ranges[BATCH] = {0};
	for (size_t j = 0; j < x.ncols;) {
		/* as many columns as go the same way */
		size_t n = 0;
		bool offset = false;
		for (; n < BATCH && j + n < x.ncols; n++) {
			bool this_one;
			ranges[n] = range_of(x, j + n);
			OPTLA_TRY(choose(s, trans, ranges[n], x.nrows, &this_one));
			if (n && this_one != offset) break;
			offset = this_one;
		}
		OPTLA_TRY((offset ? apply_offset : apply_signed)(s, trans, optla_columns_(x, j, n), optla_columns_mut_(y, j, n), ranges));
		j += n;
	}
	return OPTLA_OK;
}

/* y(1) and y(0) are still to be taken the first time; which way AUTO goes isn't known yet. */
static uint64_t signed_price(void *user, optla_trans trans)
{
	const signed_op *s = user;
	const bool captured = (trans == OPTLA_FORWARD ? &s->forward : &s->transposed)->captured;
	const uint64_t photo = optla_op_price(s->light, trans), frames = captured ? 0 : 2 * photo;
	switch (s->split) {
	case OPTLA_SPLIT_SIGNED: return 2 * photo;
	case OPTLA_SPLIT_OFFSET: return photo + frames;
	case OPTLA_SPLIT_AUTO: break;
	}
	return 2 * photo + frames;
}

static double signed_noise(void *user) { return ((const signed_op *)user)->noise; }

static void signed_destroy(void *user)
{
	signed_op *s = user;
	optla_free(s->ctx, s->forward.frames.data);
	optla_free(s->ctx, s->transposed.frames.data);
	optla_free(s->ctx, s->pattern.data);
	optla_free(s->ctx, s->photo.data);
	optla_free(s->ctx, s);
}

optla_status optla_op_signed(optla_op *light, optla_split split, optla_op **out)
{
	*out = NULL;
	optla_ctx *ctx = optla_op_ctx(light);
	OPTLA_CHECK(ctx, split == OPTLA_SPLIT_SIGNED || split == OPTLA_SPLIT_OFFSET || split == OPTLA_SPLIT_AUTO, OPTLA_ERR_ARG,
	            "split %d is none of signed, offset, auto", (int)split);
	OPTLA_CHECK(ctx, !optla_is_complex_(optla_op_type(light)), OPTLA_ERR_UNSUPPORTED,
	            "operator '%s' is %s: only real patterns are split into light", optla_op_name(light),
	            optla_scalar_name_(optla_op_type(light)));
	signed_op *s = optla_calloc_(ctx, 1, sizeof *s);
	if (!s) return OPTLA_ERR_NOMEM;
	s->ctx = ctx;
	s->light = light;
	s->split = split;
	const optla_op_desc desc = {.size = sizeof desc,
	                            .name = "signed",
	                            .nrows = optla_op_nrows(light),
	                            .ncols = optla_op_ncols(light),
	                            .type = optla_op_type(light),
	                            .frequency_hz = optla_op_frequency_hz(light),
	                            .flags = optla_op_flags(light) & ~(unsigned)OPTLA_OP_NONNEGATIVE,
	                            .user = s,
	                            .apply = signed_apply,
	                            .price = signed_price,
	                            .noise = signed_noise,
	                            .destroy = signed_destroy,
	                            .parts = &light,
	                            .nparts = 1};
	return optla_op_create(ctx, out, &desc);
}

void optla_op_signed_counts(const optla_op *op, uint64_t *by_sign, uint64_t *by_offset)
{
	const optla_op_desc *d = optla_op_desc_(op);
	const signed_op *s = d->apply == signed_apply ? d->user : NULL;
	if (by_sign) *by_sign = s ? s->by_sign : 0;
	if (by_offset) *by_offset = s ? s->by_offset : 0;
}
