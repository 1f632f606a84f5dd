"""Forward selection by BIC on the closed-loop simulator of `shakedown identify`, noise treated as white."""

import json
import math
import subprocess
import sys

from asked import answer, identify, runs, with_effects

MOST = 3


def library():
    done = subprocess.run(["shakedown", "effects", "--json", "-"], capture_output=True, text=True, check=True)
    return [effect["id"] for effect in json.loads(done.stdout)["effects"]]


def score(path, effects, samples):
    """BIC and the fit's parameters; none where there is no fit."""
    fitted = identify(with_effects(path, effects))
    chi2 = ((fitted or {}).get("fit") or {}).get("chi2")
    if not chi2 or not math.isfinite(chi2):
        return None
    return samples * math.log(chi2) + len(fitted["parameters"]) * math.log(samples), fitted


def diagnose(path):
    judged = ("displacement", "acceleration")
    samples = sum(len(run.get(channel, ())) for run in runs(path, "fit") for channel in judged)
    chosen, best = [], score(path, [], samples)
    if best is None:
        return {"verdict": "bad-data"}
    first = {(): best[0]}
    while len(chosen) < MOST:
        trials = {effect: score(path, [*chosen, effect], samples) for effect in library() if effect not in chosen}
        trials = {effect: trial for effect, trial in trials.items() if trial}
        if not chosen:
            first.update({(effect,): trial[0] for effect, trial in trials.items()})
        effect = min(trials, key=lambda one: trials[one][0], default=None)
        if effect is None or trials[effect][0] >= best[0]:
            break
        chosen.append(effect)
        best = trials[effect]
    return {"verdict": "mismatch" if chosen else "consistent", "effects": [named(e, best[1]) for e in chosen],
            "candidates": weights(first)}


def named(effect, fitted):
    own = {key.split(".")[1]: value for key, value in fitted["parameters"].items() if key.startswith(effect + ".")}
    return {"id": effect, "parameters": own}


def weights(scores):
    """Sets with the weight that exp(-BIC / 2) gives them."""
    least = min(scores.values())
    raw = {ids: math.exp(-0.5 * (value - least)) for ids, value in scores.items()}
    return [{"ids": list(ids), "probability": value / sum(raw.values())} for ids, value in raw.items()]


if __name__ == "__main__":
    sys.exit(answer("forward selection by BIC", diagnose))
