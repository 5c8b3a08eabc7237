/* SPDX-License-Identifier: BSD-3-Clause */
#include "random.h"

#include <Random123/philox.h>
#include <math.h>

void optla_rand_block_(optla_rand r, uint64_t stream, uint32_t index, uint32_t dimension, uint32_t out[4])
{
	const philox4x32_key_t key = {{(uint32_t)r.seed, (uint32_t)(r.seed >> 32) ^ r.stream_hi * 0x9E3779B9u}};
	const philox4x32_ctr_t counter = {{(uint32_t)stream, (uint32_t)(stream >> 32), index, dimension}};
	const philox4x32_ctr_t block = philox4x32(counter, key);
	for (int k = 0; k < 4; k++) out[k] = block.v[k];
}

static double u53(uint32_t hi, uint32_t lo) { return (double)((((uint64_t)hi << 32) | lo) >> 11) * 0x1p-53; }

double optla_rand_u01_(optla_rand r, uint64_t stream, uint32_t index, uint32_t dimension)
{
	uint32_t b[4];
	optla_rand_block_(r, stream, index, dimension, b);
	return u53(b[0], b[1]);
}

double optla_rand_normal_(optla_rand r, uint64_t stream, uint32_t index, uint32_t dimension)
{
	uint32_t b[4];
	optla_rand_block_(r, stream, index, dimension, b);
	const double u = 1 - u53(b[0], b[1]), v = u53(b[2], b[3]); /* u in (0, 1] */
	return sqrt(-2 * log(u)) * cos(2 * 3.14159265358979323846 * v);
}

/* Sequential search of the distribution function; one uniform number. */
static double poisson_inversion(double u, double mean)
{
	double p = exp(-mean), sum = p;
	int k = 0;
	while (u > sum && k < 200) { /* P(X > 200) < 1e-170 for mean < 10 */
		k++;
		p *= mean / k;
		sum += p;
	}
	return k;
}

double optla_rand_poisson_(optla_rand r, uint64_t stream, uint32_t index, uint32_t dimension, double mean)
{
	if (mean <= 0) return 0;
	if (mean < 10) return poisson_inversion(optla_rand_u01_(r, stream, index, dimension), mean);
	/* Hoermann's PTRS; the constants are fitted in the paper. */
	const double slam = sqrt(mean), loglam = log(mean), b = 0.931 + 2.53 * slam, a = -0.059 + 0.02483 * b,
	             invalpha = 1.1239 + 1.1328 / (b - 3.4), vr = 0.9277 - 3.6224 / (b - 2);
	for (uint32_t trial = 0;; trial++) {
		uint32_t w[4];
		optla_rand_block_(r, stream, index, dimension + trial, w);
		const double u = u53(w[0], w[1]) - 0.5, v = 1 - u53(w[2], w[3]), us = 0.5 - fabs(u),
		             k = floor((2 * a / us + b) * u + mean + 0.43);
		if (us >= 0.07 && v <= vr) return k;
		if (k < 0 || (us < 0.013 && v > us)) continue;
		if (log(v) + log(invalpha) - log(a / (us * us) + b) <= k * loglam - mean - lgamma(k + 1)) return k;
	}
}
