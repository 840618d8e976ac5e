"""What is written and said of a study whose cases are run: tables and figures of all rows."""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from ..figures import save
from . import report
from .coupled import CoupledQuantity
from .evaluations import FrfQuantity
from .files import Rows, StudyRecord
from .line_plot import distribution_figure
from .plot import envelope_figure, sobol_figure
from .settings import COMPARED, StudySettings


class Written:
    """Files of a study beside its record.

    note    what a title says of the parameters
    suffix  of the figures
    """

    def __init__(self, settings: StudySettings, record: StudyRecord, note: str, suffix: str):
        self._settings, self._record, self._rows, self._suffix = settings, record, record.rows, suffix
        varied = ", ".join(settings.vary) or ", ".join(settings.compared)
        self._title = f"Parameter study, {settings.design}, of {varied}{note}"
        self.paths = [record.path]

    def all(self) -> list[str]:
        """Write them; the lines to print."""
        lines: list[str] = []
        scalars = [name for quantity in self._settings.quantities for name in quantity.scalars]
        for name, rows in self._compared().items():
            lines += [name] if name else []
            lines += report.spread_table(scalars, rows)
        for quantity in self._settings.quantities:
            if isinstance(quantity, FrfQuantity):
                figure = envelope_figure(report.envelopes(quantity, self._rows), len(self._rows), self._title)
                self._save(figure, "envelope")
            if isinstance(quantity, CoupledQuantity):
                self._save(distribution_figure(quantity, self._compared(), self._title), "distribution")
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
