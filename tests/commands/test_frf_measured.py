"""A measured response laid over the FRF: what it says of the run is taken, and how far the model is from it is told."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from commands import PNG, head, table, zspring
from linear import PUBLISHED, LinearPantograph

FREQUENCIES = np.arange(3.0, 5.6, 0.5)
RUN = ["--set", "suspension=Linear", "--set", "solver.step=0.0002", "--frequencies", "3:5:1", "--no-extremes"]


def write_measured(path: Path, factor: complex, amplitudes=(1.0, 2.0), says: str = "", unit: str = "m/s2") -> None:
    """The closed form of the published DSA-380 times a factor, at these amplitudes."""
    values = dict(PUBLISHED["DSA-380"])
    pantograph = LinearPantograph(head=values.pop("k1"), **values)
    lines = [says, f"frequency [Hz],amplitude [{unit}],real [m/N],imaginary [m/N]"]
    for amplitude in amplitudes:
        for f in FREQUENCIES.tolist():
            H = complex(factor * pantograph.receptance(f))
            lines.append(f"{f},{amplitude},{H.real!r},{H.imag!r}")
    path.write_text("\n".join(line for line in lines if line) + "\n", encoding="utf-8")


def test_levels_become_amplitudes_and_the_distance_is_told(tmp_path):
    """Measured 5 % more and 2 deg ahead of the closed form: the model is 4.8 % below, and 2 deg behind."""
    path = tmp_path / "bench.csv"
    write_measured(path, 1.05 * np.exp(1j * np.radians(2)), says="# static_force: 120 N\n# friction: Regularized")
    out, err = zspring(tmp_path, "frf", "--measured", "bench.csv", *RUN, "--output", "out")
    assert not err
    found = re.findall(r"model against measured (\d) m/s2, (\d) points over 3 to 5 Hz:\n(.*)", out)
    assert [each[:2] for each in found] == [("1", "5"), ("2", "5")]
    for *_, words in found:
        assert words.split(";")[:2] == ["  magnitude -4.8 % in the mean, 4.8 % rms", " phase -2 deg, 2 deg rms"]
    points = table(tmp_path / "out/frf.csv")
    places = {(float(row["amplitude [m/s2]"]), float(row["frequency [Hz]"])) for row in points}
    assert places == {(a, f) for a in (1.0, 2.0) for f in (3.0, 4.0, 5.0)}
    both = table(tmp_path / "out/measured.csv")
    measured, computed = (
        np.array([complex(float(row[f"{kind}_re [m/N]"]), float(row[f"{kind}_im [m/N]"])) for row in both])
        for kind in ("measured", "computed")
    )
    np.testing.assert_allclose(measured / computed, 1.05 * np.exp(1j * np.radians(2)), rtol=2e-3)
    assert (tmp_path / "out/frf.png").read_bytes().startswith(PNG)


def test_what_the_file_says_of_the_bench_is_taken_and_a_wrong_sign_told(tmp_path):
    path = tmp_path / "bench.csv"
    write_measured(path, -1.0, (1.0,), "# static_force: 110 N\n# friction: Coulomb\n# direction: down")
    _, err = zspring(tmp_path, "frf", "--measured", "bench.csv", *RUN, "--output", "out")
    assert {"# direction: down", "# static_force: 110 N", "# friction: Coulomb"} <= set(head(tmp_path / "out/frf.csv"))
    assert "5 of 5 points the receptance has a positive imaginary part" in err and "--measured-force contact" in err
    contact = ["--measured-force", "contact", "--output", "contact"]
    out, err = zspring(tmp_path, "frf", "--measured", "bench.csv", *RUN, *contact)
    (mean,) = re.findall(r"magnitude (\S+) % in the mean", out)
    assert not err and abs(float(mean)) < 0.2


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["--set", "static_force=120"], "static_force: .* says 110 N, the settings 120 N"),
        ([], "the accelerations of level 2 mm are 0.711 to 2.39 m/s2, no steady one: give --amplitudes"),
    ],
)
def test_what_cannot_be_meant_is_refused(tmp_path, arguments, message):
    path = tmp_path / "bench.csv"
    write_measured(path, 1.0, (2.0,), "# static_force: 110 N", "mm")
    _, err = zspring(tmp_path, "frf", "--measured", "bench.csv", *RUN, *arguments, "--output", "out", status=1)
    assert re.search(message, err) and len(err.splitlines()) == 1
    assert not (tmp_path / "out").exists()
