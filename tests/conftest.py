"""Fixtures: the FMUs of the installed package, each extracted once; instances and processes end with each test."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from fmpy import extract

from commands import end_all
from harness import Fmu, Instance, Pantograph
from models import MODELS, Model
from zspring.fmu import CATENARY, PANTOGRAPH, installed_fmu


@pytest.fixture(autouse=True)
def no_process_is_left() -> Iterator[None]:
    """A test that fails in the middle leaves nothing running."""
    yield
    end_all()


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Fmu]:
    """The FMUs by model."""

    def extracted(model: str) -> Fmu:
        path = installed_fmu(model)
        return Fmu(path, Path(extract(str(path), unzipdir=str(tmp_path_factory.mktemp("fmu with spaces")))))

    return {model: extracted(model) for model in (PANTOGRAPH, CATENARY)}


def instances(kind: type[Instance], fmu: Fmu) -> Iterator[Callable[..., Instance]]:
    """A function that makes instances, until the iterator goes on and frees them."""
    made: list[Instance] = []

    def make(*arguments, **options) -> Instance:
        made.append(kind(fmu, *arguments, **options))
        return made[-1]

    yield make
    for instance in made:
        instance.close()


@pytest.fixture(scope="session")
def fmu(fmus: dict[str, Fmu]) -> Fmu:
    """That of the pantograph."""
    return fmus[PANTOGRAPH]


@pytest.fixture
def pantograph(fmu: Fmu) -> Iterator[Callable[..., Pantograph]]:
    """Makes instances of the pantograph: pantograph({"drive": "Wire"}, ...)."""
    yield from instances(Pantograph, fmu)


@pytest.fixture(scope="session")
def fmu_catenary(fmus: dict[str, Fmu]) -> Fmu:
    return fmus[CATENARY]


@pytest.fixture
def catenary(fmu_catenary: Fmu) -> Iterator[Callable[..., Instance]]:
    """Makes instances of the catenary: catenary({"line.spans": 4}, ...)."""
    yield from instances(Instance, fmu_catenary)


@pytest.fixture(params=MODELS, ids=lambda model: model.name)
def model(request: pytest.FixtureRequest) -> Model:
    """Each of the FMUs in turn: what the tests of FMI's rules know of it."""
    return request.param


@pytest.fixture
def any_fmu(model: Model, fmus: dict[str, Fmu]) -> Fmu:
    """The FMU of `model`."""
    return fmus[model.name]


@pytest.fixture
def instance(model: Model, any_fmu: Fmu) -> Iterator[Callable[..., Instance]]:
    """Makes instances of `model`."""
    yield from instances(model.instance, any_fmu)
