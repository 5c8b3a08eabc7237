/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks and copies of blocks of columns. */
#include "op/op_impl.h"

#include <math.h>
#include <string.h>

const char *optla_scalar_name_(optla_scalar type)
{
	static const char *const names[] = {"f32", "f64", "c32", "c64"};
	return (unsigned)type <= OPTLA_C64 ? names[type] : "unknown";
}

optla_status optla_block_check_(optla_ctx *ctx, const char *what, optla_cblock b)
{
	OPTLA_CHECK(ctx, optla_scalar_bytes(b.type), OPTLA_ERR_SHAPE, "%s has scalar type %d; allowed are f32, f64, c32, c64", what,
	            (int)b.type);
	OPTLA_CHECK(ctx, b.ld >= b.nrows, OPTLA_ERR_SHAPE, "%s is %zu x %zu but its columns are only %zu scalars apart", what,
	            b.nrows, b.ncols, b.ld);
	size_t scalars, bytes;
	OPTLA_CHECK(ctx, optla_size_mul_(b.ld, b.ncols, &scalars) && optla_size_mul_(scalars, optla_scalar_bytes(b.type), &bytes),
	            OPTLA_ERR_SHAPE, "%s is %zu x %zu: more than the address space", what, b.nrows, b.ncols);
	OPTLA_CHECK(ctx, b.data || !b.nrows || !b.ncols, OPTLA_ERR_ARG, "%s is %zu x %zu without data", what, b.nrows, b.ncols);
	return OPTLA_OK;
}

size_t optla_first_not_finite_(const void *data, size_t n, bool single)
{
	/* x * 0 is 0 for every finite number: a whole column is tested by one sum, the culprit is sought only if there is one */
	double sum = 0;
	if (single) {
		const float *f = data;
		float s[16] = {0};
		for (size_t i = 0; i + 16 <= n; i += 16)
			for (size_t k = 0; k < 16; k++) s[k] += f[i + k] * 0;
		for (size_t i = n - n % 16; i < n; i++) s[0] += f[i] * 0;
		for (size_t k = 0; k < 16; k++) sum += (double)s[k];
		if (sum == 0) return n;
		for (size_t i = 0; i < n; i++)
			if (!isfinite(f[i])) return i;
		return n;
	}
	const double *d = data;
	for (size_t i = 0; i < n; i++) sum += d[i] * 0;
	if (sum == 0) return n;
	for (size_t i = 0; i < n; i++)
		if (!isfinite(d[i])) return i;
	return n;
}

size_t optla_first_negative_(const void *data, size_t n, bool single)
{
	const float *f = data;
	const double *d = data;
	for (size_t i = 0; i < n; i++)
		if (single ? f[i] < 0 : d[i] < 0) return i;
	return n;
}

optla_status optla_block_check_finite_(optla_ctx *ctx, const char *what, optla_cblock b)
{
	const size_t parts = optla_is_complex_(b.type) ? 2 : 1, n = b.nrows * parts;
	const bool single = optla_is_single_(b.type);
	for (size_t j = 0; j < b.ncols; j++) {
		const char *column = (const char *)b.data + j * b.ld * optla_scalar_bytes(b.type);
		const size_t i = optla_first_not_finite_(column, n, single);
		if (i == n) continue;
		const double v = single ? (double)((const float *)(const void *)column)[i] : ((const double *)(const void *)column)[i];
		return OPTLA_FAIL(ctx, OPTLA_ERR_ARG, "%s is %g at row %zu, column %zu; all numbers must be finite", what, v, i / parts,
		                  j);
	}
	return OPTLA_OK;
}

void optla_block_conj_(optla_cblock src, optla_block dst)
{
	for (size_t j = 0; j < src.ncols; j++) {
		const size_t from = 2 * j * src.ld, to = 2 * j * dst.ld;
		if (optla_is_single_(src.type)) {
			const float *s = (const float *)src.data + from;
			float *d = (float *)dst.data + to;
			for (size_t i = 0; i < 2 * src.nrows; i += 2) d[i] = s[i], d[i + 1] = -s[i + 1];
		} else {
			const double *s = (const double *)src.data + from;
			double *d = (double *)dst.data + to;
			for (size_t i = 0; i < 2 * src.nrows; i += 2) d[i] = s[i], d[i + 1] = -s[i + 1];
		}
	}
}

void optla_block_add_(optla_cblock src, optla_block dst)
{
	const size_t parts = optla_is_complex_(src.type) ? 2 : 1, n = src.nrows * parts;
	for (size_t j = 0; j < src.ncols; j++) {
		if (optla_is_single_(src.type)) {
			const float *s = (const float *)src.data + parts * j * src.ld;
			float *d = (float *)dst.data + parts * j * dst.ld;
			for (size_t i = 0; i < n; i++) d[i] += s[i];
		} else {
			const double *s = (const double *)src.data + parts * j * src.ld;
			double *d = (double *)dst.data + parts * j * dst.ld;
			for (size_t i = 0; i < n; i++) d[i] += s[i];
		}
	}
}

optla_block optla_block_new_(optla_ctx *ctx, size_t nrows, size_t ncols, optla_scalar type)
{
	optla_block b = {NULL, nrows, ncols, nrows, type};
	size_t count;
	if (!optla_size_mul_(nrows, ncols, &count)) count = SIZE_MAX;
	b.data = optla_array_(ctx, count, optla_scalar_bytes(type));
	return b;
}

optla_block optla_block_copy_(optla_ctx *ctx, optla_cblock src)
{
	optla_block b = optla_block_new_(ctx, src.nrows, src.ncols, src.type);
	const size_t bytes = optla_scalar_bytes(src.type);
	if (b.data && src.nrows)
		for (size_t j = 0; j < src.ncols; j++)
			memcpy((char *)b.data + j * b.ld * bytes, (const char *)src.data + j * src.ld * bytes, src.nrows * bytes);
	return b;
}
