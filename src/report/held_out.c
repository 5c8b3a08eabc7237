/* SPDX-License-Identifier: BSD-3-Clause */
/* Relighting under lights that no photo was taken with. Every eighth light of the recording is held out; T is captured with the others
   by optical Arnoldi; a held-out light is put together from the others around it and relit, and compared with its real photo. */
#include "report/held_out.h"

#include "math/dense.h"

#include <math.h>
#include <string.h>

enum { EVERY = 8, FIRST = 4, STEPS = 3, MOST = 20 };
static const size_t steps[STEPS] = {5, 10, MOST};

/* Price of distance in the light that is put together: of the mixtures that give a direction equally well the one of nearer lights wins. */
static const double locality = 0.1;

typedef struct {
	optla_figure *figure;
	optla_rig *rig;
	optla_rig_info info;
	size_t n, ntrain, nheld; /* pixels, lights that T is captured with, lights held out */
	double *t, *t_train;     /* n x nlights, n x ntrain */
	float *d;                /* Arnoldi's photos, n x MOST */
	double *p;               /* Arnoldi's illuminations, ntrain x MOST */
	double *weight;          /* ntrain x nheld: held-out lights made of the others */
	double worst_deg;        /* largest angle between such a light and the real one */
	double held_psnr[STEPS + 1], train_psnr[STEPS], train_error[STEPS], eq211[STEPS]; /* last: with all photos */
	double *relit;
} experiment;

/* Lights FIRST, FIRST + EVERY, ... are held out. */
static size_t held_light(size_t h) { return FIRST + h * EVERY; }
static size_t train_light(size_t i) { return i / (EVERY - 1) * EVERY + i % (EVERY - 1) + (i % (EVERY - 1) >= FIRST); }

static const double *direction(const experiment *e, size_t light) { return e->info.light_direction + 3 * light; }

static double angle(const double a[3], const double b[3])
{
	const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
	return acos(
	    optla_clamp_(dot / sqrt((a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) * (b[0] * b[0] + b[1] * b[1] + b[2] * b[2])), -1, 1));
}

/* w >= 0 with sum_i w_i l_i ~ l and few far lights: min ||L w - l||² + locality² sum_i (angle_i w_i)². For a Lambertian surface away
   from shadow borders the mixture's photo is then exact. */
static optla_status make_light(experiment *e, double *a, double *b, size_t h)
{
	const size_t rows = 3 + e->ntrain;
	const double *l = direction(e, held_light(h));
	double sum[3] = {0};
	memset(a, 0, rows * e->ntrain * sizeof *a);
	memset(b, 0, rows * sizeof *b);
	memcpy(b, l, 3 * sizeof *b);
	for (size_t i = 0; i < e->ntrain; i++) {
		memcpy(a + i * rows, direction(e, train_light(i)), 3 * sizeof *a);
		a[i * rows + 3 + i] = locality * angle(direction(e, train_light(i)), l);
	}
	double *w = e->weight + h * e->ntrain;
	OPTLA_TRY(optla_nnls_(e->figure->ctx, a, rows, e->ntrain, b, w, NULL));
	for (size_t i = 0; i < e->ntrain; i++)
		for (int c = 0; c < 3; c++) sum[c] += w[i] * direction(e, train_light(i))[c];
	e->worst_deg = fmax(e->worst_deg, angle(sum, l) * 57.29577951308232);
	return OPTLA_OK;
}

static optla_status prepare(experiment *e)
{
	optla_figure *f = e->figure;
	optla_op *truth;
	double *a, *b;
	optla_rig_get_info(e->rig, &e->info);
	OPTLA_CHECK(f->ctx, e->info.light_direction && e->info.nlights > 4 * EVERY, OPTLA_ERR_UNSUPPORTED,
	            "rig '%s': held-out lights need at least %d lights with directions", e->info.name, 4 * EVERY + 1);
	e->nheld = (e->info.nlights - FIRST + EVERY - 1) / EVERY;
	e->ntrain = e->info.nlights - e->nheld;
	OPTLA_TRY(optla_lab_truth_(f, e->rig, OPTLA_CHANNEL_GREEN, &truth));
	OPTLA_TRY(optla_lab_matrix_(f, truth, &e->t));
	e->n = e->info.npixels;
	OPTLA_TRY(optla_figure_doubles_(f, e->n * e->ntrain, &e->t_train));
	OPTLA_TRY(optla_figure_doubles_(f, e->n, &e->relit));
	OPTLA_TRY(optla_figure_doubles_(f, e->ntrain * e->nheld, &e->weight));
	OPTLA_TRY(optla_figure_doubles_(f, (3 + e->ntrain) * e->ntrain, &a));
	OPTLA_TRY(optla_figure_doubles_(f, 3 + e->ntrain, &b));
	for (size_t i = 0; i < e->ntrain; i++) memcpy(e->t_train + i * e->n, e->t + train_light(i) * e->n, e->n * sizeof *e->t);
	for (size_t h = 0; h < e->nheld; h++) OPTLA_TRY(make_light(e, a, b, h));
	return OPTLA_OK;
}

static optla_status capture(experiment *e)
{
	optla_krylov_options o = optla_krylov_defaults;
	optla_op *op;
	optla_krylov *run;
	optla_cblock d, p;
	double errors[MOST];
	o.iterations = MOST;
	OPTLA_TRY(optla_lab_dense_(e->figure, e->t_train, e->n, e->ntrain, &op));
	OPTLA_TRY(optla_lab_run_(e->figure, op, OPTLA_KRYLOV_ARNOLDI, &o, NULL, NULL, &run));
	OPTLA_TRY(optla_krylov_bases(run, &d, &p, NULL));
	OPTLA_CHECK(e->figure->ctx, d.ncols == MOST, OPTLA_ERR_INPUT, "rig '%s': its T has rank %zu, at least %d is needed",
	            e->info.name, d.ncols, (int)MOST);
	OPTLA_TRY(optla_relative_errors(d, p, op, errors));
	for (int i = 0; i < STEPS; i++) e->eq211[i] = errors[steps[i] - 1];
	OPTLA_TRY(optla_lab_floats_(e->figure, e->n * MOST, &e->d));
	OPTLA_TRY(optla_figure_doubles_(e->figure, e->ntrain * MOST, &e->p));
	for (size_t k = 0; k < MOST; k++) {
		optla_copy_column_(d, k, optla_block_(e->d, e->n, MOST, OPTLA_F32), k);
		optla_copy_column_(p, k, optla_block_(e->p, e->ntrain, MOST, OPTLA_F64), k);
	}
	return OPTLA_OK;
}

/* relit = D_k (P_kᵀ w); w NULL: the single light `light`. k = 0: straight from all photos. */
static optla_status relight(experiment *e, size_t k, const double *w, size_t light)
{
	float c[MOST] = {0};
	if (k == 0) {
		memset(e->relit, 0, e->n * sizeof *e->relit);
		for (size_t i = 0; i < e->ntrain; i++)
			for (size_t m = 0; m < e->n && w[i] != 0; m++) e->relit[m] += w[i] * e->t_train[i * e->n + m];
		return OPTLA_OK;
	}
	for (size_t j = 0; j < k; j++)
		c[j] = (float)(w ? optla_lab_dot_(e->p + j * e->ntrain, w, e->ntrain) : e->p[j * e->ntrain + light]);
	float *y = optla_array_(e->figure->ctx, e->n, sizeof *y);
	if (!y) return OPTLA_ERR_NOMEM;
	const optla_status s = optla_relight_combine(e->figure->ctx, e->d, e->n, e->n, k, c, y);
	for (size_t m = 0; m < e->n && OPTLA_OK == s; m++) e->relit[m] = (double)y[m];
	optla_free(e->figure->ctx, y);
	return s;
}

static optla_status compare(experiment *e)
{
	for (size_t i = 0; i <= STEPS; i++)
		for (size_t h = 0; h < e->nheld; h++) {
			OPTLA_TRY(relight(e, i < STEPS ? steps[i] : 0, e->weight + h * e->ntrain, 0));
			e->held_psnr[i] += optla_lab_psnr_db_(e->relit, e->t + held_light(h) * e->n, e->n) / (double)e->nheld;
		}
	for (size_t i = 0; i < STEPS; i++) {
		double error = 0, norm = 0;
		for (size_t j = 0; j < e->ntrain; j++) {
			const double *truth = e->t_train + j * e->n;
			OPTLA_TRY(relight(e, steps[i], NULL, j));
			e->train_psnr[i] += optla_lab_psnr_db_(e->relit, truth, e->n) / (double)e->ntrain;
			error += pow(optla_lab_relative_(e->relit, truth, e->n) * optla_lab_norm_(truth, e->n), 2);
			norm += pow(optla_lab_norm_(truth, e->n), 2);
		}
		e->train_error[i] = sqrt(error / norm);
	}
	return OPTLA_OK;
}

static optla_status show(experiment *e)
{
	enum { COLUMNS = STEPS + 2, AMPLIFICATION = 4 };
	optla_panel panels[2 * COLUMNS] = {{0}};
	char caption[COLUMNS][64];
	const size_t h = e->nheld / 2;
	const double *truth = e->t + held_light(h) * e->n;
	double exposure;
	OPTLA_TRY(optla_lab_exposure_(e->figure, e->rig, truth, &exposure));
	for (size_t i = 0; i < COLUMNS; i++) {
		optla_image *image;
		const size_t k = i >= 1 && i <= STEPS ? steps[i - 1] : 0;
		if (i) OPTLA_TRY(relight(e, k, e->weight + h * e->ntrain, 0));
		const double *photo = i ? e->relit : truth;
		OPTLA_TRY(optla_lab_photo_(e->figure, e->rig, photo, exposure, &image));
		if (i == 0) snprintf(caption[i], sizeof caption[i], "real photo, light %zu", held_light(h));
		if (k) snprintf(caption[i], sizeof caption[i], "Arnoldi, k = %zu\n%.1f dB", k, optla_lab_psnr_db_(photo, truth, e->n));
		if (i > STEPS)
			snprintf(caption[i], sizeof caption[i], "all %zu photos\n%.1f dB", e->ntrain, optla_lab_psnr_db_(photo, truth, e->n));
		panels[i] = (optla_panel){image, caption[i]};
		if (i == 0) continue;
		OPTLA_TRY(optla_lab_difference_(e->figure, e->rig, photo, truth, exposure, AMPLIFICATION, &image));
		panels[COLUMNS + i] = (optla_panel){image, "difference × 4"};
	}
	return optla_lab_sheet_(
	    e->figure, panels, 2 * COLUMNS, COLUMNS, 200, "held-out.png",
	    "A light that was held out: its real photo, relit from k iterations, and mixed from all other photos; differences "
	    "amplified four times. All at the same exposure.");
}

static optla_status measure(experiment *e)
{
	optla_figure *f = e->figure;
	for (size_t i = 0; i < STEPS; i++)
		OPTLA_TRY(optla_figure_number_(f, e->held_psnr[i], optla_expect_nothing_("dB", "reported: mean over the held-out lights"),
		                               "ball: mean PSNR of %zu held-out lights, k = %zu", e->nheld, steps[i]));
	OPTLA_TRY(optla_figure_number_(f, e->held_psnr[STEPS], optla_expect_nothing_("dB", "what mixing lights can give at best"),
	                               "ball: the same, mixed from all %zu photos", e->ntrain));
	for (size_t i = 0; i < STEPS; i++) {
		OPTLA_TRY(optla_figure_number_(f, e->train_psnr[i],
		                               optla_expect_nothing_("dB", "reported: lights that T was captured with"),
		                               "ball: mean PSNR of %zu captured lights, k = %zu", e->ntrain, steps[i]));
		OPTLA_TRY(optla_figure_number_(f, e->train_error[i] / e->eq211[i],
		                               optla_expect_range_(1 - 1e-4, 1 + 1e-4, "",
		                                                   "relit photos of all captured lights are the columns of T_k; "
		                                                   "photos are combined in single precision"),
		                               "ball: error of those photos over Eq. 2.11, k = %zu", steps[i]));
	}
	return optla_figure_number_(f, e->worst_deg,
	                            optla_expect_at_most_(3, "degrees",
	                                                  "a fraction of the distance between neighbours on the "
	                                                  "dome, or the mixture would be of another light"),
	                            "ball: largest angle between a mixed and the real light");
}

optla_status optla_figure_held_out_(optla_figure *figure)
{
	experiment e = {.figure = figure};
	optla_figure_heading_(figure, "Held-out lights of the ball, green channel");
	OPTLA_TRY(optla_lab_ball_(figure, &e.rig));
	if (!e.rig) return OPTLA_OK;
	optla_lab_say_ball_(figure, e.rig);
	OPTLA_TRY(prepare(&e));
	OPTLA_TRY(capture(&e));
	OPTLA_TRY(compare(&e));
	optla_figure_say_(
	    figure,
	    "Every eighth light, %zu of %zu, is held out. T is captured with the others; a held-out light is then made of its "
	    "neighbours "
	    "(non-negative weights that give its direction, the nearer the better) and relit. Two errors add up: that of rank k, "
	    "which "
	    "the captured lights show alone, and that of mixing photos of neighbouring lights, which all photos together show alone: "
	    "shadow borders and highlights move from light to light, and a mixture shows several of each, fainter.",
	    e.nheld, e.info.nlights);
	OPTLA_TRY(show(&e));
	return measure(&e);
}
