/* SPDX-License-Identifier: BSD-3-Clause */
/* HDF5 files: round trips, conversions, refusals, a full disk, every allocation failing. */
#include "io/h5.h"
#include "io/whole_file.h"
#include "near.h"

#include <fcntl.h>
#include <glob.h>
#include <hdf5.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static error_store errors;
static char dir[32];
static char path[128];

static void make_dir(void)
{
	snprintf(dir, sizeof dir, "/tmp/optla-h5-XXXXXX");
	ck_assert_ptr_nonnull(mkdtemp(dir));
	snprintf(path, sizeof path, "%s/a.h5", dir);
}

static int files_left(void)
{
	char pattern[160];
	snprintf(pattern, sizeof pattern, "%s/*", dir);
	glob_t g;
	const int none = glob(pattern, 0, NULL, &g);
	const int count = none ? 0 : (int)g.gl_pathc;
	if (!none)
		for (size_t k = 0; k < g.gl_pathc; k++) unlink(g.gl_pathv[k]);
	globfree(&g);
	return count;
}

static void remove_dir(void)
{
	files_left();
	rmdir(dir);
}

static size_t scalar_bytes(optla_scalar type) { return (size_t[]){4, 8, 8, 16}[type]; }

/* A file at path with one dataset "x" of raw bytes in a given file type. */
static void write_raw(const char *name, hid_t type, int rank, const hsize_t *dims, const void *data)
{
	const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), space = H5Screate_simple(rank, dims, NULL);
	const hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
	ck_assert(set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
	H5Dclose(set);
	H5Sclose(space);
	ck_assert(H5Fclose(file) >= 0);
}

static optla_h5 *open_it(optla_ctx *ctx)
{
	optla_h5 *f;
	ok(optla_h5_open_(ctx, path, NULL, &f));
	return f;
}

START_TEST(blocks_of_every_scalar_come_back)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	for (optla_scalar type = OPTLA_F32; type <= OPTLA_C64; type++) {
		unsigned char data[3 * 5 * 16]; /* 3 columns of 4 rows, 5 apart */
		const size_t item = scalar_bytes(type), parts = OPTLA_C32 == type || OPTLA_C64 == type ? 2 : 1;
		for (size_t k = 0; k < 15 * parts; k++) {
			const double v = 0.1 * (double)k - 0.7;
			if (item / parts == 4)
				((float *)data)[k] = (float)v;
			else
				((double *)data)[k] = v;
		}
		optla_h5 *f;
		ok(optla_h5_create_(ctx, path, "test", &f));
		ok(optla_h5_put_(f, "photos", (optla_cblock){data, 4, 3, 5, type}, "J", "what it is"));
		ok(optla_h5_finish_(&f, true));
		ck_assert_ptr_null(f);
		ok(optla_h5_open_(ctx, path, "test", &f));
		optla_block back;
		ok(optla_h5_get_(f, "photos", type, &back));
		ck_assert(back.nrows == 4 && back.ncols == 3 && back.ld == 4 && back.type == type);
		for (size_t c = 0; c < 3; c++) ck_assert(!memcmp((char *)back.data + c * 4 * item, data + c * 5 * item, 4 * item));
		optla_free(ctx, back.data);
		optla_h5_close_(&f);
		ck_assert_int_eq(files_left(), 1);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(what_is_written_is_documented_and_can_be_mapped)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	ok(optla_ctx_set_provenance(ctx, "optla test", 7, NULL));
	const float photos[2000] = {1, 2, 3};
	optla_h5 *f;
	ok(optla_h5_create_(ctx, path, "krylov", &f));
	ok(optla_h5_put_(f, "photos", (optla_cblock){photos, 1000, 2, 1000, OPTLA_F32}, "J", "basis of photos"));
	ok(optla_h5_finish_(&f, true));

	const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), set = H5Dopen2(file, "photos", H5P_DEFAULT);
	const hid_t create = H5Dget_create_plist(set), unit = H5Aopen(set, "unit", H5P_DEFAULT), type = H5Aget_type(unit);
	ck_assert_int_eq(H5Pget_layout(create), H5D_CONTIGUOUS);
	ck_assert_uint_eq(H5Dget_offset(set) % 4096, 0);
	char *text;
	ck_assert(H5Tget_cset(type) == H5T_CSET_UTF8 && H5Aread(unit, type, &text) >= 0);
	ck_assert_str_eq(text, "J");
	H5free_memory(text);
	float mapped[2000];
	const int fd = open(path, O_RDONLY);
	ck_assert_int_eq(pread(fd, mapped, sizeof mapped, (off_t)H5Dget_offset(set)), sizeof mapped);
	ck_assert(!memcmp(mapped, photos, sizeof photos));
	close(fd);
	H5Tclose(type);
	H5Aclose(unit);
	H5Pclose(create);
	H5Dclose(set);
	H5Fclose(file);

	f = open_it(ctx);
	char *provenance;
	ok(optla_h5_get_text_(f, "provenance", &provenance));
	ck_assert_ptr_nonnull(strstr(provenance, "command: optla test\n"));
	optla_free(ctx, provenance);
	optla_h5_close_(&f);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(same_contents_same_bytes)
{
	void *bytes[2];
	size_t count[2];
	optla_ctx *ctx = test_ctx(&errors, 1);
	for (int k = 0; k < 2; k++) {
		if (k) sleep(1); /* a time in the file would have a resolution of a second */
		const double x[3] = {1, 2, 3};
		optla_h5 *f;
		ok(optla_h5_create_(ctx, path, "test", &f));
		ok(optla_h5_put_(f, "x", (optla_cblock){x, 3, 1, 3, OPTLA_F64}, "", "x"));
		ok(optla_h5_put_number_(f, "k", 3));
		ok(optla_h5_finish_(&f, true));
		optla_ctx *reader = test_ctx(&errors, 1); /* so that the input isn't in the provenance of the second file */
		ok(optla_read_file_(reader, path, &bytes[k], &count[k]));
		void *copy = malloc(count[k]);
		memcpy(copy, bytes[k], count[k]);
		optla_free(reader, bytes[k]);
		bytes[k] = copy;
		optla_ctx_destroy(&reader);
	}
	ck_assert_uint_eq(count[0], count[1]);
	ck_assert(!memcmp(bytes[0], bytes[1], count[0]));
	free(bytes[0]);
	free(bytes[1]);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(attributes_and_lists_come_back)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	const uint32_t list[4] = {0, 1, 4000000000u, 7};
	char *text, *long_text = malloc(200001);
	memset(long_text, 'x', 200000);
	long_text[200000] = 0;
	optla_h5 *f;
	ok(optla_h5_create_(ctx, path, "test", &f));
	ok(optla_h5_put_u32_(f, "list", list, 4, "columns"));
	ok(optla_h5_put_u32_(f, "nothing", list, 0, NULL));
	ok(optla_h5_put_number_(f, "residual", 0.1));
	ok(optla_h5_put_text_(f, "note", "h\xc3\xa9 \xe2\x9c\x93"));
	ok(optla_h5_put_text_(f, "long", long_text)); /* over the 64 KiB of an attribute of fixed size */
	ok(optla_h5_put_text_(f, "empty", ""));
	ok(optla_h5_finish_(&f, true));
	f = open_it(ctx);
	uint32_t *values;
	size_t count;
	ok(optla_h5_get_u32_(f, "list", &values, &count));
	ck_assert(4 == count && !memcmp(values, list, sizeof list));
	optla_free(ctx, values);
	ok(optla_h5_get_u32_(f, "nothing", &values, &count));
	ck_assert_uint_eq(count, 0);
	optla_free(ctx, values);
	double x = 0;
	ok(optla_h5_get_number_(f, "residual", &x));
	ck_assert(x == 0.1);
	ok(optla_h5_get_text_(f, "note", &text));
	ck_assert_str_eq(text, "h\xc3\xa9 \xe2\x9c\x93");
	optla_free(ctx, text);
	ok(optla_h5_get_text_(f, "long", &text));
	ck_assert_str_eq(text, long_text);
	optla_free(ctx, text);
	ok(optla_h5_get_text_(f, "empty", &text));
	ck_assert_str_eq(text, "");
	optla_free(ctx, text);
	ck_assert(optla_h5_has_(f, "list") && optla_h5_has_(f, "residual") && !optla_h5_has_(f, "residue") &&
	          !optla_h5_has_(f, "a/b"));
	optla_h5_close_(&f);
	free(long_text);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(numbers_of_any_type_are_converted)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	const hid_t pair = H5Tcreate(H5T_COMPOUND, 8);
	H5Tinsert(pair, "real", 0, H5T_NATIVE_FLOAT);
	H5Tinsert(pair, "imag", 4, H5T_NATIVE_FLOAT);
	const hid_t flag = H5Tenum_create(H5T_NATIVE_INT8);
	signed char no = 0, yes = 1;
	H5Tenum_insert(flag, "FALSE", &no);
	H5Tenum_insert(flag, "TRUE", &yes);
	const unsigned char big_endian[6] = {0, 1, 0, 2, 255, 255};
	const hid_t types[] = {H5T_NATIVE_INT32, H5T_STD_U16BE, H5T_NATIVE_LDOUBLE, pair, flag};
	const void *data[] = {(int[]){1, 2, -3}, big_endian, (long double[]){1, 2, -3}, (float[]){1, 10, 2, 20, -3, 30},
	                      (signed char[]){1, 0, 1}};
	const double wanted[5][3] = {{1, 2, -3}, {1, 2, 65535}, {1, 2, -3}, {1, 2, -3}, {1, 0, 1}};
	for (int t = 0; t < 5; t++) {
		write_raw("x", types[t], 1, (hsize_t[]){3}, data[t]);
		optla_h5 *f = open_it(ctx);
		optla_block b;
		for (optla_scalar s = OPTLA_F32; s <= OPTLA_C64; s++) {
			if (3 == t && s < OPTLA_C32) { /* the imaginary part would be lost */
				status_is(optla_h5_get_(f, "x", s, &b), OPTLA_ERR_INPUT);
				ck_assert_ptr_null(b.data);
				continue;
			}
			ok(optla_h5_get_(f, "x", s, &b));
			ck_assert(3 == b.nrows && 1 == b.ncols);
			for (size_t k = 0; k < 3; k++) {
				const float *x = b.data;
				const double *y = b.data;
				const double re = OPTLA_F32 == s ? x[k] : OPTLA_F64 == s ? y[k] : OPTLA_C32 == s ? x[2 * k] : y[2 * k];
				const double im = OPTLA_C32 == s ? x[2 * k + 1] : OPTLA_C64 == s ? y[2 * k + 1] : 0;
				ck_assert(re == wanted[t][k]);
				ck_assert(im == (3 == t ? 10.0 * (double)(k + 1) : 0));
			}
			optla_free(ctx, b.data);
		}
		optla_h5_close_(&f);
	}
	H5Tclose(pair);
	H5Tclose(flag);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(refusals_name_file_and_dataset)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_h5 *f;
	optla_block b;
	double x;
	char *text, wanted[512];
	status_is(optla_h5_open_(ctx, path, NULL, &f), OPTLA_ERR_INPUT);
	snprintf(wanted, sizeof wanted, "%s: can't be opened: No such file or directory", path);
	ck_assert_str_eq(errors.text, wanted);
	status_is(optla_h5_open_(ctx, dir, NULL, &f), OPTLA_ERR_INPUT);
	ok(optla_write_file_(ctx, path, "not HDF5 at all", 15));
	status_is(optla_h5_open_(ctx, path, NULL, &f), OPTLA_ERR_INPUT);
	snprintf(wanted, sizeof wanted, "%s: is not an HDF5 file, or a damaged one: ", path);
	ck_assert_msg(!strncmp(errors.text, wanted, strlen(wanted)), "%s", errors.text);
	ck_assert_ptr_null(f);

	ok(optla_h5_create_(ctx, path, "krylov", &f));
	ok(optla_h5_put_text_(f, "word", "abc"));
	ok(optla_h5_put_number_(f, "number", 1));
	ok(optla_h5_finish_(&f, true));
	status_is(optla_h5_open_(ctx, path, "rig", &f), OPTLA_ERR_INPUT);
	snprintf(wanted, sizeof wanted, "%s: holds a 'krylov', not a 'rig'", path);
	ck_assert_str_eq(errors.text, wanted);
	f = open_it(ctx);
	status_is(optla_h5_get_(f, "photos", OPTLA_F32, &b), OPTLA_ERR_INPUT);
	snprintf(wanted, sizeof wanted, "%s: the dataset 'photos' is missing", path);
	ck_assert_str_eq(errors.text, wanted);
	status_is(optla_h5_get_number_(f, "word", &x), OPTLA_ERR_INPUT);
	snprintf(wanted, sizeof wanted, "%s: the attribute 'word' is not a number", path);
	ck_assert_str_eq(errors.text, wanted);
	status_is(optla_h5_get_text_(f, "number", &text), OPTLA_ERR_INPUT);
	status_is(optla_h5_get_text_(f, "nobody", &text), OPTLA_ERR_INPUT);
	snprintf(wanted, sizeof wanted, "%s: the attribute 'nobody' is missing", path);
	ck_assert_str_eq(errors.text, wanted);
	ck_assert_ptr_null(text);
	optla_h5_close_(&f);

	write_raw("x", H5T_NATIVE_INT, 3, (hsize_t[]){1, 1, 2}, (int[]){1, 2});
	f = open_it(ctx);
	status_is(optla_h5_get_(f, "x", OPTLA_F32, &b), OPTLA_ERR_INPUT);
	snprintf(wanted, sizeof wanted, "%s: 'x' has 3 dimensions, 1 or 2 are needed", path);
	ck_assert_str_eq(errors.text, wanted);
	optla_h5_close_(&f);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(a_dataset_over_the_memory_limit_is_refused)
{
	/* chunked, never written: a file of a few kilobytes that claims 8 TiB */
	const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
	const hsize_t dims[2] = {1 << 20, 1 << 20}, chunk[2] = {64, 64};
	const hid_t space = H5Screate_simple(2, dims, NULL), create = H5Pcreate(H5P_DATASET_CREATE);
	H5Pset_chunk(create, 2, chunk);
	const hid_t set = H5Dcreate2(file, "x", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, create, H5P_DEFAULT);
	ck_assert(set >= 0);
	H5Dclose(set);
	H5Pclose(create);
	H5Sclose(space);
	H5Fclose(file);
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_h5 *f = open_it(ctx);
	optla_block b;
	status_is(optla_h5_get_(f, "x", OPTLA_F64, &b), OPTLA_ERR_NOMEM);
	optla_h5_close_(&f);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(values_in_another_file_are_not_followed)
{
	char other[128];
	snprintf(other, sizeof other, "%s/secret", dir);
	optla_ctx *ctx = test_ctx(&errors, 1);
	ok(optla_write_file_(ctx, other, "12345678", 8));
	const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
	const hsize_t dims[1] = {1};
	const hid_t space = H5Screate_simple(1, dims, NULL), create = H5Pcreate(H5P_DATASET_CREATE);
	ck_assert(H5Pset_external(create, other, 0, 8) >= 0);
	const hid_t set = H5Dcreate2(file, "x", H5T_NATIVE_INT64, space, H5P_DEFAULT, create, H5P_DEFAULT);
	ck_assert(set >= 0);
	H5Dclose(set);
	H5Pclose(create);
	H5Sclose(space);
	H5Fclose(file);
	optla_h5 *f = open_it(ctx);
	optla_block b;
	status_is(optla_h5_get_(f, "x", OPTLA_F64, &b), OPTLA_ERR_INPUT);
	ck_assert_ptr_nonnull(strstr(errors.text, "another file"));
	optla_h5_close_(&f);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* Changes the bytes of the file at path where find stands for the first time. */
static void patch(optla_ctx *ctx, const char *find, size_t n, size_t offset, const char *put, size_t nput)
{
	void *data;
	size_t count, k = 0;
	ok(optla_read_file_(ctx, path, &data, &count));
	char *bytes = data;
	while (k + n < count && memcmp(bytes + k, find, n)) k++;
	ck_assert(k + n < count && k + offset + nput <= count);
	memcpy(bytes + k + offset, put, nput);
	ok(optla_write_file_(ctx, path, bytes, count));
	optla_free(ctx, data);
}

START_TEST(what_hdf5_would_trust_too_much)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_h5 *f;
	optla_block b;
	const float x[4] = {1, 2, 3, 4};
	char wanted[256];
	/* A pair {r, i} of which the whole is said to be longer than its parts: in the oldest format, whose headers have no checksums. */
	const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), pair = H5Tcreate(H5T_COMPOUND, 8);
	ck_assert(H5Tinsert(pair, "r", 0, H5T_NATIVE_FLOAT) >= 0 && H5Tinsert(pair, "i", 4, H5T_NATIVE_FLOAT) >= 0);
	const hid_t space = H5Screate_simple(1, (const hsize_t[]){2}, NULL);
	const hid_t set = H5Dcreate2(file, "x", pair, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
	ck_assert(H5Dwrite(set, pair, H5S_ALL, H5S_ALL, H5P_DEFAULT, x) >= 0);
	H5Dclose(set);
	H5Sclose(space);
	H5Tclose(pair);
	H5Fclose(file);
	patch(ctx, "\x16\2\0\0\x8\0\0\0r", 9, 4, "\xc", 1); /* class and version, two members, size */
	ok(optla_h5_open_(ctx, path, NULL, &f));
	status_is(optla_h5_get_(f, "x", OPTLA_C32, &b), OPTLA_ERR_INPUT);
	ck_assert_ptr_null(b.data);
	snprintf(wanted, sizeof wanted,
	         "%s: 'x' holds neither integers, floats, booleans nor complex numbers (a compound of two floats r and i)", path);
	ck_assert_str_eq(errors.text, wanted);
	optla_h5_close_(&f);
	/* A block of driver information, which HDF5 reads in the length that it claims itself. */
	patch(ctx, "\x89HDF", 4, 48, "\0\1\0\0\0\0\0\0", 8);
	status_is(optla_h5_open_(ctx, path, NULL, &f), OPTLA_ERR_INPUT);
	snprintf(wanted, sizeof wanted, "%s: is one of the files of a split HDF5 file, or damaged", path);
	ck_assert_str_eq(errors.text, wanted);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(any_prefix_of_a_file_is_refused_or_read)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	const float x[300] = {1, 2, 3};
	optla_h5 *f;
	ok(optla_h5_create_(ctx, path, "test", &f));
	ok(optla_h5_put_(f, "x", (optla_cblock){x, 300, 1, 300, OPTLA_F32}, "J", "x"));
	ok(optla_h5_finish_(&f, true));
	char *bytes;
	size_t count;
	void *data;
	ok(optla_read_file_(ctx, path, &data, &count));
	bytes = data;
	size_t read = 0;
	for (size_t n = 0; n < count; n += n < 4096 ? 1 : 61) { /* each byte of the metadata, then steps coprime to all its sizes */
		optla_block b = {0};
		char *copy = malloc(n + 1);
		memcpy(copy, bytes, n);
		if (OPTLA_OK == optla_h5_open_bytes_(ctx, copy, n, "cut.h5", &f)) {
			read += OPTLA_OK == optla_h5_get_(f, "x", OPTLA_F32, &b);
			optla_free(ctx, b.data);
			optla_h5_close_(&f);
		}
		free(copy);
	}
	ck_assert_uint_eq(read, 0);
	ok(optla_h5_open_bytes_(ctx, bytes, count, "whole.h5", &f));
	optla_h5_close_(&f);
	optla_free(ctx, data);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(a_full_disk_leaves_the_old_file)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	ok(optla_write_file_(ctx, path, "old", 3));
	signal(SIGXFSZ, SIG_IGN);
	const rlim_t limit = _i ? 2000 : 40000; /* in the metadata, in the data */
	struct rlimit before;
	getrlimit(RLIMIT_FSIZE, &before);
	ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &(struct rlimit){limit, before.rlim_max}), 0);
	float *x = calloc(100000, sizeof *x);
	optla_h5 *f;
	optla_status s = optla_h5_create_(ctx, path, "test", &f);
	if (OPTLA_OK == s) s = optla_h5_put_(f, "x", (optla_cblock){x, 100000, 1, 100000, OPTLA_F32}, "J", "x");
	const optla_status finish = optla_h5_finish_(&f, OPTLA_OK == s);
	setrlimit(RLIMIT_FSIZE, &before);
	status_is(OPTLA_OK == s ? finish : s, OPTLA_ERR_IO);
	ck_assert_msg(strstr(errors.text, "larger than the system's limit") && strstr(errors.text, path), "%s", errors.text);
	void *bytes;
	size_t count;
	ok(optla_read_file_(ctx, path, &bytes, &count));
	ck_assert(3 == count && !memcmp(bytes, "old", 3));
	optla_free(ctx, bytes);
	free(x);
	ck_assert_int_eq(files_left(), 1);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(giving_up_leaves_nothing)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_h5 *f;
	ok(optla_h5_create_(ctx, path, "test", &f));
	ok(optla_h5_finish_(&f, false));
	ck_assert_int_eq(files_left(), 0);
	char missing[160];
	snprintf(missing, sizeof missing, "%s/none/a.h5", dir);
	status_is(optla_h5_create_(ctx, missing, "test", &f), OPTLA_ERR_IO);
	ck_assert_ptr_null(f);
	optla_ctx_destroy(&ctx);
}
END_TEST

static optla_status write_and_read(optla_ctx *ctx)
{
	const float x[2] = {1, 2};
	optla_h5 *f;
	optla_status s = optla_h5_create_(ctx, path, "test", &f);
	if (OPTLA_OK == s) s = optla_h5_put_(f, "x", (optla_cblock){x, 2, 1, 2, OPTLA_F32}, "J", "x");
	const optla_status finish = optla_h5_finish_(&f, OPTLA_OK == s);
	if (OPTLA_OK == s) s = finish;
	if (OPTLA_OK == s) s = optla_h5_open_(ctx, path, "test", &f);
	optla_block b = {0};
	char *name = NULL;
	if (OPTLA_OK == s) s = optla_h5_get_(f, "x", OPTLA_F32, &b);
	if (OPTLA_OK == s) s = optla_h5_only_name_(f, &name);
	optla_free(ctx, b.data);
	optla_free(ctx, name);
	optla_h5_close_(&f);
	return s;
}

START_TEST(every_allocation_may_fail)
{
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
		const optla_status s = write_and_read(ctx);
		const bool whole = budget.left > 0; /* not one allocation was refused, not even those whose failure is no error */
		if (OPTLA_OK != s) {
			status_is(s, OPTLA_ERR_NOMEM);
			failures++;
		}
		optla_ctx_destroy(&ctx);
		ck_assert_int_eq(budget.live, 0);
		ck_assert_int_le(files_left(), 1);
		if (whole) break;
	}
	ck_assert_int_ge(failures, 8);
}
END_TEST

START_TEST(threads_wait_for_each_other)
{
	/* Two contexts, eight files: without the lock of h5.c the HDF5 library, made for one thread, breaks down here. */
	optla_ctx *ctx[2] = {test_ctx(NULL, 1), test_ctx(NULL, 1)};
	optla_status status[8];
	double back[8];
#pragma omp parallel for num_threads(4) schedule(static)
	for (int k = 0; k < 8; k++) {
		char name[160];
		snprintf(name, sizeof name, "%s/t%d.h5", dir, k);
		optla_h5 *f;
		status[k] = optla_h5_create_(ctx[k % 2], name, "test", &f);
		if (OPTLA_OK == status[k]) status[k] = optla_h5_put_number_(f, "k", k);
		optla_h5_finish_(&f, true);
		if (OPTLA_OK == status[k]) status[k] = optla_h5_open_(ctx[k % 2], name, "test", &f);
		if (OPTLA_OK == status[k]) status[k] = optla_h5_get_number_(f, "k", &back[k]);
		optla_h5_close_(&f);
	}
	for (int k = 0; k < 8; k++) ck_assert(OPTLA_OK == status[k] && back[k] == k);
	optla_ctx_destroy(&ctx[0]);
	optla_ctx_destroy(&ctx[1]);
}
END_TEST

static herr_t count_print(hid_t stack, void *user)
{
	(void)stack;
	++*(int *)user;
	return 0;
}

START_TEST(the_callers_error_handler_is_left_alone)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	int printed = 0;
	H5Eset_auto2(H5E_DEFAULT, count_print, &printed);
	ok(optla_write_file_(ctx, path, "nonsense", 8));
	optla_h5 *f;
	status_is(optla_h5_open_(ctx, path, NULL, &f), OPTLA_ERR_INPUT);
	ck_assert_int_eq(printed, 0);
	H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
	ck_assert_int_eq(printed, 1);
	optla_ctx_destroy(&ctx);
}
END_TEST

static Suite *suite(void)
{
	Suite *s = suite_create("h5");
	TCase *c = tcase_create("h5");
	tcase_add_checked_fixture(c, make_dir, remove_dir);
	tcase_set_timeout(c, 60);
	tcase_add_test(c, blocks_of_every_scalar_come_back);
	tcase_add_test(c, what_is_written_is_documented_and_can_be_mapped);
	tcase_add_test(c, same_contents_same_bytes);
	tcase_add_test(c, attributes_and_lists_come_back);
	tcase_add_test(c, numbers_of_any_type_are_converted);
	tcase_add_test(c, refusals_name_file_and_dataset);
	tcase_add_test(c, a_dataset_over_the_memory_limit_is_refused);
	tcase_add_test(c, values_in_another_file_are_not_followed);
	tcase_add_test(c, what_hdf5_would_trust_too_much);
	tcase_add_test(c, any_prefix_of_a_file_is_refused_or_read);
	tcase_add_loop_test(c, a_full_disk_leaves_the_old_file, 0, 2);
	tcase_add_test(c, giving_up_leaves_nothing);
	tcase_add_test(c, every_allocation_may_fail);
	tcase_add_test(c, threads_wait_for_each_other);
	tcase_add_test(c, the_callers_error_handler_is_left_alone);
	suite_add_tcase(s, c);
	return s;
}

int main(void) { return run_suite(suite()); }
