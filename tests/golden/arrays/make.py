#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the array files of this folder: see README.md. Needs NumPy and h5py."""
import os
import sys

import h5py
import numpy as np

here = os.path.dirname(os.path.abspath(__file__))
values = np.array([[0, 1, 2], [3, 4, 100]])


def npy(name, array, version=None):
    with open(os.path.join(here, name + ".npy"), "wb") as f:
        np.lib.format.write_array(f, array, version=version)


for code in ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f2", "f4", "f8", "c8", "c16"]:
    little = values.astype("<" + code)
    if code[0] == "c":
        little = little - 1j * little / 4
    npy(code, little.astype("<" + code))
    if code[1:] != "1":
        npy(code + "_big", little.astype(">" + code))
npy("b1", values % 2 == 1)
npy("fortran", np.asfortranarray(values.astype("<f4")))
npy("fortran3", np.asfortranarray(np.arange(24, dtype="<i2").reshape(2, 3, 4)))
npy("dims8", np.arange(4, dtype="<f4").reshape(1, 2, 1, 1, 2, 1, 1, 1))
npy("scalar", np.array(7.5, dtype="<f8"))
npy("empty", np.zeros((0, 3), dtype="<f4"))
npy("version2", values.astype("<f4"), (2, 0))
npy("version3", values.astype("<f4"), (3, 0))
npy("extremes_i8", np.array([-(2**63), -1, 2**63 - 1], dtype="<i8"))
npy("extremes_u8", np.array([0, 2**63, 2**64 - 1], dtype="<u8"))
npy("extremes_f2", np.array([0x8000, 1, 0x3FF, 0x400, 0x7BFF, 0x7C00, 0xFC00, 0x7E00], dtype="<u2").view("<f2"))
npy("extremes_f4", np.array([np.nan, np.inf, -np.inf, 1e-45], dtype="<f4"))

# not readable, and said so
npy("structured", np.array([(1, 2.0)], dtype=[("a", "<i4"), ("b", "<f8")]))
npy("text", np.array(["abc"]))
npy("longdouble", np.array([1], dtype=np.longdouble))
npy("date", np.array(["2020-01-01"], dtype="datetime64[D]"))
npy("dims9", np.zeros((1,) * 9, dtype="<f4"))

np.savez(os.path.join(here, "two.npz"), photos=values.astype("<f4"), lights=np.arange(3.0))
np.savez_compressed(os.path.join(here, "packed.npz"), values.astype("<f8"))

with h5py.File(os.path.join(here, "h5py.h5"), "w", libver=("earliest", "v110")) as f:
    f["f4"] = values.astype("<f4")
    f["big"] = values.astype(">f8")
    f["i2"] = values.astype("<i2")
    f["b1"] = values % 2 == 1
    f["f2"] = values.astype("<f2")
    f["c8"] = (values - 1j * values / 4).astype("<c8")
    f["group/c16"] = (values - 1j * values / 4).astype("<c16")
    f["scalar"] = 7.5
    f["text"] = "abc"
    f.create_dataset("packed", data=values.astype("<f4"), chunks=(1, 2), compression="gzip", shuffle=True)
    f["dims3"] = np.arange(24, dtype="<i2").reshape(2, 3, 4)
    f.attrs["note"] = "h\u00e9"
    f.attrs["fixed"] = np.bytes_(b"abc")
    f.attrs["gain"] = 0.25
with h5py.File(os.path.join(here, "h5py_one.h5"), "w", libver="latest") as f:
    f.create_dataset("group/only", data=values.astype("<f4"))
print("NumPy", np.__version__, "h5py", h5py.__version__, file=sys.stderr)
