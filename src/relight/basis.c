/* SPDX-License-Identifier: BSD-3-Clause */
/* Scene-independent illumination bases, in the order in which a capture would show them.
 *
 * Cosines and Walsh functions go by increasing frequency; on a projector's grid they are products of a horizontal and a vertical
 * function, ordered by (u / width)² + (v / height)². Lights that aren't on a grid are taken as a line, in the order of their numbers.
 *
 * Walsh functions need powers of two. On other shapes they are those of the next larger power, seen on the real lights only. Cut
 * like this they are no longer independent: those that are combinations of earlier ones would cost photos and say nothing new, so
 * they are left out, and the rest is made orthogonal. That leaves exactly nlights patterns, and T is recovered from all of them. */
#include "relight/basis.h"
#include "base/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- orders ---- */

typedef struct {
	size_t u, v;
	double frequency; /* squared */
} wave;

static int by_frequency(const void *a, const void *b)
{
	const wave *x = a, *y = b;
	if (x->frequency != y->frequency) return x->frequency < y->frequency ? -1 : 1;
	if (x->v != y->v) return x->v < y->v ? -1 : 1;
	return (x->u > y->u) - (x->u < y->u);
}

static wave *make_waves(optla_ctx *ctx, size_t width, size_t height)
{
	wave *waves = optla_array_(ctx, width * height, sizeof *waves);
	if (!waves) return NULL;
	for (size_t v = 0; v < height; v++)
		for (size_t u = 0; u < width; u++) {
			const double fu = (double)u / (double)width, fv = (double)v / (double)height;
			waves[v * width + u] = (wave){u, v, fu * fu + fv * fv};
		}
	qsort(waves, width * height, sizeof *waves, by_frequency);
	return waves;
}

optla_status optla_permutation_(optla_ctx *ctx, uint64_t seed, uint64_t stream, size_t n, size_t **order)
{
	const optla_rand random = {.seed = seed, .stream_hi = OPTLA_RAND_NYSTROEM};
	size_t *o = *order = optla_array_(ctx, n, sizeof *o);
	if (!o) return OPTLA_ERR_NOMEM;
	for (size_t k = 0; k < n; k++) o[k] = k;
	for (size_t k = 0; k + 1 < n; k++) {
		const size_t other = k + (size_t)(optla_rand_u01_(random, stream, (uint32_t)k, 0) * (double)(n - k));
		const size_t t = o[k];
		o[k] = o[other];
		o[other] = t;
	}
	return OPTLA_OK;
}

/* ---- functions ---- */

static double cosine(size_t frequency, size_t at, size_t n)
{
	return cos(pi * ((double)at + 0.5) * (double)frequency / (double)n);
}

static size_t next_power(size_t n)
{
	size_t p = 1;
	while (p < n) p *= 2;
	return p;
}

/* Row of the natural Hadamard matrix of n = 2^b rows that changes sign `sequency` times: the Gray code, bits reversed. */
static size_t hadamard_row(size_t sequency, size_t n)
{
	const size_t gray = sequency ^ (sequency >> 1);
	size_t row = 0;
	for (size_t bit = 1; bit < n; bit *= 2) row = row * 2 + (gray & bit ? 1 : 0);
	return row;
}

static double walsh(size_t sequency, size_t at, size_t n)
{
	size_t bits = hadamard_row(sequency, n) & at;
	double sign = 1;
	for (; bits; bits &= bits - 1) sign = -sign;
	return sign;
}

/* ---- patterns ---- */

static void set_scale(optla_basis *b, size_t j)
{
	const double *x = b->pattern + j * b->nlights;
	double *q = b->q + j * b->nlights, s = 0;
	for (size_t n = 0; n < b->nlights; n++) s += x[n] * x[n];
	b->scale[j] = sqrt(s);
	for (size_t n = 0; n < b->nlights; n++) q[n] = x[n] / b->scale[j];
}

static optla_status single_lights(optla_basis *b, uint64_t seed)
{
	size_t *order;
	OPTLA_TRY(optla_permutation_(b->ctx, seed, 0, b->nlights, &order));
	for (size_t j = 0; j < b->count; j++) {
		b->pattern[j * b->nlights + order[j]] = 1;
		set_scale(b, j);
	}
	optla_free(b->ctx, order);
	return OPTLA_OK;
}

static optla_status orthogonal_waves(optla_basis *b, size_t width, size_t height, double (*f)(size_t, size_t, size_t))
{
	wave *waves = make_waves(b->ctx, width, height);
	if (!waves) return OPTLA_ERR_NOMEM;
	for (size_t j = 0; j < b->count; j++) {
		for (size_t n = 0; n < b->nlights; n++)
			b->pattern[j * b->nlights + n] = f(waves[j].u, n % width, width) * f(waves[j].v, n / width, height);
		set_scale(b, j);
	}
	optla_free(b->ctx, waves);
	return OPTLA_OK;
}

/* q_j = what b_j adds to the earlier ones, r the coefficients; false if it adds nothing. Projected out twice, as once loses
   digits when little is left. Cut Walsh functions keep at least 1/(n + 1) of their length or are combinations of earlier ones to
   rounding (sums of integers, exact), so 1e-6 tells the two apart. */
static bool add_direction(optla_basis *b, size_t j)
{
	const size_t n = b->nlights;
	double *q = b->q + j * n, *r = b->r + j * b->count, length = 0, left = 0;
	memcpy(q, b->pattern + j * n, n * sizeof *q);
	memset(r, 0, b->count * sizeof *r);
	for (size_t i = 0; i < n; i++) length += q[i] * q[i];
	for (int pass = 0; pass < 2; pass++)
		for (size_t k = 0; k < j; k++) {
			double dot = 0;
			for (size_t i = 0; i < n; i++) dot += b->q[k * n + i] * q[i];
			for (size_t i = 0; i < n; i++) q[i] -= dot * b->q[k * n + i];
			r[k] += dot;
		}
	for (size_t i = 0; i < n; i++) left += q[i] * q[i];
	if (left <= 1e-12 * length) return false;
	r[j] = sqrt(left);
	for (size_t i = 0; i < n; i++) q[i] /= r[j];
	return true;
}

static void cut_walsh(optla_basis *b)
{
	const size_t padded = next_power(b->nlights);
	for (size_t j = 0, sequency = 0; j < b->count && sequency < padded; sequency++) {
		for (size_t n = 0; n < b->nlights; n++) b->pattern[j * b->nlights + n] = walsh(sequency, n, padded);
		if (add_direction(b, j)) j++;
	}
}

static bool is_power(size_t n) { return n && 0 == (n & (n - 1)); }

static optla_status fill(optla_basis *b, optla_capture method, size_t width, size_t height, uint64_t seed)
{
	switch (method) {
	case OPTLA_CAPTURE_SINGLE: return single_lights(b, seed);
	case OPTLA_CAPTURE_DCT: return orthogonal_waves(b, width, height, cosine);
	case OPTLA_CAPTURE_HADAMARD:
		if (!b->r) return orthogonal_waves(b, width, height, walsh);
		cut_walsh(b);
		return OPTLA_OK;
	default: return OPTLA_FAIL(b->ctx, OPTLA_ERR_ARG, "capture method %d has no basis of its own", (int)method);
	}
}

optla_status optla_basis_create_(optla_ctx *ctx, optla_capture method, size_t nlights, size_t grid_width, size_t grid_height,
                                 size_t count, uint64_t seed, optla_basis *b)
{
	size_t width = grid_width, height = grid_height;
	const bool walsh_basis = OPTLA_CAPTURE_HADAMARD == method;
	if (!width || (walsh_basis && !(is_power(width) && is_power(height)))) width = nlights, height = 1;
	const bool cut = walsh_basis && !is_power(width);
	*b = (optla_basis){.ctx = ctx, .nlights = nlights, .count = count};
	b->pattern = optla_calloc_(ctx, nlights * count, sizeof *b->pattern);
	b->q = b->pattern ? optla_calloc_(ctx, nlights * count, sizeof *b->q) : NULL;
	if (b->q && cut) b->r = optla_calloc_(ctx, count * count, sizeof *b->r);
	if (b->q && !cut) b->scale = optla_calloc_(ctx, count, sizeof *b->scale);
	const optla_status s = b->r || b->scale ? fill(b, method, width, height, seed) : OPTLA_ERR_NOMEM;
	if (OPTLA_OK != s) optla_basis_free_(b);
	return s;
}

void optla_basis_free_(optla_basis *b)
{
	optla_free(b->ctx, b->pattern);
	optla_free(b->ctx, b->q);
	optla_free(b->ctx, b->r);
	optla_free(b->ctx, b->scale);
	b->pattern = b->q = b->r = b->scale = NULL;
}
