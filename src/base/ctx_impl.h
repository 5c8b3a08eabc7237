/* SPDX-License-Identifier: BSD-3-Clause */
/* The inside of the context, for base/ alone. */
#ifndef OPTLA_CTX_IMPL_H
#define OPTLA_CTX_IMPL_H

#include "base_impl.h"

#include <pthread.h>
#include <stdatomic.h>

typedef struct {
	char *path;
	char hash[64];
} optla_input_note;

struct optla_ctx {
	optla_ctx_desc desc;
	optla_ctx *parent;    /* of a child made by optla_ctx_fork_(); else NULL */
	pthread_mutex_t lock; /* recursive; a child uses its parent's */
	atomic_bool cancelled;
	char last_error[1024];
	optla_status last_code;
	const char *last_where;
	char *command, *date;
	uint64_t seed;
	optla_input_note *inputs;
	size_t ninputs;
};

void optla_provenance_clear_(optla_ctx *ctx);
/* Appends the inputs of from that to doesn't know yet; those are no longer from's. */
void optla_provenance_move_(optla_ctx *to, optla_ctx *from);
/* As optla_alloc_ without a report of failure. */
void *optla_alloc_quiet_(optla_ctx *ctx, size_t bytes);

#endif
