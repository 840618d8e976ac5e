"""Fixtures: the FMUs of the installed package, each extracted once, and instances freed after each test."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from fmpy import extract
from zspring.fmu import CATENARY, PANTOGRAPH, installed_fmu

from harness import Fmu, Pantograph


def extracted(model: str, factory: pytest.TempPathFactory) -> Fmu:
    path = installed_fmu(model)
    return Fmu(path, Path(extract(str(path), unzipdir=str(factory.mktemp("fmu with spaces")))))


def instances(fmu: Fmu) -> Iterator[Callable[..., Pantograph]]:
    """One function that makes instances, see Pantograph; they are freed when the iterator goes on."""
    made: list[Pantograph] = []

    def make(*arguments, **options) -> Pantograph:
        made.append(Pantograph(fmu, *arguments, **options))
        return made[-1]

    yield make
    for instance in made:
        instance.close()


@pytest.fixture(scope="session")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Fmu:
    return extracted(PANTOGRAPH, tmp_path_factory)


@pytest.fixture
def pantograph(fmu: Fmu) -> Iterator[Callable[..., Pantograph]]:
    """Makes instances of the pantograph: pantograph({"drive": "Wire"}, ...)."""
    yield from instances(fmu)


@pytest.fixture(scope="session")
def fmu_catenary(tmp_path_factory: pytest.TempPathFactory) -> Fmu:
    return extracted(CATENARY, tmp_path_factory)


@pytest.fixture
def catenary(fmu_catenary: Fmu) -> Iterator[Callable[..., Pantograph]]:
    """Makes instances of the catenary: catenary({"line.spans": 4}, ...)."""
    yield from instances(fmu_catenary)
