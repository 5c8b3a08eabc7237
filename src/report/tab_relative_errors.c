/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 2.11 as a table: relative error by method and k, without noise. */
#include "report/curves.h"

#include <math.h>

static const size_t ks[] = {5, 10, 20, 30, 40};
enum { KS = sizeof ks / sizeof *ks };

static optla_status table(optla_figure *figure, const optla_curve *curves)
{
	char cells[KS + 1][32] = {"method"};
	const char *row[KS + 1];
	for (size_t i = 0; i <= KS; i++) row[i] = cells[i];
	for (size_t i = 0; i < KS; i++) snprintf(cells[i + 1], sizeof cells[i + 1], "k = %zu", ks[i]);
	optla_figure_row_(figure, true, row, KS + 1);
	for (int m = 0; m < OPTLA_CURVES; m++) {
		snprintf(cells[0], sizeof cells[0], "%s", curves[m].label);
		for (size_t i = 0; i < KS; i++)
			snprintf(cells[i + 1], sizeof cells[i + 1], "%.4f", optla_curve_error_(&curves[m], ks[i]));
		optla_figure_row_(figure, false, row, KS + 1);
	}
	return figure->body.status;
}

static optla_status numbers(optla_figure *figure, const char *name, const optla_curve *curves)
{
	double least = INFINITY, growth = 0;
	for (int m = 0; m < OPTLA_CURVES; m++)
		for (size_t i = 0; i < KS && m != OPTLA_CURVE_KERNEL; i++) /* its T_k isn't of rank k */
			least = fmin(least, optla_curve_error_(&curves[m], ks[i]) / optla_curve_error_(&curves[OPTLA_CURVE_SVD], ks[i]));
	OPTLA_TRY(optla_figure_number_(figure, least,
	                               optla_expect_range_(1 - 1e-6, 1 + 1e-6, "",
	                                                   "nothing of rank k is below the optimum (Eckart and Young 1936), which "
	                                                   "itself has the ratio 1"),
	                               "%s: smallest ratio of an error to the optimum, all but kernel Nyström", name));
	for (size_t k = 2; k <= ks[KS - 1]; k++)
		growth = fmax(growth, optla_curve_error_(&curves[OPTLA_CURVE_ARNOLDI], k) /
		                          optla_curve_error_(&curves[OPTLA_CURVE_ARNOLDI], k - 1));
	OPTLA_TRY(optla_figure_number_(
	    figure, growth, optla_expect_at_most_(1 + 1e-6, "", "T_k = T P_k P_kᵀ: one more orthonormal vector can't make it worse"),
	    "%s: largest factor from one Arnoldi iteration to the next", name));
	return optla_figure_number_(figure, optla_curve_error_(&curves[OPTLA_CURVE_ARNOLDI], 10),
	                            optla_expect_nothing_("", "the thesis relights from ten iterations"),
	                            "%s: error of Arnoldi, k = 10", name);
}

static optla_status on_rig(optla_figure *figure, optla_rig *rig, const char *name, optla_channel channel)
{
	const optla_curves_job job = {.rig = rig, .channel = channel, .iterations = 40, .ks = ks, .nks = KS};
	optla_curve curves[OPTLA_CURVES];
	OPTLA_TRY(optla_curves_measure_(figure, &job, curves));
	OPTLA_TRY(table(figure, curves));
	return numbers(figure, name, curves);
}

optla_status optla_figure_relative_errors_(optla_figure *figure)
{
	optla_rig *rig;
	optla_figure_say_(
	    figure, "Relative error of T_k under the Frobenius norm, without noise: ||T_k − T|| / ||T||. k counts iterations of "
	            "Arnoldi, rows and columns of Nyström, patterns of the bases, and the rank of the optimum.");
	optla_figure_heading_(figure, "Corner behind a diffusing screen");
	OPTLA_TRY(optla_lab_screen_(figure, &rig));
	optla_lab_say_corner_(figure, rig);
	OPTLA_TRY(on_rig(figure, rig, "screen", OPTLA_CHANNEL_GREY));
	optla_figure_heading_(figure, "Corner lit directly");
	OPTLA_TRY(optla_lab_corner_(figure, 48, 32, false, &rig));
	optla_lab_say_corner_(figure, rig);
	OPTLA_TRY(on_rig(figure, rig, "corner", OPTLA_CHANNEL_GREY));
	optla_figure_heading_(figure, "Ball under 96 lights, green channel");
	OPTLA_TRY(optla_lab_ball_(figure, &rig));
	if (!rig) return OPTLA_OK;
	optla_lab_say_ball_(figure, rig);
	return on_rig(figure, rig, "ball", OPTLA_CHANNEL_GREEN);
}
