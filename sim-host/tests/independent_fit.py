"""The convex fit by another road: least-distance programming on SciPy's NNLS (Lawson and Hanson, chapter 23).

Reads {"dt", "velocity", "limit", "stroke"} from standard input; prints the least E_a within both limits, at rest at both
ends and at the centre at the end.
"""
import json
import sys

import numpy as np
from scipy.optimize import nnls

task = json.load(sys.stdin)
dt, limit, stroke = task["dt"], task["limit"], task["stroke"]
r = np.array(task["velocity"])
n = len(r) - 1
# Unknown is z = D(v - r), the acceleration error; v = v_0 + cumsum(z + D r) with v_0 = 0.
velocity = np.tril(np.ones((n, n)))
v_free = np.cumsum(np.diff(r))
displacement = dt * (np.tril(np.ones((n, n))) - 0.5 * np.eye(n)) @ velocity
x_free = dt * (np.cumsum(v_free) - 0.5 * v_free)
rows, least = [], []
for matrix, free, bound in ((velocity, v_free, limit), (displacement, x_free, stroke)):
    for side in (1.0, -1.0):
        rows.append(side * matrix / bound)
        least.append(-1.0 - side * free / bound)
    for side in (1.0, -1.0):
        rows.append(side * matrix[-1:] / bound)
        least.append(-side * free[-1:] / bound)
g, h = np.vstack(rows), np.concatenate(least)
# min |z| subject to g z >= h: the residual of NNLS on [g'; h'] u = (0, ..., 0, 1) points along z.
e = np.vstack([g.T, h])
f = np.zeros(n + 1)
f[-1] = 1.0
u, _ = nnls(e, f, maxiter=100 * e.shape[1])
residual = e @ u - f
z = -residual[:n] / residual[n]
print(json.dumps({"e_a": float(np.linalg.norm(z) / np.linalg.norm(np.diff(r))), "worst": float(np.min(g @ z - h))}))
