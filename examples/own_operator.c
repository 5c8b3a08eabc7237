/* SPDX-License-Identifier: BSD-3-Clause */
/* Your own operator: Optla needs one function that multiplies. Here it is light that spreads along a slab of wax lit by N lamps:

       T = B^STEPS,   (B x)[n] = x[n-1]/4 + x[n]/2 + x[n+1]/4,   reflecting ends

   No matrix is stored. The eigenvalues of T are known, cos(pi k / (2 N))^(2 STEPS), so we can see whether Optla finds them.
   Replace apply() by code that shows x with a projector and answers with a photo, and everything below stays as it is. */
#include <optla/optla.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { N = 64, STEPS = 40, WANTED = 5 };

/* y = B x; x and y are different arrays */
static void spread(const double *x, double *y)
{
	for (int n = 0; n < N; n++) y[n] = 0.25 * x[n > 0 ? n - 1 : 0] + 0.5 * x[n] + 0.25 * x[n < N - 1 ? n + 1 : N - 1];
}

/* Each column of x is one illumination, each column of y its photo. B is symmetric, so the transpose is the same product. */
static optla_status apply(void *user, optla_trans trans, optla_cblock x, optla_block y)
{
	(void)user, (void)trans;
	for (size_t k = 0; k < x.ncols; k++) {
		double a[N], b[N];
		memcpy(a, (const double *)x.data + k * x.ld, sizeof a);
		for (int s = 0; s < STEPS; s += 2) { /* there and back: STEPS is even */
			spread(a, b);
			spread(b, a);
		}
		memcpy((double *)y.data + k * y.ld, a, sizeof a);
	}
	return OPTLA_OK;
}

int main(void)
{
	optla_ctx *ctx = NULL;
	optla_op *wax = NULL;
	optla_krylov *run = NULL;
	const optla_op_desc desc = {.size = sizeof desc,
	                            .name = "wax",
	                            .nrows = N,
	                            .ncols = N,
	                            .type = OPTLA_F64,
	                            .flags = OPTLA_OP_SYMMETRIC,
	                            .apply = apply};
	/* The default start, all lamps equally bright, is an eigenvector here and would end the run after one photo: one lamp alone. */
	const double start[N] = {1};
	const optla_krylov_problem problem_of = {.size = sizeof problem_of, .start = start};
	optla_krylov_options options = optla_krylov_defaults;
	options.iterations = 30;
	options.rank = WANTED;
	options.symmetric = true;

	double value[WANTED], adjoint = 1, linear = 1, worst = 1;
	optla_status s = optla_ctx_create(&ctx, NULL);
	if (!s) s = optla_op_create(ctx, &wax, &desc);
	if (!s) s = optla_op_check_adjoint(wax, 1, &adjoint); /* a rig of your own deserves these two tests */
	if (!s) s = optla_op_check_linear(wax, 1, &linear);
	optla_krylov_problem problem = problem_of;
	problem.op = wax;
	if (!s) s = optla_krylov_create(&problem, OPTLA_KRYLOV_SVD, &options, &run);
	if (!s) s = optla_krylov_run(run);
	if (!s) s = optla_krylov_triplets(run, value, (optla_block){0}, (optla_block){0}, NULL);
	if (s)
		fprintf(stderr, "%s: %s\n", optla_status_name(s), optla_ctx_last_error(ctx));
	else {
		worst = 0;
		printf("adjoint test %.1e, linearity %.1e, %d photos\n", adjoint, linear, (int)optla_krylov_get_info(run).photos);
		for (int k = 0; k < WANTED; k++) {
			const double exact = pow(cos(acos(-1) * k / (2 * N)), 2 * STEPS);
			printf("singular value %d: %.12f, exact %.12f\n", k, value[k], exact);
			worst = fmax(worst, fabs(value[k] - exact));
		}
		printf("largest difference %.1e\n", worst);
	}
	optla_krylov_destroy(&run);
	optla_op_unref(&wax);
	optla_ctx_destroy(&ctx);
	return worst < 1e-10 ? 0 : 1;
}
