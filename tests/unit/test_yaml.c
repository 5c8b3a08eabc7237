/* SPDX-License-Identifier: BSD-3-Clause */
/* YAML documents: the tree, the readers of values, and the words of every message. */
#include "io/yaml_doc.h"
#include "near.h"

#include <locale.h>
#include <stdio.h>
#include <unistd.h>

static error_store errors;

static optla_yaml *parse(optla_ctx *ctx, const char *text)
{
	optla_yaml *doc;
	ok(optla_yaml_parse_(ctx, text, strlen(text), "rig.yaml", &doc));
	return doc;
}

static void fails_with(const char *text, size_t count, const char *message)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_yaml *doc;
	status_is(optla_yaml_parse_(ctx, text, count, "rig.yaml", &doc), OPTLA_ERR_INPUT);
	ck_assert_ptr_null(doc);
	ck_assert_str_eq(errors.text, message);
	optla_ctx_destroy(&ctx);
}

START_TEST(values_of_every_kind)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_yaml *doc = parse(ctx, "# a rig\nname: \"ball\"\nexposure_s: 0.0125\ncount: 96\nlive: false\nadaptive: True\n"
	                             "gain: &g 1.5e-3\nagain: *g\nlimit: .inf\nlow: -.inf\nlight: [0.5, -1, 2e2]\nempty: ''\n"
	                             "lights:\n  - {file: a.png}\n  - file: b.png\n");
	const optla_yaml_node root = optla_yaml_root_(doc);
	ck_assert(optla_yaml_is_map_(doc, root) && !optla_yaml_is_list_(doc, root) && !optla_yaml_is_scalar_(doc, root));
	ck_assert_uint_eq(optla_yaml_pairs_(doc, root), 12);
	double x, list[3];
	int n;
	bool flag;
	const char *text;
	ok(optla_yaml_number_(doc, optla_yaml_get_(doc, root, "exposure_s"), "exposure_s", 0, 10, &x));
	ck_assert(x == 0.0125);
	ok(optla_yaml_number_(doc, optla_yaml_get_(doc, root, "again"), "again", 0, 1, &x));
	ck_assert(x == 1.5e-3);
	ok(optla_yaml_number_(doc, optla_yaml_get_(doc, root, "limit"), "limit", 0, INFINITY, &x));
	ck_assert(x > 0 && isinf(x));
	ok(optla_yaml_number_(doc, optla_yaml_get_(doc, root, "low"), "low", -INFINITY, 0, &x));
	ck_assert(x < 0 && isinf(x));
	ok(optla_yaml_int_(doc, optla_yaml_get_(doc, root, "count"), "count", 1, 96, &n));
	ck_assert_int_eq(n, 96);
	ok(optla_yaml_bool_(doc, optla_yaml_get_(doc, root, "live"), "live", &flag));
	ck_assert(!flag);
	ok(optla_yaml_bool_(doc, optla_yaml_get_(doc, root, "adaptive"), "adaptive", &flag));
	ck_assert(flag);
	ok(optla_yaml_text_(doc, optla_yaml_get_(doc, root, "name"), "name", &text));
	ck_assert_str_eq(text, "ball");
	ok(optla_yaml_text_(doc, optla_yaml_get_(doc, root, "empty"), "empty", &text));
	ck_assert_str_eq(text, "");
	ok(optla_yaml_numbers_(doc, optla_yaml_get_(doc, root, "light"), "light", 3, list));
	ck_assert(list[0] == 0.5 && list[1] == -1 && list[2] == 200);
	optla_yaml_node lights, file;
	ok(optla_yaml_require_(doc, root, "lights", &lights));
	ck_assert_uint_eq(optla_yaml_count_(doc, lights), 2);
	ok(optla_yaml_require_(doc, optla_yaml_item_(doc, lights, 1), "file", &file));
	ck_assert_int_eq(optla_yaml_line_(doc, file), 15);
	ck_assert_int_eq(optla_yaml_item_(doc, lights, 2), 0);
	ck_assert_int_eq(optla_yaml_get_(doc, root, "Name"), 0);
	ck_assert_int_eq(optla_yaml_get_(doc, lights, "file"), 0);
	ck_assert_int_eq(optla_yaml_get_(doc, 0, "file"), 0);
	ck_assert_uint_eq(optla_yaml_count_(doc, root), 0);
	optla_yaml_destroy_(&doc);
	ck_assert_ptr_null(doc);
	optla_ctx_destroy(&ctx);
}
END_TEST

typedef struct {
	const char *text, *message;
} wrong_text;

static const wrong_text wrong_documents[] = {
    {"", "rig.yaml: is empty"},
    {"# nothing\n", "rig.yaml: is empty"},
    {"a: 1\nb: 2\na: 3\n", "rig.yaml:3: key 'a' is given twice (first in line 1)"},
    {"a: 1\n---\nb: 2\n", "rig.yaml:2: a second document starts here; one is allowed"},
    {"a: &x [1, *x]\n", "rig.yaml:1: a list contains itself through an alias"},
    {"{a: 1}: 2\n", "rig.yaml:1: a key must be a single word, not a mapping"},
    {"a: \"x\\0y\"\n", "rig.yaml:1: a zero byte in a text is not allowed"},
    {"a: [1, 2\nb: 3\n",
     "rig.yaml:2: not valid YAML: did not find expected ',' or ']', while parsing a flow sequence (column 2)"},
    {"a: 1\n\tb: 2\n",
     "rig.yaml:2: not valid YAML: found a tab character that violates indentation, while scanning a plain scalar "
     "(column 1)"},
    {"a: 1\nb: \xff\xfe\n", "rig.yaml:2: invalid leading UTF-8 octet (byte 8): the file must be text in UTF-8"},
    {"a: 1\nb: \x01\n", "rig.yaml:2: control characters are not allowed (byte 8): the file must be text in UTF-8"},
    {"a: *nobody\n", "rig.yaml:1: not valid YAML: found undefined alias (column 4)"},
};

START_TEST(wrong_documents_are_named_by_line)
{
	fails_with(wrong_documents[_i].text, strlen(wrong_documents[_i].text), wrong_documents[_i].message);
}
END_TEST

START_TEST(nesting_ends_at_64_levels)
{
	char text[8192] = "";
	for (int k = 0; k < 64; k++) strcat(text, "[");
	for (int k = 0; k < 64; k++) strcat(text, "]");
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_yaml *doc = parse(ctx, text);
	optla_yaml_destroy_(&doc);
	optla_ctx_destroy(&ctx);
	memset(text, '[', 65);
	memset(text + 65, ']', 65);
	fails_with(text, 130, "rig.yaml:1: nested deeper than 64 levels");
	memset(text, '[', sizeof text);
	fails_with(text, sizeof text, "rig.yaml:1: nested deeper than 64 levels");
}
END_TEST

START_TEST(aliases_multiply_neither_depth_nor_time)
{
	/* 60 lists, each of two aliases to the one before: 2^60 paths, 61 levels; ten more are too deep. */
	char text[8192] = "a0: &a0 [x]\n";
	for (int k = 1; k <= 60; k++) {
		char line[64];
		snprintf(line, sizeof line, "a%d: &a%d [*a%d, *a%d]\n", k, k, k - 1, k - 1);
		strcat(text, line);
	}
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_yaml *doc = parse(ctx, text);
	ck_assert_uint_eq(optla_yaml_pairs_(doc, optla_yaml_root_(doc)), 61);
	optla_yaml_destroy_(&doc);
	optla_ctx_destroy(&ctx);
	for (int k = 61; k <= 70; k++) {
		char line[64];
		snprintf(line, sizeof line, "a%d: &a%d [*a%d, *a%d]\n", k, k, k - 1, k - 1);
		strcat(text, line);
	}
	fails_with(text, strlen(text), "rig.yaml:62: nested deeper than 64 levels through aliases");
}
END_TEST

typedef struct {
	const char *yaml, *message;
	char reader; /* number 0..10, Unbounded number, int 1..4, bool, text, list of 2, keys, require */
} wrong_value;

static const wrong_value wrong_values[] = {
    {"exposure_s: abc", "rig.yaml:1: exposure_s is 'abc': a number from 0 to 10 is needed", 'n'},
    {"\nexposure_s: 11", "rig.yaml:2: exposure_s is '11': a number from 0 to 10 is needed", 'n'},
    {"exposure_s: -1e-9", "rig.yaml:1: exposure_s is '-1e-9': a number from 0 to 10 is needed", 'n'},
    {"exposure_s: 1 s", "rig.yaml:1: exposure_s is '1 s': a number from 0 to 10 is needed", 'n'},
    {"exposure_s: 0x1p1", "rig.yaml:1: exposure_s is '0x1p1': a number from 0 to 10 is needed", 'n'},
    {"exposure_s: 1,5", "rig.yaml:1: exposure_s is '1,5': a number from 0 to 10 is needed", 'n'},
    {"exposure_s: nan", "rig.yaml:1: exposure_s is 'nan': a number from 0 to 10 is needed", 'n'},
    {"exposure_s: .nan", "rig.yaml:1: exposure_s is '.nan': a number is needed", 'u'},
    {"exposure_s: inf", "rig.yaml:1: exposure_s is 'inf': a number is needed", 'u'},
    {"exposure_s: 1e999", "rig.yaml:1: exposure_s is '1e999': a number is needed", 'u'},
    {"exposure_s: .inf", "rig.yaml:1: exposure_s is '.inf': a number from 0 to 10 is needed", 'n'},
    {"exposure_s:", "rig.yaml:1: exposure_s has no value: a number from 0 to 10 is needed", 'n'},
    {"exposure_s: [1]", "rig.yaml:1: exposure_s is a list: a number from 0 to 10 is needed", 'n'},
    {"exposure_s: {a: 1}", "rig.yaml:1: exposure_s is a mapping: a number from 0 to 10 is needed", 'n'},
    {"exposure_s: 5", "rig.yaml:1: exposure_s is '5': a whole number from 1 to 4 is needed", 'i'},
    {"exposure_s: 1.5", "rig.yaml:1: exposure_s is '1.5': a whole number from 1 to 4 is needed", 'i'},
    {"exposure_s: 99999999999999999999", "rig.yaml:1: exposure_s is '99999999999999999999': a whole number from 1 to 4 is needed",
     'i'},
    {"exposure_s: yes", "rig.yaml:1: exposure_s is 'yes': true or false is needed", 'b'},
    {"exposure_s: ~", "rig.yaml:1: exposure_s has no value: a text is needed", 't'},
    {"exposure_s: [a]", "rig.yaml:1: exposure_s is a list: a text is needed", 't'},
    {"exposure_s: 3", "rig.yaml:1: exposure_s is '3': a list of 2 numbers is needed", 'l'},
    {"exposure_s: [1, 2, 3]", "rig.yaml:1: exposure_s has 3 entries: a list of 2 numbers is needed", 'l'},
    {"exposure_s: [1,\n x]", "rig.yaml:2: exposure_s[1] is 'x': a number is needed", 'l'},
    {"exposre_s: 1", "rig.yaml:1: unknown key 'exposre_s' (did you mean 'exposure_s'? allowed: name, exposure_s, photos)", 'k'},
    {"naem: 1", "rig.yaml:1: unknown key 'naem' (did you mean 'name'? allowed: name, exposure_s, photos)", 'k'},
    {"name: 1\ncolour: 1", "rig.yaml:2: unknown key 'colour' (allowed: name, exposure_s, photos)", 'k'},
    {"- name", "rig.yaml:1: a mapping (lines of 'key: value') is needed here, not a list", 'k'},
    {"name: 1", "rig.yaml:1: the key 'photos' is missing in the mapping that starts here", 'r'},
    {"[name]", "rig.yaml:1: a mapping with the key 'photos' is needed here, not a list", 'r'},
};

static optla_status read_wrong(const optla_yaml *doc, char reader)
{
	const optla_yaml_node root = optla_yaml_root_(doc), value = optla_yaml_get_(doc, root, "exposure_s");
	double x[2] = {-7, -7};
	int n = -7;
	bool flag;
	const char *text;
	optla_yaml_node node;
	optla_status s = OPTLA_OK;
	switch (reader) {
	case 'n': s = optla_yaml_number_(doc, value, "exposure_s", 0, 10, x); break;
	case 'u': s = optla_yaml_number_(doc, value, "exposure_s", -INFINITY, INFINITY, x); break;
	case 'i': s = optla_yaml_int_(doc, value, "exposure_s", 1, 4, &n); break;
	case 'b': s = optla_yaml_bool_(doc, value, "exposure_s", &flag); break;
	case 't': s = optla_yaml_text_(doc, value, "exposure_s", &text); break;
	case 'l': return optla_yaml_numbers_(doc, value, "exposure_s", 2, x);
	case 'k': return optla_yaml_check_keys_(doc, root, "name|exposure_s|photos");
	case 'r': return optla_yaml_require_(doc, root, "photos", &node);
	}
	ck_assert(x[0] == -7 && n == -7); /* nothing is set by a failure */
	return s;
}

START_TEST(wrong_values_say_what_is_allowed)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	const wrong_value *w = &wrong_values[_i];
	optla_yaml *doc = parse(ctx, w->yaml);
	status_is(read_wrong(doc, w->reader), OPTLA_ERR_INPUT);
	ck_assert_str_eq(errors.text, w->message);
	ck_assert_int_eq(errors.count, 1);
	optla_yaml_destroy_(&doc);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(allowed_keys_pass)
{
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_yaml *doc = parse(ctx, "photos: 1\nname: 2\n");
	ok(optla_yaml_check_keys_(doc, optla_yaml_root_(doc), "name|exposure_s|photos"));
	/* a part of an allowed word, and two of them joined, are not allowed */
	status_is(optla_yaml_check_keys_(doc, optla_yaml_root_(doc), "names|exposure_s|photos"), OPTLA_ERR_INPUT);
	optla_yaml_destroy_(&doc);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(numbers_do_not_depend_on_the_locale)
{
	static const char *const names[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "pl_PL.UTF-8"};
	for (size_t k = 0; k < sizeof names / sizeof *names; k++)
		if (setlocale(LC_ALL, names[k])) break;
	/* With no such locale on this machine the test still covers the way through uselocale. */
	optla_ctx *ctx = test_ctx(&errors, 1);
	optla_yaml *doc = parse(ctx, "1.25");
	double x;
	ok(optla_yaml_number_(doc, optla_yaml_root_(doc), "x", 0, 2, &x));
	ck_assert(x == 1.25);
	optla_yaml_destroy_(&doc);
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(any_prefix_gives_a_document_or_an_error)
{
	static const char text[] = "name: ball\nlights: &l\n - {a: 1, b: [2, 3]}\n - \"q\\u00e9\"\n - *l2\n - |\n  x\n  \xc3\xa9\n";
	optla_ctx *ctx = test_ctx(&errors, 1);
	for (size_t n = 0; n <= sizeof text - 1; n++) {
		char *copy = malloc(n + 1); /* of the exact size: reading past the end is seen by the sanitizer */
		memcpy(copy, text, n);
		optla_yaml *doc;
		const optla_status s = optla_yaml_parse_(ctx, copy, n, "t.yaml", &doc);
		ck_assert(OPTLA_OK == s ? doc != NULL : OPTLA_ERR_INPUT == s && !doc);
		optla_yaml_destroy_(&doc);
		free(copy);
	}
	optla_ctx_destroy(&ctx);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
	long k = 0;
	for (bool done = false; !done; k++) {
		alloc_budget budget = {.left = k + 1}; /* one for the context */
		optla_ctx *ctx;
		const optla_ctx_desc d = {.size = sizeof d,
		                          .alloc = budget_alloc,
		                          .free = budget_free,
		                          .alloc_user = &budget,
		                          .error = error_keep,
		                          .error_user = &errors};
		ok(optla_ctx_create(&ctx, &d));
		optla_yaml *doc;
		const optla_status s = optla_yaml_parse_(ctx, "a: {b: 1}", 9, "t.yaml", &doc);
		done = OPTLA_OK == s;
		if (!done) status_is(s, OPTLA_ERR_NOMEM);
		optla_yaml_destroy_(&doc);
		optla_ctx_destroy(&ctx);
		ck_assert_int_eq(budget.live, 0);
	}
	ck_assert_int_eq(k, 6); /* document, name, levels, two lists of keys; then success */
}
END_TEST

static Suite *suite(void)
{
	Suite *s = suite_create("yaml");
	TCase *c = tcase_create("yaml");
	tcase_add_test(c, values_of_every_kind);
	tcase_add_loop_test(c, wrong_documents_are_named_by_line, 0, sizeof wrong_documents / sizeof *wrong_documents);
	tcase_add_test(c, nesting_ends_at_64_levels);
	tcase_add_test(c, aliases_multiply_neither_depth_nor_time);
	tcase_add_loop_test(c, wrong_values_say_what_is_allowed, 0, sizeof wrong_values / sizeof *wrong_values);
	tcase_add_test(c, allowed_keys_pass);
	tcase_add_test(c, numbers_do_not_depend_on_the_locale);
	tcase_add_test(c, any_prefix_gives_a_document_or_an_error);
	tcase_add_test(c, every_allocation_may_fail);
	suite_add_tcase(s, c);
	return s;
}

int main(void) { return run_suite(suite()); }
