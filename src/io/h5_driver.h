/* SPDX-License-Identifier: BSD-3-Clause */
/* A file driver for HDF5 whose failures are kept beside HDF5: see h5_driver.c. */
#ifndef OPTLA_H5_DRIVER_H
#define OPTLA_H5_DRIVER_H

#define H5_USE_110_API /* the newer libraries keep the calls of 1.10 under their old names */
#include <hdf5.h>
#include <stdbool.h>
#include <stdlib.h>

typedef struct {
	const void *bytes; /* read from here, borrowed; NULL: write to the file of the given name, which must exist */
	size_t count;
	int *error; /* the first errno, 0 if all went well; outlives the file */
} optla_h5_driver_info;

/* Under the guard of h5_impl.h. Registers the driver for one file; negative on failure. To be given to H5FDunregister() once that file is
   closed and not before: closing drops the file's own hold on the driver first and calls it then (H5FD_close of 1.10.8), so the
   caller must hold it too. */
hid_t optla_h5_set_driver_(hid_t access, const optla_h5_driver_info *info);

#endif
