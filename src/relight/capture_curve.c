/* SPDX-License-Identifier: BSD-3-Clause */
/* Error curves of rival ways to capture T (Fig. 2.9): checks and choice of the method. */
#include "relight/capture_impl.h"

const char *optla_capture_name(optla_capture method)
{
	switch (method) {
	case OPTLA_CAPTURE_SINGLE: return "single lights";
	case OPTLA_CAPTURE_DCT: return "DCT";
	case OPTLA_CAPTURE_HADAMARD: return "Hadamard";
	case OPTLA_CAPTURE_NYSTROEM: return "Nystroem";
	case OPTLA_CAPTURE_KERNEL_NYSTROEM: return "kernel Nystroem";
	case OPTLA_CAPTURE_SVD: return "SVD";
	}
	return "unknown";
}

void optla_capture_note_cost_(const optla_capture_job *job, size_t i, optla_op *op, optla_op_cost before)
{
	const optla_op_cost now = optla_op_cost_so_far(op);
	job->points[i].photos = now.photos - before.photos;
	job->points[i].exposure_s = now.exposure_s - before.exposure_s;
}

static optla_status check_operator(optla_ctx *ctx, optla_op *op, optla_op *truth)
{
	OPTLA_CHECK(ctx, optla_op_nrows(op) == optla_op_nrows(truth) && optla_op_ncols(op) == optla_op_ncols(truth), OPTLA_ERR_SHAPE,
	            "operator '%s' is %zu x %zu, the truth '%s' %zu x %zu", optla_op_name(op), optla_op_nrows(op), optla_op_ncols(op),
	            optla_op_name(truth), optla_op_nrows(truth), optla_op_ncols(truth));
	OPTLA_CHECK(ctx, optla_op_type(op) <= OPTLA_F64, OPTLA_ERR_UNSUPPORTED, "operator '%s' is complex: this needs a real one",
	            optla_op_name(op));
	return OPTLA_OK;
}

static optla_status check_ks(const optla_capture_job *job, optla_capture method)
{
	const optla_capture_options *o = job->options;
	const bool needs_rows = method >= OPTLA_CAPTURE_NYSTROEM;
	const size_t most = needs_rows ? optla_min_(job->nrows, job->ncols) : job->ncols;
	OPTLA_CHECK(job->ctx, o->nks > 0 && o->ks, OPTLA_ERR_ARG, "no k to report: options.nks is 0");
	for (size_t i = 0; i < o->nks; i++) {
		OPTLA_CHECK(job->ctx, o->ks[i] >= 1 && o->ks[i] <= most, OPTLA_ERR_ARG, "k = %zu: %s on this T allows 1 to %zu", o->ks[i],
		            optla_capture_name(method), most);
		OPTLA_CHECK(job->ctx, 0 == i || o->ks[i] > o->ks[i - 1], OPTLA_ERR_ARG, "the list of k must ascend, but %zu follows %zu",
		            o->ks[i], o->ks[i - 1]);
	}
	return OPTLA_OK;
}

static optla_status check_job(const optla_capture_job *job, optla_capture method)
{
	OPTLA_CHECK(job->ctx, job->options && job->options->size == sizeof *job->options, OPTLA_ERR_ARG,
	            "options.size isn't %zu: not a struct of this version", sizeof *job->options);
	OPTLA_CHECK(job->ctx, (size_t)method <= OPTLA_CAPTURE_SVD, OPTLA_ERR_ARG, "capture method %d doesn't exist", (int)method);
	OPTLA_TRY(check_operator(job->ctx, job->photos, job->truth));
	OPTLA_TRY(check_operator(job->ctx, job->single, job->truth));
	OPTLA_CHECK(job->ctx,
	            !job->grid_width == !job->grid_height && job->grid_width <= job->ncols &&
	                (!job->grid_width || (job->ncols % job->grid_width == 0 && job->ncols / job->grid_width == job->grid_height)),
	            OPTLA_ERR_SHAPE, "a grid of %zu x %zu doesn't hold %zu lights", job->grid_width, job->grid_height, job->ncols);
	return check_ks(job, method);
}

optla_status optla_capture_curve(optla_capture method, optla_op *photos, optla_op *single, optla_op *truth, size_t grid_width,
                                 size_t grid_height, const optla_capture_options *options, optla_capture_point *points)
{
	const optla_capture_job job = {.ctx = optla_op_ctx(truth),
	                               .photos = photos ? photos : truth,
	                               .single = single   ? single
	                                         : photos ? photos
	                                                  : truth,
	                               .truth = truth,
	                               .nrows = optla_op_nrows(truth),
	                               .ncols = optla_op_ncols(truth),
	                               .grid_width = grid_width,
	                               .grid_height = grid_height,
	                               .options = options,
	                               .points = points};
	OPTLA_TRY(check_job(&job, method));
	for (size_t i = 0; i < options->nks; i++) points[i] = (optla_capture_point){.k = options->ks[i], .exponent = 1};
	switch (method) {
	case OPTLA_CAPTURE_NYSTROEM: return optla_capture_nystroem_(&job, false);
	case OPTLA_CAPTURE_KERNEL_NYSTROEM: return optla_capture_nystroem_(&job, true);
	case OPTLA_CAPTURE_SVD: return optla_capture_svd_(&job);
	default: return optla_capture_brute_(&job, method);
	}
}
