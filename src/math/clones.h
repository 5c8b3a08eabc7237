/* SPDX-License-Identifier: BSD-3-Clause */
/* Hot loops for several generations of a processor. */
#ifndef OPTLA_CLONES_H
#define OPTLA_CLONES_H

#include <stdint.h> /* says __GLIBC__ */

/* One version of a hot loop for each generation of x86, chosen when the program starts. Only the order of SIMD sums depends on
   it. Other compilers and processors build the plain version. */
#if defined(__x86_64__) && defined(__linux__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define OPTLA_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define OPTLA_CLONES
#endif

#endif
