/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a saved Krylov run: one that goes on to its end and gives its results, or an error. */
#include "fuzz.h"
#include "krylov/run.h"
#include "krylov_problem.h"

/* The results of each method are asked for; those of the others are errors. */
static void use(optla_krylov *run)
{
	double vector[FUZZ_COLUMNS], values[FUZZ_COLUMNS], residual;
	(void)optla_krylov_run(run);
	(void)optla_krylov_solution(run, 0, vector, &residual);
	(void)optla_krylov_triplets(run, values, (optla_block){0}, (optla_block){0}, NULL);
	(void)optla_krylov_principal(run, vector, &residual);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	optla_ctx *ctx = fuzz_ctx();
	double matrix[FUZZ_ROWS * FUZZ_COLUMNS], target[FUZZ_ROWS];
	optla_op *op = fuzz_op(ctx, matrix, target);
	const optla_krylov_problem problem = {.size = sizeof problem, .op = op, .target = target};
	optla_krylov_options o = optla_krylov_defaults;
	o.iterations = FUZZ_COLUMNS;
	optla_krylov *run;
	if (OPTLA_OK == optla_krylov_resume_bytes_(&problem, &o, data, size, "fuzz.h5", &run))
		use(run);
	else if (run || !*optla_ctx_last_error(ctx))
		abort();
	optla_krylov_destroy(&run);
	optla_op_unref(&op);
	optla_ctx_destroy(&ctx);
	return 0;
}
