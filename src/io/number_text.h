/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables of numbers as text: separated by blanks, commas or semicolons; '#' starts a comment. */
#ifndef OPTLA_NUMBER_TEXT_H
#define OPTLA_NUMBER_TEXT_H

#include "base/base_impl.h"

/* All numbers of a file in reading order; the caller frees *values. Rows (lines with numbers) must be equally long: *columns, NULL if
   not wanted. OPTLA_ERR_INPUT with FILE:LINE for text that is no finite number, rows of different lengths, an empty file. */
optla_status optla_read_numbers_(optla_ctx *ctx, const char *path, double **values, size_t *count, size_t *columns);
/* The same from bytes; name is used in messages. */
optla_status optla_parse_numbers_(optla_ctx *ctx, const char *bytes, size_t size, const char *name, double **values,
                                  size_t *count, size_t *columns);

#endif
