/* SPDX-License-Identifier: BSD-3-Clause */
/* When more photos can't help (thesis section 2.7, after V. Simoncini and D. B. Szyld, Theory of inexact Krylov subspace methods and
   applications to scientific computing, SIAM J. Sci. Comput. 25, 2003).

   Products are d_k = T p_k + e_k (Eq. 2.12), with E||e_k||² = n_k² known from the sensor. For orthonormal p_k

       E||T - D Pᵀ||² = ||T||² - sum_k ||T p_k||² + sum_k n_k²,        E||d_k||² = ||T p_k||² + n_k²,

   so photo k lowers the expected squared error by ||d_k||² - 2 n_k² and is worth taking while that is positive.

   For the inverse problem the computed residual i - D y = (i - T P y) - E y holds the gap E y, which is random and so nearly orthogonal
   to the true residual; fitting k numbers takes its share of it. Hence

       E||i - T P y||² ~ ||i - D y||² m / (m - k) - sum_k n_k² y_k²      (m pixels),

   and photos help while that falls. It is compared with itself only, from k to k+1, not with zero: over m pixels its noise's share is
   known to a part sqrt(2/m), which may be more than the residual. (Products split by offset share the noise of y(1) and y(0); the sum
   over k takes their errors as independent, so that the level, not the fall, is uncertain there.) */
#include "run.h"

#include <math.h>

/* A later direction may carry more light than the present one, so one useless photo isn't the end; this many in a row are. Residuals of
   the inverse problem have longer plateaus (a dozen photos were seen). */
enum { PATIENCE = 3, PATIENCE_INVERSE = 12 };

double optla_noise_gap_(const optla_krylov *run, size_t k, const double *y)
{
	double sum = 0;
	for (size_t j = 0; j < k; j++) sum += run->noise[j] * run->noise[j] * y[j] * y[j];
	return sqrt(sum);
}

static size_t best_capture(const optla_krylov *run)
{
	double gain = 0, most = 0;
	size_t best = 0;
	for (size_t j = 0; j < run->k; j++) {
		gain += run->energy[j] - 2 * run->noise[j] * run->noise[j];
		if (gain > most) {
			most = gain;
			best = j + 1;
		}
	}
	return best;
}

double optla_noise_true_residual2_(const optla_krylov *run, size_t k)
{
	const double r = run->residuals[k - 1] * run->target_norm, g = run->gaps[k - 1], m = (double)run->nrows;
	return r * r * m / fmax(m - (double)k, 1) - g * g;
}

static size_t best_inverse(const optla_krylov *run, bool *useless)
{
	double least = INFINITY;
	size_t best = 0;
	for (size_t j = 1; j <= run->k; j++) {
		const double e = optla_noise_true_residual2_(run, j);
		if (e < least) {
			least = e;
			best = j;
		}
	}
	*useless = run->k >= best + PATIENCE_INVERSE;
	return best;
}

size_t optla_noise_best_(const optla_krylov *run, bool *useless)
{
	if (run->method == OPTLA_KRYLOV_GMRES) return best_inverse(run, useless);
	const size_t best = best_capture(run);
	*useless = run->k >= best + PATIENCE;
	return best;
}

double optla_noise_allowed_(const optla_krylov *run)
{
	const size_t k = run->k;
	if (run->method != OPTLA_KRYLOV_GMRES || !k || run->opt.tolerance <= 0) return 0;
	/* sigma_min(R) is bounded from above by the smallest diagonal entry, cheaply and closely enough for orthogonal iterations. */
	double smallest = INFINITY;
	for (size_t j = 0; j < k; j++) smallest = fmin(smallest, fabs(run->qr[j + j * run->kmax]));
	const double before = k > 1 ? run->residuals[k - 2] : 1; /* ||r_{k-1}|| / ||i|| */
	return smallest / (double)k * run->opt.tolerance / before;
}
