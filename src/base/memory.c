/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory through the context's allocator, with checked sizes. */
#include "ctx_impl.h"

#include <string.h>

bool optla_size_mul_(size_t a, size_t b, size_t *product)
{
	if (b && a > SIZE_MAX / b) return false;
	*product = a * b;
	return true;
}

void *optla_alloc_quiet_(optla_ctx *ctx, size_t bytes)
{
	optla_ctx_lock_(ctx);
	void *p = ctx->desc.alloc(ctx->desc.alloc_user, bytes ? bytes : 1);
	optla_ctx_unlock_(ctx);
	return p;
}

void *optla_alloc_(optla_ctx *ctx, size_t bytes)
{
	if (bytes > ctx->desc.memory_limit_bytes) {
		optla_fail_(ctx, OPTLA_ERR_NOMEM, __func__, "an array of %.3g GiB is over the limit of %.3g GiB", (double)bytes / 0x1p30,
		            (double)ctx->desc.memory_limit_bytes / 0x1p30);
		return NULL;
	}
	void *p = optla_alloc_quiet_(ctx, bytes);
	if (!p) optla_fail_(ctx, OPTLA_ERR_NOMEM, __func__, "no memory for %zu bytes", bytes);
	return p;
}

void *optla_array_(optla_ctx *ctx, size_t count, size_t size)
{
	size_t bytes;
	if (!optla_size_mul_(count, size, &bytes)) {
		optla_fail_(ctx, OPTLA_ERR_NOMEM, __func__, "an array of %zu x %zu bytes does not fit in memory", count, size);
		return NULL;
	}
	return optla_alloc_(ctx, bytes);
}

void *optla_calloc_(optla_ctx *ctx, size_t count, size_t size)
{
	void *p = optla_array_(ctx, count, size);
	if (p) memset(p, 0, count * size);
	return p;
}

char *optla_strdup_(optla_ctx *ctx, const char *text)
{
	const size_t n = strlen(text) + 1;
	char *copy = optla_alloc_(ctx, n);
	if (copy) memcpy(copy, text, n);
	return copy;
}

char *optla_format_(optla_ctx *ctx, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	const int n = vsnprintf(NULL, 0, format, args);
	va_end(args);
	char *text = n < 0 ? NULL : optla_alloc_(ctx, (size_t)n + 1);
	if (!text) return NULL;
	va_start(args, format);
	vsnprintf(text, (size_t)n + 1, format, args);
	va_end(args);
	return text;
}

optla_status optla_grow_(optla_ctx *ctx, void **p, size_t old_count, size_t new_count, size_t size)
{
	void *q = optla_array_(ctx, new_count, size);
	if (!q) return OPTLA_ERR_NOMEM;
	if (*p) memcpy(q, *p, optla_min_(old_count, new_count) * size);
	optla_free(ctx, *p);
	*p = q;
	return OPTLA_OK;
}

void optla_free(optla_ctx *ctx, void *p)
{
	if (!p) return;
	optla_ctx_lock_(ctx);
	ctx->desc.free(ctx->desc.alloc_user, p);
	optla_ctx_unlock_(ctx);
}
