/* SPDX-License-Identifier: BSD-3-Clause */
/* With S = R^½ A^-½ and X = A F symmetric, B = S (I - S X S)⁻¹ S Φ: also where an albedo is 0. */
#include "render/radiosity.h"

#include "math/dense.h"

#include <math.h>

static void build_system(const double *exchange_m2, const double *s, size_t n, double *system)
{
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < n; i++) system[j * n + i] = (i == j ? 1 : 0) - s[i] * exchange_m2[j * n + i] * s[j];
}

static void scale_rows(const double *s, size_t n, const double *in, size_t count, double *out)
{
	for (size_t k = 0; k < count; k++)
		for (size_t i = 0; i < n; i++) out[k * n + i] = s[i] * in[k * n + i];
}

optla_status optla_radiosity_solve_(optla_ctx *ctx, const double *exchange_m2, const double *area_m2, const double *albedo,
                                    size_t n, const double *flux_w, size_t count, double *exitance_w_m2)
{
	double *s = optla_array_(ctx, n, sizeof *s), *system = optla_array_(ctx, n, n * sizeof *system),
	       *right = optla_array_(ctx, n, count * sizeof *right);
	optla_status status = s && system && right ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!status) {
		for (size_t i = 0; i < n; i++) s[i] = sqrt(albedo[i] / area_m2[i]);
		build_system(exchange_m2, s, n, system);
		scale_rows(s, n, flux_w, count, right);
		status = optla_solve_(ctx, system, n, right, count, exitance_w_m2);
	}
	if (!status) scale_rows(s, n, exitance_w_m2, count, exitance_w_m2);
	optla_free(ctx, right);
	optla_free(ctx, system);
	optla_free(ctx, s);
	return status;
}
