/* SPDX-License-Identifier: BSD-3-Clause */
/* Ticks: steps of 1, 2, 5 times a power of ten on a linear axis (P. Heckbert, Nice numbers for graph labels, Graphics Gems, 1990);
   decades on a logarithmic one, with 2 and 5 between them when there are few, and 2 to 9 unlabelled. */
#include "report/axis.h"

#include <math.h>
#include <stdio.h>

bool optla_axis_shows_(bool logarithmic, double value) { return fabs(value) <= 1e300 && (!logarithmic || value >= 1e-300); }

double optla_axis_position_(const optla_axis *axis, double value)
{
	if (axis->logarithmic) return (log(value) - log(axis->low)) / (log(axis->high) - log(axis->low));
	return (value - axis->low) / (axis->high - axis->low);
}

static optla_tick *add_tick(optla_axis *axis, double value, bool major)
{
	if (axis->count == OPTLA_AXIS_TICKS) return NULL;
	optla_tick *t = &axis->tick[axis->count++];
	*t = (optla_tick){.value = value, .major = major};
	return t;
}

static bool inside(const optla_axis *axis, double value)
{
	const double x = optla_axis_position_(axis, value);
	return x > -1e-9 && x < 1 + 1e-9;
}

static void label_linear(optla_tick *t, double value, double step, int power)
{
	/* As many decimals as the step needs; numbers of 1e5 and more, or steps below 1e-4, share a power of ten. */
	const double scaled = value / pow(10, power);
	int decimals = 0;
	while (decimals < 9 && fabs(step / pow(10, power - decimals) - round(step / pow(10, power - decimals))) > 1e-6) decimals++;
	snprintf(t->label, sizeof t->label, "%.*f", decimals, scaled == 0 ? 0.0 : scaled);
	if (power && value != 0) {
		snprintf(t->label, sizeof t->label, "%.*f·10", decimals, scaled);
		snprintf(t->exponent, sizeof t->exponent, "%d", power);
	}
}

static void linear_ticks(optla_axis *axis, size_t wanted)
{
	const double rough = (axis->high - axis->low) / (double)(wanted ? wanted : 1);
	const double base = pow(10, floor(log10(rough))), ratio = rough / base;
	const double step = base * (ratio < 1.5 ? 1 : ratio < 3.5 ? 2 : ratio < 7.5 ? 5 : 10);
	const double largest = fmax(fabs(axis->low), fabs(axis->high));
	const int power = largest >= 1e5 || step < 1e-4 ? (int)floor(log10(largest)) : 0;
	for (double k = ceil(axis->low / step - 1e-9); k * step <= axis->high + 1e-9 * step; k++) {
		optla_tick *t = add_tick(axis, k * step, true);
		if (!t) return;
		label_linear(t, t->value, step, power);
	}
}

static void label_decade(optla_tick *t, int digit, int exponent)
{
	if (exponent >= -3 && exponent <= 4) {
		snprintf(t->label, sizeof t->label, "%.*f", exponent < 0 ? -exponent : 0, digit * pow(10, exponent));
		return;
	}
	if (digit == 1)
		snprintf(t->label, sizeof t->label, "10");
	else
		snprintf(t->label, sizeof t->label, "%d·10", digit);
	snprintf(t->exponent, sizeof t->exponent, "%d", exponent);
}

static void log_ticks(optla_axis *axis, size_t wanted)
{
	const double decades = log10(axis->high) - log10(axis->low);
	const int first = (int)floor(log10(axis->low) - 1e-9), last = (int)ceil(log10(axis->high) + 1e-9);
	const int every = decades > (double)wanted ? (int)ceil(decades / (double)wanted) : 1;
	for (int e = first; e <= last; e++)
		for (int digit = 1; digit <= 9; digit++) {
			const double value = digit * pow(10, e);
			const bool two_five = decades < 2.2 && (digit == 2 || digit == 5);
			const bool all = decades < 0.8 && digit != 7 && digit != 9;
			const bool major = (digit == 1 && e % every == 0) || two_five || all;
			if (!inside(axis, value) || (!major && decades > 6)) continue;
			optla_tick *t = add_tick(axis, value, major);
			if (!t) return;
			if (major) label_decade(t, digit, e);
		}
}

void optla_axis_init_(optla_axis *axis, bool logarithmic, double low, double high, size_t wanted)
{
	*axis = (optla_axis){.logarithmic = logarithmic};
	if (!(low <= high)) low = logarithmic ? 0.1 : 0, high = 1;
	if (logarithmic) {
		if (high / low < 1.05) low /= 1.5, high *= 1.5;
		const double pad = pow(high, 0.04) / pow(low, 0.04); /* (high/low)^0.04 without overflow */
		axis->low = fmax(low / pad, 1e-307);
		axis->high = fmin(high * pad, 1e307);
		/* less than half a decade has too few round numbers: linear steps, logarithmic spacing */
		if (log10(axis->high) - log10(axis->low) < 0.45)
			linear_ticks(axis, wanted);
		else
			log_ticks(axis, wanted);
		return;
	}
	if (high - low <= 1e-12 * fmax(fabs(low), fabs(high))) {
		const double room = low == 0 ? 1 : 0.1 * fabs(low);
		low -= room;
		high += room;
	}
	if (low > 0 && low < 0.3 * high) low = 0;
	const double pad = 0.04 * (high - low);
	axis->low = low == 0 ? 0 : low - pad;
	axis->high = high + pad;
	linear_ticks(axis, wanted);
}
