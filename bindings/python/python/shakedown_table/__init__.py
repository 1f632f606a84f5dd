"""Control core and host library of shakedown, for hydraulic shake tables. SI units throughout.

The controller is the one that runs on the device: `Controller.step` gives the same bits. What the library finds comes as the
dictionaries that the command line writes as JSON.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._native import Command, Motion, Record, Sample, Settings, ShakedownError, __version__

__all__ = [
    "COMMAND",
    "SAMPLE",
    "Command",
    "Controller",
    "Designed",
    "Fitted",
    "Motion",
    "Record",
    "Sample",
    "Settings",
    "ShakedownError",
    "Trial",
    "__version__",
    "design",
    "diagnose",
    "fit_record",
    "identify",
    "read_record",
    "simulate",
    "sweep",
]

#: One sample of a run; `flags` has bit 0 for the limit switch, bit 1 for the relay's contact.
SAMPLE = np.dtype(
    [
        ("reference", "<f4"),
        ("displacement", "<f4"),
        ("acceleration", "<f4"),
        ("external", "<f4"),
        ("velocity", "<f4"),
        ("pressure_difference", "<f4"),
        ("reference_velocity", "<f4"),
        ("reference_acceleration", "<f4"),
        ("second_displacement", "<f4"),
        ("flags", "<u4"),
    ]
)

#: One command of a run; `status` is the word of docs/hosts.md.
COMMAND = np.dtype([("valve", "<f4"), ("reference", "<f4"), ("velocity_limit", "<f4"), ("status", "<u4")])

Progress = Callable[[str, float], object]
Path = str | os.PathLike[str]


@dataclass(frozen=True)
class Fitted:
    """A record fitted to limits: the motion, and the command line's JSON of `shakedown modify`."""

    motion: Motion
    figures: dict[str, Any]


@dataclass(frozen=True)
class Trial:
    """A run of the closed loop: arrays by name (SI, the true motion), and how near the table came to the motion."""

    arrays: dict[str, NDArray[np.float64]]
    scores: dict[str, float]


@dataclass(frozen=True)
class Designed:
    """Gains of the tracking law: the settings, and the command line's JSON of `shakedown design`."""

    settings: Settings
    figures: dict[str, Any]


class Controller(_native.Controller):
    """The control core: `step` for one tick, `steps` for a run."""

    def steps(self, samples: ArrayLike) -> NDArray[np.void]:
        """A run: an array of SAMPLE in, an array of COMMAND out, the interpreter free meanwhile."""
        given = np.asarray(samples)
        if given.dtype != SAMPLE:
            raise TypeError(f"expected an array of shakedown_table.SAMPLE, not of {given.dtype}")
        flat = np.ascontiguousarray(given).reshape(-1)
        commands = np.empty(flat.shape, COMMAND)
        self._steps(flat.view(np.uint8), commands.view(np.uint8))
        return commands.reshape(given.shape)


def diagnose(experiment: Path, *, progress: Progress | None = None) -> dict[str, Any]:
    """Where model and recordings part, what physics was left out, how much better it fits: the command line's JSON.

    `experiment` is the file that `shakedown init` writes. `progress` is told what is being done and a share of the whole (NaN
    where that is not known); what it raises, and Ctrl-C, end the work.
    """
    verdict: dict[str, Any] = json.loads(_native.diagnose(experiment, progress))
    return verdict


def identify(experiment: Path) -> dict[str, Any]:
    """Fits the parameters that the experiment lists, with intervals, and judges the model on the hold-out runs."""
    model: dict[str, Any] = json.loads(_native.identify(experiment))
    return model


def read_record(
    path: Path, *, dt: float | None = None, unit: str | None = None, channel: str | None = None
) -> Record:
    """Reads a ground-motion record; `dt` (s) and `unit` where the file states none, `channel` where it has several."""
    return _native.read_record(path, dt, unit, channel)


def fit_record(
    record: Record | Path,
    *,
    velocity: float = 0.242,
    stroke: float = 0.12,
    acceleration: float | None = None,
    jerk: float | None = None,
    stall: float | None = None,
    method: str = "convex",
    preview: float | None = None,
    as_is: bool = False,
    progress: Progress | None = None,
) -> Fitted:
    """Fits a record to a table's limits (m/s, m, m/s2, m/s3, m/s2): convex, taut, clip, causal or preview."""
    given = record if isinstance(record, Record) else read_record(record)
    figures, motion = _native.fit_record(
        given, method, velocity, stroke, acceleration, jerk, stall, preview, as_is, progress
    )
    return Fitted(motion, json.loads(figures))


def simulate(motion: Motion, settings: Settings | None = None, *, table: Path | None = None) -> Trial:
    """Plays a motion to the control core in the loop with a table: the paper's, or that of a model file."""
    arrays, scores = _native.simulate(motion, settings or Settings(), table)
    return Trial(arrays, json.loads(scores))


def sweep(
    gains: Sequence[tuple[float, float]] = ((3.70205, 0.61701),),
    *,
    amplitudes: Sequence[float] = (0.001, 0.01, 0.1),
    frequencies: Sequence[float] = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0),
    progress: Progress | None = None,
) -> list[dict[str, Any]]:
    """Bode diagrams of the displacement loop (Kp, Ki in 1/s) around the paper's plant, by amplitude (m) and frequency (Hz).

    One dictionary a pair of gains: the part `bode` of the command line's JSON of `shakedown sweep`.
    """
    pairs = [(float(kp), float(ki)) for kp, ki in gains]
    swept: list[dict[str, Any]] = json.loads(
        _native.sweep(pairs, [float(a) for a in amplitudes], [float(f) for f in frequencies], progress)
    )
    return swept


def design(
    model: Path,
    *,
    spread: float = 0.3,
    gain_margin: float = 6.0,
    phase_margin: float = 30.0,
    rate: float = 1000.0,
    progress: Progress | None = None,
) -> Designed:
    """Gains of the tracking law for the model of a file (`identify --out`, `diagnose --model`) and its uncertainty.

    `spread` is the relative uncertainty, each way, of what the model states no interval for; the margins (dB, degrees) hold in
    every corner; `rate` is the control rate, Hz. Refused where no gains are safe.
    """
    figures, settings = _native.design(model, spread, (gain_margin, phase_margin), rate, progress)
    return Designed(settings, json.loads(figures))
