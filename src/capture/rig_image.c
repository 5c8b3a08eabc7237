/* SPDX-License-Identifier: BSD-3-Clause */
/* Rows of T as pictures and back; lights as a picture. */
#include "capture/light_spec.h"
#include "capture/rig_impl.h"

optla_status optla_rig_image(const optla_rig *rig, const double *values, size_t channels, optla_image **out)
{
	const optla_rig_info *info = &rig->info;
	*out = NULL;
	OPTLA_CHECK(rig->ctx, channels == 1 || channels == 3, OPTLA_ERR_ARG, "an image of row values has 1 or 3 channels, not %zu",
	            channels);
	OPTLA_TRY(optla_image_create(rig->ctx, info->width, info->height, channels, OPTLA_IMAGE_LINEAR, out));
	for (size_t c = 0; c < channels; c++)
		for (size_t m = 0; m < info->npixels; m++)
			(*out)->data[info->pixel[m] * channels + c] = (float)values[c * info->npixels + m];
	return OPTLA_OK;
}

/* Colour channels of an image: alpha is none. */
static size_t colours(const optla_image *image) { return image->channels >= 3 ? 3 : 1; }

static double mean_of(const float *sample, size_t count)
{
	double sum = 0;
	for (size_t c = 0; c < count; c++) sum += (double)sample[c];
	return sum / (double)count;
}

optla_status optla_rig_values(const optla_rig *rig, const optla_image *image, optla_channel channel, double *values)
{
	const optla_rig_info *info = &rig->info;
	OPTLA_TRY(optla_channel_check_(rig->ctx, channel, info->channels));
	OPTLA_CHECK(rig->ctx, image->width == info->width && image->height == info->height, OPTLA_ERR_SHAPE,
	            "the image is %zu x %zu, the rig's camera %zu x %zu: resize it first", image->width, image->height, info->width,
	            info->height);
	const size_t have = colours(image), planes = channel == OPTLA_CHANNEL_ALL ? info->channels : 1;
	for (size_t c = 0; c < planes; c++)
		for (size_t m = 0; m < info->npixels; m++) {
			const float *sample = image->data + info->pixel[m] * image->channels;
			double v = (double)sample[0];
			if (have > 1 && (channel == OPTLA_CHANNEL_GREY || info->channels == 1))
				v = mean_of(sample, have);
			else if (have > 1)
				v = (double)sample[channel == OPTLA_CHANNEL_ALL ? c : (size_t)(channel - OPTLA_CHANNEL_RED)];
			values[c * info->npixels + m] = v;
		}
	return OPTLA_OK;
}

optla_status optla_rig_light_image(const optla_rig *rig, const double *values, optla_image **out)
{
	const optla_rig_info *info = &rig->info;
	*out = NULL;
	OPTLA_CHECK(rig->ctx, info->light_width, OPTLA_ERR_UNSUPPORTED, "the %zu lights of rig '%s' are not on a grid", info->nlights,
	            info->name);
	OPTLA_TRY(optla_image_create(rig->ctx, info->light_width, info->light_height, 1, OPTLA_IMAGE_LINEAR, out));
	for (size_t n = 0; n < info->nlights; n++) (*out)->data[n] = (float)values[n];
	return OPTLA_OK;
}

optla_status optla_rig_light_vector(optla_rig *rig, const char *spec, size_t channels, double *p)
{
	const optla_light_layout lights = {.nlights = rig->info.nlights,
	                                   .grid_width = rig->info.light_width,
	                                   .grid_height = rig->info.light_height,
	                                   .direction = rig->light_direction};
	return optla_light_spec_(rig->ctx, &lights, spec, channels, p);
}
