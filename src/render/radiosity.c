/* SPDX-License-Identifier: BSD-3-Clause */
/* With S = R^½ A^-½ and M = S X S (X = A F is symmetric), G = S (I - M)⁻¹ M S: one symmetric system, also where an albedo is 0. */
#include "render/radiosity.h"

#include "math/dense.h"

#include <math.h>

/* m = S X S, system = I - m */
static void build_system(const double *exchange_m2, const double *s, size_t n, double *m, double *system)
{
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < n; i++) {
			m[j * n + i] = s[i] * exchange_m2[j * n + i] * s[j];
			system[j * n + i] = (i == j ? 1 : 0) - m[j * n + i];
		}
}

/* kernel = S (Z + Zᵀ)/2 S: the solver's rounding must not make light prefer a direction. */
static void scale_symmetric(double *z, const double *s, size_t n)
{
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i <= j; i++) {
			const double v = s[i] * s[j] * (z[j * n + i] + z[i * n + j]) / 2;
			z[j * n + i] = z[i * n + j] = v;
		}
}

optla_status optla_radiosity_kernel_(optla_ctx *ctx, const double *exchange_m2, const double *area_m2, const double *albedo,
                                     size_t n, double *kernel)
{
	double *s = optla_array_(ctx, n, sizeof *s), *m = optla_array_(ctx, n, n * sizeof *m),
	       *system = optla_array_(ctx, n, n * sizeof *system);
	optla_status status = s && m && system ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!status) {
		for (size_t i = 0; i < n; i++) s[i] = sqrt(albedo[i] / area_m2[i]);
		build_system(exchange_m2, s, n, m, system);
		status = optla_solve_(ctx, system, n, m, n, kernel);
	}
	if (!status) scale_symmetric(kernel, s, n);
	optla_free(ctx, system);
	optla_free(ctx, m);
	optla_free(ctx, s);
	return status;
}
