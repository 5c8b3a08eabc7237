/* SPDX-License-Identifier: BSD-3-Clause */
/* Inverse illumination: which pattern must the projector show so that the scene looks like a wanted photo? GMRES finds it from photos
   alone (Eq. 2.9), without ever knowing T. The wanted photo is one under a secret pattern, so that an answer exists. */
#include <optla/optla.h>

#include <stdio.h>
#include <stdlib.h>

enum { SIZE = 24, PROJECTOR = 16, LIGHTS = PROJECTOR * PROJECTOR, ITERATIONS = 24 };

/* A bright disc on a dim ground. */
static void secret(double *p)
{
	for (int n = 0; n < LIGHTS; n++) {
		const int x = n % PROJECTOR - 5, y = n / PROJECTOR - 8;
		p[n] = x * x + y * y < 16 ? 1 : 0.1;
	}
}

int main(void)
{
	optla_ctx *ctx = NULL;
	optla_rig *rig = NULL;
	optla_op *op = NULL;
	optla_krylov *run = NULL;
	optla_rig_operator_options camera = optla_rig_operator_defaults; /* a perfect camera; set camera.sensor for a real one */
	camera.channel = OPTLA_CHANNEL_GREY;
	camera.type = OPTLA_F64;
	optla_krylov_options options = optla_krylov_defaults;
	options.iterations = ITERATIONS;
	options.nonnegative = OPTLA_NONNEGATIVE_NNLS; /* a projector can't subtract light */
	double p[LIGHTS], found[LIGHTS], residual = 1;
	secret(p);

	optla_status s = optla_ctx_create(&ctx, NULL);
	if (!s) s = optla_rig_corner(ctx, SIZE, PROJECTOR, false, &rig);
	if (!s) s = optla_rig_operator(rig, &camera, &op);
	const size_t n = op ? optla_op_nrows(op) : 0;
	double *target = malloc((n + 1) * sizeof *target);
	if (!s && !target) s = OPTLA_ERR_NOMEM;
	if (!s)
		s = optla_op_apply(op, OPTLA_FORWARD, (optla_cblock){p, LIGHTS, 1, LIGHTS, OPTLA_F64},
		                   (optla_block){target, n, 1, n, OPTLA_F64});
	const optla_krylov_problem problem = {.size = sizeof problem, .op = op, .target = target};
	if (!s) s = optla_krylov_create(&problem, OPTLA_KRYLOV_GMRES, &options, &run);
	if (!s) s = optla_krylov_run(run);
	for (size_t k = 4; !s && k <= optla_krylov_get_info(run).rank; k += 4) {
		s = optla_krylov_solution(run, k, found, &residual);
		if (!s) printf("%2d illuminations: the photo differs from the wanted one by %.4f of its norm\n", (int)k, residual);
	}
	if (s) fprintf(stderr, "%s: %s\n", optla_status_name(s), optla_ctx_last_error(ctx));
	free(target);
	optla_krylov_destroy(&run);
	optla_op_unref(&op);
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
	return s || residual > 0.05 ? 1 : 0;
}
