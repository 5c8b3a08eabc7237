/* SPDX-License-Identifier: BSD-3-Clause */
/* Relighting 1080 x 720 RGB from K photos (Eq. 2.7) against reading what it must read (photos and illuminations) and NumPy with
   OpenBLAS, one JSON line for each K. Reading, relighting and NumPy take turns, so that a busy machine slows down all of them.
   usage: bench_relight [THREADS [ROUNDS]] */
#include "optla/optla.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
#define CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define CLONES
#endif

enum {
	WIDTH = 1080,
	HEIGHT = 720,
	CHANNELS = 3,
	PIXELS = WIDTH * HEIGHT,
	SAMPLES = PIXELS * CHANNELS,
	LIGHTS = 100000,
	MAX_ROUNDS = 201
};

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

static double median(double *t, int n)
{
	qsort(t, (size_t)n, sizeof *t, by_value);
	return t[n / 2];
}

static void die(const char *what)
{
	fprintf(stderr, "bench_relight: %s\n", what);
	exit(1);
}

static void *must_have(size_t count, size_t size)
{
	void *p = aligned_alloc(4096, (count * size + 4095) / 4096 * 4096);
	if (!p) die("no memory");
	return p;
}

/* ---- reading alone ---- */

/* Streams side by side: 1 or 4. The sum isn't wanted, reading is. */
CLONES static float sum_streams(const float *a, size_t n, size_t streams)
{
	float s[64] = {0}, sum = 0;
	const size_t part = n / streams / 16 * 16;
	for (size_t i = 0; i < part; i += 16)
		for (size_t q = 0; q < streams; q++)
			for (size_t j = 0; j < 16; j++) s[q * 16 + j] += a[q * part + i + j];
	for (size_t j = 0; j < 64; j++) sum += s[j];
	return sum;
}

CLONES static float sum_one(const float *a, size_t n)
{
	float s[64] = {0}, sum = 0;
	for (size_t i = 0; i + 64 <= n; i += 64)
		for (size_t j = 0; j < 64; j++) s[j] += a[i + j];
	for (size_t j = 0; j < 64; j++) sum += s[j];
	return sum;
}

/* Seconds to read all of an array once: way 0 one stream for each thread, way 1 four. */
static double read_all(const float *d, size_t n, int threads, int way, volatile float *sink)
{
	const double start = now_s();
	float total = 0;
	const size_t share = n / (size_t)threads;
#pragma omp parallel for num_threads(threads) schedule(static) reduction(+ : total)
	for (int t = 0; t < threads; t++)
		total += way ? sum_streams(d + (size_t)t * share, share, 4) : sum_one(d + (size_t)t * share, share);
	*sink = total;
	return now_s() - start;
}

/* ---- NumPy as a second process that works when it is told to ---- */

typedef struct {
	FILE *to, *from;
	char version[32];
} numpy;

static numpy numpy_start(size_t photos)
{
	numpy n = {0};
	int down[2], up[2];
	char samples[32], lights[32], count[32];
	snprintf(samples, sizeof samples, "%d", (int)SAMPLES);
	snprintf(lights, sizeof lights, "%d", (int)LIGHTS);
	snprintf(count, sizeof count, "%zu", photos);
	if (pipe(down) || pipe(up)) die("no pipe");
	fflush(NULL);
	const pid_t child = fork();
	if (child < 0) die("no second process");
	if (!child) {
		dup2(down[0], 0);
		dup2(up[1], 1);
		close(down[1]);
		close(up[0]);
		execl("/usr/bin/python3", "python3", OPTLA_SOURCE_ROOT "/bench/relight_numpy.py", samples, lights, count, (char *)NULL);
		_exit(127);
	}
	close(down[0]);
	close(up[1]);
	n.to = fdopen(down[1], "w");
	n.from = fdopen(up[0], "r");
	if (!n.to || !n.from || 1 != fscanf(n.from, "numpy %31s", n.version)) n.version[0] = 0; /* no Python, no NumPy */
	return n;
}

/* Both ways of keeping D, the faster one at the end. */
static void numpy_once(numpy *n, double *by_photo, double *by_pixel)
{
	if (fputs("go\n", n->to) < 0 || fflush(n->to) || 2 != fscanf(n->from, "%lf %lf", by_photo, by_pixel))
		die("NumPy has stopped");
}

/* ---- one case ---- */

static optla_model make_model(optla_ctx *ctx, size_t rank)
{
	optla_model m = {
	    .ctx = ctx, .width = WIDTH, .height = HEIGHT, .channels = CHANNELS, .npixels = PIXELS, .nlights = LIGHTS, .rank = rank};
	m.photos = must_have((size_t)SAMPLES * rank, sizeof *m.photos);
	m.illuminations = must_have((size_t)LIGHTS * rank, sizeof *m.illuminations);
	for (size_t k = 0; k < SAMPLES * rank; k++) m.photos[k] = (float)(k * 2654435761U % 1000) / 1000;
	for (size_t k = 0; k < LIGHTS * rank; k++) m.illuminations[k] = (float)(k * 40503U % 1000) / 1000;
	return m;
}

static void run(optla_ctx *ctx, size_t rank, int threads, int rounds)
{
	optla_model m = make_model(ctx, rank);
	float *p = must_have(LIGHTS, sizeof *p), *i = must_have(SAMPLES, sizeof *i);
	volatile float sink = 0;
	double ours[MAX_ROUNDS], read[2][MAX_ROUNDS], rival[2][MAX_ROUNDS];
	for (size_t n = 0; n < LIGHTS; n++) p[n] = (float)(n % 7);
	numpy n = numpy_start(rank);
	for (int r = -2; r < rounds; r++) { /* two rounds to warm up */
		const int k = r < 0 ? 0 : r;
		for (int way = 0; way < 2; way++)
			read[way][k] = read_all(m.photos, SAMPLES * rank, threads, way, &sink) +
			               read_all(m.illuminations, LIGHTS * rank, threads, way, &sink);
		const double start = now_s();
		if (optla_relight(&m, p, 1, i)) die(optla_ctx_last_error(ctx));
		ours[k] = now_s() - start;
		if (n.version[0]) numpy_once(&n, &rival[0][k], &rival[1][k]);
	}
	const double a = median(read[0], rounds), b = median(read[1], rounds), bound = a < b ? a : b, mine = median(ours, rounds);
	printf("{\"case\": \"relight %dx%d RGB\", \"photos\": %zu, \"lights\": %d, \"threads\": %d, \"seconds\": %.5g, \"gb_per_s\": "
	       "%.4g, "
	       "\"reference\": \"read_sum\", \"reference_s\": %.5g, \"speed_over_reference\": %.4g",
	       WIDTH, HEIGHT, rank, LIGHTS, threads, mine, 4e-9 * (double)(SAMPLES + LIGHTS) * (double)rank / mine, bound,
	       bound / mine);
	if (n.version[0]) {
		const double photo = median(rival[0], rounds), pixel = median(rival[1], rounds), best = fmin(photo, pixel);
		printf(", \"numpy\": \"%s\", \"numpy_photo_major_s\": %.5g, \"numpy_pixel_major_s\": %.5g, \"speed_over_numpy\": %.4g, "
		       "\"numpy_best_s\": %.5g",
		       n.version, photo, pixel, best / mine, fmin(rival[0][0], rival[1][0]));
	}
	/* the times are sorted now: the fastest rounds, which a busy machine disturbs least */
	printf(", \"best_s\": %.5g, \"reference_best_s\": %.5g", ours[0], fmin(read[0][0], read[1][0]));
	printf("}\n");
	fclose(n.to);
	fclose(n.from);
	free(m.photos);
	free(m.illuminations);
	free(p);
	free(i);
}

int main(int argc, char **argv)
{
	const int threads = argc > 1 ? atoi(argv[1]) : 2, rounds = argc > 2 ? atoi(argv[2]) : 25;
	if (threads < 1 || rounds < 1 || rounds > MAX_ROUNDS) die("usage: bench_relight [THREADS [ROUNDS]], rounds 1 to 201");
	char count[16];
	snprintf(count, sizeof count, "%d", threads);
	setenv("OPENBLAS_NUM_THREADS", count, 1);
	optla_ctx *ctx;
	const optla_ctx_desc d = {.size = sizeof d, .threads = threads};
	if (optla_ctx_create(&ctx, &d)) die("no context");
	run(ctx, 10, threads, rounds);
	run(ctx, 50, threads, rounds);
	optla_ctx_destroy(&ctx);
	return 0;
}
