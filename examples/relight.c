/* SPDX-License-Identifier: BSD-3-Clause */
/* Relighting: capture a rig with twenty iterations of Arnoldi, keep the model in a file, show the scene under a light it was never
   photographed under, and see how near that is to a photo.

       relight RIG.yaml LIGHT [IMAGE.png [MODEL.h5]]

   LIGHT: "light:500", "point:30,45", "env:sky.exr", ..., see optla_rig_light_vector(). */
#include <optla/optla.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Arnoldi on the green channel of a perfect camera; photos of signed patterns with an offset, one for each. */
static optla_status capture(optla_rig *rig, optla_op **op, optla_model **model)
{
	optla_rig_operator_options camera = optla_rig_operator_defaults;
	camera.channel = OPTLA_CHANNEL_GREEN;
	camera.split = OPTLA_SPLIT_OFFSET;
	optla_krylov_options options = optla_krylov_defaults;
	options.iterations = 20;
	optla_krylov *run = NULL;
	optla_status s = optla_rig_operator(rig, &camera, op);
	const optla_krylov_problem problem = {.size = sizeof problem, .op = *op};
	if (!s) s = optla_krylov_create(&problem, OPTLA_KRYLOV_ARNOLDI, &options, &run);
	if (!s) s = optla_krylov_run(run);
	if (!s) s = optla_model_from_krylov(rig, run, model);
	optla_krylov_destroy(&run);
	return s;
}

/* image = D (Pᵀ p) as a picture to look at, and *error = ||D (Pᵀ p) - T p|| / ||T p||. */
static optla_status relight(const optla_model *model, optla_op *op, const char *light, optla_image **image, double *error)
{
	double *numbers = malloc(model->nlights * sizeof *numbers), wrong = 0, all = 0;
	float *p = malloc(model->nlights * sizeof *p);
	float *i = malloc(model->npixels * sizeof *i), *photo = malloc(model->npixels * sizeof *photo);
	optla_status s = numbers && p && i && photo ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!s) s = optla_model_light_vector(model, light, 1, numbers);
	for (size_t n = 0; !s && n < model->nlights; n++) p[n] = (float)numbers[n];
	if (!s) s = optla_relight(model, p, 1, i);
	if (!s)
		s = optla_op_apply(op, OPTLA_FORWARD, (optla_cblock){p, model->nlights, 1, model->nlights, OPTLA_F32},
		                   (optla_block){photo, model->npixels, 1, model->npixels, OPTLA_F32});
	for (size_t m = 0; !s && m < model->npixels; m++) {
		wrong += pow((double)i[m] - (double)photo[m], 2);
		all += pow((double)photo[m], 2);
	}
	*error = sqrt(wrong / all);
	if (!s) s = optla_model_image(model, i, image);
	if (!s) s = optla_image_to_display(*image, optla_image_auto_exposure(*image, 0.99));
	free(photo);
	free(i);
	free(p);
	free(numbers);
	return s;
}

int main(int argc, char **argv)
{
	if (argc < 3) {
		fprintf(stderr, "usage: relight RIG.yaml LIGHT [IMAGE.png [MODEL.h5]]\n");
		return 2;
	}
	optla_ctx *ctx = NULL;
	optla_rig *rig = NULL;
	optla_op *op = NULL;
	optla_model *model = NULL;
	optla_image *image = NULL;
	double error = 1;
	optla_status s = optla_ctx_create(&ctx, NULL);
	if (!s) s = optla_rig_open(ctx, argv[1], NULL, &rig);
	if (!s) s = capture(rig, &op, &model);
	if (!s) s = relight(model, op, argv[2], &image, &error);
	if (!s && argc > 3) s = optla_image_save(image, argv[3]);
	if (!s && argc > 4) s = optla_model_save(model, argv[4]);
	if (s)
		fprintf(stderr, "%s: %s\n", optla_status_name(s), optla_ctx_last_error(ctx));
	else
		printf("%d photos; relit picture and photo differ by %.4f\n", (int)model->photos_taken, error);
	optla_image_destroy(&image);
	optla_model_destroy(&model);
	optla_op_unref(&op);
	optla_rig_destroy(&rig);
	optla_ctx_destroy(&ctx);
	return s ? 1 : 0;
}
