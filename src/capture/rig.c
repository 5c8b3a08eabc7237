/* SPDX-License-Identifier: BSD-3-Clause */
/* A rig's life, what it says of itself, its exact operators, and the analytic rig. */
#include "capture/rig_impl.h"
#include "capture/rig_open.h"
#include "render/corner.h"

optla_status optla_rig_create_(optla_ctx *ctx, const char *name, const char *path, const char *sensor, optla_rig **out)
{
	*out = NULL;
	optla_rig *rig = optla_calloc_(ctx, 1, sizeof *rig);
	if (!rig) return OPTLA_ERR_NOMEM;
	rig->ctx = ctx;
	rig->name = optla_strdup_(ctx, name);
	rig->path = rig->name && path ? optla_strdup_(ctx, path) : NULL;
	rig->sensor = rig->name && sensor ? optla_strdup_(ctx, sensor) : NULL;
	if (!rig->name || (path && !rig->path) || (sensor && !rig->sensor)) {
		optla_rig_destroy(&rig);
		return OPTLA_ERR_NOMEM;
	}
	rig->info.name = rig->name;
	rig->info.path = rig->path;
	rig->info.sensor = rig->sensor;
	*out = rig;
	return OPTLA_OK;
}

void optla_rig_destroy(optla_rig **rig)
{
	if (!rig || !*rig) return;
	optla_rig *r = *rig;
	optla_transport_unref_(&r->transport);
	optla_free(r->ctx, r->light_direction);
	optla_free(r->ctx, r->pixel);
	optla_free(r->ctx, r->sensor);
	optla_free(r->ctx, r->path);
	optla_free(r->ctx, r->name);
	optla_free(r->ctx, r);
	*rig = NULL;
}

optla_ctx *optla_rig_ctx(const optla_rig *rig) { return rig->ctx; }

void optla_rig_get_info(const optla_rig *rig, optla_rig_info *info) { *info = rig->info; }

optla_status optla_rig_truth(optla_rig *rig, optla_channel channel, optla_op **out)
{
	return optla_transport_op_(rig->transport, channel, rig->info.symmetric, out);
}

static void corner_info(const optla_corner_desc *d, double exposure_s, optla_rig_info *info)
{
	info->kind = OPTLA_RIG_ANALYTIC;
	info->width = d->camera.width;
	info->height = d->camera.height;
	info->channels = 3;
	info->npixels = optla_corner_npixels_(d);
	info->nlights = optla_corner_nlights_(d);
	info->light_width = d->screen_given ? d->screen.width : d->coaxial ? d->camera.width : d->projector.width;
	info->light_height = info->nlights / info->light_width;
	info->has_transpose = true;
	info->symmetric = d->coaxial;
	info->exposure_s = exposure_s;
}

static optla_status fill_corner(optla_rig *rig, const optla_corner_desc *d)
{
	const optla_rig_info *info = &rig->info;
	rig->pixel = optla_array_(rig->ctx, info->npixels, sizeof *rig->pixel);
	if (!rig->pixel) return OPTLA_ERR_NOMEM;
	for (size_t m = 0; m < info->npixels; m++) rig->pixel[m] = (uint32_t)m;
	rig->info.pixel = rig->pixel;
	OPTLA_TRY(optla_transport_create_(rig->ctx, info->npixels, info->channels, info->nlights, OPTLA_F64, &rig->transport));
	return optla_corner_matrix_(rig->ctx, d, OPTLA_CORNER_DIRECT | OPTLA_CORNER_INDIRECT, rig->transport->t.data);
}

optla_status optla_rig_from_corner_(optla_ctx *ctx, const optla_corner_desc *desc, const optla_rig_labels *labels,
                                    optla_rig **out)
{
	*out = NULL;
	OPTLA_TRY(optla_corner_check_(ctx, desc));
	optla_rig *rig;
	OPTLA_TRY(optla_rig_create_(ctx, labels->name, labels->path, labels->sensor, &rig));
	corner_info(desc, labels->exposure_s, &rig->info);
	const optla_status status = fill_corner(rig, desc);
	if (status) optla_rig_destroy(&rig);
	*out = rig;
	return status;
}

optla_status optla_rig_corner(optla_ctx *ctx, size_t camera_size, size_t projector_size, bool coaxial, optla_rig **out)
{
	*out = NULL;
	OPTLA_CHECK(ctx, camera_size >= 1 && camera_size <= 4096 && projector_size >= 1 && projector_size <= 4096, OPTLA_ERR_ARG,
	            "a corner with %zu² camera and %zu² projector pixels: allowed is 1 to 4096", camera_size, projector_size);
	OPTLA_CHECK(ctx, !coaxial || camera_size == projector_size, OPTLA_ERR_ARG,
	            "a coaxial corner has as many projector pixels as camera pixels: not %zu² and %zu²", projector_size, camera_size);
	optla_corner_desc d = optla_corner_defaults_;
	d.camera.width = d.camera.height = camera_size;
	d.projector.width = d.projector.height = projector_size;
	d.coaxial = coaxial;
	const optla_rig_labels labels = {.name = coaxial ? "coaxial corner" : "corner", .exposure_s = 1.0 / 13};
	return optla_rig_from_corner_(ctx, &d, &labels, out);
}
