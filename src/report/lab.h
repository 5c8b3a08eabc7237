/* SPDX-License-Identifier: BSD-3-Clause */
/* What the experiments share: rigs, operators and runs that the figure holds until its end, small measures, pictures of vectors. */
#ifndef OPTLA_LAB_H
#define OPTLA_LAB_H

#include "optla/krylov.h"
#include "optla/relight.h"
#include "optla/rig.h"
#include "report/figure.h"
#include "report/panel.h"

/* ---- rigs ---- */

/* The built-in corner without a file: camera² and projector² pixels. */
optla_status optla_lab_corner_(optla_figure *figure, size_t camera, size_t projector, bool coaxial, optla_rig **rig);
/* The corner behind a diffusing screen (the arrangement of Fig. 2.3(b)). */
optla_status optla_lab_screen_(optla_figure *figure, optla_rig **rig);
/* The 96 photos of a ball. Without the data *rig is NULL and the section says what was left out. */
optla_status optla_lab_ball_(optla_figure *figure, optla_rig **rig);
/* Some words on the scene and how it differs from the thesis'. */
void optla_lab_say_corner_(optla_figure *figure, const optla_rig *rig);
void optla_lab_say_ball_(optla_figure *figure, const optla_rig *rig);

/* count floats, zeroed. */
optla_status optla_lab_floats_(optla_figure *figure, size_t count, float **out);

/* ---- operators ---- */

optla_status optla_lab_truth_(optla_figure *figure, optla_rig *rig, optla_channel channel, optla_op **op);
/* How photos are taken: the figure's seed, this camera (NULL: none), two photos for each product as in the thesis (Eq. 2.4). */
optla_rig_operator_options optla_lab_camera_(const optla_figure *figure, optla_channel channel, const char *sensor);
/* The signed operator made of photos; its type is that of the rig's truth. options->type is ignored. */
optla_status optla_lab_photos_(optla_figure *figure, optla_rig *rig, const optla_rig_operator_options *options, optla_op **op);
/* The same photos as light alone: x >= 0, one photo for each product. */
optla_status optla_lab_light_photos_(optla_figure *figure, optla_rig *rig, const optla_rig_operator_options *options,
                                     optla_op **op);
/* All of an operator as doubles, column-major. */
optla_status optla_lab_matrix_(optla_figure *figure, optla_op *op, double **matrix);
/* y = op x in doubles whatever the operator's type; one column. */
optla_status optla_lab_apply_(optla_figure *figure, optla_op *op, optla_trans trans, const double *x, double *y);
/* A matrix of doubles as an operator. */
optla_status optla_lab_dense_(optla_figure *figure, const double *matrix, size_t nrows, size_t ncols, optla_op **op);

/* ---- runs ---- */

/* Creates and holds a run that hasn't begun. start and target are doubles (NULL: none) and are converted to the operator's type. */
optla_status optla_lab_create_(optla_figure *figure, optla_op *op, optla_krylov_method method,
                               const optla_krylov_options *options, const double *start, const double *target,
                               optla_krylov **run);
/* The same, run to its end. */
optla_status optla_lab_run_(optla_figure *figure, optla_op *op, optla_krylov_method method, const optla_krylov_options *options,
                            const double *start, const double *target, optla_krylov **run);

/* ---- measures of vectors ---- */

double optla_lab_norm_(const double *x, size_t n);
double optla_lab_dot_(const double *x, const double *y, size_t n);
/* ||a - b|| / ||b|| */
double optla_lab_relative_(const double *a, const double *b, size_t n);
/* 10 log10(peak² / mean (a - b)²), peak the largest of b. Two equal vectors give infinity. */
double optla_lab_psnr_db_(const double *a, const double *b, size_t n);

/* ---- pictures, DISPLAY, held ---- */

/* Grey picture of row values. */
optla_status optla_lab_photo_(optla_figure *figure, const optla_rig *rig, const double *values, double exposure,
                              optla_image **out);
/* Red positive, blue negative, white zero (Fig. 2.6). */
optla_status optla_lab_signed_photo_(optla_figure *figure, const optla_rig *rig, const double *values, optla_image **out);
/* Light values: on the projector's grid, or as discs seen from the scene when the lights have only directions. */
optla_status optla_lab_light_(optla_figure *figure, const optla_rig *rig, const double *values, bool with_sign,
                              optla_image **out);
/* Amplified |a - b| of row values, same exposure. */
optla_status optla_lab_difference_(optla_figure *figure, const optla_rig *rig, const double *a, const double *b, double exposure,
                                   double amplification, optla_image **out);
/* Exposure that brings the 0.995 quantile of these values to white. */
optla_status optla_lab_exposure_(optla_figure *figure, const optla_rig *rig, const double *values, double *exposure);
optla_status optla_lab_sheet_(optla_figure *figure, const optla_panel *panels, size_t count, size_t columns, size_t cell_px,
                              const char *file, const char *caption);

#endif
