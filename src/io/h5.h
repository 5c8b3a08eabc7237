/* SPDX-License-Identifier: BSD-3-Clause */
/* HDF5 files of ours: named datasets with units, a kind, the provenance; written whole or not at all.

   One thread at a time in each file; calls for different files may come from different threads (they wait for each other, since the
   HDF5 library is made for one thread; a program that calls HDF5 itself must not do so meanwhile). An error handler must not call
   these functions. */
#ifndef OPTLA_H5_H
#define OPTLA_H5_H

#include "base/base_impl.h"
#include "optla/image.h"
#include "optla/op.h"

typedef struct optla_h5 optla_h5;

/* Starts a temporary file beside path; the attributes "optla_kind" = kind, "optla_version" and "provenance" are written. The same
   contents give the same bytes: no times are stored. */
optla_status optla_h5_create_(optla_ctx *ctx, const char *path, const char *kind, optla_h5 **out);
/* commit: flush, sync and rename to path; else the temporary file is removed. Always frees and clears *file. */
optla_status optla_h5_finish_(optla_h5 **file, bool commit);
/* Opens for reading; kind NULL: any; else the file must say that kind (OPTLA_ERR_INPUT names both). */
optla_status optla_h5_open_(optla_ctx *ctx, const char *path, const char *kind, optla_h5 **out);
/* As open from the bytes of a file, which must stay until it is closed; name is used in messages. */
optla_status optla_h5_open_bytes_(optla_ctx *ctx, const void *bytes, size_t count, const char *name, optla_h5 **out);
void optla_h5_close_(optla_h5 **file);

/* A block as a 2-D dataset of ncols x nrows in C order (photo after photo); complex as a compound {r, i}, as h5py has it. Contiguous, in
   the machine's byte order and from 1 KiB on page aligned, so that it can be memory mapped. unit, help: attributes "unit" and
   "description", NULL: left out. */
optla_status optla_h5_put_(optla_h5 *file, const char *name, optla_cblock block, const char *unit, const char *help);
/* Reads a 2-D (or 1-D: one column) dataset of any integers, floats, booleans or complex numbers into a new array (optla_free); out->data
   NULL on failure. type: converted to; complex to real is an error. name may be a path ("a/b"). */
optla_status optla_h5_get_(optla_h5 *file, const char *name, optla_scalar type, optla_block *out);
optla_status optla_h5_put_u32_(optla_h5 *file, const char *name, const uint32_t *values, size_t count, const char *help);
optla_status optla_h5_get_u32_(optla_h5 *file, const char *name, uint32_t **values, size_t *count);
/* Attributes of the root. */
optla_status optla_h5_put_number_(optla_h5 *file, const char *name, double value);
optla_status optla_h5_get_number_(optla_h5 *file, const char *name, double *value);
optla_status optla_h5_put_text_(optla_h5 *file, const char *name, const char *value);
/* The caller frees *value. */
optla_status optla_h5_get_text_(optla_h5 *file, const char *name, char **value);
/* A dataset or group, or an attribute of the root. */
bool optla_h5_has_(optla_h5 *file, const char *name);
/* Any dataset of up to 8 dimensions; sets type, ndim, dims and data (optla_free) of *out, nothing on failure. */
optla_status optla_h5_get_array_(optla_h5 *file, const char *name, optla_array *out);
/* Where the rows of a 2-D dataset lie in the file, one after the other and as they are in memory, so that it can be mapped.
   OPTLA_ERR_UNSUPPORTED when it is chunked, compressed, compact or kept in another file. */
typedef struct {
	size_t nrows, ncols, offset;
	optla_scalar type;
} optla_h5_place;
optla_status optla_h5_locate_(optla_h5 *file, const char *name, optla_h5_place *out);
/* Name of the only dataset (optla_free); if there are none or several the error lists them. */
optla_status optla_h5_only_name_(optla_h5 *file, char **name);

#endif
