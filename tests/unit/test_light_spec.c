/* SPDX-License-Identifier: BSD-3-Clause */
/* Descriptions of light: every form, and what is said about wrong ones. */
#include "capture/light_spec.h"
#include "near.h"

#include <stdio.h>
#include <unistd.h>

static const double pi = 3.14159265358979323846;

/* Files live in a fresh folder. */
static char folder[64];

static void make_folder(void)
{
	snprintf(folder, sizeof folder, "/tmp/optla-light-XXXXXX");
	ck_assert_ptr_nonnull(mkdtemp(folder));
}

static void remove_folder(void)
{
	char command[128];
	snprintf(command, sizeof command, "rm -rf '%s'", folder);
	ck_assert_int_eq(system(command), 0);
}

static const char *file_of(const char *name)
{
	static char path[256];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	return path;
}

static const char *write_text(const char *name, const char *text)
{
	FILE *f = fopen(file_of(name), "w");
	ck_assert_ptr_nonnull(f);
	fputs(text, f);
	ck_assert_int_eq(fclose(f), 0);
	return file_of(name);
}

static void says(const error_store *e, const char *part)
{
	ck_assert_msg(strstr(e->text, part), "the message '%s' doesn't say '%s'", e->text, part);
}

START_TEST(numbers_and_names)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	const optla_light_layout lights = {.nlights = 4};
	double p[12];
	const double all[] = {1, 1, 1, 1}, two[] = {0, 0, 0.5, 1};
	ok(optla_light_spec_(ctx, &lights, "all", 1, p));
	near_array(p, all, 4, 0);
	ok(optla_light_spec_(ctx, &lights, "light:3,2=0.5", 3, p));
	for (size_t c = 0; c < 3; c++) near_array(p + 4 * c, two, 4, 0);
	ok(optla_light_spec_(ctx, &lights, "light:2=5e-1,3=1", 1, p));
	near_array(p, two, 4, 0);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(wrong_names_are_explained)
{
	const struct {
		const char *spec;
		optla_status code;
		const char *says;
	} cases[] = {{"", OPTLA_ERR_ARG, "no light given: all, light:N"},
	             {"light:", OPTLA_ERR_ARG, "expected the number of a light (0 to 3) at ''"},
	             {"light:4", OPTLA_ERR_ARG, "there is no light 4, they are numbered 0 to 3"},
	             {"light:99999999999999999999", OPTLA_ERR_ARG, "there is no light"},
	             {"light:-1", OPTLA_ERR_ARG, "at '-1'"},
	             {"light:1=", OPTLA_ERR_ARG, "expected the power of light 1 at ''"},
	             {"light:1=-2", OPTLA_ERR_ARG, "light 1 has power -2"},
	             {"light:1=nan", OPTLA_ERR_ARG, "light 1 has power nan"},
	             {"light:1,2,1", OPTLA_ERR_ARG, "light 1 is listed twice"},
	             {"light:1;2", OPTLA_ERR_ARG, "expected ',' or the end at ';2'"},
	             {"point:1", OPTLA_ERR_ARG, "expected point:AZIMUTH,ELEVATION in degrees"},
	             {"point:1,2,3", OPTLA_ERR_ARG, "expected point:AZIMUTH,ELEVATION in degrees"},
	             {"point:1,91", OPTLA_ERR_ARG, "elevation from -90 to 90"},
	             {"point:nan,0", OPTLA_ERR_ARG, "azimuth goes from"},
	             {"point:1,2", OPTLA_ERR_UNSUPPORTED, "'point:' needs the direction of each light"},
	             {"none/such.npy", OPTLA_ERR_INPUT, "'none/such.npy' is no file and no known light: all, light:N"},
	             {"none/such.txt", OPTLA_ERR_INPUT, "such.txt"},
	             {"env:none/such.exr", OPTLA_ERR_INPUT, "such.exr"}};
	error_store e;
	optla_ctx *ctx = test_ctx(&e, 1);
	const optla_light_layout lights = {.nlights = 4};
	double p[4];
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		e = (error_store){0};
		status_is(optla_light_spec_(ctx, &lights, cases[k].spec, 1, p), cases[k].code);
		ck_assert_int_eq(e.count, 1); /* said once, where it was found */
		says(&e, cases[k].says);
	}
	status_is(optla_light_spec_(ctx, &lights, "all", 2, p), OPTLA_ERR_ARG);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(text_files)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	const optla_light_layout lights = {.nlights = 3};
	const double wanted[] = {0.5, 0, 2}, colours[] = {1, 4, 7, 2, 5, 8, 3, 6, 9};
	double p[9];
	ok(optla_light_spec_(ctx, &lights, write_text("a.txt", "# three lights\n0.5\n\n0, # off\n2"), 3, p));
	for (size_t c = 0; c < 3; c++) near_array(p + 3 * c, wanted, 3, 0);
	ok(optla_light_spec_(ctx, &lights, write_text("b.csv", "1,2,3\r\n4,5,6\r\n7,8,9\r\n"), 3, p)); /* R, G, B of each light */
	near_array(p, colours, 9, 0);
	status_is(optla_light_spec_(ctx, &lights, write_text("c.csv", "1,2,3\n4\n"), 1, p), OPTLA_ERR_INPUT);
	says(&e, "c.csv:2: 1 numbers in this line, 3 in those before");
	status_is(optla_light_spec_(ctx, &lights, write_text("c.txt", "1 2\n3 4\n"), 1, p), OPTLA_ERR_INPUT);
	says(&e, "c.txt: holds 4 numbers, wanted 3");
	status_is(optla_light_spec_(ctx, &lights, write_text("d.txt", "1\n2\n"), 1, p), OPTLA_ERR_INPUT);
	says(&e, "d.txt: holds 2 numbers, wanted 3");
	status_is(optla_light_spec_(ctx, &lights, write_text("e.txt", "1\n\n2 lamp\n"), 1, p), OPTLA_ERR_INPUT);
	says(&e, "e.txt:3: 'lamp' is not a finite number");
	status_is(optla_light_spec_(ctx, &lights, write_text("f.txt", "1\n-2\n3\n"), 1, p), OPTLA_ERR_INPUT);
	says(&e, "f.txt: light 1 has power -2: a light's power is a number of at least 0");
	status_is(optla_light_spec_(ctx, &lights, write_text("g.txt", "1 inf 3"), 1, p), OPTLA_ERR_INPUT);
	status_is(optla_light_spec_(ctx, &lights, write_text("h.txt", ""), 1, p), OPTLA_ERR_INPUT);
	status_is(optla_light_spec_(ctx, &lights, write_text("i.xyz", "hello"), 1, p), OPTLA_ERR_INPUT);
	FILE *f = fopen(file_of("z.txt"), "w");
	fwrite("1\n2\0 7\n3\n", 1, 9, f);
	fclose(f);
	status_is(optla_light_spec_(ctx, &lights, file_of("z.txt"), 1, p), OPTLA_ERR_INPUT);
	says(&e, "z.txt:2: holds a zero byte");
	optla_ctx_destroy(&ctx);
}
END_TEST

static const char *write_array(optla_ctx *ctx, const char *name, size_t rows, size_t columns, const double *data)
{
	optla_array a = {.ctx = ctx, .ndim = columns ? 2 : 1, .dims = {rows, columns}, .type = OPTLA_F64, .data = (void *)data};
	ok(optla_array_save(&a, file_of(name)));
	return file_of(name);
}

START_TEST(arrays)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	const optla_light_layout lights = {.nlights = 4};
	const double v[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, by_light[] = {1, 4, 7, 10, 2, 5, 8, 11, 3, 6, 9, 12};
	const double bad[] = {1, 2, -3, 4};
	double p[12];
	ok(optla_light_spec_(ctx, &lights, write_array(ctx, "a.npy", 4, 0, v), 1, p));
	near_array(p, v, 4, 0);
	ok(optla_light_spec_(ctx, &lights, write_array(ctx, "b.npy", 4, 1, v), 3, p));
	for (size_t c = 0; c < 3; c++) near_array(p + 4 * c, v, 4, 0);
	ok(optla_light_spec_(ctx, &lights, write_array(ctx, "c.npy", 3, 4, v), 3, p));
	near_array(p, v, 12, 0);
	ok(optla_light_spec_(ctx, &lights, write_array(ctx, "d.npy", 4, 3, v), 3, p));
	near_array(p, by_light, 12, 0);
	status_is(optla_light_spec_(ctx, &lights, write_array(ctx, "e.npy", 4, 3, v), 1, p), OPTLA_ERR_INPUT);
	says(&e, "e.npy: holds 12 numbers, wanted 4");
	status_is(optla_light_spec_(ctx, &lights, write_array(ctx, "f.npy", 12, 0, v), 3, p), OPTLA_ERR_INPUT);
	says(&e, "f.npy: coloured light is an array of 4 x 3 or 3 x 4 numbers");
	status_is(optla_light_spec_(ctx, &lights, write_array(ctx, "g.npy", 4, 0, bad), 1, p), OPTLA_ERR_INPUT);
	says(&e, "g.npy: light 2 has power -3");
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(images_on_the_grid)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	const optla_light_layout lights = {.nlights = 6, .grid_width = 3, .grid_height = 2}, loose = {.nlights = 6};
	double p[18];
	optla_image *grey, *rgb, *small;
	ok(optla_image_create(ctx, 3, 2, 1, OPTLA_IMAGE_LINEAR, &grey));
	ok(optla_image_create(ctx, 3, 2, 3, OPTLA_IMAGE_LINEAR, &rgb));
	ok(optla_image_create(ctx, 2, 2, 1, OPTLA_IMAGE_LINEAR, &small));
	for (size_t k = 0; k < 6; k++) grey->data[k] = (float)k;
	for (size_t k = 0; k < 18; k++) rgb->data[k] = (float)k;
	ok(optla_image_save(grey, file_of("grey.pfm")));
	ok(optla_image_save(rgb, file_of("rgb.pfm")));
	ok(optla_image_save(small, file_of("small.pfm")));
	ok(optla_light_spec_(ctx, &lights, file_of("grey.pfm"), 3, p));
	for (size_t k = 0; k < 18; k++) ck_assert_double_eq(p[k], (double)(k % 6));
	ok(optla_light_spec_(ctx, &lights, file_of("rgb.pfm"), 3, p));
	for (size_t k = 0; k < 18; k++) ck_assert_double_eq(p[k], (double)(3 * (k % 6) + k / 6));
	ok(optla_light_spec_(ctx, &lights, file_of("rgb.pfm"), 1, p));
	for (size_t k = 0; k < 6; k++) ck_assert_double_eq(p[k], (double)(3 * k + 1)); /* the mean of the channels */
	status_is(optla_light_spec_(ctx, &lights, file_of("small.pfm"), 1, p), OPTLA_ERR_SHAPE);
	says(&e, "small.pfm: is 2 x 2, the projector has 3 x 2 pixels");
	status_is(optla_light_spec_(ctx, &loose, file_of("grey.pfm"), 1, p), OPTLA_ERR_UNSUPPORTED);
	says(&e, "did you mean env:");
	rgb->data[7] = -1;
	ok(optla_image_save(rgb, file_of("rgb.pfm")));
	status_is(optla_light_spec_(ctx, &lights, file_of("rgb.pfm"), 3, p), OPTLA_ERR_INPUT);
	says(&e, "light 2 has power -1");
	/* a picture made for the eye is decoded, counts are divided by the largest */
	optla_image_set_kind(grey, OPTLA_IMAGE_DISPLAY, 0);
	for (size_t k = 0; k < 6; k++) grey->data[k] = k == 2 ? 1.0F : 0;
	ok(optla_image_save(grey, file_of("eye.png")));
	ok(optla_light_spec_(ctx, &lights, file_of("eye.png"), 1, p));
	for (size_t k = 0; k < 6; k++) near_abs(p[k], k == 2, 1e-6);
	optla_image_set_kind(grey, OPTLA_IMAGE_RAW_DN, 65535);
	for (size_t k = 0; k < 6; k++) grey->data[k] = 13107.0F * (float)k;
	ok(optla_image_save(grey, file_of("counts.png")));
	ok(optla_light_spec_(ctx, &lights, file_of("counts.png"), 1, p));
	for (size_t k = 0; k < 6; k++) near_abs(p[k], 0.2 * (double)k, 1e-6);
	optla_image_destroy(&grey);
	optla_image_destroy(&rgb);
	optla_image_destroy(&small);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- directions ---- */

static void toward(double azimuth_deg, double elevation_deg, double t[3])
{
	const double az = azimuth_deg * pi / 180, el = elevation_deg * pi / 180;
	t[0] = sin(az) * cos(el), t[1] = -sin(el), t[2] = cos(az) * cos(el);
}

/* Right, left, above, below, ahead, behind (towards the camera). */
static const double axes[] = {1, 0, 0, -1, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1};

START_TEST(points_follow_the_convention)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	const optla_light_layout lights = {.nlights = 6, .direction = axes};
	const char *specs[] = {"point:90,0", "point:-90,0", "point:12,90", "point:0,-90", "point:0,0", "point:180,0"};
	for (size_t k = 0; k < 6; k++) {
		double p[6];
		ok(optla_light_spec_(ctx, &lights, specs[k], 1, p));
		for (size_t n = 0; n < 6; n++) ck_assert_double_eq(p[n], n == k); /* exactly that light alone */
	}
	double p[6];
	ok(optla_light_point_(ctx, &lights, 45, 0, p)); /* between right and ahead; a third one, 90 degrees away, helps a little */
	near_rel(p[0], p[4], 1e-12);
	double sum = 0;
	for (size_t n = 0; n < 6; n++) sum += p[n];
	near_rel(sum, 1, 1e-12);
	near_rel(p[0], (1 / 45.0) / (2 / 45.0 + 1 / 90.0), 1e-12);
	/* 1/10 : 1/20 : 1/30 of three lights on one meridian */
	double line[12];
	toward(0, 10, line);
	toward(0, -20, line + 3);
	toward(0, 30, line + 6);
	toward(0, -40, line + 9);
	const optla_light_layout meridian = {.nlights = 4, .direction = line};
	ok(optla_light_point_(ctx, &meridian, 0, 0, p));
	const double wanted[] = {6.0 / 11, 3.0 / 11, 2.0 / 11, 0};
	near_array(p, wanted, 4, 1e-12);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(points_out_of_reach_are_refused)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	double d[9], p[3], reach;
	toward(170, 0, d);
	toward(180, 0, d + 3);
	toward(190, 0, d + 6);
	const optla_light_layout lights = {.nlights = 3, .direction = d};
	ok(optla_light_reach_(ctx, &lights, &reach));
	near_rel(reach, 20 * pi / 180, 1e-12);
	ok(optla_light_point_(ctx, &lights, 180, 19, p));
	status_is(optla_light_point_(ctx, &lights, 180, 21, p), OPTLA_ERR_ARG);
	says(&e, "no light within 20 degrees");
	says(&e, "the nearest, light 1, is 21 degrees away");
	/* leaving the light itself out */
	ok(optla_light_toward_(ctx, &lights, d + 3, 1, p));
	const double halves[] = {0.5, 0, 0.5};
	near_array(p, halves, 3, 1e-9);
	optla_ctx_destroy(&ctx);
}
END_TEST

static optla_image *environment(optla_ctx *ctx, size_t height, size_t channels, float value)
{
	optla_image *e;
	ok(optla_image_create(ctx, 2 * height, height, channels, OPTLA_IMAGE_LINEAR, &e));
	for (size_t k = 0; k < 2 * height * height * channels; k++) e->data[k] = value;
	return e;
}

START_TEST(uniform_environment_gives_solid_angles)
{
	/* Each of the six axes owns a sixth of the sphere; pixels on the borders of cells make the sum of a cell wrong by at most its
	   border (six arcs of about 70 degrees) times half a pixel: 7.4 * 0.5 * pi/200 = 0.06 of 2.09, and much less on average. */
	optla_ctx *ctx = test_ctx(NULL, 2);
	const optla_light_layout lights = {.nlights = 6, .direction = axes};
	optla_image *e = environment(ctx, 200, 1, 3);
	double p[6], sum = 0;
	ok(optla_light_environment_(ctx, &lights, e, "e", 1, p));
	for (size_t n = 0; n < 6; n++) {
		near_rel(p[n], 3 * 4 * pi / 6, 0.03);
		sum += p[n];
	}
	near_rel(sum, 3 * 4 * pi, 1e-9); /* nothing is lost: solid angles of pixels are exact */
	optla_image_destroy(&e);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(environment_pixels_reach_their_light)
{
	/* A bright pixel in the middle of a face of the panorama. Columns of a 64 x 32 image: azimuth 0 in the middle, 90 degrees at
	   three quarters, +-180 at the edges; rows: 90 degrees at the top. */
	const size_t at[][2] = {{48, 16}, {16, 16}, {20, 0}, {20, 31}, {32, 16}, {0, 16}};
	optla_ctx *ctx = test_ctx(NULL, 1);
	const optla_light_layout lights = {.nlights = 6, .direction = axes};
	for (size_t k = 0; k < 6; k++) {
		optla_image *e = environment(ctx, 32, 3, 0);
		double p[18];
		for (size_t c = 0; c < 3; c++) e->data[3 * (at[k][1] * 64 + at[k][0]) + c] = (float)(c + 1);
		ok(optla_image_save(e, file_of("e.exr")));
		char spec[300];
		snprintf(spec, sizeof spec, "env:%s", file_of("e.exr"));
		ok(optla_light_spec_(ctx, &lights, spec, 3, p));
		for (size_t n = 0; n < 6; n++) ck_assert(n == k ? p[n] > 0 : p[n] == 0);
		near_rel(p[6 + k], 2 * p[k], 1e-6);
		near_rel(p[12 + k], 3 * p[k], 1e-6);
		double white[6];
		ok(optla_light_spec_(ctx, &lights, spec, 1, white));
		near_rel(white[k], 2 * p[k], 1e-6); /* mean of 1, 2, 3 */
		optla_image_destroy(&e);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(environment_beyond_reach_is_ignored)
{
	/* Three lights in a row, 10 degrees apart: reach 20 degrees; what they gather is the union of three caps of that radius. */
	error_store store = {0};
	optla_ctx *ctx = test_ctx(&store, 2);
	double d[9], p[3], many[3][3];
	toward(170, 0, d);
	toward(180, 0, d + 3);
	toward(190, 0, d + 6);
	const optla_light_layout lights = {.nlights = 3, .direction = d};
	optla_image *e = environment(ctx, 360, 1, 1);
	ok(optla_light_environment_(ctx, &lights, e, "e", 1, p));
	/* light 1 keeps the strip of its cap within 5 degrees of its meridian great circle... compare with a fine count instead */
	double counted[3] = {0};
	const int fine = 4;
	for (int y = 0; y < 360 * fine; y++)
		for (int x = 0; x < 720 * fine; x++) {
			const double el = 90 - (y + 0.5) * 0.5 / fine, az = -180 + (x + 0.5) * 0.5 / fine;
			double t[3], best = -2;
			int light = 0;
			if (fabs(el) > 21 || fabs(fabs(az) - 180) > 32) continue;
			toward(az, el, t);
			for (int n = 0; n < 3; n++) {
				const double c = t[0] * d[3 * n] + t[1] * d[3 * n + 1] + t[2] * d[3 * n + 2];
				if (c > best) best = c, light = n;
			}
			const double step = 0.5 / fine * pi / 180;
			if (best >= cos(20 * pi / 180)) counted[light] += step * step * cos(el * pi / 180);
		}
	for (int n = 0; n < 3; n++) near_rel(p[n], counted[n], 0.01); /* rim of a cap (2.1 sr^.5) times half a pixel, averaged */
	for (int q = 0; q < 3; q++) {
		optla_ctx *c = test_ctx(NULL, q == 0 ? 1 : q == 1 ? 2 : 7);
		ok(optla_light_environment_(c, &lights, e, "e", 1, many[q]));
		ck_assert_mem_eq(many[q], p, sizeof p);
		optla_ctx_destroy(&c);
	}
	e->data[720 * 3 + 5] = -1;
	status_is(optla_light_environment_(ctx, &lights, e, "e.exr", 1, p), OPTLA_ERR_INPUT);
	says(&store, "e.exr: pixel (5, 3), channel 0 is -1");
	e->data[720 * 3 + 5] = NAN;
	status_is(optla_light_environment_(ctx, &lights, e, "e.exr", 1, p), OPTLA_ERR_INPUT);
	optla_image_destroy(&e);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
	const char *names[] = {"v.txt", "v.npy", "env:v.pfm", "v.pfm", "point:0,5"};
	optla_ctx *plain = test_ctx(NULL, 1);
	const double v[] = {1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6};
	write_text("v.txt", "1 2 3 4 5 6\n1 2 3 4 5 6\n1 2 3 4 5 6\n");
	write_array(plain, "v.npy", 6, 3, v);
	optla_image *e;
	ok(optla_image_create(plain, 3, 2, 3, OPTLA_IMAGE_LINEAR, &e));
	ok(optla_image_save(e, file_of("v.pfm")));
	optla_image_destroy(&e);
	optla_ctx_destroy(&plain);
	for (size_t f = 0; f < 5; f++) {
		char spec[300];
		const bool env = 0 == strncmp(names[f], "env:", 4), point = 0 == strncmp(names[f], "point:", 6);
		snprintf(spec, sizeof spec, "%s%s", env ? "env:" : "", point ? names[f] : file_of(names[f] + (env ? 4 : 0)));
		for (long k = 0, done = 0; !done; k++) {
			alloc_budget b = {.left = 1000};
			const optla_ctx_desc d = {
			    .size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b, .threads = 1};
			optla_ctx *ctx;
			ok(optla_ctx_create(&ctx, &d));
			const optla_light_layout lights = {.nlights = 6, .direction = axes, .grid_width = 3, .grid_height = 2};
			double p[18];
			b.left = k;
			const optla_status s = optla_light_spec_(ctx, &lights, spec, 3, p);
			ck_assert_msg(OPTLA_OK == s || OPTLA_ERR_NOMEM == s, "%s, allocation %ld: %s", spec, k, optla_status_name(s));
			done = OPTLA_OK == s;
			b.left = 1000;
			optla_ctx_destroy(&ctx);
			ck_assert_int_eq(b.live, 0);
		}
	}
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("light_spec");
	TCase *forms = tcase_create("forms"), *sphere = tcase_create("sphere");
	tcase_add_checked_fixture(forms, make_folder, remove_folder);
	tcase_add_checked_fixture(sphere, make_folder, remove_folder);
	tcase_add_test(forms, numbers_and_names);
	tcase_add_test(forms, wrong_names_are_explained);
	tcase_add_test(forms, text_files);
	tcase_add_test(forms, arrays);
	tcase_add_test(forms, images_on_the_grid);
	tcase_add_test(forms, every_allocation_may_fail);
	tcase_add_test(sphere, points_follow_the_convention);
	tcase_add_test(sphere, points_out_of_reach_are_refused);
	tcase_add_test(sphere, uniform_environment_gives_solid_angles);
	tcase_add_test(sphere, environment_pixels_reach_their_light);
	tcase_add_test(sphere, environment_beyond_reach_is_ignored);
	tcase_set_timeout(forms, 60);
	tcase_set_timeout(sphere, 60);
	suite_add_tcase(suite, forms);
	suite_add_tcase(suite, sphere);
	return run_suite(suite);
}
