/* SPDX-License-Identifier: BSD-3-Clause */
/* Products of operators against the memory's read bandwidth and cblas_sgemm, one JSON line per case.
   The references run in turn with the products, so that a busy machine slows down both. usage: bench_operator [THREADS [REPEATS]] */
#include "optla/optla.h"

#include <cblas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
#define CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define CLONES
#endif

enum { MAX_REPEATS = 101 };

typedef struct {
	optla_ctx *ctx;
	int threads, repeats;
} bench;

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int by_value(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Sorts t: its best is t[0] afterwards. */
static double median(double *t, int n)
{
	qsort(t, (size_t)n, sizeof *t, by_value);
	return t[n / 2];
}

static void must(optla_status status)
{
	if (status == OPTLA_OK) return;
	fprintf(stderr, "bench_operator: %s\n", optla_status_name(status));
	exit(1);
}

static void *must_have(size_t bytes)
{
	void *p = aligned_alloc(64, (bytes + 63) / 64 * 64);
	if (!p) {
		fprintf(stderr, "bench_operator: no memory for %zu bytes\n", bytes);
		exit(1);
	}
	return p;
}

/* The plainest way to read n doubles once: four sums side by side. */
CLONES static double sum_of(const double *a, size_t n)
{
	double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
	const size_t q = n / 4;
#pragma omp simd reduction(+ : s0, s1, s2, s3)
	for (size_t i = 0; i < q; i++) {
		s0 += a[i];
		s1 += a[q + i];
		s2 += a[2 * q + i];
		s3 += a[3 * q + i];
	}
	return s0 + s1 + s2 + s3;
}

static double read_all(const void *data, size_t bytes, int threads)
{
	const double *a = data;
	const size_t n = bytes / sizeof *a, share = n / (size_t)threads;
	double total = 0;
#pragma omp parallel for num_threads(threads) reduction(+ : total) schedule(static)
	for (int k = 0; k < threads; k++) total += sum_of(a + (size_t)k * share, share);
	return total;
}

static optla_block random_f32(size_t m, size_t n)
{
	float *p = must_have(m * n * sizeof *p);
	uint32_t state = 1;
	for (size_t k = 0; k < m * n; k++) {
		state = state * 1664525u + 1013904223u;
		p[k] = (float)(state >> 8) * 0x1p-24f;
	}
	const optla_block b = {p, m, n, m, OPTLA_F32};
	return b;
}

/* One direction of a dense operator; with one column the read-sum of the same matrix is the reference, else sgemm. */
static void bench_dense(const bench *b, size_t m, size_t n, size_t nrhs, optla_trans trans)
{
	const optla_block a = random_f32(m, n), x = random_f32(trans == OPTLA_FORWARD ? n : m, nrhs);
	const optla_block y = random_f32(trans == OPTLA_FORWARD ? m : n, nrhs);
	float *z = must_have(y.nrows * nrhs * sizeof *z);
	double op_s[MAX_REPEATS], reference_s[MAX_REPEATS], sink = 0, worst = 0;
	const size_t bytes = m * n * sizeof(float);
	optla_op *op;
	must(optla_op_dense(b->ctx, optla_block_const(a), false, &op));
	for (int r = 0; r < b->repeats; r++) {
		double t = now_s();
		must(optla_op_apply(op, trans, optla_block_const(x), y));
		op_s[r] = now_s() - t;
		t = now_s();
		if (nrhs > 1)
			cblas_sgemm(CblasColMajor, trans == OPTLA_FORWARD ? CblasNoTrans : CblasTrans, CblasNoTrans, (int)y.nrows, (int)nrhs,
			            (int)x.nrows, 1, a.data, (int)m, x.data, (int)x.nrows, 0, z, (int)y.nrows);
		else
			sink += read_all(a.data, bytes, b->threads);
		reference_s[r] = now_s() - t;
	}
	for (size_t i = 0; nrhs > 1 && i < y.nrows * nrhs; i++)
		worst = fmax(worst, fabs((double)((const float *)y.data)[i] - (double)z[i]) / fmax(fabs((double)z[i]), 1e-30));
	const double t = median(op_s, b->repeats), reference = median(reference_s, b->repeats);
	printf("{\"case\": \"dense_f32\", \"nrows\": %zu, \"ncols\": %zu, \"columns\": %zu, \"direction\": \"%s\", \"threads\": %d, "
	       "\"seconds\": %.6f, \"GBps\": %.2f, \"gflops\": %.1f, \"reference\": \"%s\", \"reference_s\": %.6f, "
	       "\"speed_over_reference\": %.3f, \"best_over_best\": %.3f, \"worst_relative_difference\": %.2g, \"sink\": %d}\n",
	       m, n, nrhs, trans == OPTLA_FORWARD ? "forward" : "transpose", b->threads, t, (double)bytes / t / 1e9,
	       2 * (double)(m * n * nrhs) / t / 1e9, nrhs > 1 ? "cblas_sgemm" : "read_sum", reference, reference / t,
	       reference_s[0] / op_s[0], worst, sink > 0);
	fflush(stdout);
	optla_op_unref(&op);
	free(a.data);
	free(x.data);
	free(y.data);
	free(z);
}

static void bench_sparse(const bench *b, size_t n, size_t per_row, optla_trans trans)
{
	const size_t count = n * per_row, bytes = count * (sizeof(float) + sizeof(uint32_t));
	uint64_t *start = must_have((n + 1) * sizeof *start);
	uint32_t *column = must_have(count * sizeof *column);
	const optla_block values = random_f32(count, 1), x = random_f32(n, 1), y = random_f32(n, 1);
	double op_s[MAX_REPEATS], read_s[MAX_REPEATS], sink = 0;
	optla_op *op;
	/* neighbours of the diagonal, as light that scatters close by */
	for (size_t i = 0; i <= n; i++) start[i] = i * per_row;
	for (size_t i = 0; i < n; i++) {
		const size_t first = i < per_row ? 0 : i - per_row;
		for (size_t k = 0; k < per_row; k++) column[i * per_row + k] = (uint32_t)(first + k);
	}
	must(optla_op_sparse(b->ctx, n, n, start, column, optla_block_const(values), &op));
	for (int r = 0; r < b->repeats; r++) {
		double t = now_s();
		must(optla_op_apply(op, trans, optla_block_const(x), y));
		op_s[r] = now_s() - t;
		t = now_s();
		sink += read_all(values.data, count * sizeof(float), b->threads) + read_all(column, count * sizeof *column, b->threads);
		read_s[r] = now_s() - t;
	}
	const double t = median(op_s, b->repeats), reference = median(read_s, b->repeats);
	printf("{\"case\": \"sparse_f32\", \"nrows\": %zu, \"nonzeros\": %zu, \"direction\": \"%s\", \"threads\": %d, \"seconds\": "
	       "%.6f, "
	       "\"GBps\": %.2f, \"reference\": \"read_sum\", \"reference_s\": %.6f, \"speed_over_reference\": %.3f, "
	       "\"best_over_best\": %.3f, \"sink\": %d}\n",
	       n, count, trans == OPTLA_FORWARD ? "forward" : "transpose", b->threads, t, (double)bytes / t / 1e9, reference,
	       reference / t, read_s[0] / op_s[0], sink > 0);
	fflush(stdout);
	optla_op_unref(&op);
	free(start);
	free(column);
	free(values.data);
	free(x.data);
	free(y.data);
}

int main(int argc, char **argv)
{
	bench b = {.threads = argc > 1 ? atoi(argv[1]) : 2, .repeats = argc > 2 ? atoi(argv[2]) : 15};
	if (b.threads < 1 || b.repeats < 1 || b.repeats > MAX_REPEATS) {
		fprintf(stderr, "usage: bench_operator [THREADS [REPEATS]], repeats 1 to %d\n", MAX_REPEATS);
		return 2;
	}
	const optla_ctx_desc desc = {.size = sizeof desc, .threads = b.threads};
	must(optla_ctx_create(&b.ctx, &desc));
	for (int t = OPTLA_FORWARD; t <= OPTLA_TRANSPOSE; t++) {
		bench_dense(&b, 84708, 1024, 1, (optla_trans)t);
		bench_dense(&b, 2332800, 10, 1, (optla_trans)t);
		bench_dense(&b, 2332800, 50, 1, (optla_trans)t);
		bench_dense(&b, 84708, 1024, 32, (optla_trans)t);
		bench_dense(&b, 84708, 1024, 64, (optla_trans)t);
		bench_sparse(&b, 1 << 20, 40, (optla_trans)t);
	}
	optla_ctx_destroy(&b.ctx);
	return 0;
}
