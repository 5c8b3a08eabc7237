/* SPDX-License-Identifier: BSD-3-Clause */
/* The inside of images. */
#ifndef OPTLA_IMAGE_IMPL_H
#define OPTLA_IMAGE_IMPL_H

#include "optla/image.h"

/* Channels without alpha: 1 of 1 or 2, 3 of 3 or 4. */
size_t optla_image_colours_(const optla_image *image);
/* The sRGB curve for values in 0..1 and its inverse. */
double optla_srgb_encode_(double linear);
double optla_srgb_decode_(double display);

#endif
