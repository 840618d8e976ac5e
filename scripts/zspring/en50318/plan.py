"""The runs of the validation: reference cases, what each free choice does to them, and the heads compared."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from ..errors import ZSpringError
from ..fmu import Fmu
from ..line.evaluated import stop_behind
from ..line.journey import FittedJourney, LineExtent
from ..line.mean_force import mean_force
from ..line.statistics import Section
from ..line.waves import fastest, undisturbed_until
from ..line_table import LineTable
from ..parameter_sets import ACCURATE_STEP, LINES, chosen_set
from ..variables import Value, parse

HEAD_SPEEDS = (200.0, 225.0, 250.0, 275.0, 300.0, 325.0, 350.0)  # km/h
SHOWN_HEADS = 300.0  # km/h at which the forces of the heads are drawn, if it is one of the speeds
HEAD_LINE = "benchmark-2015"
HEAD_SPANS = 4  # evaluated, the last before the far end is felt
FIRST_HEAD_SPAN = 3  # of these at least: after a span of start-up from any place in the first
STARTS = 8  # of the heads, even over the first span

Parameters = Mapping[str, Value]


@dataclass(frozen=True)
class Run:
    """One pantograph along one line."""

    group: str  # "reference", "sensitivity", "heads", or of one's own
    label: str  # title of the case, the choice, or the head
    of: str  # name of the edition or of the line; with the title of the case where the label is a choice
    speed: float  # km/h
    section: Section
    line: Parameters
    pantograph: Parameters
    uplift: float = 0.0  # N, extra force on the upper frame; with a mean force, what the search for it begins with
    mean_force: float | None = None  # N, over the section, for which the uplift is chosen
    step: float = 1e-3  # s
    scheme: str = "sequential"
    start_up: str = "ramp"
    start: float | None = None  # m along the line; None: half a span
    stop: float | None = None  # m; None: half a span before the end
    spacing: float = 0.0  # m, back to a trailing pantograph of the same parameters; 0: there is none
    table: LineTable | None = None  # of a line by file
    points: tuple[float, ...] = ()  # m, whose uplift is kept, before that at the middles of the section's spans
    series: str = ""  # name of the file that its series is written to; none: not kept

    @property
    def key(self) -> str:
        """Tells runs apart, by everything that changes their numbers."""
        all_else = asdict(replace(self, table=None))
        told = {**all_else, "table": self.table.digest if self.table else None}
        return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:12]

    def on(self, catenary: Fmu) -> Fmu:
        """The catenary with the run's line."""
        return catenary.with_line(self.table) if self.table else catenary


@dataclass(frozen=True)
class Choice:
    """Another choice where the published data leave one, or another numerical setting."""

    label: str
    line: Mapping[str, Value] = field(default_factory=dict)
    run: Mapping[str, Any] = field(default_factory=dict)
    spans: tuple[int, int] | None = None  # evaluated, if others


# 0.5 % of critical damping at 1 and 20 Hz, by Rayleigh's damping: 2 zeta w1 w2 / (w1 + w2), 2 zeta / (w1 + w2).
_RATIO = {"damping.mass": 0.0598, "damping.stiffness": 7.58e-5}

_NO_CLAMPS = {"dropper.clamp_contact": 0.0, "dropper.clamp_messenger": 0.0}

CHOICES = (
    Choice("no damping", {"damping.mass": 0.0, "damping.stiffness": 0.0}),
    Choice("damping ratio 0.005 at 1 and 20 Hz", _RATIO),
    # As identified on a line in service, by the abstract of that paper; 9 % of critical at 10 Hz.
    Choice("damping 0.02845 1/s, 0.00274 s", {"damping.mass": 0.02845, "damping.stiffness": 0.00274}),
    Choice("no dropper clamps", _NO_CLAMPS),
    Choice("no clamps, no damping", {**_NO_CLAMPS, "damping.mass": 0.0, "damping.stiffness": 0.0}),
    # The set of doi 10.1080/00423114.2022.2085586 as others quote it.
    Choice("no clamps, ratio 0.005, arm 300 N/m", {**_NO_CLAMPS, **_RATIO, "steady_arm.stiffness": 300.0}),
    Choice("droppers of 0.117 kg/m", {"dropper.mass": 0.117}),
    Choice("steady arm 1 kg", {"steady_arm.mass": 1.0}),
    Choice("steady arm 300 N/m", {"steady_arm.stiffness": 300.0}),
    Choice("no bending stiffness", {"contact_wire.EI": 0.0, "messenger.EI": 0.0}),
    Choice("messenger support 500 kN/m", {"support.stiffness": 500_000.0}),
    Choice("static force at the lifted wire", run={"start_up": "direct"}),
    Choice("start at 10 m", run={"start": 10.0}),
    Choice("start at 60 m", run={"start": 60.0}),
    Choice("start at 90 m", run={"start": 90.0}),
    Choice("20 spans, of them 10 and 11", {"line.spans": 20}, spans=(10, 11)),
    Choice("elements of 0.5 m", {"mesh.element": 0.5}),
    Choice("step 0.5 ms", {"solver.step": 5e-4}, {"step": 5e-4}),
    Choice("explicit coupling", run={"scheme": "explicit"}),
)


@dataclass(frozen=True)
class Head:
    """A head suspension to compare."""

    label: str
    pantograph: str  # set
    given: Mapping[str, str]
    every_start: bool = True  # or the first one alone, where a run shows that there is nothing to see
    is_drawn: bool = True  # its force along the line


HEADS = (
    Head("linear, k1", "dsa-380", {"suspension": "Linear"}),
    Head("Z-spring", "dsa-380-zspring", {"suspension": "ZSpring", "friction": "Regularized"}),
    Head("Z-spring linearized, rods free", "dsa-380-zspring", {"suspension": "LinearFree"}),
    Head("Z-spring, Coulomb friction", "dsa-380-zspring", {"suspension": "ZSpring", "friction": "Coulomb"}, False),
    Head("Z-spring linearized, rods locked", "dsa-380-zspring", {"suspension": "LinearLocked"}, False, False),
)


def sensitivity_runs(references: Sequence[Run], catenary: Fmu) -> list[Run]:
    """Each reference run with each other choice, no further than what is evaluated."""
    runs = []
    for run in references:
        for choice in CHOICES:
            changed = replace(run, line={**run.line, **choice.line}, **choice.run)
            changed = replace(changed, group="sensitivity", label=choice.label, of=f"{run.of}, {run.label}", series="")
            extent = LineExtent.of(changed.on(catenary), changed.line)
            if choice.spans:
                first, last = choice.spans
                changed = replace(changed, section=extent.section(first, last))
            runs.append(replace(changed, stop=stop_behind(changed.section, extent, changed.speed / 3.6)))
    return runs


def head_runs(catenary: Fmu, pantograph: Fmu, speeds: Sequence[float] = HEAD_SPEEDS) -> list[Run]:
    """The heads along the same line, from several places of the first span.

    Static force and uplift together are the mean force of the law for AC lines: nothing but 0.1 N/m holds the frame.
    """
    line = chosen_set(HEAD_LINE, catenary, LINES)
    extent = LineExtent.of(catenary, line)
    shown = SHOWN_HEADS if SHOWN_HEADS in speeds else speeds[-1]
    standing = mean_force("AC", 0.0)
    runs = []
    for speed in speeds:
        section = _head_section(speed, extent, fastest(catenary, line))
        stop = stop_behind(section, extent, speed / 3.6)
        for head in HEADS:
            parameters = pantograph_of(head.pantograph, pantograph)
            parameters |= {key: parse(pantograph.variables[key], text) for key, text in head.given.items()}
            parameters["static_force"] = standing
            run = Run(
                "heads", head.label, HEAD_LINE, speed, section, line, parameters, mean_force("AC", speed) - standing
            )
            for i in range(STARTS if head.every_start else 1):
                is_kept = head.is_drawn and speed == shown and i == 0
                series = f"{slug(head.label)}-{speed:g}-km-h.csv" if is_kept else ""
                runs.append(replace(run, start=i * extent.span_length(1) / STARTS, stop=stop, series=series))
    return runs


def _head_section(speed: float, extent: LineExtent, wave: float) -> Section:
    """The spans to evaluate at `speed` km/h. Raises ZSpringError where the far end is felt before there is one."""
    until = undisturbed_until(extent, FittedJourney(speed / 3.6, 0.0, extent.length), 0.0, wave)
    _, last = extent.whole_spans(0.0, until)
    if last < FIRST_HEAD_SPAN:
        raise ZSpringError(
            f"--head-speeds {speed:g} km/h: too slow for the line of {extent.spans} spans, whose far end is felt from "
            f"{until:.0f} m on"
        )
    return extent.section(max(FIRST_HEAD_SPAN, last - HEAD_SPANS + 1), last)


def pantograph_of(name: str, pantograph: Fmu) -> dict[str, Value]:
    """A set's parameters, with the commands' internal step where it has none."""
    return {"solver.step": ACCURATE_STEP, **chosen_set(name, pantograph)}


def slug(text: str) -> str:
    """Text as a part of a file's name."""
    return "-".join("".join(c if c.isalnum() else " " for c in text.lower()).split())
