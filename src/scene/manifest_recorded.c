/* SPDX-License-Identifier: BSD-3-Clause */
/* Keys of a recorded rig other than its photos. */
#include "scene/manifest.h"

#include <float.h>
#include <limits.h>
#include <string.h>

static optla_status parse_crop(optla_manifest *m, optla_yaml_node node)
{
	double v[4];
	OPTLA_TRY(optla_yaml_numbers_(m->doc, node, "crop", 4, v));
	for (int k = 0; k < 4; k++) {
		const double lower = k < 2 ? 0 : 1;
		if (!(v[k] >= lower && v[k] <= 1e6 && v[k] == (double)(size_t)v[k]))
			return optla_yaml_fail_(m->doc, node, "'crop' is [%g, %g, %g, %g]: it must be [x, y, width, height] in whole pixels",
			                        v[0], v[1], v[2], v[3]);
		m->crop[k] = (size_t)v[k];
	}
	return OPTLA_OK;
}

static optla_status parse_dark(optla_manifest *m, optla_yaml_node node)
{
	if (!optla_yaml_is_list_(m->doc, node) || !optla_yaml_count_(m->doc, node))
		return optla_yaml_fail_(m->doc, node, "'dark' must be a list of at least one file");
	const size_t count = optla_yaml_count_(m->doc, node);
	m->dark = optla_calloc_(m->ctx, count, sizeof *m->dark);
	if (!m->dark) return OPTLA_ERR_NOMEM;
	m->ndark = count;
	for (size_t k = 0; k < count; k++)
		OPTLA_TRY(optla_yaml_text_(m->doc, optla_yaml_item_(m->doc, node, k), "dark", &m->dark[k]));
	return OPTLA_OK;
}

/* Measured counts and what they mean, both ascending. */
static optla_status parse_table(optla_manifest *m, optla_yaml_node node)
{
	const optla_yaml *doc = m->doc;
	optla_response *r = &m->response;
	optla_yaml_node dn, linear;
	OPTLA_TRY(optla_yaml_require_(doc, node, "counts", &dn));
	OPTLA_TRY(optla_yaml_require_(doc, node, "linear", &linear));
	r->kind = OPTLA_RESPONSE_TABLE;
	r->count = optla_yaml_count_(doc, dn);
	if (r->count < 2) return optla_yaml_fail_(doc, dn, "'counts' must be a list of at least 2 numbers");
	r->dn = optla_calloc_(m->ctx, r->count, sizeof *r->dn);
	r->linear = optla_calloc_(m->ctx, r->count, sizeof *r->linear);
	if (!r->dn || !r->linear) return OPTLA_ERR_NOMEM;
	OPTLA_TRY(optla_yaml_numbers_(doc, dn, "counts", r->count, r->dn));
	OPTLA_TRY(optla_yaml_numbers_(doc, linear, "linear", r->count, r->linear));
	for (size_t k = 1; k < r->count; k++) {
		if (!(r->dn[k] > r->dn[k - 1]))
			return optla_yaml_fail_(doc, dn, "'counts' must rise: entry %zu is %g after %g", k, r->dn[k], r->dn[k - 1]);
		if (!(r->linear[k] >= r->linear[k - 1]))
			return optla_yaml_fail_(doc, linear, "'linear' must not fall: entry %zu is %g after %g", k, r->linear[k],
			                        r->linear[k - 1]);
	}
	if (!(r->linear[r->count - 1] > r->linear[0])) return optla_yaml_fail_(doc, linear, "'linear' is the same for all counts");
	return OPTLA_OK;
}

static optla_status parse_response(optla_manifest *m, optla_yaml_node node)
{
	const optla_yaml *doc = m->doc;
	if (optla_yaml_is_map_(doc, node)) {
		OPTLA_TRY(optla_yaml_check_keys_(doc, node, "gamma|counts|linear"));
		const optla_yaml_node gamma = optla_yaml_get_(doc, node, "gamma");
		if (!gamma) return parse_table(m, node);
		m->response.kind = OPTLA_RESPONSE_GAMMA;
		return optla_yaml_number_(doc, gamma, "gamma", 0.1, 10, &m->response.gamma);
	}
	const char *text;
	OPTLA_TRY(optla_yaml_text_(doc, node, "response", &text));
	if (!strcmp(text, "srgb"))
		m->response.kind = OPTLA_RESPONSE_SRGB;
	else if (strcmp(text, "linear"))
		return optla_yaml_fail_(doc, node,
		                        "'response' is '%s': allowed are linear, srgb, {gamma: X}, {counts: [..], linear: [..]}", text);
	return OPTLA_OK;
}

/* One axis word: which camera axis (right, down, away) and sign. */
static bool find_axis(const char *word, int *axis, double *sign)
{
	static const char *const words[6] = {"right", "left", "down", "up", "away", "towards"};
	for (int k = 0; k < 6; k++)
		if (!strcmp(word, words[k])) {
			*axis = k / 2;
			*sign = k % 2 ? -1 : 1;
			return true;
		}
	return false;
}

static optla_status parse_axes(optla_manifest *m, optla_yaml_node node)
{
	const optla_yaml *doc = m->doc;
	static const char *const allowed = "a list like [right, up, towards]: one each of right|left, up|down, towards|away "
	                                   "(as the camera sees it)";
	if (!optla_yaml_is_list_(doc, node) || optla_yaml_count_(doc, node) != 3)
		return optla_yaml_fail_(doc, node, "'axes' must be %s", allowed);
	bool used[3] = {false, false, false};
	memset(m->axes, 0, sizeof m->axes);
	for (size_t k = 0; k < 3; k++) {
		const char *word;
		int axis = 0;
		double sign = 1;
		OPTLA_TRY(optla_yaml_text_(doc, optla_yaml_item_(doc, node, k), "axes", &word));
		if (!find_axis(word, &axis, &sign) || used[axis])
			return optla_yaml_fail_(doc, node, "'axes' has '%s': it must be %s", word, allowed);
		used[axis] = true;
		m->axes[k][axis] = sign;
	}
	return OPTLA_OK;
}

static optla_status parse_lights(optla_manifest *m, optla_yaml_node node)
{
	const optla_yaml *doc = m->doc;
	OPTLA_TRY(optla_yaml_check_keys_(doc, node, "count|directions|axes|intensities|divide_intensities|grid"));
	const optla_yaml_node count = optla_yaml_get_(doc, node, "count"), grid = optla_yaml_get_(doc, node, "grid"),
	                      axes = optla_yaml_get_(doc, node, "axes");
	int n = 0;
	if (count) OPTLA_TRY(optla_yaml_int_(doc, count, "count", 1, 1 << 24, &n));
	m->nlights = (size_t)n;
	OPTLA_TRY(optla_manifest_text_(doc, node, "directions", &m->directions));
	OPTLA_TRY(optla_manifest_text_(doc, node, "intensities", &m->intensities));
	OPTLA_TRY(optla_manifest_bool_(doc, node, "divide_intensities", &m->divide_intensities));
	if (m->divide_intensities && !m->intensities)
		return optla_yaml_fail_(doc, node, "'divide_intensities' needs the key intensities");
	if (axes && !m->directions) return optla_yaml_fail_(doc, axes, "'axes' needs the key directions");
	if (axes) OPTLA_TRY(parse_axes(m, axes));
	if (grid) OPTLA_TRY(optla_manifest_size_(doc, grid, "grid", 1 << 16, m->grid));
	return OPTLA_OK;
}

static optla_status parse_levels(optla_manifest *m, optla_yaml_node root)
{
	const optla_yaml *doc = m->doc;
	const optla_yaml_node crop = optla_yaml_get_(doc, root, "crop"), dark = optla_yaml_get_(doc, root, "dark"),
	                      black = optla_yaml_get_(doc, root, "black_level_dn"), response = optla_yaml_get_(doc, root, "response");
	if (dark && black) return optla_yaml_fail_(doc, black, "give 'dark' or 'black_level_dn', not both");
	m->black_node = black;
	if (crop) OPTLA_TRY(parse_crop(m, crop));
	if (dark) OPTLA_TRY(parse_dark(m, dark));
	if (response) OPTLA_TRY(parse_response(m, response));
	OPTLA_TRY(optla_manifest_number_(doc, root, "black_level_dn", 0, 1e9, &m->black_level_dn));
	OPTLA_TRY(optla_manifest_number_(doc, root, "saturation_dn", 1e-9, 1e30, &m->saturation_dn));
	const optla_yaml_node saturated = optla_yaml_get_(doc, root, "saturated");
	const char *policy = "warn";
	OPTLA_TRY(optla_manifest_text_(doc, root, "saturated", &policy));
	m->saturated_is_error = !strcmp(policy, "error");
	if (!m->saturated_is_error && strcmp(policy, "warn"))
		return optla_yaml_fail_(doc, saturated, "'saturated' is '%s': allowed are error, warn", policy);
	return OPTLA_OK;
}

optla_status optla_manifest_recorded_(optla_manifest *m, optla_yaml_node root)
{
	const optla_yaml *doc = m->doc;
	OPTLA_TRY(optla_yaml_check_keys_(doc, root,
	                                 "kind|name|sensor|exposure_s|data_root|photos|lights|mask|crop|dark|black_level_dn|response|"
	                                 "saturation_dn|saturated|transpose"));
	m->data_root = ".";
	m->transpose = true;
	for (int k = 0; k < 3; k++) m->axes[k][k] = 1;
	OPTLA_TRY(optla_manifest_text_(doc, root, "data_root", &m->data_root));
	OPTLA_TRY(optla_manifest_text_(doc, root, "mask", &m->mask));
	OPTLA_TRY(optla_manifest_bool_(doc, root, "transpose", &m->transpose));
	OPTLA_TRY(parse_levels(m, root));
	m->lights_node = optla_yaml_get_(doc, root, "lights");
	if (m->lights_node) OPTLA_TRY(parse_lights(m, m->lights_node));
	OPTLA_TRY(optla_manifest_photos_(m, root));
	if (m->grid[0] && m->nlights && m->grid[0] * m->grid[1] != m->nlights)
		return optla_yaml_fail_(doc, m->lights_node, "'grid' is %zu x %zu, but there are %zu lights", m->grid[0], m->grid[1],
		                        m->nlights);
	return OPTLA_OK;
}
