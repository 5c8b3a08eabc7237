/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as YAML: a document or an error; and every reader on every node of the document. */
#include "fuzz.h"
#include "io/yaml_doc.h"

#include <math.h>

static void read_node(const optla_yaml *doc, optla_yaml_node node)
{
	double x, list[2];
	int n;
	bool flag;
	const char *text;
	optla_yaml_node found;
	optla_yaml_number_(doc, node, "x", -INFINITY, INFINITY, &x);
	optla_yaml_number_(doc, node, "x", 0, 1, &x);
	optla_yaml_int_(doc, node, "n", 0, 100, &n);
	optla_yaml_bool_(doc, node, "flag", &flag);
	optla_yaml_text_(doc, node, "text", &text);
	optla_yaml_numbers_(doc, node, "list", 2, list);
	optla_yaml_check_keys_(doc, node, "name|exposure_s|photos|lights|file");
	optla_yaml_require_(doc, node, "exposure_s", &found);
	if (optla_yaml_line_(doc, node) < 1) abort();
}

/* Through aliases a node can be reached by very many ways: steps bounds them. */
static void walk(const optla_yaml *doc, optla_yaml_node node, int *steps)
{
	if (!node || --*steps < 0) return;
	read_node(doc, node);
	for (size_t k = 0; k < optla_yaml_count_(doc, node) && *steps > 0; k++) walk(doc, optla_yaml_item_(doc, node, k), steps);
	for (size_t k = 0; k < optla_yaml_pairs_(doc, node) && *steps > 0; k++) {
		const char *key;
		const optla_yaml_node name = optla_yaml_key_(doc, node, k);
		if (!optla_yaml_is_scalar_(doc, name)) abort(); /* promised by the loader */
		walk(doc, name, steps);
		if (OPTLA_OK == optla_yaml_text_(doc, name, "key", &key)) walk(doc, optla_yaml_get_(doc, node, key), steps);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	optla_ctx *ctx = fuzz_ctx();
	optla_yaml *doc;
	if (OPTLA_OK == optla_yaml_parse_(ctx, data, size, "fuzz.yaml", &doc)) {
		int steps = 1000;
		walk(doc, optla_yaml_root_(doc), &steps);
	} else if (doc || !*optla_ctx_last_error(ctx)) {
		abort();
	}
	optla_yaml_destroy_(&doc);
	optla_ctx_destroy(&ctx);
	return 0;
}
