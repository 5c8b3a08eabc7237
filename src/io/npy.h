/* SPDX-License-Identifier: BSD-3-Clause */
/* NumPy's array file: NEP 1, "A simple file format for NumPy arrays", versions 1.0 to 3.0. */
#ifndef OPTLA_NPY_H
#define OPTLA_NPY_H

#include "base/base_impl.h"
#include "optla/image.h"

enum { OPTLA_NPY_DIMS = 8 };

typedef struct {
	char kind; /* as in NumPy's type strings: f, c, u, i, b (bool) */
	size_t item_bytes;
	bool big_endian;
	bool fortran_order; /* the first index runs fastest */
	size_t ndims, shape[OPTLA_NPY_DIMS];
	size_t count;       /* product of shape: 1 for a scalar; count * item_bytes fits in size_t */
	size_t data_offset; /* of the first item, from the start of the file */
} optla_npy_header;

/* Reads the header at the start of the first nbytes of a file. Whether the data behind it is all there is the caller's to check.
   name: of the file, for messages. OPTLA_ERR_INPUT; OPTLA_ERR_UNSUPPORTED for types and dimensions beyond the above. */
optla_status optla_npy_header_parse_(optla_ctx *ctx, const char *name, const void *bytes, size_t nbytes, optla_npy_header *out);

/* The array of a whole .npy file in memory, converted as optla_array says, in C order. Sets type, ndim, dims and data (optla_free) of
   *out, nothing on failure. OPTLA_ERR_INPUT also when data are missing; bytes after the data are ignored, as NumPy does. */
optla_status optla_npy_decode_(optla_ctx *ctx, const char *name, const void *bytes, size_t nbytes, optla_array *out);

enum { OPTLA_NPY_HEADER_BYTES = 320 };
/* Header of a version 1.0 file for this array; the array's data follow it. Returns its length, a multiple of 64 (NumPy maps
   such files with aligned data). */
size_t optla_npy_header_make_(const optla_array *array, char header[OPTLA_NPY_HEADER_BYTES]);

#endif
