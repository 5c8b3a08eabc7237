/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists the datasets and root attributes of an HDF5 file. */
#include "h5_list.h"

#include <hdf5.h>
#include <stdlib.h>
#include <string.h>

static void type_name(hid_t type, char *text, size_t bytes)
{
	const size_t bits = 8 * H5Tget_size(type);
	switch (H5Tget_class(type)) {
	case H5T_FLOAT: snprintf(text, bytes, "float%zu", bits); break;
	case H5T_INTEGER: snprintf(text, bytes, "%sint%zu", H5Tget_sign(type) == H5T_SGN_NONE ? "u" : "", bits); break;
	case H5T_COMPOUND: snprintf(text, bytes, H5Tget_nmembers(type) == 2 ? "complex%zu" : "compound%zu", bits); break;
	case H5T_STRING: snprintf(text, bytes, "text"); break;
	default: snprintf(text, bytes, "other"); break;
	}
}

/* A string attribute (fixed or variable length) as our own copy, NULL if it is none. */
static char *attribute_text(hid_t attribute)
{
	const hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
	char *copy = NULL;
	if (H5Tget_class(type) == H5T_STRING && H5Sget_simple_extent_npoints(space) == 1) {
		if (H5Tis_variable_str(type) > 0) {
			char *text = NULL;
			if (H5Aread(attribute, type, &text) >= 0 && text) {
				copy = strdup(text);
				H5free_memory(text);
			}
		} else {
			const size_t n = H5Tget_size(type);
			copy = n < 1u << 20 ? calloc(n + 1, 1) : NULL;
			if (copy && H5Aread(attribute, type, copy) < 0) {
				free(copy);
				copy = NULL;
			}
		}
	}
	H5Sclose(space);
	H5Tclose(type);
	return copy;
}

static char *named_text(hid_t object, const char *name)
{
	if (H5Aexists(object, name) <= 0) return NULL;
	const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
	if (attribute < 0) return NULL;
	char *text = attribute_text(attribute);
	H5Aclose(attribute);
	return text;
}

static herr_t take_dataset(hid_t root, const char *name, const H5O_info_t *info, void *user)
{
	cli_h5_list *list = user;
	if (info->type != H5O_TYPE_DATASET) return 0;
	cli_h5_dataset *grown = realloc(list->datasets, (list->ndatasets + 1) * sizeof *grown);
	if (!grown) return -1;
	list->datasets = grown;
	cli_h5_dataset *d = &grown[list->ndatasets];
	*d = (cli_h5_dataset){.name = strdup(name)};
	list->ndatasets++;
	const hid_t set = H5Dopen2(root, name, H5P_DEFAULT);
	if (set < 0 || !d->name) return -1;
	const hid_t type = H5Dget_type(set), space = H5Dget_space(set);
	type_name(type, d->type, sizeof d->type);
	hsize_t dims[H5S_MAX_RANK];
	d->ndim = H5Sget_simple_extent_dims(space, dims, NULL);
	for (int k = 0; k < d->ndim && k < 8; k++) d->dims[k] = dims[k];
	d->unit = named_text(set, "unit");
	d->help = named_text(set, "description");
	H5Sclose(space);
	H5Tclose(type);
	H5Dclose(set);
	return d->ndim < 0 ? -1 : 0;
}

static herr_t take_attribute(hid_t root, const char *name, const H5A_info_t *info, void *user)
{
	(void)info;
	cli_h5_list *list = user;
	cli_h5_attribute *grown = realloc(list->attributes, (list->nattributes + 1) * sizeof *grown);
	if (!grown) return -1;
	list->attributes = grown;
	const hid_t attribute = H5Aopen(root, name, H5P_DEFAULT);
	if (attribute < 0) return 0;
	cli_h5_attribute a = {.name = strdup(name), .text = attribute_text(attribute)};
	const hid_t space = H5Aget_space(attribute);
	const bool one = H5Sget_simple_extent_npoints(space) == 1;
	if (a.name && (a.text || (one && H5Aread(attribute, H5T_NATIVE_DOUBLE, &a.number) >= 0))) {
		grown[list->nattributes++] = a;
	} else {
		free(a.name);
		free(a.text);
	}
	H5Sclose(space);
	H5Aclose(attribute);
	return 0;
}

optla_status cli_h5_read_list(const cli_run *run, const char *path, cli_h5_list *list)
{
	*list = (cli_h5_list){0};
	H5Eset_auto2(H5E_DEFAULT, NULL, NULL); /* our own message names the file, the library's stack of errors does not */
	const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
	if (file < 0) return cli_fail(run, OPTLA_ERR_INPUT, "%s: not an HDF5 file, or a damaged one", path);
	const bool good = H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, take_dataset, list, H5O_INFO_BASIC) >= 0 &&
	                  H5Aiterate2(file, H5_INDEX_NAME, H5_ITER_INC, NULL, take_attribute, list) >= 0;
	H5Fclose(file);
	return good ? OPTLA_OK : cli_fail(run, OPTLA_ERR_INPUT, "%s: a damaged HDF5 file: its table of contents can't be read", path);
}

void cli_h5_list_clear(cli_h5_list *list)
{
	for (size_t k = 0; k < list->ndatasets; k++) {
		free(list->datasets[k].name);
		free(list->datasets[k].unit);
		free(list->datasets[k].help);
	}
	for (size_t k = 0; k < list->nattributes; k++) {
		free(list->attributes[k].name);
		free(list->attributes[k].text);
	}
	free(list->datasets);
	free(list->attributes);
	*list = (cli_h5_list){0};
}

const cli_h5_attribute *cli_h5_find_attribute(const cli_h5_list *list, const char *name)
{
	for (size_t k = 0; k < list->nattributes; k++)
		if (!strcmp(list->attributes[k].name, name)) return &list->attributes[k];
	return NULL;
}
