"""The twin's FMU, alone and in the loop with the core's, against runs of the command line: twin.py CORE TWIN TABLE TRACE.

TRACE is what `shakedown run scenario.toml --table TABLE --trace TRACE` wrote.
"""

import csv
import struct
import sys

from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

STEP = 0.001
#: The gains of `strong`.
SETTINGS = "displacement.proportional = 10.0\ndisplacement.integral = 1.0\n"


def single(value: float) -> float:
    """As a Float32 carries it."""
    return float(struct.unpack("<f", struct.pack("<f", value))[0])


class Part:
    """An FMU with its variables by name."""

    def __init__(self, fmu: str, text: tuple[str, str], **parameters: float) -> None:
        problems = validate_fmu(fmu)
        assert not problems, problems
        description = read_model_description(fmu)
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.said: list[str] = []
        self.fmu = FMU3Slave(
            instanceName=description.modelName,
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=extract(fmu),
        )
        self.fmu.instantiate(logMessage=lambda _environment, _status, _category, message: self.said.append(str(message)))
        self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.setString([self.references[text[0]]], [text[1]])
        for name, value in parameters.items():
            self.fmu.setFloat64([self.references[name]], [value])
        self.fmu.exitInitializationMode()
        self.ticks = 0

    def step(self, step: float = STEP) -> None:
        self.fmu.doStep(currentCommunicationPoint=self.ticks * STEP, communicationStepSize=step)
        self.ticks += 1

    def of(self, *names: str) -> list[int]:
        return [self.references[name] for name in names]


def columns(path: str) -> dict[str, list[float]]:
    with open(path, newline="") as file:
        head, *rows = csv.reader(file)
    return {name.split(" [")[0]: [float(row[k]) for row in rows] for k, name in enumerate(head)}


def equal(what: str, tick: int, mine: float, theirs: float) -> None:
    assert mine == theirs, f"{what} at tick {tick}: {mine!r} by the FMU, {theirs!r} by the command line"


def alone(fmu: str, table: str, trace: dict[str, list[float]]) -> None:
    """The run's commands move the table through the run's displacements and accelerations, bit for bit."""
    twin = Part(fmu, ("table", table), start=trace["displacement"][0], area_per_mass=2e-6)
    outputs = twin.of("displacement", "acceleration", "pressure_difference")
    for k, command in enumerate(trace["command"]):
        displacement, acceleration, pressure = twin.fmu.getFloat64(outputs)
        equal("displacement", k, displacement, trace["displacement"][k])
        equal("acceleration", k, acceleration, trace["acceleration"][k])
        assert abs(pressure) < 1e8, f"tick {k}: {pressure} Pa"
        twin.fmu.setFloat64(twin.of("valve"), [command])
        twin.step()


def together(core_fmu: str, fmu: str, table: str, trace: dict[str, list[float]]) -> None:
    """Both FMUs in a loop, the core first in each step, are the run."""
    twin = Part(fmu, ("table", table), start=trace["displacement"][0])
    core = Part(core_fmu, ("settings", SETTINGS))
    inputs = core.of("reference", "displacement", "acceleration", "velocity")
    sensors = twin.of("displacement", "acceleration", "velocity")
    for k, reference in enumerate(trace["reference"]):
        displacement, acceleration, velocity = twin.fmu.getFloat64(sensors)
        core.fmu.setFloat32(inputs, [reference, displacement, acceleration, velocity])
        core.step()
        (valve,) = core.fmu.getFloat32(core.of("valve"))
        equal("displacement in the loop", k, displacement, trace["displacement"][k])
        equal("command in the loop", k, valve, single(trace["command"][k]))
        twin.fmu.setFloat64(twin.of("valve"), [valve])
        twin.step()


def refused(fmu: str) -> None:
    """What is wrong is an error with words, and moves nothing."""
    twin = Part(fmu, ("table", ""))
    for value, step, word in ((float("nan"), STEP, "no number"), (0.0, 2 * STEP, "one tick")):
        twin.fmu.setFloat64(twin.of("valve"), [value])
        failed(lambda: twin.step(step))
        assert word in twin.said[-1], twin.said
    failed(lambda: twin.fmu.setFloat64(twin.of("start"), [0.1]))
    assert "before the first step" in twin.said[-1], twin.said
    twin.fmu.setFloat64(twin.of("valve"), [0.1])
    twin.step()
    moved, pressure = twin.fmu.getFloat64(twin.of("displacement", "pressure_difference"))
    assert moved > 0.0 and pressure != pressure
    twin.fmu.reset()
    twin.fmu.enterInitializationMode(startTime=0.0)
    twin.fmu.setString(twin.of("table"), ['[model]\nkind = "pendulum"\n'])
    failed(twin.fmu.exitInitializationMode)
    assert "pendulum" in twin.said[-1] and "line 2" in twin.said[-1], twin.said
    twin.fmu.freeInstance()


def failed(act) -> None:  # type: ignore[no-untyped-def]
    try:
        act()
    except Exception:
        return
    raise AssertionError("nothing was refused")


def main(core: str, twin: str, table: str, trace: str) -> None:
    with open(table) as file:
        text = file.read()
    run = columns(trace)
    alone(twin, text, run)
    together(core, twin, text, run)
    refused(twin)
    print(f"{len(run['command'])} ticks, alone and in the loop: the same bits as the command line's")


if __name__ == "__main__":
    main(*sys.argv[1:])
