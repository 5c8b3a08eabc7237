/* SPDX-License-Identifier: BSD-3-Clause */
/* The context: creation, errors, messages, cancelling, progress. */
#include "ctx_impl.h"
#include "version.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static void *default_alloc(void *user, size_t bytes)
{
	(void)user;
	return malloc(bytes);
}

static void default_free(void *user, void *p)
{
	(void)user;
	free(p);
}

static int processors(void)
{
	const long n = sysconf(_SC_NPROCESSORS_ONLN);
	return n > 0 ? (int)n : 1;
}

static size_t default_memory_limit(void)
{
	const long pages = sysconf(_SC_PHYS_PAGES), bytes = sysconf(_SC_PAGESIZE);
	return pages > 0 && bytes > 0 ? (size_t)pages / 4 * 3 * (size_t)bytes : SIZE_MAX / 2;
}

static optla_ctx *root(optla_ctx *ctx) { return ctx->parent ? ctx->parent : ctx; }

static bool lock_init(pthread_mutex_t *lock)
{
	pthread_mutexattr_t attributes;
	if (pthread_mutexattr_init(&attributes)) return false;
	const bool done = !pthread_mutexattr_settype(&attributes, PTHREAD_MUTEX_RECURSIVE) && !pthread_mutex_init(lock, &attributes);
	pthread_mutexattr_destroy(&attributes);
	return done;
}

optla_status optla_ctx_create(optla_ctx **out, const optla_ctx_desc *desc)
{
	if (!out) return OPTLA_ERR_ARG;
	*out = NULL;
	optla_ctx_desc d = {.size = sizeof d};
	if (desc) {
		if (desc->size != sizeof d || !desc->alloc != !desc->free || desc->threads < 0) return OPTLA_ERR_ARG;
		d = *desc;
	}
	if (!d.alloc) {
		d.alloc = default_alloc;
		d.free = default_free;
	}
	if (!d.threads) d.threads = processors();
	if (!d.memory_limit_bytes) d.memory_limit_bytes = default_memory_limit();
	optla_ctx *ctx = d.alloc(d.alloc_user, sizeof *ctx);
	if (!ctx) return OPTLA_ERR_NOMEM;
	memset(ctx, 0, sizeof *ctx);
	ctx->desc = d;
	atomic_init(&ctx->cancelled, false);
	if (!lock_init(&ctx->lock)) {
		d.free(d.alloc_user, ctx);
		return OPTLA_ERR_NOMEM;
	}
	*out = ctx;
	return OPTLA_OK;
}

void optla_ctx_destroy(optla_ctx **ctx)
{
	if (!ctx || !*ctx) return;
	optla_ctx *c = *ctx;
	optla_provenance_clear_(c);
	pthread_mutex_destroy(&c->lock);
	c->desc.free(c->desc.alloc_user, c);
	*ctx = NULL;
}

void optla_ctx_lock_(optla_ctx *ctx) { pthread_mutex_lock(&root(ctx)->lock); }

void optla_ctx_unlock_(optla_ctx *ctx) { pthread_mutex_unlock(&root(ctx)->lock); }

optla_ctx *optla_ctx_fork_(optla_ctx *parent)
{
	optla_ctx *child = optla_calloc_(parent, 1, sizeof *child);
	if (!child) return NULL;
	child->desc = parent->desc;
	child->desc.error = NULL;
	child->desc.progress = NULL;
	child->desc.threads = 1;
	child->parent = root(parent);
	atomic_init(&child->cancelled, false);
	return child;
}

void optla_ctx_join_(optla_ctx **child, bool report)
{
	optla_ctx *c = *child;
	if (!c) return;
	optla_provenance_move_(c->parent, c);
	if (report && c->last_code) optla_fail_(c->parent, c->last_code, c->last_where, "%s", c->last_error);
	optla_provenance_clear_(c);
	optla_free(c->parent, c);
	*child = NULL;
}

int optla_ctx_threads(const optla_ctx *ctx) { return ctx ? ctx->desc.threads : 1; }

size_t optla_ctx_memory_limit(const optla_ctx *ctx) { return ctx ? ctx->desc.memory_limit_bytes : 0; }

void optla_ctx_cancel(optla_ctx *ctx)
{
	if (ctx) atomic_store(&root(ctx)->cancelled, true);
}

const char *optla_ctx_last_error(const optla_ctx *ctx) { return ctx ? ctx->last_error : ""; }

const char *optla_version(void) { return OPTLA_VERSION; }

const char *optla_status_name(optla_status code)
{
	switch (code) {
	case OPTLA_OK: return "ok";
	case OPTLA_ERR_ARG: return "argument";
	case OPTLA_ERR_SHAPE: return "shape";
	case OPTLA_ERR_NOMEM: return "memory";
	case OPTLA_ERR_UNSUPPORTED: return "unsupported";
	case OPTLA_ERR_IO: return "input/output";
	case OPTLA_ERR_DEVICE: return "device";
	case OPTLA_ERR_CANCELLED: return "cancelled";
	case OPTLA_ERR_INPUT: return "input";
	}
	return "unknown";
}

optla_status optla_fail_(optla_ctx *ctx, optla_status code, const char *where, const char *format, ...)
{
	if (!ctx) return code;
	char text[sizeof ctx->last_error];
	va_list args;
	va_start(args, format);
	vsnprintf(text, sizeof text, format, args);
	va_end(args);
	optla_ctx_lock_(ctx);
	memcpy(ctx->last_error, text, sizeof text);
	ctx->last_code = code;
	ctx->last_where = where;
	if (ctx->desc.error) ctx->desc.error(ctx->desc.error_user, code, where, text);
	optla_ctx_unlock_(ctx);
	return code;
}

void optla_log_(optla_ctx *ctx, int level, const char *format, ...)
{
	if (!ctx || !ctx->desc.log) return;
	char text[1024];
	va_list args;
	va_start(args, format);
	vsnprintf(text, sizeof text, format, args);
	va_end(args);
	optla_ctx_lock_(ctx);
	ctx->desc.log(ctx->desc.log_user, level, text);
	optla_ctx_unlock_(ctx);
}

double optla_now_s_(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

optla_status optla_check_cancel_(optla_ctx *ctx)
{
	if (ctx && atomic_load(&root(ctx)->cancelled)) return OPTLA_FAIL(ctx, OPTLA_ERR_CANCELLED, "cancelled by the caller");
	return OPTLA_OK;
}

optla_status optla_report_(optla_ctx *ctx, const char *task, uint64_t done, uint64_t total, double started_s,
                           const char *value_name, double value)
{
	if (ctx && ctx->desc.progress) {
		const optla_progress_event event = {.task = task,
		                                    .done = done,
		                                    .total = total,
		                                    .elapsed_s = optla_now_s_() - started_s,
		                                    .value = value,
		                                    .value_name = value_name};
		optla_ctx_lock_(ctx);
		const bool go_on = ctx->desc.progress(ctx->desc.progress_user, &event);
		optla_ctx_unlock_(ctx);
		if (!go_on) optla_ctx_cancel(ctx);
	}
	return optla_check_cancel_(ctx);
}

double optla_clamp_(double x, double lo, double hi) { return x < lo ? lo : x > hi ? hi : x; }
