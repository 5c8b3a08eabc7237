/* SPDX-License-Identifier: BSD-3-Clause */
/* Rigs: manifests good and bad, T of recorded photos, real photos of the ball. */
#include "capture/rig_open.h"
#include "io/whole_file.h"
#include "math/dense.h"
#include "near.h"
#include "optla/rig.h"

#include <unistd.h>

enum { W = 5, H = 4, LIGHTS = 3 };

/* Folder for one test's files. */
static void make_folder(char folder[64])
{
	snprintf(folder, 64, "/tmp/optla-rig-XXXXXX");
	ck_assert_ptr_nonnull(mkdtemp(folder));
}

static void remove_folder(const char *folder)
{
	char command[128];
	snprintf(command, sizeof command, "rm -rf '%s'", folder);
	ck_assert_int_eq(system(command), 0);
}

/* True T of the test scene in counts: positive, of full rank, different for each channel. */
static double truth_dn(size_t pixel, size_t c, size_t light)
{
	return 1000 + 500 * (double)((pixel * 7 + c * 3 + light * (pixel + 5)) % 11);
}

/* A 16-bit photo of sum_l x_l T_l + black. */
static void write_photo(optla_ctx *ctx, const char *folder, const char *name, const double *x, double black_dn, size_t channels)
{
	optla_image *image;
	char path[128];
	ok(optla_image_create(ctx, W, H, channels, OPTLA_IMAGE_RAW_DN, &image));
	image->white_dn = 65535;
	for (size_t p = 0; p < W * H; p++)
		for (size_t c = 0; c < channels; c++) {
			double dn = black_dn;
			for (size_t l = 0; l < LIGHTS && x; l++) dn += x[l] * truth_dn(p, c, l);
			image->data[p * channels + c] = (float)dn;
		}
	snprintf(path, sizeof path, "%s/%s", folder, name);
	ok(optla_image_save(image, path));
	optla_image_destroy(&image);
}

static void write_text(optla_ctx *ctx, const char *folder, const char *name, const char *text)
{
	char path[128];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	ok(optla_write_file_(ctx, path, text, strlen(text)));
}

/* Photos p1.png .. p3.png: one light each. */
static void write_single_lights(optla_ctx *ctx, const char *folder, double black_dn)
{
	for (size_t l = 0; l < LIGHTS; l++) {
		double x[LIGHTS] = {0};
		char name[16];
		x[l] = 1;
		snprintf(name, sizeof name, "p%zu.png", l + 1);
		write_photo(ctx, folder, name, x, black_dn, 3);
	}
}

static optla_status open_rig(optla_ctx *ctx, const char *folder, const char *manifest, optla_rig **rig)
{
	char path[128];
	write_text(ctx, folder, "rig.yaml", manifest);
	snprintf(path, sizeof path, "%s/rig.yaml", folder);
	return optla_rig_open(ctx, path, NULL, rig);
}

/* All of the rig's T as doubles. */
static double *dense(optla_rig *rig, optla_channel channel, size_t *count)
{
	optla_op *op;
	ok(optla_rig_truth(rig, channel, &op));
	const size_t m = optla_op_nrows(op), n = optla_op_ncols(op);
	const optla_scalar type = optla_op_type(op);
	void *data = malloc(m * n * 8);
	double *t = malloc(m * n * sizeof *t);
	ok(optla_op_to_dense(op, optla_block_(data, m, n, type)));
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < m; i++) t[j * m + i] = optla_get_(optla_cblock_(data, m, n, type), i, j);
	*count = m * n;
	free(data);
	optla_op_unref(&op);
	return t;
}

#define PATTERN "kind: recorded\nphotos: {pattern: p%d.png, count: 3}\n"

/* T of the whole frame, all channels, must be truth / white. */
static void check_truth(optla_rig *rig, double white, double tolerance)
{
	size_t count;
	double *t = dense(rig, OPTLA_CHANNEL_ALL, &count), want[W * H * 3 * LIGHTS];
	ck_assert_uint_eq(count, W * H * 3 * LIGHTS);
	for (size_t l = 0; l < LIGHTS; l++)
		for (size_t c = 0; c < 3; c++)
			for (size_t p = 0; p < W * H; p++) want[(l * 3 + c) * W * H + p] = truth_dn(p, c, l) / white;
	near_array(t, want, count, tolerance);
	free(t);
}

START_TEST(single_lights_are_the_columns)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	char folder[64];
	optla_rig *rig;
	optla_rig_info info;
	make_folder(folder);
	write_single_lights(ctx, folder, 0);
	ok(open_rig(ctx, folder, PATTERN "name: three lights\nsensor: ccd-12bit\nexposure_s: 0.25\n", &rig));
	optla_rig_get_info(rig, &info);
	ck_assert_str_eq(info.name, "three lights");
	ck_assert_str_eq(info.sensor, "ccd-12bit");
	ck_assert_int_eq(info.kind, OPTLA_RIG_RECORDED);
	ck_assert_uint_eq(info.width * info.height * info.channels, W * H * 3);
	ck_assert_uint_eq(info.npixels, W * H);
	ck_assert_uint_eq(info.nlights, LIGHTS);
	ck_assert_uint_eq(info.nphotos, 3);
	ck_assert(info.has_transpose && !info.symmetric && !info.light_direction && !info.light_width);
	near_rel(info.exposure_s, 0.25, 0);
	check_truth(rig, 65535, 1e-7); /* counts are exact, T is float */
	size_t count;
	double *grey = dense(rig, OPTLA_CHANNEL_GREY, &count), *red = dense(rig, OPTLA_CHANNEL_RED, &count);
	ck_assert_uint_eq(count, W * H * LIGHTS);
	near_rel(red[3], truth_dn(3, 0, 0) / 65535, 1e-6);
	near_rel(grey[W * H + 3], (truth_dn(3, 0, 1) + truth_dn(3, 1, 1) + truth_dn(3, 2, 1)) / 3 / 65535, 1e-6);
	free(red);
	free(grey);
	optla_rig_destroy(&rig);

	/* In any order and with exposures of their own: photo / exposure * nominal exposure. */
	ok(open_rig(ctx, folder,
	            "kind: recorded\nexposure_s: 2\nphotos:\n- {file: p3.png, light: 2, exposure_s: 1}\n- {file: p1.png, light: 0}\n"
	            "- {file: p2.png, light: 1}\n",
	            &rig));
	double *t = dense(rig, OPTLA_CHANNEL_RED, &count);
	near_rel(t[2 * W * H], 2 * truth_dn(0, 0, 2) / 65535, 1e-6);
	near_rel(t[W * H], truth_dn(0, 0, 1) / 65535, 1e-6);
	free(t);
	optla_rig_destroy(&rig);
	remove_folder(folder);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(mixed_lights_are_solved_for)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	char folder[64];
	optla_rig *rig;
	make_folder(folder);
	const double x[4][LIGHTS] = {{1, 1, 0}, {0, 1, 1}, {1, 0, 1}, {0.5, 0.25, 2}};
	for (int k = 0; k < 4; k++) {
		char name[16];
		snprintf(name, sizeof name, "m%d.png", k);
		write_photo(ctx, folder, name, x[k], 0, 3);
	}
	write_text(ctx, folder, "last.txt", "# three lights\n0.5, 0.25 2\n");
	ok(open_rig(ctx, folder,
	            "kind: recorded\nphotos:\n- {file: m0.png, illumination: [1, 1, 0]}\n- {file: m1.png, illumination: [0, 1, 1]}\n"
	            "- {file: m2.png, illumination: [1, 0, 1]}\n- {file: m3.png, illumination_file: last.txt}\n",
	            &rig));
	/* photos hold whole counts: those of the last are rounded by up to 1/2 of some 1000 */
	check_truth(rig, 65535, 1e-4);
	optla_rig_destroy(&rig);
	remove_folder(folder);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(black_is_subtracted)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	char folder[64];
	optla_rig *rig;
	make_folder(folder);
	write_single_lights(ctx, folder, 512);
	ok(open_rig(ctx, folder, PATTERN "black_level_dn: 512\n", &rig));
	check_truth(rig, 65535 - 512, 1e-6);
	optla_rig_destroy(&rig);
	write_photo(ctx, folder, "d1.png", NULL, 510, 3);
	write_photo(ctx, folder, "d2.png", NULL, 514, 3);
	ok(open_rig(ctx, folder, PATTERN "dark: [d1.png, d2.png]\n", &rig));
	check_truth(rig, 65535 - 512, 1e-6);
	optla_rig_destroy(&rig);
	remove_folder(folder);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(responses_are_inverted)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	char folder[64];
	optla_rig *rig;
	size_t count;
	make_folder(folder);
	write_single_lights(ctx, folder, 0);
	const double v = truth_dn(2, 1, 0) / 65535;
	const struct {
		const char *text;
		double want;
	} cases[] = {
	    {"response: linear\n", v},
	    {"response: {gamma: 2}\n", v * v},
	    {"response: srgb\n", v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4)},
	    /* linear up to 20000 counts, then twice as steep: white is 20000 + 2 * 45535 */
	    {"response: {counts: [0, 20000, 65535], linear: [0, 20000, 111070]}\n", truth_dn(2, 1, 0) / 111070},
	};
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		char text[256];
		snprintf(text, sizeof text, "%s%s", PATTERN, cases[k].text);
		ok(open_rig(ctx, folder, text, &rig));
		double *t = dense(rig, OPTLA_CHANNEL_GREEN, &count);
		near_rel(t[2], cases[k].want, 1e-6);
		free(t);
		optla_rig_destroy(&rig);
	}
	remove_folder(folder);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(crop_mask_and_images)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	char folder[64], path[128];
	optla_rig *rig;
	optla_rig_info info;
	make_folder(folder);
	write_single_lights(ctx, folder, 0);
	optla_image *mask;
	ok(optla_image_create(ctx, W, H, 1, OPTLA_IMAGE_DISPLAY, &mask));
	for (size_t p = 0; p < W * H; p++) mask->data[p] = p % 2 ? 1.0f : 0.0f;
	snprintf(path, sizeof path, "%s/mask.png", folder);
	ok(optla_image_save(mask, path));
	optla_image_destroy(&mask);
	ok(open_rig(ctx, folder, PATTERN "mask: mask.png\ncrop: [1, 1, 3, 2]\nlights: {grid: [3, 1]}\n", &rig));
	optla_rig_get_info(rig, &info);
	ck_assert_uint_eq(info.width, 3);
	ck_assert_uint_eq(info.height, 2);
	ck_assert_uint_eq(info.npixels, 3); /* (2,1) (1,2) (3,2) of the photo have odd index */
	ck_assert_uint_eq(info.pixel[0], 1);
	ck_assert_uint_eq(info.pixel[1], 3);
	ck_assert_uint_eq(info.pixel[2], 5);
	size_t count;
	double *t = dense(rig, OPTLA_CHANNEL_ALL, &count), back[9], grey[3];
	near_rel(t[0], truth_dn(W + 2, 0, 0) / 65535, 1e-6);
	near_rel(t[3 + 1], truth_dn(2 * W + 1, 1, 0) / 65535, 1e-6);
	optla_image *image;
	ok(optla_rig_image(rig, t, 3, &image));
	ck_assert_float_eq(image->data[0], 0);
	near_rel((double)image->data[1 * 3], t[0], 1e-7);
	ok(optla_rig_values(rig, image, OPTLA_CHANNEL_ALL, back));
	near_array(back, t, 9, 1e-7);
	ok(optla_rig_values(rig, image, OPTLA_CHANNEL_GREY, grey));
	near_rel(grey[2], (t[2] + t[5] + t[8]) / 3, 1e-6);
	optla_image_destroy(&image);
	const double p[3] = {1, 2, 3};
	ok(optla_rig_light_image(rig, p, &image));
	ck_assert(image->width == 3 && image->height == 1 && image->data[2] == 3);
	optla_image_destroy(&image);
	free(t);
	optla_rig_destroy(&rig);
	remove_folder(folder);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(directions_turn_to_the_camera)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	char folder[64];
	optla_rig *rig;
	optla_rig_info info;
	make_folder(folder);
	write_single_lights(ctx, folder, 0);
	write_text(ctx, folder, "dir.txt", "1 0 0\n0 2 0\n0 0.6 0.8\n");
	write_text(ctx, folder, "int.txt", "1 1 1\n2 4 5\n1 1 1\n");
	ok(open_rig(ctx, folder,
	            PATTERN
	            "lights: {directions: dir.txt, axes: [right, up, towards], intensities: int.txt, divide_intensities: true}\n",
	            &rig));
	optla_rig_get_info(rig, &info);
	const double want[9] = {1, 0, 0, 0, -1, 0, 0, -0.6, -0.8};
	near_array(info.light_direction, want, 9, 1e-15);
	size_t count;
	double *t = dense(rig, OPTLA_CHANNEL_GREEN, &count);
	near_rel(t[W * H + 1], truth_dn(1, 1, 1) / 65535 / 4, 1e-6);
	near_rel(t[1], truth_dn(1, 1, 0) / 65535, 1e-6);
	free(t);
	optla_rig_destroy(&rig);
	remove_folder(folder);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* Each manifest (after "kind: recorded\n" unless it has its own kind) and the message, without folder, that refuses it. */
static const struct {
	const char *manifest, *message;
} bad[] = {
    {"kind: live\n", "rig.yaml:1: 'kind' is 'live': allowed are recorded, analytic"},
    {"name: x\n", "'kind'"},
    {"- 1\n", "rig.yaml:1: a rig file is a mapping with the key 'kind'"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nmsak: m.png\n", "rig.yaml:3: "},
    {"kind: recorded\n", "'photos'"},
    {"kind: recorded\nphotos: 3\n", "rig.yaml:2: 'photos' must be a list, or a mapping with pattern and count"},
    {"kind: recorded\nphotos: []\n", "rig.yaml:2: 'photos' has 0 entries"},
    {"kind: recorded\nphotos: {pattern: p.png, count: 3}\n", "rig.yaml:2: 'pattern' is 'p.png': it needs one %d or %03d"},
    {"kind: recorded\nphotos: {pattern: p%s.png, count: 3}\n", "it needs one %d or %03d for the photo's number"},
    {"kind: recorded\nphotos: {pattern: p%d%n.png, count: 3}\n", "it needs one %d or %03d for the photo's number"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 0}\n", "rig.yaml:2: "},
    {"kind: recorded\nphotos: {pattern: q%d.png, count: 7}\n",
     "rig.yaml:2: 7 of 7 photos are missing in '%s/.': q1.png, q2.png, q3.png, q4.png, q5.png, ... (another folder can be given "
     "by --data DIR)"},
    {"kind: recorded\nphotos:\n- {file: p1.png, light: 0}\n- {file: no.png, light: 1}\n",
     "rig.yaml:4: 1 of 2 photos are missing in '%s/.': no.png"},
    {"kind: recorded\nphotos:\n- {file: p1.png, light: 0}\n- {file: p2.png, light: 0}\n",
     "rig.yaml:4: light 0 is listed twice: photos 'p1.png' and 'p2.png'"},
    {"kind: recorded\nphotos:\n- {file: p1.png}\n",
     "rig.yaml:3: photo 'p1.png' needs one of the keys light, illumination, illumination_file"},
    {"kind: recorded\nphotos:\n- {file: p1.png, light: 0, illumination: [1]}\n",
     "rig.yaml:3: photo 'p1.png' needs one of the keys"},
    {"kind: recorded\nphotos:\n- {file: p1.png, illumination: [1, .nan, 0]}\n", "rig.yaml:3: "},
    {"kind: recorded\nphotos:\n- {file: p1.png, illumination: [1, -1, 0]}\n", "rig.yaml:3: "},
    {"kind: recorded\nphotos:\n- {file: p1.png, illumination: [0, 0]}\n- {file: p2.png, illumination: [1, 1]}\n",
     "rig.yaml:3: the illumination of photo 'p1.png' is all zero"},
    {"kind: recorded\nphotos:\n- {file: p1.png, illumination: [1, 0]}\n- {file: p2.png, illumination: [1]}\n",
     "rig.yaml:4: 'illumination' has 1 numbers, there are 2 lights"},
    {"kind: recorded\nphotos:\n- {file: p1.png, illumination: [1, 0, 0, 1]}\n- {file: p2.png, illumination: [1, 0, 0, 2]}\n",
     "rig.yaml:3: 2 of 4 lights are lit in no photo: 1, 2"},
    {"kind: recorded\nphotos:\n- {file: p1.png, illumination: [1, 1]}\n- {file: p2.png, illumination: [2, 2]}\n",
     "rig.yaml:3: the illuminations of the 2 photos span 1 dimensions, the 2 lights need 2"},
    {"kind: recorded\nlights: {count: 2}\nphotos:\n- {file: p1.png, illumination_file: nan.txt}\n",
     "nan.txt:2: 'nan' is not a finite number"},
    {"kind: recorded\nlights: {count: 2}\nphotos:\n- {file: p1.png, illumination_file: three.txt}\n",
     "rig.yaml:4: 'three.txt' holds 3 numbers, there are 2 lights"},
    {"kind: recorded\nphotos:\n- {file: p1.png, illumination_file: three.txt}\n", "the number of lights is not known"},
    {"kind: recorded\nlights: {count: 2}\nphotos:\n- {file: p1.png, light: 2}\n",
     "rig.yaml:4: 'light' is 2: there are 2 lights, numbered from 0"},
    {"kind: recorded\nphotos:\n- {file: p1.png, light: 0}\n- {file: small.png, light: 1}\n",
     "rig.yaml:4: 'small.png' is 2 x 2 with 3 channels, the first photo is 5 x 4 with 3"},
    {"kind: recorded\nphotos:\n- {file: p1.png, light: 0}\n- {file: eight.png, light: 1}\n",
     "rig.yaml:4: 'eight.png' holds display samples (white 0), the first photo raw_dn (white 65535)"},
    {"kind: recorded\nphotos:\n- {file: p1.png, light: 0}\n- {file: text.png, light: 1}\n", "text.png"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nmask: small.png\n",
     "rig.yaml:3: the mask 'small.png' is 2 x 2, the photos are 5 x 4"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nmask: black.png\n",
     "rig.yaml:3: the mask 'black.png' is black: no pixel is left"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\ncrop: [3, 0, 3, 2]\n",
     "rig.yaml:3: 'crop' reaches (6, 2), the photos are 5 x 4"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\ncrop: [0, 0, 1.5, 2]\n", "rig.yaml:3: 'crop' is [0, 0, 1.5, 2]"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\ndark: []\n",
     "rig.yaml:3: 'dark' must be a list of at least one file"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\ndark: [white.png]\n",
     "rig.yaml:3: the dark frames are as bright as white"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\ndark: [p1.png]\nblack_level_dn: 3\n",
     "rig.yaml:4: give 'dark' or 'black_level_dn', not both"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nblack_level_dn: 70000\n",
     "black (70000 counts) is not below white (65535 counts)"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nresponse: log\n",
     "rig.yaml:3: 'response' is 'log': allowed are linear, srgb"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nresponse: {counts: [0, 0], linear: [0, 1]}\n",
     "rig.yaml:3: 'counts' must rise: entry 1 is 0 after 0"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nresponse: {counts: [0, 2, 3], linear: [0, 2, 1]}\n",
     "rig.yaml:3: 'linear' must not fall: entry 2 is 1 after 2"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nresponse: {counts: [0, 1], linear: [1, 1]}\n",
     "rig.yaml:3: 'linear' is the same for all counts"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nresponse: {gamma: 0}\n", "rig.yaml:3: "},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nsaturated: ignore\n",
     "rig.yaml:3: 'saturated' is 'ignore': allowed are error, warn"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nsaturation_dn: 6000\nsaturated: error\n",
     "samples are saturated (6000 or more); worst photo 'p"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nsensor: eye\n",
     "rig.yaml:3: 'sensor' is 'eye': allowed are dslr-14bit, ccd-12bit, video-8bit"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nlights: {directions: three.txt}\n",
     "rig.yaml:3: 'directions': 'three.txt' is 1 x 3 numbers, wanted are 3 lights x 3"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nlights: {directions: zero.txt}\n",
     "rig.yaml:3: 'zero.txt': the direction of light 1 is zero"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nlights: {directions: d.txt, axes: [right, left, up]}\n",
     "rig.yaml:3: 'axes' has 'left': it must be a list like [right, up, towards]"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nlights: {axes: [right, down, away]}\n",
     "rig.yaml:3: 'axes' needs the key directions"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nlights: {divide_intensities: true}\n",
     "rig.yaml:3: 'divide_intensities' needs the key intensities"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nlights: {intensities: zero.txt, divide_intensities: true}\n",
     "rig.yaml:3: 'zero.txt': the intensity of light 0 is 0"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nlights: {grid: [2, 2]}\n",
     "rig.yaml:3: 'grid' is 2 x 2, but there are 3 lights"},
    {"kind: recorded\nphotos: {pattern: p%d.png, count: 3}\nlights: {grid: [0, 2]}\n",
     "rig.yaml:3: 'grid' is [0, 2]: allowed are whole numbers from 1"},
    {"kind: analytic\nphotos: 3\n", "rig.yaml:2: "},
    {"kind: analytic\nwalls: {floor: [1, 1]}\n", "rig.yaml:2: "},
    {"kind: analytic\nwalls: {floor: [1, 1, 1], ceiling: [1, 1, 1]}\n", "rig.yaml:2: "},
    {"kind: analytic\nwalls: {floor: [1, 1, 1]}\n", "rig.yaml: walls: a corner has two or three of floor, left, back, not 1"},
    {"kind: analytic\ncoaxial: true\nprojector: {size: [4, 4]}\n",
     "rig.yaml:3: a corner that is coaxial or has a screen has no 'projector'"},
    {"kind: analytic\ncamera: {size: [4, 4.5]}\n", "rig.yaml:2: 'size' is [4, 4.5]: allowed are whole numbers from 1 to 4096"},
    {"kind: analytic\ncamera: {position_m: [0, 1, 1]}\n", "rig.yaml: camera: x = 0 m is not in front of the wall 'left'"},
    {"kind: analytic\nexposure_s: 0\n", "rig.yaml:2: "},
};

static void write_constant(optla_ctx *ctx, const char *folder, const char *name, optla_image_kind kind, size_t w, size_t h,
                           float v)
{
	optla_image *image;
	char path[128];
	ok(optla_image_create(ctx, w, h, 3, kind, &image));
	if (kind == OPTLA_IMAGE_RAW_DN) image->white_dn = 65535;
	for (size_t k = 0; k < w * h * 3; k++) image->data[k] = v;
	snprintf(path, sizeof path, "%s/%s", folder, name);
	ok(optla_image_save(image, path));
	optla_image_destroy(&image);
}

START_TEST(bad_manifests_are_refused_with_line_and_value)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 2);
	char folder[64], message[512];
	make_folder(folder);
	write_single_lights(ctx, folder, 0);
	write_constant(ctx, folder, "small.png", OPTLA_IMAGE_RAW_DN, 2, 2, 9);
	write_constant(ctx, folder, "black.png", OPTLA_IMAGE_RAW_DN, W, H, 0);
	write_constant(ctx, folder, "white.png", OPTLA_IMAGE_RAW_DN, W, H, 65535);
	write_constant(ctx, folder, "eight.png", OPTLA_IMAGE_DISPLAY, W, H, 0.5f);
	write_text(ctx, folder, "text.png", "this is no photo");
	write_text(ctx, folder, "nan.txt", "1 2\n1 nan\n");
	write_text(ctx, folder, "three.txt", "1 0 2\n");
	write_text(ctx, folder, "zero.txt", "0 0 1\n0 0 0\n1 0 0\n");
	write_text(ctx, folder, "d.txt", "0 0 1\n0 1 0\n1 0 0\n");
	for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
		optla_rig *rig = (optla_rig *)&e;
		const int before = e.count;
		const optla_status status = open_rig(ctx, folder, bad[k].manifest, &rig);
		ck_assert_msg(status == OPTLA_ERR_INPUT, "case %zu: got '%s' (%s) for\n%s", k, optla_status_name(status), e.text,
		              bad[k].manifest);
		ck_assert_ptr_null(rig);
		ck_assert_msg(e.count == before + 1, "case %zu: %d messages", k, e.count - before);
		const char *where = strstr(bad[k].message, "%s/");
		if (where)
			snprintf(message, sizeof message, "%.*s%s%s", (int)(where - bad[k].message), bad[k].message, folder, where + 2);
		else
			snprintf(message, sizeof message, "%s", bad[k].message);
		ck_assert_msg(strstr(e.text, message) != NULL, "case %zu: '%s' has no '%s'", k, e.text, message);
	}
	optla_rig *rig;
	status_is(optla_rig_open(ctx, "/nowhere/rig.yaml", NULL, &rig), OPTLA_ERR_INPUT);
	const optla_rig_open_options wrong = {.size = 3};
	status_is(optla_rig_open(ctx, "/nowhere/rig.yaml", &wrong, &rig), OPTLA_ERR_ARG);
	remove_folder(folder);
	optla_ctx_destroy(&ctx);
}
END_TEST

typedef struct {
	int count;
	char text[512];
} log_store;

static void keep_log(void *user, int level, const char *message)
{
	log_store *l = user;
	if (level) return;
	l->count++;
	snprintf(l->text, sizeof l->text, "%s", message);
}

START_TEST(saturated_photos_are_counted_and_warned_of)
{
	log_store log = {0};
	const optla_ctx_desc d = {.size = sizeof d, .log = keep_log, .log_user = &log, .threads = 2};
	optla_ctx *ctx;
	char folder[64];
	optla_rig *rig;
	optla_rig_info info;
	ok(optla_ctx_create(&ctx, &d));
	make_folder(folder);
	write_single_lights(ctx, folder, 0);
	ok(open_rig(ctx, folder, PATTERN "saturation_dn: 6000\n", &rig));
	optla_rig_get_info(rig, &info);
	size_t want = 0;
	for (size_t l = 0; l < LIGHTS; l++)
		for (size_t k = 0; k < W * H * 3; k++) want += truth_dn(k / 3, k % 3, l) >= 6000;
	ck_assert_uint_gt(want, 0);
	ck_assert_uint_eq(info.saturated_samples, want);
	ck_assert_int_eq(log.count, 1);
	ck_assert_ptr_nonnull(strstr(log.text, "samples are saturated (6000 or more); worst photo 'p"));
	check_truth(rig, 6000, 1e-6); /* saturation is the unit of T */
	optla_rig_destroy(&rig);
	remove_folder(folder);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(a_rig_without_transpose_has_none)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	char folder[64];
	optla_rig *rig;
	optla_op *op;
	make_folder(folder);
	write_single_lights(ctx, folder, 0);
	ok(open_rig(ctx, folder, PATTERN "transpose: false\n", &rig));
	ok(optla_rig_operator(rig, NULL, &op));
	float x[W * H] = {1}, y[LIGHTS];
	status_is(optla_op_apply(op, OPTLA_TRANSPOSE, optla_cblock_(x, W * H, 1, OPTLA_F32), optla_block_(y, LIGHTS, 1, OPTLA_F32)),
	          OPTLA_ERR_UNSUPPORTED);
	optla_op_unref(&op);
	ok(optla_rig_truth(rig, OPTLA_CHANNEL_GREY, &op)); /* the truth is for judging, whatever the arrangement */
	ok(optla_op_apply(op, OPTLA_TRANSPOSE, optla_cblock_(x, W * H, 1, OPTLA_F32), optla_block_(y, LIGHTS, 1, OPTLA_F32)));
	optla_op_unref(&op);
	optla_image *image;
	const double p[LIGHTS] = {0};
	status_is(optla_rig_light_image(rig, p, &image), OPTLA_ERR_UNSUPPORTED);
	optla_rig_destroy(&rig);
	remove_folder(folder);
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- allocation ---- */

static optla_status make_all(optla_ctx *ctx, const char *manifest)
{
	optla_rig *rig = NULL;
	optla_op *op = NULL;
	optla_status s = optla_rig_open(ctx, manifest, NULL, &rig);
	optla_rig_operator_options o = optla_rig_operator_defaults;
	o.sensor = optla_sensor_preset("ccd-12bit");
	if (!s) s = optla_rig_operator(rig, &o, &op);
	if (s) ck_assert_ptr_null(op);
	optla_op_unref(&op);
	if (!s) s = optla_rig_truth(rig, OPTLA_CHANNEL_GREY, &op);
	optla_op_unref(&op);
	optla_rig_destroy(&rig);
	return s;
}

static void fail_each_allocation(const char *manifest)
{
	for (long k = 0;; k++) {
		alloc_budget b = {.left = 1000000};
		const optla_ctx_desc d = {.size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b, .threads = 1};
		optla_ctx *ctx;
		ok(optla_ctx_create(&ctx, &d));
		b.left = k;
		const optla_status s = make_all(ctx, manifest);
		b.left = 1000000;
		optla_ctx_destroy(&ctx);
		ck_assert_msg(b.live == 0, "allocation %ld: %ld leaked", k, b.live);
		if (!s) {
			ck_assert_int_gt(k, 20);
			return;
		}
		ck_assert_msg(s == OPTLA_ERR_NOMEM, "allocation %ld: '%s'", k, optla_status_name(s));
	}
}

START_TEST(every_allocation_of_a_recording_may_fail)
{
	optla_ctx *ctx = test_ctx(NULL, 1);
	char folder[64], path[128];
	make_folder(folder);
	write_single_lights(ctx, folder, 20);
	write_constant(ctx, folder, "mask.png", OPTLA_IMAGE_DISPLAY, W, H, 1);
	write_constant(ctx, folder, "dark.png", OPTLA_IMAGE_RAW_DN, W, H, 20);
	write_text(ctx, folder, "d.txt", "0 0 1\n0 1 0\n1 0 0\n");
	write_text(ctx, folder, "x.txt", "0 0 1\n");
	write_text(ctx, folder, "rig.yaml",
	           "kind: recorded\nmask: mask.png\ndark: [dark.png]\nlights: {directions: d.txt, intensities: d.txt}\n"
	           "response: {counts: [0, 65535], linear: [0, 1]}\n"
	           "photos:\n- {file: p1.png, light: 0}\n- {file: p2.png, illumination: [0, 1, 0]}\n- {file: p3.png, "
	           "illumination_file: x.txt}\n");
	snprintf(path, sizeof path, "%s/rig.yaml", folder);
	optla_ctx_destroy(&ctx);
	fail_each_allocation(path);
	remove_folder(folder);
}
END_TEST

/* ---- manifests as bytes ---- */

START_TEST(any_bytes_give_a_manifest_or_an_error)
{
	/* Cut short at every byte, and every byte replaced by ones that mean something to YAML. */
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	char text[] =
	    "kind: recorded\nname: x\nphotos:\n- {file: a%d.png, illumination: [1, 2], exposure_s: 0.5}\nresponse: {counts: [0, 1], "
	    "linear: [0, 2]}\nlights: {count: 2, directions: d, axes: [right, up, towards], grid: [2, 1]}\ndark: [a, b]\n";
	const size_t n = strlen(text);
	for (size_t k = 0; k <= n; k++) {
		optla_manifest *m;
		const optla_status s = optla_manifest_parse_(ctx, text, k, "cut", &m);
		ck_assert(s == OPTLA_OK || (s == OPTLA_ERR_INPUT && !m));
		optla_manifest_destroy_(&m);
	}
	for (size_t k = 0; k < n; k++)
		for (const char *c = "-:[]{}&*%\"\n\t0#"; *c; c++) {
			optla_manifest *m;
			const char old = text[k];
			text[k] = *c;
			const optla_status s = optla_manifest_parse_(ctx, text, n, "changed", &m);
			ck_assert(s == OPTLA_OK || (s == OPTLA_ERR_INPUT && !m));
			optla_manifest_destroy_(&m);
			text[k] = old;
		}
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- what is shipped ---- */

START_TEST(shipped_corners_open)
{
	static const struct {
		const char *name;
		size_t npixels, nlights;
		bool symmetric;
	} rigs[] = {{"corner", 2304, 1024, false}, {"corner-coaxial", 1024, 1024, true}, {"corner-screen", 2304, 1024, false}};
	optla_ctx *ctx = test_ctx(NULL, 2);
	for (int k = 0; k < 3; k++) {
		char path[512];
		optla_rig *rig;
		optla_rig_info info;
		snprintf(path, sizeof path, "%s/examples/rigs/%s.yaml", OPTLA_SOURCE_ROOT, rigs[k].name);
		ok(optla_rig_open(ctx, path, NULL, &rig));
		optla_rig_get_info(rig, &info);
		ck_assert_str_eq(info.name, rigs[k].name);
		ck_assert_uint_eq(info.npixels, rigs[k].npixels);
		ck_assert_uint_eq(info.nlights, rigs[k].nlights);
		ck_assert(info.symmetric == rigs[k].symmetric);
		optla_rig_destroy(&rig);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(ball_has_the_known_spectrum)
{
	/* Independent calculation (NumPy): 15791 pixels, and the best approximations of rank 10, 20, 30 of the green channel miss it by
	   0.1522, 0.1358, 0.1215 of its norm; four digits were given. */
	skip_without(OPTLA_SHARED_DATA "/diligent-ball");
	log_store log = {0};
	const optla_ctx_desc d = {.size = sizeof d, .log = keep_log, .log_user = &log};
	optla_ctx *ctx;
	optla_rig *rig;
	optla_rig_info info;
	optla_op *op;
	ok(optla_ctx_create(&ctx, &d));
	const optla_rig_open_options options = {.size = sizeof options, .data_dir = OPTLA_SHARED_DATA};
	ok(optla_rig_open(ctx, OPTLA_SOURCE_ROOT "/examples/rigs/diligent-ball.yaml", &options, &rig));
	optla_rig_get_info(rig, &info);
	ck_assert_uint_eq(info.npixels, 15791);
	ck_assert_uint_eq(info.nlights, 96);
	ck_assert_uint_eq(info.nphotos, 96);
	ck_assert_int_eq(log.count, 1); /* its highlights are saturated */
	ok(optla_rig_truth(rig, OPTLA_CHANNEL_GREEN, &op));
	enum { N = 96 };
	const size_t m = info.npixels;
	float *t = malloc(m * N * sizeof *t);
	double gram[N * N], w[N], v[N * N], energy = 0;
	ok(optla_op_to_dense(op, optla_block_(t, m, N, OPTLA_F32)));
	for (size_t i = 0; i < N; i++)
		for (size_t j = 0; j <= i; j++)
			gram[i * N + j] = gram[j * N + i] =
			    optla_dot_(optla_cblock_(t, m, N, OPTLA_F32), i, optla_cblock_(t, m, N, OPTLA_F32), j);
	ok(optla_eigh_(ctx, gram, N, w, v)); /* ascending */
	for (size_t k = 0; k < N; k++) energy += w[k];
	const size_t rank[3] = {10, 20, 30};
	const double want[3] = {0.1522, 0.1358, 0.1215};
	for (int r = 0; r < 3; r++) {
		double rest = 0;
		for (size_t k = 0; k + rank[r] < N; k++) rest += w[k];
		near_abs(sqrt(rest / energy), want[r], 5.1e-5);
	}
	/* Light from below brightens the lower half: the axes are turned right. */
	for (size_t l = 0; l < N; l += 19) {
		double y = 0, x = 0, sum = 0;
		for (size_t p = 0; p < m; p++) {
			const double value = (double)t[l * m + p];
			x += value * ((double)(info.pixel[p] % info.width) - 95);
			y += value * ((double)(info.pixel[p] / info.width) - 95);
			sum += value;
		}
		const double *dir = info.light_direction + 3 * l;
		ck_assert_double_lt(dir[2], 0); /* lights are on the camera's side */
		ck_assert_double_gt(x / sum * dir[0] + y / sum * dir[1], 0.5 * hypot(x / sum, y / sum) * hypot(dir[0], dir[1]));
	}
	free(t);
	optla_op_unref(&op);
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("rig");
	TCase *t = tcase_create("rig");
	tcase_set_timeout(t, 240);
	tcase_add_test(t, single_lights_are_the_columns);
	tcase_add_test(t, mixed_lights_are_solved_for);
	tcase_add_test(t, black_is_subtracted);
	tcase_add_test(t, responses_are_inverted);
	tcase_add_test(t, crop_mask_and_images);
	tcase_add_test(t, directions_turn_to_the_camera);
	tcase_add_test(t, bad_manifests_are_refused_with_line_and_value);
	tcase_add_test(t, saturated_photos_are_counted_and_warned_of);
	tcase_add_test(t, a_rig_without_transpose_has_none);
	tcase_add_test(t, every_allocation_of_a_recording_may_fail);
	tcase_add_test(t, any_bytes_give_a_manifest_or_an_error);
	tcase_add_test(t, shipped_corners_open);
	tcase_add_test(t, ball_has_the_known_spectrum);
	suite_add_tcase(s, t);
	return run_suite(s);
}
