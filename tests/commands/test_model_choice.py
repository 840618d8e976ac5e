"""Which model the data ask for, told of data whose model is known."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from commands import receptances, zspring
from zspring.bench.curves import Curve
from zspring.fmu import Fmu
from zspring.identify.choice import Candidate, choice_table, others
from zspring.identify.fit import Fit
from zspring.identify.problem import Answer, Problem
from zspring.identify.settings import Free, Settings, Tie
from zspring.variables import parse

FIT = """model = "zspring"
compare_models = true
search = { samples = 0 }
[[measurement]]
file = "bench.csv"
[free]
zspring.k = { start = 14000, min = 5000, max = 40000 }
zspring.Mf = { start = 0.35, min = 0.02, max = 2 }
[fixed]
solver.step = 0.002
"""


def measured(folder: Path, friction: str, amplitudes: str, noise: float, *settings: str) -> None:
    options = ["--amplitudes", amplitudes, "--frequencies", "3:9:0.75", "--no-extremes", "--set", "solver.step=0.002"]
    zspring(folder, "frf", *options, "--set", f"friction={friction}", *settings, "--output", "truth")
    rng = np.random.default_rng(3)
    lines = [
        "# static_force: 120 N",
        "# friction: Regularized",
        "frequency [Hz],amplitude [m/s2],real [m/N],imaginary [m/N]",
    ]
    for (a, f), H in receptances(folder / "truth/frf.csv").items():
        H *= np.exp(noise * complex(*rng.standard_normal(2)))
        lines.append(f"{f},{a},{H.real},{H.imag}")
    (folder / "bench.csv").write_text("\n".join(lines) + "\n")
    (folder / "fit.toml").write_text(FIT)


def criteria(out: str) -> dict[str, float]:
    return {name: float(value) for name, value in re.findall(r"^(Z-spring, \w+|linear head) +\d +([+-]\S+)", out, re.M)}


@pytest.mark.parametrize("friction", ["Regularized", "Coulomb"])
def test_the_law_that_made_the_data_is_found(tmp_path, friction):
    """Although the file says Regularized: the fit of that is compared with the other's."""
    measured(tmp_path, friction, "0.5,2", 0.005)
    out, _ = zspring(tmp_path, "identify", "fit.toml", "--output", "out")
    found = criteria(out)
    assert min(found, key=found.__getitem__) == f"Z-spring, {friction}" and sorted(found.values())[1] > 6
    assert f"the data ask for Z-spring, {friction}" in out
    assert found["linear head"] > 50


def test_small_amplitudes_cannot_tell_the_laws_apart(tmp_path):
    """Where the rods stick under either law, and a spring of locked rods does as well."""
    measured(tmp_path, "Coulomb", "0.05", 0.01)
    out, _ = zspring(tmp_path, "identify", "fit.toml", "--output", "out")
    assert "the data cannot tell" in out and "less than 6 apart" in out


class Texts(HTMLParser):
    def __init__(self, page: str):
        super().__init__()
        self.texts, self.sources = [], []
        self.feed(page)

    def handle_data(self, data):
        self.texts.append(data.strip())

    def handle_starttag(self, tag, attributes):
        self.sources += [value for key, value in attributes if key in ("src", "href")]


def test_the_report_has_what_the_terminal_has_and_needs_nothing_else(tmp_path):
    measured(tmp_path, "Regularized", "0.5,2", 0.005)
    out, _ = zspring(tmp_path, "identify", "fit.toml", "--output", "out")
    page = Texts((tmp_path / "out/report.html").read_text(encoding="utf-8"))
    lines = "\n".join(page.texts)
    for line in out.split("fitted in")[0].splitlines():
        assert line.strip() in lines
    assert all(source.startswith(("#", "data:")) for source in page.sources)
    assert "Friction law Regularized; weights: all points alike." in lines and "solver.step 0.002 s" in lines
    assert "zspring.L1" not in lines.split("Synthetic")[0]


def candidate(name: str, squares: float, parameters: int, weights: str) -> Candidate:
    """With 1000 residuals of this sum of squares."""
    curve = Curve("1 m/s2", np.ones(500), np.ones(500), np.ones(500, complex), np.ones((500, 2)))
    free = {f"m{i}": Free(start=1, min=0, max=2) for i in range(parameters)}
    settings = Settings.model_construct(model="zspring", free=free, weights=weights)
    model = SimpleNamespace(relative_step=1.0, tolerance=1.0, is_costly=False)
    answer = Answer([np.full(500, np.exp(np.sqrt(squares / 500)) + 0j)], None)
    x = np.zeros(parameters)
    fit = Fit(x, x, answer, squares / 2, True, "", 1, x > 1, x, x, np.eye(parameters), np.eye(parameters))
    return Candidate(name, Problem(settings, model, [curve]), fit)


@pytest.mark.parametrize(
    "weights, some, other, verdict",
    [
        ("errors", 1000.0, 1010.0, "the data ask for A"),  # exp(-5): strong, if the errors are right
        ("errors", 16_000.0, 16_010.0, "the data cannot tell A from B"),  # four times the errors: 10 / 16
        ("equal", 16_000.0, 16_010.0, "the data cannot tell A from B"),  # 1000 ln(1.0006)
        ("equal", 1000.0, 1010.0, "the data ask for A"),  # 1000 ln(1.01)
    ],
)
def test_errors_that_no_model_keeps_tell_less(weights, some, other, verdict):
    lines = choice_table([candidate("A", some, 3, weights), candidate("B", other, 3, weights)])
    assert any(line.startswith(verdict) for line in lines)
    assert any("even A misses them by 4" in line for line in lines) == (weights == "errors" and some > 2000)


def test_a_parameter_more_costs_the_logarithm_of_the_residuals():
    lines = choice_table([candidate("A", 1000.0, 3, "errors"), candidate("B", 1000.0, 4, "errors")])
    assert lines[2].split()[:3] == ["B", "4", f"{np.log(1000):+.3g}"]


def test_other_models_have_no_tie_or_parameter_that_they_do_not_know():
    """A linear head does not know zspring.k, to which k1 was tied; Coulomb's law not how steep the other one is."""
    free = {"zspring.k": Free(start=1e4, min=1e3, max=1e5), "zspring.tau": Free(start=900, min=100, max=5000)}
    with Fmu() as model:
        defaults = {v.name: parse(v, v.start) for v in model.variables if v.causality == "parameter"}
        settings = Settings.model_construct(
            model="zspring", free=free, fixed={"friction": 1}, tied={"k1": Tie(to="zspring.k"), "m2": Tie(to="m3")}
        )
        settings.fixed["m3"] = 5.8
        found = others(model, settings, defaults)
    assert list(found["Z-spring, Coulomb"].free) == ["zspring.k"]
    assert found["Z-spring, Coulomb"].fixed["zspring.tau"] == 900
    linear = found["linear head"]
    assert list(linear.free) == ["k1", "c1"] and list(linear.tied) == ["m2"]
    assert linear.parameters(np.full(2, 0.5))["m2"] == 5.8
