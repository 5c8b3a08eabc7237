/* SPDX-License-Identifier: BSD-3-Clause */
/* YAML over libyaml's document tree: loading with all the checks that make the readers of values simple.

   libyaml's tree lets an alias point to a node that holds it and lets a few bytes nest without end. So the event stream is walked
   once before the tree is built (depth, a second document), and the finished tree is walked once (depth through aliases,
   duplicate keys, zero bytes in texts). Numbers are read in the C locale whatever the program has set. */
#include "io/yaml_impl.h"

#include <stdlib.h>
#include <string.h>
#include <yaml.h>

enum { MAX_DEPTH = 64, MAX_MIB = 32, HEIGHT_OPEN = -1 };

struct optla_yaml {
	optla_ctx *ctx;
	char *name;
	locale_t c_locale; /* (locale_t)0: not made yet */
	bool has_document;
	yaml_document_t document;
};

static const yaml_node_t *node_of(const optla_yaml *doc, optla_yaml_node node)
{
	if (node < 1 || node > doc->document.nodes.top - doc->document.nodes.start) return NULL;
	return doc->document.nodes.start + node - 1;
}

static const char *text_of(const yaml_node_t *node) { return (const char *)node->data.scalar.value; }

static const char *kind_of(const yaml_node_t *node)
{
	if (!node) return "nothing";
	return YAML_MAPPING_NODE == node->type ? "a mapping" : YAML_SEQUENCE_NODE == node->type ? "a list" : "a single value";
}

/* ---- loading ---- */

static int line_at(const unsigned char *bytes, size_t count, size_t offset)
{
	int line = 1;
	for (size_t k = 0; k < optla_min_(count, offset); k++) line += '\n' == bytes[k];
	return line;
}

static optla_status fail_parser(const optla_yaml *doc, const yaml_parser_t *parser, const unsigned char *bytes, size_t count)
{
	const char *problem = parser->problem ? parser->problem : "can't be read";
	switch (parser->error) {
	case YAML_MEMORY_ERROR: return OPTLA_FAIL(doc->ctx, OPTLA_ERR_NOMEM, "%s: no memory to parse it", doc->name);
	case YAML_READER_ERROR:
		return OPTLA_FAIL(doc->ctx, OPTLA_ERR_INPUT, "%s:%d: %s (byte %zu): the file must be text in UTF-8", doc->name,
		                  line_at(bytes, count, parser->problem_offset), problem, parser->problem_offset);
	default:
		return OPTLA_FAIL(doc->ctx, OPTLA_ERR_INPUT, "%s:%zu: not valid YAML: %s%s%s (column %zu)", doc->name,
		                  parser->problem_mark.line + 1, problem, parser->context ? ", " : "",
		                  parser->context ? parser->context : "", parser->problem_mark.column + 1);
	}
}

/* Depth change by an event. */
static int depth_step(yaml_event_type_t type)
{
	if (YAML_MAPPING_START_EVENT == type || YAML_SEQUENCE_START_EVENT == type) return 1;
	return YAML_MAPPING_END_EVENT == type || YAML_SEQUENCE_END_EVENT == type ? -1 : 0;
}

static optla_status scan_events(const optla_yaml *doc, const unsigned char *bytes, size_t count)
{
	yaml_parser_t parser;
	OPTLA_CHECK(doc->ctx, yaml_parser_initialize(&parser), OPTLA_ERR_NOMEM, "%s: no memory to parse it", doc->name);
	yaml_parser_set_input_string(&parser, bytes, count);
	optla_status status = OPTLA_OK;
	int depth = 0, documents = 0;
	for (bool more = true; more && OPTLA_OK == status;) {
		yaml_event_t event;
		if (!yaml_parser_parse(&parser, &event)) {
			status = fail_parser(doc, &parser, bytes, count);
			break;
		}
		const size_t line = event.start_mark.line + 1;
		depth += depth_step(event.type);
		documents += YAML_DOCUMENT_START_EVENT == event.type;
		more = YAML_STREAM_END_EVENT != event.type;
		yaml_event_delete(&event);
		if (depth > MAX_DEPTH)
			status = OPTLA_FAIL(doc->ctx, OPTLA_ERR_INPUT, "%s:%zu: nested deeper than %d levels", doc->name, line, MAX_DEPTH);
		else if (documents > 1)
			status =
			    OPTLA_FAIL(doc->ctx, OPTLA_ERR_INPUT, "%s:%zu: a second document starts here; one is allowed", doc->name, line);
	}
	yaml_parser_delete(&parser);
	OPTLA_TRY(status);
	OPTLA_CHECK(doc->ctx, documents, OPTLA_ERR_INPUT, "%s: is empty", doc->name);
	return OPTLA_OK;
}

static optla_status load_tree(optla_yaml *doc, const unsigned char *bytes, size_t count)
{
	yaml_parser_t parser;
	OPTLA_CHECK(doc->ctx, yaml_parser_initialize(&parser), OPTLA_ERR_NOMEM, "%s: no memory to parse it", doc->name);
	yaml_parser_set_input_string(&parser, bytes, count);
	doc->has_document = yaml_parser_load(&parser, &doc->document);
	const optla_status status = doc->has_document ? OPTLA_OK : fail_parser(doc, &parser, bytes, count);
	yaml_parser_delete(&parser);
	return status;
}

typedef struct {
	const char *text;
	optla_yaml_node node;
} key_ref;

static int compare_keys(const void *a, const void *b)
{
	const key_ref *x = a, *y = b;
	const int order = strcmp(x->text, y->text);
	return order ? order : (x->node > y->node) - (x->node < y->node);
}

static optla_status check_duplicates(const optla_yaml *doc, const yaml_node_t *map)
{
	const yaml_node_pair_t *pairs = map->data.mapping.pairs.start;
	const size_t count = (size_t)(map->data.mapping.pairs.top - pairs);
	for (size_t k = 0; k < count; k++)
		if (!optla_yaml_is_scalar_(doc, pairs[k].key))
			return optla_yaml_fail_(doc, pairs[k].key, "a key must be a single word, not %s",
			                        kind_of(node_of(doc, pairs[k].key)));
	key_ref *keys = optla_array_(doc->ctx, count, sizeof *keys);
	if (!keys) return OPTLA_ERR_NOMEM;
	for (size_t k = 0; k < count; k++) keys[k] = (key_ref){text_of(node_of(doc, pairs[k].key)), pairs[k].key};
	qsort(keys, count, sizeof *keys, compare_keys);
	optla_status status = OPTLA_OK;
	for (size_t k = 1; k < count && OPTLA_OK == status; k++)
		if (!strcmp(keys[k - 1].text, keys[k].text))
			status = optla_yaml_fail_(doc, keys[k].node, "key '%s' is given twice (first in line %d)", keys[k].text,
			                          optla_yaml_line_(doc, keys[k - 1].node));
	optla_free(doc->ctx, keys);
	return status;
}

static optla_status check_tree(const optla_yaml *doc, optla_yaml_node node, int depth, int *heights);

static optla_status check_child(const optla_yaml *doc, optla_yaml_node child, int depth, int *heights, int *height)
{
	OPTLA_TRY(check_tree(doc, child, depth + 1, heights));
	if (heights[child - 1] + 1 > *height) *height = heights[child - 1] + 1;
	return OPTLA_OK;
}

/* heights[node - 1]: 0 not seen, HEIGHT_OPEN being walked (met again: the node holds itself), else levels from the node down.
   Each node is walked once however many aliases point to it. */
static optla_status check_tree(const optla_yaml *doc, optla_yaml_node node, int depth, int *heights)
{
	const yaml_node_t *n = node_of(doc, node);
	int *height = &heights[node - 1], levels = 1;
	if (HEIGHT_OPEN == *height) return optla_yaml_fail_(doc, node, "%s contains itself through an alias", kind_of(n));
	if (depth > MAX_DEPTH || (*height && depth + *height - 1 > MAX_DEPTH))
		return optla_yaml_fail_(doc, node, "nested deeper than %d levels through aliases", MAX_DEPTH);
	if (*height) return OPTLA_OK;
	*height = HEIGHT_OPEN;
	if (YAML_SCALAR_NODE == n->type && memchr(text_of(n), 0, n->data.scalar.length))
		return optla_yaml_fail_(doc, node, "a zero byte in a text is not allowed");
	if (YAML_MAPPING_NODE == n->type) {
		OPTLA_TRY(check_duplicates(doc, n));
		for (const yaml_node_pair_t *p = n->data.mapping.pairs.start; p < n->data.mapping.pairs.top; p++) {
			OPTLA_TRY(check_child(doc, p->key, depth, heights, &levels));
			OPTLA_TRY(check_child(doc, p->value, depth, heights, &levels));
		}
	}
	if (YAML_SEQUENCE_NODE == n->type)
		for (const yaml_node_item_t *i = n->data.sequence.items.start; i < n->data.sequence.items.top; i++)
			OPTLA_TRY(check_child(doc, *i, depth, heights, &levels));
	*height = levels;
	return OPTLA_OK;
}

static optla_status parse_into(optla_yaml *doc, const void *bytes, size_t count)
{
	OPTLA_CHECK(doc->ctx, count <= (size_t)MAX_MIB << 20, OPTLA_ERR_INPUT, "%s: its %zu bytes are more than the %d MiB allowed",
	            doc->name, count, MAX_MIB);
	doc->c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
	OPTLA_CHECK(doc->ctx, doc->c_locale, OPTLA_ERR_NOMEM, "%s: no memory for the C locale", doc->name);
	OPTLA_TRY(scan_events(doc, bytes, count));
	OPTLA_TRY(load_tree(doc, bytes, count));
	const size_t nodes = (size_t)(doc->document.nodes.top - doc->document.nodes.start);
	OPTLA_CHECK(doc->ctx, nodes, OPTLA_ERR_INPUT, "%s: is empty", doc->name);
	int *heights = optla_calloc_(doc->ctx, nodes, sizeof *heights);
	if (!heights) return OPTLA_ERR_NOMEM;
	const optla_status status = check_tree(doc, 1, 1, heights);
	optla_free(doc->ctx, heights);
	return status;
}

optla_status optla_yaml_parse_(optla_ctx *ctx, const void *bytes, size_t count, const char *name, optla_yaml **out)
{
	*out = NULL;
	optla_yaml *doc = optla_calloc_(ctx, 1, sizeof *doc);
	if (!doc) return OPTLA_ERR_NOMEM;
	doc->ctx = ctx;
	doc->name = optla_strdup_(ctx, name);
	const optla_status status = doc->name ? parse_into(doc, bytes, count) : OPTLA_ERR_NOMEM;
	if (OPTLA_OK != status) optla_yaml_destroy_(&doc);
	*out = doc;
	return status;
}

void optla_yaml_destroy_(optla_yaml **doc)
{
	if (!doc || !*doc) return;
	optla_yaml *d = *doc;
	if (d->has_document) yaml_document_delete(&d->document);
	if (d->c_locale) freelocale(d->c_locale);
	optla_free(d->ctx, d->name);
	optla_free(d->ctx, d);
	*doc = NULL;
}

/* ---- the tree ---- */

optla_yaml_node optla_yaml_root_(const optla_yaml *doc) { return node_of(doc, 1) ? 1 : 0; }

int optla_yaml_line_(const optla_yaml *doc, optla_yaml_node node)
{
	const yaml_node_t *n = node_of(doc, node);
	return n ? (int)n->start_mark.line + 1 : 0;
}

optla_status optla_yaml_fail_(const optla_yaml *doc, optla_yaml_node node, const char *format, ...)
{
	char text[900];
	va_list args;
	va_start(args, format);
	vsnprintf(text, sizeof text, format, args);
	va_end(args);
	const int line = optla_yaml_line_(doc, node);
	if (!line) return OPTLA_FAIL(doc->ctx, OPTLA_ERR_INPUT, "%s: %s", doc->name, text);
	return OPTLA_FAIL(doc->ctx, OPTLA_ERR_INPUT, "%s:%d: %s", doc->name, line, text);
}

static bool has_type(const optla_yaml *doc, optla_yaml_node node, yaml_node_type_t type)
{
	const yaml_node_t *n = node_of(doc, node);
	return n && type == n->type;
}

bool optla_yaml_is_map_(const optla_yaml *doc, optla_yaml_node node) { return has_type(doc, node, YAML_MAPPING_NODE); }
bool optla_yaml_is_list_(const optla_yaml *doc, optla_yaml_node node) { return has_type(doc, node, YAML_SEQUENCE_NODE); }
bool optla_yaml_is_scalar_(const optla_yaml *doc, optla_yaml_node node) { return has_type(doc, node, YAML_SCALAR_NODE); }

optla_yaml_node optla_yaml_get_(const optla_yaml *doc, optla_yaml_node map, const char *key)
{
	if (!optla_yaml_is_map_(doc, map)) return 0;
	const yaml_node_t *n = node_of(doc, map);
	for (const yaml_node_pair_t *p = n->data.mapping.pairs.start; p < n->data.mapping.pairs.top; p++)
		if (!strcmp(text_of(node_of(doc, p->key)), key)) return p->value;
	return 0;
}

optla_status optla_yaml_require_(const optla_yaml *doc, optla_yaml_node map, const char *key, optla_yaml_node *node)
{
	*node = 0;
	if (!optla_yaml_is_map_(doc, map))
		return optla_yaml_fail_(doc, map, "a mapping with the key '%s' is needed here, not %s", key, kind_of(node_of(doc, map)));
	*node = optla_yaml_get_(doc, map, key);
	return *node ? OPTLA_OK : optla_yaml_fail_(doc, map, "the key '%s' is missing in the mapping that starts here", key);
}

size_t optla_yaml_count_(const optla_yaml *doc, optla_yaml_node list)
{
	const yaml_node_t *n = node_of(doc, list);
	return n && YAML_SEQUENCE_NODE == n->type ? (size_t)(n->data.sequence.items.top - n->data.sequence.items.start) : 0;
}

optla_yaml_node optla_yaml_item_(const optla_yaml *doc, optla_yaml_node list, size_t k)
{
	return k < optla_yaml_count_(doc, list) ? node_of(doc, list)->data.sequence.items.start[k] : 0;
}

locale_t optla_yaml_locale_(const optla_yaml *doc) { return doc->c_locale; }
const char *optla_yaml_raw_(const optla_yaml *doc, optla_yaml_node node, bool *quoted)
{
	if (!optla_yaml_is_scalar_(doc, node)) return NULL;
	const yaml_node_t *n = node_of(doc, node);
	*quoted = YAML_PLAIN_SCALAR_STYLE != n->data.scalar.style;
	return text_of(n);
}

size_t optla_yaml_pairs_(const optla_yaml *doc, optla_yaml_node map)
{
	const yaml_node_t *n = node_of(doc, map);
	return n && YAML_MAPPING_NODE == n->type ? (size_t)(n->data.mapping.pairs.top - n->data.mapping.pairs.start) : 0;
}

optla_yaml_node optla_yaml_key_(const optla_yaml *doc, optla_yaml_node map, size_t k)
{
	return k < optla_yaml_pairs_(doc, map) ? node_of(doc, map)->data.mapping.pairs.start[k].key : 0;
}

const char *optla_yaml_kind_(const optla_yaml *doc, optla_yaml_node node) { return kind_of(node_of(doc, node)); }
