/* SPDX-License-Identifier: BSD-3-Clause */
/* libtiff's callbacks on memory. */
#include "io/tiff_memory.h"

#include <string.h>

static tmsize_t on_read(thandle_t handle, void *to, tmsize_t count)
{
	optla_tiff_memory *m = handle;
	const uint8_t *data = m->file ? m->file->data : m->data;
	const size_t end = m->file ? m->file->count : m->count, left = m->at < end ? end - m->at : 0;
	const size_t n = optla_min_((size_t)count, left);
	if (n < (size_t)count) m->cut = true;
	if (n) memcpy(to, data + m->at, n);
	m->at += n;
	return (tmsize_t)n;
}

static tmsize_t on_write(thandle_t handle, void *bytes, tmsize_t count)
{
	optla_tiff_memory *m = handle;
	if (!m->file) return -1;
	m->file->at = m->at;
	if (!optla_memory_file_write_(m->file, bytes, (size_t)count)) return -1;
	m->at = m->file->at;
	return count;
}

static toff_t on_size(thandle_t handle)
{
	const optla_tiff_memory *m = handle;
	return m->file ? m->file->count : m->count;
}

static toff_t on_seek(thandle_t handle, toff_t offset, int whence)
{
	optla_tiff_memory *m = handle;
	const toff_t from = SEEK_CUR == whence ? m->at : SEEK_END == whence ? on_size(handle) : 0;
	if (offset > SIZE_MAX / 2 || from > SIZE_MAX / 2) return (toff_t)-1;
	m->at = (size_t)(from + offset);
	return m->at;
}

static int on_close(thandle_t handle)
{
	(void)handle;
	return 0;
}

static int on_error(TIFF *tiff, void *user, const char *module, const char *format, va_list args)
{
	optla_tiff_memory *m = user;
	(void)tiff;
	(void)module;
	if (!*m->message) vsnprintf(m->message, sizeof m->message, format, args);
	return 1; /* done: the global handlers are not called */
}

static int on_warning(TIFF *tiff, void *user, const char *module, const char *format, va_list args)
{
	const optla_tiff_memory *m = user;
	char text[512];
	(void)tiff;
	(void)module;
	vsnprintf(text, sizeof text, format, args);
	optla_log_(m->ctx, 2, "%s: TIFF: %s", m->name, text);
	return 1;
}

TIFF *optla_tiff_open_(optla_tiff_memory *memory, const char *mode)
{
	TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
	if (!options) return NULL;
	const size_t limit = optla_min_(optla_ctx_memory_limit(memory->ctx), SIZE_MAX / 4);
	TIFFOpenOptionsSetMaxSingleMemAlloc(options, (tmsize_t)limit);
	TIFFOpenOptionsSetErrorHandlerExtR(options, on_error, memory);
	TIFFOpenOptionsSetWarningHandlerExtR(options, on_warning, memory);
	TIFF *tiff =
	    TIFFClientOpenExt(memory->name, mode, memory, on_read, on_write, on_seek, on_close, on_size, NULL, NULL, options);
	TIFFOpenOptionsFree(options);
	return tiff;
}
