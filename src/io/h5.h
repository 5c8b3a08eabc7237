/* SPDX-License-Identifier: BSD-3-Clause */
/* HDF5 files of ours: named datasets with units, a kind, the provenance; written whole or not at all. */
#ifndef OPTLA_H5_H
#define OPTLA_H5_H

#include "base/base_impl.h"
#include "optla/op.h"

typedef struct optla_h5 optla_h5;

/* Starts path.tmp; attributes "optla_kind" = kind and "provenance" are written. */
optla_status optla_h5_create_(optla_ctx *ctx, const char *path, const char *kind, optla_h5 **out);
/* commit: flush, sync and rename to path; else the temporary file is removed. Always frees and clears *file. */
optla_status optla_h5_finish_(optla_h5 **file, bool commit);
/* Opens for reading; kind NULL: any; else the file must say that kind (OPTLA_ERR_INPUT names both). */
optla_status optla_h5_open_(optla_ctx *ctx, const char *path, const char *kind, optla_h5 **out);
void optla_h5_close_(optla_h5 **file);

/* A block as a 2-D dataset of ncols x nrows in C order (photo after photo); complex as a compound {r, i}, as h5py has it. */
optla_status optla_h5_put_(optla_h5 *file, const char *name, optla_cblock block, const char *unit, const char *help);
/* Reads a 2-D (or 1-D: one column) dataset into a new array (optla_free); out->data NULL on failure. type: converted to. */
optla_status optla_h5_get_(optla_h5 *file, const char *name, optla_scalar type, optla_block *out);
optla_status optla_h5_put_u32_(optla_h5 *file, const char *name, const uint32_t *values, size_t count, const char *help);
optla_status optla_h5_get_u32_(optla_h5 *file, const char *name, uint32_t **values, size_t *count);
/* Attributes of the root. */
optla_status optla_h5_put_number_(optla_h5 *file, const char *name, double value);
optla_status optla_h5_get_number_(optla_h5 *file, const char *name, double *value);
optla_status optla_h5_put_text_(optla_h5 *file, const char *name, const char *value);
/* The caller frees *value. */
optla_status optla_h5_get_text_(optla_h5 *file, const char *name, char **value);
bool optla_h5_has_(optla_h5 *file, const char *name);

#endif
