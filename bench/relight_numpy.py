# SPDX-License-Identifier: BSD-3-Clause
"""Relighting with NumPy, one product whenever a line arrives: the rival of bench_relight.
usage: relight_numpy.py SAMPLES LIGHTS PHOTOS   ->   "numpy VERSION", then for each line "SECONDS SECONDS": D photo after photo, D pixel
after pixel. The same products as a relighting script would write: i = D (P^T p)."""
import sys, time
import numpy as np

samples, lights, photos = map(int, sys.argv[1:4])
rng = np.random.default_rng(1)
d = np.empty((photos, samples), np.float32)
for k in range(photos):
    d[k] = rng.random(samples, dtype=np.float32)
by_pixel = np.ascontiguousarray(d.T)
basis, p = rng.random((lights, photos), dtype=np.float32), rng.random(lights, dtype=np.float32)
out = np.empty(samples, np.float32)
print('numpy', np.__version__, flush=True)
for _ in sys.stdin:
    start = time.perf_counter()
    np.dot(basis.T @ p, d, out=out)
    middle = time.perf_counter()
    np.dot(by_pixel, basis.T @ p, out=out)
    print(middle - start, time.perf_counter() - middle, flush=True)
