"""What one pantograph came to in a case's run: its series, values, and what they are judged by."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ..fmu import Fmu
from ..line.journey import LineExtent
from ..line.limits import most_supports, near_wave_speed, of_series, untold_middles, untold_supports
from ..line.quantities import Statistics
from ..line.result import read_result
from ..line.series import Series
from ..line.statistics import statistics
from ..page import Picture
from . import plot
from .edition import Case, Judgement, judge
from .plan import Run
from .workers import Finished

WHICH = "leading", "trailing"  # of two pantographs


@dataclass(frozen=True)
class Passage:
    """One pantograph of a case's run."""

    case: Case
    run: Run
    number: int  # of the pantograph, 0 or 1
    series: Series
    found: Statistics
    uplift: float  # N

    @property
    def title(self) -> str:
        """That of the case, and which pantograph of two."""
        return f"{self.case.title}, {WHICH[self.number]}" if self.run.spacing else self.case.title

    @property
    def judged(self) -> list[Judgement]:
        return judge(self.found, self.case.trailing_ranges if self.number else self.case.ranges)

    def by_span(self) -> dict[str, Statistics]:
        """The values of each span of the section by its name."""
        spans = self.run.section.single_spans()
        return {str(s).split(",")[0]: statistics(self.series, s, further=self.case.further) for s in spans}

    def picture(self, title: str) -> Picture:
        """Contact force, height of the contact point and uplift along the line."""
        caption = f"{title}: contact force, height of the contact point and uplift"
        file = self.run.series.replace(".csv", "-trailing.png" if self.number else ".png")
        return Picture(plot.force_figure(self.series, self.run.section, self.found, title), caption, file)

    def remarks(self, catenary: Fmu) -> list[str]:
        """Lines on a mean force that was aimed at, and on what the line's model is not good for."""
        run, lines = self.run, []
        if run.mean_force is not None:
            whose = f"of {self.case.supply} lines at {run.speed:g} km/h" if self.case.supply else "of the case"
            lines.append(
                f"mean force {whose}: target {run.mean_force:.1f} N, reached {self.found['mean_force']:.1f} N with a "
                f"static force of {run.pantograph['static_force']:.1f} N and an uplift of {self.uplift:.1f} N on the "
                "upper frame"
            )
        on = run.on(catenary)
        if run.section.last > most_supports(on):
            lines += untold_supports(on, LineExtent.of(on, run.line))
        lines += untold_middles(self.series, run.section)
        return [*lines, *near_wave_speed(on, run.line, run.speed / 3.6), *of_series(self.series, run.section)]


def passages(case: Case, run: Run, finished: Finished, folder: Path) -> list[Passage]:
    """Of a finished run, whose series is read from the folder."""
    result, uplifts = read_result(folder / run.series), (finished.uplift, finished.trailing_uplift)
    made = []
    for number in range(result.position.shape[1]):
        series = result.series(number)
        found = statistics(series, run.section, further=case.further)
        made.append(Passage(case, run, number, series, found, uplifts[number]))
    return made
