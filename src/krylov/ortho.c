/* SPDX-License-Identifier: BSD-3-Clause */
/* Orthogonalisation against what is there already, twice ("twice is enough": B. Parlett, The Symmetric Eigenvalue Problem,
   1980, section 6.9, after Kahan). */
#include "base/random.h"
#include "run.h"

#include <math.h>

double optla_ortho_dirt_(optla_scalar type) { return 64 * (type == OPTLA_F32 ? 0x1p-23 : 0x1p-52); }

optla_status optla_ortho_(optla_krylov *run, optla_cblock v, size_t n, optla_block w, double *before, double *after, double *h)
{
	const optla_cblock wc = optla_block_const(w);
	*before = optla_norm_(wc, 0);
	for (int pass = 0; pass < 2 && n; pass++) {
		optla_block c = run->coef, t = run->work;
		c.nrows = n;
		t.nrows = v.nrows;
		OPTLA_TRY(optla_dense_apply_(run->ctx, OPTLA_CONJ_TRANSPOSE, optla_columns_(v, 0, n), wc, c));
		OPTLA_TRY(optla_dense_apply_(run->ctx, OPTLA_FORWARD, optla_columns_(v, 0, n), optla_block_const(c), t));
		optla_axpy_(-1, optla_block_const(t), 0, w, 0);
		for (size_t j = 0; h && j < n; j++) h[j] += optla_get_(optla_block_const(c), j, 0);
	}
	*after = optla_norm_(wc, 0);
	return OPTLA_OK;
}

optla_status optla_ortho_fresh_(optla_krylov *run, optla_cblock v, size_t n, optla_block w, bool *found)
{
	const optla_rand rng = {.seed = 0x6f70746c61, .stream_hi = OPTLA_RAND_START};
	*found = false;
	for (uint32_t attempt = 0; attempt < 3 && n < v.nrows; attempt++) {
		for (size_t m = 0; m < v.nrows; m++) optla_set_(w, m, 0, optla_rand_normal_(rng, m, (uint32_t)n, attempt));
		double before, after;
		OPTLA_TRY(optla_ortho_(run, v, n, w, &before, &after, NULL));
		if (after <= 1e-3 * before / sqrt((double)v.nrows)) continue; /* an unlucky draw: next to nothing outside V */
		optla_scale_(w, 0, 1 / after);
		*found = true;
		return OPTLA_OK;
	}
	return OPTLA_OK;
}

optla_status optla_rotate_(const optla_krylov *run, optla_cblock basis, size_t k, const double *c, optla_block out)
{
	optla_ctx *ctx = run->ctx;
	if (!k || !out.ncols) {
		for (size_t j = 0; j < out.ncols; j++) optla_clear_(out, j);
		return OPTLA_OK;
	}
	const optla_block w = optla_block_(optla_array_(ctx, k * out.ncols, optla_scalar_bytes(run->type)), k, out.ncols, run->type);
	if (!w.data) return OPTLA_ERR_NOMEM;
	for (size_t j = 0; j < out.ncols; j++) optla_copy_column_(optla_cblock_(c, k, out.ncols, OPTLA_F64), j, w, j);
	const optla_status status = optla_dense_apply_(ctx, OPTLA_FORWARD, optla_columns_(basis, 0, k), optla_block_const(w), out);
	optla_free(ctx, w.data);
	return status;
}
