"""The overhead lines that come with the package, as SSV files: what they hold and where it is from."""

from __future__ import annotations

import importlib.resources
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from fmpy.ssp.ssd import read_ssv

from catenary_line import BENCHMARK_2015, EN_50318_2002, parameters_of
from harness import Fmu
from zspring.fmu import CATENARY, installed_fmu
from zspring.fmu import Fmu as ZSpringFmu
from zspring.parameter_sets import describe_set, read_set

FILES = {
    path.stem: path
    for path in sorted(Path(str(importlib.resources.files("zspring") / "resources/lines")).glob("*.ssv"))
}
PUBLISHED = {"en-50318-2002": EN_50318_2002, "benchmark-2015": BENCHMARK_2015}


@pytest.fixture(scope="module")
def model():
    with ZSpringFmu(installed_fmu(CATENARY)) as model:
        yield model


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_lines_have_the_published_numbers(model, name):
    values = read_set(FILES[name], model)
    expected = parameters_of(PUBLISHED[name])
    assert set(expected) - set(values) <= {"mesh.element", "dropper.stiffness"}
    assert values == {parameter: expected[parameter] for parameter in values}


@pytest.mark.parametrize("name", FILES)
def test_every_parameter_of_a_line_tells_its_source_also_to_another_tool(model, name):
    description, remarks = describe_set(FILES[name])
    values = read_set(FILES[name], model)
    assert "second-hand" in description.lower()
    assert sorted(chain.from_iterable(remarks.values())) == sorted(values)
    other = {p.name: p for p in read_ssv(str(FILES[name])).parameters}
    assert {p: float(v.value) for p, v in other.items()} == values


@pytest.mark.parametrize("name", FILES)
def test_the_lines_stand_with_all_droppers_taut(catenary, name):
    """And are softer in the middle of a span than at a support."""
    values = {p.name: float(p.value) for p in read_ssv(str(FILES[name])).parameters}
    values |= {p: int(values[p]) for p in ("line.spans", "dropper.count")}
    span = values["line.span"]
    unloaded = catenary(values)
    assert unloaded["droppers.slack"] == 0 and unloaded["droppers.force_min"] > 20.0
    loaded = [
        catenary(values | {"pantograph[1].force": 100.0, "pantograph[1].start": x}) for x in (5 * span, 5.5 * span)
    ]
    support, middle = (p["pantograph[1].uplift"] / 100 for p in loaded)
    tensions = values["contact_wire.tension"] + values["messenger.tension"]
    assert 0.15e-3 < support < middle
    assert middle == pytest.approx(span / (3.75 * tensions), rel=0.15)  # the usual rule: k = 3.5 to 4


def test_the_catenary_starts_as_the_line_of_en_50318_2002(fmu_catenary: Fmu, model):
    values = read_set(FILES["en-50318-2002"], model)
    assert {name: fmu_catenary.start(name) for name in values} == values
    assert np.all([fmu_catenary.variables[name].causality == "parameter" for name in values])
