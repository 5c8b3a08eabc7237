/* SPDX-License-Identifier: BSD-3-Clause */
/* optla krylov: what its two files share. */
#ifndef OPTLA_KRYLOV_JOB_H
#define OPTLA_KRYLOV_JOB_H

#include "rig_run.h"

#include "optla/krylov.h"
#include "optla/relight.h"

typedef struct {
	size_t size;
	const char *target, *state, *resume;
	bool high, truth;
} krylov_extra_options;

typedef struct {
	optla_krylov_options krylov;
	optla_rig_operator_options op;
	cli_sensor_options sensor;
	cli_picture_options picture;
	krylov_extra_options extra;
} krylov_verb_options;

/* What a run holds while it goes on. */
typedef struct {
	cli_run *run;
	krylov_verb_options o;
	optla_krylov_method method;
	const char *method_name;
	optla_rig *rig;
	optla_rig_info info;
	optla_op *op, *high, *reduce, *truth;
	void *target; /* of the operator's type */
	optla_krylov *krylov;
	optla_model *model;
	double *lights; /* of the result, gmres and power */
} krylov_job;

/* Does the method capture T (else it finds an illumination)? */
static inline bool krylov_is_capture(const krylov_job *j)
{
	return j->method == OPTLA_KRYLOV_ARNOLDI || j->method == OPTLA_KRYLOV_SVD;
}

/* krylov_result.c: prints and records what the run did; judges the result by the exact T, if that is wanted, and writes it. */
void krylov_say_info(krylov_job *j, const optla_krylov_info *info);
optla_status krylov_save_result(krylov_job *j);

#endif
