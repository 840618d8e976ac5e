"""The first case of a study as the FMUs take it, and what the head of its files says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ..errors import ZSpringError
from ..fmu import Fmu
from ..heads import file_head
from ..line.run import LineRun
from ..variables import Value, text
from .coupled import COUPLE, IRREGULARITY, LINE, CoupledQuantity, pantograph_parameters, system_of
from .design import Case
from .evaluations import Quantity
from .factors import is_set_by_the_run
from .settings import StudySettings


@dataclass(frozen=True)
class Start:
    """What a case that the FMUs start with is given.

    parameters      all of the pantograph
    line            what a run along a line says of itself, as the head of its file has it
    """

    parameters: Mapping[str, Value]
    line: Mapping[str, str] = field(default_factory=dict)


def first_start(settings: StudySettings, cases: Sequence[Case], fmu: Fmu, catenary: Fmu) -> Start:
    """The first case that starts. Raises ZSpringError if none does."""
    refusal = None
    with fmu.instances() as (instance,):
        for case in cases:
            given = settings.parameters_of(case)
            try:
                instance.start(pantograph_parameters(given))
                names = [name for name in fmu.variables.names("parameter") if not name.startswith("bench.")]
                parameters = dict(zip(names, instance.get(names)))
                return Start(parameters, _line(settings.quantities, fmu, catenary, given))
            except ZSpringError as error:
                refusal = refusal or error
    raise ZSpringError(f"the FMU starts with no case: {refusal}")


def _line(quantities: Sequence[Quantity], fmu: Fmu, catenary: Fmu, given: Mapping[str, Value]) -> dict[str, str]:
    quantity = next((each for each in quantities if isinstance(each, CoupledQuantity)), None)
    if quantity is None:
        return {}
    design = {name: value for name, value in given.items() if not name.startswith(IRREGULARITY)}
    with quantity.on_line(catenary, design) as (on_line, parameters):
        system, _ = system_of(fmu, on_line, parameters)
        with LineRun(system) as run:
            own = {name.removeprefix("catenary "): value for name, value in run.settings.items() if "catenary " in name}
            return {f"catenary {name}": value for name, value in own.items() if not is_set_by_the_run(name)}


def study_head(settings: StudySettings, start: Start, fmu: Fmu, catenary: Fmu, cases: int) -> dict[str, str]:
    """Everything that defines the numbers of the study."""
    own = {"SHA-256 of the FMU": fmu.sha256}
    if start.line:
        own["SHA-256 of the catenary"] = catenary.sha256
    own |= {"cases": str(cases), **settings.described()}
    own |= {
        name.replace(".", " ", 1): text(settings.variables[name], value)
        for name, value in settings.sets[0].items()
        if name.startswith((COUPLE, IRREGULARITY)) and settings.is_common(name)
    }
    line = {name: value for name, value in start.line.items() if settings.is_common(name.replace("catenary ", LINE, 1))}
    common = {name: value for name, value in start.parameters.items() if settings.is_common(name)}
    law = f"{COUPLE}static_law"  # sets the static force of a run along a line, whatever the parameters have
    is_set = law in settings.vary or all(law in parameters for parameters in settings.sets)
    is_told_by_law = is_set and all(isinstance(each, CoupledQuantity) for each in settings.quantities)
    return {**file_head(fmu, common, own, but_not=("drive", *(["static_force"] if is_told_by_law else []))), **line}
