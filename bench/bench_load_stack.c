/* SPDX-License-Identifier: BSD-3-Clause */
/* Loading a stack of photos with one thread and with several, in turn, one JSON line per format. The photos are made for the run:
   a smooth picture with photon noise, as real ones compress. usage: bench_load_stack [THREADS [REPEATS]] */
#include "optla/optla.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { COUNT = 96, WIDTH = 612, HEIGHT = 512, CHANNELS = 3, MAX_REPEATS = 101 };

typedef struct {
	char dir[64], paths[COUNT][96];
	const char *list[COUNT];
	double file_bytes;
} stack;

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void must(optla_ctx *ctx, optla_status status)
{
	if (OPTLA_OK == status) return;
	fprintf(stderr, "bench_load_stack: %s\n", optla_ctx_last_error(ctx));
	exit(1);
}

static optla_ctx *context(int threads)
{
	optla_ctx *ctx = NULL;
	const optla_ctx_desc d = {.size = sizeof d, .threads = threads};
	if (OPTLA_OK != optla_ctx_create(&ctx, &d)) exit(1);
	return ctx;
}

/* Counts up to 16 bits with noise of about their square root. */
static void draw(optla_image *m, unsigned seed)
{
	uint32_t v = seed * 2654435761u + 1;
	for (size_t y = 0; y < HEIGHT; y++)
		for (size_t x = 0; x < WIDTH; x++)
			for (size_t c = 0; c < CHANNELS; c++) {
				const double mean = 20000 * (1.2 + sin(0.01 * (double)(x + seed)) * cos(0.013 * (double)y + (double)c));
				v = v * 1664525u + 1013904223u;
				const double noise = ((double)(v >> 8) * 0x1p-24 - 0.5) * 3.46 * sqrt(mean); /* standard deviation sqrt(mean) */
				m->data[(y * WIDTH + x) * CHANNELS + c] = (float)floor(fmax(0, mean + noise));
			}
}

static void make_stack(stack *s, const char *ending, optla_image_kind kind)
{
	optla_ctx *ctx = context(0);
	optla_image *m = NULL;
	snprintf(s->dir, sizeof s->dir, "/tmp/optla-bench-XXXXXX");
	if (!mkdtemp(s->dir)) exit(1);
	must(ctx, optla_image_create(ctx, WIDTH, HEIGHT, CHANNELS, kind, &m));
	if (OPTLA_IMAGE_RAW_DN == kind) optla_image_set_kind(m, kind, 65535);
	s->file_bytes = 0;
	for (int k = 0; k < COUNT; k++) {
		draw(m, (unsigned)k);
		snprintf(s->paths[k], sizeof s->paths[k], "%s/%02d%s", s->dir, k, ending);
		s->list[k] = s->paths[k];
		must(ctx, optla_image_save(m, s->paths[k]));
		FILE *f = fopen(s->paths[k], "rb");
		if (f && !fseek(f, 0, SEEK_END)) s->file_bytes += (double)ftell(f);
		if (f) fclose(f);
	}
	optla_image_destroy(&m);
	optla_ctx_destroy(&ctx);
}

static double load_s(const stack *s, int threads)
{
	static optla_image *images[COUNT];
	optla_ctx *ctx = context(threads);
	const double start = now_s();
	must(ctx, optla_image_load_stack(ctx, s->list, COUNT, images));
	const double seconds = now_s() - start;
	for (int k = 0; k < COUNT; k++) optla_image_destroy(&images[k]);
	optla_ctx_destroy(&ctx);
	return seconds;
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

static void run(const char *format, const char *ending, optla_image_kind kind, int threads, int repeats)
{
	static stack s;
	double one[MAX_REPEATS], many[MAX_REPEATS], ratio[MAX_REPEATS];
	make_stack(&s, ending, kind);
	load_s(&s, threads); /* the files come from the page cache from here on */
	for (int k = 0; k < repeats; k++) {
		one[k] = load_s(&s, 1);
		many[k] = load_s(&s, threads);
		ratio[k] = one[k] / many[k];
	}
	const double seconds = median(many, repeats), sample_mb = 1e-6 * COUNT * WIDTH * HEIGHT * CHANNELS * sizeof(float);
	printf("{\"case\": \"load_stack_%s\", \"photos\": %d, \"width\": %d, \"height\": %d, \"channels\": %d, \"threads\": %d, "
	       "\"seconds\": %.4f, \"reference\": \"one thread\", \"reference_s\": %.4f, \"speed_over_reference\": %.3f, "
	       "\"file_mb_s\": %.1f, \"sample_mb_s\": %.1f, \"repeats\": %d}\n",
	       format, COUNT, WIDTH, HEIGHT, CHANNELS, threads, seconds, median(one, repeats), median(ratio, repeats),
	       1e-6 * s.file_bytes / seconds, sample_mb / seconds, repeats);
	fflush(stdout);
	for (int k = 0; k < COUNT; k++) unlink(s.paths[k]);
	rmdir(s.dir);
}

int main(int argc, char **argv)
{
	const int threads = argc > 1 ? atoi(argv[1]) : 2, repeats = argc > 2 ? atoi(argv[2]) : 5;
	if (threads < 1 || repeats < 1 || repeats > MAX_REPEATS) {
		fprintf(stderr, "usage: bench_load_stack [THREADS [REPEATS]]\n");
		return 2;
	}
	run("png", ".png", OPTLA_IMAGE_RAW_DN, threads, repeats);
	run("exr", ".exr", OPTLA_IMAGE_LINEAR, threads, repeats);
	return 0;
}
