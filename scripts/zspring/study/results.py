"""What is written and said of a study whose cases are run: tables and figures of all rows."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure

from ..figures import save
from . import report
from .compare import conditions, difference_table, differences, write_differences
from .coupled import CoupledQuantity
from .design import Case
from .evaluations import FrfQuantity
from .files import Rows, StudyRecord
from .line_plot import correlation_figure, difference_figure, distribution_figure, sweep_figure
from .plot import envelope_figure, sobol_figure
from .sensitivity import correlation_doubts, correlation_table, correlations, parameters_of, write_correlations
from .settings import COMPARED, StudySettings


class Written:
    """Files of a study beside its record.

    note    what a title says of the parameters
    suffix  of the figures
    """

    def __init__(self, settings: StudySettings, cases: Sequence[Case], record: StudyRecord, note: str, suffix: str):
        self._settings, self._cases, self._record, self._suffix = settings, cases, record, suffix
        self._rows = record.rows
        varied = ", ".join(settings.vary) or ", ".join(settings.compared)
        self._title = (settings.title or f"Parameter study, {settings.design}, of {varied}") + note
        self.paths = [record.path]

    def all(self) -> list[str]:
        """Write them; the lines to print."""
        lines: list[str] = []
        scalars = [name for quantity in self._settings.quantities for name in quantity.scalars]
        if not self._settings.compared:
            lines += report.spread_table(scalars, self._rows)
        for quantity in self._settings.quantities:
            if isinstance(quantity, FrfQuantity):
                figure = envelope_figure(report.envelopes(quantity, self._rows), len(self._rows), self._title)
                self._save(figure, "envelope")
            if isinstance(quantity, CoupledQuantity):
                lines += self._on_line(quantity)
        if self._settings.design == "sobol":
            lines += self._sobol(scalars)
        return lines

    def _compared(self) -> dict[str, Rows]:
        """The rows of each of the compared by its name; all by an empty one where nothing is compared."""
        if not self._settings.compared:
            return {"": self._rows}
        return {
            name: {number: row for number, row in self._rows.items() if row[COMPARED] == name}
            for name in self._settings.compared
        }

    def _on_line(self, quantity: CoupledQuantity) -> list[str]:
        settings, cases, title, lines = self._settings, self._cases, self._title, list[str]()
        if quantity.irregularity:
            lines += quantity.irregularity.doubts(settings.lines)
        self._save(distribution_figure(quantity, self._compared(), title), "distribution")
        if conditions(settings):
            self._save(sweep_figure(settings, quantity, cases, self._rows, title), "sweep")
        if len(settings.compared) > 1 and (found := differences(settings, quantity, cases, self._rows)):
            lines += difference_table(settings, found)
            write_differences(self._path("differences.csv"), self._record.head, settings, found)
            self._save(difference_figure(settings, cases, found, title), "differences")
        parameters = parameters_of(settings, self._rows)
        if settings.design in ("latin-hypercube", "list") and parameters:
            every = {
                name: correlations(settings, parameters, quantity.scalars, rows)
                for name, rows in self._compared().items()
            }
            for name, own in every.items():
                lines += [*([name] if name else []), *correlation_table(parameters, own)]
            if together := [each for own in every.values() for each in own]:
                lines += correlation_doubts(together)
                write_correlations(self._path("correlations.csv"), self._record.head, parameters, every)
                self._save(correlation_figure(every, parameters, title), "correlations")
        return lines

    def _sobol(self, scalars: list[str]) -> list[str]:
        settings, lines = self._settings, list[str]()
        found = report.sobol_indices(settings, scalars, self._rows)
        if found:
            lines += [*report.sobol_table(settings, found), *report.sobol_doubts(found)]
            report.write_sobol(self._path("sobol.csv"), self._record.head, settings, found)
            self._save(sobol_figure(found, list(settings.vary), self._title), "sobol")
        incomplete = report.incomplete_blocks(settings, self._rows)
        if incomplete:
            lines.append(f"Sobol indices without {incomplete} of {settings.samples} blocks, which have failed cases")
        return lines

    def _path(self, name: str) -> Path:
        self.paths.append(self._record.path.parent / name)
        return self.paths[-1]

    def _save(self, figure: Figure, name: str) -> None:
        save(figure, self._path(f"{name}.{self._suffix}"))
