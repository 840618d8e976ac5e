"""A user's own line and pantograph, which nothing but the limit of current collection judges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..errors import ZSpringError
from ..fmu import Fmu
from ..heads import synthetic_note
from ..line.evaluated import middle_or_last
from ..line.journey import Journey, LineExtent
from ..line.waves import fastest, undisturbed_until
from ..line_file.chosen import ChosenLine
from ..page import WORDS, Cell, Chapter, Table
from ..variables import Value, with_unit
from . import report
from .cases import case_run
from .chapters import Outcome
from .edition import Case, Edition
from .plan import Run

GROUP = "own pair"


@dataclass(frozen=True)
class OwnPair:
    """What to run, by name; the spans of the first case count for all."""

    line: ChosenLine
    pantograph_name: str
    pantograph: Mapping[str, Value]
    speeds: Sequence[float]  # km/h
    spacing: float | None  # m, of two pantographs
    supply: str  # whose mean force by speed they have; empty: what static_force gives
    spans: tuple[int, int] | None  # evaluated; None: the middle ones, or the last before the far end is felt
    figures: Sequence[str]  # that are told besides those of every evaluation

    @property
    def name(self) -> str:
        return f"{self.pantograph_name} on {self.line.name}"

    def edition(self, pantograph: Fmu) -> Edition:
        """Its cases, in the form of a standard's edition. Raises ZSpringError where no span can be evaluated."""
        static_force = self.pantograph.get("static_force", pantograph.variables["static_force"].start)
        cases = []
        for speed in self.speeds:
            first, last = self.spans or self._spans(speed)
            given = {
                "title": f"{speed:g} km/h",
                "line": self.line.name,
                "pantograph": self.pantograph_name,
                "speed": speed,
                "first_span": first,
                "last_span": last,
                "spacing": self.spacing,
                "static_force": float(static_force),
                "supply": self.supply,
                "values": list(self.figures),
            }
            cases.append(Case.model_validate(given))
        return Edition.model_validate({"edition": f"own pair, {self.name}", "source": "one's own", "case": cases})

    def runs(self, edition: Edition) -> list[Run]:
        """The runs of its cases. Raises ZSpringError as case_run."""
        runs = []
        for case in edition.cases:
            parameters = {"static_force": case.static_force, **self.pantograph}
            runs.append(case_run(GROUP, self.name, case, self.line, parameters))
        return runs

    def _spans(self, speed: float) -> tuple[int, int]:
        """Those in which all pantographs have started up and the far end is not felt yet."""
        catenary, line = self.line.catenary, self.line.parameters
        extent, count = LineExtent.of(catenary, line), 2 if self.spacing else 1
        journey = extent.complete(Journey(speed / 3.6, spacing=self.spacing or 0.0), count)
        wave = fastest(catenary, line)
        until = (undisturbed_until(extent, journey, i * journey.spacing, wave) for i in range(count))
        begin, end = journey.start + extent.run_up(journey.start), min(journey.stop - journey.spacing, *until)
        section = middle_or_last(extent, begin, end)
        if section is None:
            raise ZSpringError(
                f"{self.line.name}, {speed:g} km/h: no whole span between {begin:.4g} m, a span after the start, and "
                f"{end:.4g} m, where the far end begins to tell: take a longer line, or choose --spans"
            )
        return section.first, section.last

    def chapter(self, made: Outcome, pantograph: Fmu) -> Chapter:
        """Figures of all speeds side by side, then of each its force along the line and its spans; parameters."""
        text = (
            "No accepted ranges are known for this pair, so that nothing here is judged but by the limit of current "
            "collection, in the box on top. The reference cases below show how the simulation does on known ones."
        )
        note = synthetic_note(pantograph, pantograph.used_parameters(self.pantograph))
        chapter = Chapter(
            f"Own pair: {self.name}{note}", [text, *(f"{line}." for line in made.remarks(self.line.catenary))]
        )
        if len(made.passages) > 1:
            side_by_side = {f"{each.title}, {each.run.section}": each.found for each in made.passages}
            chapter.blocks.append(report.figures_table(side_by_side, f"{self.name}, all runs"))
        for each in made.passages:
            title = f"{self.name}, {each.title}"
            place, target = f"{title}: {each.run.section}", each.case.target
            chapter.blocks += [
                report.case_table(each.found, [], each.run.speed, place, target),
                each.picture(title),
                report.spans_table(each.found, each.by_span(), f"{title}, span by span"),
            ]
        catenary = self.line.catenary
        parts = ("line", catenary, self.line.parameters), ("pantograph", pantograph, self.pantograph)
        rows: list[list[str | Cell]] = [
            [f"{part}: {name}", Cell(with_unit(fmu.variables[name], value), WORDS)]
            for part, fmu, values in parts
            for name, value in values.items()
        ]
        if catenary.line:
            rows.insert(0, ["line: its table", Cell(report.table_told(catenary.line), WORDS)])
        chapter.blocks.append(Table(f"Parameters of {self.name}", ["parameter", "value"], rows))
        return chapter
