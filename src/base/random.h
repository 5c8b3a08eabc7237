/* SPDX-License-Identifier: BSD-3-Clause */
/* Counter-based random numbers: a number is a pure function of (seed, stream, index, dimension), so any subset can be
   remade in any order by any number of threads. Philox 4x32-10: J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw,
   Parallel random numbers: as easy as 1, 2, 3, SC 2011. */
#ifndef OPTLA_RANDOM_H
#define OPTLA_RANDOM_H

#include <stdint.h>

/* stream: what is being drawn (a pixel, a job); index: which sample of it; dimension: which number within the sample. */
typedef struct {
	uint64_t seed;
	uint32_t stream_hi; /* purpose: keeps uses of one seed apart, see enum below */
} optla_rand;

enum { OPTLA_RAND_SENSOR = 1, OPTLA_RAND_START = 2, OPTLA_RAND_NYSTROEM = 4, OPTLA_RAND_CHECK = 5, OPTLA_RAND_TEST = 6 };

void optla_rand_block_(optla_rand r, uint64_t stream, uint32_t index, uint32_t dimension, uint32_t out[4]);
/* uniform in [0, 1), 53 bits */
double optla_rand_u01_(optla_rand r, uint64_t stream, uint32_t index, uint32_t dimension);
/* standard normal (Box-Muller) */
double optla_rand_normal_(optla_rand r, uint64_t stream, uint32_t index, uint32_t dimension);
/* Poisson of the given mean (>= 0), exact at every mean: inversion below 10, else W. Hoermann, The transformed rejection
   method for generating Poisson random variables, Insurance: Mathematics and Economics 12 (1993), algorithm PTRS.
   Uses dimensions from 'dimension' up, each drawn number of trials advances it. */
double optla_rand_poisson_(optla_rand r, uint64_t stream, uint32_t index, uint32_t dimension, double mean);

#endif
