/* SPDX-License-Identifier: BSD-3-Clause */
/* Ctrl-C, broken pipes, file size limits. A handler has no argument of ours, hence the one static variable of the command. */
#include "signals.h"

#include <signal.h>
#include <stdatomic.h>
#include <string.h>

static _Atomic(optla_ctx *) target;

static void on_stop(int number)
{
	optla_ctx *ctx = atomic_load(&target);
	/* The default action comes back first: whoever asks twice doesn't want to wait. */
	signal(number, SIG_DFL);
	if (ctx)
		optla_ctx_cancel(ctx);
	else
		raise(number);
}

void optla_signals_install(optla_ctx *ctx)
{
	static const int stops[] = {SIGINT, SIGTERM, SIGHUP};
	atomic_store(&target, ctx);
	struct sigaction action;
	memset(&action, 0, sizeof action);
	action.sa_handler = on_stop;
	action.sa_flags = SA_RESTART; /* a read or write under way goes on; loops look at the flag */
	sigemptyset(&action.sa_mask);
	for (size_t k = 0; k < sizeof stops / sizeof *stops; k++) {
		struct sigaction old;
		/* What a parent made us ignore (nohup, a shell's background job) stays ignored. */
		if (!sigaction(stops[k], NULL, &old) && old.sa_handler != SIG_IGN) sigaction(stops[k], &action, NULL);
	}
	signal(SIGPIPE, SIG_IGN);
	signal(SIGXFSZ, SIG_IGN);
}

void optla_signals_remove(void) { atomic_store(&target, NULL); }
