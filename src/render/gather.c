/* SPDX-License-Identifier: BSD-3-Clause */
/* Sparse lists of (pixel, patch, weight). */
#include "render/corner_impl.h"

#include <string.h>

static optla_status reserve(optla_ctx *ctx, optla_gather *g, size_t capacity)
{
	OPTLA_TRY(optla_grow_(ctx, (void **)&g->pixel, g->count, capacity, sizeof *g->pixel));
	OPTLA_TRY(optla_grow_(ctx, (void **)&g->patch, g->count, capacity, sizeof *g->patch));
	OPTLA_TRY(optla_grow_(ctx, (void **)&g->weight, g->count, capacity, sizeof *g->weight));
	g->capacity = capacity;
	return OPTLA_OK;
}

optla_status optla_gather_add_(optla_ctx *ctx, optla_gather *g, size_t pixel, size_t patch, double weight)
{
	if (g->count == g->capacity) OPTLA_TRY(reserve(ctx, g, g->capacity ? 2 * g->capacity : 4096));
	g->pixel[g->count] = (uint32_t)pixel;
	g->patch[g->count] = (uint32_t)patch;
	g->weight[g->count++] = weight;
	return OPTLA_OK;
}

/* Counting sort by pixel. next: npixels + 1 counters. */
static void sort(const optla_gather *g, size_t npixels, size_t *start, uint32_t *patch, double *weight)
{
	memset(start, 0, (npixels + 2) * sizeof *start);
	size_t *next = start + 1; /* next[p] runs from the start of pixel p to its end, which is where p + 1 starts */
	for (size_t k = 0; k < g->count; k++) next[g->pixel[k] + 1]++;
	for (size_t p = 0; p < npixels; p++) next[p + 1] += next[p];
	for (size_t k = 0; k < g->count; k++) {
		const size_t at = next[g->pixel[k]]++;
		patch[at] = g->patch[k];
		weight[at] = g->weight[k];
	}
}

optla_status optla_gather_finish_(optla_ctx *ctx, optla_gather *g, size_t npixels)
{
	size_t *start = optla_array_(ctx, npixels + 2, sizeof *start);
	uint32_t *patch = optla_array_(ctx, g->count, sizeof *patch);
	double *weight = optla_array_(ctx, g->count, sizeof *weight);
	if (!start || !patch || !weight) {
		optla_free(ctx, weight);
		optla_free(ctx, patch);
		optla_free(ctx, start);
		return OPTLA_ERR_NOMEM;
	}
	sort(g, npixels, start, patch, weight);
	optla_gather_free_(ctx, g);
	*g = (optla_gather){.count = start[npixels], .patch = patch, .weight = weight, .start = start};
	return OPTLA_OK;
}

void optla_gather_free_(optla_ctx *ctx, optla_gather *g)
{
	optla_free(ctx, g->pixel);
	optla_free(ctx, g->patch);
	optla_free(ctx, g->weight);
	optla_free(ctx, g->start);
	memset(g, 0, sizeof *g);
}
