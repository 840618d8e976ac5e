"""The package's JavaScript, as far as it needs no WebAssembly module (those: release/test_webassembly.py), in node."""

from __future__ import annotations

import numpy as np
import pytest

import node_jobs
from zspring.bench.steady import mean_response, repeats_after
from zspring.fmu import Fmu, installed_fmu


@pytest.fixture(scope="module")
def answers(fmus):
    """By job: what node told."""
    return {
        "descriptions": node_jobs.answer("descriptions", fmus),
        "steady": node_jobs.answer(
            "steady", fmus, sequences=[[[H.real, H.imag] for H in each] for each in SEQUENCES], tolerance=1e-3
        ),
    }


def sequences() -> list[np.ndarray]:
    """Responses by period: a constant with decaying, turning, alternating and staying parts, and noise."""
    rng = np.random.default_rng(3)
    made = []
    for count in (8, 12, 16, 24, 40, 80):
        for factors in (
            [0.5],
            [0.9, 0.3],
            [0.8 * np.exp(0.7j), 0.2],
            [-0.7, 0.6j],
            [-1.0],
            [1j, 0.5],
            [np.exp(2j * np.pi / 3), 0.4],
        ):
            for noise in (0, 1e-9, 1e-4):
                n = np.arange(count)
                H = 1 - 0.3j + sum((0.3 + 0.1j) / (i + 1) * factor**n for i, factor in enumerate(factors))
                made.append(1e-5 * (H + noise * (rng.normal(size=count) + 1j * rng.normal(size=count))))
    return made


SEQUENCES = sequences()


def test_descriptions_are_read_as_fmpy_reads_them(answers, fmus):
    for model, told in answers["descriptions"].items():
        with Fmu(installed_fmu(model)) as fmu:
            description, variables = fmu.description, list(fmu.variables)
        assert (told["model"], told["version"], told["guid"]) == (model, description.version, description.guid)
        assert len(told["variables"]) == len(variables)
        for found, v in zip(told["variables"], variables):
            keys = ("name", "reference", "causality", "type", "unit", "description")
            expected = [v.name, v.valueReference, v.causality, v.type, v.unit or "", v.description or ""]
            assert [found[key] for key in keys] == expected
            for bound in "min", "max":
                text = getattr(v, bound)
                assert found.get(bound) == (None if text is None else float(text)), (v.name, bound)
            if v.start is None:
                assert found.get("start") is None
            elif v.type == "Boolean":
                assert found["start"] is (str(v.start) in ("true", "1", "True"))
            else:
                assert found["start"] == float(v.start), v.name
            items = [] if v.declaredType is None or v.type != "Enumeration" else v.declaredType.items
            assert [(i["name"], i["value"]) for i in found["items"]] == [(i.name, int(i.value)) for i in items]
        shown = {v["name"]: v["display"] for v in told["variables"]}
        if "zspring.alpha" in shown:
            assert shown["zspring.alpha"] == {"unit": "deg", "factor": 180 / np.pi}


def test_the_page_sees_the_steady_state_when_python_does(answers):
    repeats = []
    for H, (repeat, left, mean) in zip(SEQUENCES, answers["steady"]):
        expected, distance = repeats_after(list(H), 1e-3)
        assert repeat == expected
        if expected:
            assert left == pytest.approx(distance, rel=1e-3, abs=1e-9)
        assert complex(*mean) == pytest.approx(mean_response(list(H[-3:])), rel=1e-12)
        repeats.append(repeat)
    assert {0, 1, 2, 3, 4} == set(repeats)
