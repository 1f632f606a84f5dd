"""What the package promises, on generated and given data: facade.py SHAKEDOWN [EXPERIMENT.toml ...].

SHAKEDOWN is the command line's binary, whose JSON the package's dictionaries must equal.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import shakedown_table as st

#: What a command says of itself, of its files and of the time it took.
OWN = {"version", "inputs", "seconds", "out", "times_real_time"}


def without(value: object) -> object:
    if isinstance(value, dict):
        return {key: without(inner) for key, inner in value.items() if key not in OWN}
    if isinstance(value, list):
        return [without(inner) for inner in value]
    return value


def command(shakedown: str, *words: str) -> object:
    done = subprocess.run([shakedown, *words, "--json", "-"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return without(json.loads(done.stdout))


def refused(act: Callable[[], object], code: int | None = None) -> str:
    try:
        act()
    except st.ShakedownError as error:
        assert code is None or error.code == code, error.code
        return str(error)
    raise AssertionError("nothing was refused")


def controller() -> None:
    settings = st.Settings("displacement.proportional = 4.0\ndisplacement.integral = 0.0\n[guard]\n")
    assert settings.set("guard.envelope.velocity", 0.5) != settings
    assert st.Settings(settings.to_toml()) == settings
    assert "49" in refused(lambda: st.Controller(settings.set("rate", 49)), 1)
    refused(lambda: settings.set("no.such", 1.0), 8)
    refused(lambda: settings.set("mode", "valve"), 9)
    assert "rate" in refused(lambda: st.Settings("rate = 'fast'"))
    one, all_at_once = st.Controller(settings), st.Controller(settings)
    refused(lambda: one.request("start"), 4)
    refused(lambda: one.request("dance"), 10)
    samples = np.zeros(1000, st.SAMPLE)
    samples["reference"] = 0.01 * np.sin(np.arange(1000) * 0.01)
    for one_of in (one, all_at_once):
        one_of.step(st.Sample())
        one_of.request("arm")
        one_of.request("start")
    valves = [one.step(st.Sample(float(reference))).valve for reference in samples["reference"]]
    assert np.array_equal(np.array(valves, np.float32), all_at_once.steps(samples)["valve"])
    assert all_at_once.steps(samples[::2]).shape == (500,)
    for wrong in (np.zeros(5), [1.0, 2.0]):
        try:
            all_at_once.steps(wrong)
        except TypeError as error:
            assert "SAMPLE" in str(error)
        else:
            raise AssertionError("a wrong array was taken")


def readme() -> None:
    """The README's example runs as it is printed there."""
    text = (Path(__file__).parent.parent / "README.md").read_text()
    names: dict[str, object] = {}
    exec(text.split("```python\n")[1].split("```")[0], names)
    command = names["command"]
    assert isinstance(command, st.Command) and command.state == "running", command


def interpreter_is_free() -> None:
    """Another thread goes on while a long run is computed."""
    samples, counted, done = np.zeros(2_000_000, st.SAMPLE), [0], threading.Event()

    def count() -> None:
        while not done.is_set():
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    before = counted[0]
    st.Controller().steps(samples)
    during = counted[0] - before
    done.set()
    thread.join()
    assert during > 1000, during


def records(shakedown: str, folder: Path) -> None:
    path = folder / "record.csv"
    t = np.arange(0.0, 20.0, 0.01)
    acceleration = 2.0 * np.sin(2 * np.pi * 0.7 * t) * np.exp(-(((t - 8) / 3) ** 2))
    path.write_text("time [s],acceleration [m/s2]\n" + "".join(f"{x:.2f},{y:.6f}\n" for x, y in zip(t, acceleration)))
    record = st.read_record(path)
    assert record.dt == 0.01 and np.allclose(record.acceleration, acceleration, atol=1e-6)
    for method in ("taut", "convex", "clip", "causal"):
        fitted = st.fit_record(record, method=method, velocity=0.15)
        theirs = command(shakedown, "modify", str(path), "--method", method, "--velocity", "0.15")
        assert without(fitted.figures) == theirs, method
    assert np.abs(fitted.motion.velocity).max() < 0.16
    assert "stroke" in refused(lambda: st.fit_record(record, stroke=-1.0))
    assert "method" in refused(lambda: st.fit_record(record, method="wish"))
    assert "nowhere.AT2" in refused(lambda: st.read_record(folder / "nowhere.AT2"))
    trial = st.simulate(fitted.motion, st.Settings("displacement.proportional = 10.0\ndisplacement.integral = 1.0\n"))
    assert set(trial.arrays) >= {"reference", "displacement", "command"} and 0 < trial.scores["e_a"] < 1


def loops(shakedown: str, folder: Path) -> None:
    """Sweeps and designs are the command line's."""
    gains, frequencies = [(3.7, 0.6), (1.0, 0.0)], [1.0, 2.0, 3.0]
    mine = st.sweep(gains, amplitudes=[0.001, 0.05], frequencies=frequencies)
    words = ["sweep", "bode", "--gains", "3.7,0.6", "--gains", "1,0", "--amplitudes", "1,50", "--step", "1", "--to", "3"]
    assert {"bode": without(mine)} == command(shakedown, *words)
    assert "not stable" in refused(lambda: st.sweep([(-1.0, 0.0)]))
    assert "frequencies" in refused(lambda: st.sweep(frequencies=[2.0, 1.0]))
    model = folder / "model.toml"
    model.write_text('[model]\nkind = "servo"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n')
    designed = st.design(model, spread=0.1)
    assert without(designed.figures) == command(shakedown, "design", str(model), "--spread", "0.1")
    assert "tracking" in designed.settings.to_toml()
    assert "spread" in refused(lambda: st.design(model, spread=2.0))
    assert "no gains are safe" in refused(lambda: st.design(model, spread=0.95, gain_margin=30.0))


def work_ends(shakedown: str, folder: Path) -> None:
    """What a progress function raises ends the work, and so does an interrupt, at once."""
    subprocess.run([shakedown, "sweep", "--write", str(folder / "sweeps")], check=True, capture_output=True)
    path, told = folder / "sweeps" / "experiment.toml", []

    def enough(what: str, share: float) -> None:
        told.append(what)
        raise RuntimeError("enough")

    try:
        st.diagnose(path, progress=enough)
    except RuntimeError as error:
        assert str(error) == "enough" and len(told) == 1
    else:
        raise AssertionError("the work went on")
    # A shell that started this in the background has it ignore interrupts.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    begin = time.monotonic()
    try:
        while time.monotonic() - begin < 60:
            st.diagnose(path)
    except KeyboardInterrupt:
        print(f"interrupted after {time.monotonic() - begin:.2f} s")
    else:
        raise AssertionError("an interrupt was not heard")


def experiments(shakedown: str, paths: list[str]) -> None:
    for path in paths:
        told: list[float] = []
        mine = st.diagnose(path, progress=lambda what, share: told.append(share))
        assert without(mine) == command(shakedown, "diagnose", path), path
        assert told
        print(f"diagnose {Path(path).stem}: equal, verdict {mine['verdict']}")
        if mine["verdict"] != "bad-data":
            assert without(st.identify(path)) == command(shakedown, "identify", path), path
            print(f"identify {Path(path).stem}: equal")
    assert "nowhere.toml" in refused(lambda: st.diagnose("nowhere.toml"))


def main(shakedown: str, *paths: str) -> None:
    controller()
    readme()
    interpreter_is_free()
    with tempfile.TemporaryDirectory() as folder:
        records(shakedown, Path(folder))
        loops(shakedown, Path(folder))
        work_ends(shakedown, Path(folder))
    experiments(shakedown, list(paths))
    print(f"{6 + len(paths)} passed, 0 failed")


if __name__ == "__main__":
    main(*sys.argv[1:])
