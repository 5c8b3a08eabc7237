/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes of one type of file (FUZZ_TYPE) as an array: a whole one or an error. */
#include "fuzz.h"
#include "io/file_type.h"

#include <string.h>

static void try_member(optla_ctx *ctx, const uint8_t *data, size_t size, const char *member)
{
	optla_array *a;
	if (OPTLA_OK != optla_array_decode(ctx, data, size, "fuzz", member, &a)) {
		if (a || !*optla_ctx_last_error(ctx)) abort();
		return;
	}
	size_t bytes = optla_scalar_bytes(a->type);
	for (size_t k = 0; k < a->ndim; k++) bytes *= a->dims[k];
	/* Every byte that the shape promises is there: the sanitizers look at reads and at uses of what was never set. */
	unsigned sum = 0;
	for (size_t k = 0; k < bytes; k++) sum += ((unsigned char *)a->data)[k];
	volatile unsigned used = sum;
	(void)used;
	optla_array_destroy(&a);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (FUZZ_TYPE != optla_file_type_of_bytes_(data, size)) return 0;
	optla_ctx *ctx = fuzz_ctx();
	try_member(ctx, data, size, NULL);
	if (OPTLA_FILE_NPY != FUZZ_TYPE) try_member(ctx, data, size, "photos");
	optla_ctx_destroy(&ctx);
	return 0;
}
