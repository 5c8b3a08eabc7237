/* SPDX-License-Identifier: BSD-3-Clause */
/* The inside of HDF5 files, shared by h5.c (files), h5_attr.c (attributes) and h5_data.c (datasets).

   The HDF5 library of most machines is built for one thread. A mutex lets one call of ours in at a time, whichever context it
   comes from, and HDF5's own printing of errors is switched off for the length of that call only. A program that calls HDF5 itself
   from another thread at the same time must not. */
#ifndef OPTLA_H5_IMPL_H
#define OPTLA_H5_IMPL_H

#include "io/h5.h"
#include "io/h5_driver.h"
#include "optla/image.h"

typedef struct {
	bool failed;
	int error;        /* errno, 0 if no call of the system failed */
	char reason[160]; /* of the innermost entry of HDF5's stack, the one that says most */
} optla_h5_failure;

struct optla_h5 {
	optla_ctx *ctx;
	char *path, *temporary;   /* temporary: NULL when reading */
	hid_t file, driver;       /* driver: of this file alone, negative: HDF5's own */
	int write_error;          /* errno of the first write that failed: see h5_driver.c */
	optla_h5_failure failure; /* the first one since the guard was taken */
};

typedef struct {
	H5E_auto2_t print;
	void *data;
} optla_h5_guard;

/* Locks HDF5 and keeps its first error in file->failure instead of printing it. Between the two: no return, no call that takes the
   guard again. */
void optla_h5_enter_(optla_h5 *file, optla_h5_guard *guard);
void optla_h5_leave_(const optla_h5_guard *guard);

/* "PATH: 'NAME': DOING: what HDF5 says", code OPTLA_ERR_IO for files being written, OPTLA_ERR_INPUT for files being read. Under the
   guard. name NULL: left out. */
optla_status optla_h5_fail_(const optla_h5 *file, const char *name, const char *doing);

/* In-memory type of a scalar; a compound {r, i} for complex numbers. The caller closes it. Negative on failure. */
hid_t optla_h5_memory_type_(optla_scalar type, const char *re, const char *im);

/* A text attribute of any object, UTF-8 of variable length; under the guard. */
bool optla_h5_put_string_(hid_t object, const char *name, const char *value);

#endif
