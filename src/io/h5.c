/* SPDX-License-Identifier: BSD-3-Clause */
/* HDF5 files: creating, opening, closing, and turning HDF5's stack of errors into one sentence. */
#include "io/h5_impl.h"
#include "io/whole_file.h"

#include <errno.h>
#include <pthread.h>
#include <string.h>

/* Datasets of this size and more start at a page, so that they can be memory mapped with aligned numbers. */
enum { ALIGN_FROM_BYTES = 1024, ALIGN_BYTES = 4096 };

/* ---- one thread at a time; errors ---- */

static pthread_mutex_t one_at_a_time = PTHREAD_MUTEX_INITIALIZER; /* guards the HDF5 library, which is one for the process */

static herr_t read_entry(unsigned n, const H5E_error2_t *entry, void *user)
{
	optla_h5_failure *f = user;
	const char *text = entry->desc ? entry->desc : "";
	const char *number = strstr(text, "errno = ");
	if (number && !f->error) sscanf(number, "errno = %d", &f->error);
	if (0 == n) snprintf(f->reason, sizeof f->reason, "%s", text);
	return 0;
}

/* HDF5 calls this where it would print. The calls that tidy up after a failure clear its stack, so it is read at once. */
static herr_t keep_first(hid_t stack, void *user)
{
	optla_h5_failure *f = user;
	if (!f->failed) H5Ewalk2(stack, H5E_WALK_UPWARD, read_entry, f);
	f->failed = true;
	return 0;
}

void optla_h5_enter_(optla_h5 *file, optla_h5_guard *guard)
{
	pthread_mutex_lock(&one_at_a_time);
	guard->print = NULL;
	guard->data = NULL;
	file->failure = (optla_h5_failure){.failed = false};
	H5Eget_auto2(H5E_DEFAULT, &guard->print, &guard->data);
	H5Eset_auto2(H5E_DEFAULT, keep_first, &file->failure);
}

void optla_h5_leave_(const optla_h5_guard *guard)
{
	H5Eclear2(H5E_DEFAULT);
	H5Eset_auto2(H5E_DEFAULT, guard->print, guard->data);
	pthread_mutex_unlock(&one_at_a_time);
}

optla_status optla_h5_fail_(const optla_h5 *file, const char *name, const char *doing)
{
	const optla_h5_failure *f = &file->failure;
	char text[128];
	const int error = file->write_error ? file->write_error : f->error;
	const char *reason = error ? optla_errno_text_(error, text, sizeof text) : f->reason;
	const optla_status code = file->temporary || error ? OPTLA_ERR_IO : OPTLA_ERR_INPUT;
	return OPTLA_FAIL(file->ctx, code, "%s: %s%s%s%s%s%s", file->path, name ? "'" : "", name ? name : "", name ? "': " : "",
	                  doing, *reason ? ": " : "", reason);
}

/* ---- life ---- */

static void destroy(optla_h5 **file)
{
	optla_h5 *f = *file;
	*file = NULL;
	if (!f) return;
	optla_ctx *ctx = f->ctx;
	optla_free(ctx, f->path);
	optla_free(ctx, f);
}

static optla_status make(optla_ctx *ctx, const char *path, optla_h5 **out)
{
	*out = optla_calloc_(ctx, 1, sizeof **out);
	if (!*out) return OPTLA_ERR_NOMEM;
	(*out)->ctx = ctx;
	(*out)->file = (*out)->driver = H5I_INVALID_HID;
	(*out)->path = optla_strdup_(ctx, path);
	if ((*out)->path) return OPTLA_OK;
	destroy(out);
	return OPTLA_ERR_NOMEM;
}

/* The format of 1.8, whose headers carry checksums: HDF5 trusts damaged ones and reads outside of its memory.
   No file locks: a finished file never changes (a new one replaces it by its name), and locks fail on some network disks. */
static hid_t access_list(void)
{
	const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
	if (access < 0) return access;
	if (H5Pset_file_locking(access, false, true) >= 0 && H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110) >= 0 &&
	    H5Pset_alignment(access, ALIGN_FROM_BYTES, ALIGN_BYTES) >= 0 && H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0)
		return access;
	H5Pclose(access);
	return H5I_INVALID_HID;
}

static optla_status create_file(optla_h5 *f)
{
	optla_h5_guard guard;
	optla_h5_enter_(f, &guard);
	const hid_t access = access_list(), create = H5Pcreate(H5P_FILE_CREATE);
	/* No times in the file: the same contents give the same bytes. */
	const optla_h5_driver_info info = {.error = &f->write_error};
	if (access >= 0) f->driver = optla_h5_set_driver_(access, &info);
	if (f->driver >= 0 && create >= 0 && H5Pset_obj_track_times(create, false) >= 0)
		f->file = H5Fcreate(f->temporary, H5F_ACC_TRUNC, create, access);
	const optla_status status = f->file >= 0 ? OPTLA_OK : optla_h5_fail_(f, NULL, "can't be written");
	if (create >= 0) H5Pclose(create);
	if (access >= 0) H5Pclose(access);
	optla_h5_leave_(&guard);
	return status;
}

static optla_status put_head(optla_h5 *f, const char *kind)
{
	char *provenance;
	OPTLA_TRY(optla_ctx_provenance(f->ctx, &provenance));
	optla_status status = optla_h5_put_text_(f, "optla_kind", kind);
	if (OPTLA_OK == status) status = optla_h5_put_text_(f, "optla_version", optla_version());
	if (OPTLA_OK == status) status = optla_h5_put_text_(f, "provenance", provenance);
	optla_free(f->ctx, provenance);
	return status;
}

optla_status optla_h5_create_(optla_ctx *ctx, const char *path, const char *kind, optla_h5 **out)
{
	*out = NULL;
	optla_h5 *f;
	OPTLA_TRY(make(ctx, path, &f));
	optla_status status = optla_temporary_begin_(ctx, path, &f->temporary);
	if (OPTLA_OK == status) status = create_file(f);
	if (OPTLA_OK == status) status = put_head(f, kind);
	if (OPTLA_OK != status) optla_h5_finish_(&f, false);
	*out = f;
	return status;
}

optla_status optla_h5_finish_(optla_h5 **file, bool commit)
{
	optla_h5 *f = *file;
	if (!f) return OPTLA_OK;
	optla_status status = OPTLA_OK;
	optla_h5_guard guard;
	optla_h5_enter_(f, &guard);
	if (f->file >= 0) {
		const bool closed = H5Fclose(f->file) >= 0;
		if (commit && (!closed || f->write_error)) status = optla_h5_fail_(f, NULL, "can't be written");
	}
	if (f->driver >= 0) H5FDunregister(f->driver);
	optla_h5_leave_(&guard);
	const optla_status finish = optla_temporary_finish_(f->ctx, f->path, &f->temporary, commit && OPTLA_OK == status);
	destroy(file);
	return OPTLA_OK != status ? status : finish;
}

enum { HEAD_BYTES = 96 };

/* Superblocks of versions 0 and 1 may name a block of driver information, whose claimed length HDF5 1.10 takes from memory without a
   look at the file's own. Files that have one are parts of split files, which we don't read. */
static optla_status check_superblock(const optla_h5 *f, const unsigned char *head, size_t count)
{
	if (count < HEAD_BYTES || memcmp(head, "\x89HDF\r\n\x1a\n", 8) || head[8] > 1) return OPTLA_OK; /* HDF5's to judge */
	const size_t address = head[13], at = (0 == head[8] ? 24 : 28) + 3 * address;
	for (size_t k = 0; k < address && at + k < HEAD_BYTES; k++)
		OPTLA_CHECK(f->ctx, 0xff == head[at + k], OPTLA_ERR_INPUT, "%s: is one of the files of a split HDF5 file, or damaged",
		            f->path);
	return OPTLA_OK;
}

static optla_status check_superblock_of_file(const optla_h5 *f)
{
	unsigned char head[HEAD_BYTES];
	FILE *file = fopen(f->path, "rb");
	const size_t count = file ? fread(head, 1, sizeof head, file) : 0;
	if (file) fclose(file);
	return check_superblock(f, head, count);
}

/* bytes NULL: the file at f->path; else the contents of one in memory, borrowed. */
static optla_status open_file(optla_h5 *f, const void *bytes, size_t count)
{
	optla_h5_guard guard;
	optla_h5_enter_(f, &guard);
	const hid_t access = access_list();
	const optla_h5_driver_info info = {bytes, count, &f->write_error};
	if (access >= 0 && bytes) f->driver = optla_h5_set_driver_(access, &info);
	if (access >= 0 && (!bytes || f->driver >= 0)) f->file = H5Fopen(f->path, H5F_ACC_RDONLY, access);
	const optla_status status = f->file >= 0 ? OPTLA_OK : optla_h5_fail_(f, NULL, "is not an HDF5 file, or a damaged one");
	if (access >= 0) H5Pclose(access);
	optla_h5_leave_(&guard);
	return status;
}

static optla_status check_kind(optla_h5 *f, const char *kind)
{
	char *found;
	OPTLA_TRY(optla_h5_get_text_(f, "optla_kind", &found));
	const optla_status status = strcmp(found, kind)
	                                ? OPTLA_FAIL(f->ctx, OPTLA_ERR_INPUT, "%s: holds a '%.64s', not a '%s'", f->path, found, kind)
	                                : OPTLA_OK;
	optla_free(f->ctx, found);
	return status;
}

optla_status optla_h5_open_(optla_ctx *ctx, const char *path, const char *kind, optla_h5 **out)
{
	*out = NULL;
	OPTLA_TRY(optla_check_readable_(ctx, path));
	optla_h5 *f;
	OPTLA_TRY(make(ctx, path, &f));
	optla_status status = check_superblock_of_file(f);
	if (OPTLA_OK == status) status = open_file(f, NULL, 0);
	if (OPTLA_OK == status && kind) status = check_kind(f, kind);
	if (OPTLA_OK == status)
		optla_note_input_(ctx, path);
	else
		optla_h5_close_(&f);
	*out = f;
	return status;
}

static uint64_t little_endian(const unsigned char *at, size_t bytes)
{
	uint64_t value = 0;
	for (size_t k = bytes; k--;) value = value << 8 | at[k];
	return value;
}

/* Global heaps hold the texts of variable length and carry no checksum. HDF5 1.10.8 walks from object to object without an end where
   one has the size 0 or one that wraps around. */
static bool heap_is_whole(const unsigned char *heap, size_t there)
{
	enum { HEADER = 16, SIZE_AT = 8 }; /* of the heap and of each object */
	const uint64_t size = there < HEADER ? 0 : little_endian(heap + SIZE_AT, 8);
	if (size < HEADER || size > there) return false;
	for (uint64_t at = HEADER; size - at >= HEADER;) {
		const uint64_t bytes = little_endian(heap + at + SIZE_AT, 8), rest = size - at;
		if (bytes > rest) return false;
		const bool unused = 0 == little_endian(heap + at, 2); /* its size counts the header */
		const uint64_t need = unused ? bytes : HEADER + (bytes + 7) / 8 * 8;
		if (need < HEADER || need > rest) return false;
		at += need;
	}
	return true;
}

static optla_status check_heaps(const optla_h5 *f, const unsigned char *bytes, size_t count)
{
	static const char start[8] = {'G', 'C', 'O', 'L', 1};
	for (size_t at = 0; count - at >= sizeof start; at++) {
		const unsigned char *found = memchr(bytes + at, 'G', count - at);
		if (!found) break;
		at = (size_t)(found - bytes);
		OPTLA_CHECK(f->ctx, count - at < sizeof start || memcmp(found, start, sizeof start) || heap_is_whole(found, count - at),
		            OPTLA_ERR_INPUT, "%s: its heap of texts at byte %zu is damaged", f->path, at);
	}
	return OPTLA_OK;
}

optla_status optla_h5_open_bytes_(optla_ctx *ctx, const void *bytes, size_t count, const char *name, optla_h5 **out)
{
	*out = NULL;
	OPTLA_CHECK(ctx, count, OPTLA_ERR_INPUT, "%s: is empty", name);
	optla_h5 *f;
	OPTLA_TRY(make(ctx, name, &f));
	optla_status status = check_superblock(f, bytes, count);
	if (OPTLA_OK == status) status = check_heaps(f, bytes, count);
	if (OPTLA_OK == status) status = open_file(f, bytes, count);
	if (OPTLA_OK != status) optla_h5_close_(&f);
	*out = f;
	return status;
}

void optla_h5_close_(optla_h5 **file)
{
	if (file && *file) optla_h5_finish_(file, false);
}
