/* SPDX-License-Identifier: BSD-3-Clause */
/* Capturing a transport of 84 708 x 1024 with few products: ours beside SciPy's PROPACK on the same matrix, in turn.
   T = U diag(1/k) Vᵀ with U of cosines and V of Walsh functions with random signs, so that every singular value is known.
   usage: bench_krylov [THREADS [REPEATS]] */
#include "optla/optla.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { NROWS = 84708, NCOLS = 1024, MAX_REPEATS = 15 };

static void must(optla_status status)
{
	if (status == OPTLA_OK) return;
	fprintf(stderr, "bench_krylov: %s\n", optla_status_name(status));
	exit(1);
}

static int by_value(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double median(double *t, int n)
{
	qsort(t, (size_t)n, sizeof *t, by_value);
	return t[n / 2];
}

/* Walsh-Hadamard transform in place. */
static void hadamard(float *x, size_t n)
{
	for (size_t half = 1; half < n; half *= 2)
		for (size_t i = 0; i < n; i += 2 * half)
			for (size_t j = i; j < i + half; j++) {
				const float a = x[j], b = x[j + half];
				x[j] = a + b;
				x[j + half] = a - b;
			}
}

/* Row i of T is the transform of s_k u_ik, times the signs. */
static void fill(float *t)
{
	float sign[NCOLS];
	uint32_t state = 1;
	for (size_t n = 0; n < NCOLS; n++) {
		state = state * 1664525u + 1013904223u;
		sign[n] = (state >> 31 ? -1.0f : 1.0f) / sqrtf(NCOLS);
	}
#pragma omp parallel for schedule(static)
	for (size_t i = 0; i < NROWS; i++) {
		float row[NCOLS];
		for (size_t k = 0; k < NCOLS; k++) /* 79 k + 1 < NROWS: distinct cosines, orthonormal over the rows */
			row[k] = (float)(sqrt(2.0 / NROWS) * cos(3.14159265358979323846 * ((double)i + 0.5) * (double)(79 * k + 1) / NROWS) /
			                 (double)(k + 1));
		hadamard(row, NCOLS);
		for (size_t n = 0; n < NCOLS; n++) t[i + n * NROWS] = row[n] * sign[n];
	}
}

static double optimum(size_t rank)
{
	double tail = 0, all = 0;
	for (size_t k = NCOLS; k > 0; k--) {
		all += 1.0 / (double)(k * k);
		if (k > rank) tail += 1.0 / (double)(k * k);
	}
	return sqrt(tail / all);
}

/* ||T - D Pᵀ|| / ||T||, entry by entry. */
static double error_of(const optla_krylov *run, const float *t)
{
	optla_cblock d, p;
	must(optla_krylov_bases(run, &d, &p, NULL));
	double left[NCOLS], all[NCOLS], sum = 0, norm = 0;
#pragma omp parallel for schedule(dynamic, 8)
	for (size_t n = 0; n < NCOLS; n++) {
		left[n] = all[n] = 0;
		for (size_t first = 0; first < NROWS; first += 2048) {
			const size_t m = NROWS - first < 2048 ? NROWS - first : 2048;
			float y[2048];
			memcpy(y, t + first + n * NROWS, m * sizeof *y);
			for (size_t i = 0; i < m; i++) all[n] += (double)y[i] * y[i];
			for (size_t k = 0; k < d.ncols; k++) {
				const float c = ((const float *)p.data)[n + k * p.ld], *column = (const float *)d.data + first + k * d.ld;
				for (size_t i = 0; i < m; i++) y[i] -= c * column[i];
			}
			for (size_t i = 0; i < m; i++) left[n] += (double)y[i] * y[i];
		}
	}
	for (size_t n = 0; n < NCOLS; n++) {
		sum += left[n];
		norm += all[n];
	}
	return sqrt(sum / norm);
}

typedef struct {
	double seconds, outside, error;
	uint64_t products;
} outcome;

static outcome capture(optla_ctx *ctx, const float *t, int iterations, int rank, bool judge)
{
	optla_op *op;
	optla_krylov *run;
	const optla_cblock block = {t, NROWS, NCOLS, NROWS, OPTLA_F32};
	must(optla_op_dense(ctx, block, false, &op));
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = iterations;
	o.rank = rank;
	const optla_krylov_problem problem = {.size = sizeof problem, .op = op};
	must(optla_krylov_create(&problem, OPTLA_KRYLOV_ARNOLDI, &o, &run));
	must(optla_krylov_run(run));
	const optla_krylov_info info = optla_krylov_get_info(run);
	const outcome r = {info.seconds_total, 1 - info.seconds_operator / info.seconds_total, judge ? error_of(run, t) : 0,
	                   info.photos};
	optla_krylov_destroy(&run);
	optla_op_unref(&op);
	return r;
}

typedef struct {
	bool there;
	double seconds, error;
	int products;
	char version[64];
} reference;

/* One run of SciPy's svds on the same file; its clock runs inside Python, around the call alone. */
static reference propack(const char *path, int rank, double tolerance)
{
	reference r = {0};
	char command[512], line[512];
	snprintf(command, sizeof command, "/usr/bin/python3 '%s/bench/propack.py' '%s' %d %g 2>/dev/null", OPTLA_SOURCE_ROOT, path,
	         rank, tolerance);
	FILE *f = popen(command, "r");
	while (f && fgets(line, sizeof line, f))
		if (4 == sscanf(line, "propack %lf %lf %d %63s", &r.seconds, &r.error, &r.products, r.version)) r.there = true;
	if (f) pclose(f);
	return r;
}

static void save(const float *t, const char *path)
{
	FILE *f = fopen(path, "wb");
	char header[128];
	memset(header, ' ', sizeof header);
	memcpy(header, "\x93NUMPY\x01\x00\x76\x00", 10);
	const int n = snprintf(header + 10, 117, "{'descr': '<f4', 'fortran_order': True, 'shape': (%d, %d), }", NROWS, NCOLS);
	header[10 + n] = ' ';
	header[127] = '\n';
	if (!f || fwrite(header, 1, 128, f) != 128 || fwrite(t, sizeof *t, (size_t)NROWS * NCOLS, f) != (size_t)NROWS * NCOLS ||
	    fclose(f)) {
		fprintf(stderr, "bench_krylov: can't write %s\n", path);
		exit(1);
	}
}

static void one_case(optla_ctx *ctx, const float *t, const char *path, const char *name, int iterations, int rank,
                     double tolerance, int repeats)
{
	double ours[MAX_REPEATS], theirs[MAX_REPEATS], outside[MAX_REPEATS];
	outcome o = {0};
	reference r = {0};
	for (int k = 0; k < repeats; k++) { /* A B A B */
		o = capture(ctx, t, iterations, rank < iterations ? rank : 0, k == repeats - 1);
		ours[k] = o.seconds;
		outside[k] = o.outside;
		r = propack(path, rank, tolerance);
		theirs[k] = r.seconds;
	}
	const double a = median(ours, repeats), b = median(theirs, repeats);
	printf(
	    "{\"case\": \"%s\", \"threads\": %d, \"seconds\": %.4f, \"outside_operator\": %.4f, \"products\": %llu, \"error\": %.5f, "
	    "\"error_over_optimum\": %.4f",
	    name, optla_ctx_threads(ctx), a, median(outside, repeats), (unsigned long long)o.products, o.error,
	    o.error / optimum((size_t)rank));
	if (r.there)
		printf(", \"reference\": \"SciPy %s svds(propack, tol=%g)\", \"reference_s\": %.4f, \"reference_products\": %d, "
		       "\"reference_error_over_optimum\": %.4f, \"speed_over_reference\": %.3f, \"products_over_reference\": %.3f",
		       r.version, tolerance, b, r.products, r.error / optimum((size_t)rank), b / a, (double)o.products / r.products);
	printf("}\n");
	fflush(stdout);
}

int main(int argc, char **argv)
{
	const int threads = argc > 1 ? atoi(argv[1]) : 0, repeats = argc > 2 ? atoi(argv[2]) : 3;
	const optla_ctx_desc desc = {.size = sizeof desc, .threads = threads};
	optla_ctx *ctx;
	must(optla_ctx_create(&ctx, &desc));
	float *t = malloc((size_t)NROWS * NCOLS * sizeof *t);
	char path[] = "/tmp/optla_bench_krylov_XXXXXX.npy";
	const int file = mkstemps(path, 4);
	if (!t || file < 0 || repeats < 1 || repeats > MAX_REPEATS) return 1;
	close(file);
	fill(t);
	save(t, path);
	one_case(ctx, t, path, "rank 50 within 1.13", 52, 50, 0.1, repeats);
	one_case(ctx, t, path, "rank 10 within 1.01", 16, 10, 0.1, repeats);
	one_case(ctx, t, path, "rank 50 within 1.01", 75, 50, 0.1, repeats);
	unlink(path);
	free(t);
	optla_ctx_destroy(&ctx);
	return 0;
}
