/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers of a figure and numbers.json (through Jansson). */
#include "report/numbers.h"

#include "io/whole_file.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

bool optla_number_ok_(const optla_number *n) { return isfinite(n->value) && n->value >= n->low && n->value <= n->high; }

optla_status optla_numbers_add_(optla_numbers *numbers, const char *name, double value, optla_expect expect)
{
	optla_ctx *ctx = numbers->ctx;
	if (numbers->count == numbers->room) {
		void *item = numbers->item;
		OPTLA_TRY(optla_grow_(ctx, &item, numbers->count, 2 * numbers->room + 8, sizeof *numbers->item));
		numbers->item = item;
		numbers->room = 2 * numbers->room + 8;
	}
	optla_number *n = &numbers->item[numbers->count];
	*n = (optla_number){.value = value, .thesis = expect.thesis, .low = expect.low, .high = expect.high};
	n->name = optla_strdup_(ctx, name);
	n->unit = optla_strdup_(ctx, expect.unit ? expect.unit : "");
	n->why = optla_strdup_(ctx, expect.why ? expect.why : "");
	numbers->count++; /* also when a copy failed: free takes NULL */
	return n->name && n->unit && n->why ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

size_t optla_numbers_failed_(const optla_numbers *numbers)
{
	size_t failed = 0;
	for (size_t k = 0; k < numbers->count; k++) failed += !optla_number_ok_(&numbers->item[k]);
	return failed;
}

void optla_numbers_free_(optla_numbers *numbers)
{
	for (size_t k = 0; k < numbers->count; k++) {
		optla_free(numbers->ctx, numbers->item[k].name);
		optla_free(numbers->ctx, numbers->item[k].unit);
		optla_free(numbers->ctx, numbers->item[k].why);
	}
	optla_free(numbers->ctx, numbers->item);
	numbers->item = NULL;
	numbers->count = numbers->room = 0;
}

static json_t *real_or_null(double value) { return isfinite(value) ? json_real(value) : json_null(); }

static json_t *number_json(const optla_number *n)
{
	/* json_object_set_new() and friends accept NULL values by failing, so one check of the result is enough */
	json_t *o = json_object();
	int bad = json_object_set_new(o, "name", json_string(n->name));
	bad |= json_object_set_new(o, "value", real_or_null(n->value));
	bad |= json_object_set_new(o, "unit", json_string(n->unit));
	bad |= json_object_set_new(o, "thesis", real_or_null(n->thesis));
	bad |= json_object_set_new(o, "low", real_or_null(n->low));
	bad |= json_object_set_new(o, "high", real_or_null(n->high));
	bad |= json_object_set_new(o, "ok", json_boolean(optla_number_ok_(n)));
	if (!bad) return o;
	json_decref(o);
	return NULL;
}

optla_status optla_numbers_save_(const optla_numbers *numbers, const char *path, const char *id, uint64_t seed, double wall_s)
{
	json_t *root = json_object(), *list = json_array();
	int bad = json_object_set_new(root, "id", json_string(id));
	bad |= json_object_set_new(root, "seed", json_integer((json_int_t)seed));
	bad |= json_object_set_new(root, "wall_s", real_or_null(wall_s));
	for (size_t k = 0; k < numbers->count; k++) bad |= json_array_append_new(list, number_json(&numbers->item[k]));
	bad |= json_object_set_new(root, "numbers", list);
	char *text = bad ? NULL : json_dumps(root, JSON_INDENT(1) | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(17));
	json_decref(root);
	OPTLA_CHECK(numbers->ctx, text, OPTLA_ERR_NOMEM, "%s: no memory for its text, or a name that is not UTF-8", path);
	const optla_status s = optla_write_file_(numbers->ctx, path, text, strlen(text));
	free(text); /* Jansson's own malloc */
	return s;
}

optla_status optla_numbers_summary_(optla_ctx *ctx, const char *path, size_t *count, size_t *failed)
{
	void *bytes;
	size_t size;
	*count = *failed = 0;
	OPTLA_TRY(optla_read_output_(ctx, path, &bytes, &size));
	json_error_t e = {0};
	json_t *root = json_loadb(bytes, size, 0, &e);
	optla_free(ctx, bytes);
	const json_t *list = json_object_get(root, "numbers");
	*count = json_array_size(list);
	for (size_t k = 0; k < *count; k++) *failed += !json_is_true(json_object_get(json_array_get(list, k), "ok"));
	const bool good = json_is_array(list);
	json_decref(root);
	OPTLA_CHECK(ctx, good, OPTLA_ERR_INPUT, "%s:%d: not the numbers of a figure: %s", path, e.line,
	            e.text[0] ? e.text : "an object with a list 'numbers' is wanted");
	return OPTLA_OK;
}
