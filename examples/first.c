/* SPDX-License-Identifier: BSD-3-Clause */
/* A first program: captures the light transport of a rig through a simulated sensor, ten iterations of Arnoldi, and says how good it is.
   cc first.c $(pkg-config --cflags --libs optla) -o first && ./first /usr/local/share/optla/rigs/corner-screen.yaml */
#include <optla/optla.h>

#include <stdio.h>

int main(int argc, char **argv)
{
	optla_ctx *ctx = NULL;
	optla_rig *rig = NULL;
	optla_op *truth = NULL, *op = NULL;
	optla_krylov *run = NULL;
	optla_cblock d, p;
	double error[10];
	optla_rig_operator_options camera = optla_rig_operator_defaults;
	camera.split = OPTLA_SPLIT_SIGNED;                 /* two photos for a signed pattern, one for each sign */
	camera.sensor = optla_sensor_preset("dslr-14bit"); /* photons, read noise, whole counts; NULL: a perfect camera */
	optla_krylov_options options = optla_krylov_defaults;
	options.iterations = 10;

	const bool good = argc == 2 && !optla_ctx_create(&ctx, NULL) && !optla_rig_open(ctx, argv[1], NULL, &rig) &&
	                  !optla_rig_operator(rig, &camera, &op) && !optla_rig_truth(rig, camera.channel, &truth) &&
	                  !optla_krylov_create(&(optla_krylov_problem){.size = sizeof(optla_krylov_problem), .op = op},
	                                       OPTLA_KRYLOV_ARNOLDI, &options, &run) &&
	                  !optla_krylov_run(run) && !optla_krylov_bases(run, &d, &p, NULL) &&
	                  !optla_relative_errors(d, p, truth, error);
	const optla_krylov_info info = good ? optla_krylov_get_info(run) : (optla_krylov_info){0};
	if (good)
		printf("%d photos, relative error %.4f\n", (int)info.photos, error[info.rank - 1]);
	else
		fprintf(stderr, "%s\n", argc == 2 ? optla_ctx_last_error(ctx) : "usage: first RIG.yaml");
	optla_krylov_destroy(&run);
	optla_op_unref(&op);
	optla_op_unref(&truth);
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
	return good ? 0 : 1;
}
