/* SPDX-License-Identifier: BSD-3-Clause */
/* The inside of a Krylov run. All columns are allocated when the run is made; iterations only fill them. */
#ifndef OPTLA_KRYLOV_RUN_H
#define OPTLA_KRYLOV_RUN_H

#include "base/base_impl.h"
#include "math/dense.h"
#include "optla/krylov.h"

struct optla_krylov {
	optla_ctx *ctx;
	optla_krylov_method method;
	optla_krylov_options opt;
	optla_op *op, *high, *reduce;
	double reduce_noise; /* noise of a reduced photo over that of the full one: ||reduce||_F / sqrt(nhigh) */
	optla_scalar type;
	size_t nrows, ncols, nhigh, kmax;
	size_t k; /* whole iterations done; columns 0 .. k-1 of D are photos */

	optla_block p;      /* ncols x (kmax+1): orthonormal illuminations; column k is the next one if have_next */
	optla_block d, h;   /* nrows x kmax photos d_k = T p_k; nhigh x kmax the same at full resolution */
	optla_block r, s;   /* nrows x kmax what shone backwards; ncols x kmax what came: s_k = Tᵀ r_k */
	optla_block q;      /* GMRES: nrows x kmax, orthonormal basis of the photos; SVD keeps it in r */
	double *qr;         /* GMRES, SVD: kmax x kmax, D = Q R, column-major, upper triangle */
	double *qt;         /* GMRES: kmax, Qᵀ i */
	double *residuals;  /* kmax: the method's relative residual after each iteration */
	double *noise;      /* kmax: expected ||e_k|| of photo d_k (Eq. 2.12) */
	double *gaps;       /* GMRES, kmax: expected ||E y|| of the solution from k photos */
	double *energy;     /* kmax: ||d_k||² */
	double *small;      /* GMRES: kmax coefficients */
	optla_block target; /* GMRES: i, nrows x 1 */
	double target_norm;
	double scale;   /* largest ||T p|| seen: what "negligible" is measured against */
	double first;   /* Arnoldi: ||w_1||, the scale of its residual */
	bool have_next; /* column k of P holds the next illumination */
	bool fresh;     /* ... which is a random direction, because the method had no more of its own */
	double value;   /* power: λ or σ */

	optla_block work, coef; /* scratch: max(nrows, ncols) x 1, (kmax+1) x 1 */
	optla_block rd, rp, rh; /* rotated bases when options.rank asks for a truncation; data NULL else */
	size_t rank;            /* columns of the result */

	optla_stop stop;
	bool done;       /* a stopping rule has fired */
	uint64_t photos; /* taken for this run, those before a resume included */
	double exposure_s, seconds_operator, seconds_total;
};

/* One iteration of each method; it calls optla_krylov_finish_() when a stopping rule fires. */
optla_status optla_power_step_(optla_krylov *run);
optla_status optla_arnoldi_step_(optla_krylov *run); /* Arnoldi and GMRES, both forms; the symmetric SVD */
optla_status optla_svd_step_(optla_krylov *run);     /* Golub-Kahan */

/* products.c: photos within the budget. *within = false: the photos don't fit any more, and the run has been finished. */
optla_status optla_krylov_photo_(optla_krylov *run, size_t k, bool *within);                     /* d_k (and h_k) = T p_k */
optla_status optla_krylov_back_(optla_krylov *run, optla_cblock r, optla_block s, bool *within); /* s = Tᵀ r */
/* Whether the next products fit in the budget; if not, the run is finished. */
bool optla_krylov_affordable_(optla_krylov *run, bool forward, bool back);
void optla_krylov_finish_(optla_krylov *run, optla_stop stop);
/* The tests that follow every iteration: tolerance, noise, K. */
void optla_krylov_judge_(optla_krylov *run);

/* ortho.c */
/* w := (I - V Vᵀ) w for V the first n columns, twice; *before, *after: its norm. h (n doubles) += Vᵀ w, or NULL. w isn't normalised. */
optla_status optla_ortho_(optla_krylov *run, optla_cblock v, size_t n, optla_block w, double *before, double *after, double *h);
/* w := random unit vector (fixed seed) orthogonal to the first n columns of v; *found false if there is none (n = dimension). */
optla_status optla_ortho_fresh_(optla_krylov *run, optla_cblock v, size_t n, optla_block w, bool *found);
/* out = basis(:, 1..k) c, c k x out.ncols in double. */
optla_status optla_rotate_(const optla_krylov *run, optla_cblock basis, size_t k, const double *c, optla_block out);
/* Rounding level under which a component is no direction but dirt. */
double optla_ortho_dirt_(optla_scalar type);

/* noise.c: section 2.7 */
/* Best number of photos so far by expected error, and whether several photos in a row have not helped. */
size_t optla_noise_best_(const optla_krylov *run, bool *useless);
/* GMRES: expected ||E y||, the gap between computed and true residual, for coefficients y of k photos. */
double optla_noise_gap_(const optla_krylov *run, size_t k, const double *y);
/* GMRES: estimate of ||i - T P y||² from k photos with the noise's share taken out; may be negative. */
double optla_noise_true_residual2_(const optla_krylov *run, size_t k);
/* GMRES: largest ||E_k|| that still allows the tolerance at the last step. */
double optla_noise_allowed_(const optla_krylov *run);

/* gmres.c */
optla_status optla_gmres_update_(optla_krylov *run, size_t k); /* takes photo k into the QR factors; residuals[k], gaps[k] */
void optla_gmres_coefficients_(const optla_krylov *run, size_t k, double *y); /* y = argmin ||D_k y - i|| */
/* nonnegative.c: p >= 0 from the first k >= 1 photos */
optla_status optla_gmres_nonnegative_(const optla_krylov *run, size_t k, optla_block p);

/* state.c: as optla_krylov_resume() from the bytes of a file; name is used in messages. */
optla_status optla_krylov_resume_bytes_(const optla_krylov_problem *problem, const optla_krylov_options *options,
                                        const void *bytes, size_t count, const char *name, optla_krylov **out);

/* svd.c */
optla_status optla_svd_residual_(optla_krylov *run, double *residual); /* largest of the wanted triplets */
/* results.c: the truncated bases, when options.rank asks for them */
optla_status optla_krylov_truncate_(optla_krylov *run);
size_t optla_krylov_columns_(const optla_krylov *run); /* of the bases */

#endif
