/* SPDX-License-Identifier: BSD-3-Clause */
/* Dense kernels on blocks of columns: the same bytes for any number of threads. */
#ifndef OPTLA_DENSE_H
#define OPTLA_DENSE_H

#include "base/base_impl.h"
#include "optla/op.h"

static inline optla_cblock optla_cblock_(const void *data, size_t nrows, size_t ncols, optla_scalar type)
{
	const optla_cblock b = {data, nrows, ncols, nrows, type};
	return b;
}

static inline optla_block optla_block_(void *data, size_t nrows, size_t ncols, optla_scalar type)
{
	const optla_block b = {data, nrows, ncols, nrows, type};
	return b;
}

/* Columns first .. first+count-1 of a block. */
optla_cblock optla_columns_(optla_cblock b, size_t first, size_t count);
optla_block optla_columns_mut_(optla_block b, size_t first, size_t count);

/* y = A x, Aᵀ x or Aᴴ x. Fixed chunks of rows, partial sums added in order of the chunks: independent of threads.
   scratch for partial sums is allocated inside only when A is transposed; OPTLA_ERR_NOMEM. */
optla_status optla_dense_apply_(optla_ctx *ctx, optla_trans trans, optla_cblock a, optla_cblock x, optla_block y);

/* Vectors of a block's scalar type, one column; sums in double in a fixed order. Real types only. */
double optla_dot_(optla_cblock a, size_t i, optla_cblock b, size_t j); /* <a_i, b_j> */
double optla_norm_(optla_cblock a, size_t i);
double optla_norm_fro_(optla_cblock a);     /* all types */
void optla_clear_(optla_block a, size_t i); /* a_i = 0, whatever it held */
void optla_scale_(optla_block a, size_t i, double factor);
void optla_axpy_(double factor, optla_cblock x, size_t i, optla_block y, size_t j); /* y_j += factor x_i */
void optla_copy_column_(optla_cblock x, size_t i, optla_block y, size_t j);         /* converts between real types */
double optla_get_(optla_cblock a, size_t row, size_t column);
void optla_set_(optla_block a, size_t row, size_t column, double value);

/* Small problems through LAPACK, double, column-major. Inputs are not changed. OPTLA_ERR_NOMEM, or OPTLA_ERR_DEVICE if LAPACK fails. */

/* A (m x n) = U diag(s) Vᵀ, thin; k = min(m, n): u m x k, vt k x n; either may be NULL. */
optla_status optla_svd_(optla_ctx *ctx, const double *a, size_t m, size_t n, double *s, double *u, double *vt);
/* Thin QR of A (m x n, m >= n): q m x n, r n x n upper. */
optla_status optla_qr_(optla_ctx *ctx, const double *a, size_t m, size_t n, double *q, double *r);
/* Minimum-norm least squares x = A⁺ b for nrhs columns; singular values below rcond * largest count as zero; *rank may be NULL. */
optla_status optla_lstsq_(optla_ctx *ctx, const double *a, size_t m, size_t n, const double *b, size_t nrhs, double rcond,
                          double *x, size_t *rank);
/* Symmetric eigenproblem, ascending eigenvalues w, vectors in columns of v (n x n). */
optla_status optla_eigh_(optla_ctx *ctx, const double *a, size_t n, double *w, double *v);
/* min ||A x - b||, x >= 0 (m x n): Lawson & Hanson, Solving Least Squares Problems (1974), ch. 23. *residual may be NULL. */
optla_status optla_nnls_(optla_ctx *ctx, const double *a, size_t m, size_t n, const double *b, double *x, double *residual);
/* Solves A X = B for a general square A (LU). OPTLA_ERR_ARG if singular. */
optla_status optla_solve_(optla_ctx *ctx, const double *a, size_t n, const double *b, size_t nrhs, double *x);

#endif
