/* SPDX-License-Identifier: BSD-3-Clause */
/* A dense matrix that stays in its file: pages are mapped, the system brings them in and drops them as it likes.

   A matrix stored row after row is its transpose stored column after column: the two directions of a product change places. The file is
   passed through in panels of whole stored columns, from its start to its end, so that a matrix larger than memory is read as
   a stream. */
#include "io/h5.h"
#include "io/npy.h"
#include "io/whole_file.h"
#include "math/dense.h"
#include "op/op_impl.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PANEL_BYTES = 64 << 20, PANEL_COLUMNS = 8 };

typedef struct {
	optla_ctx *ctx;
	char *path; /* of the file alone */
	void *pages;
	size_t page_bytes;
	optla_cblock stored; /* as a column-major matrix */
	bool by_rows;        /* stored holds Tᵀ */
} map_op;

/* ---- products ---- */

/* y = A x, panel by panel: y is the sum over panels. */
static optla_status stored_forward(const map_op *m, size_t width, optla_cblock x, optla_block y)
{
	optla_block part = optla_block_new_(m->ctx, y.nrows, y.ncols, y.type);
	optla_status status = part.data ? OPTLA_OK : OPTLA_ERR_NOMEM;
	const size_t bytes = optla_scalar_bytes(x.type);
	for (size_t j = 0; OPTLA_OK == status && j < m->stored.ncols; j += width) {
		const size_t n = optla_min_(width, m->stored.ncols - j);
		const optla_cblock rows = {(const char *)x.data + j * bytes, n, x.ncols, x.ld, x.type};
		status = optla_check_cancel_(m->ctx);
		if (OPTLA_OK == status)
			status = optla_dense_apply_(m->ctx, OPTLA_FORWARD, optla_columns_(m->stored, j, n), rows, j ? part : y);
		if (OPTLA_OK == status && j) optla_block_add_(optla_block_const(part), y);
	}
	optla_free(m->ctx, part.data);
	return status;
}

/* y = Aᵀ x: each panel gives some rows of y. */
static optla_status stored_transposed(const map_op *m, size_t width, optla_cblock x, optla_block y)
{
	const size_t bytes = optla_scalar_bytes(x.type);
	for (size_t j = 0; j < m->stored.ncols; j += width) {
		const size_t n = optla_min_(width, m->stored.ncols - j);
		const optla_block rows = {(char *)y.data + j * bytes, n, y.ncols, y.ld, y.type};
		OPTLA_TRY(optla_check_cancel_(m->ctx));
		OPTLA_TRY(optla_dense_apply_(m->ctx, OPTLA_TRANSPOSE, optla_columns_(m->stored, j, n), x, rows));
	}
	return OPTLA_OK;
}

static optla_status map_apply(void *user, optla_trans trans, optla_cblock x, optla_block y)
{
	const map_op *m = user;
	const size_t column = optla_max_(m->stored.nrows * optla_scalar_bytes(m->stored.type), 1);
	const size_t width = optla_max_(PANEL_BYTES / column, PANEL_COLUMNS);
	if ((trans == OPTLA_FORWARD) == m->by_rows) return stored_transposed(m, width, x, y);
	if (!m->stored.ncols || width >= m->stored.ncols) return optla_dense_apply_(m->ctx, OPTLA_FORWARD, m->stored, x, y);
	return stored_forward(m, width, x, y);
}

static void map_destroy(void *user)
{
	map_op *m = user;
	if (m->pages) munmap(m->pages, m->page_bytes);
	optla_free(m->ctx, m->path);
	optla_free(m->ctx, m);
}

/* ---- opening ---- */

static optla_status scalar_of(optla_ctx *ctx, const char *path, const optla_npy_header *h, optla_scalar *type)
{
	const uint16_t one = 1;
	const bool machine_is_big = *(const unsigned char *)&one == 0;
	const bool fits = (h->kind == 'f' && h->item_bytes >= 4) || h->kind == 'c';
	OPTLA_CHECK(ctx, fits && h->big_endian == machine_is_big, OPTLA_ERR_INPUT,
	            "%s: type %c%zu%s can't be mapped; allowed are f4, f8, c8, c16 in the machine's byte order", path, h->kind,
	            h->item_bytes, h->big_endian == machine_is_big ? "" : " of the other byte order");
	if (h->kind == 'f')
		*type = h->item_bytes == 4 ? OPTLA_F32 : OPTLA_F64;
	else
		*type = h->item_bytes == 8 ? OPTLA_C32 : OPTLA_C64;
	return OPTLA_OK;
}

/* Places the stored matrix into the mapped pages; its bytes must be there and aligned. */
static optla_status place(map_op *m, size_t offset, size_t nrows, size_t ncols, bool by_rows, optla_scalar type, bool to_the_end)
{
	const size_t item = optla_scalar_bytes(type), align = type == OPTLA_F32 || type == OPTLA_C32 ? 4 : 8;
	size_t count, bytes;
	OPTLA_CHECK(m->ctx, optla_size_mul_(nrows, ncols, &count) && optla_size_mul_(count, item, &bytes), OPTLA_ERR_INPUT,
	            "%s: a matrix of %zu x %zu is beyond the address space", m->path, nrows, ncols);
	OPTLA_CHECK(m->ctx, offset <= m->page_bytes && bytes <= m->page_bytes - offset, OPTLA_ERR_INPUT,
	            "%s: truncated: %zu x %zu %s at byte %zu need %zu bytes, the file has %zu", m->path, nrows, ncols,
	            optla_scalar_name_(type), offset, bytes, m->page_bytes);
	OPTLA_CHECK(m->ctx, !to_the_end || bytes == m->page_bytes - offset, OPTLA_ERR_INPUT,
	            "%s: %zu bytes too many after %zu x %zu %s", m->path, m->page_bytes - offset - bytes, nrows, ncols,
	            optla_scalar_name_(type));
	OPTLA_CHECK(m->ctx, offset % align == 0, OPTLA_ERR_INPUT, "%s: the numbers start at byte %zu, no multiple of %zu", m->path,
	            offset, align);
	m->by_rows = by_rows;
	m->stored = optla_cblock_((const char *)m->pages + offset, by_rows ? ncols : nrows, by_rows ? nrows : ncols, type);
	return OPTLA_OK;
}

static optla_status place_npy(map_op *m)
{
	optla_npy_header h;
	optla_scalar type = OPTLA_F32;
	OPTLA_TRY(optla_npy_header_parse_(m->ctx, m->path, m->pages, m->page_bytes, &h));
	OPTLA_CHECK(m->ctx, h.ndims == 2, OPTLA_ERR_INPUT, "%s: a matrix has 2 dimensions, this array has %zu", m->path, h.ndims);
	OPTLA_TRY(scalar_of(m->ctx, m->path, &h, &type));
	return place(m, h.data_offset, h.shape[0], h.shape[1], !h.fortran_order, type, true);
}

/* Rows of the dataset are rows of T. dataset NULL: the only one of the file. */
static optla_status place_h5(map_op *m, const char *dataset)
{
	optla_h5 *file;
	optla_h5_place p;
	char *only = NULL;
	OPTLA_TRY(optla_h5_open_(m->ctx, m->path, NULL, &file));
	optla_status status = dataset ? OPTLA_OK : optla_h5_only_name_(file, &only);
	if (OPTLA_OK == status) status = optla_h5_locate_(file, dataset ? dataset : only, &p);
	if (OPTLA_OK == status) status = place(m, p.offset, p.nrows, p.ncols, true, p.type, false);
	optla_free(m->ctx, only);
	optla_h5_close_(&file);
	return status;
}

static optla_status map_file(map_op *m)
{
	char reason[128];
	const int fd = open(m->path, O_RDONLY | O_CLOEXEC);
	OPTLA_CHECK(m->ctx, fd >= 0, OPTLA_ERR_INPUT, "%s: can't be opened: %s", m->path,
	            optla_errno_text_(errno, reason, sizeof reason));
	struct stat st;
	const bool regular = fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && st.st_size > 0;
	m->page_bytes = regular ? (size_t)st.st_size : 0;
	void *pages = regular ? mmap(NULL, m->page_bytes, PROT_READ, MAP_PRIVATE, fd, 0) : MAP_FAILED;
	const int error = errno;
	close(fd);
	OPTLA_CHECK(m->ctx, regular, OPTLA_ERR_INPUT, "%s: not a regular file with something in it", m->path);
	OPTLA_CHECK(m->ctx, pages != MAP_FAILED, OPTLA_ERR_IO, "%s: can't be mapped: %s", m->path,
	            optla_errno_text_(error, reason, sizeof reason));
	m->pages = pages;
	posix_madvise(pages, m->page_bytes, POSIX_MADV_SEQUENTIAL);
	return OPTLA_OK;
}

/* "file.h5:dataset": the name of the dataset, or NULL when path itself is a file or has no ':' */
static const char *dataset_of(const char *path)
{
	const char *colon = strrchr(path, ':');
	return colon && !optla_path_exists_(path) ? colon + 1 : NULL;
}

static optla_status open_map(map_op *m, const char *path)
{
	const char *dataset = dataset_of(path);
	m->path = optla_strdup_(m->ctx, path);
	if (!m->path) return OPTLA_ERR_NOMEM;
	if (dataset) m->path[dataset - path - 1] = '\0';
	OPTLA_TRY(map_file(m));
	const bool is_npy = m->page_bytes >= 6 && !memcmp(m->pages, "\x93NUMPY", 6);
	OPTLA_CHECK(m->ctx, !is_npy || !dataset, OPTLA_ERR_INPUT, "%s: an NPY file has no dataset '%s'", m->path, dataset);
	return is_npy ? place_npy(m) : place_h5(m, dataset);
}

optla_status optla_op_map(optla_ctx *ctx, const char *path, optla_op **out)
{
	*out = NULL;
	OPTLA_CHECK(ctx, path, OPTLA_ERR_ARG, "path is NULL");
	map_op *m = optla_calloc_(ctx, 1, sizeof *m);
	if (!m) return OPTLA_ERR_NOMEM;
	m->ctx = ctx;
	const optla_status status = open_map(m, path);
	if (OPTLA_OK != status) {
		map_destroy(m);
		return status;
	}
	optla_note_input_(ctx, m->path);
	const optla_op_desc desc = {.size = sizeof desc,
	                            .name = path,
	                            .nrows = m->by_rows ? m->stored.ncols : m->stored.nrows,
	                            .ncols = m->by_rows ? m->stored.nrows : m->stored.ncols,
	                            .type = m->stored.type,
	                            .user = m,
	                            .apply = map_apply,
	                            .destroy = map_destroy};
	return optla_op_create(ctx, out, &desc);
}
