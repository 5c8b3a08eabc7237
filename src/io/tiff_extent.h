/* SPDX-License-Identifier: BSD-3-Clause */
/* Where the data of a TIFF end, read from its directories alone. */
#ifndef OPTLA_TIFF_EXTENT_H
#define OPTLA_TIFF_EXTENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* False if a directory, or a strip or tile that one names, lies behind the end of a DNG. True for other files: camera makers' TIFFs
   don't keep to the rules. */
bool optla_dng_is_whole_(const uint8_t *data, size_t count);

#endif
