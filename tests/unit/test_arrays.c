/* SPDX-License-Identifier: BSD-3-Clause */
/* Arrays in files: what NumPy and h5py wrote, round trips, cut and damaged files, a full disk, every allocation failing; and the
   writing of whole files below them. */
#include "io/npy.h"
#include "io/whole_file.h"
#include "near.h"
#include "optla/image.h"

#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#define GOLDEN OPTLA_SOURCE_ROOT "/tests/golden/arrays/"

static error_store errors;
static char dir[40], path[128];

static void make_dir(void)
{
	snprintf(dir, sizeof dir, "/tmp/optla-arrays-XXXXXX");
	ck_assert_ptr_nonnull(mkdtemp(dir));
	snprintf(path, sizeof path, "%s/a.npy", dir);
	memset(&errors, 0, sizeof errors);
}

static int remove_files(void)
{
	char pattern[160];
	snprintf(pattern, sizeof pattern, "%s/*", dir);
	glob_t g;
	int count = 0;
	if (!glob(pattern, 0, NULL, &g))
		for (; count < (int)g.gl_pathc; count++) unlink(g.gl_pathv[count]);
	globfree(&g);
	return count;
}

static void remove_dir(void)
{
	remove_files();
	rmdir(dir);
}

/* Real part (part 0) or imaginary part of item k. */
static double value(const optla_array *a, size_t k, int part)
{
	switch (a->type) {
	case OPTLA_F32: return part ? 0 : ((float *)a->data)[k];
	case OPTLA_F64: return part ? 0 : ((double *)a->data)[k];
	case OPTLA_C32: return ((float *)a->data)[2 * k + (size_t)part];
	case OPTLA_C64: return ((double *)a->data)[2 * k + (size_t)part];
	}
	return NAN;
}

static size_t count_of(const optla_array *a)
{
	size_t n = 1;
	for (size_t k = 0; k < a->ndim; k++) n *= a->dims[k];
	return n;
}

static optla_array *load(optla_ctx *ctx, const char *name)
{
	char full[256];
	optla_array *a;
	snprintf(full, sizeof full, GOLDEN "%s", name);
	ok(optla_array_load(ctx, full, &a));
	ck_assert_ptr_eq(a->ctx, ctx);
	return a;
}

static void load_fails(const char *name, optla_status code, const char *message)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	char full[256], wanted[1024];
	optla_array *a;
	snprintf(full, sizeof full, GOLDEN "%s", name);
	status_is(optla_array_load(ctx, full, &a), code);
	ck_assert_ptr_null(a);
	snprintf(wanted, sizeof wanted, GOLDEN "%s", message);
	ck_assert_str_eq(errors.text, wanted);
	optla_ctx_destroy(&ctx);
}

/* ---- what NumPy and h5py wrote ---- */

typedef struct {
	const char *name;
	optla_scalar type;
	bool odd; /* booleans: is the value odd? */
} golden;

static const golden goldens[] = {
    {"i1.npy", OPTLA_F64, false},       {"u1.npy", OPTLA_F64, false},           {"i2.npy", OPTLA_F64, false},
    {"i2_big.npy", OPTLA_F64, false},   {"u2.npy", OPTLA_F64, false},           {"u2_big.npy", OPTLA_F64, false},
    {"i4.npy", OPTLA_F64, false},       {"i4_big.npy", OPTLA_F64, false},       {"u4.npy", OPTLA_F64, false},
    {"u4_big.npy", OPTLA_F64, false},   {"i8.npy", OPTLA_F64, false},           {"i8_big.npy", OPTLA_F64, false},
    {"u8.npy", OPTLA_F64, false},       {"u8_big.npy", OPTLA_F64, false},       {"f2.npy", OPTLA_F32, false},
    {"f2_big.npy", OPTLA_F32, false},   {"f4.npy", OPTLA_F32, false},           {"f4_big.npy", OPTLA_F32, false},
    {"f8.npy", OPTLA_F64, false},       {"f8_big.npy", OPTLA_F64, false},       {"c8.npy", OPTLA_C32, false},
    {"c8_big.npy", OPTLA_C32, false},   {"c16.npy", OPTLA_C64, false},          {"c16_big.npy", OPTLA_C64, false},
    {"b1.npy", OPTLA_F64, true},        {"fortran.npy", OPTLA_F32, false},      {"version2.npy", OPTLA_F32, false},
    {"version3.npy", OPTLA_F32, false}, {"two.npz:photos", OPTLA_F32, false},   {"two.npz:photos.npy", OPTLA_F32, false},
    {"packed.npz", OPTLA_F64, false},   {"packed.npz:arr_0", OPTLA_F64, false}, {"h5py.h5:f4", OPTLA_F32, false},
    {"h5py.h5:big", OPTLA_F64, false},  {"h5py.h5:i2", OPTLA_F64, false},       {"h5py.h5:b1", OPTLA_F64, true},
    {"h5py.h5:f2", OPTLA_F32, false},   {"h5py.h5:c8", OPTLA_C32, false},       {"h5py.h5:group/c16", OPTLA_C64, false},
    {"h5py.h5:/f4", OPTLA_F32, false},  {"h5py.h5:packed", OPTLA_F32, false},   {"h5py_one.h5", OPTLA_F32, false},
};

START_TEST(files_of_others_are_read)
{
	static const double wanted[6] = {0, 1, 2, 3, 4, 100};
	const golden *g = &goldens[_i];
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_array *a = load(ctx, g->name);
	ck_assert_msg(a->type == g->type && a->ndim == 2 && a->dims[0] == 2 && a->dims[1] == 3, "%s: type %d, %zu dimensions",
	              g->name, (int)a->type, a->ndim);
	const bool complex = OPTLA_C32 == a->type || OPTLA_C64 == a->type;
	for (size_t k = 0; k < 6; k++) {
		const double re = value(a, k, 0), im = value(a, k, 1);
		ck_assert_msg(re == (g->odd ? (int)wanted[k] % 2 : wanted[k]), "%s[%zu] = %g", g->name, k, re);
		ck_assert_msg(im == (complex ? -wanted[k] / 4 : 0), "%s[%zu] = %g i", g->name, k, im);
	}
	optla_array_destroy(&a);
	ck_assert_ptr_null(a);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(shapes_of_every_rank)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	static const char *const names[] = {"fortran3.npy", "h5py.h5:dims3"};
	for (size_t n = 0; n < 2; n++) {
		optla_array *a = load(ctx, names[n]);
		ck_assert(a->ndim == 3 && a->dims[0] == 2 && a->dims[1] == 3 && a->dims[2] == 4);
		for (size_t k = 0; k < 24; k++) ck_assert(value(a, k, 0) == (double)k);
		optla_array_destroy(&a);
	}
	optla_array *a = load(ctx, "dims8.npy");
	ck_assert(a->ndim == 8 && a->dims[1] == 2 && a->dims[4] == 2 && count_of(a) == 4 && value(a, 3, 0) == 3);
	optla_array_destroy(&a);
	a = load(ctx, "scalar.npy");
	ck_assert(a->ndim == 0 && value(a, 0, 0) == 7.5);
	optla_array_destroy(&a);
	a = load(ctx, "h5py.h5:scalar");
	ck_assert(a->ndim == 0 && value(a, 0, 0) == 7.5);
	optla_array_destroy(&a);
	a = load(ctx, "empty.npy");
	ck_assert(a->ndim == 2 && a->dims[0] == 0 && a->dims[1] == 3 && a->data);
	optla_array_destroy(&a);
	a = load(ctx, "two.npz:lights");
	ck_assert(a->ndim == 1 && a->dims[0] == 3 && a->type == OPTLA_F64 && value(a, 2, 0) == 2);
	optla_array_destroy(&a);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(extreme_numbers)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_array *a = load(ctx, "extremes_i8.npy");
	ck_assert(value(a, 0, 0) == -0x1p63 && value(a, 1, 0) == -1 && value(a, 2, 0) == 0x1p63); /* the nearest double */
	optla_array_destroy(&a);
	a = load(ctx, "extremes_u8.npy");
	ck_assert(value(a, 0, 0) == 0 && value(a, 1, 0) == 0x1p63 && value(a, 2, 0) == 0x1p64);
	optla_array_destroy(&a);
	a = load(ctx,
	         "extremes_f2.npy"); /* -0, the smallest and largest subnormal, the smallest normal, the largest, infinities, NaN */
	static const double half[6] = {0, 0x1p-24, 0x1.ff8p-15, 0x1p-14, 65504, (double)INFINITY};
	for (size_t k = 0; k < 6; k++) ck_assert(value(a, k, 0) == half[k]);
	ck_assert(signbit(value(a, 0, 0)) && value(a, 6, 0) == -(double)INFINITY && isnan(value(a, 7, 0)));
	optla_array_destroy(&a);
	a = load(ctx, "extremes_f4.npy");
	ck_assert(isnan(value(a, 0, 0)) && value(a, 1, 0) == (double)INFINITY && value(a, 2, 0) == -(double)INFINITY);
	ck_assert(((float *)a->data)[3] == 0x1p-149f);
	optla_array_destroy(&a);
	optla_ctx_destroy(&ctx);
}
END_TEST

typedef struct {
	const char *name;
	optla_status code;
	const char *message;
} refusal;

static const refusal refusals[] = {
    {"structured.npy", OPTLA_ERR_UNSUPPORTED,
     "structured.npy: the NPY header's descr is no plain type; allowed are bool, integers, floats and complex numbers"},
    {"text.npy", OPTLA_ERR_UNSUPPORTED,
     "text.npy: NPY type '<U3'; allowed are b1, u1, i1 ... u8, i8, f2, f4, f8, c8, c16 with a byte order"},
    {"longdouble.npy", OPTLA_ERR_UNSUPPORTED,
     "longdouble.npy: NPY type '<f16'; allowed are b1, u1, i1 ... u8, i8, f2, f4, f8, c8, c16 with a byte order"},
    {"date.npy", OPTLA_ERR_UNSUPPORTED,
     "date.npy: NPY type '<M8[D]'; allowed are b1, u1, i1 ... u8, i8, f2, f4, f8, c8, c16 with a byte order"},
    {"dims9.npy", OPTLA_ERR_UNSUPPORTED, "dims9.npy: NPY array of more than 8 dimensions"},
    {"f4.npy:x", OPTLA_ERR_INPUT, "f4.npy: is a .npy file and has no member 'x'"},
    {"two.npz", OPTLA_ERR_INPUT, "two.npz: holds 2 arrays, say which as '" GOLDEN "two.npz:NAME' (photos, lights)"},
    {"two.npz:photo", OPTLA_ERR_INPUT, "two.npz: has no member 'photo' (it has: photos, lights)"},
    {"h5py.h5", OPTLA_ERR_INPUT,
     "h5py.h5: holds 11 datasets, say which as '" GOLDEN
     "h5py.h5:NAME' (b1, big, c8, dims3, f2, f4, group/c16, i2, packed, scalar, text)"},
    {"h5py.h5:nobody", OPTLA_ERR_INPUT, "h5py.h5: the dataset 'nobody' is missing"},
    {"h5py.h5:none/nobody", OPTLA_ERR_INPUT, "h5py.h5: the dataset 'none/nobody' is missing"},
    {"h5py.h5:text", OPTLA_ERR_INPUT,
     "h5py.h5: 'text' holds neither integers, floats, booleans nor complex numbers (a compound of two floats r and i)"},
    {"make.py", OPTLA_ERR_INPUT, "make.py: is neither a .npy, a .npz nor an HDF5 file"},
    {"none.npy", OPTLA_ERR_INPUT, "none.npy: No such file or directory"},
    {"../arrays", OPTLA_ERR_INPUT, "../arrays: is a directory, a file is needed"},
};

START_TEST(refusals_name_what_is_allowed) { load_fails(refusals[_i].name, refusals[_i].code, refusals[_i].message); }
END_TEST

START_TEST(a_name_with_a_colon_is_a_file_first)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	const double x = 3;
	const optla_array a = {.ctx = ctx, .ndim = 0, .type = OPTLA_F64, .data = (void *)(uintptr_t)&x};
	char name[160], full[200];
	snprintf(name, sizeof name, "%s/10:30.npy", dir);
	ok(optla_array_save(&a, name));
	optla_array *back;
	ok(optla_array_load(ctx, name, &back));
	optla_array_destroy(&back);
	snprintf(name, sizeof name, "%s/10:30.npz", dir);
	snprintf(full, sizeof full, "%s:x", name);
	ok(optla_array_save(&a, full));
	ok(optla_array_load(ctx, full, &back));
	ck_assert(value(back, 0, 0) == 3);
	optla_array_destroy(&back);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- round trips ---- */

static optla_array sample(optla_ctx *ctx, optla_scalar type, size_t ndim, void *data)
{
	optla_array a = {.ctx = ctx, .ndim = ndim, .type = type, .data = data};
	static const size_t dims[8] = {2, 3, 1, 2, 1, 1, 1, 1};
	memcpy(a.dims, dims, ndim * sizeof *dims);
	return a;
}

START_TEST(what_is_saved_comes_back)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	unsigned char data[12 * 16];
	for (size_t k = 0; k < sizeof data; k++) data[k] = (unsigned char)(k * 37 % 61); /* any bits are some number */
	static const char *const endings[] = {"a.npy", "a.npz", "a.npz:photos"};
	for (size_t e = 0; e < 3; e++)
		for (optla_scalar type = OPTLA_F32; type <= OPTLA_C64; type++)
			for (size_t ndim = 0; ndim <= 8; ndim++) {
				const optla_array a = sample(ctx, type, ndim, data);
				snprintf(path, sizeof path, "%s/%s", dir, endings[e]);
				ok(optla_array_save(&a, path));
				optla_array *back;
				ok(optla_array_load(ctx, path, &back));
				ck_assert(back->type == type && back->ndim == ndim && !memcmp(back->dims, a.dims, ndim * sizeof *a.dims));
				ck_assert(!memcmp(back->data, data, count_of(&a) * optla_scalar_bytes(type)));
				optla_array_destroy(&back);
				ck_assert_int_eq(remove_files(), 1);
			}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(our_file_is_the_one_numpy_writes)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	static const char *const names[] = {"f4", "f8", "c8", "c16", "dims8", "scalar", "empty"};
	for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
		char name[160];
		snprintf(name, sizeof name, "%s.npy", names[k]);
		optla_array *a = load(ctx, name);
		ok(optla_array_save(a, path));
		void *ours, *theirs;
		size_t nours, ntheirs;
		snprintf(name, sizeof name, GOLDEN "%s.npy", names[k]);
		ok(optla_read_file_(ctx, path, &ours, &nours));
		ok(optla_read_file_(ctx, name, &theirs, &ntheirs));
		ck_assert_msg(nours == ntheirs && !memcmp(ours, theirs, nours), "%s", names[k]);
		optla_free(ctx, ours);
		optla_free(ctx, theirs);
		optla_array_destroy(&a);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(wrong_arguments_of_save)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	float x[6] = {0};
	optla_array a = sample(ctx, OPTLA_F32, 2, x);
	char wanted[256];
	status_is(optla_array_save(&a, "a.csv"), OPTLA_ERR_ARG);
	ck_assert_str_eq(errors.text, "a.csv: an array can be written as FILE.npy, FILE.npz or FILE.npz:NAME");
	a.ndim = 9;
	status_is(optla_array_save(&a, path), OPTLA_ERR_ARG);
	a = sample(ctx, OPTLA_F32, 2, NULL);
	status_is(optla_array_save(&a, path), OPTLA_ERR_ARG);
	a.dims[0] = a.dims[1] = SIZE_MAX / 2;
	status_is(optla_array_save(&a, path), OPTLA_ERR_ARG);
	a = sample(ctx, OPTLA_F32, 2, x);
	snprintf(path, sizeof path, "%s/none/a.npy", dir);
	status_is(optla_array_save(&a, path), OPTLA_ERR_IO);
	snprintf(wanted, sizeof wanted, "%s: can't be written: No such file or directory", path);
	ck_assert_str_eq(errors.text, wanted);
	ck_assert_int_eq(remove_files(), 0);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- damaged files ---- */

static void *read_golden(optla_ctx *ctx, const char *name, size_t *count)
{
	char full[256];
	void *bytes;
	snprintf(full, sizeof full, GOLDEN "%s", name);
	ok(optla_read_file_(ctx, full, &bytes, count));
	return bytes;
}

static const char *const cut_files[] = {"f4.npy", "version2.npy", "dims8.npy", "two.npz", "packed.npz", "h5py_one.h5"};

START_TEST(every_prefix_is_refused)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	size_t count;
	void *bytes = read_golden(ctx, cut_files[_i], &count);
	const char *member = strstr(cut_files[_i], "two") ? "photos" : NULL;
	optla_array *a;
	for (size_t n = 0; n < count; n++) {
		char *copy = malloc(n + 1); /* its own block, so that the sanitizer sees a read past its end */
		memcpy(copy, bytes, n);
		status_is(optla_array_decode(ctx, copy, n, "cut", member, &a), OPTLA_ERR_INPUT);
		ck_assert_ptr_null(a);
		free(copy);
	}
	ck_assert_int_eq(errors.count, (int)count); /* one message each */
	ok(optla_array_decode(ctx, bytes, count, "whole", member, &a));
	optla_array_destroy(&a);
	optla_free(ctx, bytes);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(a_flipped_bit_in_a_member_is_found)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	static const char *const names[] = {"two.npz", "packed.npz"};
	for (size_t f = 0; f < 2; f++) {
		size_t count;
		unsigned char *bytes = read_golden(ctx, names[f], &count);
		optla_array *a;
		/* 30 bytes of local header and the name, then the data of the first member: 152 bytes stored, over 90 deflated. */
		for (size_t k = 70; k < 120; k++) {
			bytes[k] ^= 16;
			status_is(optla_array_decode(ctx, bytes, count, "flipped", f ? NULL : "photos", &a), OPTLA_ERR_INPUT);
			bytes[k] ^= 16;
		}
		optla_free(ctx, bytes);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

typedef struct {
	const char *dictionary;
	optla_status code;
	const char *message;
} header_case;

static const header_case headers[] = {
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }", OPTLA_OK, ""},
    {"{\"shape\":(2,2),\"descr\":\"<f4\",\"fortran_order\":True}", OPTLA_OK, ""},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (2L, 2L), }", OPTLA_OK, ""},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }", OPTLA_ERR_INPUT,
     "x: truncated NPY file: its shape needs 24 bytes of data, 16 are there"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (4294967296, 4294967296), }", OPTLA_ERR_INPUT,
     "x: the NPY array's shape is beyond the address space"},
    {"{'descr': '<c16', 'fortran_order': False, 'shape': (4294967296, 268435456), }", OPTLA_ERR_INPUT,
     "x: the NPY array's size is beyond the address space"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999,), }", OPTLA_ERR_INPUT,
     "x: size 0 of the NPY header's shape is no number"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (-1,), }", OPTLA_ERR_INPUT,
     "x: size 0 of the NPY header's shape is no number"},
    {"{'descr': '<f4', 'fortran_order': 0, 'shape': (2, 2), }", OPTLA_ERR_INPUT,
     "x: fortran_order in the NPY header is neither True nor False"},
    {"{'descr': '<f4', 'shape': (2, 2), }", OPTLA_ERR_INPUT, "x: the NPY header lacks fortran_order"},
    {"{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }", OPTLA_ERR_INPUT,
     "x: key 'descr' in the NPY header; needed are descr, fortran_order and shape, each once"},
    {"{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), } x", OPTLA_ERR_INPUT,
     "x: text after the NPY header's dictionary"},
    {"{'descr': '<f4", OPTLA_ERR_UNSUPPORTED,
     "x: the NPY header's descr is no plain type; allowed are bool, integers, floats and complex numbers"},
    {"", OPTLA_ERR_INPUT, "x: the NPY header is no dictionary"},
};

START_TEST(npy_headers)
{
	const header_case *h = &headers[_i];
	unsigned char file[256] = "\x93NUMPY\x01";
	const size_t n = strlen(h->dictionary);
	file[8] = (unsigned char)n;
	memcpy(file + 10, h->dictionary, n);
	memcpy(file + 10 + n, (float[]){1, 2, 3, 4}, 16);
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_array *a;
	status_is(optla_array_decode(ctx, file, 10 + n + 16, "x", NULL, &a), h->code);
	ck_assert_str_eq(errors.text, h->message);
	if (OPTLA_OK == h->code) ck_assert(value(a, 1, 0) == (strstr(h->dictionary, "True") ? 3 : 2));
	optla_array_destroy(&a);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(a_claim_of_much_memory_is_refused_before_it_is_taken)
{
	/* A deflated member that claims 2^31 bytes in its 100: the limit of the context is above that. */
	optla_ctx *ctx;
	const optla_ctx_desc d = {
	    .size = sizeof d, .error = error_keep, .error_user = &errors, .memory_limit_bytes = (size_t)1 << 40};
	ok(optla_ctx_create(&ctx, &d));
	size_t count;
	unsigned char *bytes = read_golden(ctx, "packed.npz", &count);
	for (size_t k = 0; k + 4 < count; k++)
		if (!memcmp(bytes + k, "PK\x01\x02", 4)) bytes[k + 27] = 0x7f; /* size in the central directory */
	optla_array *a;
	status_is(optla_array_decode(ctx, bytes, count, "bomb", NULL, &a), OPTLA_ERR_INPUT);
	ck_assert_ptr_nonnull(strstr(errors.text, "which can't be"));
	optla_free(ctx, bytes);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(a_file_over_the_memory_limit_is_refused)
{
	optla_ctx *ctx;
	const optla_ctx_desc d = {.size = sizeof d, .error = error_keep, .error_user = &errors, .memory_limit_bytes = 4096};
	ok(optla_ctx_create(&ctx, &d));
	const int fd = open(path, O_WRONLY | O_CREAT, 0600);
	ck_assert(fd >= 0 && 0 == ftruncate(fd, (off_t)1 << 33) && 0 == close(fd)); /* sparse: takes no disk */
	void *bytes;
	size_t count;
	status_is(optla_read_file_(ctx, path, &bytes, &count), OPTLA_ERR_NOMEM);
	char wanted[256];
	snprintf(wanted, sizeof wanted, "%s: its 8 GiB are over the memory limit of 3.815e-06 GiB", path);
	ck_assert_str_eq(errors.text, wanted);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- files whole or not at all ---- */

START_TEST(a_full_disk_leaves_the_old_file)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	char file[160];
	snprintf(path, sizeof path, _i ? "%s/a.npz:x" : "%s/a.npy", dir);
	snprintf(file, sizeof file, _i ? "%s/a.npz" : "%s/a.npy", dir);
	ok(optla_write_file_(ctx, file, "old", 3));
	float *x = calloc(100000, sizeof *x);
	const optla_array a = {.ctx = ctx, .ndim = 1, .dims = {100000}, .type = OPTLA_F32, .data = x};
	signal(SIGXFSZ, SIG_IGN);
	struct rlimit before;
	getrlimit(RLIMIT_FSIZE, &before);
	ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &(struct rlimit){40000, before.rlim_max}), 0);
	const optla_status s = optla_array_save(&a, path);
	setrlimit(RLIMIT_FSIZE, &before);
	status_is(s, OPTLA_ERR_IO);
	char wanted[256];
	snprintf(wanted, sizeof wanted, "%s: can't be written: the file would be larger than the system's limit for files", file);
	ck_assert_str_eq(errors.text, wanted);
	void *bytes;
	size_t count;
	ok(optla_read_file_(ctx, file, &bytes, &count));
	ck_assert(3 == count && !memcmp(bytes, "old", 3));
	optla_free(ctx, bytes);
	free(x);
	ck_assert_int_eq(remove_files(), 1);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(the_disk_full_device)
{
	/* ENOSPC itself has its own words; /dev/full answers so, but is a device, which is refused before. */
	char text[128];
	ck_assert_str_eq(optla_errno_text_(ENOSPC, text, sizeof text), "the disk is full (or its quota used up)");
	optla_ctx *ctx = test_ctx(&errors, 1);
	status_is(optla_write_file_(ctx, "/dev/full", "x", 1), OPTLA_ERR_IO);
	ck_assert_str_eq(errors.text, "/dev/full: is a pipe or a device, so no file can be written there");
	void *bytes;
	size_t count;
	status_is(optla_read_file_(ctx, "/dev/zero", &bytes, &count), OPTLA_ERR_INPUT);
	ck_assert_str_eq(errors.text, "/dev/zero: is a pipe or a device; save its contents to a file first");
	ck_assert_int_eq(mkfifo(path, 0600), 0);
	status_is(optla_read_file_(ctx, path, &bytes, &count), OPTLA_ERR_INPUT); /* and doesn't wait for a writer */
	ck_assert_ptr_null(bytes);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(leftovers_of_others_are_not_touched)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	char left[160];
	snprintf(left, sizeof left, "%s.tmp-%ld-0", path, (long)getpid());
	const int fd = open(left, O_WRONLY | O_CREAT, 0600);
	ck_assert(3 == write(fd, "his", 3) && 0 == close(fd));
	ok(optla_write_file_(ctx, path, "mine", 4));
	void *bytes;
	size_t count;
	ok(optla_read_file_(ctx, left, &bytes, &count));
	ck_assert(3 == count && !memcmp(bytes, "his", 3));
	optla_free(ctx, bytes);
	ok(optla_read_file_(ctx, path, &bytes, &count));
	ck_assert(4 == count && !memcmp(bytes, "mine", 5)); /* with the zero byte behind */
	optla_free(ctx, bytes);
	ck_assert_int_eq(remove_files(), 2);
	optla_ctx_destroy(&ctx);
}
END_TEST

static void path_is(char *got, const char *wanted, optla_ctx *ctx)
{
	ck_assert_str_eq(got, wanted);
	optla_free(ctx, got);
}

START_TEST(paths)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	path_is(optla_path_dir_(ctx, "a.npy"), ".", ctx);
	path_is(optla_path_dir_(ctx, "x/y/a.npy"), "x/y", ctx);
	path_is(optla_path_dir_(ctx, "x//a.npy"), "x", ctx);
	path_is(optla_path_dir_(ctx, "/a.npy"), "/", ctx);
	path_is(optla_path_join_(ctx, "x", "a"), "x/a", ctx);
	path_is(optla_path_join_(ctx, "x/", "a"), "x/a", ctx);
	path_is(optla_path_join_(ctx, "x", "/a"), "/a", ctx);
	path_is(optla_path_join_(ctx, "", "a"), "a", ctx);
	char deep[160], inner[200];
	snprintf(deep, sizeof deep, "%s/p//q/", dir);
	ok(optla_make_dirs_(ctx, deep));
	ok(optla_make_dirs_(ctx, deep));
	struct stat s;
	snprintf(inner, sizeof inner, "%s/p/q", dir);
	ck_assert(0 == stat(inner, &s) && S_ISDIR(s.st_mode));
	rmdir(inner);
	inner[strlen(inner) - 2] = 0;
	rmdir(inner);
	ok(optla_write_file_(ctx, path, "x", 1));
	snprintf(inner, sizeof inner, "%s/under", path);
	status_is(optla_make_dirs_(ctx, inner), OPTLA_ERR_IO);
	ck_assert_ptr_nonnull(strstr(errors.text, path));
	optla_ctx_destroy(&ctx);
}
END_TEST

static optla_status load_and_save(optla_ctx *ctx, const char *from, const char *to)
{
	char full[256];
	optla_array *a;
	snprintf(full, sizeof full, GOLDEN "%s", from);
	OPTLA_TRY(optla_array_load(ctx, full, &a));
	snprintf(path, sizeof path, "%s/%s", dir, to);
	const optla_status s = optla_array_save(a, path);
	optla_array_destroy(&a);
	return s;
}

START_TEST(every_allocation_may_fail)
{
	static const char *const from[] = {"f4.npy", "two.npz:photos", "h5py_one.h5"}, *const to[] = {"b.npy", "b.npz:x", "b.npz"};
	long failures = 0;
	for (long k = 1;; k++) {
		alloc_budget budget = {.left = k};
		optla_ctx *ctx;
		const optla_ctx_desc d = {.size = sizeof d,
		                          .alloc = budget_alloc,
		                          .free = budget_free,
		                          .alloc_user = &budget,
		                          .error = error_keep,
		                          .error_user = &errors};
		ok(optla_ctx_create(&ctx, &d));
		const optla_status s = load_and_save(ctx, from[_i], to[_i]);
		const bool whole = budget.left > 0;
		if (OPTLA_OK != s) {
			status_is(s, OPTLA_ERR_NOMEM);
			failures++;
		}
		optla_ctx_destroy(&ctx);
		ck_assert_int_eq(budget.live, 0);
		ck_assert_int_le(remove_files(), 1);
		if (whole) break;
	}
	ck_assert_int_ge(failures, 5); /* name, array, file, data, temporary */
}
END_TEST

#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

static Suite *suite(void)
{
	Suite *s = suite_create("arrays");
	TCase *c = tcase_create("arrays");
	tcase_add_checked_fixture(c, make_dir, remove_dir);
	tcase_set_timeout(c, 60);
	tcase_add_loop_test(c, files_of_others_are_read, 0, COUNT(goldens));
	tcase_add_test(c, shapes_of_every_rank);
	tcase_add_test(c, extreme_numbers);
	tcase_add_loop_test(c, refusals_name_what_is_allowed, 0, COUNT(refusals));
	tcase_add_test(c, a_name_with_a_colon_is_a_file_first);
	tcase_add_test(c, what_is_saved_comes_back);
	tcase_add_test(c, our_file_is_the_one_numpy_writes);
	tcase_add_test(c, wrong_arguments_of_save);
	tcase_add_loop_test(c, every_prefix_is_refused, 0, COUNT(cut_files));
	tcase_add_test(c, a_flipped_bit_in_a_member_is_found);
	tcase_add_loop_test(c, npy_headers, 0, COUNT(headers));
	tcase_add_test(c, a_claim_of_much_memory_is_refused_before_it_is_taken);
	tcase_add_test(c, a_file_over_the_memory_limit_is_refused);
	tcase_add_loop_test(c, a_full_disk_leaves_the_old_file, 0, 2);
	tcase_add_test(c, the_disk_full_device);
	tcase_add_test(c, leftovers_of_others_are_not_touched);
	tcase_add_test(c, paths);
	tcase_add_loop_test(c, every_allocation_may_fail, 0, 3);
	suite_add_tcase(s, c);
	return s;
}

int main(void) { return run_suite(suite()); }
