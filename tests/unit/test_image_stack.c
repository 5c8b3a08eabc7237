/* SPDX-License-Identifier: BSD-3-Clause */
/* Stacks of photos: the same images, errors and provenance for any number of threads. */
#include "pictures.h"

#include <sys/stat.h>

enum { COUNT = 23 };

typedef struct {
	char dir[64], paths[COUNT][128];
	const char *list[COUNT];
} stack;

/* Files of all formats, each with another picture. */
static void make_stack(stack *s)
{
	static const char *const endings[] = {"png", "exr", "tif", "npy", "pfm"};
	optla_ctx *ctx = test_ctx(NULL, 1);
	snprintf(s->dir, sizeof s->dir, "/tmp/optla-stack-XXXXXX");
	ck_assert_ptr_nonnull(mkdtemp(s->dir));
	for (int k = 0; k < COUNT; k++) {
		const char *ending = endings[k % 5];
		optla_image *m = picture(ctx, 20 + (size_t)k, 11, 3, strcmp(ending, "png") ? OPTLA_IMAGE_LINEAR : OPTLA_IMAGE_RAW_DN);
		m->data[0] = (float)k;
		snprintf(s->paths[k], sizeof s->paths[k], "%s/%02d.%s", s->dir, k, ending);
		s->list[k] = s->paths[k];
		ok(optla_image_save(m, s->paths[k]));
		optla_image_destroy(&m);
	}
	optla_ctx_destroy(&ctx);
}

static void remove_stack(stack *s)
{
	for (int k = 0; k < COUNT; k++) unlink(s->paths[k]);
	rmdir(s->dir);
}

static void destroy_all(optla_image **images)
{
	for (int k = 0; k < COUNT; k++) optla_image_destroy(&images[k]);
}

START_TEST(same_images_for_any_number_of_threads)
{
	const int threads[] = {1, 2, 7};
	stack s;
	make_stack(&s);
	char *provenance[3];
	optla_image *images[3][COUNT];
	optla_ctx *ctx[3];
	for (int t = 0; t < 3; t++) {
		ctx[t] = test_ctx(NULL, threads[t]);
		ok(optla_image_load_stack(ctx[t], s.list, COUNT, images[t]));
		ok(optla_ctx_provenance(ctx[t], &provenance[t]));
	}
	for (int k = 0; k < COUNT; k++) {
		optla_image *one;
		ok(optla_image_load(ctx[0], s.list[k], &one));
		ck_assert(one->data[0] == (float)k);
		for (int t = 0; t < 3; t++) {
			const optla_image *m = images[t][k];
			ck_assert_ptr_eq(m->ctx, ctx[t]);
			ck_assert(m->width == one->width && m->height == one->height && m->kind == one->kind);
			ck_assert_mem_eq(m->data, one->data, m->width * m->height * m->channels * sizeof(float));
		}
		optla_image_destroy(&one);
	}
	/* The inputs are noted in the order of the list. */
	ck_assert_str_eq(provenance[0], provenance[1]);
	ck_assert_str_eq(provenance[0], provenance[2]);
	const char *at = provenance[0];
	for (int k = 0; k < COUNT; k++) {
		at = strstr(at, s.list[k]);
		ck_assert_ptr_nonnull(at);
		ck_assert_ptr_nonnull(strstr(at, "xxh3-128:"));
	}
	for (int t = 0; t < 3; t++) {
		optla_free(ctx[t], provenance[t]);
		destroy_all(images[t]);
		optla_ctx_destroy(&ctx[t]);
	}
	remove_stack(&s);
}
END_TEST

static void cut(const char *path, size_t to) { ck_assert_int_eq(truncate(path, (off_t)to), 0); }

START_TEST(the_first_failure_by_index_is_told_once)
{
	const int threads[] = {1, 2, 7};
	stack s;
	make_stack(&s);
	cut(s.paths[9], 100); /* fails early in the file */
	cut(s.paths[6], 400); /* fails later in the work, but is first in the list */
	unlink(s.paths[14]);  /* fails at once */
	optla_image *images[COUNT];
	char first[1024] = "";
	for (int t = 0; t < 3; t++)
		for (int again = 0; again < 20; again++) {
			error_store e = {0};
			optla_ctx *ctx = test_ctx(&e, threads[t]);
			for (int k = 0; k < COUNT; k++) images[k] = (optla_image *)&s;
			status_is(optla_image_load_stack(ctx, s.list, COUNT, images), OPTLA_ERR_INPUT);
			ck_assert_int_eq(e.count, 1);
			ck_assert_ptr_nonnull(strstr(e.text, s.list[6]));
			ck_assert_str_eq(optla_ctx_last_error(ctx), e.text);
			if (!*first) snprintf(first, sizeof first, "%s", e.text);
			ck_assert_str_eq(first, e.text);
			for (int k = 0; k < COUNT; k++) ck_assert_ptr_null(images[k]);
			optla_ctx_destroy(&ctx);
		}
	remove_stack(&s);
}
END_TEST

typedef struct {
	int calls, stop_at;
	uint64_t last;
	bool in_order;
} watcher;

static bool watch(void *user, const optla_progress_event *event)
{
	watcher *w = user;
	w->in_order = w->in_order && event->done == w->last + 1 && COUNT == event->total;
	w->last = event->done;
	return ++w->calls != w->stop_at;
}

START_TEST(progress_counts_and_can_cancel)
{
	stack s;
	make_stack(&s);
	for (int threads = 1; threads < 8; threads += 3)
		for (int stop = 0; stop < 2; stop++) {
			error_store e = {0};
			watcher w = {.in_order = true, .stop_at = stop ? 3 : -1};
			const optla_ctx_desc d = {.size = sizeof d,
			                          .error = error_keep,
			                          .error_user = &e,
			                          .progress = watch,
			                          .progress_user = &w,
			                          .threads = threads};
			optla_ctx *ctx;
			optla_image *images[COUNT];
			ok(optla_ctx_create(&ctx, &d));
			status_is(optla_image_load_stack(ctx, s.list, COUNT, images), stop ? OPTLA_ERR_CANCELLED : OPTLA_OK);
			ck_assert(w.in_order);
			ck_assert_int_eq(w.calls, stop ? 3 : COUNT);
			ck_assert_int_eq(e.count, stop);
			for (int k = 0; k < COUNT; k++) ck_assert(stop == !images[k]);
			destroy_all(images);
			optla_ctx_destroy(&ctx);
		}
	remove_stack(&s);
}
END_TEST

START_TEST(every_allocation_may_fail_on_any_thread)
{
	stack s;
	make_stack(&s);
	for (int threads = 1; threads < 4; threads += 2) {
		alloc_budget b = {.left = -1};
		for (long k = 1; b.left < 0; k++) {
			b = (alloc_budget){.left = k};
			const optla_ctx_desc d = {
			    .size = sizeof d, .alloc = budget_alloc, .free = budget_free, .alloc_user = &b, .threads = threads};
			optla_ctx *ctx;
			optla_image *images[COUNT];
			ok(optla_ctx_create(&ctx, &d));
			const optla_status status = optla_image_load_stack(ctx, s.list, COUNT, images);
			/* Without memory for the note that a file was read, all goes on. */
			ck_assert(OPTLA_OK == status || OPTLA_ERR_NOMEM == status);
			for (int i = 0; i < COUNT; i++) ck_assert(!status == !!images[i]);
			destroy_all(images);
			optla_ctx_destroy(&ctx);
			ck_assert_int_eq(b.live, 0);
		}
	}
	remove_stack(&s);
}
END_TEST

START_TEST(an_empty_stack_is_no_error)
{
	optla_ctx *ctx = test_ctx(NULL, 2);
	ok(optla_image_load_stack(ctx, NULL, 0, NULL));
	optla_ctx_destroy(&ctx);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("image_stack");
	TCase *t = tcase_create("image_stack");
	tcase_set_timeout(t, 120);
	tcase_add_test(t, same_images_for_any_number_of_threads);
	tcase_add_test(t, the_first_failure_by_index_is_told_once);
	tcase_add_test(t, progress_counts_and_can_cancel);
	tcase_add_test(t, every_allocation_may_fail_on_any_thread);
	tcase_add_test(t, an_empty_stack_is_no_error);
	suite_add_tcase(s, t);
	return run_suite(s);
}
