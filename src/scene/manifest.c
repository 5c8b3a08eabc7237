/* SPDX-License-Identifier: BSD-3-Clause */
/* Rig files: what both kinds share. */
#include "scene/manifest.h"

#include <float.h>
#include <string.h>

optla_status optla_manifest_number_(const optla_yaml *doc, optla_yaml_node map, const char *key, double lower, double upper,
                                    double *value)
{
	const optla_yaml_node node = optla_yaml_get_(doc, map, key);
	return node ? optla_yaml_number_(doc, node, key, lower, upper, value) : OPTLA_OK;
}

optla_status optla_manifest_text_(const optla_yaml *doc, optla_yaml_node map, const char *key, const char **value)
{
	const optla_yaml_node node = optla_yaml_get_(doc, map, key);
	return node ? optla_yaml_text_(doc, node, key, value) : OPTLA_OK;
}

optla_status optla_manifest_bool_(const optla_yaml *doc, optla_yaml_node map, const char *key, bool *value)
{
	const optla_yaml_node node = optla_yaml_get_(doc, map, key);
	return node ? optla_yaml_bool_(doc, node, key, value) : OPTLA_OK;
}

optla_status optla_manifest_size_(const optla_yaml *doc, optla_yaml_node node, const char *what, size_t limit, size_t size[2])
{
	double v[2];
	OPTLA_TRY(optla_yaml_numbers_(doc, node, what, 2, v));
	for (int k = 0; k < 2; k++) {
		if (!(v[k] >= 1 && v[k] <= (double)limit && v[k] == (double)(size_t)v[k]))
			return optla_yaml_fail_(doc, node, "'%s' is [%g, %g]: allowed are whole numbers from 1 to %zu", what, v[0], v[1],
			                        limit);
		size[k] = (size_t)v[k];
	}
	return OPTLA_OK;
}

static optla_status parse(optla_manifest *m, const char *name)
{
	const optla_yaml *doc = m->doc;
	const optla_yaml_node root = optla_yaml_root_(doc);
	if (!optla_yaml_is_map_(doc, root)) return optla_yaml_fail_(doc, root, "a rig file is a mapping with the key 'kind'");
	optla_yaml_node node;
	OPTLA_TRY(optla_yaml_require_(doc, root, "kind", &node));
	const char *kind;
	OPTLA_TRY(optla_yaml_text_(doc, node, "kind", &kind));
	m->analytic = !strcmp(kind, "analytic");
	if (!m->analytic && strcmp(kind, "recorded"))
		return optla_yaml_fail_(doc, node, "'kind' is '%s': allowed are recorded, analytic", kind);
	m->name = name;
	m->exposure_s = 1;
	OPTLA_TRY(optla_manifest_text_(doc, root, "name", &m->name));
	OPTLA_TRY(optla_manifest_text_(doc, root, "sensor", &m->sensor));
	OPTLA_TRY(optla_manifest_number_(doc, root, "exposure_s", 1e-9, 1e9, &m->exposure_s));
	return m->analytic ? optla_manifest_corner_(m, root) : optla_manifest_recorded_(m, root);
}

optla_status optla_manifest_parse_(optla_ctx *ctx, const void *bytes, size_t count, const char *name, optla_manifest **out)
{
	*out = NULL;
	optla_manifest *m = optla_calloc_(ctx, 1, sizeof *m);
	if (!m) return OPTLA_ERR_NOMEM;
	m->ctx = ctx;
	optla_status status = optla_yaml_parse_(ctx, bytes, count, name, &m->doc);
	if (!status) status = parse(m, name);
	if (status) optla_manifest_destroy_(&m);
	*out = m;
	return status;
}

void optla_manifest_destroy_(optla_manifest **manifest)
{
	optla_manifest *m = *manifest;
	*manifest = NULL;
	if (!m) return;
	for (size_t k = 0; m->photos && k < m->nphotos; k++) {
		optla_free(m->ctx, m->photos[k].illumination);
		optla_free(m->ctx, m->photos[k].file);
	}
	optla_free(m->ctx, m->photos);
	optla_free(m->ctx, (void *)m->dark);
	optla_free(m->ctx, m->response.dn);
	optla_free(m->ctx, m->response.linear);
	optla_yaml_destroy_(&m->doc);
	optla_free(m->ctx, m);
}
