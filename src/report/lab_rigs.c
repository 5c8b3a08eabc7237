/* SPDX-License-Identifier: BSD-3-Clause */
/* The scenes of the experiments. Rig files travel inside the library and are written beside the page: what was used can be read there,
   and an installed library needs no path to its own examples. */
#include "report/lab.h"

#include "io/whole_file.h"
#include "report/rig_files.h"

#include <math.h>

static void destroy_rig(optla_ctx *ctx, void *object)
{
	(void)ctx;
	optla_rig *rig = object;
	optla_rig_destroy(&rig);
}

static optla_status hold_rig(optla_figure *figure, optla_rig **rig)
{
	const optla_status s = optla_figure_hold_(figure, *rig, destroy_rig);
	if (OPTLA_OK != s) *rig = NULL;
	return s;
}

optla_status optla_lab_corner_(optla_figure *figure, size_t camera, size_t projector, bool coaxial, optla_rig **rig)
{
	OPTLA_TRY(optla_rig_corner(figure->ctx, camera, projector, coaxial, rig));
	return hold_rig(figure, rig);
}

static optla_status open_file(optla_figure *figure, const optla_rig_file *file, optla_rig **rig)
{
	char *dir = optla_path_join_(figure->ctx, figure->out_dir, "rigs");
	char *path = dir ? optla_path_join_(figure->ctx, dir, file->name) : NULL;
	optla_status s = path ? optla_make_dirs_(figure->ctx, dir) : OPTLA_ERR_NOMEM;
	if (OPTLA_OK == s) s = optla_write_file_(figure->ctx, path, file->bytes, file->count);
	const optla_rig_open_options o = {.size = sizeof o, .data_dir = figure->data_dir};
	if (OPTLA_OK == s) s = optla_rig_open(figure->ctx, path, &o, rig);
	optla_free(figure->ctx, path);
	optla_free(figure->ctx, dir);
	OPTLA_TRY(s);
	return hold_rig(figure, rig);
}

optla_status optla_lab_screen_(optla_figure *figure, optla_rig **rig)
{
	*rig = NULL;
	return open_file(figure, &optla_rig_file_screen_, rig);
}

optla_status optla_lab_ball_(optla_figure *figure, optla_rig **rig)
{
	*rig = NULL;
	bool there = false;
	if (figure->data_dir) {
		char *dir = optla_path_join_(figure->ctx, figure->data_dir, "diligent-ball");
		if (!dir) return OPTLA_ERR_NOMEM;
		there = optla_path_exists_(dir);
		optla_free(figure->ctx, dir);
	}
	if (there) return open_file(figure, &optla_rig_file_ball_, rig);
	optla_figure_say_(figure,
	                  "Left out: the photos of the ball (folder diligent-ball) are not on this machine. Give the folder of real "
	                  "captures with --data.");
	return OPTLA_OK;
}

void optla_lab_say_corner_(optla_figure *figure, const optla_rig *rig)
{
	optla_rig_info info;
	optla_rig_get_info(rig, &info);
	optla_figure_say_(
	    figure,
	    "Scene: %s, a corner of diffuse walls, of which all inter-reflections are known exactly (form factors and a radiosity "
	    "solve); %zu × %zu camera pixels, %zu × %zu light pixels%s. It stands in for the thesis' scenes, which aren't public.",
	    info.name, info.width, info.height, info.light_width, info.light_height,
	    info.symmetric ? ", camera and projector in one place, so that T is symmetric" : "");
}

void optla_lab_say_ball_(optla_figure *figure, const optla_rig *rig)
{
	optla_rig_info info;
	optla_rig_get_info(rig, &info);
	optla_figure_say_(
	    figure,
	    "Scene: %s, %zu photos of a real object, one light at a time; %zu pixels inside the mask are rows of T. Products with T "
	    "and with its transpose are made of the photos, through the sensor model where a camera is named.",
	    info.name, info.nphotos, info.npixels);
}
