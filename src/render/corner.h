/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The analytic corner: T of a corner of diffuse walls with all inter-reflections, without sampling.
 *
 * A projector (or screen) pixel at full power emits W_n joules, W_n = 1 for the brightest. T[m, n] is the energy of them that enters
 * the camera's pupil through pixel m. Like a real projector of uniform radiance its pixels fall off as the camera's do, by
 * cos⁴: W_n ~ ∫ cos⁴α du / f². That makes a coaxial T symmetric: reciprocity without a factor.
 *
 *     direct   T = A_c ∫ ρ/π · E_n(x(u)) · cos⁴α_c / f_c² du,   E_n(x) = I_n cosθ / r²         over the part of pixel m that n lights
 *     bounce   T = A_c ∫∫ ρ/π · ρ cosθ cosθ' / (π r²) · dΦ_n · cos⁴α_c / f_c² du            light that two walls scatter in turn
 *     rest     T = A_c/π · V_cᵀ (I - R F)⁻¹ R A⁻¹ V_p                                       light that patches scatter in between
 *
 * A_c: area of the pupil. V: light between the points of a pixel and each patch of the other walls, by closed form factors, with the
 * points' albedo. Direct light is exact to quadrature of degree 5 on pieces smaller than a pixel; the bounce is a sum over pairs of
 * pieces of pixels, finer where they are close; only the rest knows patches: patches² squares on each wall whose exitance is constant.
 * A screen's light meets the patches first: T = direct + A_c/π · V_cᵀ (I - R F)⁻¹ R A⁻¹ Φ, Φ in closed form.
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
