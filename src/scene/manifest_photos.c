/* SPDX-License-Identifier: BSD-3-Clause */
/* Photos of a recorded rig and the illumination of each: a list, or a pattern of file names with one light each. */
#include "scene/manifest.h"

#include <float.h>
#include <limits.h>
#include <string.h>

enum { PHOTOS_MAX = 1 << 20 };

/* The place of "%d" or "%0Nd" in a pattern, and N; false unless there is exactly one and no other '%'. */
static bool find_number(const char *pattern, size_t *start, size_t *length, int *digits)
{
	const char *p = strchr(pattern, '%');
	if (!p) return false;
	const char *q = p + 1;
	*digits = 0;
	if (*q == '0' && q[1] >= '1' && q[1] <= '9') {
		*digits = q[1] - '0';
		q += 2;
	}
	*start = (size_t)(p - pattern);
	*length = (size_t)(q + 1 - p);
	return *q == 'd' && !strchr(q, '%');
}

static optla_status parse_pattern(optla_manifest *m, optla_yaml_node node)
{
	const optla_yaml *doc = m->doc;
	OPTLA_TRY(optla_yaml_check_keys_(doc, node, "pattern|first|count|exposure_s"));
	optla_yaml_node pattern_node, count_node;
	OPTLA_TRY(optla_yaml_require_(doc, node, "pattern", &pattern_node));
	OPTLA_TRY(optla_yaml_require_(doc, node, "count", &count_node));
	const char *pattern;
	int count, first = 1, digits;
	double exposure_s = m->exposure_s;
	size_t start, length;
	OPTLA_TRY(optla_yaml_text_(doc, pattern_node, "pattern", &pattern));
	if (!find_number(pattern, &start, &length, &digits))
		return optla_yaml_fail_(doc, pattern_node, "'pattern' is '%s': it needs one %%d or %%03d for the photo's number",
		                        pattern);
	OPTLA_TRY(optla_yaml_int_(doc, count_node, "count", 1, PHOTOS_MAX, &count));
	const optla_yaml_node first_node = optla_yaml_get_(doc, node, "first");
	if (first_node) OPTLA_TRY(optla_yaml_int_(doc, first_node, "first", 0, INT_MAX - PHOTOS_MAX, &first));
	OPTLA_TRY(optla_manifest_number_(doc, node, "exposure_s", 1e-9, 1e9, &exposure_s));
	m->photos = optla_calloc_(m->ctx, (size_t)count, sizeof *m->photos);
	if (!m->photos) return OPTLA_ERR_NOMEM;
	m->nphotos = (size_t)count;
	for (size_t k = 0; k < m->nphotos; k++) {
		optla_manifest_photo *p = &m->photos[k];
		*p = (optla_manifest_photo){.node = pattern_node, .light = k, .exposure_s = exposure_s};
		p->file = optla_format_(m->ctx, "%.*s%0*d%s", (int)start, pattern, digits, first + (int)k, pattern + start + length);
		if (!p->file) return OPTLA_ERR_NOMEM;
	}
	return OPTLA_OK;
}

static optla_status parse_illumination(optla_manifest *m, optla_yaml_node node, optla_manifest_photo *p)
{
	const optla_yaml *doc = m->doc;
	if (!optla_yaml_is_list_(doc, node) || !optla_yaml_count_(doc, node))
		return optla_yaml_fail_(doc, node, "'illumination' must be a list of one number for each light");
	const size_t n = optla_yaml_count_(doc, node);
	if (!m->nlights) m->nlights = n;
	if (n != m->nlights)
		return optla_yaml_fail_(doc, node, "'illumination' has %zu numbers, there are %zu lights", n, m->nlights);
	p->illumination = optla_calloc_(m->ctx, n, sizeof *p->illumination);
	if (!p->illumination) return OPTLA_ERR_NOMEM;
	for (size_t k = 0; k < n; k++)
		OPTLA_TRY(optla_yaml_number_(doc, optla_yaml_item_(doc, node, k), "illumination", 0, DBL_MAX, &p->illumination[k]));
	return OPTLA_OK;
}

static optla_status parse_photo(optla_manifest *m, optla_yaml_node node, optla_manifest_photo *p)
{
	const optla_yaml *doc = m->doc;
	*p = (optla_manifest_photo){.node = node, .light = SIZE_MAX, .exposure_s = m->exposure_s};
	OPTLA_TRY(optla_yaml_check_keys_(doc, node, "file|light|illumination|illumination_file|exposure_s"));
	optla_yaml_node file_node;
	const char *file;
	OPTLA_TRY(optla_yaml_require_(doc, node, "file", &file_node));
	OPTLA_TRY(optla_yaml_text_(doc, file_node, "file", &file));
	p->file = optla_strdup_(m->ctx, file);
	if (!p->file) return OPTLA_ERR_NOMEM;
	const optla_yaml_node light = optla_yaml_get_(doc, node, "light"), illumination = optla_yaml_get_(doc, node, "illumination");
	OPTLA_TRY(optla_manifest_text_(doc, node, "illumination_file", &p->illumination_file));
	if ((light != 0) + (illumination != 0) + (p->illumination_file != NULL) != 1)
		return optla_yaml_fail_(doc, node, "photo '%s' needs one of the keys light, illumination, illumination_file", file);
	if (light) {
		int index;
		OPTLA_TRY(optla_yaml_int_(doc, light, "light", 0, PHOTOS_MAX - 1, &index));
		p->light = (size_t)index;
	}
	if (illumination) OPTLA_TRY(parse_illumination(m, illumination, p));
	return optla_manifest_number_(doc, node, "exposure_s", 1e-9, 1e9, &p->exposure_s);
}

static optla_status parse_list(optla_manifest *m, optla_yaml_node list)
{
	const size_t count = optla_yaml_count_(m->doc, list);
	if (!count || count > PHOTOS_MAX)
		return optla_yaml_fail_(m->doc, list, "'photos' has %zu entries: allowed are 1 to %d", count, PHOTOS_MAX);
	m->photos = optla_calloc_(m->ctx, count, sizeof *m->photos);
	if (!m->photos) return OPTLA_ERR_NOMEM;
	m->nphotos = count;
	for (size_t k = 0; k < count; k++) OPTLA_TRY(parse_photo(m, optla_yaml_item_(m->doc, list, k), &m->photos[k]));
	return OPTLA_OK;
}

/* Lights that are named by index: within the number of lights, and each by one photo only. */
static optla_status check_lights(optla_manifest *m)
{
	size_t largest = 0;
	for (size_t k = 0; k < m->nphotos; k++)
		if (m->photos[k].light != SIZE_MAX) largest = optla_max_(largest, m->photos[k].light + 1);
	if (!m->nlights) m->nlights = largest;
	size_t *photo = optla_calloc_(m->ctx, m->nlights, sizeof *photo);
	if (!photo) return OPTLA_ERR_NOMEM;
	optla_status status = OPTLA_OK;
	for (size_t k = 0; k < m->nphotos && !status; k++) {
		const size_t light = m->photos[k].light;
		if (light == SIZE_MAX) continue;
		if (light >= m->nlights)
			status = optla_yaml_fail_(m->doc, m->photos[k].node, "'light' is %zu: there are %zu lights, numbered from 0", light,
			                          m->nlights);
		else if (photo[light])
			status = optla_yaml_fail_(m->doc, m->photos[k].node, "light %zu is listed twice: photos '%s' and '%s'", light,
			                          m->photos[photo[light] - 1].file, m->photos[k].file);
		else
			photo[light] = k + 1;
	}
	optla_free(m->ctx, photo);
	return status;
}

optla_status optla_manifest_photos_(optla_manifest *m, optla_yaml_node root)
{
	OPTLA_TRY(optla_yaml_require_(m->doc, root, "photos", &m->photos_node));
	if (optla_yaml_is_list_(m->doc, m->photos_node))
		OPTLA_TRY(parse_list(m, m->photos_node));
	else if (optla_yaml_is_map_(m->doc, m->photos_node))
		OPTLA_TRY(parse_pattern(m, m->photos_node));
	else
		return optla_yaml_fail_(m->doc, m->photos_node, "'photos' must be a list, or a mapping with pattern and count");
	return check_lights(m);
}
