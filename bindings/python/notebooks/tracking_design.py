# %% [markdown]
# # Gains of the tracking law from a model and its uncertainty
#
# A model known to 20 % and one known to 5 %: what the margins allow, and how near the table then comes to a motion.

# %%
import tempfile
from pathlib import Path

import numpy as np

import shakedown_table as st

folder = Path(tempfile.mkdtemp())
model = folder / "table.toml"
model.write_text('[model]\nkind = "servo"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n')

# %% [markdown]
# ## A motion within the table's limits

# %%
record = folder / "record.csv"
t = np.arange(0.0, 20.0, 0.01)
acceleration = 1.5 * np.sin(2 * np.pi * 1.5 * t) * np.exp(-(((t - 8) / 3) ** 2))
rows = "".join(f"{x:.2f},{y:.6f}\n" for x, y in zip(t, acceleration))
record.write_text("time [s],acceleration [m/s2]\n" + rows)
motion = st.fit_record(record, velocity=0.2, method="taut").motion

# %% [markdown]
# ## Two designs and the paper's gains

# %%
settings = {"paper's gains": st.Settings("displacement.proportional = 3.70205\ndisplacement.integral = 0.61701\n")}
for spread in (0.2, 0.05):
    designed = st.design(model, spread=spread, gain_margin=6.0, phase_margin=30.0)
    worst = designed.figures["worst"]
    print(f"known to {spread:.0%}: {worst['gain_margin_db']:.1f} dB, {worst['phase_margin_degrees']:.0f} degrees in the worst corner")
    settings[f"tracking law, known to {spread:.0%}"] = designed.settings

# %%
errors = {name: st.simulate(motion, one).scores["e_a"] for name, one in settings.items()}
for name, error in errors.items():
    print(f"{name}: acceleration error {error:.3f}")
assert errors["tracking law, known to 20%"] < errors["paper's gains"]
