/* SPDX-License-Identifier: BSD-3-Clause */
/* One axis of a chart: range, ticks and their labels. */
#ifndef OPTLA_AXIS_H
#define OPTLA_AXIS_H

#include <stdbool.h>
#include <stddef.h>

enum { OPTLA_AXIS_TICKS = 64 };

typedef struct {
	double value;
	bool major;                   /* labelled, with a stronger grid line */
	char label[24], exponent[12]; /* exponent: drawn raised behind the label; "" if none */
} optla_tick;

typedef struct {
	bool logarithmic;
	double low, high; /* shown range, low < high */
	size_t count;
	optla_tick tick[OPTLA_AXIS_TICKS];
} optla_axis;

/* Can this value be shown? Finite (up to 1e300, so that ranges can be reckoned with), and positive on a logarithmic axis. */
bool optla_axis_shows_(bool logarithmic, double value);
/* Range and ticks for data from low to high (low > high: no data at all). */
void optla_axis_init_(optla_axis *axis, bool logarithmic, double low, double high, size_t wanted_ticks);
/* 0 at the low end, 1 at the high end. */
double optla_axis_position_(const optla_axis *axis, double value);

#endif
