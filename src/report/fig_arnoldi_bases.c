/* SPDX-License-Identifier: BSD-3-Clause */
/* Fig. 2.6: the illuminations and photos of optical Arnoldi (Algorithm 2, non-symmetric form) on a corner behind a screen and on the
   recorded ball. */
#include "math/dense.h"
#include "report/lab.h"

#include <math.h>

enum { ITERATIONS = 10, SHOWN = 6, ROWS = 4 };

static const size_t shown[SHOWN] = {1, 2, 3, 4, 5, 10};

/* Column k of a block as doubles. */
static optla_status column(optla_figure *figure, optla_cblock block, size_t k, double **out)
{
	OPTLA_TRY(optla_figure_doubles_(figure, block.nrows, out));
	optla_copy_column_(block, k, optla_block_(*out, block.nrows, 1, OPTLA_F64), 0);
	return OPTLA_OK;
}

static optla_status show(optla_figure *figure, const optla_rig *rig, const optla_krylov *run, const char *file,
                         const char *caption)
{
	optla_cblock d, p, r, s;
	OPTLA_TRY(optla_krylov_bases(run, &d, &p, NULL));
	OPTLA_TRY(optla_krylov_dual_bases(run, &r, &s));
	const optla_cblock blocks[ROWS] = {p, d, r, s};
	static const char names[ROWS] = {'p', 'd', 'r', 's'};
	optla_panel panels[ROWS * SHOWN];
	char captions[ROWS * SHOWN][16];
	for (size_t row = 0; row < ROWS; row++)
		for (size_t c = 0; c < SHOWN; c++) {
			const size_t at = row * SHOWN + c;
			const bool of_light = names[row] == 'p' || names[row] == 's';
			double *v;
			optla_image *image;
			OPTLA_TRY(column(figure, blocks[row], shown[c] - 1, &v));
			OPTLA_TRY(of_light ? optla_lab_light_(figure, rig, v, true, &image)
			                   : optla_lab_signed_photo_(figure, rig, v, &image));
			snprintf(captions[at], sizeof captions[at], "%c_%zu", names[row], shown[c]);
			panels[at] = (optla_panel){image, captions[at]};
		}
	return optla_lab_sheet_(figure, panels, ROWS * SHOWN, SHOWN, 150, file, caption);
}

/* Largest entry of |PᵀP - I|. */
static double orthogonality(optla_cblock p)
{
	double worst = 0;
	for (size_t i = 0; i < p.ncols; i++)
		for (size_t j = 0; j <= i; j++) worst = fmax(worst, fabs(optla_dot_(p, i, p, j) - (i == j)));
	return worst;
}

/* Cosine between light vector p_2 and s_1 with p_1 taken out: Algorithm 2 says that they are the same direction. */
static double next_from_last(optla_cblock p, optla_cblock s)
{
	double sp = optla_dot_(s, 0, p, 0), along = optla_dot_(s, 0, p, 1), norm = optla_norm_(s, 0);
	return along / sqrt(norm * norm - sp * sp);
}

static optla_status measure(optla_figure *figure, const char *name, const optla_krylov *run, optla_scalar type)
{
	optla_cblock p, r, s;
	const optla_krylov_info info = optla_krylov_get_info(run);
	OPTLA_TRY(optla_krylov_bases(run, NULL, &p, NULL));
	OPTLA_TRY(optla_krylov_dual_bases(run, &r, &s));
	optla_expect photos =
	    optla_expect_range_(4 * ITERATIONS, 4 * ITERATIONS, "",
	                        "two photos for each product with T and with its transpose (Eq. 2.4); the thesis: 40 for ten "
	                        "iterations");
	photos.thesis = 40;
	OPTLA_TRY(optla_figure_number_(figure, (double)info.photos, photos, "%s: photos for %d iterations", name, (int)ITERATIONS));
	/* 1000 times the rounding of one stored number: sums over up to a thousand lights after two passes of Gram-Schmidt */
	const double eps = type == OPTLA_F64 ? 2.2e-16 : 1.2e-7;
	OPTLA_TRY(
	    optla_figure_number_(figure, orthogonality(p),
	                         optla_expect_at_most_(1000 * eps, "",
	                                               "the illuminations are orthonormal to rounding: twice "
	                                               "orthogonalised is enough (Giraud et al. 2005); sums of up to 1000 terms"),
	                         "%s: largest entry of |PᵀP − I|", name));
	return optla_figure_number_(figure, 1 - next_from_last(p, s),
	                            optla_expect_range_(-1e4 * eps, 1e4 * eps, "",
	                                                "Algorithm 2: p_2 is s_1 without its part along p_1; the part "
	                                                "left is 1e-2 of s_1 or more, hence 1e4 roundings"),
	                            "%s: 1 − cos(p_2, s_1 without p_1)", name);
}

static optla_status on_rig(optla_figure *figure, optla_rig *rig, const char *name, optla_channel channel, const char *sensor,
                           const char *file, const char *caption)
{
	const optla_rig_operator_options o = optla_lab_camera_(figure, channel, sensor);
	optla_op *photos;
	OPTLA_TRY(optla_lab_photos_(figure, rig, &o, &photos));
	optla_krylov_options k = optla_krylov_defaults;
	k.iterations = ITERATIONS;
	optla_krylov *run;
	OPTLA_TRY(optla_lab_run_(figure, photos, OPTLA_KRYLOV_ARNOLDI, &k, NULL, NULL, &run));
	OPTLA_TRY(show(figure, rig, run, file, caption));
	return measure(figure, name, run, optla_op_type(photos));
}

optla_status optla_figure_arnoldi_bases_(optla_figure *figure)
{
	optla_figure_say_(
	    figure, "Ten iterations of optical Arnoldi for a T that isn't symmetric: p_k is shown by the projector, the camera "
	            "answers with d_k; r_k, which is d_k scaled to length one, is shown from the camera's side, and the projector's "
	            "side answers with s_k, from which the next p comes. Red is positive, blue is negative light; each picture is "
	            "scaled to its own largest magnitude. The scenes aren't the thesis', so the pictures can be compared in kind "
	            "only: p_1 and d_1 are positive, s_k is smooth, and later components show ever finer detail.");
	optla_rig *screen, *ball;
	optla_figure_heading_(figure, "Corner behind a diffusing screen, 14-bit camera");
	OPTLA_TRY(optla_lab_screen_(figure, &screen));
	optla_lab_say_corner_(figure, screen);
	OPTLA_TRY(on_rig(figure, screen, "screen", OPTLA_CHANNEL_GREY, "dslr-14bit", "screen.png",
	                 "Corner behind a screen: p_k on the screen, d_k and r_k at the camera, s_k at the screen."));
	optla_figure_heading_(figure, "Ball under 96 lights, 14-bit camera");
	OPTLA_TRY(optla_lab_ball_(figure, &ball));
	if (!ball) return OPTLA_OK;
	optla_lab_say_ball_(figure, ball);
	return on_rig(figure, ball, "ball", OPTLA_CHANNEL_GREEN, "dslr-14bit", "ball.png",
	              "Ball: p_k and s_k are one number for each light, drawn where the light stands; d_k and r_k are photos.");
}
