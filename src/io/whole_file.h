/* SPDX-License-Identifier: BSD-3-Clause */
/* Reading a file at once; writing one whole or not at all (temporary name, flush, rename). */
#ifndef OPTLA_WHOLE_FILE_H
#define OPTLA_WHOLE_FILE_H

#include "base/base_impl.h"

/* Bytes of a regular file (one zero byte after them that count does not include); OPTLA_ERR_INPUT if it doesn't exist, is a
   directory, pipe or device, OPTLA_ERR_NOMEM over the memory limit, OPTLA_ERR_IO when it can't be read. Notes the file as an
   input. */
optla_status optla_read_file_(optla_ctx *ctx, const char *path, void **bytes, size_t *count);
/* The same without noting it: for our own outputs that are read to be written anew (pages). */
optla_status optla_read_output_(optla_ctx *ctx, const char *path, void **bytes, size_t *count);
/* The errors of optla_read_file_ without reading, for libraries that open the file themselves. */
optla_status optla_check_readable_(optla_ctx *ctx, const char *path);
/* Whole or not at all; OPTLA_ERR_IO names the path and the reason (disk full, permission). What stands at path must be a regular
   file or nothing; a symbolic link is replaced. */
optla_status optla_write_file_(optla_ctx *ctx, const char *path, const void *bytes, size_t count);
/* The same for several pieces that follow each other. */
typedef struct {
	const void *bytes;
	size_t count;
} optla_piece;
optla_status optla_write_pieces_(optla_ctx *ctx, const char *path, const optla_piece *pieces, size_t count);
/* An empty temporary file beside path, for writers that need a name. finish: sync + rename (commit) or remove; frees and clears
   *temporary (NULL: nothing to do). */
optla_status optla_temporary_begin_(optla_ctx *ctx, const char *path, char **temporary);
optla_status optla_temporary_finish_(optla_ctx *ctx, const char *path, char **temporary, bool commit);
/* "dir/name" joined; absolute name: name alone. NULL on failure. */
char *optla_path_join_(optla_ctx *ctx, const char *dir, const char *name);
/* Directory part of path ("." if none). NULL on failure. */
char *optla_path_dir_(optla_ctx *ctx, const char *path);
/* Splits "file.h5:member" where the part before a colon exists; a file whose own name has colons is taken as it is. The caller
   frees *file; *member points into path, NULL if there is none. */
optla_status optla_split_member_(optla_ctx *ctx, const char *path, char **file, const char **member);
bool optla_path_exists_(const char *path);
/* mkdir -p */
optla_status optla_make_dirs_(optla_ctx *ctx, const char *path);
/* Text of an errno value, a full disk named as such. Returns buffer. */
const char *optla_errno_text_(int error, char *buffer, size_t bytes);

#endif
