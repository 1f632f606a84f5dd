import os
from collections.abc import Callable, Sequence
from typing import final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import disjoint_base

__all__ = [
    "Command",
    "Controller",
    "Motion",
    "Record",
    "Sample",
    "Settings",
    "ShakedownError",
    "__version__",
    "design",
    "diagnose",
    "fit_record",
    "identify",
    "read_record",
    "simulate",
    "sweep",
]

__version__: str

class ShakedownError(ValueError):
    code: int

@final
class Settings:
    def __new__(cls, text: str = "") -> Settings: ...
    def set(self, name: str, value: bool | float | str) -> Settings: ...
    def validate(self) -> None: ...
    def to_toml(self) -> str: ...
    @property
    def rate(self) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Sample:
    reference: float
    displacement: float
    acceleration: float
    external: float
    velocity: float
    pressure_difference: float
    reference_velocity: float
    reference_acceleration: float
    second_displacement: float
    limit_switch: bool
    relay_closed: bool
    def __new__(
        cls,
        reference: float = 0.0,
        displacement: float = 0.0,
        acceleration: float = 0.0,
        *,
        external: float = 0.0,
        velocity: float = 0.0,
        pressure_difference: float = 0.0,
        reference_velocity: float = 0.0,
        reference_acceleration: float = 0.0,
        second_displacement: float = 0.0,
        limit_switch: bool = False,
        relay_closed: bool = False,
    ) -> Sample: ...

@final
class Command:
    @property
    def valve(self) -> float: ...
    @property
    def reference(self) -> float: ...
    @property
    def velocity_limit(self) -> float: ...
    @property
    def state(self) -> str: ...
    @property
    def trip(self) -> int: ...
    @property
    def relay_closed(self) -> bool: ...
    @property
    def saturated(self) -> bool: ...
    @property
    def held(self) -> bool: ...
    @property
    def limited(self) -> bool: ...
    @property
    def missing(self) -> int: ...
    @property
    def changes(self) -> int: ...

@disjoint_base
class Controller:
    def __new__(cls, settings: Settings | None = None) -> Controller: ...
    def retune(self, settings: Settings) -> None: ...
    def request(self, request: str) -> None: ...
    def step(self, sample: Sample) -> Command: ...
    def _steps(self, samples: NDArray[np.uint8], commands: NDArray[np.uint8]) -> None: ...
    @property
    def state(self) -> str: ...

@final
class Record:
    @property
    def name(self) -> str: ...
    @property
    def dt(self) -> float: ...
    @property
    def acceleration(self) -> NDArray[np.float64]: ...
    @property
    def facts(self) -> list[tuple[str, str]]: ...
    def motion(self, *, as_is: bool = False) -> Motion: ...

@final
class Motion:
    @property
    def dt(self) -> float: ...
    @property
    def displacement(self) -> NDArray[np.float64]: ...
    @property
    def velocity(self) -> NDArray[np.float64]: ...
    @property
    def acceleration(self) -> NDArray[np.float64]: ...

def read_record(
    path: str | os.PathLike[str], dt: float | None, unit: str | None, channel: str | None
) -> Record: ...
def fit_record(
    record: Record,
    method: str,
    velocity: float,
    stroke: float,
    acceleration: float | None,
    jerk: float | None,
    stall: float | None,
    preview: float | None,
    as_is: bool,
    progress: Callable[[str, float], object] | None,
) -> tuple[str, Motion]: ...
def simulate(
    motion: Motion, settings: Settings, table: str | os.PathLike[str] | None
) -> tuple[dict[str, NDArray[np.float64]], str]: ...
def sweep(
    gains: Sequence[tuple[float, float]],
    amplitudes: Sequence[float],
    frequencies: Sequence[float],
    progress: Callable[[str, float], object] | None = None,
) -> str: ...
def design(
    path: str | os.PathLike[str],
    spread: float,
    margins: tuple[float, float],
    rate: float,
    progress: Callable[[str, float], object] | None = None,
) -> tuple[str, Settings]: ...
def identify(path: str | os.PathLike[str]) -> str: ...
def diagnose(
    path: str | os.PathLike[str], progress: Callable[[str, float], object] | None = None
) -> str: ...
