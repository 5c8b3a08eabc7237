/* SPDX-License-Identifier: BSD-3-Clause */
/* Reading a file at once; writing one whole or not at all.

   A writer fills a temporary file beside the wanted name, brings it to the disk (fsync) and renames it. rename() is atomic
   within a file system, so whoever opens the name sees the old file or the new one, also after a crash. The temporary's name
   is made unique by O_EXCL, not by a counter in memory: two threads or two machines on one network disk don't collide. */
#include "io/whole_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { NEW_FILE_MODE = 0666, NEW_DIR_MODE = 0777, TEMPORARY_TRIES = 1000 };

const char *optla_errno_text_(int error, char *buffer, size_t bytes)
{
	if (ENOSPC == error || EDQUOT == error)
		snprintf(buffer, bytes, "the disk is full (or its quota used up)");
	else if (EFBIG == error)
		snprintf(buffer, bytes, "the file would be larger than the system's limit for files");
	else if (strerror_r(error, buffer, bytes))
		snprintf(buffer, bytes, "error %d", error);
	return buffer;
}

static optla_status fail_errno(optla_ctx *ctx, optla_status code, const char *path, const char *doing, int error)
{
	char text[128];
	return OPTLA_FAIL(ctx, code, "%s: %s: %s", path, doing, optla_errno_text_(error, text, sizeof text));
}

/* ---- reading ---- */

static optla_status open_regular(optla_ctx *ctx, const char *path, int *fd, size_t *size)
{
	/* O_NONBLOCK: opening a pipe that nobody writes to would wait for ever; it has no effect on regular files. */
	*fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (*fd < 0) {
		const bool missing = ENOENT == errno || ENOTDIR == errno || ENAMETOOLONG == errno || ENXIO == errno;
		return fail_errno(ctx, missing ? OPTLA_ERR_INPUT : OPTLA_ERR_IO, path, "can't be opened", errno);
	}
	struct stat s;
	optla_status status = OPTLA_OK;
	if (fstat(*fd, &s))
		status = fail_errno(ctx, OPTLA_ERR_IO, path, "can't be examined", errno);
	else if (S_ISDIR(s.st_mode))
		status = OPTLA_FAIL(ctx, OPTLA_ERR_INPUT, "%s: is a directory, a file is needed", path);
	else if (!S_ISREG(s.st_mode))
		status = OPTLA_FAIL(ctx, OPTLA_ERR_INPUT, "%s: is a pipe or a device; save its contents to a file first", path);
	if (OPTLA_OK != status) {
		close(*fd);
		*fd = -1;
		return status;
	}
	*size = (size_t)s.st_size;
	return OPTLA_OK;
}

optla_status optla_check_readable_(optla_ctx *ctx, const char *path)
{
	int fd;
	size_t size;
	OPTLA_TRY(open_regular(ctx, path, &fd, &size));
	close(fd);
	return OPTLA_OK;
}

/* Bytes read (fewer than size only at the end of the file), or -1 with errno. */
static ssize_t read_all(int fd, char *bytes, size_t size)
{
	size_t done = 0;
	while (done < size) {
		const ssize_t n = read(fd, bytes + done, size - done);
		if (0 == n) break;
		if (n < 0 && EINTR == errno) continue;
		if (n < 0) return -1;
		done += (size_t)n;
	}
	return (ssize_t)done;
}

optla_status optla_read_output_(optla_ctx *ctx, const char *path, void **bytes, size_t *count)
{
	*bytes = NULL;
	*count = 0;
	int fd;
	size_t size = 0;
	OPTLA_TRY(open_regular(ctx, path, &fd, &size));
	const size_t limit = optla_ctx_memory_limit(ctx);
	char *data = size < limit ? optla_alloc_(ctx, size + 1) : NULL;
	if (!data) {
		close(fd);
		OPTLA_CHECK(ctx, size < limit, OPTLA_ERR_NOMEM, "%s: its %.4g GiB are over the memory limit of %.4g GiB", path,
		            (double)size / 0x1p30, (double)limit / 0x1p30);
		return OPTLA_ERR_NOMEM;
	}
	const ssize_t n = read_all(fd, data, size);
	const int error = errno;
	close(fd);
	if (n < 0) {
		optla_free(ctx, data);
		return fail_errno(ctx, OPTLA_ERR_IO, path, "can't be read", error);
	}
	data[n] = 0;
	*bytes = data;
	*count = (size_t)n;
	return OPTLA_OK;
}

optla_status optla_read_file_(optla_ctx *ctx, const char *path, void **bytes, size_t *count)
{
	OPTLA_TRY(optla_read_output_(ctx, path, bytes, count));
	optla_note_input_bytes_(ctx, path, *bytes, *count);
	return OPTLA_OK;
}

/* ---- writing ---- */

optla_status optla_temporary_begin_(optla_ctx *ctx, const char *path, char **temporary)
{
	*temporary = NULL;
	struct stat s;
	/* Renaming over a device or a pipe (-o /dev/null) would replace it by a file. */
	if (0 == stat(path, &s) && !S_ISREG(s.st_mode))
		return OPTLA_FAIL(ctx, OPTLA_ERR_IO, "%s: is a %s, so no file can be written there", path,
		                  S_ISDIR(s.st_mode) ? "directory" : "pipe or a device");
	for (int k = 0; k < TEMPORARY_TRIES; k++) {
		char *name = optla_format_(ctx, "%s.tmp-%ld-%d", path, (long)getpid(), k);
		if (!name) return OPTLA_ERR_NOMEM;
		const int fd = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, NEW_FILE_MODE);
		const int error = errno;
		if (fd >= 0) {
			close(fd);
			*temporary = name;
			return OPTLA_OK;
		}
		optla_free(ctx, name);
		if (EEXIST != error) return fail_errno(ctx, OPTLA_ERR_IO, path, "can't be written", error);
	}
	return OPTLA_FAIL(ctx, OPTLA_ERR_IO, "%s: can't be written: %d temporary files %s.tmp-* are in the way", path,
	                  TEMPORARY_TRIES, path);
}

/* 0, or errno */
static int sync_name(const char *path, int flags)
{
	const int fd = open(path, flags | O_CLOEXEC);
	if (fd < 0) return errno;
	int error = fsync(fd) ? errno : 0;
	if (close(fd) && !error) error = errno;
	return error;
}

/* Makes the new name itself last. Some file systems can't sync a directory: then the file is there, if not yet safe from a
   power failure, and that is no reason to fail. */
static void sync_directory_of(optla_ctx *ctx, const char *path)
{
	char *dir = optla_path_dir_(ctx, path);
	if (dir) sync_name(dir, O_RDONLY | O_DIRECTORY);
	optla_free(ctx, dir);
}

optla_status optla_temporary_finish_(optla_ctx *ctx, const char *path, char **temporary, bool commit)
{
	char *name = *temporary;
	*temporary = NULL;
	if (!name) return OPTLA_OK;
	optla_status status = OPTLA_OK;
	if (!commit) {
		unlink(name);
	} else {
		int error = sync_name(name, O_WRONLY);
		if (!error && rename(name, path)) error = errno;
		if (error) {
			unlink(name);
			status = fail_errno(ctx, OPTLA_ERR_IO, path, "can't be written", error);
		} else {
			sync_directory_of(ctx, path);
		}
	}
	optla_free(ctx, name);
	return status;
}

/* 0, or errno */
static int write_piece(int fd, const char *bytes, size_t count)
{
	for (size_t done = 0; done < count;) {
		const ssize_t n = write(fd, bytes + done, count - done);
		if (n > 0)
			done += (size_t)n;
		else if (n < 0 && EINTR != errno)
			return errno;
	}
	return 0;
}

/* 0, or errno */
static int write_all(const char *name, const optla_piece *pieces, size_t count)
{
	const int fd = open(name, O_WRONLY | O_TRUNC | O_CLOEXEC);
	if (fd < 0) return errno;
	int error = 0;
	for (size_t k = 0; k < count && !error; k++) error = write_piece(fd, pieces[k].bytes, pieces[k].count);
	if (close(fd) && !error) error = errno;
	return error;
}

optla_status optla_write_pieces_(optla_ctx *ctx, const char *path, const optla_piece *pieces, size_t count)
{
	char *temporary;
	OPTLA_TRY(optla_temporary_begin_(ctx, path, &temporary));
	const int error = write_all(temporary, pieces, count);
	const optla_status status = error ? fail_errno(ctx, OPTLA_ERR_IO, path, "can't be written", error) : OPTLA_OK;
	const optla_status finish = optla_temporary_finish_(ctx, path, &temporary, !error);
	return OPTLA_OK != status ? status : finish;
}

optla_status optla_write_file_(optla_ctx *ctx, const char *path, const void *bytes, size_t count)
{
	const optla_piece piece = {bytes, count};
	return optla_write_pieces_(ctx, path, &piece, 1);
}

/* ---- names ---- */

char *optla_path_join_(optla_ctx *ctx, const char *dir, const char *name)
{
	const size_t n = strlen(dir);
	if ('/' == name[0] || 0 == n) return optla_strdup_(ctx, name);
	return optla_format_(ctx, '/' == dir[n - 1] ? "%s%s" : "%s/%s", dir, name);
}

char *optla_path_dir_(optla_ctx *ctx, const char *path)
{
	const char *slash = strrchr(path, '/');
	if (!slash) return optla_strdup_(ctx, ".");
	while (slash > path && '/' == slash[-1]) slash--;
	return slash == path ? optla_strdup_(ctx, "/") : optla_format_(ctx, "%.*s", (int)(slash - path), path);
}

bool optla_path_exists_(const char *path)
{
	struct stat s;
	return 0 == stat(path, &s);
}

optla_status optla_split_member_(optla_ctx *ctx, const char *path, char **file, const char **member)
{
	*member = NULL;
	*file = optla_strdup_(ctx, path);
	if (!*file) return OPTLA_ERR_NOMEM;
	if (optla_path_exists_(path)) return OPTLA_OK;
	for (char *colon = *file + strlen(*file); colon > *file; colon--) {
		if (':' != *colon || !colon[1]) continue;
		*colon = 0;
		if (optla_path_exists_(*file)) {
			*member = path + (colon + 1 - *file);
			return OPTLA_OK;
		}
		*colon = ':';
	}
	return OPTLA_OK;
}

static bool is_directory(const char *path)
{
	struct stat s;
	return 0 == stat(path, &s) && S_ISDIR(s.st_mode);
}

optla_status optla_make_dirs_(optla_ctx *ctx, const char *path)
{
	char *part = optla_strdup_(ctx, path);
	if (!part) return OPTLA_ERR_NOMEM;
	optla_status status = OPTLA_OK;
	for (char *p = part; *p && OPTLA_OK == status; p++) {
		if (p[1] && ('/' != p[1] || '/' == *p)) continue; /* not yet at the end of a component */
		const char kept = p[1];
		p[1] = 0;
		const int error = is_directory(part) || 0 == mkdir(part, NEW_DIR_MODE) ? 0 : errno;
		/* The second look: another program may have made it in between. */
		if (error && !is_directory(part)) status = fail_errno(ctx, OPTLA_ERR_IO, part, "can't be made a directory", error);
		p[1] = kept;
	}
	optla_free(ctx, part);
	return status;
}
