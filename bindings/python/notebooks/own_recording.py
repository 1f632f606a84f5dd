# %% [markdown]
# # From a recording of one's own to a named effect
#
# Two runs of a table are given as columns of text, and a model that leaves something out. Which physics is missing? Here the runs are
# simulated on a table that is faster in one direction than in the other, which the model does not know, so that the answer can be
# checked.

# %%
import tempfile
from pathlib import Path

import numpy as np

import shakedown_table as st

folder = Path(tempfile.mkdtemp())
MODEL = 'kind = "servo"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n'

# %% [markdown]
# ## The table, and what its sensors record
#
# `table.toml` is the truth: the model with the effect. Two motions are played to it, and what comes out is written with noise.

# %%
truth = folder / "table.toml"
truth.write_text(f'[model]\n{MODEL}effects = ["asymmetric_gain"]\n[effects.asymmetric_gain]\ndifference = 0.15\n')
settings = st.Settings("displacement.proportional = 3.7\ndisplacement.integral = 0.6\n")
rng = np.random.default_rng(1)


def recorded(name: str, acceleration: np.ndarray, dt: float) -> None:
    """Plays an acceleration (m/s2) to the table and writes what its sensors would have recorded."""
    record = folder / f"played-{name}"
    rows = "".join(f"{k * dt:.3f},{a:.6f}\n" for k, a in enumerate(acceleration))
    record.write_text("time [s],acceleration [m/s2]\n" + rows)
    trial = st.simulate(st.read_record(record).motion(), settings, table=truth)
    arrays = trial.arrays
    displacement = arrays["displacement"] + 2e-5 * rng.standard_normal(len(arrays["displacement"]))
    time = np.arange(len(displacement)) * trial.scores["dt"]
    columns = np.column_stack([time, arrays["command"], displacement])
    np.savetxt(folder / name, columns, delimiter=",", header="t,u,x", comments="", fmt="%.9g")


t = np.arange(0.0, 20.0, 0.01)
window = np.sin(np.pi * t / t[-1]) ** 2
recorded("a.csv", 0.6 * window * np.sin(2 * np.pi * (0.5 * t + 0.05 * t**2)), 0.01)
recorded("b.csv", 0.4 * window * (np.sin(2 * np.pi * 0.8 * t) + np.sin(2 * np.pi * 2.3 * t + 1.0)), 0.01)

# %% [markdown]
# ## The experiment
#
# The model as it is believed, the columns, the runs: one to fit, one to judge.

# %%
(folder / "experiment.toml").write_text(
    f"""[model]
{MODEL}fit = ["b0", "a1"]
[channels]
time = {{ column = "t", unit = "s" }}
command = {{ column = "u", unit = "m" }}
displacement = {{ column = "x", unit = "m", noise = 2e-5 }}
[[runs]]
file = "a.csv"
use = "fit"
[[runs]]
file = "b.csv"
use = "holdout"
"""
)

# %% [markdown]
# ## The diagnosis

# %%
verdict = st.diagnose(folder / "experiment.toml", progress=lambda what, share: print(f"{share:4.0%} {what}"))
print(verdict["verdict"])
for effect in verdict["effects"]:
    print(effect["id"], effect["equation"], effect["parameters"])

# %%
assert [effect["id"] for effect in verdict["effects"]] == ["asymmetric_gain"], verdict["effects"]
