/* SPDX-License-Identifier: BSD-3-Clause */
/* What a file is, from its content. */
#ifndef OPTLA_FILE_TYPE_H
#define OPTLA_FILE_TYPE_H

#include "base/base_impl.h"
#include "optla/image.h"

/* The type of count bytes in memory. Never reads outside them. */
optla_file_type optla_file_type_of_bytes_(const void *bytes, size_t count);

#endif
