/* SPDX-License-Identifier: BSD-3-Clause */
/* Image files: what is written is read back to the bit; files of other programs hold what their formulas say (tests/golden/make.py). */
#include "pictures.h"

/* ---- round trips ---- */

static void round_trip(const char *ending, optla_image_kind kind, size_t channels, double white_dn)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	ok(optla_ctx_set_provenance(ctx, "optla test 'ä ö' --x", 5, "2026-01-01"));
	optla_image *m = picture(ctx, 17, 9, channels, kind), *back;
	const char *path = temporary(ending);
	if (OPTLA_IMAGE_RAW_DN == kind) m->white_dn = white_dn;
	ok(optla_image_save(m, path));
	ok(optla_image_load(ctx, path, &back));
	ck_assert_uint_eq(back->width, 17);
	ck_assert_uint_eq(back->height, 9);
	ck_assert_uint_eq(back->channels, channels);
	ck_assert_int_eq(back->kind, kind);
	ck_assert_double_eq(back->white_dn, m->white_dn);
	ck_assert_mem_eq(back->data, m->data, 17 * 9 * channels * sizeof(float));
	ck_assert_int_eq(e.count, 0);
	unlink(path);
	optla_image_destroy(&m);
	optla_image_destroy(&back);
	optla_ctx_destroy(&ctx);
}

START_TEST(png_round_trip)
{
	round_trip("a.png", OPTLA_IMAGE_RAW_DN, (size_t)_i, 4095.5);
	round_trip("a.PNG", OPTLA_IMAGE_DISPLAY, (size_t)_i, 0);
}
END_TEST

START_TEST(tiff_round_trip)
{
	round_trip("a.tif", OPTLA_IMAGE_LINEAR, (size_t)_i, 0);
	round_trip("a.tiff", OPTLA_IMAGE_RAW_DN, (size_t)_i, 16383);
	round_trip("a.TIF", OPTLA_IMAGE_DISPLAY, (size_t)_i, 0);
}
END_TEST

START_TEST(exr_round_trip)
{
	round_trip("a.exr", OPTLA_IMAGE_LINEAR, (size_t)_i, 0);
	round_trip("a.exr", OPTLA_IMAGE_RAW_DN, (size_t)_i, 1e-3);
	round_trip("a.exr", OPTLA_IMAGE_DISPLAY, (size_t)_i, 0);
}
END_TEST

START_TEST(npy_round_trip)
{
	round_trip("a.npy", OPTLA_IMAGE_LINEAR, (size_t)_i, 0);
	round_trip("a.npy", OPTLA_IMAGE_RAW_DN, (size_t)_i, 65535); /* has no room for another white level */
	round_trip("a.npy", OPTLA_IMAGE_DISPLAY, (size_t)_i, 0);
}
END_TEST

START_TEST(pfm_round_trip)
{
	round_trip("a.pfm", OPTLA_IMAGE_LINEAR, 1, 0);
	round_trip("a.pfm", OPTLA_IMAGE_LINEAR, 3, 0);
}
END_TEST

START_TEST(floats_keep_infinity_and_nan)
{
	static const char *const names[] = {"f.exr", "f.tif", "f.pfm", "f.npy"};
	const float odd[6] = {INFINITY, -INFINITY, NAN, -0.0f, 1e-42f, 3.4e38f}; /* also a denormal and nearly the largest */
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_image *m, *back;
	ok(optla_image_create(ctx, 6, 1, 1, OPTLA_IMAGE_LINEAR, &m));
	memcpy(m->data, odd, sizeof odd);
	for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
		const char *path = temporary(names[k]);
		ok(optla_image_save(m, path));
		ok(optla_image_load(ctx, path, &back));
		ck_assert_mem_eq(back->data, odd, sizeof odd);
		optla_image_destroy(&back);
		unlink(path);
	}
	optla_image_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

static bool contains(const char *bytes, size_t count, const char *text)
{
	const size_t n = strlen(text);
	for (size_t k = 0; k + n <= count; k++)
		if (!memcmp(bytes + k, text, n)) return true;
	return false;
}

START_TEST(provenance_is_in_the_file)
{
	static const char *const names[] = {"p.png", "p.tif", "p.exr"};
	optla_ctx *ctx = test_ctx(NULL, 1);
	ok(optla_ctx_set_provenance(ctx, "optla provenance-test", 77, NULL));
	optla_image *m = picture(ctx, 3, 2, 1, OPTLA_IMAGE_RAW_DN);
	for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
		const char *path = temporary(names[k]);
		size_t count;
		ok(optla_image_save(m, path));
		char *bytes = whole_file(path, &count);
		ck_assert_msg(contains(bytes, count, "command: optla provenance-test\n") && contains(bytes, count, "seed: 77\n"),
		              "%s has no provenance", path);
		free(bytes);
		unlink(path);
	}
	optla_image_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- golden files: 7 x 5 pixels of a formula ---- */

enum { W = 7, H = 5 };

static double u8(int x, int y, int c) { return (37 * x + 59 * y + 101 * c + 3) % 256; }
static double u16(int x, int y, int c) { return (4801 * x + 9973 * y + 21001 * c + 77) % 65536; }
static double half(int x, int y, int c) { return (x + 8 * y + 40 * c - 60) / 4.0; }
static double bits1(int x, int y, int c) { return (int)u8(x, y, c) % 2; }
static double bits2(int x, int y, int c) { return (int)u8(x, y, c) % 4 / 3.0; }
static double bits4(int x, int y, int c) { return (int)u8(x, y, c) % 16 / 15.0; }
static double display(int x, int y, int c) { return u8(x, y, c) / 255; }
static double negative(int x, int y, int c) { return 1 - u8(x, y, c) / 255; }
static double grey_alpha(int x, int y, int c) { return 1 == c ? u16(x, y, 1) / 65535 : u16(x, y, c); }
static double colour_alpha(int x, int y, int c) { return 3 == c ? u16(x, y, 3) / 65535 : u16(x, y, c); }
static double layers(int x, int y, int c) { return 3 == c ? 0.25 : half(x, y, c); }
static double scaled(int x, int y, int c) { return u16(x, y, c) * 65537; }
static double transparent(int x, int y, int c)
{
	return 3 == c ? !(2 == x && 1 == y) : u16(x, y, c); /* the formula has no second pixel of that colour */
}
static double palette(int x, int y, int c)
{
	const int index = (x + y) % 4;
	return 3 == c ? (1 == index ? 128 / 255.0 : 1) : u8(index, 0, c) / 255;
}

typedef struct {
	const char *name;
	size_t channels;
	optla_image_kind kind;
	double (*sample)(int x, int y, int c);
} golden_image;

static const golden_image goldens[] = {
    {"grey1.png", 1, OPTLA_IMAGE_DISPLAY, bits1},
    {"grey2.png", 1, OPTLA_IMAGE_DISPLAY, bits2},
    {"grey4.png", 1, OPTLA_IMAGE_DISPLAY, bits4},
    {"grey8.png", 1, OPTLA_IMAGE_DISPLAY, display},
    {"grey16.png", 1, OPTLA_IMAGE_RAW_DN, u16},
    {"rgb8-interlaced.png", 3, OPTLA_IMAGE_DISPLAY, display},
    {"rgb16.png", 3, OPTLA_IMAGE_RAW_DN, u16},
    {"rgb16-interlaced.png", 3, OPTLA_IMAGE_RAW_DN, u16},
    {"grey-alpha16.png", 2, OPTLA_IMAGE_RAW_DN, grey_alpha},
    {"rgba8.png", 4, OPTLA_IMAGE_DISPLAY, display},
    {"palette2-alpha.png", 4, OPTLA_IMAGE_DISPLAY, palette},
    {"rgb16-transparent.png", 4, OPTLA_IMAGE_RAW_DN, transparent},
    {"grey-big.pfm", 1, OPTLA_IMAGE_LINEAR, half},
    {"rgb-little.pfm", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgb-float-plain.exr", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgb-float-piz.exr", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgb-half-none.exr", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgb-half-rle.exr", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgb-half-zips.exr", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgb-half-zip.exr", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgb-half-piz.exr", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgb-half-pxr24.exr", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgb-half-tiles.exr", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgba-layers.exr", 4, OPTLA_IMAGE_LINEAR, layers},
    {"y-half.exr", 1, OPTLA_IMAGE_LINEAR, half},
    {"y-uint.exr", 1, OPTLA_IMAGE_LINEAR, scaled},
    {"two-parts.exr", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgb8.tif", 3, OPTLA_IMAGE_DISPLAY, display},
    {"grey16-big.tif", 1, OPTLA_IMAGE_RAW_DN, u16},
    {"grey8-white.tif", 1, OPTLA_IMAGE_DISPLAY, negative},
    {"rgb16-deflate.tif", 3, OPTLA_IMAGE_RAW_DN, u16},
    {"rgba16.tif", 4, OPTLA_IMAGE_RAW_DN, colour_alpha},
    {"rgb-float-planes.tif", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgb16-bigtiff.tif", 3, OPTLA_IMAGE_RAW_DN, u16},
    {"grey16-tiles.tif", 1, OPTLA_IMAGE_RAW_DN, u16},
    {"rgb-float-big-tiles.tif", 3, OPTLA_IMAGE_LINEAR, half},
    {"rgb16-lzw.tif", 3, OPTLA_IMAGE_RAW_DN, u16},
    {"rgb8-make.tif", 3, OPTLA_IMAGE_DISPLAY, display},
    {"rgb8-packbits.tif", 3, OPTLA_IMAGE_DISPLAY, display},
    {"rgb16.npy", 3, OPTLA_IMAGE_RAW_DN, u16},
    {"grey8.npy", 1, OPTLA_IMAGE_DISPLAY, display},
    {"rgb-float-fortran.npy", 3, OPTLA_IMAGE_LINEAR, half},
    {"grey-double-big.npy", 1, OPTLA_IMAGE_LINEAR, half},
};
enum { GOLDENS = sizeof goldens / sizeof *goldens };

START_TEST(files_of_other_programs_are_understood)
{
	const golden_image *g = &goldens[_i];
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	optla_image *m;
	size_t count;
	void *bytes = golden(g->name, &count);
	const optla_status status = optla_image_decode(ctx, bytes, count, g->name, &m);
	ck_assert_msg(OPTLA_OK == status, "%s: %s", g->name, e.text);
	free(bytes);
	ck_assert_msg(W == m->width && H == m->height && g->channels == m->channels, "%s: %zu x %zu x %zu", g->name, m->width,
	              m->height, m->channels);
	ck_assert_int_eq(m->kind, g->kind);
	ck_assert_double_eq(m->white_dn, OPTLA_IMAGE_RAW_DN == g->kind ? 65535 : 0);
	const int channels = (int)g->channels;
	for (int k = 0; k < W * H * channels; k++) {
		const int x = k / channels % W, y = k / channels / W, c = k % channels;
		const float wanted = (float)g->sample(x, y, c);
		ck_assert_msg(m->data[k] == wanted, "%s: sample (%d, %d, %d) is %.9g, not %.9g", g->name, x, y, c, (double)m->data[k],
		              (double)wanted);
	}
	optla_image_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

static optla_image *decode_golden(optla_ctx *ctx, const char *name, optla_status wanted)
{
	size_t count;
	optla_image *m = (optla_image *)&count;
	void *bytes = golden(name, &count);
	status_is(optla_image_decode(ctx, bytes, count, name, &m), wanted);
	if (wanted) ck_assert_ptr_null(m);
	free(bytes);
	return m;
}

START_TEST(exr_windows_place_the_picture)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_image *m = decode_golden(ctx, "window-inside.exr", OPTLA_OK);
	ck_assert(10 == m->width && 8 == m->height);
	for (int y = 0; y < 8; y++)
		for (int x = 0; x < 10; x++)
			for (int c = 0; c < 3; c++) {
				const bool in = x >= 2 && x < 2 + W && y >= 1 && y < 1 + H;
				ck_assert(m->data[(y * 10 + x) * 3 + c] == (in ? (float)half(x - 2, y - 1, c) : 0));
			}
	optla_image_destroy(&m);
	m = decode_golden(ctx, "window-cut.exr", OPTLA_OK);
	ck_assert(4 == m->width && 3 == m->height);
	for (int y = 0; y < 3; y++)
		for (int x = 0; x < 4; x++)
			for (int c = 0; c < 3; c++) ck_assert(m->data[(y * 4 + x) * 3 + c] == (float)half(x + 1, y + 1, c));
	optla_image_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(what_cannot_be_an_image_is_said)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	decode_golden(ctx, "z-only.exr", OPTLA_ERR_INPUT);
	ck_assert_str_eq(e.text, "z-only.exr: OpenEXR: neither R, G, B nor Y is among its channels (Z)");
	decode_golden(ctx, "deep.exr", OPTLA_ERR_UNSUPPORTED);
	ck_assert_str_eq(e.text, "deep.exr: OpenEXR: deep images can't be read");
	decode_golden(ctx, "int32.tif", OPTLA_ERR_INPUT);
	ck_assert_ptr_nonnull(strstr(e.text, "int32.tif: TIFF: 32 bits of sample format 2"));
	decode_golden(ctx, "int64.npy", OPTLA_ERR_INPUT);
	ck_assert_ptr_nonnull(strstr(e.text, "items of type 'i8'"));
	decode_golden(ctx, "make.py", OPTLA_ERR_INPUT);
	ck_assert_ptr_nonnull(strstr(e.text, "make.py is not an image"));
	ck_assert_int_eq(e.count, 5); /* each is told once */
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- camera RAW ---- */

enum { RAW_W = 28, RAW_H = 24 };

static double raw_count(int x, int y) { return 512 + (int)u16(x, y, 0) % 15000; }

/* RGGB */
static int filter_at(int x, int y) { return y % 2 + x % 2; }

START_TEST(camera_raw_is_counts_with_the_missing_colours_interpolated)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_image *m = decode_golden(ctx, "bayer.dng", OPTLA_OK);
	ck_assert(RAW_W == m->width && RAW_H == m->height && 3 == m->channels);
	ck_assert_int_eq(m->kind, OPTLA_IMAGE_RAW_DN);
	ck_assert_double_eq(m->white_dn, 16000);
	for (int y = 1; y < RAW_H - 1; y++)
		for (int x = 1; x < RAW_W - 1; x++) {
			double cross = 0, diagonal = 0;
			for (int d = -1; d <= 1; d += 2) {
				cross += (raw_count(x + d, y) + raw_count(x, y + d)) / 4;
				diagonal += (raw_count(x + d, y + d) + raw_count(x + d, y - d)) / 4;
			}
			const double beside = (raw_count(x - 1, y) + raw_count(x + 1, y)) / 2,
			             above = (raw_count(x, y - 1) + raw_count(x, y + 1)) / 2;
			const double own = raw_count(x, y);
			const float *rgb = m->data + (y * RAW_W + x) * 3;
			/* Bilinear interpolation for each of the four places in the pattern. */
			const bool red_row = 0 == y % 2;
			const double wanted[3] = {
			    0 == filter_at(x, y)   ? own
			    : 2 == filter_at(x, y) ? diagonal
			    : red_row              ? beside
			                           : above,
			    1 == filter_at(x, y) ? own : cross,
			    2 == filter_at(x, y)   ? own
			    : 0 == filter_at(x, y) ? diagonal
			    : red_row              ? above
			                           : beside,
			};
			for (int c = 0; c < 3; c++) near_rel(rgb[c], wanted[c], 6e-8); /* one rounding to float */
		}
	/* The corner has its own count, the mean of its two green neighbours, and the only blue one. */
	near_rel(m->data[0], raw_count(0, 0), 0);
	near_rel(m->data[1], (raw_count(1, 0) + raw_count(0, 1)) / 2, 6e-8);
	near_rel(m->data[2], raw_count(1, 1), 0);
	optla_image_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- types, endings, real photos ---- */

START_TEST(types_are_found_from_the_content)
{
	static const struct {
		const char *name;
		optla_file_type type;
	} known[] = {{"grey1.png", OPTLA_FILE_PNG},       {"rgb8.tif", OPTLA_FILE_TIFF}, {"rgb16-bigtiff.tif", OPTLA_FILE_TIFF},
	             {"grey16-big.tif", OPTLA_FILE_TIFF}, {"deep.exr", OPTLA_FILE_EXR},  {"grey-big.pfm", OPTLA_FILE_PFM},
	             {"grey8.npy", OPTLA_FILE_NPY},       {"bayer.dng", OPTLA_FILE_RAW}, {"make.py", OPTLA_FILE_UNKNOWN},
	             {"missing", OPTLA_FILE_UNKNOWN},     {".", OPTLA_FILE_UNKNOWN}};
	static const struct {
		const char *text;
		optla_file_type type;
	} written[] = {{"# rig\n%YAML 1.2\n---\n\nkind: recorded\n", OPTLA_FILE_YAML},
	               {"{kind: recorded}", OPTLA_FILE_YAML},
	               {"kind:\n  a: 1\n", OPTLA_FILE_YAML},
	               {"a list of words\nb: 1\n", OPTLA_FILE_UNKNOWN},
	               {"http://example.org\n", OPTLA_FILE_UNKNOWN},
	               {"PK\003\004rest", OPTLA_FILE_NPZ},
	               {"\x89HDF\r\n\x1a\n", OPTLA_FILE_HDF5},
	               {"", OPTLA_FILE_UNKNOWN},
	               {"II*", OPTLA_FILE_UNKNOWN}};
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	char path[1024];
	optla_file_type type;
	for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
		snprintf(path, sizeof path, "%s/tests/golden/%s", OPTLA_SOURCE_ROOT, known[k].name);
		const bool bad = k >= sizeof known / sizeof *known - 2;
		status_is(optla_file_type_of(ctx, path, &type), bad ? OPTLA_ERR_INPUT : OPTLA_OK);
		ck_assert_msg(type == known[k].type, "%s: %d", path, (int)type);
	}
	ck_assert_int_eq(e.count, 2);
	for (size_t k = 0; k < sizeof written / sizeof *written; k++) {
		const char *name = temporary("type");
		FILE *f = fopen(name, "wb");
		fwrite(written[k].text, 1, strlen(written[k].text), f);
		fclose(f);
		ok(optla_file_type_of(ctx, name, &type));
		ck_assert_msg(type == written[k].type, "'%s': %d", written[k].text, (int)type);
		unlink(name);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(a_format_says_what_it_cannot_hold)
{
	static const struct {
		const char *name;
		size_t channels;
		optla_image_kind kind;
		float first;
		const char *message;
	} wrong[] = {{"w.jpg", 1, OPTLA_IMAGE_DISPLAY, 0, "the ending says no image format"},
	             {"w", 1, OPTLA_IMAGE_DISPLAY, 0, "the ending says no image format"},
	             {"w.png", 1, OPTLA_IMAGE_LINEAR, 0, ".exr"},
	             {"w.png", 1, OPTLA_IMAGE_RAW_DN, 65536, "sample (0, 0, 0) is 65536"},
	             {"w.png", 1, OPTLA_IMAGE_RAW_DN, -1, "sample (0, 0, 0) is -1"},
	             {"w.png", 1, OPTLA_IMAGE_DISPLAY, NAN, "nan"},
	             {"w.tif", 3, OPTLA_IMAGE_RAW_DN, 1e30f, "w.tif: sample (0, 0, 0) is 1e+30"},
	             {"w.npy", 1, OPTLA_IMAGE_RAW_DN, INFINITY, "can't hold as an integer of 0 to 65535"},
	             {"w.pfm", 2, OPTLA_IMAGE_LINEAR, 0, "1 or 3 channels"},
	             {"w.pfm", 1, OPTLA_IMAGE_DISPLAY, 0, "kind display"}};
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
		optla_image *m;
		ok(optla_image_create(ctx, 2, 2, wrong[k].channels, wrong[k].kind, &m));
		m->data[0] = wrong[k].first;
		const char *path = temporary(wrong[k].name);
		status_is(optla_image_save(m, path), OPTLA_ERR_ARG);
		ck_assert_msg(NULL != strstr(e.text, wrong[k].message), "%s", e.text);
		ck_assert_msg(!strncmp(e.text, path, strlen(path)), "%s", e.text);
		ck_assert_int_ne(access(path, F_OK), 0);
		optla_image_destroy(&m);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(fractions_of_counts_are_rounded)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_image *m, *back;
	ok(optla_image_create(ctx, 4, 1, 1, OPTLA_IMAGE_RAW_DN, &m));
	const float in[4] = {0.4f, 1.6f, -0.4f, 65535.25f}, out[4] = {0, 2, 0, 65535};
	memcpy(m->data, in, sizeof in);
	const char *path = temporary("r.png");
	ok(optla_image_save(m, path));
	ok(optla_image_load(ctx, path, &back));
	ck_assert_mem_eq(back->data, out, sizeof out);
	unlink(path);
	optla_image_destroy(&m);
	optla_image_destroy(&back);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(real_photos_of_the_ball)
{
	const char *dir = OPTLA_SHARED_DATA "/diligent-ball";
	skip_without(dir);
	optla_ctx *ctx = test_ctx(NULL, 2);
	static char paths[96][512];
	const char *list[96];
	optla_image *photos[96];
	for (int k = 0; k < 96; k++) {
		snprintf(paths[k], sizeof paths[k], "%s/%03d.png", dir, k + 1);
		list[k] = paths[k];
	}
	ok(optla_image_load_stack(ctx, list, 96, photos));
	float most = 0;
	for (int k = 0; k < 96; k++) {
		const optla_image *m = photos[k];
		ck_assert(190 == m->width && 190 == m->height && 3 == m->channels && OPTLA_IMAGE_RAW_DN == m->kind);
		ck_assert_double_eq(m->white_dn, 65535);
		for (size_t i = 0; i < 190 * 190 * 3; i++) most = fmaxf(most, m->data[i]);
	}
	ck_assert(65535 == most);
	for (int k = 0; k < 96; k++) optla_image_destroy(&photos[k]);
	optla_ctx_destroy(&ctx);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("image_files");
	TCase *t = tcase_create("image_files");
	tcase_set_timeout(t, 60);
	tcase_add_loop_test(t, png_round_trip, 1, 5);
	tcase_add_loop_test(t, tiff_round_trip, 1, 5);
	tcase_add_loop_test(t, exr_round_trip, 1, 5);
	tcase_add_loop_test(t, npy_round_trip, 1, 5);
	tcase_add_test(t, pfm_round_trip);
	tcase_add_test(t, floats_keep_infinity_and_nan);
	tcase_add_test(t, provenance_is_in_the_file);
	tcase_add_loop_test(t, files_of_other_programs_are_understood, 0, GOLDENS);
	tcase_add_test(t, exr_windows_place_the_picture);
	tcase_add_test(t, what_cannot_be_an_image_is_said);
	tcase_add_test(t, camera_raw_is_counts_with_the_missing_colours_interpolated);
	tcase_add_test(t, types_are_found_from_the_content);
	tcase_add_test(t, a_format_says_what_it_cannot_hold);
	tcase_add_test(t, fractions_of_counts_are_rounded);
	tcase_add_test(t, real_photos_of_the_ball);
	suite_add_tcase(s, t);
	return run_suite(s);
}
