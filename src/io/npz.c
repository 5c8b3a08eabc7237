/* SPDX-License-Identifier: BSD-3-Clause */
/* .npz through libzip, which checks the archive's structure and each member's CRC. */
#include "io/npz.h"
#include "io/npy.h"
#include "io/whole_file.h"

#include <string.h>
#include <zip.h>

/* ---- reading ---- */

static optla_status fail_zip(optla_ctx *ctx, const char *name, zip_error_t *error)
{
	return OPTLA_FAIL(ctx, OPTLA_ERR_INPUT, "%s: not a ZIP archive (.npz), or a damaged one: %s", name,
	                  zip_error_strerror(error));
}

static bool is_named(const char *found, const char *member)
{
	const size_t n = strlen(member);
	return !strncmp(found, member, n) && (!found[n] || !strcmp(found + n, ".npy"));
}

/* "a, b, c" of the names, without .npy */
static void list_members(zip_t *archive, char *buffer, size_t bytes)
{
	size_t used = 0;
	const zip_int64_t count = zip_get_num_entries(archive, 0);
	buffer[0] = 0;
	for (zip_int64_t k = 0; k < count; k++) {
		const char *name = zip_get_name(archive, (zip_uint64_t)k, ZIP_FL_ENC_RAW);
		const size_t n = name ? strlen(name) : 0, shown = n > 4 && !strcmp(name + n - 4, ".npy") ? n - 4 : n;
		if (used + shown + 8 > bytes) {
			snprintf(buffer + used, bytes - used, ", ...");
			return;
		}
		used += (size_t)snprintf(buffer + used, bytes - used, "%s%.*s", k ? ", " : "", (int)shown, name ? name : "");
	}
}

static optla_status find_member(optla_ctx *ctx, zip_t *archive, const char *name, const char *member, zip_uint64_t *index)
{
	const zip_int64_t count = zip_get_num_entries(archive, 0);
	OPTLA_CHECK(ctx, count > 0, OPTLA_ERR_INPUT, "%s: the archive is empty", name);
	for (zip_int64_t k = 0; k < count; k++) {
		const char *found = zip_get_name(archive, (zip_uint64_t)k, ZIP_FL_ENC_RAW);
		*index = (zip_uint64_t)k;
		if (member ? found && is_named(found, member) : 1 == count) return OPTLA_OK;
	}
	char names[600];
	list_members(archive, names, sizeof names);
	if (member) return OPTLA_FAIL(ctx, OPTLA_ERR_INPUT, "%s: has no member '%s' (it has: %s)", name, member, names);
	return OPTLA_FAIL(ctx, OPTLA_ERR_INPUT, "%s: holds %lld arrays, say which as '%s:NAME' (%s)", name, (long long)count, name,
	                  names);
}

/* Deflate makes at most 1032 bytes of one: what claims more would only make us reserve memory for nothing. */
static optla_status check_member(optla_ctx *ctx, const char *name, const zip_stat_t *s)
{
	const zip_uint64_t needed = ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD | ZIP_STAT_ENCRYPTION_METHOD;
	OPTLA_CHECK(ctx, (s->valid & needed) == needed, OPTLA_ERR_INPUT, "%s: a member's size is missing", name);
	OPTLA_CHECK(ctx, ZIP_EM_NONE == s->encryption_method, OPTLA_ERR_INPUT, "%s: a member is encrypted", name);
	OPTLA_CHECK(ctx, ZIP_CM_STORE == s->comp_method || ZIP_CM_DEFLATE == s->comp_method, OPTLA_ERR_INPUT,
	            "%s: a member is compressed by method %d; 0 (stored) and 8 (deflated) can be read", name, s->comp_method);
	const zip_uint64_t ratio = ZIP_CM_STORE == s->comp_method ? 1 : 1032;
	OPTLA_CHECK(ctx, s->size / ratio <= s->comp_size, OPTLA_ERR_INPUT, "%s: a member claims %llu bytes in %llu, which can't be",
	            name, (unsigned long long)s->size, (unsigned long long)s->comp_size);
	return OPTLA_OK;
}

static optla_status unpack(optla_ctx *ctx, zip_t *archive, const char *name, zip_uint64_t index, size_t size, char *bytes)
{
	zip_file_t *file = zip_fopen_index(archive, index, 0);
	OPTLA_CHECK(ctx, file, OPTLA_ERR_INPUT, "%s: a member can't be opened: %s", name, zip_strerror(archive));
	size_t done = 0;
	zip_int64_t n = 1;
	while (done < size && n > 0) {
		n = zip_fread(file, bytes + done, size - done);
		if (n > 0) done += (size_t)n;
	}
	char more;
	if (done == size) n = zip_fread(file, &more, 1); /* the CRC is compared at the end */
	optla_status status = OPTLA_OK;
	if (n < 0)
		status = OPTLA_FAIL(ctx, OPTLA_ERR_INPUT, "%s: a member is damaged: %s", name, zip_file_strerror(file));
	else if (done < size || n > 0)
		status = OPTLA_FAIL(ctx, OPTLA_ERR_INPUT, "%s: a member is %s than the %zu bytes it claims", name,
		                    done < size ? "shorter" : "longer", size);
	zip_fclose(file);
	return status;
}

static optla_status decode_member(optla_ctx *ctx, zip_t *archive, const char *name, const char *member, optla_array *out)
{
	zip_uint64_t index = 0;
	zip_stat_t s;
	OPTLA_TRY(find_member(ctx, archive, name, member, &index));
	zip_stat_init(&s);
	OPTLA_CHECK(ctx, 0 == zip_stat_index(archive, index, 0, &s), OPTLA_ERR_INPUT, "%s: %s", name, zip_strerror(archive));
	OPTLA_TRY(check_member(ctx, name, &s));
	char *bytes = optla_array_(ctx, (size_t)s.size, 1), *full = optla_format_(ctx, "%s:%.64s", name, s.name ? s.name : "");
	optla_status status = bytes && full ? unpack(ctx, archive, full, index, (size_t)s.size, bytes) : OPTLA_ERR_NOMEM;
	if (OPTLA_OK == status) status = optla_npy_decode_(ctx, full, bytes, (size_t)s.size, out);
	optla_free(ctx, bytes);
	optla_free(ctx, full);
	return status;
}

optla_status optla_npz_decode_(optla_ctx *ctx, const char *name, const void *bytes, size_t nbytes, const char *member,
                               optla_array *out)
{
	zip_error_t error;
	zip_error_init(&error);
	optla_status status;
	zip_source_t *source = zip_source_buffer_create(bytes, nbytes, 0, &error);
	zip_t *archive = source ? zip_open_from_source(source, ZIP_RDONLY, &error) : NULL;
	if (archive) {
		status = decode_member(ctx, archive, name, member, out);
		zip_discard(archive); /* frees the source too */
	} else {
		status = fail_zip(ctx, name, &error);
		zip_source_free(source);
	}
	zip_error_fini(&error);
	return status;
}

/* ---- writing ---- */

static size_t data_bytes(const optla_array *array)
{
	size_t count = 1;
	for (size_t k = 0; k < array->ndim; k++) count *= array->dims[k];
	return count * optla_scalar_bytes(array->type);
}

static optla_status fail_write(optla_ctx *ctx, const char *path, zip_error_t *error)
{
	char text[128];
	const bool system = ZIP_ET_SYS == zip_error_system_type(error);
	return OPTLA_FAIL(ctx, OPTLA_ERR_IO, "%s: can't be written: %s", path,
	                  system ? optla_errno_text_(zip_error_code_system(error), text, sizeof text) : zip_error_strerror(error));
}

/* The archive is written when it is closed; the fragments must live until then. */
static bool add_member(zip_t *archive, const char *name, const zip_buffer_fragment_t fragments[2])
{
	enum { DATE_1980_01_01 = 1 << 5 | 1 }; /* the same contents give the same bytes */
	zip_source_t *source = zip_source_buffer_fragment(archive, fragments, 2, 0);
	if (!source) return false;
	const zip_int64_t index = zip_file_add(archive, name, source, ZIP_FL_ENC_UTF_8);
	if (index < 0) {
		zip_source_free(source);
		return false;
	}
	return 0 == zip_set_file_compression(archive, (zip_uint64_t)index, ZIP_CM_STORE, 0) &&
	       0 == zip_file_set_dostime(archive, (zip_uint64_t)index, 0, DATE_1980_01_01, 0);
}

static optla_status write_archive(const optla_array *array, const char *path, const char *temporary, const char *member)
{
	char header[OPTLA_NPY_HEADER_BYTES];
	const size_t length = optla_npy_header_make_(array, header);
	const zip_buffer_fragment_t fragments[2] = {{(zip_uint8_t *)header, length}, {array->data, data_bytes(array)}};
	zip_error_t error;
	zip_error_init(&error);
	int code = 0;
	zip_t *archive = zip_open(temporary, ZIP_CREATE | ZIP_TRUNCATE, &code);
	optla_status status = OPTLA_OK;
	if (!archive) {
		zip_error_init_with_code(&error, code);
		status = fail_write(array->ctx, path, &error);
	} else if (!add_member(archive, member, fragments) || zip_close(archive)) {
		status = fail_write(array->ctx, path, zip_get_error(archive));
		zip_discard(archive);
	}
	zip_error_fini(&error);
	return status;
}

optla_status optla_npz_save_(const optla_array *array, const char *path, const char *member)
{
	char *full = optla_format_(array->ctx, "%s.npy", member), *temporary = NULL;
	optla_status status = full ? optla_temporary_begin_(array->ctx, path, &temporary) : OPTLA_ERR_NOMEM;
	if (OPTLA_OK == status) status = write_archive(array, path, temporary, full);
	const optla_status finish = optla_temporary_finish_(array->ctx, path, &temporary, OPTLA_OK == status);
	optla_free(array->ctx, full);
	return OPTLA_OK != status ? status : finish;
}
