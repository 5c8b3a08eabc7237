/* SPDX-License-Identifier: BSD-3-Clause */
/* Relighting, dual photos, models and their files. */
#include "base/random.h"
#include "io/h5.h"
#include "io/whole_file.h"
#include "math/dense.h"
#include "near.h"
#include "optla/relight.h"
#include "relight/model_impl.h"

#include <stdio.h>
#include <unistd.h>

static double random_number(uint64_t stream, size_t k)
{
	return optla_rand_u01_((optla_rand){.seed = 5, .stream_hi = OPTLA_RAND_TEST}, stream, (uint32_t)k, 0);
}

static float *random_floats(uint64_t stream, size_t n)
{
	float *v = malloc(n * sizeof *v);
	for (size_t k = 0; k < n; k++) v[k] = (float)(random_number(stream, k) - 0.25);
	return v;
}

static char folder[64];

static void make_folder(void)
{
	snprintf(folder, sizeof folder, "/tmp/optla-relight-XXXXXX");
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

/* ---- the kernel ---- */

START_TEST(combine_against_plain_sums)
{
	/* every remainder of photos (passes of eight) and rows that are no multiple of anything; photos apart by ld */
	const size_t rows[] = {1, 15, 16, 1000, 70001}, ks[] = {1, 2, 3, 7, 8, 9, 23};
	optla_ctx *ctx = test_ctx(NULL, 2);
	for (size_t r = 0; r < 5; r++)
		for (size_t q = 0; q < 7; q++) {
			const size_t n = rows[r], k = ks[q], ld = n + 3;
			float *d = random_floats(1, ld * k), *c = random_floats(2, k), *y = malloc(n * sizeof *y);
			ok(optla_relight_combine(ctx, d, n, ld, k, c, y));
			for (size_t m = 0; m < n; m++) {
				double sum = 0, size = 0;
				for (size_t j = 0; j < k; j++) {
					sum += (double)c[j] * (double)d[j * ld + m];
					size += fabs((double)c[j] * (double)d[j * ld + m]);
				}
				near_abs((double)y[m], sum, ((double)k + 1) * 0x1p-24 * size); /* k products and sums, half an ulp each */
			}
			free(d);
			free(c);
			free(y);
		}
	error_store e = {0};
	optla_ctx *loud = test_ctx(&e, 1);
	float x[4] = {0};
	status_is(optla_relight_combine(loud, x, 3, 2, 1, x, x), OPTLA_ERR_SHAPE);
	optla_ctx_destroy(&loud);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(combine_gives_the_same_bytes_for_any_threads)
{
	enum { N = 300007, K = 11 };
	float *d = random_floats(1, (size_t)N * K), *c = random_floats(2, K), *y[3];
	for (int q = 0; q < 3; q++) {
		optla_ctx *ctx = test_ctx(NULL, q == 0 ? 1 : q == 1 ? 2 : 7);
		y[q] = malloc(N * sizeof **y);
		ok(optla_relight_combine(ctx, d, N, N, K, c, y[q]));
		optla_ctx_destroy(&ctx);
	}
	ck_assert_mem_eq(y[1], y[0], N * sizeof **y);
	ck_assert_mem_eq(y[2], y[0], N * sizeof **y);
	for (int q = 0; q < 3; q++) free(y[q]);
	free(d);
	free(c);
}
END_TEST

/* ---- a model of full rank: T = D Pᵀ exactly ---- */

enum { WIDTH = 9, HEIGHT = 7, PIXELS = 40, LIGHTS = 12, CHANNELS = 3, ROWS = PIXELS * CHANNELS };

typedef struct {
	uint32_t pixel[PIXELS];
	double direction[3 * LIGHTS];
	float t[ROWS * LIGHTS], d[ROWS * LIGHTS], p[LIGHTS * LIGHTS]; /* T, D = T P, P orthogonal */
	optla_rig_info info;
} scene;

/* P = I - 2 u uᵀ / uᵀu, a reflection: orthogonal and full. */
static void make_scene(scene *s, bool grid)
{
	double u[LIGHTS], uu = 0;
	for (size_t k = 0; k < PIXELS; k++) s->pixel[k] = (uint32_t)(k + k / 3);
	for (size_t k = 0; k < ROWS * LIGHTS; k++) s->t[k] = (float)random_number(1, k);
	for (size_t n = 0; n < LIGHTS; n++) {
		u[n] = random_number(2, n);
		uu += u[n] * u[n];
		const double angle = 0.1 + 0.05 * (double)n, turn = (double)n;
		s->direction[3 * n] = sin(angle) * cos(turn);
		s->direction[3 * n + 1] = sin(angle) * sin(turn);
		s->direction[3 * n + 2] = -cos(angle);
	}
	for (size_t j = 0; j < LIGHTS; j++)
		for (size_t i = 0; i < LIGHTS; i++) s->p[j * LIGHTS + i] = (float)((i == j) - 2 * u[i] * u[j] / uu);
	for (size_t j = 0; j < LIGHTS; j++)
		for (size_t m = 0; m < ROWS; m++) {
			double sum = 0;
			for (size_t n = 0; n < LIGHTS; n++) sum += (double)s->t[n * ROWS + m] * (double)s->p[j * LIGHTS + n];
			s->d[j * ROWS + m] = (float)sum;
		}
	s->info = (optla_rig_info){.name = "test",
	                           .width = WIDTH,
	                           .height = HEIGHT,
	                           .channels = CHANNELS,
	                           .npixels = PIXELS,
	                           .pixel = s->pixel,
	                           .nlights = LIGHTS,
	                           .light_direction = grid ? NULL : s->direction,
	                           .light_width = grid ? 4 : 0,
	                           .light_height = grid ? 3 : 0};
}

static optla_model *make_model(optla_ctx *ctx, const scene *s)
{
	optla_model *m;
	ok(optla_model_build_(ctx, &s->info, CHANNELS, optla_cblock_(s->d, ROWS, LIGHTS, OPTLA_F32),
	                      optla_cblock_(s->p, LIGHTS, LIGHTS, OPTLA_F32), &m));
	return m;
}

/* Rounding of a chain of three sums of LIGHTS floats of size <= 1 each (T P, Pᵀ p, D c). */
static const double rounding = 3 * LIGHTS * 0x1p-24 * LIGHTS;

START_TEST(relighting_at_full_rank_is_the_product)
{
	scene s;
	make_scene(&s, false);
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_model *m = make_model(ctx, &s);
	float p[CHANNELS * LIGHTS], white[ROWS], coloured[ROWS];
	for (size_t k = 0; k < CHANNELS * LIGHTS; k++) p[k] = (float)random_number(3, k);
	ok(optla_relight(m, p, 1, white));
	ok(optla_relight(m, p, CHANNELS, coloured));
	for (size_t row = 0; row < ROWS; row++) {
		double w = 0, c = 0;
		for (size_t n = 0; n < LIGHTS; n++) {
			w += (double)s.t[n * ROWS + row] * (double)p[n];
			c += (double)s.t[n * ROWS + row] * (double)p[row / PIXELS * LIGHTS + n];
		}
		near_abs((double)white[row], w, rounding);
		near_abs((double)coloured[row], c, rounding);
	}
	error_store e = {0};
	optla_model_destroy(&m);
	optla_ctx_destroy(&ctx);
	ctx = test_ctx(&e, 1);
	m = make_model(ctx, &s);
	status_is(optla_relight(m, p, 2, white), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "light of 2 channels for photos of 3: give 1 (white) or as many as the photos have");
	p[LIGHTS + 1] = NAN;
	status_is(optla_relight(m, p, CHANNELS, white), OPTLA_ERR_ARG);
	ck_assert_str_eq(e.text, "light 1, channel 1 has power nan");
	optla_model_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(dual_photo_is_the_transpose)
{
	scene s;
	make_scene(&s, false);
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_model *m = make_model(ctx, &s);
	float r[ROWS], dual[LIGHTS], p[LIGHTS], i[ROWS];
	double left = 0, right = 0;
	for (size_t k = 0; k < ROWS; k++) r[k] = (float)random_number(4, k);
	for (size_t k = 0; k < LIGHTS; k++) p[k] = (float)random_number(5, k);
	ok(optla_dual(m, r, dual));
	for (size_t n = 0; n < LIGHTS; n++) {
		double sum = 0;
		for (size_t row = 0; row < ROWS; row++) sum += (double)s.t[n * ROWS + row] * (double)r[row];
		near_abs((double)dual[n], sum, rounding * ROWS / LIGHTS);
	}
	ok(optla_relight(m, p, 1, i));
	for (size_t row = 0; row < ROWS; row++) left += (double)r[row] * (double)i[row];
	for (size_t n = 0; n < LIGHTS; n++) right += (double)dual[n] * (double)p[n];
	near_rel(left, right, 1e-5); /* <r, T p> = <Tᵀ r, p>, sums of ROWS floats */
	r[7] = INFINITY;
	status_is(optla_dual(m, r, dual), OPTLA_ERR_ARG);
	optla_model_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(pictures_and_lights_of_a_model)
{
	scene s;
	make_scene(&s, true);
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_model *m = make_model(ctx, &s);
	optla_image *image;
	ok(optla_model_image(m, s.t, &image));
	ck_assert(image->width == WIDTH && image->height == HEIGHT && image->channels == CHANNELS &&
	          image->kind == OPTLA_IMAGE_LINEAR);
	for (size_t k = 0; k < PIXELS; k++)
		for (size_t c = 0; c < CHANNELS; c++) ck_assert_float_eq(image->data[CHANNELS * s.pixel[k] + c], s.t[c * PIXELS + k]);
	ck_assert_float_eq(image->data[CHANNELS * 3], 0); /* pixel 3 isn't in the mask */
	optla_image_destroy(&image);
	double p[LIGHTS];
	ok(optla_model_light_vector(m, "light:5", 1, p));
	for (size_t n = 0; n < LIGHTS; n++) ck_assert_double_eq(p[n], n == 5);
	optla_model_destroy(&m);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(misfits_are_refused)
{
	scene s;
	make_scene(&s, true);
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	const optla_cblock d = optla_cblock_(s.d, ROWS, LIGHTS, OPTLA_F32), p = optla_cblock_(s.p, LIGHTS, LIGHTS, OPTLA_F32);
	optla_model *m;
	status_is(optla_model_build_(ctx, &s.info, 1, d, p, &m), OPTLA_ERR_SHAPE);
	ck_assert_ptr_null(m);
	ck_assert_ptr_nonnull(strstr(e.text, "photos of 120 samples"));
	status_is(optla_model_build_(ctx, &s.info, 3, optla_columns_(d, 0, 5), p, &m), OPTLA_ERR_SHAPE);
	status_is(optla_model_build_(ctx, &s.info, 3, optla_columns_(d, 0, 0), optla_columns_(p, 0, 0), &m), OPTLA_ERR_SHAPE);
	s.info.light_height = 2;
	status_is(optla_model_build_(ctx, &s.info, 3, d, p, &m), OPTLA_ERR_SHAPE);
	ck_assert_str_eq(e.text, "test: a projector of 4 x 2 pixels doesn't have 12 lights");
	optla_ctx_destroy(&ctx);
}
END_TEST

/* ---- from a Krylov run ---- */

/* Relit pictures are those of D Pᵀ, and at full rank those of T; photos, duals and costs come along. */
static void check_krylov_model(optla_krylov_method method, bool high)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	optla_rig *rig;
	ok(optla_rig_corner(ctx, 8, 4, false, &rig));
	optla_rig_info info;
	optla_rig_get_info(rig, &info);
	optla_rig_operator_options o = optla_rig_operator_defaults;
	o.type = OPTLA_F64;
	o.channel = high ? OPTLA_CHANNEL_ALL : OPTLA_CHANNEL_GREY;
	optla_op *photos, *truth, *grey = NULL, *mean = NULL;
	ok(optla_rig_operator(rig, &o, &photos));
	ok(optla_rig_truth(rig, o.channel, &truth));
	const size_t channels = high ? info.channels : 1, nrows = info.npixels * channels, nlights = info.nlights;
	if (high) { /* the mean of the channels (section 2.4) */
		double *average = calloc(info.npixels * nrows, sizeof *average);
		for (size_t k = 0; k < nrows; k++) average[k * info.npixels + k % info.npixels] = 1 / (double)channels;
		o.channel = OPTLA_CHANNEL_GREY;
		ok(optla_rig_operator(rig, &o, &grey));
		ok(optla_op_dense(ctx, optla_cblock_(average, info.npixels, nrows, OPTLA_F64), true, &mean));
		free(average);
	}
	optla_krylov_options ko = optla_krylov_defaults;
	ko.iterations = (int)nlights;
	ko.tolerance = 0;
	const optla_krylov_problem problem = {
	    .size = sizeof problem, .op = high ? grey : photos, .high = high ? photos : NULL, .reduce = mean};
	optla_krylov *run;
	ok(optla_krylov_create(&problem, method, &ko, &run));
	ok(optla_krylov_run(run));
	optla_model *m;
	ok(optla_model_from_krylov(rig, run, &m));
	ck_assert(m->channels == channels && m->nlights == nlights && m->rank == optla_krylov_get_info(run).rank);
	ck_assert_uint_eq(m->photos_taken, optla_krylov_get_info(run).photos);
	ck_assert(m->photos_taken > 0 && m->exposure_s > 0);
	ck_assert(high == (NULL != m->thumbnails));
	ck_assert_ptr_nonnull(m->dual_light);
	ck_assert_uint_eq(m->nthumb, info.npixels);
	double *p = calloc(nlights, sizeof *p), *i = malloc(nrows * sizeof *i), *got = malloc(nrows * sizeof *got);
	float *light = malloc(nlights * sizeof *light), *relit = malloc(nrows * sizeof *relit);
	ok(optla_model_light_vector(m, "light:3,9=0.5", 1, p));
	for (size_t n = 0; n < nlights; n++) light[n] = (float)p[n];
	ok(optla_relight(m, light, 1, relit));
	ok(optla_op_apply(truth, OPTLA_FORWARD, optla_cblock_(p, nlights, 1, OPTLA_F64), optla_block_(i, nrows, 1, OPTLA_F64)));
	for (size_t k = 0; k < nrows; k++) got[k] = (double)relit[k];
	near_array(got, i, nrows, 1e-5); /* T has full rank here; the model holds floats: sums of 16 terms */
	free(p);
	free(i);
	free(got);
	free(light);
	free(relit);
	optla_model_destroy(&m);
	optla_krylov_destroy(&run);
	optla_op_unref(&photos);
	optla_op_unref(&truth);
	optla_op_unref(&grey);
	optla_op_unref(&mean);
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
}

START_TEST(models_of_krylov_runs)
{
	check_krylov_model(OPTLA_KRYLOV_ARNOLDI, false);
	check_krylov_model(OPTLA_KRYLOV_SVD, false);
	check_krylov_model(OPTLA_KRYLOV_ARNOLDI, true);
}
END_TEST

/* ---- files ---- */

/* Gives a model everything that a Krylov run may leave. */
static void add_extras(optla_model *m)
{
	m->nthumb = PIXELS;
	m->thumbnails = optla_array_(m->ctx, (size_t)PIXELS * m->rank, sizeof *m->thumbnails);
	m->dual_light = optla_array_(m->ctx, (size_t)PIXELS * m->rank, sizeof *m->dual_light);
	m->dual_photo = optla_array_(m->ctx, (size_t)LIGHTS * m->rank, sizeof *m->dual_photo);
	for (size_t k = 0; k < PIXELS * m->rank; k++) m->thumbnails[k] = (float)k, m->dual_light[k] = -(float)k;
	for (size_t k = 0; k < LIGHTS * m->rank; k++) m->dual_photo[k] = 0.5F * (float)k;
	m->photos_taken = 48;
	m->exposure_s = 0.25;
}

static void same(const void *a, const void *b, size_t bytes)
{
	ck_assert(!a == !b);
	if (a) ck_assert_mem_eq(a, b, bytes);
}

static void same_models(const optla_model *a, const optla_model *b)
{
	ck_assert(a->width == b->width && a->height == b->height && a->channels == b->channels && a->npixels == b->npixels &&
	          a->nlights == b->nlights && a->rank == b->rank && a->light_width == b->light_width &&
	          a->light_height == b->light_height && a->nthumb == b->nthumb && a->thumb_width == b->thumb_width &&
	          a->thumb_height == b->thumb_height && a->photos_taken == b->photos_taken);
	ck_assert_double_eq(a->exposure_s, b->exposure_s);
	same(a->pixel, b->pixel, a->npixels * sizeof *a->pixel);
	same(a->photos, b->photos, a->npixels * a->channels * a->rank * sizeof *a->photos);
	same(a->illuminations, b->illuminations, a->nlights * a->rank * sizeof *a->illuminations);
	same(a->light_direction, b->light_direction, 3 * a->nlights * sizeof *a->light_direction);
	same(a->thumbnails, b->thumbnails, a->nthumb * a->rank * sizeof *a->thumbnails);
	same(a->dual_light, b->dual_light, a->nthumb * a->rank * sizeof *a->dual_light);
	same(a->dual_photo, b->dual_photo, a->nlights * a->rank * sizeof *a->dual_photo);
}

START_TEST(save_and_load)
{
	for (int q = 0; q < 4; q++) {
		scene s;
		make_scene(&s, q & 1);
		optla_ctx *ctx = test_ctx(NULL, 1);
		optla_model *m = make_model(ctx, &s), *back;
		if (q & 2) add_extras(m);
		ok(optla_model_save(m, file_of("m.h5")));
		ok(optla_model_load(ctx, file_of("m.h5"), &back));
		same_models(m, back);
		optla_model_destroy(&m);
		optla_model_destroy(&back);
		optla_ctx_destroy(&ctx);
	}
}
END_TEST

static void load_refused(const char *what)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 1);
	optla_model *m = (optla_model *)&e;
	status_is(optla_model_load(ctx, file_of("m.h5"), &m), OPTLA_ERR_INPUT);
	ck_assert_ptr_null(m);
	ck_assert_int_eq(e.count, 1);
	ck_assert_msg(strstr(e.text, what), "the message '%s' doesn't say '%s'", e.text, what);
	optla_ctx_destroy(&ctx);
}

START_TEST(files_that_contradict_themselves)
{
	scene s;
	make_scene(&s, true);
	optla_ctx *ctx = test_ctx(NULL, 1);
	const char *wrong[] = {"pixel[0] = 0 is outside of the picture of 0 x 7",
	                       "pixel[37] = 49 is outside of the picture of 7 x 7",
	                       "pixel[5] = 0 doesn't ascend from",
	                       "photos is 12 x 119, the other parts of the model want 12 x 120",
	                       "illuminations is 11 x 12",
	                       "photos[2, 7] is nan",
	                       "a projector of 4 x 5 pixels doesn't have 12 lights",
	                       "dual_light and dual_photo belong together",
	                       "light_direction[3] has length 0",
	                       "low-resolution pictures have 40 samples, which isn't 7 x 5",
	                       "exposure_s is"};
	for (int q = 0; q < 11; q++) {
		make_scene(&s, q != 8);
		optla_model *m = make_model(ctx, &s);
		optla_h5 *file;
		if (q == 0) m->width = 0;
		if (q == 1) m->width = m->height = 7;
		if (q == 2) m->pixel[5] = 0;
		if (q == 5) m->photos[2 * ROWS + 7] = NAN;
		if (q == 6) m->light_height = 5;
		if (q == 8) m->light_direction[9] = m->light_direction[10] = m->light_direction[11] = 0;
		if (q == 10) m->exposure_s = -1;
		if (q == 9) add_extras(m), m->thumb_width = 7, m->thumb_height = 5;
		if (q == 3 || q == 4 || q == 7) { /* written by hand: sizes that no model has */
			const char *numbers[] = {"width",       "height",       "channels",     "light_width", "light_height",
			                         "thumb_width", "thumb_height", "photos_taken", "exposure_s"};
			const double values[] = {WIDTH, HEIGHT, CHANNELS, 4, 3, 0, 0, 1, 1};
			ok(optla_h5_create_(ctx, file_of("m.h5"), "model", &file));
			for (size_t k = 0; k < 9; k++) ok(optla_h5_put_number_(file, numbers[k], values[k]));
			ok(optla_h5_put_u32_(file, "pixel", s.pixel, PIXELS, ""));
			ok(optla_h5_put_(file, "photos", optla_cblock_(s.d, q == 3 ? ROWS - 1 : ROWS, LIGHTS, OPTLA_F32), "", ""));
			ok(optla_h5_put_(file, "illuminations", optla_cblock_(s.p, LIGHTS, q == 4 ? LIGHTS - 1 : LIGHTS, OPTLA_F32), "", ""));
			if (q == 7) ok(optla_h5_put_(file, "dual_light", optla_cblock_(s.d, PIXELS, LIGHTS, OPTLA_F32), "", ""));
			ok(optla_h5_finish_(&file, true));
		} else {
			ok(optla_model_save(m, file_of("m.h5")));
		}
		optla_model_destroy(&m);
		load_refused(wrong[q]);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

/* Whatever the numbers are, the answer is a sound model or an error. */
static void decode_any(optla_ctx *ctx, const void *bytes, size_t count)
{
	optla_model *m;
	const optla_status s = optla_model_decode_(ctx, bytes, count, "bytes", &m);
	ck_assert((OPTLA_OK == s) == (NULL != m));
	if (!m) return;
	double sum = 0; /* all that it says is there can be read */
	for (size_t k = 0; k < m->npixels * m->channels * m->rank; k++) sum += (double)m->photos[k];
	for (size_t k = 0; k < m->nlights * m->rank; k++) sum += (double)m->illuminations[k];
	for (size_t k = 0; k < m->npixels; k++) ck_assert(m->pixel[k] < m->width * m->height);
	ck_assert(isfinite(sum));
	optla_model_destroy(&m);
}

/* Where `size` bytes stand in the file first. */
static size_t find(const unsigned char *bytes, size_t count, const void *what, size_t size)
{
	for (size_t at = 0; at + size <= count; at++)
		if (0 == memcmp(bytes + at, what, size)) return at;
	ck_abort_msg("the file doesn't hold what was written");
	return 0;
}

/* One to four bytes of the numbers of a file are changed. Its structure is left alone: that is HDF5's own to check. */
static void damage_numbers(optla_ctx *ctx, const optla_model *m, const unsigned char *bytes, size_t count)
{
	const double width = (double)m->width, channels = (double)m->channels;
	const struct {
		const void *what;
		size_t size;
	} parts[] = {{&width, sizeof width},
	             {&channels, sizeof channels},
	             {m->pixel, m->npixels * sizeof *m->pixel},
	             {m->light_direction, 3 * m->nlights * sizeof *m->light_direction},
	             {m->photos, ROWS * LIGHTS * sizeof *m->photos},
	             {m->illuminations, LIGHTS * LIGHTS * sizeof *m->illuminations}};
	unsigned char *copy = malloc(count);
	for (size_t k = 0; k < 600; k++) {
		const size_t part = k % 6, first = find(bytes, count, parts[part].what, parts[part].size);
		memcpy(copy, bytes, count);
		for (size_t j = 0; j <= k % 4; j++) {
			const size_t at = first + (size_t)(random_number(7 + j, k) * (double)parts[part].size);
			copy[at] = (unsigned char)(256 * random_number(20 + j, k));
		}
		decode_any(ctx, copy, count);
	}
	free(copy);
}

START_TEST(damaged_files)
{
	scene s;
	make_scene(&s, false);
	optla_ctx *ctx = test_ctx(NULL, 1);
	optla_model *m = make_model(ctx, &s), *part;
	add_extras(m);
	ok(optla_model_save(m, file_of("m.h5")));
	void *bytes;
	size_t count;
	ok(optla_read_file_(ctx, file_of("m.h5"), &bytes, &count));
	for (size_t n = 0; n < count; n += 1 + count / 300) { /* truncated */
		status_is(optla_model_decode_(ctx, bytes, n, "bytes", &part), OPTLA_ERR_INPUT);
		ck_assert_ptr_null(part);
	}
	damage_numbers(ctx, m, bytes, count);
	optla_model_destroy(&m);
	optla_free(ctx, bytes);
	optla_ctx_destroy(&ctx);
	remove(file_of("m.h5"));
	load_refused("m.h5");
}
END_TEST

START_TEST(every_allocation_may_fail)
{
	scene s;
	make_scene(&s, false);
	optla_ctx *plain = test_ctx(NULL, 1);
	optla_model *kept = make_model(plain, &s);
	add_extras(kept);
	ok(optla_model_save(kept, file_of("kept.h5")));
	optla_model_destroy(&kept);
	optla_ctx_destroy(&plain);
	for (int action = 0; action < 5; action++)
		for (long k = 0, done = 0; !done; k++) {
			alloc_budget b = {.left = 100000};
			const optla_ctx_desc desc = {
			    .size = sizeof desc, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b, .threads = 1};
			optla_ctx *ctx;
			ok(optla_ctx_create(&ctx, &desc));
			optla_model *m = action ? make_model(ctx, &s) : NULL, *made = NULL;
			optla_image *image = NULL;
			float p[ROWS] = {0}, i[ROWS];
			const long live = b.live;
			b.left = k;
			optla_status status = OPTLA_OK;
			if (action == 0)
				status = optla_model_build_(ctx, &s.info, CHANNELS, optla_cblock_(s.d, ROWS, LIGHTS, OPTLA_F32),
				                            optla_cblock_(s.p, LIGHTS, LIGHTS, OPTLA_F32), &made);
			if (action == 1) status = optla_relight(m, p, 1, i);
			if (action == 2) status = optla_dual(m, p, i);
			if (action == 3) status = optla_model_montage(m, 2, &image);
			if (action == 4) status = optla_model_load(ctx, file_of("kept.h5"), &made);
			b.left = 100000;
			ck_assert_msg(OPTLA_OK == status || OPTLA_ERR_NOMEM == status, "action %d, allocation %ld: %s", action, k,
			              optla_status_name(status));
			done = OPTLA_OK == status;
			ck_assert((made || image) == (done && (action == 0 || action >= 3)));
			if (!done && action != 4) ck_assert_int_eq(b.live, live); /* loading leaves a note of the input */
			optla_model_destroy(&made);
			optla_image_destroy(&image);
			optla_model_destroy(&m);
			optla_ctx_destroy(&ctx);
			ck_assert_int_eq(b.live, 0);
		}
}
END_TEST

/* ---- montage ---- */

START_TEST(montage_shows_signs_where_they_are)
{
	for (int q = 0; q < 2; q++) {
		scene s;
		make_scene(&s, q == 0);
		for (size_t k = 0; k < ROWS; k++) s.d[k] = 1, s.d[ROWS + k] = -1;     /* d_1 red, d_2 blue */
		for (size_t n = 0; n < LIGHTS; n++) s.p[n] = 1, s.p[LIGHTS + n] = -1; /* p_1 red, p_2 blue */
		optla_ctx *ctx = test_ctx(NULL, 1);
		optla_model *m = make_model(ctx, &s);
		optla_image *two, *four;
		ok(optla_model_montage(m, 2, &two));
		ck_assert(two->kind == OPTLA_IMAGE_DISPLAY && two->channels == 3);
		add_extras(m);
		ok(optla_model_montage(m, 1000, &four));           /* as many as there are */
		const size_t gap = 2 * two->height - four->height; /* heights are gap + rows * step */
		ck_assert_uint_eq((four->height - gap) * 2, (two->height - gap) * 4);
		ck_assert_uint_eq((four->width - gap) * 2, (two->width - gap) * LIGHTS);
		double red[4] = {0}, blue[4] = {0}; /* quarters of the sheet: d_1, d_2, p_1, p_2 */
		for (size_t y = 0; y < two->height; y++)
			for (size_t x = 0; x < two->width; x++) {
				const float *v = two->data + 3 * (y * two->width + x);
				const size_t quarter = 2 * (2 * y / two->height) + 2 * x / two->width;
				red[quarter] += v[0] > v[2] + 0.2F;
				blue[quarter] += v[2] > v[0] + 0.2F;
			}
		for (size_t k = 0; k < 4; k++) {
			ck_assert(k % 2 ? blue[k] > 500 : red[k] > 500);
			ck_assert(k % 2 ? red[k] == 0 : blue[k] == 0);
		}
		optla_image_destroy(&two);
		optla_image_destroy(&four);
		optla_model_destroy(&m);
		optla_ctx_destroy(&ctx);
	}
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("relight");
	TCase *products = tcase_create("products"), *files = tcase_create("files");
	tcase_add_test(products, combine_against_plain_sums);
	tcase_add_test(products, combine_gives_the_same_bytes_for_any_threads);
	tcase_add_test(products, relighting_at_full_rank_is_the_product);
	tcase_add_test(products, dual_photo_is_the_transpose);
	tcase_add_test(products, pictures_and_lights_of_a_model);
	tcase_add_test(products, misfits_are_refused);
	tcase_add_test(products, models_of_krylov_runs);
	tcase_add_test(products, montage_shows_signs_where_they_are);
	tcase_add_checked_fixture(files, make_folder, remove_folder);
	tcase_add_test(files, save_and_load);
	tcase_add_test(files, files_that_contradict_themselves);
	tcase_add_test(files, damaged_files);
	tcase_add_test(files, every_allocation_may_fail);
	tcase_set_timeout(products, 60);
	tcase_set_timeout(files, 120);
	suite_add_tcase(suite, products);
	suite_add_tcase(suite, files);
	return run_suite(suite);
}
