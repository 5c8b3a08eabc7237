/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file krylov.h
 * Optical Krylov methods (thesis chapter 2): power iteration, Arnoldi, GMRES / least squares, singular triplets.
 *
 * Written for photographs, not flops: each product with T costs photos. A run holds every photo it has taken, takes a photo budget, can
 * be stopped, saved and resumed, re-orthogonalises twice, and reports residuals recomputed from the photos, not from recurrences.
 *
 * Notation as in Algorithm 2: P = [p_1 .. p_K] orthonormal illuminations (ncols x K), D = [d_1 .. d_K] photos, d_k = T p_k (nrows x K).
 * For symmetric T the next illumination comes from d_k, otherwise from s_k = Tᵀ d_k / ||d_k||, that is from Tᵀ T (Eqs. 2.5, 2.6).
 */
#ifndef OPTLA_KRYLOV_H
#define OPTLA_KRYLOV_H

#include "optla/base.h"
#include "optla/op.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What to solve. All operators real, of one scalar type. */
typedef struct {
	size_t size;
	optla_op *op; /**< T, nrows x ncols; signed patterns are its own affair (optla_op_signed) */
	/**
	 * High-resolution photos beside the low-resolution ones (Eq. 2.10): if given, photo k is taken through `high` (nhigh x ncols) and
	 * d_k = reduce * photo (reduce: nrows x nhigh), so each photo is taken once and kept at full resolution; `op` then answers only Tᵀ.
	 * With colour cameras `high` is all channels and `reduce` the mean of the channels (grey illumination, section 2.4).
	 */
	optla_op *high, *reduce;
	const void *target; /**< GMRES: the photo to be made, i (nrows of op's scalar type); else NULL */
	const void *start;  /**< first illumination (ncols), any length but zero; NULL: all ones, as in the thesis */
} optla_krylov_problem;

typedef enum { OPTLA_KRYLOV_POWER, OPTLA_KRYLOV_ARNOLDI, OPTLA_KRYLOV_GMRES, OPTLA_KRYLOV_SVD } optla_krylov_method;
typedef enum { OPTLA_NONNEGATIVE_NONE, OPTLA_NONNEGATIVE_CLAMP, OPTLA_NONNEGATIVE_NNLS } optla_nonnegative;

typedef struct {
	size_t size;
	int iterations; /**< K, largest number of iterations */
	int max_photos; /**< stop before the photo that would exceed this; 0: no limit */
	int rank;       /**< SVD and Arnoldi: best rank of the result, <= iterations; 0: iterations */
	bool symmetric; /**< use the form for symmetric T (needs nrows = ncols): half the photos */
	/** Stop at this relative residual, 0: don't. GMRES: ||i - T p|| / ||i||; power: ||T v - λ v|| / λ; SVD: that of the wanted triplets;
	    Arnoldi: the part of the last s_k (symmetric: d_k) outside P over that of the first. */
	double tolerance;
	/** Stop when more photos can't help, judged from the sensor's noise (section 2.7), and keep what the best number of photos gives. Capture ends
	    within 5 % of the least error of T that any number of iterations reaches; GMRES, where each photo still helps a little, within 10 %
	    (signed splitting) to 25 % (offset) of the least true residual (tests/stat/test_noise_stop.c). */
	bool noise_stop;
	optla_nonnegative nonnegative; /**< GMRES: footnote 3 of section 2.3 */
} optla_krylov_options;
OPTLA_API extern const optla_krylov_options optla_krylov_defaults;
OPTLA_API extern const optla_option_table optla_krylov_table;

typedef enum {
	OPTLA_STOP_ITERATIONS, /**< K reached */
	OPTLA_STOP_TOLERANCE,
	OPTLA_STOP_PHOTOS,    /**< budget used up */
	OPTLA_STOP_BREAKDOWN, /**< invariant subspace: T has no more to give (rank reached) */
	OPTLA_STOP_NOISE,     /**< the next photo would add more noise than signal */
	OPTLA_STOP_CANCELLED,
	OPTLA_STOP_NONE /**< not stopped: optla_krylov_step() came to its end */
} optla_stop;
OPTLA_API const char *optla_stop_name(optla_stop stop);

typedef struct {
	optla_stop stop;
	size_t iterations; /**< iterations done */
	size_t rank;     /**< columns of the result: iterations, less those that noise made useless, at most options.rank when done */
	uint64_t photos; /**< taken for this run, those before a resume included */
	double exposure_s;
	double residual; /**< relative and recomputed, see optla_krylov_options.tolerance */
	double
	    residual_true; /**< GMRES: estimated ||i - T p||/||i|| with the share of the photos' noise taken out; 0: lost in the noise */
	double noise;      /**< estimated ||E||: expected Frobenius norm of the error in D(:, 1..rank) */
	double
	    noise_allowed; /**< GMRES: largest ||E_k|| that Simoncini & Szyld's bound still allows at the last step for `tolerance` */
	double seconds_operator, seconds_total;
	uint64_t photos_saved; /**< budgeted photos (iterations asked for) not taken thanks to noise_stop */
} optla_krylov_info;

typedef struct optla_krylov optla_krylov;

/** Prepares a run; takes references to the operators, copies target and start. All memory is allocated here.
    @return OPTLA_ERR_ARG: K larger than ncols, zero start, NaN; OPTLA_ERR_UNSUPPORTED: no transpose; OPTLA_ERR_SHAPE. */
OPTLA_API optla_status optla_krylov_create(const optla_krylov_problem *problem, optla_krylov_method method,
                                           const optla_krylov_options *options, optla_krylov **out);
OPTLA_API void optla_krylov_destroy(optla_krylov **run);
/** Runs until a stopping rule fires. After OPTLA_ERR_CANCELLED the state is that of the last whole iteration and can be saved and run on. */
OPTLA_API optla_status optla_krylov_run(optla_krylov *run);
/** The same, but at most `iterations` more of them: to look at a run while it goes on. */
OPTLA_API optla_status optla_krylov_step(optla_krylov *run, size_t iterations);
OPTLA_API optla_krylov_info optla_krylov_get_info(const optla_krylov *run);
/** The state, every photo included, as HDF5 (docs/files.md). Whole or not at all. */
OPTLA_API optla_status optla_krylov_save(const optla_krylov *run, const char *path);
/** Continues from a file: problem and options as for create (K may have grown); sizes and method must agree with the file. */
OPTLA_API optla_status optla_krylov_resume(const optla_krylov_problem *problem, const optla_krylov_options *options,
                                           const char *path, optla_krylov **out);

/* ---- results; views stay valid until the next run or destroy ---- */

/** D (nrows x rank), P (ncols x rank): T ~ D Pᵀ. high: nhigh x rank photos, data NULL if none were kept. Any of them may be NULL. */
OPTLA_API optla_status optla_krylov_bases(const optla_krylov *run, optla_cblock *photos, optla_cblock *illuminations,
                                          optla_cblock *high);
/** r_k and s_k of Algorithm 2 (nrows x k, ncols x k; the non-symmetric form only, data NULL else): for Fig. 2.6. */
OPTLA_API optla_status optla_krylov_dual_bases(const optla_krylov *run, optla_cblock *r, optla_cblock *s);
/** GMRES: illumination p (ncols) of Eq. 2.9 with the chosen non-negativity, from the first k photos (0: rank). p is of the
    op's type; *residual = ||i - D Pᵀ p|| / ||i|| recomputed. NNLS minimises that with a price on the part of p that was never
    photographed, which D Pᵀ doesn't see: ||D Pᵀ p - i||² + τ² ||(I - P Pᵀ) p||² over p >= 0, τ the smallest singular value of D. */
OPTLA_API optla_status optla_krylov_solution(const optla_krylov *run, size_t k, void *p, double *residual);
/** SVD: values (rank, double), left vectors U (nrows x rank), right V (ncols x rank), op's type; residual (rank): recomputed
    max(||T v - σ u||, ||Tᴴ u - σ v||) / σ_1 from stored photos. Any may be NULL/empty. */
OPTLA_API optla_status optla_krylov_triplets(const optla_krylov *run, double *values, optla_block left, optla_block right,
                                             double *residual);
/** Power: the principal eigenvector (symmetric) or right singular vector (ncols, op's type) and its value. */
OPTLA_API optla_status optla_krylov_principal(const optla_krylov *run, void *vector, double *value);

#ifdef __cplusplus
}
#endif
#endif
