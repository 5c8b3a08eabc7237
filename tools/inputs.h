/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files named on the command line are. */
#ifndef OPTLA_INPUTS_H
#define OPTLA_INPUTS_H

#include "cli.h"

#include "optla/image.h"
#include "optla/rig.h"

typedef enum {
	CLI_INPUT_IMAGE, /* PNG, TIFF, EXR, PFM, camera RAW */
	CLI_INPUT_NPY,   /* image or array */
	CLI_INPUT_ARRAY, /* .npz, or one dataset: "file.h5:name" */
	CLI_INPUT_HDF5,
	CLI_INPUT_YAML
} cli_input;

/* @return OPTLA_ERR_INPUT for a file that is missing or of no known type. */
optla_status cli_input_of(const cli_run *run, const char *path, cli_input *input);
const char *cli_input_name(cli_input input);
/* "84708 x 96" */
void cli_array_size(const optla_array *array, char *text, size_t bytes);
/* Reads an image whose values are to be computed with: LINEAR as it is, DISPLAY is linearised, RAW_DN is an error that says what to do. */
optla_status cli_load_linear(const cli_run *run, const char *path, optla_image **image);
/* Values of a vector of a real scalar type. */
double cli_get(const void *vector, optla_scalar type, size_t k);
void cli_set(void *vector, optla_scalar type, size_t k, double value);
/* Opens a rig file with --data. */
optla_status cli_open_rig(const cli_run *run, const char *path, optla_rig **rig);

#endif
