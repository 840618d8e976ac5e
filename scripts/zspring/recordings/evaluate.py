"""From a hold to its point: the steady periods, H from the fundamentals, harmonics, and how far each is known.

Every period is fitted for itself; their scatter about their mean tells the errors.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .moderation import moderated
from .points import Point
from .settings import Settings
from .signals import Record
from .sine import (
    FEWEST_PERIODS,
    MOST,
    Periods,
    error_of_mean,
    errors_of_means,
    harmonics_within,
    undisturbed,
    variance_of_mean,
    without_trend,
)
from .steady import repeats_after, settled, usual
from .track import Stretch
from .window import Window, located

INCONSISTENT = 0.02  # relative distance of displacement and acceleration, complex
AUDIBLE = 4.0  # standard errors from which on a harmonic is more than noise
HUNTING = 0.02  # relative scatter of the motion's amplitude


def evaluate(record: Record, hold: Stretch, settings: Settings, swept: bool = False) -> Point:
    """The point of a hold, or why there is none; not yet judged.

    swept   H changes evenly along it
    """
    point = Point(record.path.name, record.level, hold.begin, hold.end, hold.frequency, 0)
    harmonics = harmonics_within(record.rate, hold.frequency)
    if harmonics < 2:
        return replace(point, left_out=f"{record.rate:g} Hz are too few samples for it")
    name, motion = next(iter(record.motions.items()))
    window = located(record, hold, motion, harmonics)
    force, moved = (window.periods(signal) for signal in (record.force, motion))
    count = moved.residual.size
    point = replace(point, frequency=window.frequency, found=count)
    good = (
        undisturbed(force.residual, record.force.step)
        & undisturbed(moved.residual, motion.step)
        & usual(moved.amplitude[:, 0])
    )
    good[: 0 if swept else math.ceil(settings.sweep.settle)] = False
    kept = np.flatnonzero(good)
    skipped, change = (0, 0.0) if swept else settled(force.amplitude[kept, 0] / moved.amplitude[kept, 0])
    kept = kept[skipped:]
    clipped = [channel for channel, found in (("force", force), (name, moved)) if found.clipped]
    if kept.size < FEWEST_PERIODS + swept:
        return replace(point, periods=kept.size, left_out=_why(kept.size, clipped, force, moved, name, swept))
    marks = []
    if (disturbed := count - kept[0] - kept.size) > 0.1 * count:
        marks.append(f"{disturbed} of {count} periods disturbed")
    if clipped:
        marks.append(f"{' and '.join(clipped)} clipped in many periods")
    if change:
        marks.append(f"not settled: H changes by {100 * change:.2g} %")
    return _measured(point, window, settings, kept, force, moved, tuple(marks), swept)


def _why(count: int, clipped: list[str], force: Periods, moved: Periods, name: str, swept: bool) -> str:
    """Why there are too few periods."""
    if clipped:
        return f"{' and '.join(clipped)} clipped"
    for channel, found in (("force", force), (name, moved)):
        if np.isnan(found.residual).sum() > found.residual.size / 2:
            return f"{channel} has missing values"
    return f"{count} steady periods, {FEWEST_PERIODS + swept} at least are needed"


def _measured(
    point: Point,
    window: Window,
    settings: Settings,
    kept: np.ndarray,
    force: Periods,
    moved: Periods,
    marks: tuple[str, ...],
    swept: bool,
) -> Point:
    """The point from the periods that count."""
    record, order = window.record, window.order
    (name, motion), *others = record.motions.items()
    omega = 2 * np.pi * window.frequency
    Z = moved.amplitude[kept] * window.to_displacement(name)
    F = force.amplitude[kept] - settings.fixture_mass * (order * omega) ** 2 * Z  # the head's own share
    z, f = Z[:, 0].mean(), F[:, 0].mean()
    relative = Z[:, 0] / z - F[:, 0] / f
    force_noise, motion_noise = (float(np.median(found.residual[kept])) for found in (force, moved))
    per_period = record.rate / window.frequency
    seen = abs(moved.amplitude[kept, 0].mean())  # of the motion, in the sensor's quantity
    rounding = math.hypot(
        rounding_error(record.force.step, force_noise, abs(f), per_period),
        rounding_error(motion.step, motion_noise, seen, per_period),
    )
    loss = -np.pi * (order * (F * Z.conj()).imag).sum(1)
    motions, forces = (_clear(amplitudes) for amplitudes in (Z, F))
    variance, freedom = np.array([variance_of_mean(part, swept) for part in (relative.real, relative.imag)]).T
    white = 2 / (kept.size * per_period) * ((force_noise / abs(f)) ** 2 + (motion_noise / seen) ** 2)
    begin, end = window.begin + np.array([kept[0], kept[-1] + 1]) / window.frequency
    repeat, size = repeats_after(*window.values(record.force, begin, end), window.frequency, window.harmonics)
    agreement, agreement_error = complex(math.nan, math.nan), math.nan
    if others:
        second = window.periods(others[0][1]).amplitude[kept, 0] * window.to_displacement(others[0][0])[0]
        agreement, agreement_error = _ratio(second, Z[:, 0]) if name == "displacement" else _ratio(Z[:, 0], second)
    amplitude = without_trend(np.abs(Z[:, 0])) if swept else np.abs(Z[:, 0])
    of_noise = motion_noise * math.sqrt(2 / per_period) * window.to_displacement(name)[0]

    def padded(values: np.ndarray) -> np.ndarray:
        return np.concatenate([values, np.full(MOST - values.size, np.nan)])

    measured = replace(
        point,
        begin=float(begin),
        end=float(end),
        periods=kept.size,
        H=complex(-z / f),
        variance=variance,
        freedom=freedom,
        white=white,
        rounding=rounding,
        harmonics=control_error(motions / abs(z), forces / abs(f)),
        acceleration=float(abs(z) * omega**2),
        scatter=math.sqrt(max(float(amplitude.var(ddof=1)) - of_noise**2, 0)) / abs(z),
        force=padded(np.abs(F.mean(0))),
        force_error=padded(errors_of_means(F)),
        motion=padded(np.abs(Z.mean(0))),
        distortion=float(np.linalg.norm(order[1:] * motions[1:]) / abs(z)),
        force_noise=force_noise,
        motion_noise=motion_noise,
        static_force=force.mean,
        drift=force.slope * kept.size / window.frequency,
        loss=float(loss.mean()),
        loss_error=error_of_mean(loss, swept),
        agreement=agreement,
        agreement_error=agreement_error,
        subharmonic=repeat,
    )
    return replace(measured, marks=(*marks, *([_repeats(repeat, size)] if repeat > 1 else [])))


def _repeats(periods: int, size: float) -> str:
    return f"the force repeats only after {periods} periods ({100 * size:.1f} % of the fundamental)"


def _ratio(one: np.ndarray, other: np.ndarray) -> tuple[complex, float]:
    """Ratio of the means of complex values (M,), NaN for missing ones, and its standard error, relative."""
    there = np.isfinite(one) & np.isfinite(other)
    one, other = one[there], other[there]
    if one.size < FEWEST_PERIODS:
        return complex(math.nan, math.nan), math.nan
    apart = one / one.mean() - other / other.mean()
    return complex(one.mean() / other.mean()), math.hypot(error_of_mean(apart.real), error_of_mean(apart.imag))


def _clear(amplitudes: np.ndarray) -> np.ndarray:
    """Sizes (K,) of the means of complex amplitudes (M, K) without what noise adds; 0 where it could make them."""
    size, noise = np.abs(amplitudes.mean(0)), errors_of_means(amplitudes)
    return np.sqrt(np.where(size > AUDIBLE * noise, np.maximum(size**2 - 2 * noise**2, 0), 0))


def control_error(motions: np.ndarray, forces: np.ndarray) -> float:
    """Relative standard error of H by harmonics of the imposed motion, which is to have none.

    motions, forces     (K,) harmonics beside their fundamentals
    Where the force has a harmonic of its own, one of the motion comes back as a part of the fundamental. If the force
    goes with the k-th power of the motion, its k-th harmonics change the fundamental by k times their product, in a
    phase that is not known: 1 / sqrt(2) of that in magnitude and in phase. The FMU shows this for even harmonics; for
    odd ones dry friction makes it 2 instead (0.25 to 4 m/s2, 2 to 12 Hz, both laws).
    """
    order = np.arange(1, motions.size + 1)
    weight = np.where(order % 2, 2.0, math.sqrt(0.5))
    return float(np.linalg.norm((weight * order * motions * forces)[1:]))


def rounding_error(step: float, noise: float, amplitude: float, per_period: float) -> float:
    """Relative standard error of an amplitude by the converter's steps, as far as they are alike in every period.

    The rms of rounding is step / sqrt(12). Noise of a standard deviation s makes it random from period to period, which
    the scatter tells, and leaves step / (sqrt(2) pi) exp(-2 (pi s / step)^2) (Widrow, Kollár: Quantization Noise). It
    is another at every level crossed; a quarter of a sine crosses amplitude / step, and the others may be like it.
    """
    if not step or not amplitude:
        return 0.0
    own = math.sqrt(max(noise**2 - step**2 / 12, 0))
    rms = min(step / math.sqrt(12), step / (math.sqrt(2) * math.pi) * math.exp(-2 * (math.pi * own / step) ** 2))
    return rms / amplitude * math.sqrt(2 / max(min(per_period / 4, amplitude / step), 1))


def told(points: Sequence[Point], settings: Settings) -> list[Point]:
    """The points of one record, by what all of them tell of their errors, and judged by that."""
    return [judged(point, settings) for point in moderated(points)]


def judged(point: Point, settings: Settings) -> Point:
    """With what its numbers make of it: marks, or why it is left out."""
    limits, marks, why = settings.limits, [*point.marks], point.left_out
    worst = max(point.magnitude_error, point.phase_error)
    for value, limit, text in (
        (point.distortion, limits.distortion, "distortion of the motion"),
        (worst, limits.error, "too short for its noise: standard error"),
    ):
        shown = f"{text} {100 * value:.2g} %"
        if value > limit[1]:
            why = why or f"{shown}, more than {100 * limit[1]:g} %"
        elif value > limit[0]:
            marks.append(shown)
    if point.scatter > HUNTING:
        marks.append(f"amplitude scatters by {100 * point.scatter:.2g} %")
    if abs(point.agreement - 1) > max(INCONSISTENT, 3 * point.agreement_error):
        size, turn = abs(point.agreement) - 1, math.degrees(np.angle(point.agreement))
        marks.append(f"displacement from acceleration off by {100 * size:+.1f} %, {turn:+.1f} deg")
    return replace(point, marks=tuple(marks), left_out=why)
