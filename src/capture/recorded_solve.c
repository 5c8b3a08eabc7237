/* SPDX-License-Identifier: BSD-3-Clause */
/* T = Y X⁺: from photos under known illuminations to the light transport of single lights (Eq. 1.1). */
#include "capture/recorded_impl.h"
#include "io/number_text.h"
#include "math/dense.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static optla_status check_illumination(const optla_recorded *r, size_t photo, const double *x)
{
	const optla_manifest_photo *p = &r->m->photos[photo];
	double sum = 0;
	for (size_t n = 0; n < r->m->nlights; n++) {
		if (!(x[n] >= 0 && isfinite(x[n])))
			return optla_yaml_fail_(r->m->doc, p->node,
			                        "the illumination of photo '%s' is %g at light %zu: allowed is a number >= 0", p->file, x[n],
			                        n);
		sum += x[n];
	}
	if (!(sum > 0)) return optla_yaml_fail_(r->m->doc, p->node, "the illumination of photo '%s' is all zero", p->file);
	return OPTLA_OK;
}

static bool ends_with(const char *text, const char *end)
{
	const size_t n = strlen(text), m = strlen(end);
	return n >= m && !strcmp(text + n - m, end);
}

/* Numbers of a .npy, .npz or .h5 array, or of a text file. */
static optla_status read_numbers(optla_ctx *ctx, const char *path, double **values, size_t *count)
{
	*values = NULL;
	if (!ends_with(path, ".npy") && !ends_with(path, ".npz") && !ends_with(path, ".h5"))
		return optla_read_numbers_(ctx, path, values, count, NULL);
	optla_array *array;
	OPTLA_TRY(optla_array_load(ctx, path, &array));
	*count = 1;
	for (size_t k = 0; k < array->ndim; k++) *count *= array->dims[k];
	*values = optla_array_(ctx, *count, sizeof **values);
	const optla_cblock all = {array->data, *count, 1, *count, array->type};
	const bool real = array->type == OPTLA_F32 || array->type == OPTLA_F64;
	for (size_t k = 0; *values && k < *count; k++) (*values)[k] = real ? optla_get_(all, k, 0) : NAN;
	optla_array_destroy(&array);
	return *values ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

static optla_status read_illumination(const optla_recorded *r, size_t photo, double *x)
{
	const optla_manifest_photo *p = &r->m->photos[photo];
	char *path = optla_recorded_path_(r, p->illumination_file);
	if (!path) return OPTLA_ERR_NOMEM;
	double *values;
	size_t count;
	optla_status status = read_numbers(r->ctx, path, &values, &count);
	if (!status && count != r->m->nlights)
		status = optla_yaml_fail_(r->m->doc, p->node, "'%s' holds %zu numbers, there are %zu lights", p->illumination_file, count,
		                          r->m->nlights);
	if (!status) memcpy(x, values, count * sizeof *x);
	optla_free(r->ctx, values);
	optla_free(r->ctx, path);
	return status;
}

/* X, nlights x nphotos. */
static optla_status fill_illuminations(const optla_recorded *r, double *x)
{
	const size_t n = r->m->nlights;
	for (size_t k = 0; k < r->m->nphotos; k++) {
		const optla_manifest_photo *p = &r->m->photos[k];
		double *column = x + k * n;
		if (p->light != SIZE_MAX)
			column[p->light] = 1;
		else if (p->illumination)
			memcpy(column, p->illumination, n * sizeof *column);
		else
			OPTLA_TRY(read_illumination(r, k, column));
		OPTLA_TRY(check_illumination(r, k, column));
	}
	return OPTLA_OK;
}

/* "0, 3, 7" of the lights whose row of X is zero; returns their number. */
static size_t list_unlit(const optla_recorded *r, const double *x, char *list, size_t bytes)
{
	size_t unlit = 0, used = 0;
	for (size_t n = 0; n < r->m->nlights; n++) {
		bool lit = false;
		for (size_t k = 0; k < r->m->nphotos && !lit; k++) lit = x[k * r->m->nlights + n] > 0;
		if (lit) continue;
		if (unlit++ < 5) {
			const int w = snprintf(list + used, bytes - used, "%s%zu", unlit > 1 ? ", " : "", n);
			used = optla_min_(used + (size_t)(w > 0 ? w : 0), bytes - 1);
		}
	}
	if (unlit > 5) snprintf(list + used, bytes - used, ", ...");
	return unlit;
}

static optla_status fail_rank(const optla_recorded *r, const double *x, size_t rank)
{
	char list[160] = "";
	const size_t unlit = list_unlit(r, x, list, sizeof list);
	if (unlit)
		return optla_yaml_fail_(r->m->doc, r->m->photos_node, "%zu of %zu lights are lit in no photo: %s", unlit, r->m->nlights,
		                        list);
	return optla_yaml_fail_(
	    r->m->doc, r->m->photos_node,
	    "the illuminations of the %zu photos span %zu dimensions, the %zu lights need %zu: some lights are never "
	    "lit apart from others",
	    r->m->nphotos, rank, r->m->nlights, r->m->nlights);
}

/* X⁺, nphotos x nlights: (Xᵀ)⁺ = lstsq(Xᵀ, I), transposed. */
static optla_status invert_illuminations(const optla_recorded *r, const double *x, double *inverse)
{
	const size_t n = r->m->nlights, k = r->m->nphotos;
	double *xt = optla_calloc_(r->ctx, k, n * sizeof *xt), *eye = optla_calloc_(r->ctx, k, k * sizeof *eye),
	       *solution = optla_calloc_(r->ctx, n, k * sizeof *solution);
	optla_status status = xt && eye && solution ? OPTLA_OK : OPTLA_ERR_NOMEM;
	size_t rank = 0;
	for (size_t j = 0; j < k && !status; j++) {
		eye[j * k + j] = 1;
		for (size_t i = 0; i < n; i++) xt[i * k + j] = x[j * n + i];
	}
	/* 1e-10 of the largest singular value: photos of 8 to 16 bits can't tell such lights apart */
	if (!status) status = optla_lstsq_(r->ctx, xt, k, n, eye, k, 1e-10, solution, &rank);
	if (!status && rank < n) status = fail_rank(r, x, rank);
	for (size_t j = 0; j < k && !status; j++)
		for (size_t i = 0; i < n; i++) inverse[i * k + j] = solution[j * n + i];
	optla_free(r->ctx, solution);
	optla_free(r->ctx, eye);
	optla_free(r->ctx, xt);
	return status;
}

/* T = Y X⁺ row by row, sums in double. */
static void multiply(const optla_recorded *r, const double *inverse)
{
	const optla_transport *t = r->rig->transport;
	const size_t rows = t->t.nrows, k = r->m->nphotos;
	float *out = t->t.data;
	const int threads = optla_ctx_threads(r->ctx);
#pragma omp parallel for num_threads(threads) schedule(static)
	for (size_t m = 0; m < rows; m++)
		for (size_t n = 0; n < t->nlights; n++) {
			double sum = 0;
			for (size_t j = 0; j < k; j++) sum += (double)r->y[j * rows + m] * inverse[n * k + j];
			out[n * rows + m] = (float)sum;
		}
}

/* One light for each photo and one photo for each light: columns are the photos. */
static bool place_single(const optla_recorded *r)
{
	const size_t n = r->m->nlights, rows = r->rig->transport->t.nrows;
	if (r->m->nphotos != n) return false;
	for (size_t k = 0; k < n; k++)
		if (r->m->photos[k].light == SIZE_MAX) return false;
	float *out = r->rig->transport->t.data;
	for (size_t k = 0; k < n; k++) memcpy(out + r->m->photos[k].light * rows, r->y + k * rows, rows * sizeof *out);
	return true;
}

static optla_status solve_mixed(const optla_recorded *r)
{
	const size_t n = r->m->nlights, k = r->m->nphotos;
	double *x = optla_calloc_(r->ctx, k, n * sizeof *x), *inverse = optla_calloc_(r->ctx, k, n * sizeof *inverse);
	optla_status status = x && inverse ? fill_illuminations(r, x) : OPTLA_ERR_NOMEM;
	char list[160] = "";
	if (!status && list_unlit(r, x, list, sizeof list)) status = fail_rank(r, x, 0);
	if (!status) status = invert_illuminations(r, x, inverse);
	if (!status) multiply(r, inverse);
	optla_free(r->ctx, inverse);
	optla_free(r->ctx, x);
	return status;
}

optla_status optla_recorded_solve_(optla_recorded *r)
{
	optla_rig_info *info = &r->rig->info;
	info->nlights = r->m->nlights;
	OPTLA_TRY(optla_transport_create_(r->ctx, info->npixels, info->channels, info->nlights, OPTLA_F32, &r->rig->transport));
	return place_single(r) ? OPTLA_OK : solve_mixed(r);
}
