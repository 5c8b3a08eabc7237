/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a captured model: one that can be relit, or an error. */
#include "fuzz.h"
#include "relight/model_impl.h"

/* Every photo, illumination and pixel is looked at. */
static void use(const optla_model *m)
{
	float *p = calloc(m->nlights, sizeof *p), *i = calloc(m->npixels * m->channels, sizeof *i);
	optla_image *image = NULL;
	if (!p || !i) abort();
	for (size_t n = 0; n < m->nlights; n++) p[n] = 1;
	if (OPTLA_OK == optla_relight(m, p, 1, i) && OPTLA_OK == optla_model_image(m, i, &image)) optla_image_destroy(&image);
	if (OPTLA_OK == optla_model_montage(m, m->rank < 2 ? m->rank : 2, &image)) optla_image_destroy(&image);
	free(p);
	free(i);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	optla_ctx *ctx = fuzz_ctx();
	optla_model *model;
	if (OPTLA_OK == optla_model_decode_(ctx, data, size, "fuzz.h5", &model))
		use(model);
	else if (model || !*optla_ctx_last_error(ctx))
		abort();
	optla_model_destroy(&model);
	optla_ctx_destroy(&ctx);
	return 0;
}
