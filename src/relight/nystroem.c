/* SPDX-License-Identifier: BSD-3-Clause */
/* Nystroem capture: k random columns C, k random rows R and where they cross, W, give T_k = C W⁺ R; with a kernel the same is done
 * to T^γ, element by element: T_k = (C^γ (W^γ)⁺ R^γ)^(1/γ).  J. Wang, Y. Dong, X. Tong, Z. Lin, B. Guo, Kernel Nyström method for
 * light transport, SIGGRAPH 2009.
 *
 * Columns are photos under single lights, rows are photos from the projector's side under single camera pixels. Two things are left
 * open by the method: the exponent and the tolerance of the pseudo-inverse. Both are chosen as the best against the truth, on a
 * random sample of its rows, so the curve shows the method at its best; a capture that doesn't know the truth does worse. */
#include "relight/nystroem.h"
#include "math/dense.h"
#include "relight/basis.h"
#include "relight/truth_walk.h"

enum { SAMPLE_ENTRIES = 4096 * 96, SAMPLE_ROWS_LEAST = 256, STREAM_COLUMNS = 1, STREAM_ROWS = 2, STREAM_SAMPLE = 3 };

/* ---- capture ---- */

static optla_status take(optla_nystroem *y, optla_trans trans, size_t which, optla_block to)
{
	optla_op *op = y->job->single;
	const size_t n = OPTLA_FORWARD == trans ? y->job->ncols : y->job->nrows;
	const optla_block unit = optla_block_(y->unit.data, n, 1, y->unit.type);
	optla_set_(unit, which, 0, 1);
	const optla_status s = optla_op_apply(op, trans, optla_block_const(unit), to);
	optla_set_(unit, which, 0, 0);
	return s;
}

static optla_status take_all(optla_nystroem *y)
{
	const optla_capture_options *o = y->job->options;
	const optla_op_cost before = optla_op_cost_so_far(y->job->single);
	const double started_s = optla_now_s_();
	for (size_t i = 0, k = 0; i < o->nks; i++) {
		for (; k < o->ks[i]; k++) {
			OPTLA_TRY(take(y, OPTLA_FORWARD, y->column[k], optla_columns_mut_(y->c, k, 1)));
			OPTLA_TRY(take(y, OPTLA_TRANSPOSE, y->row[k], optla_columns_mut_(y->r, k, 1)));
		}
		optla_capture_note_cost_(y->job, i, y->job->single, before);
		OPTLA_TRY(optla_report_(y->job->ctx, "Nystroem capture", k, y->most, started_s, NULL, 0));
	}
	return OPTLA_OK;
}

static optla_status take_sample(optla_nystroem *y)
{
	optla_walk w;
	OPTLA_TRY(optla_walk_begin_(y->job->truth, &w));
	optla_status s;
	for (bool more = true;;) {
		optla_cblock columns;
		const size_t first = w.first;
		s = optla_walk_next_(&w, &columns, &more);
		if (OPTLA_OK != s || !more) break;
		for (size_t j = 0; j < columns.ncols; j++)
			for (size_t i = 0; i < y->nsample; i++)
				y->sample[(first + j) * y->nsample + i] = optla_get_(columns, y->sample_row[i], j);
	}
	optla_walk_end_(&w);
	return s;
}

static optla_status curve(optla_nystroem *y)
{
	const optla_capture_options *o = y->job->options;
	OPTLA_TRY(take_all(y));
	OPTLA_TRY(take_sample(y));
	const double started_s = optla_now_s_();
	for (size_t i = 0; i < o->nks; i++) {
		optla_nystroem_choice best;
		OPTLA_TRY(optla_nystroem_search_(y, o->ks[i], &best));
		OPTLA_TRY(optla_nystroem_error_(y, o->ks[i], best, &y->job->points[i].relative_error));
		y->job->points[i].exponent = best.exponent;
		OPTLA_TRY(optla_report_(y->job->ctx, "Nystroem errors", i + 1, o->nks, started_s, "relative error", best.error));
	}
	return OPTLA_OK;
}

/* ---- memory ---- */

static void release(optla_nystroem *y)
{
	void *all[] = {y->column, y->row, y->sample_row, y->c.data, y->r.data, y->unit.data, y->sample, y->cg,
	               y->w,      y->u,   y->s,          y->vt,     y->rg,     y->middle,    y->mixed,  y->chunk_sum};
	for (size_t i = 0; i < sizeof all / sizeof *all; i++) optla_free(y->job->ctx, all[i]);
}

static void *block_of(optla_ctx *ctx, size_t nrows, size_t ncols, optla_scalar type, optla_block *out)
{
	*out = optla_block_(optla_calloc_(ctx, nrows * ncols, optla_scalar_bytes(type)), nrows, ncols, type);
	return out->data;
}

static optla_status reserve(optla_nystroem *y)
{
	const optla_capture_job *job = y->job;
	optla_ctx *ctx = job->ctx;
	const optla_scalar type = optla_op_type(job->single);
	const size_t k = y->most, nchunks = (job->nrows + OPTLA_NYSTROEM_CHUNK - 1) / OPTLA_NYSTROEM_CHUNK, bytes = sizeof(double);
	const size_t cg_rows = optla_max_(y->nsample, OPTLA_NYSTROEM_CHUNK * (size_t)optla_ctx_threads(ctx));
	OPTLA_TRY(optla_permutation_(ctx, job->options->seed, STREAM_COLUMNS, job->ncols, &y->column));
	OPTLA_TRY(optla_permutation_(ctx, job->options->seed, STREAM_ROWS, job->nrows, &y->row));
	OPTLA_TRY(optla_permutation_(ctx, job->options->seed, STREAM_SAMPLE, job->nrows, &y->sample_row));
	const bool ok = block_of(ctx, job->nrows, k, type, &y->c) && block_of(ctx, job->ncols, k, type, &y->r) &&
	                block_of(ctx, optla_max_(job->nrows, job->ncols), 1, type, &y->unit) &&
	                (y->sample = optla_array_(ctx, y->nsample * job->ncols, bytes)) &&
	                (y->cg = optla_array_(ctx, cg_rows * k, bytes)) && (y->w = optla_array_(ctx, k * k, bytes)) &&
	                (y->u = optla_array_(ctx, k * k, bytes)) && (y->s = optla_array_(ctx, k, bytes)) &&
	                (y->vt = optla_array_(ctx, k * k, bytes)) && (y->rg = optla_array_(ctx, k * job->ncols, bytes)) &&
	                (y->middle = optla_array_(ctx, k * job->ncols, bytes)) && (y->mixed = optla_array_(ctx, k * k, bytes)) &&
	                (y->chunk_sum = optla_array_(ctx, 2 * nchunks, bytes));
	return ok ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

/* The search costs time by entries of T, not by rows: a wide T needs fewer rows for as good a choice. */
static size_t sample_rows(size_t ncols) { return optla_max_(SAMPLE_ENTRIES / ncols, SAMPLE_ROWS_LEAST); }

optla_status optla_capture_nystroem_(const optla_capture_job *job, bool kernel)
{
	optla_nystroem y = {.job = job,
	                    .kernel = kernel,
	                    .most = job->options->ks[job->options->nks - 1],
	                    .nsample = optla_min_(sample_rows(job->ncols), job->nrows)};
	OPTLA_CHECK(job->ctx, !(optla_op_flags(job->single) & OPTLA_OP_NO_TRANSPOSE), OPTLA_ERR_UNSUPPORTED,
	            "the Nystroem methods need rows of T, and '%s' has no transpose", optla_op_name(job->single));
	optla_status s = reserve(&y);
	if (OPTLA_OK == s) s = curve(&y);
	release(&y);
	return s;
}
