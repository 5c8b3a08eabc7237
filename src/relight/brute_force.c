/* SPDX-License-Identifier: BSD-3-Clause */
/* Brute force: photos under the first k patterns of a fixed basis, T_k = T projected on their span. */
#include "math/dense.h"
#include "relight/basis.h"
#include "relight/capture_impl.h"

/* Photos of patterns first .. first + count - 1. */
static optla_status take(optla_op *op, const optla_basis *basis, optla_block patterns, size_t first, size_t count,
                         optla_block photos)
{
	for (size_t j = first; j < first + count; j++)
		for (size_t n = 0; n < basis->nlights; n++) optla_set_(patterns, n, j, basis->pattern[j * basis->nlights + n]);
	return optla_op_apply(op, OPTLA_FORWARD, optla_block_const(optla_columns_mut_(patterns, first, count)),
	                      optla_columns_mut_(photos, first, count));
}

static optla_status take_all(const optla_capture_job *job, optla_op *op, const optla_basis *basis, optla_block patterns,
                             optla_block photos)
{
	const optla_op_cost before = optla_op_cost_so_far(op);
	const double started_s = optla_now_s_();
	for (size_t i = 0, done = 0; i < job->options->nks; i++) {
		const size_t k = job->options->ks[i];
		OPTLA_TRY(take(op, basis, patterns, done, k - done, photos));
		optla_capture_note_cost_(job, i, op, before);
		done = k;
		OPTLA_TRY(optla_report_(job->ctx, "brute-force capture", done, basis->count, started_s, NULL, 0));
	}
	return OPTLA_OK;
}

/* D <- D R^-1, column by column: T projected on the span of the patterns is then D Q^T. */
static void orthogonalise(const optla_basis *basis, optla_block d)
{
	for (size_t j = 0; j < basis->count; j++) {
		for (size_t k = 0; basis->r && k < j; k++) optla_axpy_(-basis->r[j * basis->count + k], optla_block_const(d), k, d, j);
		optla_scale_(d, j, 1 / (basis->r ? basis->r[j * basis->count + j] : basis->scale[j]));
	}
}

static optla_status curve(const optla_capture_job *job, optla_op *op, const optla_basis *basis, optla_block patterns,
                          optla_block photos, double *errors)
{
	OPTLA_TRY(take_all(job, op, basis, patterns, photos));
	orthogonalise(basis, photos);
	OPTLA_TRY(optla_relative_errors(optla_block_const(photos), optla_cblock_(basis->q, basis->nlights, basis->count, OPTLA_F64),
	                                job->truth, errors));
	for (size_t i = 0; i < job->options->nks; i++) job->points[i].relative_error = errors[job->options->ks[i] - 1];
	return OPTLA_OK;
}

optla_status optla_capture_brute_(const optla_capture_job *job, optla_capture method)
{
	optla_op *op = OPTLA_CAPTURE_SINGLE == method ? job->single : job->photos;
	const optla_scalar type = optla_op_type(op);
	const size_t count = job->options->ks[job->options->nks - 1], bytes = optla_scalar_bytes(type);
	optla_basis basis;
	OPTLA_TRY(
	    optla_basis_create_(job->ctx, method, job->ncols, job->grid_width, job->grid_height, count, job->options->seed, &basis));
	void *patterns = optla_array_(job->ctx, job->ncols * count, bytes), *photos = NULL;
	double *errors = NULL;
	if (patterns) photos = optla_array_(job->ctx, job->nrows * count, bytes);
	if (photos) errors = optla_array_(job->ctx, count, sizeof *errors);
	const optla_status s = !errors ? OPTLA_ERR_NOMEM
	                               : curve(job, op, &basis, optla_block_(patterns, job->ncols, count, type),
	                                       optla_block_(photos, job->nrows, count, type), errors);
	optla_free(job->ctx, errors);
	optla_free(job->ctx, photos);
	optla_free(job->ctx, patterns);
	optla_basis_free_(&basis);
	return s;
}
