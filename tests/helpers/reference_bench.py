"""The bench by the independent pantograph: a sine that is imposed on the head, and the response of its last period."""

from __future__ import annotations

import math

import numpy as np

from reference import Reference

RAMP, WAIT = 2.0, 3.0  # s, to the full sine, and until it is steady
SAMPLES = 64  # of a period


def imposed_sine(frequency: float, peak: float, t: float, order: int = 0) -> float:
    """peak sin(2 pi f t) behind a ramp of the fifth degree, which leaves rest without a jump; or a derivative."""
    omega, x = 2 * math.pi * frequency, min(t / RAMP, 1.0)
    level = x**3 * (10 - 15 * x + 6 * x * x)
    slope = (30 * x * x - 60 * x**3 + 30 * x**4) / RAMP
    bend = (60 * x - 180 * x * x + 120 * x**3) / RAMP**2
    sine, cosine = math.sin(omega * t), math.cos(omega * t)
    return (
        peak
        * (
            level * sine,
            slope * sine + level * omega * cosine,
            bend * sine + 2 * slope * omega * cosine - level * omega**2 * sine,
        )[order]
    )


def one_period(reference: Reference, frequency: float, acceleration: float) -> dict[str, np.ndarray]:
    """SAMPLES values over a steady period that begins at phase 0; drive Displacement, from rest, Hz, peak in m/s2."""
    omega = 2 * math.pi * frequency
    end = math.ceil((RAMP + WAIT) * frequency) / frequency
    times = end - np.arange(SAMPLES, 0, -1) / (frequency * SAMPLES)

    def head(t: float, order: int = 0) -> float:
        return imposed_sine(frequency, acceleration / omega**2, t, order)

    motion = reference.solve(np.concatenate([[0.0], times, [end]]), {"head_displacement": head}, rtol=1e-7)
    return {name: values[1:-1] for name, values in motion.items()}


def receptance(reference: Reference, frequency: float, acceleration: float) -> complex:
    """H = -Z/F in m/N over that period."""
    motion = one_period(reference, frequency, acceleration)
    return -np.fft.rfft(motion["head.z"])[1] / np.fft.rfft(motion["contact.force"])[1]
