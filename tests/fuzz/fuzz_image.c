/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes of one type of file (FUZZ_TYPE) as an image: a whole one or an error. */
#include "fuzz.h"
#include "io/file_type.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (FUZZ_TYPE != optla_file_type_of_bytes_(data, size)) return 0;
	optla_ctx *ctx = fuzz_ctx();
	optla_image *image;
	if (OPTLA_OK == optla_image_decode(ctx, data, size, "fuzz", &image)) {
		double sum = 0;
		for (size_t k = 0; k < image->width * image->height * image->channels; k++) sum += (double)image->data[k];
		volatile double used = sum;
		(void)used;
	} else if (image || !*optla_ctx_last_error(ctx)) {
		abort();
	}
	optla_image_destroy(&image);
	optla_ctx_destroy(&ctx);
	return 0;
}
