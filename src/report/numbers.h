/* SPDX-License-Identifier: BSD-3-Clause */
/* The numbers of a figure: ours, the thesis', the range that is allowed and why; numbers.json. */
#ifndef OPTLA_NUMBERS_H
#define OPTLA_NUMBERS_H

#include "base/base_impl.h"

#include <math.h>

/* What a number is expected to be. thesis NaN: the thesis gives none. low, high: ends included; infinite: no bound on that side. */
typedef struct {
	const char *unit; /* "" if none */
	double thesis, low, high;
	const char *why; /* where the range comes from */
} optla_expect;

static inline optla_expect optla_expect_range_(double low, double high, const char *unit, const char *why)
{
	return (optla_expect){unit, NAN, low, high, why};
}
static inline optla_expect optla_expect_at_most_(double high, const char *unit, const char *why)
{
	return (optla_expect){unit, NAN, -INFINITY, high, why};
}
static inline optla_expect optla_expect_at_least_(double low, const char *unit, const char *why)
{
	return (optla_expect){unit, NAN, low, INFINITY, why};
}
/* Reported without a bound (it must still be a number). */
static inline optla_expect optla_expect_nothing_(const char *unit, const char *why)
{
	return (optla_expect){unit, NAN, -INFINITY, INFINITY, why};
}

typedef struct {
	char *name, *unit, *why;
	double value, thesis, low, high;
} optla_number;

typedef struct {
	optla_ctx *ctx;
	optla_number *item;
	size_t count, room;
} optla_numbers;

/* A finite value within its range; NaN and infinities are never ok. */
bool optla_number_ok_(const optla_number *number);
/* All texts are copied. */
optla_status optla_numbers_add_(optla_numbers *numbers, const char *name, double value, optla_expect expect);
size_t optla_numbers_failed_(const optla_numbers *numbers);
void optla_numbers_free_(optla_numbers *numbers);

/**
 * {"id", "seed", "wall_s", "numbers": [{"name", "value", "unit", "thesis", "low", "high", "ok"}]}, written whole. null stands for what
 * isn't a number: no thesis value, no bound, a value that came out as NaN (which is then not ok).
 */
optla_status optla_numbers_save_(const optla_numbers *numbers, const char *path, const char *id, uint64_t seed, double wall_s);
/* How many numbers a numbers.json holds and how many of them aren't ok; OPTLA_ERR_INPUT if the file isn't one. */
optla_status optla_numbers_summary_(optla_ctx *ctx, const char *path, size_t *count, size_t *failed);

#endif
