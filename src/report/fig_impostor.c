/* SPDX-License-Identifier: BSD-3-Clause */
/* Fig. 2.12: optical GMRES (Eq. 2.9) finds an illumination that makes the scene look as under another light. Two scenes (behind a screen:
   low rank; lit directly: high rank), two lights (a soft disc; stripes one pixel wide), three ways to keep light non-negative. */
#include "math/dense.h"
#include "report/lab.h"

#include <math.h>
#include <string.h>

enum { ITERATIONS = 20, MODES = 3, TRIALS = 2 * MODES, SHOWN = 4 };
static const size_t shown[SHOWN] = {1, 5, 10, ITERATIONS};
static const char *const sensor_name = "dslr-14bit";

/* One run of GMRES and its errors after k = 1..ITERATIONS. */
typedef struct {
	const char *label, *sensor;
	optla_nonnegative mode;
	size_t count;
	double *k, *photo_error, *light_error, *residual;
	double *light[SHOWN], *photo[SHOWN]; /* solutions to show, and the photos they make */
	optla_krylov *run;
} trial;

typedef struct {
	optla_figure *figure;
	const char *name;
	optla_rig *rig;
	optla_rig_info info;
	optla_op *truth;
	size_t nrows, ncols;
	double *light, *photo; /* what is to be found, and the photo of it without noise */
} scene;

/* A disc of radius 0.16 of the width with a soft border, off the centre: a flashlight seen through the screen. */
static void make_disc(const scene *s, double *light)
{
	const double w = (double)s->info.light_width, h = (double)s->info.light_height;
	for (size_t y = 0; y < s->info.light_height; y++)
		for (size_t x = 0; x < s->info.light_width; x++) {
			const double r = hypot((double)x - 0.6 * w, (double)y - 0.4 * h) / w;
			light[y * s->info.light_width + x] = 1 / (1 + exp((r - 0.16) / 0.03));
		}
}

static void make_stripes(const scene *s, double *light)
{
	for (size_t n = 0; n < s->ncols; n++) light[n] = (double)(n % s->info.light_width % 2);
}

static optla_status open_scene(scene *s)
{
	optla_rig_get_info(s->rig, &s->info);
	OPTLA_TRY(optla_lab_truth_(s->figure, s->rig, OPTLA_CHANNEL_GREY, &s->truth));
	s->nrows = optla_op_nrows(s->truth);
	s->ncols = optla_op_ncols(s->truth);
	OPTLA_TRY(optla_figure_doubles_(s->figure, s->ncols, &s->light));
	return optla_figure_doubles_(s->figure, s->nrows, &s->photo);
}

static optla_status init_trial(scene *s, trial *t)
{
	double **columns[] = {&t->k, &t->photo_error, &t->light_error, &t->residual};
	for (size_t i = 0; i < sizeof columns / sizeof *columns; i++)
		OPTLA_TRY(optla_figure_doubles_(s->figure, ITERATIONS, columns[i]));
	for (size_t i = 0; i < SHOWN; i++) {
		OPTLA_TRY(optla_figure_doubles_(s->figure, s->ncols, &t->light[i]));
		OPTLA_TRY(optla_figure_doubles_(s->figure, s->nrows, &t->photo[i]));
	}
	return OPTLA_OK;
}

/* The target is a photo too: with a camera it is as noisy as the others. Same seed for each trial: same noise. */
static optla_status start(scene *s, trial *t)
{
	optla_rig_operator_options o = optla_lab_camera_(s->figure, OPTLA_CHANNEL_GREY, t->sensor);
	optla_krylov_options k = optla_krylov_defaults;
	optla_op *photos, *light;
	double *target;
	k.iterations = ITERATIONS;
	k.nonnegative = t->mode;
	OPTLA_TRY(optla_figure_doubles_(s->figure, s->nrows, &target));
	OPTLA_TRY(optla_lab_photos_(s->figure, s->rig, &o, &photos));
	o.seed = s->figure->seed + 1;
	OPTLA_TRY(optla_lab_light_photos_(s->figure, s->rig, &o, &light));
	OPTLA_TRY(optla_lab_apply_(s->figure, light, OPTLA_FORWARD, s->light, target));
	return optla_lab_run_(s->figure, photos, OPTLA_KRYLOV_GMRES, &k, NULL, target, &t->run);
}

static optla_status run_trial(scene *s, trial *t)
{
	double *p, *i; /* both rigs answer in doubles */
	OPTLA_TRY(init_trial(s, t));
	OPTLA_TRY(start(s, t));
	OPTLA_TRY(optla_figure_doubles_(s->figure, s->ncols, &p));
	OPTLA_TRY(optla_figure_doubles_(s->figure, s->nrows, &i));
	t->count = optla_krylov_get_info(t->run).iterations;
	for (size_t k = 1; k <= t->count; k++) {
		OPTLA_TRY(optla_krylov_solution(t->run, k, p, &t->residual[k - 1]));
		OPTLA_TRY(optla_lab_apply_(s->figure, s->truth, OPTLA_FORWARD, p, i));
		t->k[k - 1] = (double)k;
		t->photo_error[k - 1] = optla_lab_relative_(i, s->photo, s->nrows);
		t->light_error[k - 1] = optla_lab_relative_(p, s->light, s->ncols);
		for (size_t j = 0; j < SHOWN; j++)
			if (shown[j] == k) {
				memcpy(t->light[j], p, s->ncols * sizeof *p);
				memcpy(t->photo[j], i, s->nrows * sizeof *i);
			}
	}
	return OPTLA_OK;
}

static optla_status run_all(scene *s, trial trials[TRIALS])
{
	static const char *const labels[TRIALS] = {"as it comes",         "clamped",         "NNLS",
	                                           "as it comes, 14 bit", "clamped, 14 bit", "NNLS, 14 bit"};
	OPTLA_TRY(optla_lab_apply_(s->figure, s->truth, OPTLA_FORWARD, s->light, s->photo));
	for (int i = 0; i < TRIALS; i++) {
		trials[i] = (trial){.label = labels[i], .sensor = i < MODES ? NULL : sensor_name, .mode = (optla_nonnegative)(i % MODES)};
		OPTLA_TRY(run_trial(s, &trials[i]));
	}
	return OPTLA_OK;
}

static optla_status plot(scene *s, const trial *trials, bool of_photo, const char *caption)
{
	optla_series series[TRIALS];
	char title[96], file[64];
	for (int i = 0; i < TRIALS; i++)
		series[i] = (optla_series){trials[i].label, trials[i].k, of_photo ? trials[i].photo_error : trials[i].light_error,
		                           trials[i].count};
	snprintf(title, sizeof title, "%s: error of the %s", s->name, of_photo ? "photo" : "illumination");
	snprintf(file, sizeof file, "%s-%s", s->name, of_photo ? "photo" : "illumination");
	const optla_plot p = {.size = sizeof p,
	                      .title = title,
	                      .x_label = "iteration k",
	                      .y_label = of_photo ? "||T p_k − i|| / ||i||" : "||p_k − p|| / ||p||",
	                      .log_y = true,
	                      .series = series,
	                      .nseries = TRIALS};
	return optla_figure_plot_(s->figure, &p, file, caption);
}

static optla_status show(scene *s, const trial *t, const char *suffix, const char *what)
{
	enum { COLUMNS = SHOWN + 1, ROWS = 3, AMPLIFICATION = 10 };
	optla_panel panels[ROWS * COLUMNS] = {{0}};
	char captions[2][COLUMNS][64], file[64], text[256];
	optla_image *image;
	double exposure;
	OPTLA_TRY(optla_lab_exposure_(s->figure, s->rig, s->photo, &exposure));
	for (size_t i = 0; i < COLUMNS; i++) {
		const double *light = i ? t->light[i - 1] : s->light, *photo = i ? t->photo[i - 1] : s->photo;
		OPTLA_TRY(optla_lab_light_(s->figure, s->rig, light, false, &image));
		if (i == 0) snprintf(captions[0][i], sizeof captions[0][i], "light to imitate");
		if (i)
			snprintf(captions[0][i], sizeof captions[0][i], "k = %zu, error %.3f", shown[i - 1],
			         t->light_error[shown[i - 1] - 1]);
		panels[i] = (optla_panel){image, captions[0][i]};
		OPTLA_TRY(optla_lab_photo_(s->figure, s->rig, photo, exposure, &image));
		if (i == 0) snprintf(captions[1][i], sizeof captions[1][i], "its photo");
		if (i) snprintf(captions[1][i], sizeof captions[1][i], "error %.4f", t->photo_error[shown[i - 1] - 1]);
		panels[COLUMNS + i] = (optla_panel){image, captions[1][i]};
		if (i == 0) continue;
		OPTLA_TRY(optla_lab_difference_(s->figure, s->rig, photo, s->photo, exposure, AMPLIFICATION, &image));
		panels[2 * COLUMNS + i] = (optla_panel){image, "difference × 10"};
	}
	snprintf(file, sizeof file, "%s-%s.png", s->name, suffix);
	snprintf(text, sizeof text, "%s, %s (%s): illumination, photo, and difference of photos amplified ten times.", s->name, what,
	         t->label);
	return optla_lab_sheet_(s->figure, panels, ROWS * COLUMNS, COLUMNS, 192, file, text);
}

/* Residual of min ||D y - i|| by LAPACK, from the same photos. */
static optla_status lapack_residual(scene *s, const trial *t, double *residual)
{
	optla_cblock d;
	double *a, *y, *r;
	OPTLA_TRY(optla_krylov_bases(t->run, &d, NULL, NULL));
	OPTLA_TRY(optla_figure_doubles_(s->figure, d.nrows * d.ncols, &a));
	OPTLA_TRY(optla_figure_doubles_(s->figure, d.ncols, &y));
	OPTLA_TRY(optla_figure_doubles_(s->figure, d.nrows, &r));
	for (size_t k = 0; k < d.ncols; k++) optla_copy_column_(d, k, optla_block_(a, d.nrows, d.ncols, OPTLA_F64), k);
	OPTLA_TRY(optla_lstsq_(s->figure->ctx, a, d.nrows, d.ncols, s->photo, 1, 0, y, NULL));
	OPTLA_TRY(optla_dense_apply_(s->figure->ctx, OPTLA_FORWARD, optla_cblock_(a, d.nrows, d.ncols, OPTLA_F64),
	                             optla_cblock_(y, d.ncols, 1, OPTLA_F64), optla_block_(r, d.nrows, 1, OPTLA_F64)));
	*residual = optla_lab_relative_(r, s->photo, s->nrows);
	return OPTLA_OK;
}

static optla_status measure(scene *s, const trial *trials)
{
	const trial *plain = &trials[0];
	double lapack, growth = 0;
	OPTLA_CHECK(s->figure->ctx, plain->count >= 2, OPTLA_ERR_INPUT, "'%s': GMRES ended after %zu iterations", s->name,
	            plain->count);
	OPTLA_TRY(lapack_residual(s, plain, &lapack));
	for (size_t k = 1; k < plain->count; k++) growth = fmax(growth, plain->residual[k] / plain->residual[k - 1]);
	optla_expect photos =
	    optla_expect_range_(80, 80, "",
	                        "four photos for each iteration (Eq. 2.4): the first lights the scene with the target photo "
	                        "from the camera's side");
	photos.thesis = 80;
	OPTLA_TRY(optla_figure_number_(s->figure, (double)optla_krylov_get_info(plain->run).photos, photos,
	                               "%s: photos for 20 iterations", s->name));
	OPTLA_TRY(optla_figure_number_(s->figure, plain->residual[plain->count - 1] / lapack,
	                               optla_expect_range_(1 - 1e-6, 1 + 1e-6, "", "LAPACK's least squares on the same photos"),
	                               "%s: residual over LAPACK's", s->name));
	OPTLA_TRY(optla_figure_number_(s->figure, growth,
	                               optla_expect_at_most_(1 + 1e-9, "", "each iteration minimises over a larger space"),
	                               "%s: largest factor from one residual to the next", s->name));
	for (int i = 0; i < TRIALS; i++) {
		const size_t last = trials[i].count - 1;
		OPTLA_TRY(optla_figure_number_(s->figure, trials[i].photo_error[last], optla_expect_nothing_("", "reported"),
		                               "%s: error of the photo, %s, k = %zu", s->name, trials[i].label, last + 1));
		OPTLA_TRY(optla_figure_number_(s->figure, trials[i].light_error[last], optla_expect_nothing_("", "reported"),
		                               "%s: error of the illumination, %s, k = %zu", s->name, trials[i].label, last + 1));
	}
	for (int i = 0; i < TRIALS; i += MODES) {
		const size_t last = ITERATIONS - 1;
		const trial *clamped = &trials[i + OPTLA_NONNEGATIVE_CLAMP], *nnls = &trials[i + OPTLA_NONNEGATIVE_NNLS];
		OPTLA_TRY(
		    optla_figure_number_(s->figure, nnls->photo_error[last] / clamped->photo_error[last],
		                         optla_expect_at_most_(1.02, "",
		                                               "footnote 3: clamping costs residual, a constraint does not; 2 % for "
		                                               "noise where hardly anything is negative"),
		                         "%s: error of the photo, NNLS / clamped%s", s->name, i ? ", 14 bit" : ""));
		OPTLA_TRY(optla_figure_number_(
		    s->figure, nnls->photo_error[last] / nnls->light_error[last],
		    optla_expect_at_most_(1, "", "the thesis' finding: the photo matches better than the illumination"),
		    "%s: error of the photo / of the illumination, NNLS%s", s->name, i ? ", 14 bit" : ""));
	}
	return OPTLA_OK;
}

static optla_status imitate(scene *s)
{
	trial disc[TRIALS], stripes = {.label = "NNLS, 14 bit", .sensor = sensor_name, .mode = OPTLA_NONNEGATIVE_NNLS};
	OPTLA_TRY(open_scene(s));
	make_disc(s, s->light);
	OPTLA_TRY(run_all(s, disc));
	OPTLA_TRY(show(s, &disc[2 * MODES - 1], "disc", "a soft disc"));
	OPTLA_TRY(
	    plot(s, disc, true, "Error of the photo that the illumination makes, against the photo of the disc without noise."));
	OPTLA_TRY(plot(s, disc, false, "Error of the illumination itself."));
	OPTLA_TRY(measure(s, disc));
	make_stripes(s, s->light);
	OPTLA_TRY(optla_lab_apply_(s->figure, s->truth, OPTLA_FORWARD, s->light, s->photo));
	OPTLA_TRY(run_trial(s, &stripes));
	OPTLA_TRY(show(s, &stripes, "stripes", "stripes one pixel wide"));
	const size_t last = stripes.count - 1;
	OPTLA_TRY(optla_figure_number_(s->figure, stripes.photo_error[last], optla_expect_nothing_("", "reported"),
	                               "%s: error of the photo, stripes, %s, k = %zu", s->name, stripes.label, last + 1));
	return optla_figure_number_(s->figure, stripes.light_error[last], optla_expect_nothing_("", "reported"),
	                            "%s: error of the illumination, stripes, %s, k = %zu", s->name, stripes.label, last + 1);
}

optla_status optla_figure_impostor_(optla_figure *figure)
{
	scene screen = {.figure = figure, .name = "screen"}, corner = {.figure = figure, .name = "corner"};
	optla_figure_say_(
	    figure,
	    "A photo of the scene under one light is given to optical GMRES, which finds a pattern for the projector that makes the "
	    "same photo (Eq. 2.9) in %d iterations. Illumination can't be negative: the solution is taken as it comes, clamped at "
	    "zero, or solved for with the constraint (NNLS). The thesis shows curves of its own scene (a flashlight behind a screen) "
	    "and no numbers but 20 iterations and 80 photos.",
	    (int)ITERATIONS);
	optla_figure_heading_(figure, "Corner behind a diffusing screen: dense, low rank");
	OPTLA_TRY(optla_lab_screen_(figure, &screen.rig));
	optla_lab_say_corner_(figure, screen.rig);
	OPTLA_TRY(imitate(&screen));
	optla_figure_heading_(figure, "Corner lit directly: sparse, high rank");
	OPTLA_TRY(optla_lab_corner_(figure, 48, 32, false, &corner.rig));
	optla_lab_say_corner_(figure, corner.rig);
	OPTLA_TRY(imitate(&corner));
	optla_figure_say_(
	    figure,
	    "Are fine patterns found? Only as far as they reach the photo. Behind the screen each patch lights the whole "
	    "corner softly, neighbouring patches nearly alike: stripes make almost the photo of an even grey, and what tells "
	    "them apart is below the noise. Many illuminations make that photo and GMRES returns one of them, as the thesis "
	    "found: the photo is right, the illumination is not. Lit directly, each stripe stands on a wall, the photo holds "
	    "it and it is found; what stays open is where the camera sees little of the pattern: on the dark red wall, beyond "
	    "the corner's edges, and where stripes are finer than the camera's pixels.");
	optla_figure_say_(
	    figure,
	    "Clamping what comes negative changes the photo by as much as was cut off, which behind the screen is a third of it. "
	    "NNLS has the constraint in the problem, with a price on the part of the light that no photo has shown (see "
	    "optla_krylov_solution), and makes the better photo and the better illumination, most of all with noise.");
	return OPTLA_OK;
}
