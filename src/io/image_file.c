/* SPDX-License-Identifier: BSD-3-Clause */
/* Loading and saving images: the format from the content when reading, from the ending of the name when writing. */
#include "io/file_type.h"
#include "io/image_codec.h"
#include "io/whole_file.h"

#include <string.h>
#include <strings.h>

static const char *const readable = "PNG, TIFF, OpenEXR, PFM, NPY or camera RAW";

optla_status optla_image_decode(optla_ctx *ctx, const void *bytes, size_t count, const char *name, optla_image **out)
{
	*out = NULL;
	const optla_source source = {.ctx = ctx, .name = name, .data = bytes, .count = count};
	OPTLA_CHECK(ctx, count, OPTLA_ERR_INPUT, "%s: the file is empty", name);
	switch (optla_file_type_of_bytes_(bytes, count)) {
	case OPTLA_FILE_PNG: return optla_png_decode_(&source, out);
	case OPTLA_FILE_EXR: return optla_exr_decode_(&source, out);
	case OPTLA_FILE_PFM: return optla_pfm_decode_(&source, out);
	case OPTLA_FILE_TIFF: return optla_tiff_decode_(&source, out);
	case OPTLA_FILE_RAW: return optla_raw_decode_(&source, out);
	case OPTLA_FILE_NPY: return optla_npy_image_decode_(&source, out);
	case OPTLA_FILE_NPZ:
	case OPTLA_FILE_HDF5:
	case OPTLA_FILE_YAML:
	case OPTLA_FILE_UNKNOWN: break;
	}
	return OPTLA_FAIL(ctx, OPTLA_ERR_INPUT, "%s is not an image that can be read: %s", name, readable);
}

optla_status optla_image_load(optla_ctx *ctx, const char *path, optla_image **out)
{
	*out = NULL;
	void *bytes = NULL;
	size_t count = 0;
	OPTLA_TRY(optla_read_file_(ctx, path, &bytes, &count));
	const optla_status status = optla_image_decode(ctx, bytes, count, path, out);
	optla_free(ctx, bytes);
	return status;
}

/* ---- stacks ---- */

typedef struct {
	optla_ctx **children; /* one per file: errors and inputs are collected in the order of the files */
	optla_status *states;
	size_t done, first_failed;
	bool cancelled; /* told already */
} stack_job;

static void load_one(optla_ctx *ctx, stack_job *job, size_t k, const char *path, optla_image **out)
{
	optla_image *image = NULL;
	job->states[k] = optla_image_load(job->children[k], path, &image);
	if (image) image->ctx = ctx;
	*out = image;
}

/* Items behind a failure are skipped, those before it are not: the first failure by index is always found. */
static void load_all(optla_ctx *ctx, stack_job *job, const char *const *paths, size_t count, optla_image **out)
{
	const double started_s = optla_now_s_();
#pragma omp parallel for num_threads(optla_ctx_threads(ctx)) schedule(dynamic)
	for (size_t k = 0; k < count; k++) {
		optla_ctx_lock_(ctx);
		const bool skip = job->cancelled || k > job->first_failed;
		optla_ctx_unlock_(ctx);
		if (skip) continue;
		load_one(ctx, job, k, paths[k], &out[k]);
		optla_ctx_lock_(ctx);
		if (OPTLA_OK != job->states[k]) job->first_failed = optla_min_(job->first_failed, k);
		if (!job->cancelled)
			job->cancelled = OPTLA_OK != optla_report_(ctx, "load photos", ++job->done, count, started_s, NULL, 0);
		optla_ctx_unlock_(ctx);
	}
}

static optla_status make_children(optla_ctx *ctx, stack_job *job, size_t count)
{
	for (size_t k = 0; k < count; k++)
		if (!(job->children[k] = optla_ctx_fork_(ctx))) return OPTLA_ERR_NOMEM;
	return OPTLA_OK;
}

optla_status optla_image_load_stack(optla_ctx *ctx, const char *const *paths, size_t count, optla_image **out)
{
	for (size_t k = 0; k < count; k++) out[k] = NULL;
	stack_job job = {.first_failed = count};
	optla_status status = OPTLA_ERR_NOMEM;
	job.children = optla_calloc_(ctx, count, sizeof *job.children);
	job.states = job.children ? optla_calloc_(ctx, count, sizeof *job.states) : NULL;
	if (job.states) status = make_children(ctx, &job, count);
	if (OPTLA_OK == status) {
		load_all(ctx, &job, paths, count, out);
		if (job.cancelled)
			status = OPTLA_ERR_CANCELLED;
		else if (job.first_failed < count)
			status = job.states[job.first_failed];
	}
	for (size_t k = 0; job.children && k < count; k++) optla_ctx_join_(&job.children[k], k == job.first_failed && !job.cancelled);
	for (size_t k = 0; OPTLA_OK != status && k < count; k++) optla_image_destroy(&out[k]);
	optla_free(ctx, job.children);
	optla_free(ctx, job.states);
	return status;
}

/* ---- writing ---- */

typedef struct {
	const char *ending;
	optla_file_type type;
} ending_type;

static const ending_type endings[] = {{".png", OPTLA_FILE_PNG}, {".tif", OPTLA_FILE_TIFF}, {".tiff", OPTLA_FILE_TIFF},
                                      {".exr", OPTLA_FILE_EXR}, {".pfm", OPTLA_FILE_PFM},  {".npy", OPTLA_FILE_NPY}};

static optla_file_type type_by_ending(const char *path)
{
	const char *dot = strrchr(path, '.');
	for (size_t k = 0; dot && k < sizeof endings / sizeof *endings; k++)
		if (!strcasecmp(dot, endings[k].ending)) return endings[k].type;
	return OPTLA_FILE_UNKNOWN;
}

static optla_status encode(const optla_image *image, optla_file_type type, const char *provenance, optla_memory_file *file)
{
	switch (type) {
	case OPTLA_FILE_PNG: return optla_png_encode_(image, provenance, file);
	case OPTLA_FILE_EXR: return optla_exr_encode_(image, provenance, file);
	case OPTLA_FILE_PFM: return optla_pfm_encode_(image, file);
	case OPTLA_FILE_TIFF: return optla_tiff_encode_(image, provenance, file);
	case OPTLA_FILE_NPY: return optla_npy_image_encode_(image, file);
	default: return OPTLA_FAIL(image->ctx, OPTLA_ERR_UNSUPPORTED, "%s: no writer for this format", file->name);
	}
}

optla_status optla_image_save(const optla_image *image, const char *path)
{
	optla_ctx *ctx = image->ctx;
	const optla_file_type type = type_by_ending(path);
	OPTLA_CHECK(ctx, OPTLA_FILE_UNKNOWN != type, OPTLA_ERR_ARG,
	            "%s: the ending says no image format; .png, .tif, .exr, .pfm and .npy can be written", path);
	optla_memory_file file = {.ctx = ctx, .name = path};
	char *provenance = NULL;
	OPTLA_TRY(optla_ctx_provenance(ctx, &provenance));
	optla_status status = encode(image, type, provenance, &file);
	if (OPTLA_OK == status) status = optla_write_file_(ctx, path, file.data, file.count);
	optla_free(ctx, provenance);
	optla_memory_file_free_(&file);
	return status;
}
