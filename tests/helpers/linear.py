"""Closed forms: the linearised Z-spring and the complex receptance of linear pantographs.

Degrees of freedom [u1, alpha, beta, u2, u3] as in the non-linear model, time factor exp(+i omega t).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from harness import Pantograph

# Published lumped-mass pantographs (kg, N/m, N.s/m; 1 = head).
# DSA-380: Wang et al., extended Habedank model of pantograph arcing, table II. DSA-250: as quoted in papers.
# EN 50318:2002 reference pantograph: two masses, so the lower one is massless on a very stiff spring.
# 2015 benchmark, Bruni et al., Vehicle System Dynamics 53(3): masses and springs; dampers are the test's own.
PUBLISHED = {
    "DSA-380": {
        "m1": 7.12,
        "m2": 6.0,
        "m3": 5.8,
        "k1": 9430.0,
        "k2": 14100.0,
        "k3": 0.1,
        "c1": 0.0,
        "c2": 0.0,
        "c3": 70.0,
    },
    "DSA-250": {
        "m1": 7.51,
        "m2": 5.855,
        "m3": 4.645,
        "k1": 8380.0,
        "k2": 6200.0,
        "k3": 80.0,
        "c1": 0.0,
        "c2": 0.0,
        "c3": 70.0,
    },
    "EN 50318:2002": {
        "m1": 7.2,
        "m2": 15.0,
        "m3": 0.0,
        "k1": 4200.0,
        "k2": 50.0,
        "k3": 1e9,
        "c1": 10.0,
        "c2": 90.0,
        "c3": 0.0,
    },
    "2015 benchmark": {
        "m1": 7.5,
        "m2": 9.0,
        "m3": 6.0,
        "k1": 7000.0,
        "k2": 15500.0,
        "k3": 160.0,
        "c1": 30.0,
        "c2": 5.0,
        "c3": 80.0,
    },
}


@dataclass(frozen=True)
class ZSpringLinear:
    """The Z-spring about its static state: rods and spring on one line at the angle `theta`."""

    theta: float
    k: float
    l0: float
    L1: float
    L2: float
    d: float

    @classmethod
    def of(cls, p: Pantograph) -> ZSpringLinear:
        """With the parameters of an instance, at the static angle that it reports."""
        return cls(*p.reals([f"zspring.{name}" for name in ("theta", "k", "l0", "L1", "L2", "d")]))

    @property
    def span(self) -> float:
        """Distance D of the two joints."""
        return self.d / np.cos(self.theta)

    @property
    def length(self) -> float:
        return self.span - self.L1 - self.L2

    @property
    def tension(self) -> float:
        return self.k * (self.length - self.l0)

    @property
    def k_locked(self) -> float:
        s, c = np.sin(self.theta), np.cos(self.theta)
        return self.k * s**2 + self.tension / self.length * c**2

    @property
    def k_free(self) -> float:
        s, c = np.sin(self.theta), np.cos(self.theta)
        return self.k * s**2 + self.tension / self.span * c**2

    def stiffness(self) -> np.ndarray:
        """Second derivative of the energy with respect to [u1, alpha, beta, u2, u3]."""
        rods, across = np.array([self.L1, self.L2]), self.tension / self.length
        swing = across * np.outer(rods, rods) + self.tension * np.diag(rods)
        couple = across * rods * np.cos(self.theta)
        stiffness = np.zeros((5, 5))
        stiffness[1:3, 1:3] = swing
        stiffness[0, 1:3] = stiffness[1:3, 0] = couple
        stiffness[3, 1:3] = stiffness[1:3, 3] = -couple
        stiffness[np.ix_([0, 3], [0, 3])] = self.k_locked * np.array([[1, -1], [-1, 1]])
        return stiffness


@dataclass(frozen=True)
class LinearPantograph:
    """Three masses; `head` is the head suspension: a stiffness (N/m), or a ZSpringLinear whose rods move.

    `rods` are the rods' inertias (kg m2), `rod_damping` a viscous moment on each (N m s): Mf tau is that of
    the regularised friction law at amplitudes so small that tanh(tau w) is tau w.
    """

    m1: float
    m2: float
    m3: float
    k2: float
    k3: float
    c1: float
    c2: float
    c3: float
    head: float | ZSpringLinear
    rods: tuple[float, float] = (0.0, 0.0)
    rod_damping: float = 0.0

    @classmethod
    def of(cls, p: Pantograph, head: float | ZSpringLinear, **rods) -> LinearPantograph:
        """With the masses, springs and dampers of an instance."""
        frame = ("m1", "m2", "m3", "k2", "k3", "c1", "c2", "c3")
        return cls(**{name: p[name] for name in frame}, head=head, **rods)

    def matrices(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """M, C, K; shape (3, 3) with a plain head stiffness, else (5, 5)."""

        def chain(first: float, second: float, third: float) -> np.ndarray:
            return np.array([[first, -first, 0], [-first, first + second, -second], [0, -second, second + third]])

        m = np.diag([self.m1, self.m2, self.m3])
        c = chain(self.c1, self.c2, self.c3)
        if not isinstance(self.head, ZSpringLinear):
            return m, c, chain(self.head, self.k2, self.k3)
        frame = np.ix_([0, 3, 4], [0, 3, 4])
        mass, damping, stiffness = (np.zeros((5, 5)) for _ in range(3))
        mass[frame], damping[frame], stiffness[frame] = m, c, chain(0.0, self.k2, self.k3)
        mass[[1, 2], [1, 2]] = self.rods
        damping[[1, 2], [1, 2]] = self.rod_damping
        return mass, damping, stiffness + self.head.stiffness()

    def dynamic_stiffness(self, frequency: float) -> complex:
        """Force on the head over its displacement (N/m)."""
        omega = 2 * np.pi * frequency
        m, c, k = self.matrices()
        dynamic = k + 1j * omega * c - omega**2 * m
        rest = dynamic[1:, 1:]
        return complex(dynamic[0, 0] - dynamic[0, 1:] @ np.linalg.solve(rest, dynamic[1:, 0]))

    def receptance(self, frequency: float) -> complex:
        return 1 / self.dynamic_stiffness(frequency)

    def frequencies(self, *, head_fixed: bool = False) -> np.ndarray:
        """Undamped natural frequencies (Hz), ascending."""
        m, _, k = self.matrices()
        first = 1 if head_fixed else 0
        return np.sqrt(eigh(k[first:, first:], m[first:, first:], eigvals_only=True)) / (2 * np.pi)


STEP = 2e-4  # s


def step_error(linear: LinearPantograph, frequency: float, step: float = STEP) -> float:
    """Bound of the receptance's error (m/N) by the time step.

    HHT at alpha = -0.3 shifts frequencies by 0.12 (omega h)^2: twice that, in frequency and in magnitude.
    """
    shift = 0.24 * (2 * np.pi * frequency * step) ** 2
    h, slope = (
        linear.receptance(frequency),
        (linear.receptance(1.001 * frequency) - linear.receptance(frequency)) / 0.001,
    )
    return shift * (abs(h) + abs(slope))
