/* SPDX-License-Identifier: BSD-3-Clause */
/* Error curves of all methods on one rig. */
#include "report/curves.h"

#include <math.h>

static const struct {
	optla_curve_method curve;
	optla_capture method;
	const char *label;
} rivals[] = {
    {OPTLA_CURVE_SVD, OPTLA_CAPTURE_SVD, "optimal (SVD)"},
    {OPTLA_CURVE_NYSTROEM, OPTLA_CAPTURE_NYSTROEM, "Nyström"},
    {OPTLA_CURVE_KERNEL, OPTLA_CAPTURE_KERNEL_NYSTROEM, "kernel Nyström"},
    {OPTLA_CURVE_DCT, OPTLA_CAPTURE_DCT, "DCT"},
    {OPTLA_CURVE_HADAMARD, OPTLA_CAPTURE_HADAMARD, "Hadamard"},
    {OPTLA_CURVE_SINGLE, OPTLA_CAPTURE_SINGLE, "one light at a time"},
};

/* Exposure of photos under single lights, as a multiple of the others (section 2.5.1). */
static const double single_exposure = 2;

static optla_status init_curve(optla_figure *figure, const char *label, size_t count, optla_curve *c)
{
	*c = (optla_curve){.label = label, .count = count};
	double **columns[] = {&c->k, &c->photos, &c->exposure_s, &c->error, &c->exponent};
	for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) OPTLA_TRY(optla_figure_doubles_(figure, count, columns[i]));
	return OPTLA_OK;
}

static optla_status arnoldi(optla_figure *figure, const optla_curves_job *job, optla_op *photos, optla_op *truth,
                            const char *label, optla_curve *curve)
{
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = (int)job->iterations;
	optla_krylov *run;
	OPTLA_TRY(optla_lab_run_(figure, photos, OPTLA_KRYLOV_ARNOLDI, &o, NULL, NULL, &run));
	optla_cblock d, p;
	OPTLA_TRY(optla_krylov_bases(run, &d, &p, NULL));
	OPTLA_TRY(init_curve(figure, label, d.ncols, curve));
	OPTLA_TRY(optla_relative_errors(d, p, truth, curve->error));
	const optla_krylov_info info = optla_krylov_get_info(run);
	for (size_t k = 0; k < d.ncols; k++) { /* each iteration costs the same, but for what the offset takes once */
		const double share = (double)(k + 1) / (double)info.iterations;
		curve->k[k] = (double)(k + 1);
		curve->photos[k] = share * (double)info.photos;
		curve->exposure_s[k] = share * info.exposure_s;
		curve->exponent[k] = 1;
	}
	return OPTLA_OK;
}

static void copy_points(const optla_capture_point *points, optla_curve *c)
{
	for (size_t i = 0; i < c->count; i++) {
		c->k[i] = (double)points[i].k;
		c->photos[i] = (double)points[i].photos;
		c->exposure_s[i] = points[i].exposure_s;
		c->error[i] = points[i].relative_error;
		c->exponent[i] = points[i].exponent;
	}
}

/* The optimum is shown where Arnoldi stands after as many iterations. */
static void lend_photos(const optla_curve *arnoldi_curve, optla_curve *c)
{
	for (size_t i = 0; i < c->count; i++) {
		const size_t k = (size_t)c->k[i];
		const bool there = k >= 1 && k <= arnoldi_curve->count;
		c->photos[i] = there ? arnoldi_curve->photos[k - 1] : NAN;
		c->exposure_s[i] = there ? arnoldi_curve->exposure_s[k - 1] : NAN;
	}
}

static optla_status measure_rivals(optla_figure *figure, const optla_curves_job *job, optla_op *photos, optla_op *single,
                                   optla_op *truth, optla_curve curves[OPTLA_CURVES])
{
	optla_rig_info info;
	optla_rig_get_info(job->rig, &info);
	const optla_capture_options o = {.size = sizeof o, .seed = figure->seed, .ks = job->ks, .nks = job->nks};
	optla_capture_point *points = optla_calloc_(figure->ctx, job->nks, sizeof *points);
	optla_status s = points ? OPTLA_OK : OPTLA_ERR_NOMEM;
	for (size_t r = 0; r < sizeof rivals / sizeof *rivals && OPTLA_OK == s; r++) {
		optla_curve *c = &curves[rivals[r].curve];
		s = optla_capture_curve(rivals[r].method, photos, single, truth, info.light_width, info.light_height, &o, points);
		if (OPTLA_OK == s) s = init_curve(figure, rivals[r].label, job->nks, c);
		if (OPTLA_OK == s) copy_points(points, c);
	}
	optla_free(figure->ctx, points);
	return s;
}

optla_status optla_curves_measure_(optla_figure *figure, const optla_curves_job *job, optla_curve curves[OPTLA_CURVES])
{
	optla_op *truth, *photos, *offset, *single;
	optla_rig_operator_options o = optla_lab_camera_(figure, job->channel, job->sensor);
	OPTLA_TRY(optla_lab_truth_(figure, job->rig, job->channel, &truth));
	OPTLA_TRY(optla_lab_photos_(figure, job->rig, &o, &photos));
	OPTLA_TRY(arnoldi(figure, job, photos, truth, "optical Arnoldi", &curves[OPTLA_CURVE_ARNOLDI]));
	o.split = OPTLA_SPLIT_OFFSET;
	o.seed = figure->seed + 2;
	OPTLA_TRY(optla_lab_photos_(figure, job->rig, &o, &offset));
	OPTLA_TRY(arnoldi(figure, job, offset, truth, "Arnoldi with offset", &curves[OPTLA_CURVE_OFFSET]));
	o.exposure = single_exposure;
	o.seed = figure->seed + 1;
	OPTLA_TRY(optla_lab_light_photos_(figure, job->rig, &o, &single));
	OPTLA_TRY(measure_rivals(figure, job, photos, single, truth, curves));
	lend_photos(&curves[OPTLA_CURVE_ARNOLDI], &curves[OPTLA_CURVE_SVD]);
	return OPTLA_OK;
}

double optla_curve_error_(const optla_curve *curve, size_t k)
{
	for (size_t i = 0; i < curve->count; i++)
		if ((size_t)curve->k[i] == k) return curve->error[i];
	return NAN;
}
