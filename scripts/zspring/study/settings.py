"""A study as its TOML file describes it; resources/examples/study.toml explains one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..bench.measure import BENCH_PARAMETERS
from ..draws import read_draws
from ..errors import ZSpringError
from ..fmu import Fmu
from ..line.quantities import points_of
from ..line.system import most_points
from ..line_file.chosen import line_of
from ..line_table import LineTable
from ..parameter_sets import ACCURATE_STEP, PANTOGRAPHS, chosen_set, packaged_sets
from ..settings import named, settings_of
from ..variables import Value, Variables, text
from .coupled import COUPLE, IRREGULARITY, LINE, CoupledQuantity
from .evaluations import Quantity
from .factors import (
    IRREGULARITIES,
    LINE_NUMBER,
    SET_BY_THE_RUN,
    choice_variable,
    factors,
    own_variable,
    run_keys,
    value_of,
)
from .file import SAMPLED, Range, StudyFile
from .irregular import Irregularity
from .roughness import roughness_of

_SLACK = {f"{IRREGULARITY}slack", f"{IRREGULARITY}slack_by"}
_HEIGHT = f"{IRREGULARITY}contact_wire"
_FORCE = {f"{COUPLE}static_law", "static_force"}  # the law sets the force, whatever it was
COMPARED = "compare"  # name of what tells which of the compared a case is
Parameters = dict[str, Value]


@dataclass(frozen=True)
class StudySettings:
    """What to vary and what to compute; everything here changes the numbers."""

    design: str
    samples: int  # 0 for grid and list
    seed: int  # of sampled designs
    vary: Mapping[str, Range | tuple[Value, ...]]  # by parameter: Range for sampled designs, else values
    common: Mapping[str, Value]  # parameters that all cases have in common
    quantities: tuple[Quantity, ...]
    compared: Mapping[str, Parameters] = field(default_factory=dict)  # by name, in place of `common`; or none
    variables: Variables = field(default_factory=lambda: Variables([]))  # of all that can vary
    lines: int = 0  # irregular ones; 0: that of the design alone
    title: str = ""  # of the figures, which it changes alone

    @property
    def names(self) -> list[str]:
        """Of what differs between cases."""
        return [*self.vary, *([LINE_NUMBER] if self.lines else []), *([COMPARED] if self.compared else [])]

    @property
    def sets(self) -> list[Parameters]:
        """What cases are given but for what varies: by each of the compared, or by all."""
        return list(self.compared.values()) or [dict(self.common)]

    def parameters_of(self, case: Mapping[str, Value]) -> Parameters:
        """All that a case is given."""
        own = dict(case)
        return {**self.sets[int(own.pop(COMPARED, 1)) - 1], **own}

    def described(self) -> dict[str, str]:
        """Everything above but the common parameters as text, by key."""
        head = {"design": self.design}
        if self.design in SAMPLED:
            head |= {"samples": str(self.samples), "seed": str(self.seed)}
        for name, values in self.vary.items():
            head[f"vary {name}"] = (
                f"{values.low!r} to {values.high!r}, {values.scale}"
                if isinstance(values, Range)
                else " ".join(text(self.variables[name], value) for value in values)
            )
        for i, (name, parameters) in enumerate(self.compared.items(), 1):  # their order tells the sign of differences
            own = {key: value for key, value in parameters.items() if self._differs(key)}
            texts = (f"{key}={text(self.variables[key], value)}" for key, value in own.items())
            head[f"compare {i}"] = " ".join([f"{name}:", *texts])
        if self.lines:
            head["irregular lines"] = str(self.lines)
        for quantity in self.quantities:
            head |= quantity.described()
        return head

    def _differs(self, name: str) -> bool:
        """Whether the compared do not all have the same value of a parameter."""
        return len({parameters.get(name) for parameters in self.compared.values()}) > 1

    def is_common(self, name: str) -> bool:
        """Whether all cases have the same value of a parameter."""
        return name not in self.vary and not self._differs(name)


def read_study(path: Path, fmu: Fmu, catenary: Fmu | None = None) -> StudySettings:
    """The study of a TOML file.

    catenary    for a study with [couple]
    Raises ZSpringError with the file and the key, or the line of bad syntax.
    """
    with settings_of(path, StudyFile, brackets=True) as file:
        if file.couple and catenary is None:
            raise ZSpringError("[couple]: needs the FMU of the catenary")
        variables = factors(fmu.variables, catenary.variables if file.couple and catenary else None)
        with named("[set] "):
            common = {name: value_of(variables, name, value) for name, value in file.common.items()}
        with named("[vary] "):
            given = file.vary
            if file.draws:
                given = _by_parameter(read_draws(file.draws, fmu, (*BENCH_PARAMETERS, *common)))
            vary = {name: _varied(variables, name, value, file.design) for name, value in given.items()}
        line, irregularity, told = None, None, {*common, *vary}
        if file.couple and catenary:
            line, of_line = _line(file.couple.line, catenary, vary)
            if len(points_of(file.couple.values)) > (most := most_points(catenary)):
                raise ZSpringError(f"[couple] values: uplift_at is told of {most} points at most")
            of_run = _tabled("couple", file.couple, run_keys(), variables, vary)
            told |= of_run.keys()
            _check_force(told)
            common = {**of_line, **of_run, **common}
            if file.irregularity:
                irregularity, of_it = _irregularity(file.irregularity, line, variables, vary)
                common = {**of_it, **common}
        sets = _Sets(fmu, path.parent, (*BENCH_PARAMETERS, *vary), common)
        compared = {}
        for name, assigned in file.compare.items():
            with named(f"[compare] {name}: "):
                _check_force(told | assigned.keys())
                compared[name] = sets.with_own(variables, assigned, file.parameter_set)
        lengths = {name: len(values) for name, values in vary.items() if not isinstance(values, Range)}
        if file.design == "list" and len(set(lengths.values())) > 1:
            found = ", ".join(f"{name} has {length}" for name, length in lengths.items())
            raise ZSpringError(f"[vary]: design list needs as many values of each parameter: {found}")
        quantities: tuple[Quantity, ...] = tuple(table.quantity for table in (file.frf, file.static) if table)
        whole = sets.whole(file.parameter_set)
        if irregularity:
            for name, each in (compared or {"": whole}).items():
                with named(f"[irregularity] with [compare] {name}: " if name else "[irregularity] "):
                    _check_irregularity(irregularity, {*each, *vary})
            variables = Variables([*variables, own_variable(LINE_NUMBER, "Integer", min="1")])
        if file.couple:
            most = _most(f"{COUPLE}pantographs", vary, [whole, *compared.values()])
            quantities += (CoupledQuantity(file.couple.values, most, file.couple.spans, line, irregularity),)
        if compared:
            variables = Variables([*variables, choice_variable(COMPARED, compared)])
        lines = file.irregularity.lines if file.irregularity else 0
        return StudySettings(
            file.design, file.samples, file.seed, vary, whole, quantities, compared, variables, lines, file.title
        )


@dataclass(frozen=True)
class _Sets:
    """Parameters of sets under those of [set].

    folder      of the study
    but_not     what sets do not tell
    """

    fmu: Fmu
    folder: Path
    but_not: Sequence[str]
    common: Mapping[str, Value]

    def whole(self, name: str) -> Parameters:
        """The set of that name, if any, and [set]."""
        used = chosen_set(name, self.fmu, but_not=self.but_not) if name else {}
        step = {} if "solver.step" in self.but_not else {"solver.step": ACCURATE_STEP}
        return {**step, **used, **self.common}

    def with_own(self, variables: Variables, assigned: Mapping[str, Any], usual: str) -> Parameters:
        """What one of the compared is given, its own set in place of the usual one."""
        own, given = assigned.get("parameters", usual), dict(assigned)
        if given.pop("parameters", None) and own not in packaged_sets(PANTOGRAPHS):
            own = str(self.folder / own)
        for name in given:
            if name in self.but_not:
                raise ZSpringError(f"{name}: must be in [vary] or in [compare], not in both")
        return {**self.whole(own), **{name: value_of(variables, name, value) for name, value in given.items()}}


def _line(name: str, catenary: Fmu, vary: Mapping[str, Any]) -> tuple[LineTable | None, Parameters]:
    """The table of a line file, if it is one, and the parameters of the line."""
    line = line_of(name, catenary, SET_BY_THE_RUN)
    own = {LINE + key: value for key, value in line.parameters.items()}
    return line.catenary.line, {key: value for key, value in own.items() if key not in vary}


def _tabled(table: str, given: Any, keys: Sequence[str], variables: Variables, vary: Mapping[str, Any]) -> Parameters:
    """What a table gives of what can vary."""
    values: Parameters = {}
    with named(f"[{table}] "):
        for key in keys:
            if (value := getattr(given, key)) is not None:
                name = f"{table}.{key}"
                if name in vary:
                    raise ZSpringError(f"{key}: must be in [vary] or in [{table}], not in both")
                values[name] = value_of(variables, name, value)
    return values


def _irregularity(
    given: Any, line: LineTable | None, variables: Variables, vary: Mapping[str, Any]
) -> tuple[Irregularity, Parameters]:
    """The distribution of lines, and what the table gives of what can vary."""
    values = _tabled("irregularity", given, list(IRREGULARITIES), variables, vary)
    rough, deviation = roughness_of(given)
    with named("[irregularity] "):
        if line is None:
            raise ZSpringError("needs a line file: [couple] line = ..., with the suffix .toml")
        if rough and len(line.profile):
            raise ZSpringError("contact_wire: the line file has an irregularity of its own")
        if deviation is not None and _HEIGHT not in {*values, *vary}:
            values[_HEIGHT] = deviation
        return Irregularity(line, given.seed, rough), values


def _check_irregularity(irregularity: Irregularity, told: set[str]) -> None:
    """Refuses what a case is told that does nothing, or nothing alone."""
    if _HEIGHT in told and irregularity.roughness is None:
        raise ZSpringError("contact_wire: needs wavelengths and exponent, a spectrum or a profile")
    if irregularity.roughness and _HEIGHT not in told:
        raise ZSpringError("contact_wire is missing: the standard deviation in m")
    if _SLACK & told not in (set(), _SLACK):
        raise ZSpringError("slack and slack_by: one alone does nothing")


def _check_force(told: set[str]) -> None:
    """Refuses a static force that the law would overwrite."""
    if _FORCE <= told:
        raise ZSpringError("static_force and static_law: give one of them")


def _most(name: str, vary: Mapping[str, Range | tuple[Value, ...]], sets: Sequence[Parameters]) -> int:
    """The largest value of an Integer in any case, which is 1 where none has it."""
    values = vary.get(name, ())
    varied = () if isinstance(values, Range) else values  # ranges are for Real ones alone
    return max(1, *map(int, varied), *(int(each.get(name, 1)) for each in sets))


def _by_parameter(draws: Sequence[Mapping[str, Value]]) -> dict[str, Range | list]:
    """Values of each parameter, one for each draw."""
    return {name: [draw[name] for draw in draws] for name in draws[0]}


def _varied(variables: Variables, name: str, given: Range | list, design: str) -> Range | tuple[Value, ...]:
    """A parameter of [vary]: a range where the design samples it, otherwise values."""
    is_sampled, is_real = design in SAMPLED, variables.settable(name).type == "Real"
    if isinstance(given, list):
        if is_sampled:
            needed = "a range { from = ..., to = ... }" if is_real else "design grid or list, as it is no real number"
            raise ZSpringError(f"{name} = {given!r}: needs {needed}")
        values = tuple(value_of(variables, name, item) for item in given)
        if design == "grid" and len(set(values)) < len(values):
            raise ZSpringError(f"{name} = {given!r}: needs different values")
        return values
    if not is_real:
        raise ZSpringError(f"{name}: needs a list of values, as it is no real number")
    for end in (given.low, given.high):
        value_of(variables, name, end)
    if is_sampled and given.count:
        raise ZSpringError(f"{name}.count: only for grid and list, not for {design}")
    if is_sampled:
        return given
    if not given.count:
        raise ZSpringError(f"{name}.count is missing")
    return tuple(given.at(i / (given.count - 1)) for i in range(given.count))
