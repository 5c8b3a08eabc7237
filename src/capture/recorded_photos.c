/* SPDX-License-Identifier: BSD-3-Clause */
/* Photos of a recording: found, read, cropped, masked, made linear. */
#include "capture/recorded_impl.h"
#include "io/whole_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { BATCH = 32 }; /* photos held in memory at once */

char *optla_recorded_path_(const optla_recorded *r, const char *name) { return optla_path_join_(r->ctx, r->root, name); }

static optla_status fail_missing(const optla_recorded *r, const size_t *missing, size_t count)
{
	char list[1024] = "";
	size_t used = 0;
	for (size_t k = 0; k < count && k < 5; k++) {
		const int n = snprintf(list + used, sizeof list - used, "%s%s", k ? ", " : "", r->m->photos[missing[k]].file);
		used = optla_min_(used + (size_t)(n > 0 ? n : 0), sizeof list - 1);
	}
	return optla_yaml_fail_(r->m->doc, r->m->photos[missing[0]].node,
	                        "%zu of %zu photos are missing in '%s': %s%s (another folder can be given by --data DIR)", count,
	                        r->m->nphotos, r->root, list, count > 5 ? ", ..." : "");
}

optla_status optla_recorded_check_files_(const optla_recorded *r)
{
	size_t missing[5], count = 0;
	for (size_t k = 0; k < r->m->nphotos; k++) {
		char *path = optla_recorded_path_(r, r->m->photos[k].file);
		if (!path) return OPTLA_ERR_NOMEM;
		if (!optla_path_exists_(path)) {
			if (count < 5) missing[count] = k;
			count++;
		}
		optla_free(r->ctx, path);
	}
	return count ? fail_missing(r, missing, count) : OPTLA_OK;
}

static optla_status check_size(const optla_recorded *r, const optla_image *image, const char *name, optla_yaml_node node)
{
	if (!r->width) return OPTLA_OK; /* the first photo says what the size is */
	const size_t channels = image->channels >= 3 ? 3 : 1;
	if (image->kind != r->kind || image->white_dn != r->file_white_dn)
		return optla_yaml_fail_(r->m->doc, node, "'%s' holds %s samples (white %g), the first photo %s (white %g)", name,
		                        optla_image_kind_name(image->kind), image->white_dn, optla_image_kind_name(r->kind),
		                        r->file_white_dn);
	if (image->width == r->width && image->height == r->height && channels == r->channels) return OPTLA_OK;
	return optla_yaml_fail_(r->m->doc, node, "'%s' is %zu x %zu with %zu channel%s, the first photo is %zu x %zu with %zu", name,
	                        image->width, image->height, channels, channels == 1 ? "" : "s", r->width, r->height, r->channels);
}

optla_status optla_recorded_load_(const optla_recorded *r, const char *const *names, const optla_yaml_node *nodes, size_t count,
                                  optla_image **images)
{
	char **paths = optla_calloc_(r->ctx, count, sizeof *paths);
	optla_status status = paths ? OPTLA_OK : OPTLA_ERR_NOMEM;
	for (size_t k = 0; k < count; k++) images[k] = NULL;
	for (size_t k = 0; k < count && !status; k++) {
		paths[k] = optla_recorded_path_(r, names[k]);
		if (!paths[k]) status = OPTLA_ERR_NOMEM;
	}
	if (!status) status = optla_image_load_stack(r->ctx, (const char *const *)paths, count, images);
	for (size_t k = 0; k < count && !status; k++) status = check_size(r, images[k], names[k], nodes[k]);
	for (size_t k = 0; k < count; k++) {
		if (status) optla_image_destroy(&images[k]);
		if (paths) optla_free(r->ctx, paths[k]);
	}
	optla_free(r->ctx, (void *)paths);
	return status;
}

double optla_recorded_dn_(const optla_recorded *r, const optla_image *image, size_t pixel, size_t c)
{
	const size_t x = r->crop[0] + pixel % r->crop[2], y = r->crop[1] + pixel / r->crop[2];
	const double v = (double)image->data[(y * image->width + x) * image->channels + c];
	return image->kind == OPTLA_IMAGE_DISPLAY ? 255 * v : v; /* eight-bit files come as 0..1 */
}

static double table_linear(const optla_response *t, double dn)
{
	size_t hi = 1;
	while (hi + 1 < t->count && dn > t->dn[hi]) hi++;
	const double share = (dn - t->dn[hi - 1]) / (t->dn[hi] - t->dn[hi - 1]); /* the end pieces go on beyond the table */
	return t->linear[hi - 1] + share * (t->linear[hi] - t->linear[hi - 1]);
}

double optla_recorded_linear_(const optla_recorded *r, double dn)
{
	const double v = dn / r->scale_dn;
	switch (r->m->response.kind) {
	case OPTLA_RESPONSE_LINEAR: return v;
	case OPTLA_RESPONSE_GAMMA: return pow(fmax(0, v), r->m->response.gamma);
	case OPTLA_RESPONSE_SRGB: return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4); /* IEC 61966-2-1 */
	case OPTLA_RESPONSE_TABLE: return table_linear(&r->m->response, dn);
	}
	return v;
}

typedef struct {
	size_t saturated;
	size_t bad; /* index of the pixel of the first sample that is no number, SIZE_MAX: none */
} photo_report;

/* One photo into its column of y. */
static photo_report take_photo(optla_recorded *r, size_t k, const optla_image *image)
{
	const optla_rig_info *info = &r->rig->info;
	const double scale = r->m->exposure_s / r->m->photos[k].exposure_s / (r->white_linear - r->black_linear);
	float *column = r->y + k * info->npixels * info->channels;
	photo_report report = {0, SIZE_MAX};
	for (size_t c = 0; c < info->channels; c++)
		for (size_t m = 0; m < info->npixels; m++) {
			const double dn = optla_recorded_dn_(r, image, info->pixel[m], c);
			const double black = r->dark ? r->dark[c * r->crop[2] * r->crop[3] + info->pixel[m]] : r->black_linear;
			if (!isfinite(dn) && report.bad == SIZE_MAX) report.bad = info->pixel[m];
			report.saturated += dn >= r->saturation_dn;
			column[c * info->npixels + m] = (float)((optla_recorded_linear_(r, dn) - black) * scale);
		}
	return report;
}

static optla_status judge_photo(optla_recorded *r, size_t k, const photo_report *report)
{
	if (report->saturated > r->worst_count) {
		r->worst_count = report->saturated;
		r->worst_photo = k;
	}
	r->saturated += report->saturated;
	if (report->bad == SIZE_MAX) return OPTLA_OK;
	return optla_yaml_fail_(r->m->doc, r->m->photos[k].node, "photo '%s' holds NaN or infinity at pixel (%zu, %zu)",
	                        r->m->photos[k].file, r->crop[0] + report->bad % r->crop[2], r->crop[1] + report->bad / r->crop[2]);
}

static optla_status judge_saturated(const optla_recorded *r)
{
	if (!r->saturated) return OPTLA_OK;
	const optla_rig_info *info = &r->rig->info;
	const optla_manifest_photo *worst = &r->m->photos[r->worst_photo];
	const size_t all = info->npixels * info->channels * r->m->nphotos;
	if (r->m->saturated_is_error)
		return optla_yaml_fail_(
		    r->m->doc, worst->node,
		    "%zu of %zu samples are saturated (%g or more); worst photo '%s' with %zu ('saturated: warn' goes on)", r->saturated,
		    all, r->saturation_dn, worst->file, r->worst_count);
	optla_log_(r->ctx, 0, "rig '%s': %zu of %zu samples are saturated (%g or more); worst photo '%s' with %zu", info->name,
	           r->saturated, all, r->saturation_dn, worst->file, r->worst_count);
	return OPTLA_OK;
}

static optla_status take_batch(optla_recorded *r, size_t first, size_t count)
{
	const char *names[BATCH];
	optla_yaml_node nodes[BATCH];
	optla_image *images[BATCH];
	photo_report report[BATCH];
	for (size_t k = 0; k < count; k++) {
		names[k] = r->m->photos[first + k].file;
		nodes[k] = r->m->photos[first + k].node;
	}
	OPTLA_TRY(optla_recorded_load_(r, names, nodes, count, images));
	const int threads = optla_ctx_threads(r->ctx);
#pragma omp parallel for num_threads(threads) schedule(static)
	for (size_t k = 0; k < count; k++) report[k] = take_photo(r, first + k, images[k]);
	optla_status status = OPTLA_OK;
	for (size_t k = 0; k < count; k++) {
		if (!status) status = judge_photo(r, first + k, &report[k]);
		optla_image_destroy(&images[k]);
	}
	return status;
}

optla_status optla_recorded_photos_(optla_recorded *r)
{
	const optla_rig_info *info = &r->rig->info;
	const double started_s = optla_now_s_();
	size_t samples;
	if (!optla_size_mul_(info->npixels * info->channels, r->m->nphotos, &samples)) samples = SIZE_MAX;
	r->y = optla_array_(r->ctx, samples, sizeof *r->y);
	if (!r->y) return OPTLA_ERR_NOMEM;
	for (size_t k = 0; k < r->m->nphotos; k += BATCH) {
		OPTLA_TRY(take_batch(r, k, optla_min_(BATCH, r->m->nphotos - k)));
		OPTLA_TRY(optla_report_(r->ctx, "photos", optla_min_(k + BATCH, r->m->nphotos), r->m->nphotos, started_s, NULL, 0));
	}
	r->rig->info.nphotos = r->m->nphotos;
	r->rig->info.saturated_samples = r->saturated;
	return judge_saturated(r);
}
