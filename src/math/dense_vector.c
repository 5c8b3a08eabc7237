/* SPDX-License-Identifier: BSD-3-Clause */
/* Blocks and their columns: views, dot products, norms, copies. Sums are taken in double, in the order of the rows with eight
   interleaved accumulators. */
#include "math/dense.h"

#include <math.h>
#include <string.h>

size_t optla_scalar_bytes(optla_scalar type)
{
	switch (type) {
	case OPTLA_F32: return sizeof(float);
	case OPTLA_F64: return sizeof(double);
	case OPTLA_C32: return 2 * sizeof(float);
	case OPTLA_C64: return 2 * sizeof(double);
	}
	return 0;
}

optla_cblock optla_columns_(optla_cblock b, size_t first, size_t count)
{
	b.data = (const char *)b.data + first * b.ld * optla_scalar_bytes(b.type);
	b.ncols = count;
	return b;
}

optla_block optla_columns_mut_(optla_block b, size_t first, size_t count)
{
	b.data = (char *)b.data + first * b.ld * optla_scalar_bytes(b.type);
	b.ncols = count;
	return b;
}

static const float *column_f32(optla_cblock a, size_t j) { return (const float *)a.data + j * a.ld; }
static const double *column_f64(optla_cblock a, size_t j) { return (const double *)a.data + j * a.ld; }

static double sum_8(const double s[8]) { return ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7])); }

static double dot_f32(size_t n, const float *a, const float *b)
{
	double s[8] = {0};
	size_t i = 0;
	for (; i + 8 <= n; i += 8)
		for (size_t k = 0; k < 8; k++) s[k] += (double)a[i + k] * (double)b[i + k];
	for (; i < n; i++) s[i % 8] += (double)a[i] * (double)b[i];
	return sum_8(s);
}

static double dot_f64(size_t n, const double *a, const double *b)
{
	double s[8] = {0};
	size_t i = 0;
	for (; i + 8 <= n; i += 8)
		for (size_t k = 0; k < 8; k++) s[k] += a[i + k] * b[i + k];
	for (; i < n; i++) s[i % 8] += a[i] * b[i];
	return sum_8(s);
}

double optla_dot_(optla_cblock a, size_t i, optla_cblock b, size_t j)
{
	if (a.type == OPTLA_F32 && b.type == OPTLA_F32) return dot_f32(a.nrows, column_f32(a, i), column_f32(b, j));
	if (a.type == OPTLA_F64 && b.type == OPTLA_F64) return dot_f64(a.nrows, column_f64(a, i), column_f64(b, j));
	double s = 0;
	for (size_t r = 0; r < a.nrows; r++) s += optla_get_(a, r, i) * optla_get_(b, r, j);
	return s;
}

double optla_norm_(optla_cblock a, size_t i) { return sqrt(optla_dot_(a, i, a, i)); }

double optla_norm_fro_(optla_cblock a)
{
	const size_t n = a.type >= OPTLA_C32 ? 2 * a.nrows : a.nrows, ld = a.type >= OPTLA_C32 ? 2 * a.ld : a.ld;
	const bool single = a.type == OPTLA_F32 || a.type == OPTLA_C32;
	double s = 0;
	for (size_t j = 0; j < a.ncols; j++) {
		const float *f = (const float *)a.data + j * ld;
		const double *d = (const double *)a.data + j * ld;
		s += single ? dot_f32(n, f, f) : dot_f64(n, d, d);
	}
	return sqrt(s);
}

void optla_clear_(optla_block a, size_t i)
{
	const size_t bytes = optla_scalar_bytes(a.type);
	memset((char *)a.data + i * a.ld * bytes, 0, a.nrows * bytes);
}

void optla_scale_(optla_block a, size_t i, double factor)
{
	if (a.type == OPTLA_F32) {
		float *p = (float *)a.data + i * a.ld;
		for (size_t r = 0; r < a.nrows; r++) p[r] = (float)((double)p[r] * factor);
	} else {
		double *p = (double *)a.data + i * a.ld;
		for (size_t r = 0; r < a.nrows; r++) p[r] *= factor;
	}
}

void optla_axpy_(double factor, optla_cblock x, size_t i, optla_block y, size_t j)
{
	if (x.type == OPTLA_F32 && y.type == OPTLA_F32) {
		const float *p = column_f32(x, i);
		float *q = (float *)y.data + j * y.ld;
		for (size_t r = 0; r < x.nrows; r++) q[r] = (float)((double)q[r] + factor * (double)p[r]);
	} else if (x.type == OPTLA_F64 && y.type == OPTLA_F64) {
		const double *p = column_f64(x, i);
		double *q = (double *)y.data + j * y.ld;
		for (size_t r = 0; r < x.nrows; r++) q[r] += factor * p[r];
	} else
		for (size_t r = 0; r < x.nrows; r++)
			optla_set_(y, r, j, optla_get_(optla_block_const(y), r, j) + factor * optla_get_(x, r, i));
}

void optla_copy_column_(optla_cblock x, size_t i, optla_block y, size_t j)
{
	if (x.type == y.type) {
		const size_t bytes = optla_scalar_bytes(x.type);
		if (x.nrows) memcpy((char *)y.data + j * y.ld * bytes, (const char *)x.data + i * x.ld * bytes, x.nrows * bytes);
		return;
	}
	for (size_t r = 0; r < x.nrows; r++) optla_set_(y, r, j, optla_get_(x, r, i));
}

double optla_get_(optla_cblock a, size_t row, size_t column)
{
	return a.type == OPTLA_F32 ? (double)column_f32(a, column)[row] : column_f64(a, column)[row];
}

void optla_set_(optla_block a, size_t row, size_t column, double value)
{
	if (a.type == OPTLA_F32)
		((float *)a.data)[column * a.ld + row] = (float)value;
	else
		((double *)a.data)[column * a.ld + row] = value;
}
