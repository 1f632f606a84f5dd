"""What the rivals share: the command line that `shakedown prove --examinee` uses, and reading an experiment."""

import csv
import json
import math
import subprocess
import sys
import tomllib
from pathlib import Path

UNITS = {"mm": 1e-3, "g": 9.80665}


def answer(name, diagnose):
    """Runs `diagnose(path)` as `NAME diagnose EXPERIMENT --json -` and prints its object."""
    arguments = sys.argv[1:]
    if arguments == ["--version"]:
        print(name)
        return 0
    if len(arguments) < 2 or arguments[0] != "diagnose":
        print(f"usage: {sys.argv[0]} diagnose EXPERIMENT.toml --json -", file=sys.stderr)
        return 2
    print(json.dumps(diagnose(Path(arguments[1]))))
    return 0


def experiment(path):
    """The experiment as a dictionary."""
    return tomllib.loads(path.read_text())


def runs(path, wanted):
    """The runs of one use, each a dictionary from channel to a list of SI values; all runs where none says its use."""
    stated = experiment(path)
    channels = stated["channels"]
    chosen = [run for run in stated["runs"] if run.get("use", wanted) == wanted]
    out = []
    for run in chosen:
        with open(path.parent / run["file"], newline="") as file:
            rows = list(csv.DictReader(file))
        values = {}
        for channel, source in channels.items():
            factor = UNITS.get(source.get("unit", "1"), 1.0)
            values[channel] = [number(row[source["column"]]) * factor for row in rows]
        out.append(values)
    return out


def number(text):
    """A cell as a number; an empty one is none."""
    return float(text) if text.strip() else math.nan


def identify(path):
    """Fits the experiment's free parameters with `shakedown identify`; none where it fails."""
    done = subprocess.run(["shakedown", "identify", str(path), "--json", "-"], capture_output=True, text=True)
    return json.loads(done.stdout) if done.returncode == 0 else None


def with_effects(path, effects):
    """The same experiment with effects declared and freed, as a file beside it."""
    text = path.read_text()
    if effects:
        names = ", ".join(f'"{effect}"' for effect in effects)
        lines = []
        for line in text.splitlines():
            if line.startswith("fit = ["):
                line = line.rstrip("]") + f", {names}]"
            lines.append(line)
        text = "\n".join(lines) + "\n"
        if "fit = [" not in text:
            text = text.replace("\n[channels]", f"fit = [{names}]\n\n[channels]", 1)
        text = text.replace("\n[channels]", f"effects = [{names}]\n\n[channels]", 1)
    other = path.with_name("rival-" + "-".join(effects or ["stated"]) + ".toml")
    other.write_text(text)
    return other
