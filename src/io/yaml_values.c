/* SPDX-License-Identifier: BSD-3-Clause */
/* Readers of YAML values: keys, numbers, flags, texts, with messages that say what is allowed. */
#include "io/yaml_impl.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- keys ---- */

enum { MAX_WORD = 63, MAX_ALLOWED = 700 };

/* Letters to insert, delete, change or swap with a neighbour to get from a to b ("optimal string alignment"). */
static int edit_distance(const char *a, size_t na, const char *b, size_t nb)
{
	int rows[3][MAX_WORD + 1];
	for (size_t j = 0; j <= nb; j++) rows[0][j] = (int)j;
	for (size_t i = 1; i <= na; i++) {
		int *now = rows[i % 3];
		const int *above = rows[(i + 2) % 3], *above2 = rows[(i + 1) % 3];
		now[0] = (int)i;
		for (size_t j = 1; j <= nb; j++) {
			int d = above[j - 1] + (a[i - 1] != b[j - 1]);
			if (above[j] + 1 < d) d = above[j] + 1;
			if (now[j - 1] + 1 < d) d = now[j - 1] + 1;
			if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && above2[j - 2] + 1 < d) d = above2[j - 2] + 1;
			now[j] = d;
		}
	}
	return rows[na % 3][nb];
}

/* The word of "a|b|c" nearest to text and its length; NULL when none is near enough to be a slip of the pen. */
static const char *nearest_word(const char *allowed, const char *text, size_t *length)
{
	const size_t n = strlen(text);
	const char *best = NULL;
	int best_distance = INT_MAX;
	for (const char *word = allowed; *word;) {
		const size_t len = strcspn(word, "|");
		if (len <= MAX_WORD && n <= MAX_WORD) {
			const int d = edit_distance(word, len, text, n);
			if (d < best_distance && d <= (int)optla_max_(1, len / 3)) {
				best_distance = d;
				best = word;
				*length = len;
			}
		}
		word += len + ('|' == word[len]);
	}
	return best;
}

static bool is_allowed(const char *allowed, const char *text)
{
	const size_t n = strlen(text);
	for (const char *word = allowed; *word;) {
		const size_t len = strcspn(word, "|");
		if (len == n && !memcmp(word, text, n)) return true;
		word += len + ('|' == word[len]);
	}
	return false;
}

/* "a|b|c" as "a, b, c" */
static const char *list_words(const char *allowed, char *buffer, size_t bytes)
{
	size_t used = 0;
	for (const char *c = allowed; *c && used + 3 < bytes; c++) {
		if ('|' == *c) buffer[used++] = ',';
		buffer[used++] = (char)('|' == *c ? ' ' : *c);
	}
	buffer[used] = 0;
	return buffer;
}

static optla_status fail_unknown(const optla_yaml *doc, optla_yaml_node key, const char *text, const char *allowed)
{
	char words[MAX_ALLOWED];
	list_words(allowed, words, sizeof words);
	size_t length = 0;
	const char *hint = nearest_word(allowed, text, &length);
	if (hint)
		return optla_yaml_fail_(doc, key, "unknown key '%.64s' (did you mean '%.*s'? allowed: %s)", text, (int)length, hint,
		                        words);
	return optla_yaml_fail_(doc, key, "unknown key '%.64s' (allowed: %s)", text, words);
}

optla_status optla_yaml_check_keys_(const optla_yaml *doc, optla_yaml_node map, const char *allowed)
{
	if (!optla_yaml_is_map_(doc, map))
		return optla_yaml_fail_(doc, map, "a mapping (lines of 'key: value') is needed here, not %s", optla_yaml_kind_(doc, map));
	for (size_t k = 0; k < optla_yaml_pairs_(doc, map); k++) {
		bool quoted;
		const optla_yaml_node key = optla_yaml_key_(doc, map, k);
		const char *text = optla_yaml_raw_(doc, key, &quoted);
		if (!is_allowed(allowed, text)) return fail_unknown(doc, key, text, allowed);
	}
	return OPTLA_OK;
}

/* ---- values ---- */

static bool is_null(const char *text, bool quoted)
{
	return !quoted && (!*text || !strcmp(text, "~") || !strcmp(text, "null") || !strcmp(text, "Null") || !strcmp(text, "NULL"));
}

static optla_status fail_value(const optla_yaml *doc, optla_yaml_node node, const char *what, const char *needed)
{
	bool quoted = false;
	const char *text = optla_yaml_raw_(doc, node, &quoted);
	if (!text) return optla_yaml_fail_(doc, node, "%s is %s: %s is needed", what, optla_yaml_kind_(doc, node), needed);
	if (is_null(text, quoted)) return optla_yaml_fail_(doc, node, "%s has no value: %s is needed", what, needed);
	return optla_yaml_fail_(doc, node, "%s is '%.64s': %s is needed", what, text, needed);
}

static const char *range_text(char *buffer, size_t bytes, const char *noun, double lower, double upper)
{
	if (isinf(lower) && isinf(upper))
		snprintf(buffer, bytes, "%s", noun);
	else if (isinf(upper))
		snprintf(buffer, bytes, "%s of at least %.10g", noun, lower);
	else if (isinf(lower))
		snprintf(buffer, bytes, "%s of at most %.10g", noun, upper);
	else
		snprintf(buffer, bytes, "%s from %.10g to %.10g", noun, lower, upper);
	return buffer;
}

/* YAML's infinities (.inf, -.inf) and strtod's decimal numbers; not its hexadecimal ones, "infinity" or NaN. */
static bool read_number(const optla_yaml *doc, const char *text, double *value)
{
	const char *digits = text + ('-' == *text || '+' == *text);
	if (!strcmp(digits, ".inf") || !strcmp(digits, ".Inf") || !strcmp(digits, ".INF")) {
		*value = '-' == *text ? -INFINITY : INFINITY;
		return true;
	}
	if (!*digits || digits[strspn(digits, "0123456789.eE+-")]) return false;
	char *end;
	/* uselocale changes this thread alone, and for the length of one call. */
	const locale_t old = uselocale(optla_yaml_locale_(doc));
	const double v = strtod(text, &end);
	uselocale(old);
	if (end == text || *end || !isfinite(v)) return false; /* 1e999 is no number either */
	*value = v;
	return true;
}

optla_status optla_yaml_number_(const optla_yaml *doc, optla_yaml_node node, const char *what, double lower, double upper,
                                double *value)
{
	bool quoted;
	const char *text = optla_yaml_raw_(doc, node, &quoted);
	double v = 0;
	if (!text || !read_number(doc, text, &v) || v < lower || v > upper) {
		char needed[128];
		return fail_value(doc, node, what, range_text(needed, sizeof needed, "a number", lower, upper));
	}
	*value = v;
	return OPTLA_OK;
}

optla_status optla_yaml_int_(const optla_yaml *doc, optla_yaml_node node, const char *what, int lower, int upper, int *value)
{
	bool quoted;
	const char *text = optla_yaml_raw_(doc, node, &quoted);
	char *end = NULL;
	errno = 0;
	const bool starts = text && *text && !text[strspn(text, "+-0123456789")];
	const long v = starts ? strtol(text, &end, 10) : 0;
	if (!starts || *end || errno || v < lower || v > upper) {
		char needed[128];
		const double low = INT_MIN == lower ? -(double)INFINITY : lower, high = INT_MAX == upper ? (double)INFINITY : upper;
		return fail_value(doc, node, what, range_text(needed, sizeof needed, "a whole number", low, high));
	}
	*value = (int)v;
	return OPTLA_OK;
}

static bool is_one_of(const char *text, const char *const words[3])
{
	return !strcmp(text, words[0]) || !strcmp(text, words[1]) || !strcmp(text, words[2]);
}

optla_status optla_yaml_bool_(const optla_yaml *doc, optla_yaml_node node, const char *what, bool *value)
{
	static const char *const yes[3] = {"true", "True", "TRUE"}, *const no[3] = {"false", "False", "FALSE"};
	bool quoted;
	const char *text = optla_yaml_raw_(doc, node, &quoted);
	if (!text || (!is_one_of(text, yes) && !is_one_of(text, no))) return fail_value(doc, node, what, "true or false");
	*value = is_one_of(text, yes);
	return OPTLA_OK;
}

optla_status optla_yaml_text_(const optla_yaml *doc, optla_yaml_node node, const char *what, const char **value)
{
	*value = NULL;
	bool quoted = false;
	const char *text = optla_yaml_raw_(doc, node, &quoted);
	if (!text || is_null(text, quoted)) return fail_value(doc, node, what, "a text");
	*value = text;
	return OPTLA_OK;
}

optla_status optla_yaml_numbers_(const optla_yaml *doc, optla_yaml_node node, const char *what, size_t count, double *values)
{
	char text[128];
	snprintf(text, sizeof text, "a list of %zu numbers", count);
	if (!optla_yaml_is_list_(doc, node)) return fail_value(doc, node, what, text);
	if (optla_yaml_count_(doc, node) != count)
		return optla_yaml_fail_(doc, node, "%s has %zu entries: %s is needed", what, optla_yaml_count_(doc, node), text);
	for (size_t k = 0; k < count; k++) {
		snprintf(text, sizeof text, "%.64s[%zu]", what, k);
		OPTLA_TRY(optla_yaml_number_(doc, optla_yaml_item_(doc, node, k), text, -INFINITY, INFINITY, &values[k]));
	}
	return OPTLA_OK;
}
