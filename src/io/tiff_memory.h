/* SPDX-License-Identifier: BSD-3-Clause */
/* A TIFF that lives in memory, and libtiff's messages without its global handlers. */
#ifndef OPTLA_TIFF_MEMORY_H
#define OPTLA_TIFF_MEMORY_H

#include "io/image_codec.h"

#include <tiffio.h>

typedef struct {
	optla_ctx *ctx;
	const char *name; /* of the file, for messages */
	/* Reading: data and count. Writing: file, and data is NULL. */
	const uint8_t *data;
	size_t count, at;
	optla_memory_file *file;
	bool cut;          /* bytes behind the end were asked for: a file that was cut off */
	char message[512]; /* what libtiff said first */
} optla_tiff_memory;

/* mode as for TIFFOpen. NULL: read memory->message. */
TIFF *optla_tiff_open_(optla_tiff_memory *memory, const char *mode);

#endif
