/* SPDX-License-Identifier: BSD-3-Clause */
/* The parts of the demonstration that any rig can show. */
#include "demo_scene.h"

#include "math/dense.h"

#include <math.h>
#include <string.h>

static const char expected[] = "what this scene reaches with this sensor, with room for the noise of another seed";

static void destroy_image(optla_ctx *ctx, void *object)
{
	(void)ctx;
	optla_image *image = object;
	optla_image_destroy(&image);
}

static void destroy_op(optla_ctx *ctx, void *object)
{
	(void)ctx;
	optla_op *op = object;
	optla_op_unref(&op);
}

static void destroy_run(optla_ctx *ctx, void *object)
{
	(void)ctx;
	optla_krylov *run = object;
	optla_krylov_destroy(&run);
}

static void destroy_model(optla_ctx *ctx, void *object)
{
	(void)ctx;
	optla_model *model = object;
	optla_model_destroy(&model);
}

optla_status demo_scene_init(demo_scene *scene, optla_figure *figure, optla_rig *rig, const char *sensor,
                             const demo_expect *expect)
{
	*scene = (demo_scene){
	    .expect = *expect, .figure = figure, .rig = rig, .sensor_name = sensor, .sensor = optla_sensor_preset(sensor)};
	optla_rig_get_info(rig, &scene->info);
	OPTLA_TRY(optla_lab_truth_(figure, rig, OPTLA_CHANNEL_ALL, &scene->truth));
	return optla_lab_truth_(figure, rig, OPTLA_CHANNEL_GREY, &scene->truth_grey);
}

/* ---- pictures in colour ---- */

static size_t nsamples(const demo_scene *s) { return s->info.npixels * s->info.channels; }

static optla_status photo(const demo_scene *s, const double *values, double exposure, optla_image **out)
{
	OPTLA_TRY(optla_rig_image(s->rig, values, s->info.channels, out));
	OPTLA_TRY(optla_figure_hold_(s->figure, *out, destroy_image));
	return optla_image_to_display(*out, exposure);
}

static optla_status exposure_of(const demo_scene *s, const double *values, double *exposure)
{
	optla_image *image;
	OPTLA_TRY(optla_rig_image(s->rig, values, s->info.channels, &image));
	*exposure = optla_image_auto_exposure(image, 0.999);
	optla_image_destroy(&image);
	return OPTLA_OK;
}

static optla_status difference(const demo_scene *s, const double *a, const double *b, double exposure, double amplification,
                               optla_image **out)
{
	optla_image *ia = NULL, *ib = NULL;
	*out = NULL;
	optla_status status = optla_rig_image(s->rig, a, s->info.channels, &ia);
	if (!status) status = optla_rig_image(s->rig, b, s->info.channels, &ib);
	if (!status) status = optla_panel_difference_(ia, ib, exposure, amplification, out);
	optla_image_destroy(&ia);
	optla_image_destroy(&ib);
	OPTLA_TRY(status);
	return optla_figure_hold_(s->figure, *out, destroy_image);
}

/* Cells of a sheet are whole multiples of small pictures. */
static size_t cell_px(const demo_scene *s) { return s->info.width < 96 ? 4 * s->info.width : 200; }

/* ---- operators ---- */

static optla_rig_operator_options operator_options(const demo_scene *s, optla_channel channel, bool noisy, uint64_t stream)
{
	optla_rig_operator_options o = optla_rig_operator_defaults;
	o.channel = channel;
	o.sensor = noisy ? s->sensor : NULL;
	o.split = OPTLA_SPLIT_AUTO;
	o.seed = s->figure->seed + stream * UINT64_C(0x9e3779b97f4a7c15);
	return o;
}

static optla_status photos_operator(const demo_scene *s, optla_channel channel, bool noisy, uint64_t stream, optla_op **op)
{
	const optla_rig_operator_options o = operator_options(s, channel, noisy, stream);
	return optla_lab_photos_(s->figure, s->rig, &o, op);
}

/* ---- capture ---- */

static optla_status arnoldi(demo_scene *s, int iterations, bool noisy, optla_krylov **run)
{
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = iterations;
	o.symmetric = s->info.symmetric;
	optla_krylov_problem problem = {.size = sizeof problem};
	OPTLA_TRY(photos_operator(s, OPTLA_CHANNEL_GREY, noisy, 1, &problem.op));
	if (s->info.channels > 1) {
		OPTLA_TRY(photos_operator(s, OPTLA_CHANNEL_ALL, noisy, 2, &problem.high));
		OPTLA_TRY(optla_rig_grey_reduction(s->rig, optla_op_type(problem.op), &problem.reduce));
		OPTLA_TRY(optla_figure_hold_(s->figure, problem.reduce, destroy_op));
	}
	OPTLA_TRY(optla_krylov_create(&problem, OPTLA_KRYLOV_ARNOLDI, &o, run));
	OPTLA_TRY(optla_figure_hold_(s->figure, *run, destroy_run));
	return optla_krylov_run(*run);
}

/* Eq. 2.11 after each iteration. */
static optla_status error_curve(demo_scene *s, optla_krylov *run, optla_series *series)
{
	optla_cblock d, p;
	double *errors, *photos;
	OPTLA_TRY(optla_krylov_bases(run, &d, &p, NULL));
	OPTLA_TRY(optla_figure_doubles_(s->figure, d.ncols, &errors));
	OPTLA_TRY(optla_figure_doubles_(s->figure, d.ncols, &photos));
	OPTLA_TRY(optla_relative_errors(d, p, s->truth_grey, errors));
	for (size_t k = 0; k < d.ncols; k++) photos[k] = (double)(k + 1);
	series->x = photos;
	series->y = errors;
	series->count = d.ncols;
	return OPTLA_OK;
}

static optla_status optimum(demo_scene *s, size_t count, optla_series *series)
{
	optla_capture_point *points = optla_calloc_(s->figure->ctx, count, sizeof *points);
	size_t *ks = optla_array_(s->figure->ctx, count, sizeof *ks);
	double *x = NULL, *y = NULL;
	optla_status status = points && ks ? optla_figure_doubles_(s->figure, count, &x) : OPTLA_ERR_NOMEM;
	if (!status) status = optla_figure_doubles_(s->figure, count, &y);
	if (!status) {
		for (size_t k = 0; k < count; k++) ks[k] = k + 1;
		const optla_capture_options o = {.size = sizeof o, .seed = s->figure->seed, .ks = ks, .nks = count};
		status = optla_capture_curve(OPTLA_CAPTURE_SVD, s->truth_grey, NULL, s->truth_grey, s->info.light_width,
		                             s->info.light_height, &o, points);
	}
	for (size_t k = 0; !status && k < count; k++) {
		x[k] = (double)points[k].k;
		y[k] = points[k].relative_error;
	}
	*series = (optla_series){"best possible of this rank (SVD)", x, y, count};
	optla_free(s->figure->ctx, points);
	optla_free(s->figure->ctx, ks);
	return status;
}

static optla_status capture_plot(demo_scene *s, optla_krylov *clean, optla_krylov *noisy)
{
	char label[96];
	snprintf(label, sizeof label, "Arnoldi through the sensor '%s'", s->sensor_name);
	optla_series series[3] = {{0}, {.label = "Arnoldi without noise"}, {.label = label}};
	OPTLA_TRY(error_curve(s, clean, &series[1]));
	OPTLA_TRY(error_curve(s, noisy, &series[2]));
	OPTLA_TRY(optimum(s, series[1].count, &series[0]));
	const optla_plot plot = {.size = sizeof plot,
	                         .title = "Error of the captured T",
	                         .x_label = "iterations k",
	                         .y_label = "relative error (Eq. 2.11)",
	                         .log_y = true,
	                         .series = series,
	                         .nseries = 3,
	                         .width = 640,
	                         .height = 380};
	OPTLA_TRY(optla_figure_plot_(s->figure, &plot, "errors",
	                             "How near the captured matrix comes to the exact one with each iteration."));
	const size_t last = series[1].count - 1;
	if (series[0].y[last] > 1e-6) /* with as many iterations as lights nothing is left of T but rounding: no ratio */
		OPTLA_TRY(optla_figure_number_(s->figure, series[1].y[last] / series[0].y[last],
		                               optla_expect_at_most_(s->expect.capture_over_best, "", expected),
		                               "error of T without noise, over the best possible of rank %zu", last + 1));
	return optla_figure_number_(s->figure, series[2].y[series[2].count - 1],
	                            optla_expect_at_most_(s->expect.capture_error, "", expected), "error of T through the sensor");
}

static optla_status montage(demo_scene *s)
{
	optla_image *image;
	OPTLA_TRY(optla_model_montage(s->model, 8, &image));
	OPTLA_TRY(optla_figure_hold_(s->figure, image, destroy_image));
	return optla_figure_image_(
	    s->figure, image, "components.png",
	    "The first eight iterations, red positive, blue negative. From the top: photos d, illuminations p, then light r from "
	    "the camera's side and what came of it, s (as Fig. 2.6).");
}

optla_status demo_capture(demo_scene *s, int iterations)
{
	optla_krylov *clean, *noisy;
	OPTLA_TRY(arnoldi(s, iterations, false, &clean));
	OPTLA_TRY(arnoldi(s, iterations, true, &noisy));
	const optla_krylov_info info = optla_krylov_get_info(noisy);
	s->photos += info.photos;
	s->exposure_s += info.exposure_s;
	OPTLA_TRY(optla_model_from_krylov(s->rig, noisy, &s->model));
	OPTLA_TRY(optla_figure_hold_(s->figure, s->model, destroy_model));
	optla_figure_heading_(s->figure, "Capture T from a few photos");
	optla_figure_say_(s->figure,
	                  "Lighting one light after the other would take %zu photos. Optical Arnoldi needs %llu: it shows the scene "
	                  "the answer to its "
	                  "last pattern, %zu times, and so learns the patterns that matter for this scene. %.3g s of exposure "
	                  "through the sensor '%s'.",
	                  s->info.nlights, (unsigned long long)info.photos, info.iterations, info.exposure_s, s->sensor_name);
	OPTLA_TRY(capture_plot(s, clean, noisy));
	return montage(s);
}

/* ---- relight ---- */

static optla_status relit(const demo_scene *s, const double *light, double *values)
{
	optla_ctx *ctx = s->figure->ctx;
	const size_t n = s->info.nlights, m = s->model->npixels * s->model->channels;
	float *p = optla_array_(ctx, n, sizeof *p), *i = optla_array_(ctx, m, sizeof *i);
	optla_status status = p && i ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!status) {
		for (size_t k = 0; k < n; k++) p[k] = (float)light[k];
		status = optla_relight(s->model, p, 1, i);
	}
	for (size_t k = 0; !status && k < nsamples(s); k++) values[k] = i[k];
	optla_free(ctx, p);
	optla_free(ctx, i);
	return status;
}

enum { MOST_LIGHTS = 6, AMPLIFY = 4 };

optla_status demo_relight(demo_scene *s, const demo_light *lights, size_t count)
{
	optla_panel panels[4 * MOST_LIGHTS];
	char captions[MOST_LIGHTS][96];
	double *truth, *ours;
	count = optla_min_(count, MOST_LIGHTS);
	OPTLA_TRY(optla_figure_doubles_(s->figure, nsamples(s), &truth));
	OPTLA_TRY(optla_figure_doubles_(s->figure, nsamples(s), &ours));
	optla_figure_heading_(s->figure, "Light the scene anew");
	optla_figure_say_(
	    s->figure,
	    "From those photos alone, without taking another one, comes the photo under any light: a weighted sum (Eq. 2.7).");
	for (size_t k = 0; k < count; k++) {
		optla_image *light, *a, *b, *d;
		double exposure;
		OPTLA_TRY(optla_lab_apply_(s->figure, s->truth, OPTLA_FORWARD, lights[k].light, truth));
		OPTLA_TRY(relit(s, lights[k].light, ours));
		OPTLA_TRY(exposure_of(s, truth, &exposure));
		OPTLA_TRY(optla_lab_light_(s->figure, s->rig, lights[k].light, false, &light));
		OPTLA_TRY(photo(s, truth, exposure, &a));
		OPTLA_TRY(photo(s, ours, exposure, &b));
		OPTLA_TRY(difference(s, ours, truth, exposure, AMPLIFY, &d));
		const double psnr_db = optla_lab_psnr_db_(ours, truth, nsamples(s));
		snprintf(captions[k], sizeof captions[k], "relit, PSNR %.1f dB", psnr_db);
		panels[4 * k] = (optla_panel){light, lights[k].words};
		panels[4 * k + 1] = (optla_panel){a, "the scene under it"};
		panels[4 * k + 2] = (optla_panel){b, captions[k]};
		panels[4 * k + 3] = (optla_panel){d, "difference, 4 times"};
		OPTLA_TRY(optla_figure_number_(s->figure, psnr_db, optla_expect_at_least_(s->expect.relit_psnr_db, "dB", expected),
		                               "PSNR of the scene relit: %s", lights[k].words));
	}
	return optla_lab_sheet_(s->figure, panels, 4 * count, 4, cell_px(s), "relit.png", "Lights that the capture never showed.");
}

/* ---- invert ---- */

static optla_status solve(demo_scene *s, const double *target, int iterations, double *light, optla_krylov_info *info)
{
	optla_op *op;
	optla_krylov *run;
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = iterations;
	o.symmetric = s->info.symmetric;
	o.nonnegative = OPTLA_NONNEGATIVE_NNLS;
	OPTLA_TRY(photos_operator(s, OPTLA_CHANNEL_GREY, true, 3, &op));
	OPTLA_TRY(optla_lab_run_(s->figure, op, OPTLA_KRYLOV_GMRES, &o, NULL, target, &run));
	*info = optla_krylov_get_info(run);
	const optla_block p = optla_block_(optla_array_(s->figure->ctx, s->info.nlights, optla_scalar_bytes(optla_op_type(op))),
	                                   s->info.nlights, 1, optla_op_type(op));
	if (!p.data) return OPTLA_ERR_NOMEM;
	double residual;
	const optla_status status = optla_krylov_solution(run, 0, p.data, &residual);
	for (size_t k = 0; !status && k < s->info.nlights; k++) light[k] = optla_get_(optla_block_const(p), k, 0);
	optla_free(s->figure->ctx, p.data);
	return status;
}

optla_status demo_invert(demo_scene *s, const demo_light *hidden, int iterations)
{
	const size_t m = s->info.npixels;
	double *target, *made, *light, exposure;
	optla_krylov_info info;
	OPTLA_TRY(optla_figure_doubles_(s->figure, m, &target));
	OPTLA_TRY(optla_figure_doubles_(s->figure, m, &made));
	OPTLA_TRY(optla_figure_doubles_(s->figure, s->info.nlights, &light));
	OPTLA_TRY(optla_lab_apply_(s->figure, s->truth_grey, OPTLA_FORWARD, hidden->light, target));
	OPTLA_TRY(solve(s, target, iterations, light, &info));
	OPTLA_TRY(optla_lab_apply_(s->figure, s->truth_grey, OPTLA_FORWARD, light, made));
	s->photos += info.photos;
	s->exposure_s += info.exposure_s;
	const double error = optla_lab_relative_(made, target, m);
	optla_figure_heading_(s->figure, "Which light made this photo?");
	optla_figure_say_(
	    s->figure,
	    "Optical GMRES gets a photo and asks the scene for the illumination that makes it (Eq. 2.9), here one without negative "
	    "light: "
	    "%zu iterations, %llu photos. The light it finds need not be the hidden one, the photo it makes must be the same.",
	    info.iterations, (unsigned long long)info.photos);
	optla_image *hidden_image, *found_image, *a, *b, *d;
	char caption[96];
	OPTLA_TRY(optla_lab_exposure_(s->figure, s->rig, target, &exposure));
	OPTLA_TRY(optla_lab_light_(s->figure, s->rig, hidden->light, false, &hidden_image));
	OPTLA_TRY(optla_lab_light_(s->figure, s->rig, light, false, &found_image));
	OPTLA_TRY(optla_lab_photo_(s->figure, s->rig, target, exposure, &a));
	OPTLA_TRY(optla_lab_photo_(s->figure, s->rig, made, exposure, &b));
	OPTLA_TRY(optla_lab_difference_(s->figure, s->rig, made, target, exposure, AMPLIFY, &d));
	snprintf(caption, sizeof caption, "the photo it makes,\nrelative error %.3g", error);
	const optla_panel panels[] = {{a, "the photo given"},
	                              {found_image, "the light found"},
	                              {b, caption},
	                              {d, "difference, 4 times"},
	                              {hidden_image, "the hidden light"}};
	OPTLA_TRY(optla_figure_number_(s->figure, error, optla_expect_at_most_(s->expect.inverse_error, "", expected),
	                               "error of the photo that the light found makes"));
	return optla_lab_sheet_(s->figure, panels, 5, 5, cell_px(s), "inverse.png", hidden->words);
}

/* ---- dual ---- */

optla_status demo_dual(demo_scene *s)
{
	const optla_rig_operator_options o = operator_options(s, OPTLA_CHANNEL_GREY, true, 4);
	optla_op *op;
	OPTLA_TRY(optla_rig_light_operator(s->rig, &o, &op));
	OPTLA_TRY(optla_figure_hold_(s->figure, op, destroy_op));
	double *all, *seen, *r, *dual, exposure;
	const size_t n = s->info.nlights, m = s->info.npixels;
	OPTLA_TRY(optla_figure_doubles_(s->figure, n, &all));
	OPTLA_TRY(optla_figure_doubles_(s->figure, nsamples(s), &seen));
	OPTLA_TRY(optla_figure_doubles_(s->figure, m, &r));
	OPTLA_TRY(optla_figure_doubles_(s->figure, n, &dual));
	for (size_t k = 0; k < n; k++) all[k] = 1;
	for (size_t k = 0; k < m; k++) r[k] = 1;
	OPTLA_TRY(optla_lab_apply_(s->figure, s->truth, OPTLA_FORWARD, all, seen));
	OPTLA_TRY(optla_lab_apply_(s->figure, op, OPTLA_TRANSPOSE, r, dual));
	const optla_op_cost cost = optla_op_cost_so_far(op);
	s->photos += cost.photos;
	s->exposure_s += cost.exposure_s;
	optla_image *a, *b;
	OPTLA_TRY(exposure_of(s, seen, &exposure));
	OPTLA_TRY(photo(s, seen, exposure, &a));
	OPTLA_TRY(optla_lab_light_(s->figure, s->rig, dual, false, &b));
	optla_figure_heading_(s->figure, "See with the projector's eyes");
	optla_figure_say_(s->figure,
	                  "Light runs both ways: with camera and projector swapped the same matrix, transposed, answers (Eq. 1.12).");
	const optla_panel panels[] = {{a, "seen by the camera,\nlit by the projector"},
	                              {b, "seen by the projector,\nlit by the camera"}};
	return optla_lab_sheet_(s->figure, panels, 2, 2, cell_px(s), "dual.png", "One photo each.");
}

void demo_say_cost(const demo_scene *scenes, size_t count)
{
	uint64_t photos = 0;
	double exposure_s = 0;
	for (size_t k = 0; k < count; k++) {
		photos += scenes[k].photos;
		exposure_s += scenes[k].exposure_s;
	}
	optla_figure_say_(scenes->figure, "All of this took %llu photos and %.3g s of exposure.", (unsigned long long)photos,
	                  exposure_s);
}
