/* SPDX-License-Identifier: BSD-3-Clause */
/* What all photos of a recording share: size, levels, mask, black. */
#include "capture/recorded_impl.h"

#include <math.h>
#include <string.h>

static optla_status set_crop(optla_recorded *r)
{
	const size_t *c = r->m->crop;
	if (!c[2]) {
		r->crop[2] = r->width;
		r->crop[3] = r->height;
		return OPTLA_OK;
	}
	memcpy(r->crop, c, sizeof r->crop);
	if (c[0] + c[2] > r->width || c[1] + c[3] > r->height)
		return optla_yaml_fail_(r->m->doc, optla_yaml_get_(r->m->doc, optla_yaml_root_(r->m->doc), "crop"),
		                        "'crop' reaches (%zu, %zu), the photos are %zu x %zu", c[0] + c[2], c[1] + c[3], r->width,
		                        r->height);
	return OPTLA_OK;
}

/* Counts: the largest a file can hold is white; numbers of a float file are taken as they are, white is 1 and nothing saturates. */
static optla_status set_levels(optla_recorded *r, const optla_image *first)
{
	const optla_manifest *m = r->m;
	const bool counts = first->kind == OPTLA_IMAGE_RAW_DN && first->white_dn > 0;
	r->kind = first->kind;
	r->file_white_dn = first->white_dn;
	r->scale_dn = first->kind == OPTLA_IMAGE_DISPLAY ? 255 : counts ? first->white_dn : 1;
	const double white_dn = m->saturation_dn > 0 ? m->saturation_dn : r->scale_dn;
	r->saturation_dn = m->saturation_dn > 0 || first->kind != OPTLA_IMAGE_LINEAR ? white_dn : INFINITY;
	r->black_linear = optla_recorded_linear_(r, m->black_level_dn);
	r->white_linear = optla_recorded_linear_(r, white_dn);
	if (!(r->white_linear > r->black_linear))
		return optla_yaml_fail_(m->doc, m->black_node ? m->black_node : m->photos_node,
		                        "black (%g counts) is not below white (%g counts)", m->black_level_dn, white_dn);
	return OPTLA_OK;
}

static optla_status read_first(optla_recorded *r)
{
	optla_image *first;
	const char *name = r->m->photos[0].file;
	OPTLA_TRY(optla_recorded_load_(r, &name, &r->m->photos[0].node, 1, &first));
	r->width = first->width;
	r->height = first->height;
	r->channels = first->channels >= 3 ? 3 : 1;
	optla_status status = set_crop(r);
	if (!status) status = set_levels(r, first);
	optla_image_destroy(&first);
	return status;
}

/* Pixels where any channel of the mask is above zero. */
static optla_status list_pixels(optla_recorded *r, const optla_image *mask)
{
	const size_t count = r->crop[2] * r->crop[3];
	optla_rig *rig = r->rig;
	rig->pixel = optla_array_(r->ctx, count, sizeof *rig->pixel);
	if (!rig->pixel) return OPTLA_ERR_NOMEM;
	size_t n = 0;
	for (size_t p = 0; p < count; p++) {
		bool inside = !mask;
		for (size_t c = 0; mask && c < (mask->channels >= 3 ? 3 : 1); c++)
			inside = inside || optla_recorded_dn_(r, mask, p, c) > 0;
		if (inside) rig->pixel[n++] = (uint32_t)p;
	}
	rig->info.npixels = n;
	rig->info.pixel = rig->pixel;
	return OPTLA_OK;
}

static optla_status read_mask(optla_recorded *r)
{
	if (!r->m->mask) return list_pixels(r, NULL);
	const optla_yaml_node node = optla_yaml_get_(r->m->doc, optla_yaml_root_(r->m->doc), "mask");
	optla_recorded any = *r;
	any.width = 0; /* a mask may have other channels than the photos */
	optla_image *mask;
	OPTLA_TRY(optla_recorded_load_(&any, &r->m->mask, &node, 1, &mask));
	optla_status status = OPTLA_OK;
	if (mask->width != r->width || mask->height != r->height)
		status = optla_yaml_fail_(r->m->doc, node, "the mask '%s' is %zu x %zu, the photos are %zu x %zu", r->m->mask,
		                          mask->width, mask->height, r->width, r->height);
	if (!status) status = list_pixels(r, mask);
	if (!status && !r->rig->info.npixels)
		status = optla_yaml_fail_(r->m->doc, node, "the mask '%s' is black: no pixel is left", r->m->mask);
	optla_image_destroy(&mask);
	return status;
}

/* Mean of the linear dark frames, one after another. */
static optla_status read_dark(optla_recorded *r)
{
	if (!r->m->ndark) return OPTLA_OK;
	const size_t count = r->crop[2] * r->crop[3];
	const optla_yaml_node node = optla_yaml_get_(r->m->doc, optla_yaml_root_(r->m->doc), "dark");
	r->dark = optla_calloc_(r->ctx, count, r->channels * sizeof *r->dark);
	if (!r->dark) return OPTLA_ERR_NOMEM;
	double sum = 0;
	for (size_t k = 0; k < r->m->ndark; k++) {
		optla_image *frame;
		OPTLA_TRY(optla_recorded_load_(r, &r->m->dark[k], &node, 1, &frame));
		for (size_t c = 0; c < r->channels; c++)
			for (size_t p = 0; p < count; p++) {
				const double black = optla_recorded_linear_(r, optla_recorded_dn_(r, frame, p, c)) / (double)r->m->ndark;
				r->dark[c * count + p] += black;
				sum += black;
			}
		optla_image_destroy(&frame);
	}
	r->black_linear = sum / (double)(count * r->channels); /* for the scale of T alone */
	if (isfinite(sum) && r->black_linear < r->white_linear) return OPTLA_OK;
	return optla_yaml_fail_(r->m->doc, node, "the dark frames are as bright as white or hold NaN (their mean is %g of white)",
	                        r->black_linear / r->white_linear);
}

optla_status optla_recorded_frame_(optla_recorded *r)
{
	OPTLA_TRY(read_first(r));
	optla_rig_info *info = &r->rig->info;
	info->kind = OPTLA_RIG_RECORDED;
	info->width = r->crop[2];
	info->height = r->crop[3];
	info->channels = r->channels;
	info->exposure_s = r->m->exposure_s;
	info->has_transpose = r->m->transpose;
	OPTLA_TRY(read_mask(r));
	return read_dark(r);
}
