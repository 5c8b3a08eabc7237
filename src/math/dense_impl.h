/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernels on one tile of a dense matrix, for math/ alone. The driver is dense_apply.c. */
#ifndef OPTLA_DENSE_IMPL_H
#define OPTLA_DENSE_IMPL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h> /* __GLIBC__ too */

/* One version of a hot loop for each generation of x86, chosen when the program starts. Only the order of SIMD sums depends on
   it. Other compilers and processors build the plain version. */
#if defined(__x86_64__) && defined(__linux__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define OPTLA_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define OPTLA_CLONES
#endif

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
