/* SPDX-License-Identifier: BSD-3-Clause */
/* The rival captures, one file each, for relight/ alone. */
#ifndef OPTLA_CAPTURE_IMPL_H
#define OPTLA_CAPTURE_IMPL_H

#include "base/base_impl.h"
#include "optla/relight.h"

typedef struct {
	optla_ctx *ctx;
	optla_op *photos, *single, *truth;
	size_t nrows, ncols, grid_width, grid_height;
	const optla_capture_options *options;
	optla_capture_point *points;
} optla_capture_job;

optla_status optla_capture_brute_(const optla_capture_job *job, optla_capture method);
optla_status optla_capture_nystroem_(const optla_capture_job *job, bool kernel);
optla_status optla_capture_svd_(const optla_capture_job *job);

/* Notes in points[i] what op has cost since `before`. */
void optla_capture_note_cost_(const optla_capture_job *job, size_t i, optla_op *op, optla_op_cost before);

#endif
