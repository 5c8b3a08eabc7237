/* SPDX-License-Identifier: BSD-3-Clause */
/* Option structs described by tables: validation, setting from text, printing. */
#include "base_impl.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const void *field(const optla_option *o, const void *opts) { return (const char *)opts + o->offset; }

static double number(const optla_option *o, const void *opts)
{
	const void *p = field(o, opts);
	switch (o->type) {
	case OPTLA_OPTION_INT:
	case OPTLA_OPTION_ENUM: return *(const int *)p;
	case OPTLA_OPTION_U64: return (double)*(const uint64_t *)p;
	case OPTLA_OPTION_DOUBLE: return *(const double *)p;
	case OPTLA_OPTION_BOOL: return *(const bool *)p;
	case OPTLA_OPTION_STRING: break;
	}
	return 0;
}

static int count_choices(const char *choices)
{
	int n = 1;
	for (const char *c = choices; *c; c++) n += *c == '|';
	return n;
}

/* Index of text in "a|b|c", or -1. */
static int find_choice(const char *choices, const char *text)
{
	const size_t n = strlen(text);
	int k = 0;
	for (const char *c = choices; c; c = strchr(c, '|'), c = c ? c + 1 : NULL, k++)
		if (!strncmp(c, text, n) && (c[n] == '|' || !c[n])) return k;
	return -1;
}

static optla_status check_one(optla_ctx *ctx, const optla_option *o, const void *opts)
{
	if (o->type == OPTLA_OPTION_STRING || o->type == OPTLA_OPTION_BOOL) return OPTLA_OK;
	const double v = number(o, opts);
	if (o->type == OPTLA_OPTION_ENUM) {
		OPTLA_CHECK(ctx, v >= 0 && v < count_choices(o->choices), OPTLA_ERR_ARG, "option '%s' is %g: allowed are %s", o->name, v,
		            o->choices);
		return OPTLA_OK;
	}
	OPTLA_CHECK(ctx, v >= o->lower && v <= o->upper, OPTLA_ERR_ARG, "option '%s' is %g%s%s: allowed is %g to %g", o->name, v,
	            *o->unit ? " " : "", o->unit, o->lower, o->upper);
	return OPTLA_OK;
}

optla_status optla_options_check(optla_ctx *ctx, const optla_option_table *table, const void *opts)
{
	size_t size;
	memcpy(&size, opts, sizeof size);
	OPTLA_CHECK(ctx, size == table->struct_size, OPTLA_ERR_ARG,
	            "%s has size %zu, this library knows %zu: start from the defaults", table->name, size, table->struct_size);
	for (size_t k = 0; k < table->count; k++) OPTLA_TRY(check_one(ctx, &table->options[k], opts));
	return OPTLA_OK;
}

static bool parse_number(const char *text, double *v)
{
	char *end;
	errno = 0;
	*v = optla_strtod_(text, &end);
	return end != text && !*end && !isnan(*v);
}

static optla_status bad(optla_ctx *ctx, const optla_option *o, const char *text)
{
	switch (o->type) {
	case OPTLA_OPTION_ENUM:
		return OPTLA_FAIL(ctx, OPTLA_ERR_ARG, "option '%s': '%s' is not one of %s", o->name, text, o->choices);
	case OPTLA_OPTION_BOOL: return OPTLA_FAIL(ctx, OPTLA_ERR_ARG, "option '%s': '%s' is not true or false", o->name, text);
	case OPTLA_OPTION_INT:
	case OPTLA_OPTION_U64:
		return OPTLA_FAIL(ctx, OPTLA_ERR_ARG, "option '%s': '%s' is not a whole number from %.0f to %.0f", o->name, text,
		                  o->lower, o->upper);
	case OPTLA_OPTION_DOUBLE:
	case OPTLA_OPTION_STRING: break;
	}
	return OPTLA_FAIL(ctx, OPTLA_ERR_ARG, "option '%s': '%s' is not a number from %g to %g", o->name, text, o->lower, o->upper);
}

optla_status optla_option_set(optla_ctx *ctx, const optla_option_table *table, void *opts, const char *name, const char *text)
{
	const optla_option *o = NULL;
	for (size_t k = 0; k < table->count && !o; k++)
		if (!strcmp(table->options[k].name, name)) o = &table->options[k];
	OPTLA_CHECK(ctx, o, OPTLA_ERR_ARG, "%s has no option '%s'", table->name, name);
	void *p = (char *)opts + o->offset;
	double v = 0;
	char *end;
	switch (o->type) {
	case OPTLA_OPTION_STRING: *(const char **)p = text; return OPTLA_OK;
	case OPTLA_OPTION_BOOL:
		if (strcmp(text, "true") && strcmp(text, "false")) return bad(ctx, o, text);
		*(bool *)p = !strcmp(text, "true");
		return OPTLA_OK;
	case OPTLA_OPTION_ENUM: {
		const int k = *text ? find_choice(o->choices, text) : -1;
		if (k < 0) return bad(ctx, o, text);
		*(int *)p = k;
		return OPTLA_OK;
	}
	case OPTLA_OPTION_U64: {
		errno = 0;
		const unsigned long long u = strtoull(text, &end, 10);
		if (end == text || *end || errno || *text == '-' || (double)u < o->lower || (double)u > o->upper)
			return bad(ctx, o, text);
		*(uint64_t *)p = u;
		return OPTLA_OK;
	}
	case OPTLA_OPTION_INT:
		if (!parse_number(text, &v) || v != floor(v) || v < o->lower || v > o->upper) return bad(ctx, o, text);
		*(int *)p = (int)v;
		return OPTLA_OK;
	case OPTLA_OPTION_DOUBLE:
		if (!parse_number(text, &v) || v < o->lower || v > o->upper) return bad(ctx, o, text);
		*(double *)p = v;
		return OPTLA_OK;
	}
	return OPTLA_OK;
}

const char *optla_option_format(const optla_option *option, const void *opts, char *buffer, size_t bytes)
{
	const void *p = field(option, opts);
	switch (option->type) {
	case OPTLA_OPTION_STRING: snprintf(buffer, bytes, "%s", *(const char *const *)p ? *(const char *const *)p : ""); break;
	case OPTLA_OPTION_BOOL: snprintf(buffer, bytes, "%s", *(const bool *)p ? "true" : "false"); break;
	case OPTLA_OPTION_U64: snprintf(buffer, bytes, "%llu", (unsigned long long)*(const uint64_t *)p); break;
	case OPTLA_OPTION_INT: snprintf(buffer, bytes, "%d", *(const int *)p); break;
	case OPTLA_OPTION_DOUBLE: optla_double_text_(*(const double *)p, 12, buffer, bytes); break;
	case OPTLA_OPTION_ENUM: {
		const char *c = option->choices;
		for (int k = *(const int *)p; k > 0 && c; k--) {
			c = strchr(c, '|');
			c = c ? c + 1 : NULL;
		}
		snprintf(buffer, bytes, "%.*s", c ? (int)strcspn(c, "|") : 1, c ? c : "?");
		break;
	}
	}
	return buffer;
}
