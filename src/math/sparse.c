/* SPDX-License-Identifier: BSD-3-Clause */
/* Sparse matrices in compressed rows: copy, transpose (counting sort), product. */
#include "math/sparse.h"
#include "math/clones.h"

#include <string.h>

static optla_status csr_alloc(optla_ctx *ctx, size_t nrows, size_t ncols, size_t count, optla_scalar type, optla_csr *a)
{
	const optla_csr made = {nrows,
	                        ncols,
	                        type,
	                        optla_calloc_(ctx, nrows + 1, sizeof *made.row_start),
	                        optla_array_(ctx, count, sizeof *made.column),
	                        optla_array_(ctx, count, optla_scalar_bytes(type))};
	*a = made;
	if (a->row_start && a->column && a->values) return OPTLA_OK;
	optla_csr_clear_(ctx, a);
	return OPTLA_ERR_NOMEM;
}

void optla_csr_clear_(optla_ctx *ctx, optla_csr *a)
{
	optla_free(ctx, a->row_start);
	optla_free(ctx, a->column);
	optla_free(ctx, a->values);
	memset(a, 0, sizeof *a);
}

optla_status optla_csr_copy_(optla_ctx *ctx, size_t nrows, size_t ncols, const uint64_t *row_start, const uint32_t *column,
                             optla_cblock values, optla_csr *a)
{
	const size_t count = (size_t)row_start[nrows];
	OPTLA_TRY(csr_alloc(ctx, nrows, ncols, count, values.type, a));
	memcpy(a->row_start, row_start, (nrows + 1) * sizeof *row_start);
	if (count) memcpy(a->column, column, count * sizeof *column);
	if (count) memcpy(a->values, values.data, count * optla_scalar_bytes(values.type));
	return OPTLA_OK;
}

optla_status optla_csr_transpose_(optla_ctx *ctx, const optla_csr *a, optla_csr *at)
{
	const size_t count = (size_t)a->row_start[a->nrows], bytes = optla_scalar_bytes(a->type);
	OPTLA_TRY(csr_alloc(ctx, a->ncols, a->nrows, count, a->type, at));
	uint64_t *next = at->row_start; /* first where the next entry of a row goes, afterwards the end of that row */
	for (size_t k = 0; k < count; k++) next[a->column[k] + 1]++;
	for (size_t j = 0; j < a->ncols; j++) next[j + 1] += next[j];
	for (size_t i = 0; i < a->nrows; i++)
		for (uint64_t k = a->row_start[i]; k < a->row_start[i + 1]; k++) {
			const uint64_t to = next[a->column[k]]++;
			at->column[to] = (uint32_t)i;
			memcpy((char *)at->values + to * bytes, (const char *)a->values + k * bytes, bytes);
		}
	memmove(next + 1, next, a->ncols * sizeof *next);
	next[0] = 0;
	return OPTLA_OK;
}

OPTLA_CLONES static void rows_f32(const optla_csr *a, size_t first, size_t end, const float *restrict x, float *restrict y)
{
	const float *restrict v = a->values;
	const uint32_t *restrict c = a->column;
	for (size_t i = first; i < end; i++) {
		double s = 0;
#pragma omp simd reduction(+ : s)
		for (uint64_t k = a->row_start[i]; k < a->row_start[i + 1]; k++) s += (double)v[k] * (double)x[c[k]];
		y[i] = (float)s;
	}
}

OPTLA_CLONES static void rows_f64(const optla_csr *a, size_t first, size_t end, const double *restrict x, double *restrict y)
{
	const double *restrict v = a->values;
	const uint32_t *restrict c = a->column;
	for (size_t i = first; i < end; i++) {
		double s = 0;
#pragma omp simd reduction(+ : s)
		for (uint64_t k = a->row_start[i]; k < a->row_start[i + 1]; k++) s += v[k] * x[c[k]];
		y[i] = s;
	}
}

static void row_c32(const optla_csr *a, size_t i, const float *x, float *y)
{
	const float *v = a->values;
	double re = 0, im = 0;
	for (uint64_t k = a->row_start[i]; k < a->row_start[i + 1]; k++) {
		const double vr = (double)v[2 * k], vi = (double)v[2 * k + 1];
		const double xr = (double)x[2 * (size_t)a->column[k]], xi = (double)x[2 * (size_t)a->column[k] + 1];
		re += vr * xr - vi * xi;
		im += vr * xi + vi * xr;
	}
	y[0] = (float)re, y[1] = (float)im;
}

static void row_c64(const optla_csr *a, size_t i, const double *x, double *y)
{
	const double *v = a->values;
	double re = 0, im = 0;
	for (uint64_t k = a->row_start[i]; k < a->row_start[i + 1]; k++) {
		const double xr = x[2 * (size_t)a->column[k]], xi = x[2 * (size_t)a->column[k] + 1];
		re += v[2 * k] * xr - v[2 * k + 1] * xi;
		im += v[2 * k] * xi + v[2 * k + 1] * xr;
	}
	y[0] = re, y[1] = im;
}

static void apply_rows(const optla_csr *a, size_t first, size_t end, const void *x, void *y)
{
	switch (a->type) {
	case OPTLA_F32: rows_f32(a, first, end, x, y); break;
	case OPTLA_F64: rows_f64(a, first, end, x, y); break;
	case OPTLA_C32:
		for (size_t i = first; i < end; i++) row_c32(a, i, x, (float *)y + 2 * i);
		break;
	case OPTLA_C64:
		for (size_t i = first; i < end; i++) row_c64(a, i, x, (double *)y + 2 * i);
		break;
	}
}

void optla_csr_apply_(optla_ctx *ctx, const optla_csr *a, optla_cblock x, optla_block y)
{
	enum { CHUNK = 256 }; /* rows with many entries sit together: shared out as threads come free */
	const size_t bytes = optla_scalar_bytes(a->type), nchunks = (a->nrows + CHUNK - 1) / CHUNK;
#pragma omp parallel for num_threads(optla_ctx_threads(ctx)) schedule(dynamic)
	for (size_t c = 0; c < nchunks; c++)
		for (size_t r = 0; r < x.ncols; r++)
			apply_rows(a, c * CHUNK, optla_min_(a->nrows, (c + 1) * CHUNK), (const char *)x.data + r * x.ld * bytes,
			           (char *)y.data + r * y.ld * bytes);
}
