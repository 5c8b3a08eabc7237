/* SPDX-License-Identifier: BSD-3-Clause */
/* A whole figure through the public call, with and without the real captures. */
#include "io/whole_file.h"
#include "near.h"
#include "optla/report.h"

#include <jansson.h>
#include <stdio.h>
#include <unistd.h>

static char dir[64];

static const char *in_dir(const char *name)
{
	static char path[160];
	snprintf(path, sizeof path, "%s/%s", dir, name);
	return path;
}

static bool exists(const char *name) { return 0 == access(in_dir(name), R_OK); }

/* Does the page say this? */
static bool page_has(optla_ctx *ctx, const char *text)
{
	void *bytes;
	size_t count;
	ok(optla_read_file_(ctx, in_dir("index.html"), &bytes, &count));
	const bool found = strstr(bytes, text) != NULL;
	optla_free(ctx, bytes);
	return found;
}

/* Reproduces Fig. 2.6 into a new folder and checks its numbers.json: every number ok, the ball's there only with its photos. */
static optla_ctx *fig26(const char *data_dir)
{
	snprintf(dir, sizeof dir, "/tmp/optla-reproduce-XXXXXX");
	ck_assert_ptr_nonnull(mkdtemp(dir));
	optla_ctx *ctx = test_ctx(NULL, 0);
	ok(optla_ctx_set_provenance(ctx, "test_reproduce", 3, "2026-01-01"));
	const optla_reproduce_options o = {.size = sizeof o, .out_dir = dir, .data_dir = data_dir, .seed = 3};
	const char *ids[] = {"fig2.6"};
	size_t failed = 9, with_ball = 0;
	ok(optla_reproduce(ctx, ids, 1, &o, &failed));
	ck_assert_uint_eq(failed, 0);
	json_error_t e;
	json_t *root = json_load_file(in_dir("fig2.6/numbers.json"), JSON_REJECT_DUPLICATES, &e);
	ck_assert_msg(root != NULL, "%s", e.text);
	ck_assert_str_eq(json_string_value(json_object_get(root, "id")), "fig2.6");
	ck_assert_int_eq(json_integer_value(json_object_get(root, "seed")), 3);
	ck_assert_double_gt(json_real_value(json_object_get(root, "wall_s")), 0);
	size_t k;
	json_t *n, *list = json_object_get(root, "numbers");
	json_array_foreach(list, k, n)
	{
		ck_assert_msg(json_is_true(json_object_get(n, "ok")), "%s", json_string_value(json_object_get(n, "name")));
		with_ball += !strncmp(json_string_value(json_object_get(n, "name")), "ball", 4);
	}
	ck_assert_uint_eq(json_array_size(list), data_dir ? 6 : 3);
	ck_assert_uint_eq(with_ball, data_dir ? 3 : 0);
	json_decref(root);
	return ctx;
}

static void end(optla_ctx *ctx)
{
	char command[96];
	optla_ctx_destroy(&ctx);
	snprintf(command, sizeof command, "rm -rf '%s'", dir);
	ck_assert_int_eq(system(command), 0);
}

START_TEST(a_figure_without_real_captures)
{
	optla_ctx *ctx = fig26(NULL);
	ck_assert(page_has(ctx, "<section id=\"fig2.6\">"));
	ck_assert(page_has(ctx, "Left out: the photos of the ball"));
	ck_assert(page_has(ctx, "command: test_reproduce"));
	ck_assert(!page_has(ctx, "not ok"));
	ck_assert(exists("fig2.6/screen.png") && exists("rigs/corner-screen.yaml") && !exists("fig2.6/ball.png"));
	optla_image *picture;
	ok(optla_image_load(ctx, in_dir("fig2.6/screen.png"), &picture));
	ck_assert_uint_gt(picture->width, 6 * 100);
	optla_image_destroy(&picture);
	end(ctx);
}
END_TEST

START_TEST(a_figure_with_real_captures)
{
	if (access(OPTLA_SHARED_DATA "/diligent-ball", R_OK)) return; /* a machine without them: the test above is what it can do */
	optla_ctx *ctx = fig26(OPTLA_SHARED_DATA);
	ck_assert(!page_has(ctx, "Left out"));
	ck_assert(page_has(ctx, "<img src=\"fig2.6/ball.png\""));
	ck_assert(exists("fig2.6/ball.png"));
	end(ctx);
}
END_TEST

START_TEST(a_folder_that_cannot_be_written)
{
	error_store e = {0};
	optla_ctx *ctx = test_ctx(&e, 0);
	const optla_reproduce_options o = {.size = sizeof o, .out_dir = "/proc/nowhere", .seed = 1};
	const char *ids[] = {"fig2.6"};
	size_t failed;
	status_is(optla_reproduce(ctx, ids, 1, &o, &failed), OPTLA_ERR_IO);
	ck_assert_ptr_nonnull(strstr(e.text, "/proc/nowhere"));
	optla_ctx_destroy(&ctx);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("reproduce");
	TCase *t = tcase_create("reproduce");
	tcase_set_timeout(t, 280);
	tcase_add_test(t, a_figure_without_real_captures);
	tcase_add_test(t, a_figure_with_real_captures);
	tcase_add_test(t, a_folder_that_cannot_be_written);
	suite_add_tcase(s, t);
	return run_suite(s);
}
