/* SPDX-License-Identifier: BSD-3-Clause */
#include "io/number_text.h"

#include "io/whole_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
	optla_ctx *ctx;
	const char *name;
	double *values;
	size_t count, capacity, columns;
	int line;
} table;

static bool separates(char c) { return c == ' ' || c == '\t' || c == '\r' || c == ',' || c == ';'; }

static optla_status add(table *t, double value)
{
	if (t->count == t->capacity) {
		const size_t capacity = t->capacity ? 2 * t->capacity : 64;
		OPTLA_TRY(optla_grow_(t->ctx, (void **)&t->values, t->count, capacity, sizeof *t->values));
		t->capacity = capacity;
	}
	t->values[t->count++] = value;
	return OPTLA_OK;
}

/* One number up to a separator; hexadecimal, infinity and NaN are refused. */
static optla_status parse_number(table *t, const char *text, size_t length)
{
	char copy[64], *end = copy;
	double value = NAN;
	if (length < sizeof copy) {
		memcpy(copy, text, length);
		copy[length] = 0;
		if (strspn(copy, "+-.0123456789eE") == length) value = optla_strtod_(copy, &end);
		if (end != copy + length) value = NAN;
	}
	OPTLA_CHECK(t->ctx, isfinite(value), OPTLA_ERR_INPUT, "%s:%d: '%.*s' is not a finite number", t->name, t->line,
	            (int)optla_min_(length, 40), text);
	return add(t, value);
}

static optla_status parse_line(table *t, const char *line, size_t length)
{
	const size_t before = t->count;
	OPTLA_CHECK(t->ctx, !memchr(line, 0, length), OPTLA_ERR_INPUT, "%s:%d: holds a zero byte: this is no text", t->name, t->line);
	for (size_t k = 0; k < length && line[k] != '#';) {
		if (separates(line[k])) {
			k++;
			continue;
		}
		size_t n = 0;
		while (k + n < length && !separates(line[k + n]) && line[k + n] != '#') n++;
		OPTLA_TRY(parse_number(t, line + k, n));
		k += n;
	}
	const size_t found = t->count - before;
	if (found && !t->columns) t->columns = found;
	OPTLA_CHECK(t->ctx, !found || found == t->columns, OPTLA_ERR_INPUT, "%s:%d: %zu numbers in this line, %zu in those before",
	            t->name, t->line, found, t->columns);
	return OPTLA_OK;
}

optla_status optla_parse_numbers_(optla_ctx *ctx, const char *bytes, size_t size, const char *name, double **values,
                                  size_t *count, size_t *columns)
{
	*values = NULL;
	*count = 0;
	table t = {.ctx = ctx, .name = name, .line = 1};
	optla_status status = OPTLA_OK;
	for (size_t at = 0; at < size && !status; t.line++) {
		const char *end = memchr(bytes + at, '\n', size - at);
		const size_t length = end ? (size_t)(end - bytes) - at : size - at;
		status = parse_line(&t, bytes + at, length);
		at += length + 1;
	}
	if (!status && !t.count) status = OPTLA_FAIL(ctx, OPTLA_ERR_INPUT, "%s: no numbers in it", name);
	if (status) {
		optla_free(ctx, t.values);
		return status;
	}
	*values = t.values;
	*count = t.count;
	if (columns) *columns = t.columns;
	return OPTLA_OK;
}

optla_status optla_read_numbers_(optla_ctx *ctx, const char *path, double **values, size_t *count, size_t *columns)
{
	void *bytes;
	size_t size;
	*values = NULL;
	OPTLA_TRY(optla_read_file_(ctx, path, &bytes, &size));
	const optla_status status = optla_parse_numbers_(ctx, bytes, size, path, values, count, columns);
	optla_free(ctx, bytes);
	return status;
}
