"""Fixtures: the FMU of the installed package, extracted once, and instances freed after each test."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from fmpy import extract
from zspring.fmu import installed_fmu

from harness import Fmu, Pantograph


@pytest.fixture(scope="session")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Fmu:
    path = installed_fmu()
    return Fmu(path, Path(extract(str(path), unzipdir=str(tmp_path_factory.mktemp("fmu with spaces")))))


@pytest.fixture
def pantograph(fmu: Fmu) -> Iterator[Callable[..., Pantograph]]:
    """Makes instances: pantograph({"drive": "Wire"}, ...), see Pantograph; the test's end frees them."""
    made: list[Pantograph] = []

    def make(*arguments, **options) -> Pantograph:
        made.append(Pantograph(fmu, *arguments, **options))
        return made[-1]

    yield make
    for instance in made:
        instance.close()
