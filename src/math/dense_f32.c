/* SPDX-License-Identifier: BSD-3-Clause */
/* Tiles of a float matrix. Each pass reads eight columns of A (four for several right-hand sides) so that y is loaded and stored
   once for eight products, and each element of A is loaded once for four or eight right-hand sides. */
#include "math/dense_impl.h"

OPTLA_CLONES static void add_8_columns(size_t n, const float *restrict a, size_t lda, const float *x, float *restrict y)
{
	const float *restrict b = a + 4 * lda;
	const float x0 = x[0], x1 = x[1], x2 = x[2], x3 = x[3], x4 = x[4], x5 = x[5], x6 = x[6], x7 = x[7];
#pragma omp simd
	for (size_t i = 0; i < n; i++)
		y[i] += ((a[i] * x0 + a[lda + i] * x1) + (a[2 * lda + i] * x2 + a[3 * lda + i] * x3)) +
		        ((b[i] * x4 + b[lda + i] * x5) + (b[2 * lda + i] * x6 + b[3 * lda + i] * x7));
}

OPTLA_CLONES static void add_2_columns(size_t n, const float *restrict a, size_t lda, const float *x, float *restrict y)
{
	const float x0 = x[0], x1 = x[1];
#pragma omp simd
	for (size_t i = 0; i < n; i++) y[i] += a[i] * x0 + a[lda + i] * x1;
}

OPTLA_CLONES static void add_column(size_t n, const float *restrict a, float x, float *restrict y)
{
#pragma omp simd
	for (size_t i = 0; i < n; i++) y[i] += a[i] * x;
}

/* Four columns of A into eight columns of y. */
OPTLA_CLONES static void add_4_columns_8(size_t n, const float *restrict a, size_t lda, const float *x, size_t ldx,
                                         float *restrict y, size_t ldy)
{
	float c[8][4];
	for (size_t r = 0; r < 8; r++)
		for (size_t j = 0; j < 4; j++) c[r][j] = x[r * ldx + j];
	float *restrict z = y + 4 * ldy;
#pragma omp simd
	for (size_t i = 0; i < n; i++) {
		const float p = a[i], q = a[lda + i], s = a[2 * lda + i], t = a[3 * lda + i];
		y[i] += (p * c[0][0] + q * c[0][1]) + (s * c[0][2] + t * c[0][3]);
		y[ldy + i] += (p * c[1][0] + q * c[1][1]) + (s * c[1][2] + t * c[1][3]);
		y[2 * ldy + i] += (p * c[2][0] + q * c[2][1]) + (s * c[2][2] + t * c[2][3]);
		y[3 * ldy + i] += (p * c[3][0] + q * c[3][1]) + (s * c[3][2] + t * c[3][3]);
		z[i] += (p * c[4][0] + q * c[4][1]) + (s * c[4][2] + t * c[4][3]);
		z[ldy + i] += (p * c[5][0] + q * c[5][1]) + (s * c[5][2] + t * c[5][3]);
		z[2 * ldy + i] += (p * c[6][0] + q * c[6][1]) + (s * c[6][2] + t * c[6][3]);
		z[3 * ldy + i] += (p * c[7][0] + q * c[7][1]) + (s * c[7][2] + t * c[7][3]);
	}
}

static void add_one(optla_tile t, const float *x, float *y)
{
	const float *a = t.a;
	size_t j = 0;
	for (; j + 8 <= t.cols; j += 8) add_8_columns(t.rows, a + j * t.lda, t.lda, x + j, y);
	for (; j + 2 <= t.cols; j += 2) add_2_columns(t.rows, a + j * t.lda, t.lda, x + j, y);
	if (j < t.cols) add_column(t.rows, a + j * t.lda, x[j], y);
}

void optla_tile_forward_f32_(optla_tile t, void *y_, size_t ldy)
{
	const float *a = t.a, *x = t.x;
	float *y = y_;
	size_t r = 0;
	for (; r + 8 <= t.nrhs; r += 8) {
		size_t j = 0;
		for (; j + 4 <= t.cols; j += 4) add_4_columns_8(t.rows, a + j * t.lda, t.lda, x + r * t.ldx + j, t.ldx, y + r * ldy, ldy);
		for (; j < t.cols; j++)
			for (size_t k = r; k < r + 8; k++) add_column(t.rows, a + j * t.lda, x[k * t.ldx + j], y + k * ldy);
	}
	for (; r < t.nrhs; r++) add_one(t, x + r * t.ldx, y + r * ldy);
}

/* Rows that are summed in float before they join the sum in double: keeps the rounding of long columns away. */
enum { FLOAT_ROWS = 1024 };

OPTLA_CLONES static void dots_8_columns(size_t n, const float *restrict a, size_t lda, const float *restrict x, double *sums)
{
	const float *restrict b = a + 4 * lda;
	for (size_t first = 0; first < n; first += FLOAT_ROWS) {
		const size_t end = n - first < FLOAT_ROWS ? n : first + FLOAT_ROWS;
		float s0 = 0, s1 = 0, s2 = 0, s3 = 0, s4 = 0, s5 = 0, s6 = 0, s7 = 0;
#pragma omp simd reduction(+ : s0, s1, s2, s3, s4, s5, s6, s7)
		for (size_t i = first; i < end; i++) {
			const float v = x[i];
			s0 += a[i] * v;
			s1 += a[lda + i] * v;
			s2 += a[2 * lda + i] * v;
			s3 += a[3 * lda + i] * v;
			s4 += b[i] * v;
			s5 += b[lda + i] * v;
			s6 += b[2 * lda + i] * v;
			s7 += b[3 * lda + i] * v;
		}
		const float s[8] = {s0, s1, s2, s3, s4, s5, s6, s7};
		for (size_t j = 0; j < 8; j++) sums[j] += (double)s[j];
	}
}

OPTLA_CLONES static void dots_2_columns(size_t n, const float *restrict a, size_t lda, const float *restrict x, double *sums)
{
	for (size_t first = 0; first < n; first += FLOAT_ROWS) {
		const size_t end = n - first < FLOAT_ROWS ? n : first + FLOAT_ROWS;
		float s = 0, t = 0;
#pragma omp simd reduction(+ : s, t)
		for (size_t i = first; i < end; i++) {
			s += a[i] * x[i];
			t += a[lda + i] * x[i];
		}
		sums[0] += (double)s;
		sums[1] += (double)t;
	}
}

OPTLA_CLONES static void dot_column(size_t n, const float *restrict a, const float *restrict x, double *sum)
{
	for (size_t first = 0; first < n; first += FLOAT_ROWS) {
		const size_t end = n - first < FLOAT_ROWS ? n : first + FLOAT_ROWS;
		float s = 0;
#pragma omp simd reduction(+ : s)
		for (size_t i = first; i < end; i++) s += a[i] * x[i];
		*sum += (double)s;
	}
}

/* Four columns of A with four columns of x. */
OPTLA_CLONES static void dots_4_columns_4(size_t n, const float *restrict a, size_t lda, const float *restrict x, size_t ldx,
                                          double *sums, size_t lds)
{
	float s00 = 0, s01 = 0, s02 = 0, s03 = 0, s10 = 0, s11 = 0, s12 = 0, s13 = 0;
	float s20 = 0, s21 = 0, s22 = 0, s23 = 0, s30 = 0, s31 = 0, s32 = 0, s33 = 0;
#pragma omp simd reduction(+ : s00, s01, s02, s03, s10, s11, s12, s13, s20, s21, s22, s23, s30, s31, s32, s33)
	for (size_t i = 0; i < n; i++) {
		const float p = a[i], q = a[lda + i], u = a[2 * lda + i], v = a[3 * lda + i];
		const float x0 = x[i], x1 = x[ldx + i], x2 = x[2 * ldx + i], x3 = x[3 * ldx + i];
		s00 += p * x0, s01 += q * x0, s02 += u * x0, s03 += v * x0;
		s10 += p * x1, s11 += q * x1, s12 += u * x1, s13 += v * x1;
		s20 += p * x2, s21 += q * x2, s22 += u * x2, s23 += v * x2;
		s30 += p * x3, s31 += q * x3, s32 += u * x3, s33 += v * x3;
	}
	const float s[4][4] = {{s00, s01, s02, s03}, {s10, s11, s12, s13}, {s20, s21, s22, s23}, {s30, s31, s32, s33}};
	for (size_t r = 0; r < 4; r++)
		for (size_t j = 0; j < 4; j++) sums[r * lds + j] += (double)s[r][j];
}

void optla_tile_dots_f32_(optla_tile t, bool conj, double *sums, size_t lds)
{
	(void)conj;
	const float *a = t.a, *x = t.x;
	size_t r = 0;
	for (; r + 4 <= t.nrhs; r += 4) {
		size_t j = 0;
		for (; j + 4 <= t.cols; j += 4)
			dots_4_columns_4(t.rows, a + j * t.lda, t.lda, x + r * t.ldx, t.ldx, sums + r * lds + j, lds);
		for (; j < t.cols; j++)
			for (size_t k = r; k < r + 4; k++) dot_column(t.rows, a + j * t.lda, x + k * t.ldx, sums + k * lds + j);
	}
	for (; r < t.nrhs; r++) {
		size_t j = 0;
		for (; j + 8 <= t.cols; j += 8) dots_8_columns(t.rows, a + j * t.lda, t.lda, x + r * t.ldx, sums + r * lds + j);
		for (; j + 2 <= t.cols; j += 2) dots_2_columns(t.rows, a + j * t.lda, t.lda, x + r * t.ldx, sums + r * lds + j);
		if (j < t.cols) dot_column(t.rows, a + j * t.lda, x + r * t.ldx, sums + r * lds + j);
	}
}
