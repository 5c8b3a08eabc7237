/* SPDX-License-Identifier: BSD-3-Clause */
/* Where the numbers of an HDF5 dataset lie in its file, for those who map it. */
#include "io/h5_impl.h"

static bool is_part(hid_t pair, unsigned index, char initial, size_t offset, hid_t number)
{
	char *name = H5Tget_member_name(pair, index);
	const hid_t type = H5Tget_member_type(pair, index);
	const bool same = name && (name[0] | 0x20) == initial && type >= 0 && H5Tequal(type, number) > 0 &&
	                  H5Tget_member_offset(pair, index) == offset;
	if (type >= 0) H5Tclose(type);
	if (name) H5free_memory(name);
	return same;
}

/* The scalar type that these bytes are in memory as they stand. */
static bool scalar_of(hid_t type, optla_scalar *scalar)
{
	static const optla_scalar real[] = {OPTLA_F32, OPTLA_F64}, pair[] = {OPTLA_C32, OPTLA_C64};
	const hid_t number[] = {H5T_NATIVE_FLOAT, H5T_NATIVE_DOUBLE};
	for (size_t k = 0; k < 2; k++) {
		const size_t bytes = optla_scalar_bytes(real[k]);
		*scalar = real[k];
		if (H5Tequal(type, number[k]) > 0) return true;
		*scalar = pair[k];
		if (H5Tget_class(type) == H5T_COMPOUND && H5Tget_nmembers(type) == 2 && H5Tget_size(type) == 2 * bytes &&
		    is_part(type, 0, 'r', 0, number[k]) && is_part(type, 1, 'i', bytes, number[k]))
			return true;
	}
	return false;
}

static optla_status understand(const optla_h5 *f, const char *name, hid_t dataset, hid_t space, hid_t type, hid_t create,
                               optla_h5_place *out)
{
	hsize_t dims[2] = {0, 0};
	const int rank = H5Sget_simple_extent_ndims(space);
	if (rank == 2) H5Sget_simple_extent_dims(space, dims, NULL);
	OPTLA_CHECK(f->ctx, rank == 2, OPTLA_ERR_INPUT, "%s: a matrix has 2 dimensions, '%s' has %d", f->path, name, rank);
	OPTLA_CHECK(f->ctx, scalar_of(type, &out->type), OPTLA_ERR_INPUT,
	            "%s: the numbers of '%s' can't be mapped; allowed are float, double and compounds {r, i} of two of them, in the "
	            "machine's "
	            "byte order",
	            f->path, name);
	OPTLA_CHECK(
	    f->ctx, H5Pget_layout(create) == H5D_CONTIGUOUS && H5Pget_external_count(create) == 0, OPTLA_ERR_UNSUPPORTED,
	    "%s: '%s' is stored in chunks, compressed, compact or elsewhere; a mapped matrix must be contiguous (h5repack -l CONTI)",
	    f->path, name);
	const haddr_t offset = H5Dget_offset(dataset);
	OPTLA_CHECK(f->ctx, offset != HADDR_UNDEF, OPTLA_ERR_INPUT, "%s: '%s' was never written", f->path, name);
	out->nrows = (size_t)dims[0];
	out->ncols = (size_t)dims[1];
	out->offset = (size_t)offset;
	return OPTLA_OK;
}

optla_status optla_h5_locate_(optla_h5 *file, const char *name, optla_h5_place *out)
{
	optla_h5_guard guard;
	optla_h5_enter_(file, &guard);
	const hid_t dataset = H5Dopen2(file->file, name, H5P_DEFAULT);
	const bool found = dataset >= 0;
	const hid_t space = found ? H5Dget_space(dataset) : -1, type = found ? H5Dget_type(dataset) : -1;
	const hid_t create = found ? H5Dget_create_plist(dataset) : -1;
	const optla_status status = space >= 0 && type >= 0 && create >= 0 ? understand(file, name, dataset, space, type, create, out)
	                                                                   : optla_h5_fail_(file, name, "no dataset to be mapped");
	if (create >= 0) H5Pclose(create);
	if (type >= 0) H5Tclose(type);
	if (space >= 0) H5Sclose(space);
	if (found) H5Dclose(dataset);
	optla_h5_leave_(&guard);
	return status;
}
