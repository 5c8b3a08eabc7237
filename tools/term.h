/* SPDX-License-Identifier: BSD-3-Clause */
/* What appears on standard error: errors, remarks, and on a terminal a line of progress with the time left. */
#ifndef OPTLA_TERM_H
#define OPTLA_TERM_H

#include "optla/base.h"

enum { TERM_ERRORS = 4 };

typedef struct {
	bool progress; /* draw the line: standard error is a terminal and nobody asked for quiet */
	int log_level; /* remarks up to this level are printed */
	bool where;    /* name the function that found an error */
	bool drawn;
	char task[64];
	double drawn_at_s, task_began_s;
	/* Errors are kept until the run has failed: a reader that tries one format after the other recovers from some. */
	char errors[TERM_ERRORS][1200];
	size_t nerrors;
} optla_term;

void optla_term_error(void *user, optla_status code, const char *where, const char *message);
void optla_term_log(void *user, int level, const char *message);
bool optla_term_progress(void *user, const optla_progress_event *event);
/* Removes the progress line. */
void optla_term_clear(optla_term *term);
void optla_term_print_errors(optla_term *term);

#endif
