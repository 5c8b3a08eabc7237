/* SPDX-License-Identifier: BSD-3-Clause */
/* Image files: round trips, files of other programs, malformed files, stacks. */
#include "near.h"
#include "optla/image.h"

#include <stdio.h>
#include <unistd.h>

static const char *temporary(const char *name)
{
	static char path[256];
	const char *dir = getenv("TMPDIR");
	snprintf(path, sizeof path, "%s/optla-%ld-%s", dir ? dir : "/tmp", (long)getpid(), name);
	return path;
}

static optla_image *pattern(optla_ctx *ctx, size_t w, size_t h, size_t c, optla_image_kind kind)
{
	optla_image *m;
	ok(optla_image_create(ctx, w, h, c, kind, &m));
	uint32_t v = 12345;
	for (size_t k = 0; k < w * h * c; k++) {
		v = v * 1664525u + 1013904223u;
		if (0 == c % 2 && k % c == c - 1)
			m->data[k] = OPTLA_IMAGE_RAW_DN == kind ? (float)(v >> 16) / 65535 : (float)(v >> 24) / 255;
		else
			m->data[k] = OPTLA_IMAGE_RAW_DN == kind    ? (float)(v >> 16)
			             : OPTLA_IMAGE_DISPLAY == kind ? (float)(v >> 24) / 255
			                                           : ((float)(v >> 8) - 3e6f) * 1e-5f;
	}
	if (OPTLA_IMAGE_RAW_DN == kind) m->white_dn = 4095;
	return m;
}

static void round_trip(const char *ending, optla_image_kind kind, size_t channels)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	optla_image *m = pattern(ctx, 17, 9, channels, kind), *back;
	const char *path = temporary(ending);
	ok(optla_image_save(m, path));
	ok(optla_image_load(ctx, path, &back));
	ck_assert_uint_eq(back->width, 17);
	ck_assert_uint_eq(back->height, 9);
	ck_assert_uint_eq(back->channels, channels);
	ck_assert_int_eq(back->kind, kind);
	ck_assert_double_eq(back->white_dn, m->white_dn);
	ck_assert_mem_eq(back->data, m->data, 17 * 9 * channels * sizeof(float));
	unlink(path);
	optla_image_destroy(&m);
	optla_image_destroy(&back);
	optla_ctx_destroy(&ctx);
}

START_TEST(png_round_trip)
{
	round_trip("a.png", OPTLA_IMAGE_RAW_DN, (size_t)_i);
	round_trip("a.png", OPTLA_IMAGE_DISPLAY, (size_t)_i);
}
END_TEST

START_TEST(exr_round_trip)
{
	round_trip("a.exr", OPTLA_IMAGE_LINEAR, (size_t)_i);
	round_trip("a.exr", OPTLA_IMAGE_RAW_DN, (size_t)_i);
	round_trip("a.exr", OPTLA_IMAGE_DISPLAY, (size_t)_i);
}
END_TEST

START_TEST(tiff_round_trip)
{
	round_trip("a.tif", OPTLA_IMAGE_LINEAR, (size_t)_i);
	round_trip("a.tiff", OPTLA_IMAGE_RAW_DN, (size_t)_i);
	round_trip("a.TIF", OPTLA_IMAGE_DISPLAY, (size_t)_i);
}
END_TEST

START_TEST(pfm_round_trip)
{
	round_trip("a.pfm", OPTLA_IMAGE_LINEAR, 1);
	round_trip("a.pfm", OPTLA_IMAGE_LINEAR, 3);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("image_files");
	TCase *t = tcase_create("image_files");
	tcase_set_timeout(t, 60);
	tcase_add_loop_test(t, png_round_trip, 1, 5);
	tcase_add_loop_test(t, exr_round_trip, 1, 5);
	tcase_add_loop_test(t, tiff_round_trip, 1, 5);
	tcase_add_test(t, pfm_round_trip);
	suite_add_tcase(s, t);
	return run_suite(s);
}
