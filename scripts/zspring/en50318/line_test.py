"""A simulation beside the line test that it is to agree with: values with what is accepted, places, spectra."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..line.quantities import Statistics, band_of
from ..line.series import BAND, Series
from ..line.statistics import Section, inside, statistics
from ..page import Chapter, Picture, Table
from . import plot, report
from .edition import Edition, Judgement, agreement

SEGMENT = 2.0  # s, of the spectra: a resolution of 0.5 Hz
PRINTED = ("mean_force", "standard_deviation", "standard_deviation_5_20", "actual_minimum")  # span by span
BY_PLACE = (  # values told span by span
    "mean_force",
    "standard_deviation",
    "standard_deviation_0_5",
    "standard_deviation_5_20",
    "actual_maximum",
    "actual_minimum",
    "support_uplift",
    "contact_point_range",
)


@dataclass(frozen=True)
class Comparison:
    """Both series over the same sections, the line test's positions counted as the simulation's."""

    simulation: Series
    line_test: Series
    sections: Sequence[Section | None]  # such as tension sections; None: the whole series
    simulated: Sequence[Statistics]  # by section
    measured: Sequence[Statistics]
    edition: Edition

    @property
    def judged(self) -> dict[str, list[Judgement]]:
        """Differences beside what the edition accepts, by section."""
        each = zip(self.sections, self.simulated, self.measured)
        return {self._place(section): judged(mine, theirs, self.edition) for section, mine, theirs in each}

    @property
    def all_judged(self) -> list[Judgement]:
        return [one for of_section in self.judged.values() for one in of_section]

    def chapter(self) -> Chapter:
        """Figures side by side, over each section and each span; forces along the line and their spectra."""
        chapter = Chapter(
            "Simulation and line test", [f"Accepted differences: {' '.join(self.edition.source.split())}"]
        )
        if self.all_judged:
            chapter.blocks.append(report.verdict("Simulation against line test", self.judged, "%") + ".")
        chapter.blocks += [*self.section_tables(), *self.place_tables(BY_PLACE)]
        along = plot.overlay_figure(self.simulation, self.line_test, self.sections)
        if along:
            caption = "Contact force of 0-20 Hz along the line, simulated and measured"
            chapter.blocks.append(Picture(along, caption, "line-test-force.png"))
        spectra = {"simulation": self.spectrum(self.simulation), "line test": self.spectrum(self.line_test)}
        until = max([BAND, *(band[1] for name in self.measured[0] if (band := band_of(name)))])
        caption = (
            f"Power spectral density of the unfiltered contact force over what is evaluated, Welch's method with Hann "
            f"windows of {SEGMENT:g} s, or of a section that is shorter"
        )
        chapter.blocks.append(Picture(plot.spectra_figure(spectra, until), caption, "line-test-spectra.png"))
        return chapter

    def section_tables(self) -> list[Table]:
        """All values of each section beside what is accepted."""
        each = zip(self.sections, self.judged.values(), self.simulated, self.measured)
        return [
            report.agreement_table(mine, theirs, limits, f"Simulation and line test, {section or 'the whole series'}")
            for section, limits, mine, theirs in each
        ]

    def place_tables(self, names: Sequence[str]) -> list[Table]:
        """These values by section where there are several, and by span."""
        tables = []
        if len(self.sections) > 1:
            both = dict(zip(self.judged, zip(self.simulated, self.measured)))
            tables.append(report.places_table(both, names, "Simulation (line test), section by section"))
        spans = [span for section in self.sections if section for span in section.single_spans()]
        if len(spans) > 1:
            by_span = {
                self._place(span): (statistics(self.simulation, span), statistics(self.line_test, span))
                for span in spans
            }
            tables.append(report.places_table(by_span, names, "Simulation (line test), span by span"))
        return tables

    def printed(self) -> list[str]:
        """What the command prints of the sections and spans."""
        tables = [*self.section_tables(), *self.place_tables(PRINTED)]
        return [line for table in tables for line in (*report.as_lines(table), "")]

    def spectrum(self, series: Series) -> tuple[np.ndarray, np.ndarray]:
        """Frequencies in Hz and power spectral density in N2/Hz, both (f,), the mean over the sections by length."""
        from scipy.signal import welch  # slow to load

        parts = [series.force[inside(series, section)] for section in self.sections]
        length = min([round(SEGMENT / series.step), *(part.size for part in parts)])
        found = [welch(part, 1 / series.step, nperseg=length) for part in parts]
        return found[0][0], np.average([density for _, density in found], axis=0, weights=[p.size for p in parts])

    def _place(self, section: Section | None) -> str:
        return str(section).split(",")[0] if section else "the line test"


def judged(simulated: Statistics, measured: Statistics, edition: Edition) -> list[Judgement]:
    """Differences that both tell, beside what the edition accepts."""
    limits: Mapping[str, float] = {
        name: limit
        for name, limit in edition.agreement.items()
        if measured[name] and math.isfinite(measured[name]) and math.isfinite(simulated[name])
    }
    return agreement(simulated, measured, limits)
