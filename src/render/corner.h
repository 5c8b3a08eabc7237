/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The analytic corner: T of a corner of diffuse walls with all inter-reflections, without sampling.
 *
 * A projector (or screen) pixel at full power emits W_n joules, W_n = 1 for the brightest. T[m, n] is the energy of them that enters
 * the camera's pupil through pixel m. Like a real projector of uniform radiance its pixels fall off as the camera's do, by
 * cos⁴: W_n ~ ∫ cos⁴α du / f². That makes a coaxial T symmetric: reciprocity without a factor.
 *
 *     direct     T = A_c ∫ ρ/π · E_n(x(u)) · cos⁴α_c / f_c² du,   E_n(x) = I_n cosθ / r²      over the part of pixel m that n lights
 *     indirect   T = A_c/π · W_cᵀ G Φ                            W_c[b, m] = ∫ cos⁴α_c / f_c² du  over pixel m ∩ patch b
 *
 * A_c: area of the pupil; Φ[a, n]: energy of pixel n that falls on patch a; G: render/radiosity.h. The direct part is exact to
 * quadrature of degree 5 on pieces smaller than a pixel; indirect light is constant over each of patches² squares of a wall.
 */
#ifndef OPTLA_CORNER_H
#define OPTLA_CORNER_H

#include "scene/corner_desc.h"

enum { OPTLA_CORNER_DIRECT = 1u, OPTLA_CORNER_INDIRECT = 2u };

/* Camera pixels, and projector pixels or screen patches. */
size_t optla_corner_npixels_(const optla_corner_desc *desc);
size_t optla_corner_nlights_(const optla_corner_desc *desc);
/* Checks desc. t: 3 * npixels x nlights, column-major; row c*npixels + m is channel c of pixel m. Same bytes for any number of
   threads; a coaxial T is symmetric to the bit in each channel. */
optla_status optla_corner_matrix_(optla_ctx *ctx, const optla_corner_desc *desc, unsigned parts, double *t);

#endif
