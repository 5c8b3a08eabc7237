/* SPDX-License-Identifier: BSD-3-Clause */
/* Rigs made of plain data. */
#ifndef OPTLA_RIG_OPEN_H
#define OPTLA_RIG_OPEN_H

#include "capture/rig_impl.h"
#include "scene/corner_desc.h"
#include "scene/manifest.h"

typedef struct {
	const char *name, *path, *sensor; /* copied; path, sensor may be NULL */
	double exposure_s;
} optla_rig_labels;

optla_status optla_rig_from_corner_(optla_ctx *ctx, const optla_corner_desc *desc, const optla_rig_labels *labels,
                                    optla_rig **out);
/* Reads the photos. data_dir: NULL for the manifest's own. */
optla_status optla_rig_from_photos_(optla_ctx *ctx, const optla_manifest *manifest, const char *data_dir,
                                    const optla_rig_labels *labels, optla_rig **out);

#endif
