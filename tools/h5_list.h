/* SPDX-License-Identifier: BSD-3-Clause */
/* What is in an HDF5 file, ours or anybody's. */
#ifndef OPTLA_H5_LIST_H
#define OPTLA_H5_LIST_H

#include "cli.h"

typedef struct {
	char *name, *unit, *help; /* unit, help: NULL when the dataset has no such attribute */
	char type[32];            /* "float32", "uint32", "complex64", ... */
	int ndim;
	unsigned long long dims[8];
} cli_h5_dataset;

typedef struct {
	char *name, *text; /* text of a string; NULL for a number */
	double number;
} cli_h5_attribute;

typedef struct {
	cli_h5_dataset *datasets;
	cli_h5_attribute *attributes; /* of the root */
	size_t ndatasets, nattributes;
} cli_h5_list;

/* @return OPTLA_ERR_INPUT for a file that isn't HDF5 or is damaged. Free with cli_h5_list_clear() in any case. */
optla_status cli_h5_read_list(const cli_run *run, const char *path, cli_h5_list *list);
void cli_h5_list_clear(cli_h5_list *list);
/* Root attribute by name, NULL if absent. */
const cli_h5_attribute *cli_h5_find_attribute(const cli_h5_list *list, const char *name);

#endif
