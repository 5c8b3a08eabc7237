/* SPDX-License-Identifier: BSD-3-Clause */
/* Standard error: errors, remarks, progress. */
#include "term.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void optla_term_error(void *user, optla_status code, const char *where, const char *message)
{
	optla_term *term = user;
	if (code == OPTLA_ERR_CANCELLED) return; /* the user knows; main says what became of the work */
	char text[sizeof *term->errors];
	if (term->where)
		snprintf(text, sizeof text, "%s [%s]", message, where);
	else
		snprintf(text, sizeof text, "%s", message);
#pragma omp critical(optla_term)
	{
		bool known = false;
		for (size_t k = 0; k < term->nerrors; k++) known |= !strcmp(term->errors[k], text);
		if (!known && term->nerrors < TERM_ERRORS) memcpy(term->errors[term->nerrors++], text, sizeof text);
	}
}

void optla_term_clear(optla_term *term)
{
	if (!term->drawn) return;
	fputs("\r\033[K", stderr);
	fflush(stderr);
	term->drawn = false;
}

void optla_term_print_errors(optla_term *term)
{
	optla_term_clear(term);
	for (size_t k = 0; k < term->nerrors; k++) fprintf(stderr, "optla: %s\n", term->errors[k]);
	term->nerrors = 0;
}

void optla_term_log(void *user, int level, const char *message)
{
	optla_term *term = user;
	if (level > term->log_level) return;
#pragma omp critical(optla_term)
	{
		optla_term_clear(term);
		fprintf(stderr, "optla: %s%s\n", level == 0 ? "warning: " : "", message);
	}
}

static void duration(double seconds, char *text, size_t bytes)
{
	const long s = lround(seconds);
	if (s < 100)
		snprintf(text, bytes, "%ld s", s);
	else if (s < 6000)
		snprintf(text, bytes, "%ld min %02ld s", s / 60, s % 60);
	else
		snprintf(text, bytes, "%ld h %02ld min", s / 3600, s / 60 % 60);
}

bool optla_term_progress(void *user, const optla_progress_event *event)
{
	enum { BAR = 24 };
	optla_term *term = user;
	if (!term->progress) return true;
	const bool same = !strncmp(term->task, event->task, sizeof term->task - 1);
	/* Ten times a second is smooth; what is done within a quarter of a second needs no line. */
	if (same && (event->elapsed_s - term->drawn_at_s < 0.1 && event->elapsed_s >= term->drawn_at_s)) return true;
	if (event->elapsed_s < 0.25) return true;
	snprintf(term->task, sizeof term->task, "%s", event->task);
	term->drawn_at_s = event->elapsed_s;
	char value[64] = "", left[32] = "";
	if (event->value_name) snprintf(value, sizeof value, "  %s %.3g", event->value_name, event->value);
	if (event->total) {
		const double share = fmin(1, (double)event->done / (double)event->total);
		const int full = (int)(share * BAR);
		if (event->done) duration(event->elapsed_s * (1 / share - 1), left, sizeof left);
		fprintf(stderr, "\r\033[K%s [%.*s%.*s] %llu/%llu%s%s%s", event->task, full, "########################", BAR - full,
		        "........................", (unsigned long long)event->done, (unsigned long long)event->total, value,
		        *left ? "  left: " : "", left);
	} else {
		duration(event->elapsed_s, left, sizeof left);
		fprintf(stderr, "\r\033[K%s %llu%s  %s", event->task, (unsigned long long)event->done, value, left);
	}
	fflush(stderr);
	term->drawn = true;
	return true;
}
