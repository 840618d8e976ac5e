# ---
# jupyter:
#   jupytext:
#     text_representation: {extension: .py, format_name: percent}
#   kernelspec: {display_name: Python 3, language: python, name: python3}
# ---

# %% [markdown]
# # The pantograph in a co-simulation loop of your own
#
# A line of your own, here a taut string on an elastic foundation with an insulator in 30 lines of NumPy, and
# `ZSpringPantograph.fmu` through fmpy: first with last values, as most tools exchange them, then with the wire as
# an affine map of the contact force. No step is taken back in either.

# %%
import shutil

import fmpy
import matplotlib.pyplot as plt
import numpy as np
from fmpy.fmi2 import FMU2Slave

from zspring.fmu import installed_fmu

FORCE, SPEED, START, INSULATOR = 120.0, 60.0, 40.0, 70.0  # N, m/s, m, m


def place(time):
    """Where the pantograph is, m: it gets up to its speed within 0.3 s."""
    return START + SPEED * (time**2 / 0.6 if time < 0.3 else time - 0.15)


class Line:
    """A string of linear elements by the trapezoidal rule; heights count from where `FORCE` lifts it at rest."""

    def __init__(self, step, tension=20e3, mass=1.35, foundation=40.0, length=150.0, elements=300):
        self.step, self.element = step, length / elements
        nodes = np.arange(elements + 1)
        M, K = np.zeros((2, elements + 1, elements + 1))
        for i in range(elements):
            pair, consistent = np.ix_([i, i + 1], [i, i + 1]), self.element / 6 * np.array([[2, 1], [1, 2]])
            M[pair] += mass * consistent
            K[pair] += tension / self.element * np.array([[1, -1], [-1, 1]]) + foundation * consistent
        M[2 * (round(INSULATOR / self.element),)] += 3.0  # kg
        inner = nodes[1:-1]
        self.K, self.M = K[np.ix_(inner, inner)], M[np.ix_(inner, inner)]
        self.inverse = np.linalg.inv(self.M + step**2 / 4 * self.K)
        self.u = np.linalg.solve(self.K, FORCE * self.at(START))
        self.v, self.a = np.zeros_like(self.u), np.zeros_like(self.u)
        self.datum = self.height(START, self.u, 0.0)

    def at(self, x):
        """The inner nodes' shares of what is at x m: cubic B-splines, which have no corner at the nodes to run over."""
        i, r = divmod(x / self.element, 1)
        p = np.zeros(self.K.shape[0] + 2)
        p[int(i) - 1 : int(i) + 1] = (1 - r) ** 3 / 6, 2 / 3 - r**2 + r**3 / 2
        p[int(i) + 1 : int(i) + 3] = (1 + 3 * (r + r**2 - r**3)) / 6, r**3 / 6
        return p[1:-1]

    def height(self, x, u, datum=None):
        return self.at(x) @ u - (self.datum if datum is None else datum)

    def after(self, x, force):
        """Displacement, velocity and acceleration after a step, under this force at its end."""
        h = self.step
        predicted = self.u + h * self.v + h**2 / 4 * self.a
        a = self.inverse @ (force * self.at(x) - self.K @ predicted)
        return predicted + h**2 / 4 * a, self.v + h / 2 * (self.a + a), a

    def affine_map(self, x):
        """Height at x after the next step without force there, and what each newton adds."""
        p = self.at(x)
        return self.height(x, self.after(x, 0.0)[0]), self.step**2 / 4 * p @ self.inverse @ p


# %% [markdown]
# ## The FMU through fmpy
#
# Nothing of this package is needed but the file. Enumerations are set by their numbers: `drive` 3 is Wire,
# `friction` 2 Coulomb.

# %%
description = fmpy.read_model_description(str(installed_fmu()))
reference = {variable.name: variable.valueReference for variable in description.modelVariables}
folder = fmpy.extract(str(installed_fmu()))


def run(step, exchange, duration=1.2):
    """Contact forces at the ends of the steps. (duration / step,)"""
    line = Line(step)
    pantograph = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="pantograph",
    )
    pantograph.instantiate()
    pantograph.setInteger([reference["drive"], reference["friction"]], [3, 2])
    pantograph.setReal([reference["solver.step"]], [5e-4])
    pantograph.setupExperiment(startTime=0.0)
    pantograph.enterInitializationMode()
    pantograph.exitInitializationMode()
    forces = []
    for n in range(round(duration / step)):
        x, last = place(step * (n + 1)), forces[-1] if forces else FORCE
        if exchange == "affine map":
            free, compliance = line.affine_map(x)
        else:  # both step at once, each with the other's last value
            free, compliance = line.height(x, line.u), 0.0
        pantograph.setReal([reference["wire_height"], reference["wire.compliance"]], [free, compliance])
        pantograph.doStep(n * step, step)
        forces.append(pantograph.getReal([reference["contact.force"]])[0])
        line.u, line.v, line.a = line.after(x, forces[-1] if exchange == "affine map" else last)
    pantograph.terminate()
    pantograph.freeInstance()
    return np.array(forces)


# %% [markdown]
# ## What the exchange costs
#
# With last values the contact's stiffness sees a wire that is a step old. With the map the pantograph solves
# contact, friction and frame with a wire that gives way, and both agree at the end of each step as if solved
# together.

# %%
STEPS = 0.5, 1, 2, 5  # ms
forces = {exchange: {h: run(1e-3 * h, exchange) for h in STEPS} for exchange in ("affine map", "last values")}

figure, axes = plt.subplots(figsize=(8, 4.5))
for (exchange, found), style in zip(forces.items(), ("k", "C1")):
    axes.plot(1e-3 * np.arange(1, len(found[1]) + 1), found[1], style, lw=1, label=exchange)
axes.set(xlabel="time, s", ylabel="contact force, N", title="Past an insulator of 3 kg at 60 m/s, steps of 1 ms")
axes.legend()
plt.show()

# %% [markdown]
# In N rms: what last values are off by against the map with the same step, and what the map with this step is off
# by against one of 0.1 ms, which is the error of the step itself.

# %%
finest = run(0.1e-3, "affine map")
cost, own = {}, {}
for h in STEPS:
    mapped, last = forces["affine map"][h], forces["last values"][h]
    cost[h] = float(np.sqrt(np.mean((last - mapped) ** 2)))
    own[h] = float(np.sqrt(np.mean((mapped - finest[round(10 * h) - 1 :: round(10 * h)]) ** 2)))
    print(f"{h:3g} ms: last values {cost[h]:5.2g}, the step itself {own[h]:5.2g}")
assert cost[5] > 20 * own[5] and cost[1] > 1.5 * cost[0.5]

# %% [markdown]
# A finite-element line of yours gives the same two numbers from its matrices, as `affine_map` does here.

# %%
shutil.rmtree(folder)
