/* SPDX-License-Identifier: BSD-3-Clause */
/* Attributes of HDF5 objects: numbers as doubles, texts as UTF-8 strings of variable length (h5py reads them as str, and a
   long provenance has room). */
#include "io/h5_impl.h"

#include <string.h>

/* ---- writing ---- */

static bool put_attribute(hid_t object, const char *name, hid_t type, const void *value)
{
	const hid_t space = H5Screate(H5S_SCALAR);
	if (space < 0) return false;
	const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
	bool done = attribute >= 0 && H5Awrite(attribute, type, value) >= 0;
	if (attribute >= 0 && H5Aclose(attribute) < 0) done = false;
	H5Sclose(space);
	return done;
}

bool optla_h5_put_string_(hid_t object, const char *name, const char *value)
{
	const hid_t type = H5Tcopy(H5T_C_S1);
	const bool done = type >= 0 && H5Tset_size(type, H5T_VARIABLE) >= 0 && H5Tset_cset(type, H5T_CSET_UTF8) >= 0 &&
	                  put_attribute(object, name, type, &value);
	if (type >= 0) H5Tclose(type);
	return done;
}

optla_status optla_h5_put_text_(optla_h5 *file, const char *name, const char *value)
{
	optla_h5_guard guard;
	optla_h5_enter_(file, &guard);
	const optla_status status = optla_h5_put_string_(file->file, name, value) && !file->write_error
	                                ? OPTLA_OK
	                                : optla_h5_fail_(file, name, "can't be written");
	optla_h5_leave_(&guard);
	return status;
}

optla_status optla_h5_put_number_(optla_h5 *file, const char *name, double value)
{
	optla_h5_guard guard;
	optla_h5_enter_(file, &guard);
	const optla_status status = put_attribute(file->file, name, H5T_NATIVE_DOUBLE, &value) && !file->write_error
	                                ? OPTLA_OK
	                                : optla_h5_fail_(file, name, "can't be written");
	optla_h5_leave_(&guard);
	return status;
}

/* ---- reading ---- */

/* Opens the root's attribute and its type when it holds exactly one value. The caller closes what isn't negative. */
static optla_status open_one(const optla_h5 *file, const char *name, hid_t *attribute, hid_t *type)
{
	*attribute = *type = H5I_INVALID_HID;
	if (H5Aexists(file->file, name) <= 0)
		return OPTLA_FAIL(file->ctx, OPTLA_ERR_INPUT, "%s: the attribute '%s' is missing", file->path, name);
	*attribute = H5Aopen(file->file, name, H5P_DEFAULT);
	*type = *attribute >= 0 ? H5Aget_type(*attribute) : H5I_INVALID_HID;
	const hid_t space = *attribute >= 0 ? H5Aget_space(*attribute) : H5I_INVALID_HID;
	const hssize_t count = space >= 0 ? H5Sget_simple_extent_npoints(space) : -1;
	optla_status status = OPTLA_OK;
	if (*type < 0 || count < 0)
		status = optla_h5_fail_(file, name, "the attribute can't be read");
	else if (1 != count)
		status = OPTLA_FAIL(file->ctx, OPTLA_ERR_INPUT, "%s: the attribute '%s' holds %lld values, one is needed", file->path,
		                    name, (long long)count);
	if (space >= 0) H5Sclose(space);
	return status;
}

optla_status optla_h5_get_number_(optla_h5 *file, const char *name, double *value)
{
	optla_h5_guard guard;
	optla_h5_enter_(file, &guard);
	hid_t attribute, type;
	optla_status status = open_one(file, name, &attribute, &type);
	if (OPTLA_OK == status) {
		const H5T_class_t class = H5Tget_class(type);
		double read;
		if (H5T_FLOAT != class && H5T_INTEGER != class)
			status = OPTLA_FAIL(file->ctx, OPTLA_ERR_INPUT, "%s: the attribute '%s' is not a number", file->path, name);
		else if (H5Aread(attribute, H5T_NATIVE_DOUBLE, &read) < 0)
			status = optla_h5_fail_(file, name, "the attribute can't be read");
		else
			*value = read;
	}
	if (type >= 0) H5Tclose(type);
	if (attribute >= 0) H5Aclose(attribute);
	optla_h5_leave_(&guard);
	return status;
}

static optla_status read_variable(const optla_h5 *file, const char *name, hid_t attribute, hid_t type, char **value)
{
	char *text = NULL;
	if (H5Aread(attribute, type, &text) < 0) return optla_h5_fail_(file, name, "the attribute can't be read");
	*value = optla_strdup_(file->ctx, text ? text : "");
	H5free_memory(text);
	return *value ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

static optla_status read_fixed(const optla_h5 *file, const char *name, hid_t attribute, hid_t type, char **value)
{
	size_t size = H5Tget_size(type);
	char *text = optla_alloc_(file->ctx, size + 1);
	if (!text) return OPTLA_ERR_NOMEM;
	if (H5Aread(attribute, type, text) < 0) {
		optla_free(file->ctx, text);
		return optla_h5_fail_(file, name, "the attribute can't be read");
	}
	if (H5T_STR_SPACEPAD == H5Tget_strpad(type))
		while (size && ' ' == text[size - 1]) size--;
	text[size] = 0;
	*value = text;
	return OPTLA_OK;
}

optla_status optla_h5_get_text_(optla_h5 *file, const char *name, char **value)
{
	*value = NULL;
	optla_h5_guard guard;
	optla_h5_enter_(file, &guard);
	hid_t attribute, type;
	optla_status status = open_one(file, name, &attribute, &type);
	if (OPTLA_OK == status) {
		if (H5T_STRING != H5Tget_class(type))
			status = OPTLA_FAIL(file->ctx, OPTLA_ERR_INPUT, "%s: the attribute '%s' is not a text", file->path, name);
		else if (H5Tis_variable_str(type) > 0)
			status = read_variable(file, name, attribute, type, value);
		else
			status = read_fixed(file, name, attribute, type, value);
	}
	if (type >= 0) H5Tclose(type);
	if (attribute >= 0) H5Aclose(attribute);
	optla_h5_leave_(&guard);
	return status;
}
