/* SPDX-License-Identifier: BSD-3-Clause */
/* The analytic corner lit through a diffusing screen, its exact T, and cameras that look at it. Such a T is dense and its singular values
   fall fast (Fig. 2.3b), so that noise ends a run early. */
#ifndef OPTLA_SCREEN_CORNER_H
#define OPTLA_SCREEN_CORNER_H

#include "near.h"
#include "optla/rig.h"

#include <unistd.h>

typedef struct {
	optla_ctx *ctx;
	optla_rig *rig;
	optla_op *truth;
	size_t nrows, ncols;
} setting;

static inline setting corner(void)
{
	setting s = {.ctx = test_ctx(NULL, 1)};
	static const char text[] =
	    "kind: analytic\n"
	    "camera: {position_m: [0.62, 0.75, 2.30], look_at_m: [0.42, 0.42, 0.20], field_of_view_deg: 26, size: [32, 32]}\n"
	    "screen: {x_m: 1.05, y_m: [0.10, 0.95], z_m: [0.10, 0.95], size: [16, 16]}\n";
	char path[] = "/tmp/optla_screen_XXXXXX";
	const int file = mkstemp(path);
	ck_assert_int_ge(file, 0);
	ck_assert_int_eq(write(file, text, sizeof text - 1), sizeof text - 1);
	close(file);
	ok(optla_rig_open(s.ctx, path, NULL, &s.rig));
	unlink(path);
	ok(optla_rig_truth(s.rig, OPTLA_CHANNEL_GREY, &s.truth));
	s.nrows = optla_op_nrows(s.truth);
	s.ncols = optla_op_ncols(s.truth);
	return s;
}

static inline void leave(setting *s)
{
	optla_op_unref(&s->truth);
	optla_rig_destroy(&s->rig);
	optla_ctx_destroy(&s->ctx);
}

/* exposure: as a multiple of the nominal one */
static inline optla_op *camera(const setting *s, const char *sensor, double exposure, optla_split split, uint64_t seed)
{
	optla_rig_operator_options o = optla_rig_operator_defaults;
	optla_op *op;
	o.sensor = optla_sensor_preset(sensor);
	ck_assert_ptr_nonnull(o.sensor);
	o.type = OPTLA_F64;
	o.split = split;
	o.seed = seed;
	o.exposure = exposure;
	ok(optla_rig_operator(s->rig, &o, &op));
	return op;
}

#endif
