"""Where a run leaves what the line's model is good for, one line each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..fmu import Fmu
from ..variables import Value
from .journey import LineExtent
from .quantities import band_of, described
from .series import BAND, Series
from .statistics import Section, is_middle
from .waves import wave_speed

NEAR_WAVE_SPEED = 0.7  # of the contact wire's wave speed: what papers quote from EN 50119 as the limit of operation
SMALL = 0.2  # m; small displacements: tensions and lengths of the wires, and the steady arms, as they are at rest
FAR_END = "forces are under the influence of the line's far end, which reflects the waves of the start"


def near_wave_speed(catenary: Fmu, line: Mapping[str, Value], speed: float) -> list[str]:
    """A line for a speed in m/s near the contact wire's wave speed."""
    wave = wave_speed(catenary, line, "contact_wire")
    if speed <= NEAR_WAVE_SPEED * wave:
        return []
    return [
        f"warning: {3.6 * speed:.4g} km/h is {speed / wave:.2f} of the contact wire's wave speed, {3.6 * wave:.4g} "
        f"km/h: above {NEAR_WAVE_SPEED:g} of it forces depend on details of the line that no data here tell"
    ]


def most_supports(catenary: Fmu) -> int:
    """Supports between the line's ends whose uplift the FMU tells."""
    return sum(variable.name.startswith("support.uplift[") for variable in catenary.variables) - 1


def untold_supports(catenary: Fmu, extent: LineExtent) -> list[str]:
    """A line for a line with more supports than that."""
    told = most_supports(catenary)
    if extent.spans - 1 <= told:
        return []
    return [
        f"warning: a line of {extent.spans} spans: uplifts are told at its first {told} supports alone, those up to "
        f"{extent.supports[told - 1]:.4g} m; no other one is among the values"
    ]


def of_bands(names: Iterable[str]) -> list[str]:
    """A line for each value, by name, that is of frequencies for which the model is not made."""
    bands = {name: band for name in names if (band := band_of(name))}
    return [
        f"warning: {described(name)[0]}: above {BAND:g} Hz a simulated force is one of lumped masses on contact.k, "
        "which no data here tell"
        for name, (_, high) in bands.items()
        if high > BAND
    ]


def untold_middles(series: Series, section: Section) -> list[str]:
    """A line where the uplift at mid-span is not that of all spans, as not all of them were watched."""
    spans = section.single_spans()
    told = sum(any(is_middle(position, span) for position in series.points) for span in spans)
    if told in (0, len(spans)):
        return []
    return [
        f"{series.name}: the largest uplift at mid-span is that of {told} of the {len(spans)} spans, which were watched"
    ]


def of_series(series: Series, section: Section | None) -> list[str]:
    """Lines for supports lifted far, and for an evaluated section (None: all) in which the far end is felt."""
    found = []
    lifted = max((float(each.max()) for each in (series.uplift or {}).values()), default=0.0)
    if lifted > SMALL:
        found.append(
            f"warning: {series.name}: uplift of {1e3 * lifted:.3g} mm at a support: the line's model is for small "
            f"displacements, up to {1e3 * SMALL:g} mm"
        )
    until = series.stated.undisturbed_until
    if until is not None and series.position is not None:
        end = section.bounds[1] if section else float(series.position[-1])
        if end > until:
            found.append(
                f"warning: {series.name}: what is evaluated goes to {end:.4g} m, but from {until:.4g} m on {FAR_END}"
            )
    return found
