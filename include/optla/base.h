/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file base.h
 * Context, status codes, errors, progress, cancelling, provenance and option tables.
 *
 * Every object of Optla belongs to a context. The context holds the allocator, the handlers of errors, messages and
 * progress, the number of threads and the limit of memory. There is no global state: two contexts don't know of each other.
 */
#ifndef OPTLA_BASE_H
#define OPTLA_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define OPTLA_API __attribute__((visibility("default")))
#else
#define OPTLA_API
#endif

/** What a call answers. Not converging is no error: solvers say in their info why they stopped. */
typedef enum {
	OPTLA_OK = 0,
	OPTLA_ERR_ARG = -1,         /**< an argument or option has a value that isn't allowed */
	OPTLA_ERR_SHAPE = -2,       /**< sizes or scalar types don't fit together */
	OPTLA_ERR_NOMEM = -3,       /**< memory ran out, or the context's limit was met */
	OPTLA_ERR_UNSUPPORTED = -4, /**< this object can't answer that question (no transpose, no such photo) */
	OPTLA_ERR_IO = -5,          /**< reading or writing failed for the machine's reasons (disk full, permission) */
	OPTLA_ERR_DEVICE = -6,      /**< a device failed */
	OPTLA_ERR_CANCELLED = -7,   /**< the caller cancelled; partial results are valid where the docs say so */
	OPTLA_ERR_INPUT = -8        /**< a file is missing or what it says is wrong */
} optla_status;

typedef struct optla_ctx optla_ctx;

/** Receives each error once, on the thread that found it: code, name of the function, and a message with the values. */
typedef void (*optla_error_fn)(void *user, optla_status code, const char *where, const char *message);

/** Receives remarks that aren't errors. level: 0 warning, 1 information, 2 detail. */
typedef void (*optla_log_fn)(void *user, int level, const char *message);

/** State of a long task. total = 0: unknown. value is named by value_name (NULL: none), e.g. "residual". */
typedef struct {
	const char *task;
	uint64_t done, total;
	double elapsed_s, value;
	const char *value_name;
} optla_progress_event;

/** Called from one thread at a time; returning false cancels the task. */
typedef bool (*optla_progress_fn)(void *user, const optla_progress_event *event);

/** How to make a context. Zero or NULL means the default; size must be sizeof(optla_ctx_desc). */
typedef struct {
	size_t size;
	optla_error_fn error; /**< NULL: errors are only returned, and kept for optla_ctx_last_error() */
	void *error_user;
	optla_log_fn log; /**< NULL: silent */
	void *log_user;
	optla_progress_fn progress; /**< NULL: silent */
	void *progress_user;
	void *(*alloc)(void *user, size_t bytes); /**< NULL: malloc; must return memory aligned as malloc does */
	void (*free)(void *user, void *p);        /**< NULL: free; given together with alloc */
	void *alloc_user;
	int threads;               /**< 0: number of processors */
	size_t memory_limit_bytes; /**< largest single array that may be made; 0: three quarters of the machine's memory */
} optla_ctx_desc;

/** @param desc NULL for all defaults. @return OPTLA_ERR_NOMEM, or OPTLA_ERR_ARG when desc->size is not known. */
OPTLA_API optla_status optla_ctx_create(optla_ctx **out, const optla_ctx_desc *desc);
/** Accepts NULL; clears the pointer. All objects made with the context must be gone before. */
OPTLA_API void optla_ctx_destroy(optla_ctx **ctx);
OPTLA_API int optla_ctx_threads(const optla_ctx *ctx);
OPTLA_API size_t optla_ctx_memory_limit(const optla_ctx *ctx);
/** Asks every running task of this context to stop with OPTLA_ERR_CANCELLED. Any thread or a signal handler may call it. */
OPTLA_API void optla_ctx_cancel(optla_ctx *ctx);
/** Text of the last error of this context ("" if none). Valid until the next error; a copy for one-threaded callers. */
OPTLA_API const char *optla_ctx_last_error(const optla_ctx *ctx);
OPTLA_API const char *optla_status_name(optla_status code);
/** "0.1.0" */
OPTLA_API const char *optla_version(void);

/**
 * How the results of this context are being made: written into every output file together with the library's version
 * and the name and hash of each input that was read.
 * @param command e.g. the command line; copied. @param date ISO 8601, or NULL to leave the date out; copied.
 */
OPTLA_API optla_status optla_ctx_set_provenance(optla_ctx *ctx, const char *command, uint64_t seed, const char *date);
/** Text of the provenance, lines of "key: value"; the caller frees it with optla_free(). */
OPTLA_API optla_status optla_ctx_provenance(optla_ctx *ctx, char **text);
/** Returns memory that the library gave away (texts, arrays) to the context's allocator. Accepts NULL. */
OPTLA_API void optla_free(optla_ctx *ctx, void *p);

/* ---- option tables ------------------------------------------------------------------------------------------------ */

typedef enum {
	OPTLA_OPTION_INT,    /**< int */
	OPTLA_OPTION_U64,    /**< uint64_t */
	OPTLA_OPTION_DOUBLE, /**< double */
	OPTLA_OPTION_BOOL,   /**< bool */
	OPTLA_OPTION_ENUM,   /**< an int-sized enum, values 0, 1, ... named by choices "first|second" */
	OPTLA_OPTION_STRING  /**< const char *, borrowed; NULL: not given */
} optla_option_type;

/** One field of an option struct. Drives validation, the command's flags, --help, man pages and bindings. */
typedef struct {
	const char *name; /**< as on the command line, without dashes */
	size_t offset;
	optla_option_type type;
	const char *unit;    /**< "" if none; for strings what it is: "FILE" */
	double lower, upper; /**< allowed range of numbers, both ends included */
	const char *choices; /**< enums only */
	const char *help;    /**< one sentence */
} optla_option;

typedef struct {
	const char *name; /**< of the struct */
	size_t struct_size;
	const void *defaults;
	const optla_option *options;
	size_t count;
} optla_option_table;

/** Checks each field of opts against the table: range, NaN, known enum value. The message names field, value and range. */
OPTLA_API optla_status optla_options_check(optla_ctx *ctx, const optla_option_table *table, const void *opts);
/** Sets the field called name from text. Strings are borrowed. @return OPTLA_ERR_ARG with a message that says what is allowed. */
OPTLA_API optla_status optla_option_set(optla_ctx *ctx, const optla_option_table *table, void *opts, const char *name,
                                        const char *text);
/** Writes the value of one field as text into buffer (always terminated). Returns buffer. */
OPTLA_API const char *optla_option_format(const optla_option *option, const void *opts, char *buffer, size_t bytes);

#ifdef __cplusplus
}
#endif
#endif
