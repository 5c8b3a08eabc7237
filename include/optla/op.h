/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file op.h
 * The operator: the scene as a black box that multiplies.
 *
 *     y = T x,   y = Tᵀ x   or   y = Tᴴ x           (Eqs. 1.1, 1.12)
 *
 * Rows of T are camera samples, columns are projector samples. x and y are blocks of columns. Algorithms see an operator
 * and nothing else; whether a product is a matrix product, a simulated exposure or a real photo is the operator's affair.
 */
#ifndef OPTLA_OP_H
#define OPTLA_OP_H

#include "optla/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Transpose (reciprocity: camera and projector swap) is not the adjoint (complex conjugate too) for complex T(ω). */
typedef enum { OPTLA_FORWARD, OPTLA_TRANSPOSE, OPTLA_CONJ_TRANSPOSE } optla_trans;

/** F32, F64: float, double. C32, C64: complex numbers made of two floats, of two doubles (real part first). */
typedef enum { OPTLA_F32, OPTLA_F64, OPTLA_C32, OPTLA_C64 } optla_scalar;

/** Bytes of one scalar; 0 for a value that is no scalar type. */
OPTLA_API size_t optla_scalar_bytes(optla_scalar type);

/** Column-major block to read: ncols columns of nrows scalars, column k starts at scalar k*ld. */
typedef struct {
	const void *data;
	size_t nrows, ncols, ld;
	optla_scalar type;
} optla_cblock;

/** Column-major block to write. */
typedef struct {
	void *data;
	size_t nrows, ncols, ld;
	optla_scalar type;
} optla_block;

static inline optla_cblock optla_block_const(optla_block b)
{
	const optla_cblock c = {b.data, b.nrows, b.ncols, b.ld, b.type};
	return c;
}

typedef struct optla_op optla_op;

enum {
	OPTLA_OP_NONNEGATIVE = 1u << 0,  /**< accepts only x >= 0: light */
	OPTLA_OP_STOCHASTIC = 1u << 1,   /**< two applies of the same x differ: noise */
	OPTLA_OP_NO_TRANSPOSE = 1u << 2, /**< the arrangement can't answer Tᵀ r */
	OPTLA_OP_SYMMETRIC = 1u << 3     /**< T = Tᵀ by construction (coaxial rig); nrows = ncols */
};

/** What the products of an operator have cost so far. */
typedef struct {
	uint64_t applies;                            /**< calls of optla_op_apply() */
	uint64_t forward_columns, transpose_columns; /**< products, column by column */
	uint64_t photos;                             /**< sensor readouts behind them; a plain matrix counts one per column */
	double exposure_s;                           /**< total exposure time of those photos */
	double seconds;                              /**< wall time inside optla_op_apply() */
} optla_op_cost;

/** Describes an operator to be made. size must be sizeof(optla_op_desc). */
typedef struct {
	size_t size;
	const char *name; /**< copied; used in messages */
	size_t nrows, ncols;
	optla_scalar type;
	double frequency_hz; /**< modulation frequency ω of T(ω), Eq. 6.1; 0 = steady light */
	unsigned flags;
	void *user;
	/** Computes y; sizes and types have been checked, x and y don't overlap, y is uninitialised. Only OPTLA_FORWARD and
	    OPTLA_TRANSPOSE reach a real operator; a complex one gets those two as well, the adjoint is made by conjugation. */
	optla_status (*apply)(void *user, optla_trans trans, optla_cblock x, optla_block y);
	/** Light only: as apply with the projector's power given. full_power[k] (> 0, >= max x_k) is the value of x that the projector's
	    full power stands for while column k is exposed:

	        y_k = T x_k + full_power[k] (ambient light + noise)

	    Given instead of apply, which is then expose with full_power[k] = max x_k (1 for a column of zeros). An operator whose y
	    doesn't depend on the power (a plain matrix) gives apply and leaves this NULL. */
	optla_status (*expose)(void *user, optla_trans trans, optla_cblock x, const double *full_power, optla_block y);
	void (*destroy)(void *user); /**< NULL: nothing to do. Called even when optla_op_create() fails */
	/** Adds photos and exposure_s of the products so far; NULL for an operator without a camera of its own. */
	void (*cost)(void *user, optla_op_cost *cost);
	/** Most photos that the next column will take, so that a photo budget can be kept; NULL: one, or the sum over the parts. */
	uint64_t (*price)(void *user, optla_trans trans);
	/** Expected Euclidean norm of the error of the last column applied, sqrt(E ||e||²), from the sensor's noise; NULL: exact,
	    or that of parts[0] when there is one part. */
	double (*noise)(void *user);
	/** Operators this one is made of: references are taken on success, their costs are counted once each. */
	optla_op *const *parts;
	size_t nparts;
} optla_op_desc;

/** @return OPTLA_ERR_ARG, OPTLA_ERR_NOMEM; on failure desc->destroy(desc->user) has been called and *out is NULL. */
OPTLA_API optla_status optla_op_create(optla_ctx *ctx, optla_op **out, const optla_op_desc *desc);
OPTLA_API optla_op *optla_op_ref(optla_op *op);
/** Drops one reference, clears the pointer; accepts NULL. */
OPTLA_API void optla_op_unref(optla_op **op);

/**
 * y = T x, Tᵀ x or Tᴴ x, for every column.
 *
 * x: ncols (forward) or nrows (else) rows; y the other; same number of columns; both of the operator's scalar type; no overlap.
 * @return OPTLA_ERR_SHAPE; OPTLA_ERR_UNSUPPORTED for a transpose the rig doesn't offer; OPTLA_ERR_ARG when x holds NaN, Inf
 * or (for light) a negative number; or the operator's own failure. y is undefined after a failure.
 * One thread at a time for each operator.
 */
OPTLA_API optla_status optla_op_apply(optla_op *op, optla_trans trans, optla_cblock x, optla_block y);

/**
 * As optla_op_apply() with the projector's power chosen: full_power[k] is the value of x that full power stands for in column k, at
 * least max x_k. Photos taken at one power hold the same ambient light, so their difference holds none (Eq. 2.4): that is what the
 * signed operator needs. Operators that don't depend on the power ignore it.
 * @return as optla_op_apply(); OPTLA_ERR_ARG too when a full_power isn't positive and finite or is below max x_k.
 */
OPTLA_API optla_status optla_op_expose(optla_op *op, optla_trans trans, optla_cblock x, const double *full_power, optla_block y);

OPTLA_API optla_ctx *optla_op_ctx(const optla_op *op);
OPTLA_API const char *optla_op_name(const optla_op *op);
OPTLA_API size_t optla_op_nrows(const optla_op *op);
OPTLA_API size_t optla_op_ncols(const optla_op *op);
OPTLA_API optla_scalar optla_op_type(const optla_op *op);
OPTLA_API unsigned optla_op_flags(const optla_op *op);
OPTLA_API double optla_op_frequency_hz(const optla_op *op);
/** applies, columns and seconds of this operator; photos and exposure of it and all its parts, each part counted once. */
OPTLA_API optla_op_cost optla_op_cost_so_far(optla_op *op);
/** Most photos that the next product with one column will take. */
OPTLA_API uint64_t optla_op_price(const optla_op *op, optla_trans trans);
/** Expected norm of the error of the last product, from the sensor; 0 = exact. */
OPTLA_API double optla_op_noise(optla_op *op);

/* ---- kinds ---- */

/** Dense matrix, y = A x. copy: false borrows a.data, which must then outlive the operator. Bytes: nrows * ncols scalars. */
OPTLA_API optla_status optla_op_dense(optla_ctx *ctx, optla_cblock a, bool copy, optla_op **out);
/**
 * Dense matrix mapped from a file without reading it: a .npy file (C or Fortran order, f4, f8, c8, c16), or a dataset of an HDF5
 * file as "file.h5:dataset" (2-D, contiguous storage, native byte order; rows of the dataset are rows of T). Pages come from disk as
 * needed, so the matrix may be larger than memory; the file must keep its size while the operator lives.
 * @return OPTLA_ERR_INPUT for a file that isn't that, OPTLA_ERR_UNSUPPORTED for a chunked or compressed dataset.
 */
OPTLA_API optla_status optla_op_map(optla_ctx *ctx, const char *path, optla_op **out);
/** Sparse matrix from compressed rows: row_start has nrows+1 entries, column/values row_start[nrows]. Copied and checked:
    columns of a row ascend, values (row_start[nrows] x 1) are finite. The transpose is kept too: 2 (4 + sizeof(scalar)) bytes per
    non-zero. */
OPTLA_API optla_status optla_op_sparse(optla_ctx *ctx, size_t nrows, size_t ncols, const uint64_t *row_start,
                                       const uint32_t *column, optla_cblock values, optla_op **out);
/** Low rank, T = L Rᵀ: left is nrows x K, right is ncols x K (as the photo basis D and illumination basis P of Eq. 2.7). Copied. */
OPTLA_API optla_status optla_op_lowrank(optla_ctx *ctx, optla_cblock left, optla_cblock right, optla_op **out);
/** T = A B. */
OPTLA_API optla_status optla_op_product(optla_op *a, optla_op *b, optla_op **out);
/** T = Aᴴ (for a real operator its transpose). */
OPTLA_API optla_status optla_op_adjoint(optla_op *a, optla_op **out);
/** Passes everything on to A and checks it: y is filled with NaN first and must come back finite, x must come back unchanged, a
    non-negative operator without noise must answer y >= 0. Breaches are OPTLA_ERR_DEVICE with the index of the first bad entry. */
OPTLA_API optla_status optla_op_checked(optla_op *a, optla_op **out);

/** How a signed pattern becomes light. */
typedef enum {
	/** T p = T p₊ - T p₋: two photos for each product, both exposed at full power max |p|, so that ambient light and black level cancel
	    (Eqs. 2.3, 2.4). */
	OPTLA_SPLIT_SIGNED,
	/** T p = (y(p + c 1) - s dark) - c (y(1) - dark), c = max(0, -min p), s = max(p + c 1): one photo for each product, plus y(1) and
	    the dark frame y(0) at full power 1, taken once for each direction. */
	OPTLA_SPLIT_OFFSET,
	/** Product by product, whichever is expected to have less noise for the light spent, see optla_op_signed(). */
	OPTLA_SPLIT_AUTO
} optla_split;

/**
 * The signed operator of Krylov methods made of an operator that accepts only light (Eqs. 2.3, 2.4).
 *
 * OPTLA_SPLIT_AUTO compares, per product, the expected noise of the two ways from the light op's own noise estimate: it takes offset
 * when its variance is at most twice that of signed (two offset photos averaged are then no worse than one signed pair), and
 * always when the operator is exact. Cost: 2 photos per column (signed), 1 + 2 per direction once (offset).
 */
OPTLA_API optla_status optla_op_signed(optla_op *light, optla_split split, optla_op **out);
/** How many products of a signed operator were made each way so far. */
OPTLA_API void optla_op_signed_counts(const optla_op *op, uint64_t *by_sign, uint64_t *by_offset);

/* ---- oracles ---- */

/** *rel = |<y, T x> - <Tᴴ y, x>| / max(||y|| ||T x||, ||Tᴴ y|| ||x||) for random x, y (non-negative for light). */
OPTLA_API optla_status optla_op_check_adjoint(optla_op *op, uint64_t seed, double *rel);
/** *rel = ||T(a x + b y) - a T x - b T y|| / (|a| ||T x|| + |b| ||T y||), a, b, x, y random (non-negative for light). */
OPTLA_API optla_status optla_op_check_linear(optla_op *op, uint64_t seed, double *rel);
/** All of T, nrows x ncols, by ncols products with unit vectors (in blocks). */
OPTLA_API optla_status optla_op_to_dense(optla_op *op, optla_block out);

#ifdef __cplusplus
}
#endif
#endif
