"""Sparse regression of the measured acceleration on terms in the states that it can have, by PySINDy's STLSQ."""

import sys

import numpy as np
from pysindy.optimizers import STLSQ

from asked import answer, runs

# Shares of the acceleration's RMS below which a term is dropped; the one that predicts the run held out best is taken, and of
# those within a twentieth of it the sparsest.
THRESHOLDS = (0.02, 0.05, 0.1, 0.2, 0.4)
SLACK = 1.05


def terms(x, v, u, t):
    """Terms by the name of the effect they would be; none for those that the stated model has."""
    fastest, farthest = np.max(np.abs(v)) + 1e-12, np.max(np.abs(x)) + 1e-12
    slow = 0.05 * fastest
    return [
        (None, u),
        (None, v),
        ("null_bias", np.ones_like(x)),
        ("spring", x),
        ("coulomb_friction", np.tanh(v / slow)),
        ("stribeck_friction", np.tanh(v / slow) * np.exp(-((v / (4 * slow)) ** 2))),
        ("flow_softening", u * np.abs(v / fastest) ** 3),
        ("asymmetric_gain", np.maximum(u, 0.0)),
        ("gain_drift", t * u),
        ("valve_deadband", np.tanh(u / (0.05 * np.max(np.abs(u)) + 1e-12))),
        ("end_stop", np.where(np.abs(x) > 0.8 * farthest, x - 0.8 * farthest * np.sign(x), 0.0)),
        ("command_delay", np.gradient(u, t)),
        ("unlisted", v * np.abs(v)),
        ("unlisted", x**3),
        ("unlisted", u**3),
    ]


def samples(run):
    """Displacement, velocity, command, time and acceleration on rows without gaps."""
    t = np.asarray(run["time"])
    reference = np.asarray(run["reference"])
    x = np.asarray(run.get("displacement", run["reference"]))
    x = np.where(np.isfinite(x), x, reference)
    width = max(3, int(0.02 / np.median(np.diff(t))) | 1)
    smooth = np.convolve(x, np.ones(width) / width, mode="same")
    v = np.gradient(smooth, t)
    a = np.asarray(run["acceleration"]) if "acceleration" in run else np.gradient(v, t)
    u = np.asarray(run["command"]) if "command" in run else reference - x
    sound = np.isfinite(a) & np.isfinite(u)
    return x[sound], v[sound], u[sound], t[sound], a[sound]


def regression(path, wanted):
    """Terms' names, their values and the measured acceleration over the runs of one use."""
    columns, targets, names = [], [], []
    for run in runs(path, wanted):
        x, v, u, t, a = samples(run)
        listed = terms(x, v, u, t)
        names = [name for name, _ in listed]
        columns.append(np.column_stack([value for _, value in listed]))
        targets.append(a)
    return names, np.vstack(columns), np.concatenate(targets)


def diagnose(path):
    names, matrix, target = regression(path, "fit")
    _, other, foreseen = regression(path, "holdout")
    scale = np.sqrt(np.mean(matrix**2, axis=0)) + 1e-30
    rms = np.sqrt(np.mean(target**2)) + 1e-30
    tried = []
    for threshold in THRESHOLDS:
        fit = STLSQ(threshold=threshold, alpha=1e-3, max_iter=50).fit(matrix / scale, (target / rms)[:, None])
        weights = np.ravel(fit.coef_)
        error = np.mean((foreseen / rms - (other / scale) @ weights) ** 2)
        tried.append((error, weights))
    least = min(error for error, _ in tried)
    weights = [weights for error, weights in tried if error <= SLACK * least][-1]
    found = sorted({name for name, weight in zip(names, weights) if weight and name})
    return {"verdict": "mismatch" if found else "consistent", "effects": [{"id": name} for name in found]}


if __name__ == "__main__":
    sys.exit(answer("PySINDy", diagnose))
