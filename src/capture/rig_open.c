/* SPDX-License-Identifier: BSD-3-Clause */
/* A rig from its file. */
#include "capture/rig_open.h"
#include "io/whole_file.h"

static optla_status unknown_sensor(optla_ctx *ctx, const optla_manifest *m)
{
	char *known = optla_format_(ctx, "%s", optla_sensor_preset_name(0, NULL));
	for (size_t k = 1; known && optla_sensor_preset_name(k, NULL); k++) {
		char *longer = optla_format_(ctx, "%s, %s", known, optla_sensor_preset_name(k, NULL));
		optla_free(ctx, known);
		known = longer;
	}
	if (!known) return OPTLA_ERR_NOMEM;
	const optla_status status = optla_yaml_fail_(m->doc, optla_yaml_get_(m->doc, optla_yaml_root_(m->doc), "sensor"),
	                                             "'sensor' is '%s': allowed are %s", m->sensor, known);
	optla_free(ctx, known);
	return status;
}

static optla_status open_manifest(optla_ctx *ctx, const char *path, const optla_rig_open_options *options,
                                  const optla_manifest *m, optla_rig **out)
{
	if (m->sensor && !optla_sensor_preset(m->sensor)) return unknown_sensor(ctx, m);
	const optla_rig_labels labels = {.name = m->name, .path = path, .sensor = m->sensor, .exposure_s = m->exposure_s};
	if (!m->analytic) return optla_rig_from_photos_(ctx, m, options ? options->data_dir : NULL, &labels, out);
	char *where = optla_format_(ctx, "%s: ", path);
	if (!where) return OPTLA_ERR_NOMEM;
	optla_corner_desc corner = m->corner;
	corner.where = where;
	const optla_status status = optla_rig_from_corner_(ctx, &corner, &labels, out);
	optla_free(ctx, where);
	return status;
}

optla_status optla_rig_open(optla_ctx *ctx, const char *path, const optla_rig_open_options *options, optla_rig **out)
{
	*out = NULL;
	OPTLA_CHECK(ctx, !options || options->size == sizeof *options, OPTLA_ERR_ARG,
	            "optla_rig_open_options has size %zu, this library knows %zu", options->size, sizeof *options);
	void *bytes;
	size_t count;
	OPTLA_TRY(optla_read_file_(ctx, path, &bytes, &count));
	optla_manifest *m = NULL;
	optla_status status = optla_manifest_parse_(ctx, bytes, count, path, &m);
	optla_free(ctx, bytes);
	if (!status) status = open_manifest(ctx, path, options, m, out);
	optla_manifest_destroy_(&m);
	return status;
}
