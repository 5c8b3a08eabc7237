/* SPDX-License-Identifier: BSD-3-Clause */
/* Non-negative illumination from k photos (footnote 3 of section 2.3).

   A light pattern p is in part what was photographed, P Pᵀ p, and in part not, (I - P Pᵀ) p. Its photo is D Pᵀ p plus T (I - P Pᵀ) p, of which
   nothing is known but its size. Plain non-negative least squares on D Pᵀ (Eq. 2.9) ignores the second part and fills it at will: it likes a
   few bright points whose photo is nothing like the target. So the unknown part has a price,

       minimise  ||D Pᵀ p - i||² + τ² ||(I - P Pᵀ) p||²    over p >= 0,

   with τ the smallest singular value of D: T's singular values outside a Krylov space are about as large as the smallest found inside. At
   k = ncols the second part is empty and this is the exact problem. D = Q R leaves a k x k problem, H = τ² I + P (RᵀR - τ² I) Pᵀ.

   Block principal pivoting: L. F. Portugal, J. J. Judice, L. N. Vicente, A comparison of block pivoting and interior-point algorithms for
   linear least squares problems with nonnegative variables, Mathematics of Computation 63 (1994). */
#include "run.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* τ is at least this share of the largest singular value: H then has a condition number of at most 1e8, which keeps half of the digits
   of a double, far more than photos have. */
static const double least_price = 1e-4;
/* Full exchanges that may pass without progress, as in the paper. */
enum { PATIENCE = 3, MAX_EXCHANGES = 2000 };

typedef struct {
	optla_ctx *ctx;
	size_t n, k;
	double *p;        /* n x k */
	double *m, *g;    /* M = RᵀR - τ² I, k x k; Rᵀ Qᵀ i, k */
	double *b;        /* P g: minus the gradient at zero, n */
	double tau2;      /* τ² */
	double condition; /* σ² / τ², σ the largest singular value of D */
	double *x, *y;    /* solution and gradient H x - b, n */
	bool *passive;    /* n: x may be positive */
	double *gram;     /* k x k: P_Fᵀ P_F */
	double *small;    /* k x k system */
	double *v[3];     /* k each */
} problem;

/* out = M v */
static void times_m(const problem *q, const double *v, double *out)
{
	for (size_t i = 0; i < q->k; i++) {
		out[i] = 0;
		for (size_t j = 0; j < q->k; j++) out[i] += q->m[j * q->k + i] * v[j];
	}
}

/* out = Pᵀ v over the passive entries. */
static void passive_part(const problem *q, const double *v, double *out)
{
	for (size_t j = 0; j < q->k; j++) {
		out[j] = 0;
		for (size_t i = 0; i < q->n; i++)
			if (q->passive[i]) out[j] += q->p[j * q->n + i] * v[i];
	}
}

static void set_gram(problem *q)
{
	for (size_t a = 0; a < q->k; a++)
		for (size_t c = 0; c <= a; c++) {
			double sum = 0;
			for (size_t i = 0; i < q->n; i++)
				if (q->passive[i]) sum += q->p[a * q->n + i] * q->p[c * q->n + i];
			q->gram[a * q->k + c] = q->gram[c * q->k + a] = sum;
		}
}

/* H_FF x_F = b_F by Woodbury: (τ² I + M P_Fᵀ P_F) w = M P_Fᵀ b_F, x_F = (b_F - P_F w) / τ². */
static optla_status solve_passive(problem *q)
{
	const size_t k = q->k;
	set_gram(q);
	for (size_t c = 0; c < k; c++) {
		times_m(q, q->gram + c * k, q->small + c * k);
		q->small[c * k + c] += q->tau2;
	}
	passive_part(q, q->b, q->v[0]);
	times_m(q, q->v[0], q->v[1]);
	OPTLA_TRY(optla_solve_(q->ctx, q->small, k, q->v[1], 1, q->v[2]));
	for (size_t i = 0; i < q->n; i++) {
		q->x[i] = q->passive[i] ? q->b[i] : 0;
		for (size_t j = 0; j < k && q->passive[i]; j++) q->x[i] -= q->p[j * q->n + i] * q->v[2][j];
		q->x[i] /= q->tau2;
	}
	return OPTLA_OK;
}

/* y = τ² x + P M Pᵀ x - b on the entries that are held at zero. */
static void set_gradient(problem *q)
{
	passive_part(q, q->x, q->v[0]);
	times_m(q, q->v[0], q->v[1]);
	for (size_t i = 0; i < q->n; i++) {
		q->y[i] = -q->b[i];
		for (size_t j = 0; j < q->k && !q->passive[i]; j++) q->y[i] += q->p[j * q->n + i] * q->v[1][j];
	}
}

/* Entries with the wrong sign; *last the one with the largest index. */
static size_t infeasible(const problem *q, double x_dirt, double y_dirt, size_t *last)
{
	size_t count = 0;
	for (size_t i = 0; i < q->n; i++)
		if (q->passive[i] ? q->x[i] < -x_dirt : q->y[i] < -y_dirt) {
			count++;
			*last = i;
		}
	return count;
}

static double largest(const double *v, size_t n)
{
	double most = 0;
	for (size_t i = 0; i < n; i++) most = fmax(most, fabs(v[i]));
	return most;
}

static optla_status pivot(problem *q)
{
	size_t best = q->n + 1, last = 0;
	int patience = PATIENCE;
	/* x comes from differences of numbers as large as b / τ², and an error e of x is one of σ² e in y. */
	const double b = largest(q->b, q->n), x_dirt = 16 * DBL_EPSILON * b / q->tau2, y_dirt = 16 * DBL_EPSILON * b * q->condition;
	for (int step = 0; step < MAX_EXCHANGES; step++) {
		OPTLA_TRY(optla_check_cancel_(q->ctx));
		OPTLA_TRY(solve_passive(q));
		set_gradient(q);
		const size_t wrong = infeasible(q, x_dirt, y_dirt, &last);
		if (wrong == 0) return OPTLA_OK;
		const bool progress = wrong < best;
		patience = progress ? PATIENCE : patience - 1;
		if (progress) best = wrong;
		for (size_t i = 0; i < q->n; i++) {
			if (!progress && patience < 0 && i != last) continue; /* one at a time can't cycle (K. G. Murty 1974) */
			if (q->passive[i] ? q->x[i] < -x_dirt : q->y[i] < -y_dirt) q->passive[i] = !q->passive[i];
		}
	}
	optla_log_(q->ctx, 0, "non-negative illumination: after %d exchanges the signs of %zu of %zu lights are still open",
	           MAX_EXCHANGES, best, q->n);
	return OPTLA_OK;
}

/* M, g, b and τ from the factors of the run. */
static optla_status set_up(problem *q, const optla_krylov *run)
{
	const size_t k = q->k;
	for (size_t l = 0; l < k; l++)
		for (size_t j = 0; j < k; j++) q->small[l * k + j] = j <= l ? run->qr[j + l * run->kmax] : 0;
	OPTLA_TRY(optla_svd_(q->ctx, q->small, k, k, q->v[0], NULL, NULL));
	const double tau = fmax(q->v[0][k - 1], least_price * q->v[0][0]);
	q->tau2 = tau * tau;
	q->condition = q->tau2 > 0 ? q->v[0][0] * q->v[0][0] / q->tau2 : 1;
	for (size_t a = 0; a < k; a++) {
		q->g[a] = 0;
		for (size_t j = 0; j <= a; j++) q->g[a] += q->small[a * k + j] * run->qt[j];
		for (size_t c = 0; c < k; c++) {
			double sum = a == c ? -q->tau2 : 0;
			for (size_t j = 0; j < k; j++) sum += q->small[a * k + j] * q->small[c * k + j];
			q->m[a * k + c] = sum;
		}
	}
	for (size_t j = 0; j < k; j++)
		for (size_t i = 0; i < q->n; i++) {
			q->p[j * q->n + i] = optla_get_(optla_block_const(run->p), i, j);
			q->b[i] += q->p[j * q->n + i] * q->g[j];
		}
	return OPTLA_OK;
}

static bool reserve(problem *q)
{
	const size_t n = q->n, k = q->k, bytes = sizeof(double);
	return (q->p = optla_array_(q->ctx, n * k, bytes)) && (q->m = optla_array_(q->ctx, k * k, bytes)) &&
	       (q->g = optla_array_(q->ctx, k, bytes)) && (q->b = optla_calloc_(q->ctx, n, bytes)) &&
	       (q->x = optla_calloc_(q->ctx, n, bytes)) && (q->y = optla_array_(q->ctx, n, bytes)) &&
	       (q->passive = optla_calloc_(q->ctx, n, sizeof(bool))) && (q->gram = optla_array_(q->ctx, k * k, bytes)) &&
	       (q->small = optla_array_(q->ctx, k * k, bytes)) && (q->v[0] = optla_array_(q->ctx, k, bytes)) &&
	       (q->v[1] = optla_array_(q->ctx, k, bytes)) && (q->v[2] = optla_array_(q->ctx, k, bytes));
}

optla_status optla_gmres_nonnegative_(const optla_krylov *run, size_t k, optla_block p)
{
	problem q = {.ctx = run->ctx, .n = run->ncols, .k = k};
	optla_status status = reserve(&q) ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!status) status = set_up(&q, run);
	if (!status && q.tau2 > 0) status = pivot(&q); /* τ = 0: every photo was black, so is the light */
	for (size_t i = 0; !status && i < q.n; i++) optla_set_(p, i, 0, fmax(q.x[i], 0));
	void *all[] = {q.p, q.m, q.g, q.b, q.x, q.y, q.passive, q.gram, q.small, q.v[0], q.v[1], q.v[2]};
	for (size_t i = 0; i < sizeof all / sizeof *all; i++) optla_free(run->ctx, all[i]);
	return status;
}
