/* SPDX-License-Identifier: BSD-3-Clause */
/* Fig. 2.2: optical power iteration (Algorithm 1) on a coaxial corner, judged by the eigenvectors of the exact T. */
#include "math/dense.h"
#include "report/lab.h"

#include <math.h>
#include <string.h>

enum { SIDE = 32, ITERATIONS = 400, NOISY_ITERATIONS = 120, FLOOR_FROM = 80, SHOWN = 5 };

static const size_t shown_after[SHOWN] = {1, 2, 5, 10, 50};

typedef struct {
	optla_figure *figure;
	optla_rig *rig;
	size_t n;
	double *t;                 /* exact T */
	double *value, *vector;    /* LAPACK: eigenvalues in ascending order, vectors */
	const double *principal;   /* the last of them */
	double *start_coefficient; /* of p_1 in the eigenvectors */
	double *shown[SHOWN];      /* p after 1, 2, 5, 10, 50 photos, noiseless */
} experiment;

/* What a run was like after k photos. */
typedef struct {
	double *k, *angle, *eigenvalue, *residual, *recomputed;
	optla_krylov *run;
	optla_op *op;
	size_t count;
} history;

static optla_status prepare(experiment *e)
{
	optla_op *truth;
	OPTLA_TRY(optla_lab_corner_(e->figure, SIDE, SIDE, true, &e->rig));
	OPTLA_TRY(optla_lab_truth_(e->figure, e->rig, OPTLA_CHANNEL_RED, &truth));
	OPTLA_TRY(optla_lab_matrix_(e->figure, truth, &e->t));
	e->n = optla_op_ncols(truth);
	OPTLA_TRY(optla_figure_doubles_(e->figure, e->n, &e->value));
	OPTLA_TRY(optla_figure_doubles_(e->figure, e->n * e->n, &e->vector));
	OPTLA_TRY(optla_figure_doubles_(e->figure, e->n, &e->start_coefficient));
	for (size_t i = 0; i < SHOWN; i++) OPTLA_TRY(optla_figure_doubles_(e->figure, e->n, &e->shown[i]));
	OPTLA_TRY(optla_eigh_(e->figure->ctx, e->t, e->n, e->value, e->vector));
	e->principal = e->vector + (e->n - 1) * e->n;
	for (size_t j = 0; j < e->n; j++) /* p_1 is constant */
		for (size_t i = 0; i < e->n; i++) e->start_coefficient[j] += e->vector[j * e->n + i] / sqrt((double)e->n);
	return OPTLA_OK;
}

/* sin of the angle between p (unit length) and the principal eigenvector. */
static double angle_of(const experiment *e, const double *p)
{
	const double along = optla_lab_dot_(p, e->principal, e->n);
	double sum = 0;
	for (size_t i = 0; i < e->n; i++) sum += (p[i] - along * e->principal[i]) * (p[i] - along * e->principal[i]);
	return sqrt(sum);
}

/* The same after k photos, in exact arithmetic: p_{k+1} ~ T^k p_1 = sum_j c_j λ_j^k v_j. */
static double predicted_angle(const experiment *e, size_t k)
{
	const double largest = e->value[e->n - 1], first = e->start_coefficient[e->n - 1];
	double rest = 0;
	for (size_t j = 0; j + 1 < e->n; j++) {
		const double x = e->start_coefficient[j] / first * pow(e->value[j] / largest, (double)k);
		rest += x * x;
	}
	return sqrt(rest / (1 + rest));
}

/* ||T p - λ p|| / λ with the exact T, λ = pᵀ T p. */
static optla_status recompute(const experiment *e, const double *p, double *w, double *residual)
{
	const size_t n = e->n;
	OPTLA_TRY(optla_dense_apply_(e->figure->ctx, OPTLA_FORWARD, optla_cblock_(e->t, n, n, OPTLA_F64),
	                             optla_cblock_(p, n, 1, OPTLA_F64), optla_block_(w, n, 1, OPTLA_F64)));
	const double lambda = optla_lab_dot_(p, w, n);
	for (size_t i = 0; i < n; i++) w[i] -= lambda * p[i];
	*residual = optla_lab_norm_(w, n) / lambda;
	return OPTLA_OK;
}

static optla_status init_history(experiment *e, const char *sensor, size_t iterations, history *h)
{
	const optla_rig_operator_options o = optla_lab_camera_(e->figure, OPTLA_CHANNEL_RED, sensor);
	double **columns[] = {&h->k, &h->angle, &h->eigenvalue, &h->residual, &h->recomputed};
	for (size_t i = 0; i < sizeof columns / sizeof *columns; i++)
		OPTLA_TRY(optla_figure_doubles_(e->figure, iterations, columns[i]));
	/* patterns and photos are light: one photo for each product */
	OPTLA_TRY(optla_lab_light_photos_(e->figure, e->rig, &o, &h->op));
	optla_krylov_options k = optla_krylov_defaults;
	k.iterations = (int)iterations;
	k.symmetric = true;
	h->count = iterations;
	return optla_lab_create_(e->figure, h->op, OPTLA_KRYLOV_POWER, &k, NULL, NULL, &h->run);
}

static optla_status run(experiment *e, const char *sensor, size_t iterations, history *h)
{
	double *before, *after, *work;
	OPTLA_TRY(init_history(e, sensor, iterations, h));
	OPTLA_TRY(optla_figure_doubles_(e->figure, e->n, &before));
	OPTLA_TRY(optla_figure_doubles_(e->figure, e->n, &after));
	OPTLA_TRY(optla_figure_doubles_(e->figure, e->n, &work));
	for (size_t i = 0; i < e->n; i++) before[i] = 1 / sqrt((double)e->n);
	for (size_t k = 0; k < iterations; k++) {
		OPTLA_TRY(optla_krylov_step(h->run, 1));
		OPTLA_TRY(optla_krylov_principal(h->run, after, &h->eigenvalue[k]));
		OPTLA_TRY(recompute(e, before, work, &h->recomputed[k]));
		h->k[k] = (double)(k + 1);
		h->residual[k] = optla_krylov_get_info(h->run).residual;
		h->angle[k] = angle_of(e, after);
		for (size_t i = 0; i < SHOWN && !sensor; i++)
			if (k + 1 == shown_after[i]) memcpy(e->shown[i], after, e->n * sizeof *after);
		memcpy(before, after, e->n * sizeof *after);
	}
	return OPTLA_OK;
}

static optla_status show_vectors(experiment *e)
{
	enum { PANELS = SHOWN + 2 };
	optla_panel panels[PANELS];
	char caption[PANELS][32] = {"p_1, constant"};
	double *flat;
	OPTLA_TRY(optla_figure_doubles_(e->figure, e->n, &flat));
	for (size_t i = 0; i < e->n; i++) flat[i] = 1 / sqrt((double)e->n);
	for (size_t i = 0; i < PANELS; i++) {
		const double *p = i == 0 ? flat : i <= SHOWN ? e->shown[i - 1] : e->principal;
		optla_image *image;
		OPTLA_TRY(optla_lab_light_(e->figure, e->rig, p, false, &image));
		if (i && i <= SHOWN) snprintf(caption[i], sizeof caption[i], "after %zu photo%s", shown_after[i - 1], i > 1 ? "s" : "");
		if (i > SHOWN) snprintf(caption[i], sizeof caption[i], "LAPACK");
		panels[i] = (optla_panel){image, caption[i]};
	}
	return optla_lab_sheet_(
	    e->figure, panels, PANELS, PANELS, 160, "vectors.png",
	    "The illumination after so many photos without noise, and the principal eigenvector of the exact T. Each picture "
	    "is scaled to its own largest value.");
}

static optla_status plot_convergence(experiment *e, const history *quiet, const history *noisy)
{
	double *theory;
	OPTLA_TRY(optla_figure_doubles_(e->figure, quiet->count, &theory));
	for (size_t k = 0; k < quiet->count; k++) theory[k] = predicted_angle(e, k + 1);
	const optla_series series[] = {{"without noise", quiet->k, quiet->angle, quiet->count},
	                               {"predicted", quiet->k, theory, quiet->count},
	                               {"14-bit camera", noisy->k, noisy->angle, noisy->count}};
	const optla_plot plot = {.size = sizeof plot,
	                         .title = "Distance from the principal eigenvector",
	                         .x_label = "photos",
	                         .y_label = "sin of the angle to the eigenvector",
	                         .log_y = true,
	                         .series = series,
	                         .nseries = 3};
	return optla_figure_plot_(
	    e->figure, &plot, "convergence",
	    "Predicted: from all eigenvalues of the exact T. With noise the error stops falling where a photo brings in as "
	    "much error as an iteration takes out.");
}

/* Largest relative difference of two curves, where the second is above a floor. */
static double largest_deviation(const double *a, const double *b, size_t n, double floor)
{
	double worst = 0;
	for (size_t k = 0; k < n; k++)
		if (b[k] > floor) worst = fmax(worst, fabs(a[k] / b[k] - 1));
	return worst;
}

static optla_status measure_quiet(experiment *e, const history *h)
{
	const size_t n = e->n, last = h->count - 1;
	const double largest = e->value[n - 1], ratio = e->value[n - 2] / largest;
	double *theory;
	OPTLA_TRY(optla_figure_doubles_(e->figure, h->count, &theory));
	for (size_t k = 0; k < h->count; k++) theory[k] = predicted_angle(e, k + 1);
	optla_expect photos = optla_expect_range_(50, 50, "",
	                                          "one photo for each iteration of Algorithm 1; the thesis calls its vectors settled "
	                                          "after about 50");
	photos.thesis = 50;
	/* patterns and photos are light, so a product is one photo */
	OPTLA_TRY(optla_figure_number_(e->figure, (double)optla_krylov_get_info(h->run).photos * 50 / (double)h->count, photos,
	                               "photos for 50 iterations"));
	OPTLA_TRY(
	    optla_figure_number_(e->figure, fabs(h->eigenvalue[last] / largest - 1),
	                         optla_expect_at_most_(1e-6, "",
	                                               "exact value from LAPACK; the error of a symmetric T's eigenvalue is below "
	                                               "the square of the vector's"),
	                         "relative error of the eigenvalue after %zu photos", h->count));
	OPTLA_TRY(
	    optla_figure_number_(e->figure, largest_deviation(h->angle, theory, h->count, 1e-6),
	                         optla_expect_at_most_(1e-6, "",
	                                               "exact arithmetic from all eigenvalues and vectors (LAPACK); rounding adds "
	                                               "about 1e-15 to an angle of at least 1e-6, with room for LAPACK's own"),
	                         "largest relative deviation of the error curve from theory"));
	const double hundredth = e->value[n - 101] / e->value[n - 2];
	const double slope = pow(h->angle[last] / h->angle[last - 100], 0.01);
	OPTLA_TRY(optla_figure_number_(
	    e->figure, slope / ratio,
	    optla_expect_range_(hundredth, 1 + 1e-9, "",
	                        "|λ₂|/|λ₁| is reached from below: the factor is a mean of |λ_j|/|λ₁|, j > 1, by what is "
	                        "left of each eigenvector; after 300 photos those are the first hundred at most"),
	    "convergence factor of the last 100 photos over |λ₂|/|λ₁| = %.5f", ratio));
	return optla_figure_number_(e->figure, largest_deviation(h->residual, h->recomputed, h->count, 1e-6),
	                            optla_expect_at_most_(1e-9, "",
	                                                  "the same formula from the exact T; rounding of 1e-16 over residuals of at "
	                                                  "least 1e-6"),
	                            "largest relative deviation of reported from recomputed residual");
}

/* Where noise and iteration balance: a component j of noise with variance σ² per photo is damped by λ_j/λ_1 in each iteration,
   so it settles at σ² / (λ_1² - λ_j²). The noise is taken as equally strong in each eigenvector. */
static double predicted_floor(const experiment *e, double noise)
{
	const double largest = e->value[e->n - 1], variance = noise * noise / (double)e->n;
	double sum = 0;
	for (size_t j = 0; j + 1 < e->n; j++) sum += variance / (largest * largest - e->value[j] * e->value[j]);
	return sqrt(sum);
}

static optla_status measure_noisy(experiment *e, const history *h)
{
	double sum = 0;
	for (size_t k = FLOOR_FROM; k < h->count; k++) sum += h->angle[k] * h->angle[k];
	const double measured = sqrt(sum / (double)(h->count - FLOOR_FROM));
	OPTLA_TRY(optla_figure_number_(e->figure, measured,
	                               optla_expect_nothing_("", "what is left of the error when noise stops it"),
	                               "14-bit camera: sin of the angle after %d to %zu photos", (int)FLOOR_FROM + 1, h->count));
	return optla_figure_number_(
	    e->figure, measured / predicted_floor(e, optla_op_noise(h->op)),
	    optla_expect_range_(0.5, 2, "",
	                        "balance of sensor noise (Eq. 1.8) and contraction; the prediction takes noise "
	                        "as white, which it is not (bright pixels have more)"),
	    "14-bit camera: that angle over its prediction");
}

optla_status optla_figure_power_iteration_(optla_figure *figure)
{
	experiment e = {.figure = figure};
	history quiet = {0}, noisy = {0};
	OPTLA_TRY(prepare(&e));
	OPTLA_TRY(run(&e, NULL, ITERATIONS, &quiet));
	OPTLA_TRY(run(&e, "dslr-14bit", NOISY_ITERATIONS, &noisy));
	optla_figure_say_(
	    figure, "The scene is lit by what the last photo shows, scaled; the photo of that is the next pattern (Algorithm 1).");
	optla_lab_say_corner_(figure, e.rig);
	optla_figure_say_(
	    figure,
	    "The camera's red channel is used, in which the red wall makes inter-reflection strongest. The thesis shows pictures of "
	    "its "
	    "own scene and no numbers but one: the vectors hardly change after about 50 photos. Here the eigenvectors of T are "
	    "known, "
	    "so the speed can be checked: the largest eigenvalues are %.4g, %.4g and %.4g, and the error falls by %.4f per photo in "
	    "the long run, faster at first.",
	    e.value[e.n - 1], e.value[e.n - 2], e.value[e.n - 3], e.value[e.n - 2] / e.value[e.n - 1]);
	OPTLA_TRY(show_vectors(&e));
	OPTLA_TRY(plot_convergence(&e, &quiet, &noisy));
	OPTLA_TRY(measure_quiet(&e, &quiet));
	return measure_noisy(&e, &noisy);
}
