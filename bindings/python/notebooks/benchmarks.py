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
# Effects that the experiments name beside their own folder.
shutil.copytree(examples.parent / "effects", folder / "effects")


def experiment(name: str, toml: Path, *recordings: Path) -> Path | None:
    """The experiment beside its recordings, in a folder of its own; none where one of them is not at hand."""
    missing = [recording for recording in recordings if not recording.exists()]
    if missing:
        print(f"SKIPPED: {name}: {missing[0]} is not at hand")
        return None
    place = folder / name
    place.mkdir()
    shutil.copy(toml, place / "experiment.toml")
    for recording in recordings:
        os.symlink(recording.resolve(), place / recording.name)
    return place / "experiment.toml"


# %%
table, emps = data / "shake_table", data / "emps"
cases = [
    ("EMPS", examples / "emps.toml", emps / "DATA_EMPS.mat"),
    ("EMPS with pulses", examples / "emps_pulses.toml", emps / "DATA_EMPS.mat", emps / "DATA_EMPS_PULSES.mat"),
    ("shake table, TAP089", table / "TAP089.toml", table / "2004_1015_TAP089_NS.csv"),
]
for case in cases:
    name, path = case[0], experiment(*case)
    if path is None:
        continue
    verdict = st.diagnose(path)
    named = ", ".join(effect["id"] for effect in verdict["effects"]) or "nothing named"
    assert verdict["verdict"] != "bad-data", f"{name}: {verdict['findings']}"
    print(f"{name}: {verdict['verdict']}, {named}")
    # The pulses' experiment holds no run out: `cargo xtask benchmarks` judges it as its task does.
    if judged := verdict["holdout"]:
        before, after = judged["before"]["chi2"], judged["after"]["chi2"]
        print(f"  chi2 of the hold-out runs {before:.3g} -> {after:.3g}")
        assert after <= 1.001 * before, name
    else:
        assert "holdout" not in path.read_text(), f"{name}: hold-out runs are not judged"
