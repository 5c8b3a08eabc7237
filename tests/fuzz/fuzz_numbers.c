/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a table of numbers in text: finite numbers in whole rows, or an error. */
#include "fuzz.h"
#include "io/number_text.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	optla_ctx *ctx = fuzz_ctx();
	double *values;
	size_t count, columns;
	if (OPTLA_OK == optla_parse_numbers_(ctx, (const char *)data, size, "fuzz.txt", &values, &count, &columns)) {
		if (!count || !columns || count % columns) abort();
		for (size_t k = 0; k < count; k++)
			if (!isfinite(values[k])) abort();
	} else if (values || !*optla_ctx_last_error(ctx)) {
		abort();
	}
	optla_free(ctx, values);
	optla_ctx_destroy(&ctx);
	return 0;
}
