/* SPDX-License-Identifier: BSD-3-Clause */
/* The parts of the demonstration that any rig can show: capture, relight, invert, dual. Each adds a heading with pictures and numbers. */
#ifndef OPTLA_DEMO_SCENE_H
#define OPTLA_DEMO_SCENE_H

#include "report/lab.h"

/* What the scene is known to reach with the default sensor, with room for the noise of another seed; infinite: nothing is known. */
typedef struct {
	double capture_error, capture_over_best, relit_psnr_db, inverse_error;
} demo_expect;

typedef struct {
	optla_figure *figure;
	optla_rig *rig;
	optla_rig_info info;
	const char *sensor_name;
	const optla_sensor *sensor;
	demo_expect expect;
	optla_op *truth, *truth_grey; /* all channels; their mean */
	optla_model *model;           /* of demo_capture() */
	uint64_t photos;              /* taken so far, all parts together */
	double exposure_s;
} demo_scene;

/* A light to show the scene under: nlights values, and a few words. */
typedef struct {
	const double *light;
	const char *words;
} demo_light;

/* Truth operators and sensor; everything is held by the figure. */
optla_status demo_scene_init(demo_scene *scene, optla_figure *figure, optla_rig *rig, const char *sensor,
                             const demo_expect *expect);
/* Arnoldi with and without noise beside the best possible: error curves, the components, the model. */
optla_status demo_capture(demo_scene *scene, int iterations);
/* Truth, relit, difference for each light. */
optla_status demo_relight(demo_scene *scene, const demo_light *lights, size_t count);
/* The photo under a hidden light is all that GMRES gets. */
optla_status demo_invert(demo_scene *scene, const demo_light *hidden, int iterations);
/* One photo from the projector's side, beside the one from the camera's. */
optla_status demo_dual(demo_scene *scene);
/* What all of it has cost. */
void demo_say_cost(const demo_scene *scenes, size_t count);

#endif
