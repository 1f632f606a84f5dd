"""SciPy's least_squares over the simulation of the bench, compiled by numba, its runs in parallel.

Arguments: the file of runs (reference, displacement, acceleration of each, as doubles), their number, the starting values.
Prints seconds (best of three, compilation left out), the sum of squares, the six parameters.
"""
import sys
import time

import numba
import numpy as np
from scipy.optimize import least_squares

DT, KP, KI = 1e-3, 8.0, 1.0
NOISE = (2e-5, 0.2)
runs = int(sys.argv[2])
start = np.array([float(x) for x in sys.argv[3].split(",")])
data = np.fromfile(sys.argv[1], dtype="<f8").reshape(runs, 3, -1)
numba.set_num_threads(min(2, numba.config.NUMBA_NUM_THREADS))


@numba.njit(inline="always")
def velocity(z, b1, u, limit):
    return min(max(z + b1 * u, -limit), limit)


@numba.njit(parallel=True)
def residuals(p, starts, data):
    b1, b0, a1, limit, bias, offset = p
    runs, _, n = data.shape
    out = np.empty((runs, 2, n))
    h = DT
    for r in numba.prange(runs):
        z, x, total, before, u = 0.0, starts[r], 0.0, 0.0, 0.0
        for k in range(n):
            error = data[r, 0, k] - x
            total += error
            u = KP * error + KI * h * total + bias
            out[r, 0, k] = (data[r, 1, k] - x) / NOISE[0]
            c = (b0 - b1 * a1) * u
            # The classical fourth-order rule; half way by its dense output.
            k1 = -a1 * z + c
            k2 = -a1 * (z + 0.5 * h * k1) + c
            k3 = -a1 * (z + 0.5 * h * k2) + c
            k4 = -a1 * (z + h * k3) + c
            v1 = velocity(z, b1, u, limit)
            v2 = velocity(z + 0.5 * h * k1, b1, u, limit)
            v3 = velocity(z + 0.5 * h * k2, b1, u, limit)
            v4 = velocity(z + h * k3, b1, u, limit)
            middle = velocity(z + h / 24.0 * (5.0 * k1 + 4.0 * (k2 + k3) - k4), b1, u, limit)
            out[r, 1, k] = (data[r, 2, k] - (middle - before) / h - offset) / NOISE[1]
            before = middle
            z += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
            x += h / 6.0 * (v1 + 2.0 * (v2 + v3) + v4)
    return out.ravel()


starts = np.zeros(runs)
scale = np.array([1.0, 100.0, 50.0, 0.2, 1e-3, 1e-2])
residuals(start, starts, data)
best, answer = np.inf, None
for _ in range(3):
    begun = time.perf_counter()
    answer = least_squares(lambda q: residuals(q * scale, starts, data), start / scale)
    best = min(best, time.perf_counter() - begun)
print(best, 2.0 * answer.cost, *(answer.x * scale))
