/* SPDX-License-Identifier: BSD-3-Clause */
/* A file driver for HDF5 that never fails: it writes to a file or reads from bytes in memory.

   When a write fails (the disk is full) HDF5 can't close its file any more, and the half closed file crashes the process at its
   end (seen with 1.10.8, H5F__close_cb from H5_term_library). So a failure is noted in info.error and hidden from HDF5, which
   goes on and closes in good order; the caller looks at the note and drops the file. Reading from memory needs no copy this way,
   where HDF5's own core driver makes two. */
#include "io/h5_driver.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

typedef struct {
	H5FD_t public; /* first: HDF5 knows the file as this */
	optla_h5_driver_info info;
	int fd; /* -1: memory */
	haddr_t eoa, eof;
} driver_file;

static const haddr_t max_address = INT64_MAX;

static void note(const driver_file *f, int error)
{
	if (!*f->info.error) *f->info.error = error;
}

static H5FD_t *driver_open(const char *name, unsigned flags, hid_t access, haddr_t max)
{
	(void)max;
	const optla_h5_driver_info *info = H5Pget_driver_info(access);
	driver_file *f = info ? calloc(1, sizeof *f) : NULL; /* HDF5's own memory, as all of it */
	if (!f) return NULL;
	f->info = *info;
	f->fd = -1;
	f->eof = info->count;
	if (info->bytes) return &f->public;
	f->eof = 0;
	f->fd = open(name, O_RDWR | O_CLOEXEC | (flags & H5F_ACC_TRUNC ? O_TRUNC : 0));
	if (f->fd >= 0) return &f->public;
	note(f, errno);
	free(f);
	return NULL;
}

static herr_t driver_close(H5FD_t *file)
{
	driver_file *f = (driver_file *)file;
	if (f->fd >= 0 && close(f->fd)) note(f, errno);
	free(f);
	return 0;
}

static herr_t driver_query(const H5FD_t *file, unsigned long *flags)
{
	(void)file;
	*flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA;
	return 0;
}

static haddr_t driver_get_eoa(const H5FD_t *file, H5FD_mem_t type)
{
	(void)type;
	return ((const driver_file *)file)->eoa;
}

static herr_t driver_set_eoa(H5FD_t *file, H5FD_mem_t type, haddr_t address)
{
	(void)type;
	((driver_file *)file)->eoa = address;
	return 0;
}

static haddr_t driver_get_eof(const H5FD_t *file, H5FD_mem_t type)
{
	(void)type;
	return ((const driver_file *)file)->eof;
}

/* Bytes past the end read as zeros, as in HDF5's own drivers. */
static herr_t driver_read(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t address, size_t size, void *buffer)
{
	(void)type;
	(void)transfer;
	const driver_file *f = (const driver_file *)file;
	memset(buffer, 0, size);
	if (address >= f->eof || address > max_address) return 0;
	const size_t there = size < f->eof - address ? size : (size_t)(f->eof - address);
	if (f->info.bytes) {
		memcpy(buffer, (const char *)f->info.bytes + address, there);
		return 0;
	}
	for (size_t done = 0; done < there;) {
		const ssize_t n = pread(f->fd, (char *)buffer + done, there - done, (off_t)(address + done));
		if (n < 0 && EINTR == errno) continue;
		if (n < 0) note(f, errno);
		if (n <= 0) break;
		done += (size_t)n;
	}
	return 0;
}

static herr_t driver_write(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t address, size_t size, const void *buffer)
{
	(void)type;
	(void)transfer;
	driver_file *f = (driver_file *)file;
	if (f->info.bytes) return -1; /* opened for reading: HDF5 doesn't come here */
	for (size_t done = 0; done < size && !*f->info.error;) {
		const ssize_t n = pwrite(f->fd, (const char *)buffer + done, size - done, (off_t)(address + done));
		if (n > 0)
			done += (size_t)n;
		else if (n < 0 && EINTR != errno)
			note(f, errno);
	}
	if (address + size > f->eof) f->eof = address + size;
	return 0;
}

static herr_t driver_truncate(H5FD_t *file, hid_t transfer, hbool_t closing)
{
	(void)transfer;
	(void)closing;
	driver_file *f = (driver_file *)file;
	if (f->info.bytes || f->eoa == f->eof) return 0;
	if (ftruncate(f->fd, (off_t)f->eoa)) note(f, errno);
	f->eof = f->eoa;
	return 0;
}

static const H5FD_class_t driver_class = {.name = "optla",
                                          .maxaddr = INT64_MAX,
                                          .fc_degree = H5F_CLOSE_STRONG,
                                          .fapl_size = sizeof(optla_h5_driver_info),
                                          .open = driver_open,
                                          .close = driver_close,
                                          .query = driver_query,
                                          .get_eoa = driver_get_eoa,
                                          .set_eoa = driver_set_eoa,
                                          .get_eof = driver_get_eof,
                                          .read = driver_read,
                                          .write = driver_write,
                                          .truncate = driver_truncate,
                                          .fl_map = H5FD_FLMAP_DICHOTOMY};

hid_t optla_h5_set_driver_(hid_t access, const optla_h5_driver_info *info)
{
	const hid_t driver = H5FDregister(&driver_class);
	if (driver >= 0 && H5Pset_driver(access, driver, info) >= 0) return driver;
	if (driver >= 0) H5FDunregister(driver);
	return H5I_INVALID_HID;
}
