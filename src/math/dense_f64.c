/* SPDX-License-Identifier: BSD-3-Clause */
/* Tiles of a double matrix: as dense_f32.c, four columns per pass. */
#include "math/dense_impl.h"

OPTLA_CLONES static void add_4_columns(size_t n, const double *restrict a, size_t lda, const double *x, double *restrict y)
{
	const double x0 = x[0], x1 = x[1], x2 = x[2], x3 = x[3];
#pragma omp simd
	for (size_t i = 0; i < n; i++) y[i] += (a[i] * x0 + a[lda + i] * x1) + (a[2 * lda + i] * x2 + a[3 * lda + i] * x3);
}

OPTLA_CLONES static void add_column(size_t n, const double *restrict a, double x, double *restrict y)
{
#pragma omp simd
	for (size_t i = 0; i < n; i++) y[i] += a[i] * x;
}

void optla_tile_forward_f64_(optla_tile t, void *y_, size_t ldy)
{
	const double *a = t.a, *x = t.x;
	double *y = y_;
	size_t j = 0;
	for (; j + 4 <= t.cols; j += 4)
		for (size_t r = 0; r < t.nrhs; r++) add_4_columns(t.rows, a + j * t.lda, t.lda, x + r * t.ldx + j, y + r * ldy);
	for (; j < t.cols; j++)
		for (size_t r = 0; r < t.nrhs; r++) add_column(t.rows, a + j * t.lda, x[r * t.ldx + j], y + r * ldy);
}

OPTLA_CLONES static void dots_4_columns(size_t n, const double *restrict a, size_t lda, const double *restrict x, double *sums)
{
	double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
#pragma omp simd reduction(+ : s0, s1, s2, s3)
	for (size_t i = 0; i < n; i++) {
		const double v = x[i];
		s0 += a[i] * v;
		s1 += a[lda + i] * v;
		s2 += a[2 * lda + i] * v;
		s3 += a[3 * lda + i] * v;
	}
	sums[0] += s0, sums[1] += s1, sums[2] += s2, sums[3] += s3;
}

OPTLA_CLONES static void dot_column(size_t n, const double *restrict a, const double *restrict x, double *sum)
{
	double s = 0;
#pragma omp simd reduction(+ : s)
	for (size_t i = 0; i < n; i++) s += a[i] * x[i];
	*sum += s;
}

void optla_tile_dots_f64_(optla_tile t, bool conj, double *sums, size_t lds)
{
	(void)conj;
	const double *a = t.a, *x = t.x;
	size_t j = 0;
	for (; j + 4 <= t.cols; j += 4)
		for (size_t r = 0; r < t.nrhs; r++) dots_4_columns(t.rows, a + j * t.lda, t.lda, x + r * t.ldx, sums + r * lds + j);
	for (; j < t.cols; j++)
		for (size_t r = 0; r < t.nrhs; r++) dot_column(t.rows, a + j * t.lda, x + r * t.ldx, sums + r * lds + j);
}
