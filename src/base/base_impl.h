/* SPDX-License-Identifier: BSD-3-Clause */
/* What the inside of the library shares: raising errors, memory, progress, random numbers, parallel loops. */
#ifndef OPTLA_BASE_IMPL_H
#define OPTLA_BASE_IMPL_H

#include "optla/base.h"

#include <stdarg.h>
#include <stdio.h>

#if defined(__GNUC__)
#define OPTLA_PRINTF(f, a) __attribute__((format(printf, f, a)))
#else
#define OPTLA_PRINTF(f, a)
#endif

/* ---- errors: found once, reported once, passed up as a code ---- */

optla_status optla_fail_(optla_ctx *ctx, optla_status code, const char *where, const char *format, ...) OPTLA_PRINTF(4, 5);
#define OPTLA_FAIL(ctx, code, ...) optla_fail_((ctx), (code), __func__, __VA_ARGS__)
#define OPTLA_CHECK(ctx, cond, code, ...)                           \
	do {                                                            \
		if (!(cond)) return OPTLA_FAIL((ctx), (code), __VA_ARGS__); \
	} while (0)
#define OPTLA_TRY(expr)                 \
	do {                                \
		const optla_status s_ = (expr); \
		if (OPTLA_OK != s_) return s_;  \
	} while (0)

/* level: 0 warning, 1 information, 2 detail */
void optla_log_(optla_ctx *ctx, int level, const char *format, ...) OPTLA_PRINTF(3, 4);

/* ---- parallel loops ----
   optla_fail_, optla_log_, optla_report_, optla_note_input_ and the allocator may be used from parallel loops: the context's lock makes
   the handlers be called by one thread at a time. Where several items may fail, fork a child for each item, so that what is reported
   and the order of the noted inputs don't depend on which thread was first. */

/* The lock may be taken again by the thread that holds it (a handler may call into the library). */
void optla_ctx_lock_(optla_ctx *ctx);
void optla_ctx_unlock_(optla_ctx *ctx);
/* A context for one item: the parent's allocator, limit, log and cancel flag, one thread; it keeps its error and its inputs to itself.
   Objects made with it must be given to the parent (object->ctx = parent) before the join. NULL on failure, which has been reported. */
optla_ctx *optla_ctx_fork_(optla_ctx *parent);
/* Gives the child's inputs, and with report the child's last error, to its parent; destroys the child. Accepts a NULL child. */
void optla_ctx_join_(optla_ctx **child, bool report);

/* ---- memory ---- */

/* Bytes are uninitialised; NULL only on failure, which has been reported. bytes = 0 gives a valid pointer. */
void *optla_alloc_(optla_ctx *ctx, size_t bytes);
/* count * size bytes, zeroed; overflow of the product and the context's memory limit are errors that have been reported. */
void *optla_calloc_(optla_ctx *ctx, size_t count, size_t size);
/* As optla_calloc_ but not zeroed. */
void *optla_array_(optla_ctx *ctx, size_t count, size_t size);
/* strtod with a decimal point in every locale; *end == text: no number. */
double optla_strtod_(const char *text, char **end);
/* "%.*g" with a decimal point in every locale whose point is one byte. */
void optla_double_text_(double value, int digits, char *text, size_t bytes);
char *optla_strdup_(optla_ctx *ctx, const char *text);
/* Formatted text owned by the caller; NULL on failure. */
char *optla_format_(optla_ctx *ctx, const char *format, ...) OPTLA_PRINTF(2, 3);
/* Grows to new_count elements keeping old_count; on failure *p is unchanged. */
optla_status optla_grow_(optla_ctx *ctx, void **p, size_t old_count, size_t new_count, size_t size);
/* a*b, false when it doesn't fit in size_t */
bool optla_size_mul_(size_t a, size_t b, size_t *product);

/* ---- progress, cancel ---- */

double optla_now_s_(void);
/* OPTLA_ERR_CANCELLED when someone asked to stop; reported as an error once. */
optla_status optla_check_cancel_(optla_ctx *ctx);
/* Tells the progress handler; also looks at the cancel flag. started_s: optla_now_s_() at the task's start. */
optla_status optla_report_(optla_ctx *ctx, const char *task, uint64_t done, uint64_t total, double started_s,
                           const char *value_name, double value);

/* ---- provenance ---- */

/* Remembers that this file was read (its name and hash appear in later outputs). Failure is not an error. */
void optla_note_input_(optla_ctx *ctx, const char *path);
/* The same for a file whose bytes are at hand: it isn't read again. */
void optla_note_input_bytes_(optla_ctx *ctx, const char *path, const void *bytes, size_t count);

/* ---- numbers ---- */

double optla_clamp_(double x, double lo, double hi);
static inline size_t optla_min_(size_t a, size_t b) { return a < b ? a : b; }
static inline size_t optla_max_(size_t a, size_t b) { return a > b ? a : b; }

#endif
