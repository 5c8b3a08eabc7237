/* SPDX-License-Identifier: BSD-3-Clause */
/* The image: creation, copies, and what its samples mean. */
#include "optla/image.h"
#include "base/base_impl.h"

#include <string.h>

static bool is_kind(optla_image_kind kind)
{
	return OPTLA_IMAGE_RAW_DN == kind || OPTLA_IMAGE_LINEAR == kind || OPTLA_IMAGE_DISPLAY == kind;
}

optla_status optla_image_create(optla_ctx *ctx, size_t width, size_t height, size_t channels, optla_image_kind kind,
                                optla_image **out)
{
	*out = NULL;
	OPTLA_CHECK(ctx, width && height, OPTLA_ERR_ARG, "an image of %zu x %zu pixels is empty", width, height);
	OPTLA_CHECK(ctx, channels >= 1 && channels <= 4, OPTLA_ERR_ARG, "an image has 1 to 4 channels, not %zu", channels);
	OPTLA_CHECK(ctx, is_kind(kind), OPTLA_ERR_ARG, "%d is no kind of image", (int)kind);
	size_t samples;
	OPTLA_CHECK(ctx,
	            optla_size_mul_(width, height, &samples) && optla_size_mul_(samples, channels, &samples) &&
	                samples <= optla_ctx_memory_limit(ctx) / sizeof(float),
	            OPTLA_ERR_ARG, "an image of %zu x %zu x %zu samples is over the memory limit of %.3g GiB", width, height,
	            channels, (double)optla_ctx_memory_limit(ctx) / 0x1p30);
	optla_image *image = optla_calloc_(ctx, 1, sizeof *image);
	if (!image) return OPTLA_ERR_NOMEM;
	*image = (optla_image){.ctx = ctx, .width = width, .height = height, .channels = channels, .kind = kind};
	image->data = optla_calloc_(ctx, samples, sizeof(float));
	if (!image->data) {
		optla_image_destroy(&image);
		return OPTLA_ERR_NOMEM;
	}
	*out = image;
	return OPTLA_OK;
}

optla_status optla_image_copy(const optla_image *image, optla_image **out)
{
	OPTLA_TRY(optla_image_create(image->ctx, image->width, image->height, image->channels, image->kind, out));
	(*out)->white_dn = image->white_dn;
	memcpy((*out)->data, image->data, image->width * image->height * image->channels * sizeof(float));
	return OPTLA_OK;
}

void optla_image_destroy(optla_image **image)
{
	if (!image || !*image) return;
	optla_ctx *ctx = (*image)->ctx;
	optla_free(ctx, (*image)->data);
	optla_free(ctx, (*image)->provenance);
	optla_free(ctx, *image);
	*image = NULL;
}

const char *optla_image_kind_name(optla_image_kind kind)
{
	switch (kind) {
	case OPTLA_IMAGE_RAW_DN: return "raw_dn";
	case OPTLA_IMAGE_LINEAR: return "linear";
	case OPTLA_IMAGE_DISPLAY: return "display";
	}
	return "unknown";
}

void optla_image_set_kind(optla_image *image, optla_image_kind kind, double white_dn)
{
	image->kind = kind;
	image->white_dn = OPTLA_IMAGE_RAW_DN == kind ? white_dn : 0;
}
