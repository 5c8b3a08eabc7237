/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernels on one tile of a dense matrix, for math/ alone. The driver is dense_apply.c. */
#ifndef OPTLA_DENSE_IMPL_H
#define OPTLA_DENSE_IMPL_H

#include "math/clones.h"

#include <stdbool.h>
#include <stddef.h>

/* Views of a tile: rows x cols of A, nrhs columns of x (cols rows forward, rows rows transposed). Leading dimensions in scalars. */
typedef struct {
	size_t rows, cols, nrhs;
	const void *a;
	size_t lda;
	const void *x;
	size_t ldx;
} optla_tile;

/* y += A x */
void optla_tile_forward_f32_(optla_tile t, void *y, size_t ldy);
void optla_tile_forward_f64_(optla_tile t, void *y, size_t ldy);
void optla_tile_forward_c32_(optla_tile t, void *y, size_t ldy);
void optla_tile_forward_c64_(optla_tile t, void *y, size_t ldy);

/* sums += Aᵀ x, or Aᴴ x when conj; sums are doubles (pairs of them for complex), leading dimension in scalars. */
void optla_tile_dots_f32_(optla_tile t, bool conj, double *sums, size_t ldsums);
void optla_tile_dots_f64_(optla_tile t, bool conj, double *sums, size_t ldsums);
void optla_tile_dots_c32_(optla_tile t, bool conj, double *sums, size_t ldsums);
void optla_tile_dots_c64_(optla_tile t, bool conj, double *sums, size_t ldsums);

#endif
