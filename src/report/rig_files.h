/* SPDX-License-Identifier: BSD-3-Clause */
/* Rig files of examples/rigs that the library carries (rig_files.c is made from them by embed.py). */
#ifndef OPTLA_RIG_FILES_H
#define OPTLA_RIG_FILES_H

#include <stddef.h>

typedef struct {
	const char *name;
	const unsigned char *bytes;
	size_t count;
} optla_rig_file;

extern const optla_rig_file optla_rig_file_ball_, optla_rig_file_screen_;

#endif
