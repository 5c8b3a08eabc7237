/* SPDX-License-Identifier: BSD-3-Clause */
/* What the fuzz targets share: a context that allows little memory, so that a file's claims can't get much. */
#ifndef OPTLA_FUZZ_H
#define OPTLA_FUZZ_H

#include "optla/base.h"

#include <stdint.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static inline optla_ctx *fuzz_ctx(void)
{
	const optla_ctx_desc d = {.size = sizeof d, .threads = 1, .memory_limit_bytes = (size_t)64 << 20};
	optla_ctx *ctx;
	if (OPTLA_OK != optla_ctx_create(&ctx, &d)) abort();
	return ctx;
}

#endif
