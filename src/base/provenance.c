/* SPDX-License-Identifier: BSD-3-Clause */
/* How a result was made: command, version, seed, date, and the inputs with their hashes (XXH3, 128 bits). */
#include "ctx_impl.h"
#include "version.h"

#include <string.h>
#include <xxhash.h>

void optla_provenance_clear_(optla_ctx *ctx)
{
	optla_free(ctx, ctx->command);
	optla_free(ctx, ctx->date);
	for (size_t k = 0; k < ctx->ninputs; k++) optla_free(ctx, ctx->inputs[k].path);
	optla_free(ctx, ctx->inputs);
	ctx->command = ctx->date = NULL;
	ctx->inputs = NULL;
	ctx->ninputs = 0;
}

optla_status optla_ctx_set_provenance(optla_ctx *ctx, const char *command, uint64_t seed, const char *date)
{
	char *c = command ? optla_strdup_(ctx, command) : NULL, *d = date ? optla_strdup_(ctx, date) : NULL;
	if ((command && !c) || (date && !d)) {
		optla_free(ctx, c);
		optla_free(ctx, d);
		return OPTLA_ERR_NOMEM;
	}
	optla_free(ctx, ctx->command);
	optla_free(ctx, ctx->date);
	ctx->command = c;
	ctx->date = d;
	ctx->seed = seed;
	return OPTLA_OK;
}

/* Files over this size are named without a hash: reading them twice would double the time of the whole job. */
enum { HASH_LIMIT_MIB = 256 };

static void hash_text(XXH128_hash_t h, char hash[64])
{
	snprintf(hash, 64, "xxh3-128:%016llx%016llx", (unsigned long long)h.high64, (unsigned long long)h.low64);
}

static void hash_file(const char *path, char hash[64])
{
	memcpy(hash, "-", 2);
	FILE *f = fopen(path, "rb");
	XXH3_state_t *state = f ? XXH3_createState() : NULL;
	if (state) {
		char chunk[1 << 14];
		size_t n, total = 0;
		XXH3_128bits_reset(state);
		while ((n = fread(chunk, 1, sizeof chunk, f)) > 0 && total <= (size_t)HASH_LIMIT_MIB << 20) {
			XXH3_128bits_update(state, chunk, n);
			total += n;
		}
		if (feof(f) && !ferror(f)) hash_text(XXH3_128bits_digest(state), hash);
	}
	XXH3_freeState(state);
	if (f) fclose(f);
}

static bool is_noted(const optla_ctx *ctx, const char *path)
{
	for (size_t k = 0; k < ctx->ninputs; k++)
		if (!strcmp(ctx->inputs[k].path, path)) return true;
	return false;
}

/* Takes over path; drops it if it is noted already or there is no room. The caller holds the lock. */
static void append(optla_ctx *ctx, char *path, const char hash[64])
{
	optla_input_note *grown = is_noted(ctx, path) ? NULL : optla_alloc_quiet_(ctx, (ctx->ninputs + 1) * sizeof *ctx->inputs);
	if (!grown) {
		optla_free(ctx, path);
		return;
	}
	if (ctx->ninputs) memcpy(grown, ctx->inputs, ctx->ninputs * sizeof *grown);
	optla_free(ctx, ctx->inputs);
	ctx->inputs = grown;
	optla_input_note *note = &grown[ctx->ninputs++];
	note->path = path;
	memcpy(note->hash, hash, sizeof note->hash);
}

static void append_copy(optla_ctx *ctx, const char *path, const char hash[64])
{
	const size_t bytes = strlen(path) + 1;
	optla_ctx_lock_(ctx);
	char *copy = optla_alloc_quiet_(ctx, bytes);
	if (copy) {
		memcpy(copy, path, bytes);
		append(ctx, copy, hash);
	}
	optla_ctx_unlock_(ctx);
}

void optla_note_input_(optla_ctx *ctx, const char *path)
{
	optla_ctx_lock_(ctx);
	const bool known = is_noted(ctx, path);
	optla_ctx_unlock_(ctx);
	if (known) return;
	char hash[64] = {0};
	hash_file(path, hash);
	append_copy(ctx, path, hash);
}

void optla_note_input_bytes_(optla_ctx *ctx, const char *path, const void *bytes, size_t count)
{
	char hash[64] = {0};
	hash_text(XXH3_128bits(bytes, count), hash);
	append_copy(ctx, path, hash);
}

void optla_provenance_move_(optla_ctx *to, optla_ctx *from)
{
	optla_ctx_lock_(to);
	for (size_t k = 0; k < from->ninputs; k++) {
		append(to, from->inputs[k].path, from->inputs[k].hash);
		from->inputs[k].path = NULL;
	}
	from->ninputs = 0;
	optla_ctx_unlock_(to);
}

optla_status optla_ctx_provenance(optla_ctx *ctx, char **text)
{
	*text = NULL;
	size_t bytes = 256 + (ctx->command ? strlen(ctx->command) : 0) + (ctx->date ? strlen(ctx->date) : 0), used;
	for (size_t k = 0; k < ctx->ninputs; k++) bytes += strlen(ctx->inputs[k].path) + 80;
	char *t = optla_alloc_(ctx, bytes);
	if (!t) return OPTLA_ERR_NOMEM;
	used = (size_t)snprintf(t, bytes, "creator: optla %s\nseed: %llu\n", OPTLA_VERSION, (unsigned long long)ctx->seed);
	if (ctx->command) used += (size_t)snprintf(t + used, bytes - used, "command: %s\n", ctx->command);
	if (ctx->date) used += (size_t)snprintf(t + used, bytes - used, "date: %s\n", ctx->date);
	for (size_t k = 0; k < ctx->ninputs; k++)
		used += (size_t)snprintf(t + used, bytes - used, "input: %s %s\n", ctx->inputs[k].path, ctx->inputs[k].hash);
	*text = t;
	return OPTLA_OK;
}
