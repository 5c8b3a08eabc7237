/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as the manifest of a rig: plain data that was checked, or an error. */
#include "fuzz.h"
#include "scene/manifest.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	optla_ctx *ctx = fuzz_ctx();
	optla_manifest *manifest;
	if (OPTLA_OK != optla_manifest_parse_(ctx, data, size, "fuzz.yaml", &manifest)) {
		if (manifest || !*optla_ctx_last_error(ctx)) abort();
	}
	optla_manifest_destroy_(&manifest);
	optla_ctx_destroy(&ctx);
	return 0;
}
