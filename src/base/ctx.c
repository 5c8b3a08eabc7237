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
	*out = ctx;
	return OPTLA_OK;
}

void optla_ctx_destroy(optla_ctx **ctx)
{
	if (!ctx || !*ctx) return;
	optla_ctx *c = *ctx;
	optla_provenance_clear_(c);
	c->desc.free(c->desc.alloc_user, c);
	*ctx = NULL;
}

int optla_ctx_threads(const optla_ctx *ctx) { return ctx ? ctx->desc.threads : 1; }

size_t optla_ctx_memory_limit(const optla_ctx *ctx) { return ctx ? ctx->desc.memory_limit_bytes : 0; }

void optla_ctx_cancel(optla_ctx *ctx)
{
	if (ctx) atomic_store(&ctx->cancelled, true);
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
	memcpy(ctx->last_error, text, sizeof text);
	if (ctx->desc.error) ctx->desc.error(ctx->desc.error_user, code, where, text);
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
	ctx->desc.log(ctx->desc.log_user, level, text);
}

double optla_now_s_(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

optla_status optla_check_cancel_(optla_ctx *ctx)
{
	if (ctx && atomic_load(&ctx->cancelled)) return OPTLA_FAIL(ctx, OPTLA_ERR_CANCELLED, "cancelled by the caller");
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
		if (!ctx->desc.progress(ctx->desc.progress_user, &event)) optla_ctx_cancel(ctx);
	}
	return optla_check_cancel_(ctx);
}

double optla_clamp_(double x, double lo, double hi) { return x < lo ? lo : x > hi ? hi : x; }
