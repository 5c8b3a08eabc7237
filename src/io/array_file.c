/* SPDX-License-Identifier: BSD-3-Clause */
/* Arrays in files: .npy, .npz and HDF5, found from the content; "file:member" names one of several. */
#include "io/file_type.h"
#include "io/h5.h"
#include "io/npy.h"
#include "io/npz.h"
#include "io/whole_file.h"

#include <string.h>

void optla_array_destroy(optla_array **array)
{
	if (!array || !*array) return;
	optla_free((*array)->ctx, (*array)->data);
	optla_free((*array)->ctx, *array);
	*array = NULL;
}

static optla_status make(optla_ctx *ctx, optla_array **out)
{
	*out = optla_calloc_(ctx, 1, sizeof **out);
	if (*out) (*out)->ctx = ctx;
	return *out ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

/* ---- reading ---- */

static optla_status read_h5(optla_h5 *file, const char *member, optla_array *array)
{
	char *only = NULL;
	if (!member) OPTLA_TRY(optla_h5_only_name_(file, &only));
	const optla_status status = optla_h5_get_array_(file, member ? member : only, array);
	optla_free(array->ctx, only);
	return status;
}

static optla_status decode_h5(optla_ctx *ctx, const void *bytes, size_t count, const char *name, const char *member,
                              optla_array *array)
{
	optla_h5 *file;
	OPTLA_TRY(optla_h5_open_bytes_(ctx, bytes, count, name, &file));
	const optla_status status = read_h5(file, member, array);
	optla_h5_close_(&file);
	return status;
}

static optla_status decode(optla_ctx *ctx, const void *bytes, size_t count, const char *name, const char *member,
                           optla_array *array)
{
	switch (optla_file_type_of_bytes_(bytes, count)) {
	case OPTLA_FILE_NPY:
		OPTLA_CHECK(ctx, !member, OPTLA_ERR_INPUT, "%s: is a .npy file and has no member '%s'", name, member);
		return optla_npy_decode_(ctx, name, bytes, count, array);
	case OPTLA_FILE_NPZ: return optla_npz_decode_(ctx, name, bytes, count, member, array);
	case OPTLA_FILE_HDF5: return decode_h5(ctx, bytes, count, name, member, array);
	default: return OPTLA_FAIL(ctx, OPTLA_ERR_INPUT, "%s: is neither a .npy, a .npz nor an HDF5 file", name);
	}
}

optla_status optla_array_decode(optla_ctx *ctx, const void *bytes, size_t count, const char *name, const char *member,
                                optla_array **out)
{
	OPTLA_TRY(make(ctx, out));
	const optla_status status = decode(ctx, bytes, count, name, member, *out);
	if (OPTLA_OK != status) optla_array_destroy(out);
	return status;
}

/* HDF5 files are not read whole: one dataset of many may be wanted. */
static optla_status load(optla_ctx *ctx, const char *file, const char *member, optla_array *array)
{
	optla_file_type type;
	OPTLA_TRY(optla_file_type_of(ctx, file, &type));
	if (OPTLA_FILE_HDF5 == type) {
		optla_h5 *h5;
		OPTLA_TRY(optla_h5_open_(ctx, file, NULL, &h5));
		const optla_status status = read_h5(h5, member, array);
		optla_h5_close_(&h5);
		return status;
	}
	void *bytes;
	size_t count;
	OPTLA_TRY(optla_read_file_(ctx, file, &bytes, &count));
	const optla_status status = decode(ctx, bytes, count, file, member, array);
	optla_free(ctx, bytes);
	return status;
}

optla_status optla_array_load(optla_ctx *ctx, const char *path, optla_array **out)
{
	*out = NULL;
	char *file;
	const char *member;
	OPTLA_TRY(optla_split_member_(ctx, path, &file, &member));
	optla_status status = make(ctx, out);
	if (OPTLA_OK == status) status = load(ctx, file, member, *out);
	if (OPTLA_OK != status) optla_array_destroy(out);
	optla_free(ctx, file);
	return status;
}

/* ---- writing ---- */

static bool ends_with(const char *text, size_t length, const char *ending)
{
	const size_t n = strlen(ending);
	return length > n && !memcmp(text + length - n, ending, n);
}

static optla_status check(const optla_array *array, const char *path, size_t *bytes)
{
	OPTLA_CHECK(array->ctx, array->ndim <= OPTLA_NPY_DIMS && optla_scalar_bytes(array->type), OPTLA_ERR_ARG,
	            "%s: an array of %zu dimensions and scalar type %d can't be written", path, array->ndim, (int)array->type);
	*bytes = optla_scalar_bytes(array->type);
	for (size_t k = 0; k < array->ndim; k++)
		OPTLA_CHECK(array->ctx, optla_size_mul_(*bytes, array->dims[k], bytes), OPTLA_ERR_ARG,
		            "%s: the array's shape is beyond the address space", path);
	OPTLA_CHECK(array->ctx, array->data || 0 == *bytes, OPTLA_ERR_ARG, "%s: the array has no data", path);
	return OPTLA_OK;
}

static optla_status save_npz(const optla_array *array, const char *path, size_t length, const char *member)
{
	char *file = optla_format_(array->ctx, "%.*s", (int)length, path);
	if (!file) return OPTLA_ERR_NOMEM;
	const optla_status status = optla_npz_save_(array, file, member);
	optla_free(array->ctx, file);
	return status;
}

optla_status optla_array_save(const optla_array *array, const char *path)
{
	size_t bytes;
	OPTLA_TRY(check(array, path, &bytes));
	const size_t n = strlen(path);
	if (ends_with(path, n, ".npy")) {
		char header[OPTLA_NPY_HEADER_BYTES];
		const optla_piece pieces[2] = {{header, optla_npy_header_make_(array, header)}, {array->data, bytes}};
		return optla_write_pieces_(array->ctx, path, pieces, 2);
	}
	const char *colon = strrchr(path, ':');
	if (colon && colon[1] && ends_with(path, (size_t)(colon - path), ".npz"))
		return save_npz(array, path, (size_t)(colon - path), colon + 1);
	if (ends_with(path, n, ".npz")) return save_npz(array, path, n, "arr_0"); /* NumPy's name for an array without one */
	return OPTLA_FAIL(array->ctx, OPTLA_ERR_ARG, "%s: an array can be written as FILE.npy, FILE.npz or FILE.npz:NAME", path);
}
