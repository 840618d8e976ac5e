"""The wheel in a Python for Windows, under wine with Microsoft's C library: commands write what they write on Linux.

Folders have spaces and umlauts, files come as Windows writes them, output goes to pipes and files. Each run is made
here, too, with the same wheel and the same versions of NumPy and SciPy. Where numbers may differ, it is by the last
digits of functions of the C library: cosine, logarithm, complex absolute value.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from windows_python import WindowsPython, differences, with_wheel

from zspring.fmu import CATENARY, PANTOGRAPH
from zspring.parameter_sets import find_set

FOLDER = "Stromabnehmer für Übung"
PASSING = "# date", "# elapsed"
TIME = re.compile(r"[\d.]+ (s|points/s|times faster)\b")


class Both:
    """The same commands on Windows and here, in a folder of each."""

    def __init__(self, python: WindowsPython, folder: Path):
        self._python = python
        self.windows, self.linux = (folder / system / FOLDER for system in ("Windows", "Linux"))
        for each in (self.windows, self.linux):
            each.mkdir(parents=True)

    def write(self, name: str, content: bytes) -> None:
        for each in (self.windows, self.linux):
            (each / name).write_bytes(content)

    def __call__(self, *arguments: str) -> str:
        """Runs `zspring` on both, which must tell the same; what it told."""
        status, out = self._python.zspring(self.windows, *arguments)
        assert status == 0, out
        here = subprocess.run(
            [sys.executable, "-m", "zspring", *arguments],
            cwd=self.linux,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=True,
        ).stdout
        ours = here.replace("Usage: python -m zspring ", "Usage: zspring ")
        assert TIME.sub("", out.replace("\\", "/")) == TIME.sub("", ours)
        return out

    def compare(self, folder: str, within: float = 0, but_not: tuple[str, ...] = ()) -> list[str]:
        """Names of the tables in a folder, which are the same but for `within` of each column's largest number."""
        names = sorted(path.name for path in (self.linux / folder).iterdir())
        assert names == sorted(path.name for path in (self.windows / folder).iterdir())
        tables = [name for name in names if name.endswith(".csv") and name not in but_not]
        for name in tables:
            unlike = differences(self.linux / folder / name, self.windows / folder / name, PASSING, within)
            assert not unlike, f"{name}: {len(unlike)}, {unlike[:5]}"
        return tables

    def same_bytes(self, name: str) -> None:
        assert (self.windows / name).read_bytes() == (self.linux / name).read_bytes(), name


@pytest.fixture(scope="session")
def windows(wine_variables: dict[str, str]) -> WindowsPython:
    return with_wheel(wine_variables)


@pytest.fixture
def both(windows: WindowsPython, tmp_path: Path) -> Both:
    return Both(windows, tmp_path)


def as_windows_writes(text: str) -> bytes:
    return b"\xef\xbb\xbf" + "\r\n".join(text.splitlines()).encode() + b"\r\n"


def test_frf(both: Both):
    """The points' steps and H are the same bits; last digits are of what is derived from H."""
    both("frf", "--amplitudes", "1,4", "--frequencies", "4:8:1", "--output", "Messung 1 für Übung")
    assert both.compare("Messung 1 für Übung", within=1e-9) == ["frf-refined.csv", "frf.csv", "resonances.csv"]


def test_simulate(both: Both):
    """To the last digit, from a table as a spreadsheet of a German Windows writes it."""
    time = np.arange(0, 2, 0.002)
    wire = 10 * np.sin(2 * np.pi * time / 0.8) ** 3 + 30 * np.exp(-(((time - 1.5) / 0.01) ** 2))
    rows = (f"{t:.3f};{height:.12g}".replace(".", ",") for t, height in zip(time, wire))
    both.write("Fahrdraht Höhe.csv", as_windows_writes("\n".join(["time [s];wire_height [mm]", *rows])))
    both("simulate", "--drive", "Wire", "--input", "Fahrdraht Höhe.csv", "--output", "aus")
    assert both.compare("aus") == ["simulation.csv"]


def test_couple(both: Both):
    """The cosine by which the uplift rises is of the C library."""
    both.write("mein Gerät.ssv", as_windows_writes(find_set("dsa-380-zspring").read_text("utf-8")))
    both("couple", "--parameters", "mein Gerät.ssv", "--output", "Fahrt")
    assert both.compare("Fahrt", within=1e-9) == ["line.csv"]


def test_from_recordings_to_parameters(both: Both):
    """Both examples, their settings as Windows writes them; the recordings are read to the last digit."""
    both("recordings", "--example", "Prüfstand")
    both("recordings", "Prüfstand/bench.toml", "--output", "Antworten")
    assert "frf-up.csv" in both.compare("Prüfstand") + both.compare("Antworten")
    both("identify", "--example", "Beispiel")
    settings = (both.linux / "Beispiel/identify.toml").read_text("utf-8")
    both.write("Beispiel/identify.toml", as_windows_writes(settings))
    out = both("identify", "Beispiel/identify.toml", "--output", "gefunden")
    assert re.search(r"^zspring.k +12007 +20 ", out, re.MULTILINE)
    assert both.compare("gefunden", within=1e-9) == ["fit.csv"]
    both("frf", "--parameters", "gefunden/fitted.ssv", "--amplitudes", "1", "--frequencies", "5", "--output", "damit")
    assert "frf.csv" in both.compare("damit", within=1e-9)


def test_static_and_mechanism(both: Both):
    both("static", "--amplitudes", "0.2,2", "--rates", "0.1", "--output", "statisch")
    both("mechanism", "--output", "Gelenk")
    assert both.compare("statisch") + both.compare("Gelenk") == ["loops.csv", "stiffness.csv", "mechanism.csv"]


def test_report_of_en50318(both: Both):
    """Its runs are made by processes of their own."""
    both("en50318", "--quick", "--output", "Bericht")
    tables = both.compare("Bericht", within=1e-9, but_not=("runs.csv",))  # which tells the time that they took
    assert tables == ["en-50318-2002-250-km-h.csv"]


def test_explorer(both: Both):
    both("explore", "--output", "Erkunder.html")
    both.same_bytes("Erkunder.html")


def test_help_and_variables(both: Both):
    assert "Fit parameters" in both("identify", "--help")
    assert "13050" in both("info", "zspring.k*")
    both("info", "--sets", "dsa-250", "--write", "mein Satz.ssv")
    both.same_bytes("mein Satz.ssv")


def test_export(both: Both):
    both("export", "Übung an Modellen", "--set", "drive=Wire", "--flat")
    for model in (PANTOGRAPH, CATENARY):
        both.same_bytes(f"Übung an Modellen/{model}.fmu")


def test_output_goes_to_a_file(windows: WindowsPython, tmp_path: Path):
    """In the code page of Windows; a name beyond it does not stop the command."""
    status, out = windows.zspring(tmp_path, "linearize", shell="> modes.txt")
    assert (status, out) == (0, "")
    assert " at 0°" in (tmp_path / "modes.txt").read_bytes().decode("cp1252")
    assert windows.zspring(tmp_path, "info", "--sets", "dsa-250", "--write", "Łódź.ssv", shell="> names.txt") == (0, "")
    assert (tmp_path / "Łódź.ssv").is_file() and "\\u0141ód" in (tmp_path / "names.txt").read_bytes().decode("cp1252")


INTERRUPTED = """import _thread, pathlib, sys, threading, time
def interrupt():
    while not list(pathlib.Path("lang").glob("*.partial.csv")):
        time.sleep(0.02)
    _thread.interrupt_main()
threading.Thread(target=interrupt, daemon=True).start()
sys.argv = ["zspring", "frf", "--frequencies", "2:14:0.01", "--output", "lang"]
from zspring.__main__ import main
sys.exit(main())
"""


def test_an_interrupt_keeps_what_there_is(windows: WindowsPython, tmp_path: Path):
    """As Ctrl-C comes to Python; wine gives no console to press it in."""
    (tmp_path / "interrupted.py").write_text(INTERRUPTED)
    status, out = windows.run(windows.home / "python.exe", "interrupted.py", folder=tmp_path)
    assert status == 130 and re.match(r"zspring: interrupted after \d+ of 7206 points, kept in lang", out), out
    assert (tmp_path / "lang/frf.partial.csv").is_file()


def test_a_refusal_is_one_line(windows: WindowsPython, tmp_path: Path):
    status, out = windows.zspring(tmp_path, "simulate", "--input", "nicht da.csv")
    assert status == 1 and out == "zspring: nicht da.csv: No such file or directory\n"
