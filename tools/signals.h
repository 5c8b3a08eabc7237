/* SPDX-License-Identifier: BSD-3-Clause */
/* Ctrl-C, broken pipes, file size limits. */
#ifndef OPTLA_SIGNALS_H
#define OPTLA_SIGNALS_H

#include "optla/base.h"

/* The first SIGINT, SIGTERM or SIGHUP cancels ctx, so that files are finished or removed; the second ends the program at once. A closed
   pipe and a file that grows over its limit become errors of the write. */
void optla_signals_install(optla_ctx *ctx);
/* Call before ctx is destroyed. */
void optla_signals_remove(void);

#endif
