/* SPDX-License-Identifier: BSD-3-Clause */
/* The inside of the context, for base/ alone. */
#ifndef OPTLA_CTX_IMPL_H
#define OPTLA_CTX_IMPL_H

#include "base_impl.h"

#include <stdatomic.h>

typedef struct {
	char *path;
	char hash[64];
} optla_input_note;

struct optla_ctx {
	optla_ctx_desc desc;
	atomic_bool cancelled;
	char last_error[1024];
	char *command, *date;
	uint64_t seed;
	optla_input_note *inputs;
	size_t ninputs;
};

void optla_provenance_clear_(optla_ctx *ctx);

#endif
