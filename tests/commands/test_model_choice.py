"""Which model the data ask for, told of data whose model is known."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from commands import receptances, zspring

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
