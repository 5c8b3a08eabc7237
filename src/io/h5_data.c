/* SPDX-License-Identifier: BSD-3-Clause */
/* Datasets of HDF5 files: contiguous and in the machine's byte order when written (so that they can be memory mapped), any
   integers, floats, booleans and complex compounds when read. */
#include "io/h5_impl.h"

#include <ctype.h>
#include <string.h>

enum { MAX_RANK = 8, LIST_BYTES = 600 };

hid_t optla_h5_memory_type_(optla_scalar type, const char *re, const char *im)
{
	const bool single = OPTLA_F32 == type || OPTLA_C32 == type;
	const hid_t part = single ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE;
	if (OPTLA_F32 == type || OPTLA_F64 == type) return H5Tcopy(part);
	const size_t bytes = single ? sizeof(float) : sizeof(double);
	const hid_t pair = H5Tcreate(H5T_COMPOUND, 2 * bytes);
	if (pair < 0 || (H5Tinsert(pair, re, 0, part) >= 0 && H5Tinsert(pair, im, bytes, part) >= 0)) return pair;
	H5Tclose(pair);
	return H5I_INVALID_HID;
}

/* ---- writing ---- */

typedef struct {
	const char *name;
	hid_t type; /* in memory and in the file */
	int rank;
	hsize_t dims[2], memory[2]; /* memory: extent of the array that dims is the first part of */
	const void *data;
	const char *unit, *help; /* NULL: left out */
} new_dataset;

static bool write_values(hid_t dataset, const new_dataset *d)
{
	static const hsize_t origin[2] = {0, 0};
	const hid_t space = H5Screate_simple(d->rank, d->memory, NULL);
	const bool done = space >= 0 && H5Sselect_hyperslab(space, H5S_SELECT_SET, origin, NULL, d->dims, NULL) >= 0 &&
	                  H5Dwrite(dataset, d->type, space, H5S_ALL, H5P_DEFAULT, d->data) >= 0;
	if (space >= 0) H5Sclose(space);
	return done;
}

static bool put_dataset(hid_t file, const new_dataset *d)
{
	const hid_t space = H5Screate_simple(d->rank, d->dims, NULL), create = H5Pcreate(H5P_DATASET_CREATE);
	hid_t dataset = H5I_INVALID_HID;
	if (space >= 0 && create >= 0 && H5Pset_layout(create, H5D_CONTIGUOUS) >= 0 && H5Pset_obj_track_times(create, false) >= 0)
		dataset = H5Dcreate2(file, d->name, d->type, space, H5P_DEFAULT, create, H5P_DEFAULT);
	bool done = dataset >= 0;
	if (done && d->dims[0] && (d->rank < 2 || d->dims[1])) done = write_values(dataset, d);
	if (done && d->unit) done = optla_h5_put_string_(dataset, "unit", d->unit);
	if (done && d->help) done = optla_h5_put_string_(dataset, "description", d->help);
	if (dataset >= 0 && H5Dclose(dataset) < 0) done = false;
	if (create >= 0) H5Pclose(create);
	if (space >= 0) H5Sclose(space);
	return done;
}

optla_status optla_h5_put_(optla_h5 *file, const char *name, optla_cblock block, const char *unit, const char *help)
{
	optla_h5_guard guard;
	optla_h5_enter_(file, &guard);
	const hid_t type = optla_h5_memory_type_(block.type, "r", "i");
	const new_dataset d = {.name = name,
	                       .type = type,
	                       .rank = 2,
	                       .dims = {block.ncols, block.nrows},
	                       .memory = {block.ncols, optla_max_(block.ld, block.nrows)},
	                       .data = block.data,
	                       .unit = unit,
	                       .help = help};
	const optla_status status = type >= 0 && put_dataset(file->file, &d) && !file->write_error
	                                ? OPTLA_OK
	                                : optla_h5_fail_(file, name, "can't be written");
	if (type >= 0) H5Tclose(type);
	optla_h5_leave_(&guard);
	return status;
}

optla_status optla_h5_put_u32_(optla_h5 *file, const char *name, const uint32_t *values, size_t count, const char *help)
{
	optla_h5_guard guard;
	optla_h5_enter_(file, &guard);
	const new_dataset d = {
	    .name = name, .type = H5T_NATIVE_UINT32, .rank = 1, .dims = {count}, .memory = {count}, .data = values, .help = help};
	const optla_status status =
	    put_dataset(file->file, &d) && !file->write_error ? OPTLA_OK : optla_h5_fail_(file, name, "can't be written");
	optla_h5_leave_(&guard);
	return status;
}

/* ---- reading ---- */

typedef struct {
	hid_t dataset, type, space, create;
	size_t rank, dims[MAX_RANK], count;
	bool complex, boolean;
	optla_scalar natural; /* the scalar that holds the values */
	char re[32], im[32];  /* names of the two parts */
} open_dataset;

static void close_dataset(open_dataset *d)
{
	if (d->create >= 0) H5Pclose(d->create);
	if (d->space >= 0) H5Sclose(d->space);
	if (d->type >= 0) H5Tclose(d->type);
	if (d->dataset >= 0) H5Dclose(d->dataset);
}

static bool equals_one_of(hid_t type, const hid_t *known, size_t count)
{
	for (size_t k = 0; k < count; k++)
		if (H5Tequal(type, known[k]) > 0) return true;
	return false;
}

/* Only whole words of the usual formats: HDF5's conversions of others (floats of any layout, integers of any bits, members that overlap)
   trust the file too much. Half precision has no name in HDF5 1.10, so its fields are compared. */
static bool is_plain_float(hid_t type)
{
	const hid_t known[] = {H5T_IEEE_F32LE, H5T_IEEE_F32BE, H5T_IEEE_F64LE, H5T_IEEE_F64BE, H5T_NATIVE_LDOUBLE};
	if (H5T_FLOAT != H5Tget_class(type)) return false;
	if (equals_one_of(type, known, sizeof known / sizeof *known)) return true;
	size_t sign, exponent, exponent_bits, mantissa, mantissa_bits;
	return H5Tget_size(type) == 2 && H5Tget_precision(type) == 16 && H5Tget_offset(type) == 0 && H5Tget_ebias(type) == 15 &&
	       H5Tget_norm(type) == H5T_NORM_IMPLIED &&
	       H5Tget_fields(type, &sign, &exponent, &exponent_bits, &mantissa, &mantissa_bits) >= 0 && 15 == sign &&
	       10 == exponent && 5 == exponent_bits && 0 == mantissa && 10 == mantissa_bits;
}

static bool is_plain_integer(hid_t type)
{
	const hid_t known[] = {H5T_STD_I8LE,  H5T_STD_I16LE, H5T_STD_I32LE, H5T_STD_I64LE, H5T_STD_U8LE,  H5T_STD_U16LE,
	                       H5T_STD_U32LE, H5T_STD_U64LE, H5T_STD_I8BE,  H5T_STD_I16BE, H5T_STD_I32BE, H5T_STD_I64BE,
	                       H5T_STD_U8BE,  H5T_STD_U16BE, H5T_STD_U32BE, H5T_STD_U64BE};
	return H5T_INTEGER == H5Tget_class(type) && equals_one_of(type, known, sizeof known / sizeof *known);
}

/* A compound of two equal floats side by side is complex when one name starts with r and the other with i (r/i of h5py, re/im,
   real/imag). */
static bool find_parts(open_dataset *d)
{
	if (H5Tget_nmembers(d->type) != 2) return false;
	const size_t size = H5Tget_size(d->type);
	for (unsigned k = 0; k < 2; k++) {
		const hid_t part = H5Tget_member_type(d->type, k);
		const bool fits = part >= 0 && is_plain_float(part) && 2 * H5Tget_size(part) == size &&
		                  H5Tget_member_offset(d->type, k) == k * (size / 2);
		if (part >= 0) H5Tclose(part);
		char *name = fits ? H5Tget_member_name(d->type, k) : NULL;
		if (!name) return false;
		char *copy = 'r' == tolower((unsigned char)*name) ? d->re : 'i' == tolower((unsigned char)*name) ? d->im : NULL;
		const size_t n = strlen(name);
		if (copy && n < sizeof d->re) memcpy(copy, name, n + 1);
		H5free_memory(name);
	}
	d->natural = size > 2 * sizeof(float) ? OPTLA_C64 : OPTLA_C32;
	return *d->re && *d->im;
}

static optla_status understand_type(const optla_h5 *file, const char *name, open_dataset *d)
{
	const H5T_class_t class = H5Tget_class(d->type);
	d->natural = H5T_FLOAT == class && H5Tget_size(d->type) <= sizeof(float) ? OPTLA_F32 : OPTLA_F64;
	if (H5T_COMPOUND == class) d->complex = find_parts(d);
	if (H5T_ENUM == class) d->boolean = 1 == H5Tget_size(d->type);
	if (d->complex || d->boolean || is_plain_float(d->type) || is_plain_integer(d->type)) return OPTLA_OK;
	return OPTLA_FAIL(file->ctx, OPTLA_ERR_INPUT,
	                  "%s: '%s' holds neither integers, floats, booleans nor complex numbers (a compound of two floats r and i)",
	                  file->path, name);
}

static optla_status understand_shape(const optla_h5 *file, const char *name, open_dataset *d)
{
	const int rank = H5Sget_simple_extent_ndims(d->space);
	hsize_t dims[H5S_MAX_RANK];
	if (rank < 0 || H5Sget_simple_extent_dims(d->space, dims, NULL) < 0 || H5S_NULL == H5Sget_simple_extent_type(d->space))
		return OPTLA_FAIL(file->ctx, OPTLA_ERR_INPUT, "%s: '%s' has no shape", file->path, name);
	OPTLA_CHECK(file->ctx, rank <= MAX_RANK, OPTLA_ERR_INPUT, "%s: '%s' has %d dimensions; at most %d can be read", file->path,
	            name, rank, MAX_RANK);
	d->rank = (size_t)rank;
	d->count = 1;
	for (size_t k = 0; k < d->rank; k++) {
		d->dims[k] = (size_t)dims[k];
		OPTLA_CHECK(file->ctx, optla_size_mul_(d->count, d->dims[k], &d->count), OPTLA_ERR_NOMEM,
		            "%s: the shape of '%s' is too large for this machine", file->path, name);
	}
	return OPTLA_OK;
}

static optla_status open_named(const optla_h5 *file, const char *name, open_dataset *d)
{
	*d = (open_dataset){.dataset = H5I_INVALID_HID, .type = H5I_INVALID_HID, .space = H5I_INVALID_HID, .create = H5I_INVALID_HID};
	if (H5Lexists(file->file, name, H5P_DEFAULT) <= 0)
		return OPTLA_FAIL(file->ctx, OPTLA_ERR_INPUT, "%s: the dataset '%s' is missing", file->path, name);
	d->dataset = H5Dopen2(file->file, name, H5P_DEFAULT);
	if (d->dataset >= 0) {
		d->type = H5Dget_type(d->dataset);
		d->space = H5Dget_space(d->dataset);
		d->create = H5Dget_create_plist(d->dataset);
	}
	if (d->type < 0 || d->space < 0 || d->create < 0) return optla_h5_fail_(file, name, "can't be opened as a dataset");
	/* What one file holds must not depend on, or let out, what others hold. */
	OPTLA_CHECK(file->ctx, H5Pget_external_count(d->create) == 0 && H5Pget_layout(d->create) != H5D_VIRTUAL, OPTLA_ERR_INPUT,
	            "%s: '%s' keeps its values in another file, which isn't followed", file->path, name);
	OPTLA_TRY(understand_type(file, name, d));
	return understand_shape(file, name, d);
}

static void put_real(void *data, optla_scalar type, size_t k, double value)
{
	switch (type) {
	case OPTLA_F32: ((float *)data)[k] = (float)value; break;
	case OPTLA_F64: ((double *)data)[k] = value; break;
	case OPTLA_C32: memcpy((float *)data + 2 * k, (float[2]){(float)value, 0}, 2 * sizeof(float)); break;
	case OPTLA_C64: memcpy((double *)data + 2 * k, (double[2]){value, 0}, 2 * sizeof(double)); break;
	}
}

/* Narrow values are read into the end of the array and widened from its start: value k lies at or behind the place it goes to
   and is taken before that place is written. */
static bool read_booleans(const open_dataset *d, optla_scalar type, void *data)
{
	const size_t n = d->count;
	char *end = (char *)data + n * (optla_scalar_bytes(type) - 1);
	if (H5Dread(d->dataset, d->type, H5S_ALL, H5S_ALL, H5P_DEFAULT, end) < 0) return false;
	for (size_t k = 0; k < n; k++) put_real(data, type, k, end[k] ? 1 : 0);
	return true;
}

static bool read_real_as_complex(const open_dataset *d, optla_scalar type, void *data)
{
	const size_t n = d->count;
	const bool single = OPTLA_C32 == type;
	char *end = (char *)data + n * (single ? sizeof(float) : sizeof(double));
	if (H5Dread(d->dataset, single ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, end) < 0) return false;
	for (size_t k = 0; k < n; k++) put_real(data, type, k, single ? (double)((float *)end)[k] : ((double *)end)[k]);
	return true;
}

static bool read_values(const open_dataset *d, optla_scalar type, void *data)
{
	if (0 == d->count) return true;
	if (d->boolean) return read_booleans(d, type, data);
	if (!d->complex && (OPTLA_C32 == type || OPTLA_C64 == type)) return read_real_as_complex(d, type, data);
	const hid_t memory = optla_h5_memory_type_(type, d->re, d->im);
	const bool done = memory >= 0 && H5Dread(d->dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0;
	if (memory >= 0) H5Tclose(memory);
	return done;
}

static optla_status read_new(const optla_h5 *file, const char *name, const open_dataset *d, optla_scalar type, void **data)
{
	OPTLA_CHECK(file->ctx, !d->complex || OPTLA_C32 == type || OPTLA_C64 == type, OPTLA_ERR_INPUT,
	            "%s: '%s' holds complex numbers, real ones are needed", file->path, name);
	*data = optla_array_(file->ctx, d->count, optla_scalar_bytes(type));
	if (!*data) return OPTLA_ERR_NOMEM;
	if (read_values(d, type, *data)) return OPTLA_OK;
	optla_free(file->ctx, *data);
	*data = NULL;
	return optla_h5_fail_(file, name, "can't be read");
}

optla_status optla_h5_get_(optla_h5 *file, const char *name, optla_scalar type, optla_block *out)
{
	*out = (optla_block){.type = type};
	optla_h5_guard guard;
	optla_h5_enter_(file, &guard);
	open_dataset d;
	optla_status status = open_named(file, name, &d);
	if (OPTLA_OK == status && d.rank != 1 && d.rank != 2)
		status =
		    OPTLA_FAIL(file->ctx, OPTLA_ERR_INPUT, "%s: '%s' has %zu dimensions, 1 or 2 are needed", file->path, name, d.rank);
	if (OPTLA_OK == status) status = read_new(file, name, &d, type, &out->data);
	if (OPTLA_OK == status) {
		out->ncols = 2 == d.rank ? d.dims[0] : 1;
		out->nrows = out->ld = d.dims[d.rank - 1];
	}
	close_dataset(&d);
	optla_h5_leave_(&guard);
	return status;
}

optla_status optla_h5_get_array_(optla_h5 *file, const char *name, optla_array *out)
{
	optla_h5_guard guard;
	optla_h5_enter_(file, &guard);
	open_dataset d;
	optla_status status = open_named(file, name, &d);
	if (OPTLA_OK == status) status = read_new(file, name, &d, d.natural, &out->data);
	if (OPTLA_OK == status) {
		out->type = d.natural;
		out->ndim = d.rank;
		memcpy(out->dims, d.dims, sizeof out->dims);
	}
	close_dataset(&d);
	optla_h5_leave_(&guard);
	return status;
}

optla_status optla_h5_get_u32_(optla_h5 *file, const char *name, uint32_t **values, size_t *count)
{
	*values = NULL;
	*count = 0;
	optla_h5_guard guard;
	optla_h5_enter_(file, &guard);
	open_dataset d;
	optla_status status = open_named(file, name, &d);
	if (OPTLA_OK == status && (1 != d.rank || H5T_INTEGER != H5Tget_class(d.type)))
		status = OPTLA_FAIL(file->ctx, OPTLA_ERR_INPUT, "%s: '%s' is not a list of whole numbers", file->path, name);
	if (OPTLA_OK == status) {
		*values = optla_array_(file->ctx, d.count, sizeof **values);
		if (!*values)
			status = OPTLA_ERR_NOMEM;
		else if (d.count && H5Dread(d.dataset, H5T_NATIVE_UINT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, *values) < 0) {
			optla_free(file->ctx, *values);
			*values = NULL;
			status = optla_h5_fail_(file, name, "can't be read");
		} else
			*count = d.count;
	}
	close_dataset(&d);
	optla_h5_leave_(&guard);
	return status;
}

/* ---- names ---- */

bool optla_h5_has_(optla_h5 *file, const char *name)
{
	optla_h5_guard guard;
	optla_h5_enter_(file, &guard);
	const bool found = H5Lexists(file->file, name, H5P_DEFAULT) > 0 || H5Aexists(file->file, name) > 0;
	optla_h5_leave_(&guard);
	return found;
}

typedef struct {
	size_t count, used;
	char list[LIST_BYTES], *first; /* first: owned by the caller */
	optla_ctx *ctx;
} dataset_names;

static herr_t add_name(hid_t object, const char *name, const H5O_info_t *info, void *user)
{
	(void)object;
	dataset_names *n = user;
	if (H5O_TYPE_DATASET != info->type) return 0;
	if (0 == n->count++) {
		n->first = optla_strdup_(n->ctx, name);
		if (!n->first) return -1;
	}
	if (n->used + strlen(name) + 8 < sizeof n->list)
		n->used += (size_t)snprintf(n->list + n->used, sizeof n->list - n->used, "%s%s", n->used ? ", " : "", name);
	else if (n->used + 8 < sizeof n->list)
		n->used += (size_t)snprintf(n->list + n->used, sizeof n->list - n->used, ", ...");
	return 0;
}

optla_status optla_h5_only_name_(optla_h5 *file, char **name)
{
	*name = NULL;
	dataset_names n = {.ctx = file->ctx};
	optla_h5_guard guard;
	optla_h5_enter_(file, &guard);
	const bool visited = H5Ovisit(file->file, H5_INDEX_NAME, H5_ITER_INC, add_name, &n) >= 0;
	optla_status status = OPTLA_OK;
	if (n.count && !n.first)
		status = OPTLA_ERR_NOMEM;
	else if (!visited)
		status = optla_h5_fail_(file, NULL, "its datasets can't be listed");
	else if (0 == n.count)
		status = OPTLA_FAIL(file->ctx, OPTLA_ERR_INPUT, "%s: holds no dataset", file->path);
	else if (n.count > 1)
		status = OPTLA_FAIL(file->ctx, OPTLA_ERR_INPUT, "%s: holds %zu datasets, say which as '%s:NAME' (%s)", file->path,
		                    n.count, file->path, n.list);
	optla_h5_leave_(&guard);
	if (OPTLA_OK == status)
		*name = n.first;
	else
		optla_free(file->ctx, n.first);
	return status;
}
