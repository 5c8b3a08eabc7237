/* SPDX-License-Identifier: BSD-3-Clause */
/* Products of a dense column-major matrix with a block of columns.
   Where a sum is cut into parts they are cut by the shape alone and added in their order: the result doesn't depend on the number
   of threads. A is read from memory once for all right-hand sides of a block. */
#include "math/dense.h"
#include "math/dense_impl.h"

#include <string.h>

typedef void (*forward_fn)(optla_tile t, void *y, size_t ldy);
typedef void (*dots_fn)(optla_tile t, bool conj, double *sums, size_t ldsums);

static const forward_fn forward_tile[] = {optla_tile_forward_f32_, optla_tile_forward_f64_, optla_tile_forward_c32_,
                                          optla_tile_forward_c64_};
static const dots_fn dots_tile[] = {optla_tile_dots_f32_, optla_tile_dots_f64_, optla_tile_dots_c32_, optla_tile_dots_c64_};

enum {
	/* rows of a tile of y = A x, one right-hand side: 64 KiB of float y stay in level 2 while long stretches of each column stream
	   past (84708 x 1024 on one core of an EPYC 9004: 1024 rows 21 ms, 4096 18, 8192 16.1, 12288 15.5; reading alone 15.9) */
	ROWS_STREAM = 16384,
	ROWS_BLOCK = 512,      /* for several: 8 columns of y in level 1 */
	ROWS_DOTS = 32768,     /* of a transposed product: x in level 2 */
	COLUMNS_TILE = 128,    /* columns of a tile: 256 KiB of A stay in level 2 while all right-hand sides pass */
	COLUMNS_TASK = 64,     /* columns of one task of a transposed product */
	TASKS_WANTED = 64,     /* enough to share out evenly, few enough that partial sums are small */
	BLOCK = 64,            /* right-hand sides of a transposed product per pass: bounds the partial sums */
	SERIAL_BELOW = 1 << 17 /* multiplications that take less time than waking the threads */
};

/* Tasks are handed out as threads come free: memory doesn't serve all threads alike, and each task writes to a place of its own. */

static bool worth_threads(optla_cblock a, size_t nrhs) { return (double)a.nrows * (double)a.ncols * (double)nrhs > SERIAL_BELOW; }

static size_t ceil_div(size_t a, size_t b) { return a / b + (a % b != 0); }

/* Rows of each of n parts, a multiple of unit. */
static size_t even_share(size_t nrows, size_t n, size_t unit) { return optla_max_(ceil_div(ceil_div(nrows, n), unit), 1) * unit; }

static const char *at(const void *data, size_t index, size_t bytes) { return (const char *)data + index * bytes; }

/* Each row of y is a sum of its own, in the order of the columns: the same wherever a tile ends, so every thread gets as many rows. */
static void apply_forward(optla_ctx *ctx, optla_cblock a, optla_cblock x, optla_block y)
{
	const size_t bytes = optla_scalar_bytes(a.type);
	const size_t most = x.ncols >= 8 ? ROWS_BLOCK : ROWS_STREAM, threads = (size_t)optla_ctx_threads(ctx);
	const size_t rows = even_share(a.nrows, optla_max_(ceil_div(a.nrows, most * threads), 1) * threads, 64);
	const size_t ntiles = ceil_div(a.nrows, rows), width = x.ncols >= 8 ? COLUMNS_TILE : a.ncols;
#pragma omp parallel for num_threads(optla_ctx_threads(ctx)) schedule(dynamic) if (worth_threads(a, x.ncols))
	for (size_t k = 0; k < ntiles; k++) {
		const size_t first = k * rows, n = optla_min_(rows, a.nrows - first);
		char *to = (char *)y.data + first * bytes;
		for (size_t r = 0; r < y.ncols; r++) memset(to + r * y.ld * bytes, 0, n * bytes);
		for (size_t j = 0; j < a.ncols; j += width) {
			const optla_tile t = {n,    optla_min_(width, a.ncols - j), x.ncols, at(a.data, first + j * a.ld, bytes),
			                      a.ld, at(x.data, j, bytes),           x.ld};
			forward_tile[a.type](t, to, y.ld);
		}
	}
}

/* Partial sums of all tasks: sums[chunk][right-hand side][column]. */
static void partial_sums(optla_ctx *ctx, bool conj, optla_cblock a, optla_cblock x, size_t chunk, double *sums)
{
	const size_t bytes = optla_scalar_bytes(a.type), parts = a.type >= OPTLA_C32 ? 2 : 1;
	const size_t npanels = ceil_div(a.ncols, COLUMNS_TASK), nchunks = ceil_div(a.nrows, chunk);
	const size_t rows = x.ncols >= 4 ? ROWS_BLOCK : even_share(chunk, ceil_div(chunk, ROWS_DOTS), 1024);
#pragma omp parallel for num_threads(optla_ctx_threads(ctx)) schedule(dynamic) if (worth_threads(a, x.ncols))
	for (size_t k = 0; k < nchunks * npanels; k++) {
		const size_t c = k / npanels, j = k % npanels * COLUMNS_TASK, end = optla_min_(a.nrows, (c + 1) * chunk);
		double *to = sums + parts * (c * x.ncols * a.ncols + j);
		for (size_t i = c * chunk; i < end; i += rows) {
			const optla_tile t = {optla_min_(rows, end - i),
			                      optla_min_(COLUMNS_TASK, a.ncols - j),
			                      x.ncols,
			                      at(a.data, i + j * a.ld, bytes),
			                      a.ld,
			                      at(x.data, i, bytes),
			                      x.ld};
			dots_tile[a.type](t, conj, to, a.ncols);
		}
	}
}

static void store_sums(const double *sums, size_t nchunks, size_t ncols, optla_block y)
{
	const bool single = y.type == OPTLA_F32 || y.type == OPTLA_C32;
	const size_t parts = y.type >= OPTLA_C32 ? 2 : 1, stride = parts * ncols * y.ncols;
	for (size_t r = 0; r < y.ncols; r++)
		for (size_t j = 0; j < parts * ncols; j++) {
			double s = 0;
			for (size_t c = 0; c < nchunks; c++) s += sums[c * stride + r * parts * ncols + j];
			const size_t to = parts * r * y.ld + j;
			if (single)
				((float *)y.data)[to] = (float)s;
			else
				((double *)y.data)[to] = s;
		}
}

static optla_status apply_transposed(optla_ctx *ctx, bool conj, optla_cblock a, optla_cblock x, optla_block y)
{
	const size_t parts = a.type >= OPTLA_C32 ? 2 : 1, npanels = ceil_div(a.ncols, COLUMNS_TASK);
	const size_t wanted = ceil_div(TASKS_WANTED, optla_max_(npanels, 1));
	const size_t chunk = even_share(a.nrows, wanted, a.nrows / wanted >= 8192 ? 1024 : 256);
	const size_t nchunks = ceil_div(a.nrows, chunk), block = optla_min_(BLOCK, x.ncols);
	double *sums = optla_array_(ctx, nchunks * block * a.ncols, parts * sizeof *sums);
	if (!sums) return OPTLA_ERR_NOMEM;
	for (size_t r = 0; r < x.ncols; r += block) {
		const size_t n = optla_min_(block, x.ncols - r);
		memset(sums, 0, nchunks * n * a.ncols * parts * sizeof *sums);
		partial_sums(ctx, conj, a, optla_columns_(x, r, n), chunk, sums);
		store_sums(sums, nchunks, a.ncols, optla_columns_mut_(y, r, n));
	}
	optla_free(ctx, sums);
	return OPTLA_OK;
}

optla_status optla_dense_apply_(optla_ctx *ctx, optla_trans trans, optla_cblock a, optla_cblock x, optla_block y)
{
	if (!x.ncols) return OPTLA_OK;
	if (trans != OPTLA_FORWARD) return apply_transposed(ctx, trans == OPTLA_CONJ_TRANSPOSE, a, x, y);
	apply_forward(ctx, a, x, y);
	return OPTLA_OK;
}
