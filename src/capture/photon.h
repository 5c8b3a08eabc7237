/* SPDX-License-Identifier: BSD-3-Clause */
/* Photons and energy, for Ψ = quantum efficiency / photon energy (Eq. 1.2). */
#ifndef OPTLA_PHOTON_H
#define OPTLA_PHOTON_H

/* h c / λ at 550 nm, the middle of what eyes and cameras see, where nothing says of which colour the light was. */
#define OPTLA_PHOTON_550NM_J 3.6117e-19

#endif
