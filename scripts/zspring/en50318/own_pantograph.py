"""A user's own pantograph on the lines of the reference cases, counted apart from them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ..fmu import Fmu
from ..heads import synthetic_note
from ..page import WORDS, Cell, Chapter, Table
from ..variables import Value, with_unit
from . import report, summary
from .chapters import Outcome
from .plan import Run

GROUP = "own pantograph"


@dataclass(frozen=True)
class OwnPantograph:
    """Parameters of a pantograph, and what it is called."""

    name: str
    parameters: Mapping[str, Value]

    def runs(self, references: Sequence[Run]) -> list[Run]:
        """The runs of reference cases with this pantograph: static force by its own parameters, else by the case."""
        made = []
        for run in references:
            parameters = {"static_force": run.pantograph["static_force"], **self.parameters}
            if "solver.step" in parameters:
                parameters["solver.step"] = min(parameters["solver.step"], run.pantograph["solver.step"])
            uplift = 0.0 if run.mean_force is None else run.mean_force - parameters["static_force"]
            series = f"own-pantograph-{run.series}"
            made.append(replace(run, group=GROUP, pantograph=parameters, uplift=uplift, series=series))
        return made

    def chapter(self, outcomes: Sequence[tuple[Outcome, Outcome]], pantograph: Fmu, catenary: Fmu) -> Chapter:
        """Figures beside those of the reference pantograph; outcomes: by edition, of the reference and this one."""
        text = (
            "Lines, speeds, evaluated spans and target mean forces are those of the reference cases. The accepted "
            "ranges are those of the reference pantograph, so that this one is not judged by them."
        )
        chapter = Chapter(f"Own pantograph: {self.name}{synthetic_note(pantograph, self._used(pantograph))}", [text])
        for reference, own in outcomes:
            chapter.blocks += [f"{own.edition.name}: {line}." for line in own.remarks(catenary)]
            for mine, theirs in zip(own.passages, reference.passages):
                title = f"{self.name}, {own.edition.name}, {mine.title}"
                both = {self.name: mine.found, f"reference: {Path(mine.case.pantograph).stem}": theirs.found}
                table = report.figures_table(both, f"{title}: {mine.run.section}")
                chapter.blocks += [table, mine.picture(title)]
        rows: list[list[str | Cell]] = [
            [name, Cell(with_unit(pantograph.variables[name], value), WORDS)] for name, value in self.parameters.items()
        ]
        chapter.blocks.append(Table(f"Parameters of {self.name}", ["parameter", "value"], rows))
        return chapter

    def summary_rows(self, own: Outcome) -> list[summary.Row]:
        """The rows of the box on top."""
        return [
            summary.row(
                f"own pantograph, {own.edition.name}, {each.title}",
                self.name,
                Path(each.case.line).stem,
                each.run.speed,
                each.run.section,
                None,
                each.found,
            )
            for each in own.passages
        ]

    def _used(self, pantograph: Fmu) -> dict[str, Value]:
        return pantograph.used_parameters(self.parameters)


def name_of(parameter_set: str | None, assignments: Sequence[str]) -> str:
    """What the pantograph of --parameters and --set is called."""
    named = Path(parameter_set).stem if parameter_set else "the FMU's own"
    return ", ".join([named, *assignments])


def lines(name: str, own: Outcome, reference: Outcome, catenary: Fmu) -> list[str]:
    """What the command prints: main values by case, those of the reference in brackets, and the limit of quality."""
    rows: list[list[str | Cell]] = []
    for figure in (*report.SENSITIVE, "loss_of_contact"):
        pairs = zip(own.passages, reference.passages)
        both = [[report.number(figure, each.found[figure]) for each in pair] for pair in pairs]
        rows.append([report.labelled(figure), *(f"{mine} ({theirs})" for mine, theirs in both)])
    title = f"{name}, {own.edition.name} (reference pantograph)"
    table = Table("", [title, *(each.title for each in own.passages)], rows)
    share = summary.shares(name, {each.title: each.found for each in own.passages})
    return [*report.as_lines(table), share, *own.remarks(catenary), ""]
