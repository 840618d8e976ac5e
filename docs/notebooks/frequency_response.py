# ---
# jupyter:
#   jupytext:
#     text_representation: {extension: .py, format_name: percent}
#   kernelspec: {display_name: Python 3, language: python, name: python3}
# ---

# %% [markdown]
# # What friction does to the frequency response
#
# The pantograph on its virtual bench: the head moves in a sine whose peak acceleration is controlled, the contact
# force answers, and their components at the drive's frequency give the first-harmonic receptance $H = -Z/F$,
# which the paper calls first-order. All Z-spring parameters are synthetic.

# %%
import threading

import matplotlib.pyplot as plt
import numpy as np

from zspring.bench.measure import measure
from zspring.bench.points import FrfSettings, sweeps
from zspring.fmu import Fmu
from zspring.receptance import receptance

LEVELS = (0.25, 1.0, 4.0)  # m/s2
FREQUENCIES = tuple(np.arange(2.0, 14.01, 0.25))  # Hz


def respond(levels=LEVELS, **parameters):
    """H in m/N by level, (frequencies,), from low to high frequency."""
    settings = FrfSettings(levels, FREQUENCIES, {"solver.step": 5e-4, **parameters})
    found = {level: np.full(len(FREQUENCIES), np.nan, complex) for level in levels}
    with Fmu() as fmu:
        for point, _ in measure(fmu, settings, sweeps(settings), jobs=2, stop=threading.Event()):
            found[point.level][FREQUENCIES.index(point.frequency)] = point.H
    return found


responses = respond()

# %% [markdown]
# ## Between two linear models
#
# With stuck rods the head's spring is $K_{locked}$, with free ones $K_{free}$, which is half as stiff. Both
# linear models follow from the same parameters.

# %%
with Fmu() as fmu:
    parameters = fmu.used_parameters({})
bounds = {name: receptance(np.array(FREQUENCIES), parameters, name) for name in ("locked", "free")}

figure, axes = plt.subplots(figsize=(8, 4.5))
for name, H in bounds.items():
    axes.semilogy(FREQUENCIES, 1e3 * np.abs(H), "k--" if name == "locked" else "k:", label=f"rods {name}")
for level, H in responses.items():
    axes.semilogy(FREQUENCIES, 1e3 * np.abs(H), label=f"{level:g} m/s²")
axes.set(xlabel="frequency, Hz", ylabel="receptance, mm/N", title="First-harmonic receptance by level (synthetic)")
axes.legend()
plt.show()

# %% [markdown]
# At 0.25 m/s² the rods stay stuck and the response is that of the first linear model; at 4 m/s² they slide, and
# it comes near the second one. At 1 m/s² both peaks are low: friction takes most there.

# %%
stuck = np.array(FREQUENCIES) > 5
np.testing.assert_allclose(np.abs(responses[0.25][stuck]), np.abs(bounds["locked"][stuck]), rtol=0.05)
peak = {level: FREQUENCIES[int(np.nanargmax(np.abs(H)))] for level, H in responses.items()}
assert peak[0.25] == 6.5 and 4.75 <= peak[4.0] <= 5.0

# %% [markdown]
# ## The friction bound
#
# More friction holds the rods for longer: at 1 m/s² a bound of 0.6 N.m gives the stuck head's resonance, and one
# of 0.1 N.m nearly the free one's.

# %%
figure, axes = plt.subplots(figsize=(8, 4.5))
highest = {}
for bound in (0.1, 0.3, 0.6):
    H = respond((1.0,), **{"zspring.Mf": bound})[1.0]
    axes.semilogy(FREQUENCIES, 1e3 * np.abs(H), label=f"Mf = {bound:g} N.m")
    highest[bound] = FREQUENCIES[int(np.nanargmax(np.abs(H)))]
axes.set(xlabel="frequency, Hz", ylabel="receptance, mm/N", title="At 1 m/s², by friction bound (synthetic)")
axes.legend()
plt.show()
assert highest[0.1] < 5.2 and highest[0.6] > 6.4

# %% [markdown]
# ## One joint over a period
#
# The moment in a joint over the rod's angle, driven from outside through `head_displacement`, as a bench would:
# what the loop encloses is lost in the joint. Regularised friction (the paper's) and Coulomb's differ where the
# rod sticks: the first one creeps.

# %%
FREQUENCY, ACCELERATION, STEP = 4.9, 2.0, 1 / 4.9 / 400
peak_displacement = ACCELERATION / (2 * np.pi * FREQUENCY) ** 2
figure, axes = plt.subplots(figsize=(6, 4.5))
lost = {}
with Fmu() as fmu, fmu.instances() as (pantograph,):
    for law, number in {"regularised": 1, "Coulomb": 2}.items():
        pantograph.start({"drive": 2, "friction": number, "solver.step": STEP}, {"head_displacement": 0.0})
        rows = []
        for n in range(1, 12 * 400 + 1):
            time = n * STEP
            softly = min(1.0, FREQUENCY * time / 4)  # four periods to rise
            pantograph.set({"head_displacement": softly * peak_displacement * np.sin(2 * np.pi * FREQUENCY * time)})
            pantograph.step(time - STEP, STEP)
            rows.append(pantograph.get(["zspring.alpha", "zspring.moment_alpha"]))
        angle, moment = np.array(rows[-401:]).T
        axes.plot(np.degrees(angle), moment, label=law)
        lost[law] = abs(np.trapezoid(moment, angle))
axes.set(xlabel="angle of the rod, deg", ylabel="friction moment, N.m", title=f"{FREQUENCY} Hz, {ACCELERATION} m/s²")
axes.legend()
plt.show()
print({law: f"{1e3 * value:.2f} mJ a cycle" for law, value in lost.items()})
assert abs(lost["regularised"] / lost["Coulomb"] - 1) < 0.05
