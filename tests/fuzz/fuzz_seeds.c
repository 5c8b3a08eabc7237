/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes a small corpus for each fuzz target with Optla's own writers: fuzz_seeds DIR makes DIR/fuzz_png/..., DIR/fuzz_npy/... */
#include "io/h5.h"
#include "io/whole_file.h"
#include "krylov_problem.h"
#include "optla/image.h"
#include "optla/relight.h"

#include <stdlib.h>
#include <string.h>

static const char *top;

/* Path of a seed, its folder made. */
static char *seed(optla_ctx *ctx, const char *target, const char *name)
{
	char *folder = optla_format_(ctx, "%s/%s", top, target), *path = optla_format_(ctx, "%s/%s/%s", top, target, name);
	if (!folder || !path || OPTLA_OK != optla_make_dirs_(ctx, folder)) exit(EXIT_FAILURE);
	optla_free(ctx, folder);
	return path;
}

static void must(optla_ctx *ctx, optla_status status)
{
	if (OPTLA_OK == status) return;
	fprintf(stderr, "fuzz_seeds: %s\n", optla_ctx_last_error(ctx));
	exit(EXIT_FAILURE);
}

static void write_bytes(optla_ctx *ctx, const char *target, const char *name, const void *bytes, size_t count)
{
	char *path = seed(ctx, target, name);
	must(ctx, optla_write_file_(ctx, path, bytes, count));
	optla_free(ctx, path);
}

/* ---- YAML ---- */

static void yaml_seeds(optla_ctx *ctx)
{
	static const char *const texts[] = {
	    "name: ball\nexposure_s: 0.0125\nphotos: &p [a.png, b.png]\nagain: *p\nlights:\n  - {file: a.png, light: [1, 0]}\n",
	    "- 1e-3\n- .inf\n- true\n- ~\n- \"q\\u00e9\\n\"\n- |\n  block\n  text\n- >\n  folded\n",
	    "%YAML 1.1\n---\n? complex\n: [[[1]]]\n...\n",
	    "exposre_s: 1 # a slip\n'quoted key': !!str 12\n",
	};
	for (size_t k = 0; k < sizeof texts / sizeof *texts; k++)
		write_bytes(ctx, "fuzz_yaml", (const char[]){(char)('a' + k), 0}, texts[k], strlen(texts[k]));
}

/* ---- arrays ---- */

static void array_seeds(optla_ctx *ctx)
{
	static unsigned char data[6 * 16];
	for (size_t k = 0; k < sizeof data; k++) data[k] = (unsigned char)(k * 37 % 61);
	static const char *const names[] = {"f4", "f8", "c8", "c16"};
	for (optla_scalar type = OPTLA_F32; type <= OPTLA_C64; type++) {
		const optla_array a = {.ctx = ctx, .ndim = 2, .dims = {2, 3}, .type = type, .data = data};
		char name[32];
		snprintf(name, sizeof name, "%s.npy", names[type]);
		char *npy = seed(ctx, "fuzz_npy", name);
		snprintf(name, sizeof name, "%s.npz:%s", names[type], type % 2 ? "photos" : "x");
		char *npz = seed(ctx, "fuzz_npz", name);
		must(ctx, optla_array_save(&a, npy));
		must(ctx, optla_array_save(&a, npz));
		optla_free(ctx, npy);
		optla_free(ctx, npz);
	}
	static const char *const headers[] = {"{'descr': '>i2', 'fortran_order': True, 'shape': (2, 3), }\n",
	                                      "{'descr': '|b1', 'fortran_order': False, 'shape': (24,)}",
	                                      "{'descr': '<f2', 'fortran_order': True, 'shape': (2, 1, 2, 2)}",
	                                      "{'descr': '<u8', 'fortran_order': False, 'shape': ()}"};
	for (size_t k = 0; k < sizeof headers / sizeof *headers; k++) {
		unsigned char file[128] = "\x93NUMPY\x02";
		const size_t n = strlen(headers[k]);
		file[8] = (unsigned char)n;
		memcpy(file + 12, headers[k], n);
		memcpy(file + 12 + n, data, 24);
		write_bytes(ctx, "fuzz_npy", (const char[]){(char)('a' + k), 0}, file, 12 + n + 24);
	}
}

static void h5_seeds(optla_ctx *ctx)
{
	static const double data[8] = {1, -2, 3, 0.5};
	static const char *const names[] = {"f4", "f8", "c8", "c16"};
	for (optla_scalar type = OPTLA_F32; type <= OPTLA_C64; type++) {
		char *path = seed(ctx, "fuzz_h5", names[type]);
		optla_h5 *f;
		must(ctx, optla_h5_create_(ctx, path, "test", &f));
		must(ctx, optla_h5_put_(f, "photos", (optla_cblock){data, 2, 2, 2, type}, "J", "photos"));
		if (OPTLA_F64 == type) must(ctx, optla_h5_put_u32_(f, "list", (const uint32_t[]){1, 2}, 2, "a list"));
		must(ctx, optla_h5_finish_(&f, true));
		optla_free(ctx, path);
	}
}

static void model_seeds(optla_ctx *ctx)
{
	static const float photos[2 * 9 * 3] = {1, -2, 3, 0.5f}, illuminations[2 * 4] = {0.5f, 0.5f, 0.5f, 0.5f, 1};
	optla_rig *rig;
	must(ctx, optla_rig_corner(ctx, 3, 2, false, &rig));
	for (size_t channels = 1; channels <= 3; channels += 2) {
		const optla_cblock d = {photos, 9 * channels, 2, 9 * channels, OPTLA_F32}, p = {illuminations, 4, 2, 4, OPTLA_F32};
		optla_model *model;
		must(ctx, optla_model_create(rig, channels, d, p, &model));
		char *path = seed(ctx, "fuzz_model", 1 == channels ? "grey" : "colour");
		must(ctx, optla_model_save(model, path));
		optla_free(ctx, path);
		optla_model_destroy(&model);
	}
	optla_rig_destroy(&rig);
}

static void krylov_seeds(optla_ctx *ctx)
{
	static const char *const names[] = {"power", "arnoldi", "gmres", "svd"};
	double matrix[FUZZ_ROWS * FUZZ_COLUMNS], target[FUZZ_ROWS];
	optla_op *op = fuzz_op(ctx, matrix, target);
	const optla_krylov_problem problem = {.size = sizeof problem, .op = op, .target = target};
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = 2;
	for (int method = OPTLA_KRYLOV_POWER; method <= OPTLA_KRYLOV_SVD; method++) {
		optla_krylov *run;
		must(ctx, optla_krylov_create(&problem, (optla_krylov_method)method, &o, &run));
		must(ctx, optla_krylov_run(run));
		char *path = seed(ctx, "fuzz_krylov", names[method]);
		must(ctx, optla_krylov_save(run, path));
		optla_free(ctx, path);
		optla_krylov_destroy(&run);
	}
	optla_op_unref(&op);
}

static void number_seeds(optla_ctx *ctx)
{
	static const char text[] = "# x y z\n0.5, -1e-3 ;2\n\n+.25\t7 8 # end\r\n";
	write_bytes(ctx, "fuzz_numbers", "table", text, sizeof text - 1);
}

/* ---- images ---- */

static void image_seed(optla_ctx *ctx, const char *target, const char *name, size_t channels, optla_image_kind kind, double scale)
{
	optla_image *image;
	must(ctx, optla_image_create(ctx, 5, 4, channels, kind, &image));
	for (size_t k = 0; k < 20 * channels; k++) image->data[k] = (float)(scale * (double)(k * 37 % 61) / 61);
	char *path = seed(ctx, target, name);
	must(ctx, optla_image_save(image, path));
	optla_free(ctx, path);
	optla_image_destroy(&image);
}

static void image_seeds(optla_ctx *ctx)
{
	static const struct {
		const char *target, *ending;
	} formats[] = {{"fuzz_png", "png"}, {"fuzz_tiff", "tif"}, {"fuzz_exr", "exr"}, {"fuzz_pfm", "pfm"}};
	for (size_t f = 0; f < sizeof formats / sizeof *formats; f++)
		for (size_t channels = 1; channels <= 3; channels += 2)
			for (int kind = OPTLA_IMAGE_RAW_DN; kind <= OPTLA_IMAGE_DISPLAY; kind++) {
				if (OPTLA_IMAGE_LINEAR == kind ? 0 == f : f > 1)
					continue; /* PNG holds no LINEAR; one kind of EXR and PFM will do */
				char name[64];
				snprintf(name, sizeof name, "%s%zu.%s", optla_image_kind_name(kind), channels, formats[f].ending);
				for (char *c = name; *c; c++)
					if (' ' == *c || '/' == *c) *c = '_';
				image_seed(ctx, formats[f].target, name, channels, kind, OPTLA_IMAGE_RAW_DN == kind ? 4000 : 1);
			}
}

/* ---- camera RAW: the smallest DNG, since Optla writes none ---- */

typedef struct {
	unsigned char bytes[4096];
	size_t entries, extra; /* extra: where the next long value goes */
} dng;

static void put(unsigned char *to, size_t bytes, uint32_t value)
{
	for (size_t k = 0; k < bytes; k++) to[k] = (unsigned char)(value >> 8 * k);
}

/* One entry of the directory, little endian; values over 4 bytes go behind it. */
static void tag(dng *d, unsigned id, unsigned type, uint32_t count, const uint32_t *values)
{
	const size_t size = 4 == type ? 4 : 3 == type ? 2 : 10 == type ? 4 : 1, numbers = 10 == type ? 2 * count : count;
	unsigned char *entry = d->bytes + 10 + 12 * d->entries++, *to = entry + 8;
	put(entry, 2, id);
	put(entry + 2, 2, type);
	put(entry + 4, 4, count);
	if (size * numbers > 4) {
		put(entry + 8, 4, (uint32_t)d->extra);
		to = d->bytes + d->extra;
		d->extra += (size * numbers + 3) / 4 * 4;
	}
	for (size_t k = 0; k < numbers; k++) put(to + k * size, size, values[k]);
}

static void raw_seed(optla_ctx *ctx)
{
	enum { WIDTH = 32, HEIGHT = 24, BYTE = 1, ASCII = 2, SHORT = 3, LONG = 4, SRATIONAL = 10, DATA = 1024 };
	static dng d = {.extra = 512};
	memcpy(d.bytes, "II*\0\x08\0\0\0", 8);
#define TAG(id, type, count, ...) tag(&d, id, type, count, (const uint32_t[]){__VA_ARGS__})
	TAG(254, LONG, 1, 0);
	TAG(256, LONG, 1, WIDTH);
	TAG(257, LONG, 1, HEIGHT);
	TAG(258, SHORT, 1, 16);
	TAG(259, SHORT, 1, 1);
	TAG(262, SHORT, 1, 32803);
	TAG(271, ASCII, 6, 'O', 'p', 't', 'l', 'a', 0);
	TAG(272, ASCII, 5, 'T', 'e', 's', 't', 0);
	TAG(273, LONG, 1, DATA);
	TAG(277, SHORT, 1, 1);
	TAG(278, LONG, 1, HEIGHT);
	TAG(279, LONG, 1, WIDTH * HEIGHT * 2);
	TAG(33421, SHORT, 2, 2, 2);
	TAG(33422, BYTE, 4, 0, 1, 1, 2);
	TAG(50706, BYTE, 4, 1, 4, 0, 0);
	TAG(50708, ASCII, 11, 'O', 'p', 't', 'l', 'a', ' ', 'T', 'e', 's', 't', 0);
	TAG(50714, LONG, 1, 64);
	TAG(50717, LONG, 1, 4095);
	TAG(50721, SRATIONAL, 9, 1, 1, 0, 1, 0, 1, 0, 1, 1, 1, 0, 1, 0, 1, 0, 1, 1, 1);
#undef TAG
	put(d.bytes + 8, 2, (uint32_t)d.entries);
	for (uint32_t k = 0; k < WIDTH * HEIGHT; k++) put(d.bytes + DATA + 2 * k, 2, 64 + k * 37 % 3000);
	optla_image *image;
	must(ctx, optla_image_decode(ctx, d.bytes, DATA + 2 * WIDTH * HEIGHT, "bayer.dng", &image));
	optla_image_destroy(&image);
	write_bytes(ctx, "fuzz_raw", "bayer.dng", d.bytes, DATA + 2 * WIDTH * HEIGHT);
}

int main(int argc, char **argv)
{
	optla_ctx *ctx;
	if (argc != 2 || OPTLA_OK != optla_ctx_create(&ctx, NULL)) return EXIT_FAILURE;
	top = argv[1];
	yaml_seeds(ctx);
	array_seeds(ctx);
	h5_seeds(ctx);
	model_seeds(ctx);
	krylov_seeds(ctx);
	number_seeds(ctx);
	image_seeds(ctx);
	raw_seed(ctx);
	optla_ctx_destroy(&ctx);
	return EXIT_SUCCESS;
}
