/* SPDX-License-Identifier: BSD-3-Clause */
/* Keys of the analytic corner. */
#include "scene/manifest.h"

#include <string.h>

static optla_status parse_walls(optla_manifest *m, optla_yaml_node node)
{
	static const char *const names[OPTLA_WALLS] = {"floor", "left", "back"};
	OPTLA_TRY(optla_yaml_check_keys_(m->doc, node, "floor|left|back"));
	for (int w = 0; w < OPTLA_WALLS; w++) {
		const optla_yaml_node albedo = optla_yaml_get_(m->doc, node, names[w]);
		m->corner.wall[w] = albedo != 0;
		if (albedo) OPTLA_TRY(optla_yaml_numbers_(m->doc, albedo, names[w], 3, m->corner.albedo[w]));
	}
	return OPTLA_OK;
}

static optla_status parse_vector(const optla_yaml *doc, optla_yaml_node map, const char *key, double v[3])
{
	const optla_yaml_node node = optla_yaml_get_(doc, map, key);
	return node ? optla_yaml_numbers_(doc, node, key, 3, v) : OPTLA_OK;
}

static optla_status parse_pinhole(const optla_yaml *doc, optla_yaml_node node, optla_pinhole_desc *p)
{
	OPTLA_TRY(parse_vector(doc, node, "position_m", p->position_m));
	OPTLA_TRY(parse_vector(doc, node, "look_at_m", p->look_at_m));
	OPTLA_TRY(parse_vector(doc, node, "up", p->up));
	OPTLA_TRY(optla_manifest_number_(doc, node, "field_of_view_deg", 0.1, 170, &p->field_of_view_deg));
	const optla_yaml_node size = optla_yaml_get_(doc, node, "size");
	size_t s[2] = {p->width, p->height};
	if (size) OPTLA_TRY(optla_manifest_size_(doc, size, "size", 4096, s));
	p->width = s[0];
	p->height = s[1];
	return OPTLA_OK;
}

static optla_status parse_screen(optla_manifest *m, optla_yaml_node node)
{
	const optla_yaml *doc = m->doc;
	optla_screen_desc *s = &m->corner.screen;
	OPTLA_TRY(optla_yaml_check_keys_(doc, node, "x_m|y_m|z_m|size"));
	*s = (optla_screen_desc){1.05, {0.1, 0.95}, {0.1, 0.95}, 32, 32};
	m->corner.screen_given = true;
	OPTLA_TRY(optla_manifest_number_(doc, node, "x_m", 1, 100, &s->x_m));
	const optla_yaml_node y = optla_yaml_get_(doc, node, "y_m"), z = optla_yaml_get_(doc, node, "z_m"),
	                      size = optla_yaml_get_(doc, node, "size");
	if (y) OPTLA_TRY(optla_yaml_numbers_(doc, y, "y_m", 2, s->y_m));
	if (z) OPTLA_TRY(optla_yaml_numbers_(doc, z, "z_m", 2, s->z_m));
	size_t patches[2] = {s->width, s->height};
	if (size) OPTLA_TRY(optla_manifest_size_(doc, size, "size", 1024, patches));
	s->width = patches[0];
	s->height = patches[1];
	return OPTLA_OK;
}

optla_status optla_manifest_corner_(optla_manifest *m, optla_yaml_node root)
{
	const optla_yaml *doc = m->doc;
	m->corner = optla_corner_defaults_;
	OPTLA_TRY(optla_yaml_check_keys_(doc, root, "kind|name|sensor|exposure_s|walls|patches|camera|projector|coaxial|screen"));
	const optla_yaml_node walls = optla_yaml_get_(doc, root, "walls"), camera = optla_yaml_get_(doc, root, "camera"),
	                      projector = optla_yaml_get_(doc, root, "projector"), screen = optla_yaml_get_(doc, root, "screen"),
	                      patches = optla_yaml_get_(doc, root, "patches");
	int n = (int)m->corner.patches;
	if (patches) OPTLA_TRY(optla_yaml_int_(doc, patches, "patches", 1, 64, &n));
	m->corner.patches = (size_t)n;
	if (walls) OPTLA_TRY(parse_walls(m, walls));
	OPTLA_TRY(optla_manifest_bool_(doc, root, "coaxial", &m->corner.coaxial));
	if (projector && (m->corner.coaxial || screen))
		return optla_yaml_fail_(doc, projector, "a corner that is coaxial or has a screen has no 'projector'");
	if (camera) {
		OPTLA_TRY(optla_yaml_check_keys_(doc, camera, "position_m|look_at_m|up|field_of_view_deg|size|pupil_m"));
		OPTLA_TRY(parse_pinhole(doc, camera, &m->corner.camera));
		OPTLA_TRY(optla_manifest_number_(doc, camera, "pupil_m", 1e-6, 0.2, &m->corner.pupil_m));
	}
	if (projector) {
		OPTLA_TRY(optla_yaml_check_keys_(doc, projector, "position_m|look_at_m|up|field_of_view_deg|size"));
		OPTLA_TRY(parse_pinhole(doc, projector, &m->corner.projector));
	}
	return screen ? parse_screen(m, screen) : OPTLA_OK;
}
