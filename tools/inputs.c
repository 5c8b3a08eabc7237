/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files named on the command line are. */
#include "inputs.h"

#include "base/base_impl.h"
#include "io/whole_file.h"

#include <stdlib.h>
#include <string.h>

/* Length of the file's part of "file.h5:name"; the whole length when there is no name. */
static size_t file_part(const char *path)
{
	const char *colon = strrchr(path, ':');
	return colon && !optla_path_exists_(path) ? (size_t)(colon - path) : strlen(path);
}

optla_status cli_input_of(const cli_run *run, const char *path, cli_input *input)
{
	const size_t n = file_part(path);
	char *file = strndup(path, n);
	if (!file) return cli_fail(run, OPTLA_ERR_NOMEM, "no memory");
	optla_file_type type = OPTLA_FILE_UNKNOWN;
	optla_status status = optla_file_type_of(run->ctx, file, &type);
	if (!status) switch (type) {
		case OPTLA_FILE_PNG:
		case OPTLA_FILE_TIFF:
		case OPTLA_FILE_EXR:
		case OPTLA_FILE_PFM:
		case OPTLA_FILE_RAW: *input = CLI_INPUT_IMAGE; break;
		case OPTLA_FILE_NPY: *input = CLI_INPUT_NPY; break;
		case OPTLA_FILE_NPZ: *input = CLI_INPUT_ARRAY; break;
		case OPTLA_FILE_HDF5: *input = path[n] ? CLI_INPUT_ARRAY : CLI_INPUT_HDF5; break;
		case OPTLA_FILE_YAML: *input = CLI_INPUT_YAML; break;
		case OPTLA_FILE_UNKNOWN:
			status = cli_fail(
			    run, OPTLA_ERR_INPUT,
			    "%s: neither an image (PNG, TIFF, EXR, PFM, camera RAW), an array (NPY, NPZ), HDF5 nor a YAML rig file", file);
			break;
		}
	free(file);
	return status;
}

const char *cli_input_name(cli_input input)
{
	switch (input) {
	case CLI_INPUT_IMAGE: return "an image";
	case CLI_INPUT_NPY:
	case CLI_INPUT_ARRAY: return "an array";
	case CLI_INPUT_HDF5: return "an HDF5 file";
	case CLI_INPUT_YAML: return "a rig file";
	}
	return "?";
}

void cli_array_size(const optla_array *array, char *text, size_t bytes)
{
	size_t used = 0;
	snprintf(text, bytes, "one number");
	for (size_t k = 0; k < array->ndim && used < bytes; k++)
		used += (size_t)snprintf(text + used, bytes - used, "%s%zu", k ? " x " : "", array->dims[k]);
}

optla_status cli_open_rig(const cli_run *run, const char *path, optla_rig **rig)
{
	const optla_rig_open_options options = {.size = sizeof options, .data_dir = run->shared.data};
	return optla_rig_open(run->ctx, path, &options, rig);
}

double cli_get(const void *vector, optla_scalar type, size_t k)
{
	return type == OPTLA_F32 ? (double)((const float *)vector)[k] : ((const double *)vector)[k];
}

void cli_set(void *vector, optla_scalar type, size_t k, double value)
{
	if (type == OPTLA_F32)
		((float *)vector)[k] = (float)value;
	else
		((double *)vector)[k] = value;
}

optla_status cli_load_linear(const cli_run *run, const char *path, optla_image **image)
{
	*image = NULL;
	OPTLA_TRY(optla_image_load(run->ctx, path, image));
	optla_status status = OPTLA_OK;
	if ((*image)->kind == OPTLA_IMAGE_DISPLAY) {
		optla_log_(run->ctx, 1, "%s is for looking at: its sRGB curve is taken off", path);
		status = optla_image_display_to_linear(*image);
	} else if ((*image)->kind == OPTLA_IMAGE_RAW_DN) {
		status = cli_fail(
		    run, OPTLA_ERR_INPUT,
		    "%s holds raw counts, whose black level and scale aren't known here: give a linear image (.exr, .pfm, .npy)", path);
	}
	if (status) optla_image_destroy(image);
	return status;
}
