/* SPDX-License-Identifier: BSD-3-Clause */
/* Matrices with a known spectrum, and runs on them. */
#ifndef OPTLA_TEST_SPECTRUM_H
#define OPTLA_TEST_SPECTRUM_H

#include "base/random.h"
#include "math/dense.h"
#include "near.h"
#include "optla/krylov.h"

/* m x n, column-major, standard normal numbers. */
static inline double *random_matrix(size_t m, size_t n, uint64_t seed)
{
	double *a = malloc(m * n * sizeof *a);
	for (size_t k = 0; k < m * n; k++) a[k] = optla_rand_normal_((optla_rand){seed, OPTLA_RAND_TEST}, k, 0, 0);
	return a;
}

/* T = U diag(s) Vᵀ with random orthonormal U (m x k), V (n x k); both are given back if wanted. */
static inline double *with_spectrum(optla_ctx *ctx, size_t m, size_t n, const double *s, size_t k, bool symmetric)
{
	double *a = random_matrix(m, k, 1), *b = random_matrix(n, k, 2), *u = malloc(m * k * sizeof *u),
	       *v = malloc(n * k * sizeof *v), *r = malloc(k * k * sizeof *r), *t = calloc(m * n, sizeof *t);
	ok(optla_qr_(ctx, a, m, k, u, r));
	ok(optla_qr_(ctx, symmetric ? a : b, n, k, v, r));
	for (size_t l = 0; l < k; l++)
		for (size_t j = 0; j < n; j++)
			for (size_t i = 0; i < m; i++) t[i + j * m] += u[i + l * m] * s[l] * v[j + l * n];
	free(a), free(b), free(u), free(v), free(r);
	return t;
}

static inline optla_op *dense(optla_ctx *ctx, const double *t, size_t m, size_t n)
{
	optla_op *op;
	ok(optla_op_dense(ctx, optla_cblock_(t, m, n, OPTLA_F64), true, &op));
	return op;
}

static inline optla_krylov *started(optla_op *op, optla_krylov_method method, const optla_krylov_options *o, const double *target)
{
	const optla_krylov_problem problem = {.size = sizeof problem, .op = op, .target = target};
	optla_krylov *run;
	ok(optla_krylov_create(&problem, method, o, &run));
	return run;
}

static inline void harmonic(double *s, size_t k)
{
	for (size_t j = 0; j < k; j++) s[j] = 1 / (double)(j + 1);
}

#endif
