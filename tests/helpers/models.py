"""The two FMUs as the tests of FMI's rules need to know them: runs that move all they have, and a variable of
each kind.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pytest

from harness import Instance, Pantograph, Signal, Value
from zspring.fmu import CATENARY, PANTOGRAPH


@dataclass(frozen=True)
class Case:
    """A run: parameters set before initialization, inputs set at the begin of each step with derivatives."""

    parameters: Mapping[str, Value]
    inputs: Mapping[str, Signal]


@dataclass(frozen=True)
class Model:
    """An FMU with

    instance    the class of its instances
    cases       runs by name; the first one needs no parameter that is an enumeration
    smallest    Integer parameters that make the model small
    others      parameters far from those of the cases
    bounded     two fixed Real parameters with a lower bound
    choice      an enumeration parameter
    force       a Real input, and a Real output that it moves
    discarded   a run whose second step of 0.1 s, with this force in the input `force`, is discarded
    """

    name: str
    instance: type[Instance]
    cases: Mapping[str, Case]
    smallest: Mapping[str, int]
    others: Mapping[str, Value]
    bounded: tuple[str, str]
    choice: str
    force: str
    moved: str
    discarded: tuple[Mapping[str, Value], float]

    @property
    def case(self) -> Case:
        return next(iter(self.cases.values()))


# One iteration of a slope that does not follow the friction law, to a tolerance at the limit of rounding.
HOPELESS = {"solver.tangent": "Exact", "solver.max_iterations": 1, "solver.tolerance": 1e-13, "drive": "Force"}
PRESSING = {"pantograph[1].force": 120.0}
AT_THE_END = {"line.spans": 1, "pantograph[1].start": 59.0, "pantograph[1].speed": 60.0} | PRESSING

MODELS = [
    Model(
        PANTOGRAPH,
        Pantograph,
        {
            "Force": Case({}, {"contact_force": Signal.cubed_sines([60.0], [1.3], 120.0)}),
            "Displacement": Case(
                {"drive": "Displacement", "friction": "Coulomb"},
                {"head_displacement": Signal.cubed_sines([0.02], [1.3])},
            ),
            "Wire": Case({"drive": "Wire", "contact.c": 50.0}, {"wire_height": Signal([(0.012, 25.0, 0.0)])}),
            "Bench": Case({"drive": "Bench", "bench.acceleration": 3.0}, {}),
            "compliant wire": Case(
                {"drive": "Wire", "contact.c": 20.0, "wire.compliance": 2e-6, "wire.compliance_previous": 1e-6},
                {
                    "wire_height": Signal([(0.012, 25.0, 0.0)], -0.00036),
                    "wire.compliance": Signal([(1e-6, 30.0, 0.0)], 2e-6),
                },
            ),
        },
        smallest={},
        others={"m1": 9.0, "suspension": "LinearFree", "bench.frequency": 7.0},
        bounded=("m1", "m2"),
        choice="drive",
        force="contact_force",
        moved="head.z",
        discarded=(HOPELESS, 300.0),
    ),
    Model(
        CATENARY,
        Instance,
        {
            "Speed": Case(
                {"line.spans": 2, "pantograph[1].start": 20.0, "pantograph[1].speed": 40.0} | PRESSING,
                {
                    "pantograph[1].force": Signal.cubed_sines([90.0], [1.3], 120.0),
                    "pantograph[1].speed": Signal([(10.0, 5.0, 0.0)], 40.0),
                },
            ),
            "Position": Case(
                {"line.spans": 2, "travel": "Position", "damping.stiffness": 1e-3, "pantograph[2].force": 90.0},
                {
                    "pantograph[1].force": Signal.cubed_sines([90.0], [1.3]),
                    "pantograph[1].position": Signal([(30.0, 3.0, 0.0)], 60.0),
                    "pantograph[2].position": Signal([(5.0, 9.0, 0.0)], 95.0),
                },
            ),
            **{
                exchange: Case(
                    {"exchange": exchange, "line.spans": 2, "pantograph[1].start": 20.0, "pantograph[1].speed": 40.0}
                    | {"pantograph[1].static_force": 110.0, "exchange.step": 0.01}
                    | PRESSING,
                    {"pantograph[1].force": Signal.cubed_sines([90.0], [1.3], 120.0)},
                )
                for exchange in ("Sequential", "Parallel")
            },
        },
        smallest={"line.spans": 1},
        others={"line.spans": 3, "contact_wire.mass": 1.0, "travel": "Position", "pantograph[1].position": 20.0},
        bounded=("contact_wire.mass", "contact_wire.tension"),
        choice="travel",
        force="pantograph[1].force",
        moved="pantograph[1].uplift",
        discarded=(AT_THE_END, 200.0),
    ),
]


def each_case_but(*left_out: str) -> pytest.MarkDecorator:
    """Parameters `model` and `case` of a test: every case of both FMUs but these."""
    cases = [(m, name, case) for m in MODELS for name, case in m.cases.items() if name not in left_out]
    parameters = [pytest.param(m, case, id=f"{m.name}-{name}") for m, name, case in cases]
    return pytest.mark.parametrize("model, case", parameters, indirect=["model"])


each_case = each_case_but()
