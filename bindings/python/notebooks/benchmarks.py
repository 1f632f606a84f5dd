# %% [markdown]
# # Three benchmark recordings
#
# The EMPS positioning axis, the same with force pulses, and a hydraulic shake table under a specimen. None of them is part of the
# project: `SHAKEDOWN_DATA` names the folder that has them, and what is not there is skipped.

# %%
import os
import shutil
import tempfile
from pathlib import Path

import shakedown_table as st

data = Path(os.environ.get("SHAKEDOWN_DATA", "../shared/data")) / "recordings"
examples = Path(__file__).resolve().parents[3] / "examples" / "recordings"
folder = Path(tempfile.mkdtemp())


def experiment(name: str, toml: Path, recording: Path) -> Path | None:
    """The experiment beside its recording, in a folder of its own; none where the recording is not at hand."""
    if not recording.exists():
        print(f"SKIPPED: {name}: {recording} is not at hand")
        return None
    place = folder / name
    place.mkdir()
    shutil.copy(toml, place / "experiment.toml")
    os.symlink(recording.resolve(), place / recording.name)
    return place / "experiment.toml"


# %%
table = data / "shake_table"
cases = [
    ("EMPS", examples / "emps.toml", data / "emps" / "DATA_EMPS.mat"),
    ("EMPS with pulses", examples / "emps_pulses.toml", data / "emps" / "DATA_EMPS_PULSES.mat"),
    ("shake table, TAP089", table / "TAP089.toml", table / "2004_1015_TAP089_NS.csv"),
]
for name, toml, recording in cases:
    path = experiment(name, toml, recording)
    if path is None:
        continue
    verdict = st.diagnose(path)
    named = ", ".join(effect["id"] for effect in verdict["effects"]) or "nothing named"
    judged = verdict["holdout"]
    assert judged is not None, f"{name}: {verdict['verdict']}: {verdict['findings']}"
    before, after = judged["before"]["chi2"], judged["after"]["chi2"]
    print(f"{name}: {verdict['verdict']}, {named}; chi2 of the hold-out runs {before:.3g} -> {after:.3g}")
    assert after <= 1.001 * before, name
