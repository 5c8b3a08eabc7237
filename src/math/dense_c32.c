/* SPDX-License-Identifier: BSD-3-Clause */
/* Tiles of a complex matrix, float real and imaginary parts side by side. */
#include "math/dense_impl.h"

OPTLA_CLONES static void add_column(size_t n, const float *restrict a, const float *x, float *restrict y)
{
	const float xr = x[0], xi = x[1];
#pragma omp simd
	for (size_t i = 0; i < n; i++) {
		const float ar = a[2 * i], ai = a[2 * i + 1];
		y[2 * i] += ar * xr - ai * xi;
		y[2 * i + 1] += ar * xi + ai * xr;
	}
}

void optla_tile_forward_c32_(optla_tile t, void *y_, size_t ldy)
{
	const float *a = t.a, *x = t.x;
	float *y = y_;
	for (size_t j = 0; j < t.cols; j++)
		for (size_t r = 0; r < t.nrhs; r++) add_column(t.rows, a + 2 * j * t.lda, x + 2 * (r * t.ldx + j), y + 2 * r * ldy);
}

/* sum += (ar + i sign ai) (xr + i xi) */
OPTLA_CLONES static void dot_column(size_t n, const float *restrict a, float sign, const float *restrict x, double *sum)
{
	enum { FLOAT_ROWS = 1024 }; /* as in dense_f32.c */
	for (size_t first = 0; first < n; first += FLOAT_ROWS) {
		const size_t end = n - first < FLOAT_ROWS ? n : first + FLOAT_ROWS;
		float rr = 0, ii = 0, ri = 0, ir = 0;
#pragma omp simd reduction(+ : rr, ii, ri, ir)
		for (size_t i = first; i < end; i++) {
			const float ar = a[2 * i], ai = a[2 * i + 1], xr = x[2 * i], xi = x[2 * i + 1];
			rr += ar * xr;
			ii += ai * xi;
			ri += ar * xi;
			ir += ai * xr;
		}
		sum[0] += (double)(rr - sign * ii);
		sum[1] += (double)(ri + sign * ir);
	}
}

void optla_tile_dots_c32_(optla_tile t, bool conj, double *sums, size_t lds)
{
	const float *a = t.a, *x = t.x;
	const float sign = conj ? -1 : 1;
	for (size_t j = 0; j < t.cols; j++)
		for (size_t r = 0; r < t.nrhs; r++)
			dot_column(t.rows, a + 2 * j * t.lda, sign, x + 2 * r * t.ldx, sums + 2 * (r * lds + j));
}
