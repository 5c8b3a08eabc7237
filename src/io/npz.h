/* SPDX-License-Identifier: BSD-3-Clause */
/* .npz: a ZIP archive of .npy files. */
#ifndef OPTLA_NPZ_H
#define OPTLA_NPZ_H

#include "base/base_impl.h"
#include "optla/image.h"

/* The array of the member called member or member.npy (NULL: of the only one) of a .npz file in memory; as optla_npy_decode_. */
optla_status optla_npz_decode_(optla_ctx *ctx, const char *name, const void *bytes, size_t nbytes, const char *member,
                               optla_array *out);
/* Writes a .npz file with one array, not compressed, as numpy.savez does. Whole or not at all. */
optla_status optla_npz_save_(const optla_array *array, const char *path, const char *member);

#endif
