/* SPDX-License-Identifier: BSD-3-Clause */
/* Files that are cut off, damaged or lie about their size; disks that don't take them; memory that runs out. */
#include "pictures.h"

#include <dirent.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

/* One or more files of each way through the readers; none with a second picture behind the first, which isn't read and may be cut. */
static const char *const files[] = {
    "grey1.png",
    "grey16.png",
    "rgb16-interlaced.png",
    "palette2-alpha.png",
    "rgb16-transparent.png",
    "grey-big.pfm",
    "rgb-little.pfm",
    "rgb-float-plain.exr",
    "rgb-half-rle.exr",
    "rgb-half-zip.exr",
    "rgb-half-piz.exr",
    "rgb-half-pxr24.exr",
    "rgb-half-tiles.exr",
    "rgba-layers.exr",
    "window-cut.exr",
    "deep.exr",
    "rgb8.tif",
    "grey16-big.tif",
    "rgb16-deflate.tif",
    "rgb-float-planes.tif",
    "rgb16-bigtiff.tif",
    "rgb-float-big-tiles.tif",
    "rgb16-lzw.tif",
    "rgb8-packbits.tif",
    "rgb16.npy",
    "grey8.npy",
    "rgb-float-fortran.npy",
    "bayer.dng",
};
enum { FILES = sizeof files / sizeof *files };

static optla_ctx *small_ctx(error_store *e)
{
	optla_ctx *ctx;
	const optla_ctx_desc d = {
	    .size = sizeof d, .error = error_keep, .error_user = e, .threads = 1, .memory_limit_bytes = 16 << 20};
	ok(optla_ctx_create(&ctx, &d));
	return ctx;
}

/* Decodes the bytes from a block of exactly that size, so that the sanitizer sees every read outside. */
static optla_status decode(optla_ctx *ctx, const void *bytes, size_t count, const char *name)
{
	optla_image *m = NULL;
	uint8_t *exact = malloc(count ? count : 1);
	memcpy(exact, bytes, count);
	const optla_status status = optla_image_decode(ctx, exact, count, name, &m);
	ck_assert((OPTLA_OK == status) == (NULL != m));
	optla_image_destroy(&m);
	free(exact);
	return status;
}

static void cut_everywhere(const uint8_t *bytes, size_t count, const char *name)
{
	error_store e = {0};
	optla_ctx *ctx = small_ctx(&e);
	for (size_t n = 0; n < count; n++) {
		e.count = 0;
		const optla_status status = decode(ctx, bytes, n, name);
		/* A deep image is refused as such as soon as its header is whole. */
		ck_assert_msg(OPTLA_ERR_INPUT == status || (OPTLA_ERR_UNSUPPORTED == status && !strcmp(name, "deep.exr")),
		              "%s cut to %zu of %zu bytes: %s", name, n, count, optla_status_name(status));
		ck_assert_msg(1 == e.count && !strncmp(e.text, name, strlen(name)), "%s cut to %zu bytes: %d errors, '%s'", name, n,
		              e.count, e.text);
	}
	optla_ctx_destroy(&ctx);
}

START_TEST(every_shorter_file_is_an_error)
{
	size_t count;
	void *bytes = golden(files[_i], &count);
	cut_everywhere(bytes, count, files[_i]);
	free(bytes);
}
END_TEST

START_TEST(every_shorter_file_of_our_own_is_an_error)
{
	static const char *const names[] = {"c.png", "c.tif", "c.exr", "c.pfm", "c.npy"};
	optla_ctx *ctx = test_ctx(NULL, 1);
	for (size_t k = 0; k < 5; k++) {
		const char *path = temporary(names[k]);
		size_t count;
		optla_image *m = picture(ctx, 9, 20, 3, 0 == k ? OPTLA_IMAGE_RAW_DN : OPTLA_IMAGE_LINEAR);
		ok(optla_image_save(m, path));
		void *bytes = whole_file(path, &count);
		cut_everywhere(bytes, count, names[k]);
		free(bytes);
		unlink(path);
		optla_image_destroy(&m);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(a_png_chunk_is_no_longer_than_the_file)
{
	/* libpng would take the 2 GiB that a text claims before it looks whether they are there. */
	error_store e = {0};
	optla_ctx *ctx = small_ctx(&e);
	size_t count;
	uint8_t *bytes = golden("grey8.png", &count);
	memcpy(bytes + 33, "\x7e\0\0\0tEXt", 8); /* behind the signature and IHDR */
	status_is(decode(ctx, bytes, count, "grey8.png"), OPTLA_ERR_INPUT);
	char wanted[128];
	snprintf(wanted, sizeof wanted, "grey8.png: PNG: a chunk of 2113929216 bytes, of which %zu are there", count - 45);
	ck_assert_str_eq(e.text, wanted);
	free(bytes);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* Any byte changed to some other values: no crash and no read outside (under the sanitizer); PNG notices every change. */
START_TEST(damaged_bytes_do_no_harm)
{
	static const uint8_t changes[] = {0x01, 0x80, 0xff};
	error_store e = {0};
	optla_ctx *ctx = small_ctx(&e);
	size_t count, noticed = 0;
	uint8_t *bytes = golden(files[_i], &count);
	const bool png = strstr(files[_i], ".png");
	for (size_t n = 0; n < count; n++)
		for (size_t k = 0; k < sizeof changes; k++) {
			bytes[n] ^= changes[k];
			const optla_status status = decode(ctx, bytes, count, files[_i]);
			noticed += OPTLA_OK != status;
			ck_assert_msg(!png || status, "%s: byte %zu changed by %02x was not noticed", files[_i], n, changes[k]);
			bytes[n] ^= changes[k];
		}
	ck_assert_uint_gt(noticed, 0);
	free(bytes);
	optla_ctx_destroy(&ctx);
}
END_TEST

static void must_refuse(optla_ctx *ctx, error_store *e, const void *bytes, size_t count, const char *name, const char *message)
{
	e->count = 0;
	status_is(decode(ctx, bytes, count, name), OPTLA_ERR_INPUT);
	ck_assert_int_eq(e->count, 1);
	ck_assert_msg(NULL != strstr(e->text, message), "%s: '%s' has no '%s'", name, e->text, message);
}

static void big_endian(uint8_t *to, uint32_t value)
{
	for (int k = 0; k < 4; k++) to[k] = (uint8_t)(value >> (24 - 8 * k));
}

/* The checksum of PNG, ISO/IEC 15948 annex D. */
static uint32_t crc_of(const uint8_t *bytes, size_t count)
{
	uint32_t crc = 0xffffffff;
	for (size_t k = 0; k < count; k++) {
		crc ^= bytes[k];
		for (int bit = 0; bit < 8; bit++) crc = crc & 1 ? 0xedb88320 ^ crc >> 1 : crc >> 1;
	}
	return ~crc;
}

static void huge_png(optla_ctx *ctx, error_store *e, uint32_t width, uint32_t height, const char *message)
{
	size_t count;
	uint8_t *bytes = golden("rgb16.png", &count);
	big_endian(bytes + 16, width);
	big_endian(bytes + 20, height);
	big_endian(bytes + 29, crc_of(bytes + 12, 17));
	must_refuse(ctx, e, bytes, count, "huge.png", message);
	free(bytes);
}

/* The position of a run of bytes. */
static size_t find(const uint8_t *bytes, size_t count, const void *what, size_t n)
{
	for (size_t k = 0; k + n <= count; k++)
		if (!memcmp(bytes + k, what, n)) return k;
	ck_abort_msg("not found");
	return 0;
}

static void huge_exr(optla_ctx *ctx, error_store *e, const char *name, int32_t x, int32_t y, const char *message)
{
	size_t count;
	uint8_t *bytes = golden(name, &count);
	const int32_t corner[2] = {x, y};
	static const char *const windows[] = {"dataWindow", "displayWindow"};
	for (int k = 0; k < 2; k++) {
		const size_t at = find(bytes, count, windows[k], strlen(windows[k])) + strlen(windows[k]) + 1 + 6 + 4;
		memcpy(bytes + at + 8, corner, sizeof corner);
	}
	must_refuse(ctx, e, bytes, count, name, message);
	free(bytes);
}

START_TEST(sizes_that_cannot_be_are_refused_before_memory_is_taken)
{
	error_store e = {0};
	optla_ctx *ctx = small_ctx(&e);
	huge_png(ctx, &e, 0x7fffffff, 0x7fffffff, "over the memory limit");
	huge_png(ctx, &e, 4000, 4000, "4000 x 4000 x 3");
	huge_png(ctx, &e, 0, 4, "PNG");
	huge_png(ctx, &e, 0x80000000, 1, "PNG");
	huge_png(ctx, &e, 8, 5, "PNG"); /* a little larger than its data */
	huge_exr(ctx, &e, "rgb-float-plain.exr", 0x7ffffffe, 0x7ffffffe, "OpenEXR");
	huge_exr(ctx, &e, "rgb-half-tiles.exr", 100000, 100000, "OpenEXR");
	huge_exr(ctx, &e, "rgb-half-zip.exr", -5, 4, "OpenEXR");
	const char pfm[] = "PF\n4294967295 4294967295\n-1.0\n12345678";
	must_refuse(ctx, &e, pfm, sizeof pfm - 1, "huge.pfm", "4294967295 x 4294967295");
	const char pfm_sign[] = "PF\n-1 1\n-1.0\n", pfm_scale[] = "PF\n1 1\n0\n123456789012", pfm_more[] = "Pf\n1 1\n1\n12345";
	must_refuse(ctx, &e, pfm_sign, sizeof pfm_sign - 1, "sign.pfm", "width in the header is '-1'");
	must_refuse(ctx, &e, pfm_scale, sizeof pfm_scale - 1, "scale.pfm", "scale in the header is '0'");
	must_refuse(ctx, &e, pfm_more, sizeof pfm_more - 1, "more.pfm", "need 4 bytes behind the header, there are 5");
	must_refuse(ctx, &e, "", 0, "nothing", "empty");
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(tiff_sizes_that_cannot_be_are_refused)
{
	error_store e = {0};
	optla_ctx *ctx = small_ctx(&e);
	size_t count;
	/* Tag 256 (width), LONG or SHORT, one value: the entry's last four bytes. */
	uint8_t *bytes = golden("rgb8.tif", &count);
	const uint8_t entry[2] = {0x00, 0x01};
	const size_t at = find(bytes + 8, count - 8, entry, 2) + 8;
	const uint32_t huge[] = {0x7fffffff, 0xffffffff, 5000000, 0};
	for (size_t k = 0; k < 4; k++) {
		bytes[at + 2] = 4;
		memcpy(bytes + at + 8, &huge[k], 4);
		must_refuse(ctx, &e, bytes, count, "huge.tif", "huge.tif");
	}
	free(bytes);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- writing where it can't be done ---- */

static int entries(const char *dir)
{
	int n = 0;
	DIR *d = opendir(dir);
	ck_assert_ptr_nonnull(d);
	while (readdir(d)) n++;
	closedir(d);
	return n - 2;
}

START_TEST(no_file_is_left_where_writing_fails)
{
	static const char *const names[] = {"full.png", "full.tif", "full.exr", "full.pfm", "full.npy"};
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	char dir[] = "/tmp/optla-full-XXXXXX", path[64];
	ck_assert_ptr_nonnull(mkdtemp(dir));
	signal(SIGXFSZ, SIG_IGN); /* a write over the limit then fails with EFBIG, as one to a full disk does with ENOSPC */
	const struct rlimit limit = {.rlim_cur = 2000, .rlim_max = RLIM_INFINITY};
	optla_image *linear = picture(ctx, 40, 40, 3, OPTLA_IMAGE_LINEAR), *raw = picture(ctx, 40, 40, 3, OPTLA_IMAGE_RAW_DN);
	for (int k = 0; k < 5; k++) {
		snprintf(path, sizeof path, "%s/%s", dir, names[k]);
		ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &limit), 0);
		status_is(optla_image_save(k ? linear : raw, path), OPTLA_ERR_IO);
		ck_assert_ptr_nonnull(strstr(e.text, names[k]));
		ck_assert_int_eq(entries(dir), 0);
	}
	status_is(optla_image_save(linear, "/proc/optla.exr"), OPTLA_ERR_IO); /* not even root may make a file there */
	snprintf(path, sizeof path, "%s/no/such/a.exr", dir);
	status_is(optla_image_save(linear, path), OPTLA_ERR_IO);
	ck_assert_int_eq(entries(dir), 0);
	optla_image_destroy(&linear);
	optla_image_destroy(&raw);
	rmdir(dir);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(the_old_file_stays_where_writing_fails)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	const char *path = temporary("old.exr");
	optla_image *small = picture(ctx, 2, 2, 1, OPTLA_IMAGE_LINEAR), *large = picture(ctx, 60, 60, 3, OPTLA_IMAGE_LINEAR), *back;
	ok(optla_image_save(small, path));
	signal(SIGXFSZ, SIG_IGN);
	const struct rlimit limit = {.rlim_cur = 2000, .rlim_max = RLIM_INFINITY};
	ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &limit), 0);
	status_is(optla_image_save(large, path), OPTLA_ERR_IO);
	ok(optla_image_load(ctx, path, &back));
	ck_assert_uint_eq(back->width, 2);
	ck_assert_mem_eq(back->data, small->data, 4 * sizeof(float));
	unlink(path);
	optla_image_destroy(&small);
	optla_image_destroy(&large);
	optla_image_destroy(&back);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- memory that runs out ---- */

/* True while the allocation numbered k is still one of those made. */
static bool fails_well(long k, const char *load, const char *save, optla_image_kind kind)
{
	alloc_budget b = {.left = k + 1};
	const optla_ctx_desc d = {.size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b, .threads = 1};
	optla_ctx *ctx;
	optla_image *m = NULL;
	optla_status s = OPTLA_OK;
	ok(optla_ctx_create(&ctx, &d));
	if (load) {
		s = optla_image_load(ctx, load, &m);
	} else {
		s = optla_image_create(ctx, 30, 30, 3, kind, &m);
		if (!s) s = optla_image_save(m, save);
	}
	/* That a file was read is noted where there is memory for it; without the note all goes on. */
	ck_assert_msg(OPTLA_OK == s || OPTLA_ERR_NOMEM == s, "%s, allocation %ld: %s", load ? load : save, k,
	              optla_ctx_last_error(ctx));
	optla_image_destroy(&m);
	optla_ctx_destroy(&ctx);
	ck_assert_int_eq(b.live, 0);
	if (b.left >= 0) ck_assert_int_eq(s, OPTLA_OK);
	return b.left < 0;
}

START_TEST(every_allocation_of_loading_may_fail)
{
	char path[1024];
	snprintf(path, sizeof path, "%s/tests/golden/%s", OPTLA_SOURCE_ROOT, files[_i]);
	if (!strcmp(files[_i], "deep.exr")) return;
	long k = 0;
	while (fails_well(k, path, NULL, OPTLA_IMAGE_LINEAR)) k++;
	ck_assert_int_ge(k, 3); /* at least the bytes, the image and its samples */
}
END_TEST

START_TEST(every_allocation_of_saving_may_fail)
{
	static const struct {
		const char *name;
		optla_image_kind kind;
	} cases[] = {{"m.png", OPTLA_IMAGE_RAW_DN}, {"m.png", OPTLA_IMAGE_DISPLAY}, {"m.tif", OPTLA_IMAGE_LINEAR},
	             {"m.tif", OPTLA_IMAGE_RAW_DN}, {"m.exr", OPTLA_IMAGE_LINEAR},  {"m.pfm", OPTLA_IMAGE_LINEAR},
	             {"m.npy", OPTLA_IMAGE_LINEAR}, {"m.npy", OPTLA_IMAGE_DISPLAY}};
	for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
		const char *path = temporary(cases[c].name);
		long k = 0;
		while (fails_well(k, NULL, path, cases[c].kind)) k++;
		ck_assert_int_ge(k, 4);
		unlink(path);
	}
}
END_TEST

int main(void)
{
	Suite *s = suite_create("image_broken");
	TCase *t = tcase_create("image_broken");
	tcase_set_timeout(t, 120);
	tcase_add_loop_test(t, every_shorter_file_is_an_error, 0, FILES);
	tcase_add_test(t, every_shorter_file_of_our_own_is_an_error);
	tcase_add_test(t, a_png_chunk_is_no_longer_than_the_file);
	tcase_add_loop_test(t, damaged_bytes_do_no_harm, 0, FILES);
	tcase_add_test(t, sizes_that_cannot_be_are_refused_before_memory_is_taken);
	tcase_add_test(t, tiff_sizes_that_cannot_be_are_refused);
	tcase_add_test(t, no_file_is_left_where_writing_fails);
	tcase_add_test(t, the_old_file_stays_where_writing_fails);
	tcase_add_loop_test(t, every_allocation_of_loading_may_fail, 0, FILES);
	tcase_add_test(t, every_allocation_of_saving_may_fail);
	suite_add_tcase(s, t);
	return run_suite(s);
}
