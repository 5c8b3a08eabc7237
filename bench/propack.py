# SPDX-License-Identifier: BSD-3-Clause
"""One run of SciPy's svds(solver='propack') on a matrix in a file, seen only through its products.
usage: propack.py T.npy RANK TOLERANCE   ->   "propack SECONDS ERROR PRODUCTS VERSION" """
import os, sys, time
os.environ['SCIPY_USE_PROPACK'] = '1'
import numpy as np, scipy
from scipy.sparse.linalg import LinearOperator, svds

t = np.load(sys.argv[1])
rank, tolerance, count = int(sys.argv[2]), float(sys.argv[3]), 0


def forward(x):
    global count
    count += 1
    return t @ x.ravel()


def back(x):
    global count
    count += 1
    return t.T @ x.ravel()


op = LinearOperator(t.shape, matvec=forward, rmatvec=back, dtype=t.dtype)
start = time.perf_counter()
u, s, vt = svds(op, k=rank, tol=tolerance, solver='propack', random_state=1)
seconds = time.perf_counter() - start
left = 0.0
for n in range(0, t.shape[1], 64):
    left += float(np.sum((t[:, n:n + 64] - (u * s) @ vt[:, n:n + 64]).astype(np.float64) ** 2))
print('propack', seconds, np.sqrt(left / float(np.sum(t.astype(np.float64) ** 2))), count, scipy.__version__)
