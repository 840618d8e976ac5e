"""Wrong and odd inputs of every command: they end in one line, or are taken, and never in a traceback.

Good inputs are spoiled in each way that people and disks do; where one may still be right, both are allowed.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from commands import in_process
from zspring.cli import commands
from zspring.en50318.edition import packaged_edition
from zspring.figures import new_figure, save
from zspring.parameter_sets import find_set

BINARY = bytes(range(256)) * 4
FRF = """frequency [Hz],amplitude [m/s2],real [(m/s2)/N],imaginary [(m/s2)/N]
2,1,0.0340758,0.024269221
2.5,1,0.024297642,0.027460523
3,1,0.0080000681,0.03494809
"""
FUNCTION = """    -1
    58
NONE
NONE
NONE
NONE
NONE
    4         0    0         0       HEAD         1   3       HEAD         1   3
         6         2         0  0.00000e+00  0.00000e+00  1.00000e+00
        18    0    0    0 Frequency            Hz
        12    0    0    0 Acceleration         m/s2
        13    0    0    0 Force                N
        12    0    0    0 Acceleration         m/s2
  2.00000e+00  3.407580033430e-02  2.426922100110e-02
  2.50000e+00  2.429764175960e-02  2.746052307410e-02
    -1
"""
STATIC = "displacement [mm],force [N]\n0,0\n1,5\n2,12\n1,4\n"
WIRE = "time [s],wire_height [mm]\n0,0\n0.005,1\n0.01,0\n"
SERIES = "time [s],contact force [N]\n" + "".join(f"{n / 200:g},{120 + n % 7}\n" for n in range(60))
FIT = """model = "linear"
[[measurement]]
file = "good.csv"
[free]
k1 = { start = 9000, min = 5000, max = 20000 }
[search]
samples = 0
"""
STUDY = """design = "list"
[vary]
m1 = [7, 7.5]
[static]
amplitudes = [1000]
"""  # a case that fails at once, should the study begin

AS_MEASURED = ["--set", "friction=Coulomb", "--set", "static_force=120"]
SERIES_ALONE = ["--series", "good.ser", "--speed", "250"]
EDITION = packaged_edition("benchmark-2015").read_text("utf-8")
# Good but for what is spoiled, and done in a moment.
GOOD = {
    "frf": ["frf", "--amplitudes", "1", "--frequencies", "5", "--jobs", "1"],
    "simulate": ["simulate", "--stop", "0.01"],
    "static": ["static", "--amplitudes", "1", "--rates", "1"],
    "mechanism": ["mechanism", "--accelerations", "1"],
    "linearize": ["linearize", "--frequencies", "1"],
    "couple": ["couple", "--start", "60", "--stop", "61"],
    "en50318": ["en50318", "--frf", "good.csv", "--frf-bands", "1,14", *AS_MEASURED, "--jobs", "1"],
}
# File to spoil, with what reads it.
READERS = {
    "table of inputs": (WIRE, "odd.csv", ["simulate", "--drive", "Wire", "--input", "odd.csv"]),
    "measured response": (FRF, "odd.csv", ["en50318", "--frf", "odd.csv", *GOOD["en50318"][3:]]),
    "universal file": (FUNCTION, "odd.uff", ["en50318", "--frf", "odd.uff", *GOOD["en50318"][3:]]),
    "series": (SERIES, "odd.csv", ["en50318", "--series", "odd.csv", *SERIES_ALONE[2:]]),
    "line test": (SERIES, "odd.csv", ["en50318", "--line-test", "odd.csv", *SERIES_ALONE]),
    "set": (find_set("dsa-380").read_text("utf-8"), "odd.ssv", [*GOOD["simulate"], "--parameters", "odd.ssv"]),
    "fit": (FIT, "odd.toml", ["identify", "odd.toml", "--jobs", "1"]),
    "edition": (EDITION, "odd.toml", ["en50318", "--edition", "odd.toml", *SERIES_ALONE]),
}


def spoiled(text: str) -> Iterator[tuple[str, bytes]]:
    """The text as it may come: cut, doubled, in another encoding, with another number."""
    good, lines = text.encode(), text.splitlines(keepends=True)
    yield from {
        "empty": b"",
        "blank": b"\n\n",
        "binary": BINARY,
        "zero bytes": good.replace(b"1", b"\0", 1),
        "half": good[: len(good) // 2],
        "cut": good[:-4],
        "UTF-16": text.encode("utf-16"),
        "half a character": text.encode("utf-16")[:-1],
        "Latin-1": text.replace("e", "é", 2).encode("latin-1"),
        "first line": lines[0].encode(),
        "twice": good + good,
        "upside down": "".join(lines[::-1]).encode(),
        "a web page": b"<html><body>404 Not Found</body></html>",
        "open quote": good.replace(b",", b',"', 1),
    }.items()
    numbers = list(re.finditer(r"(?<![\w.])\d+\.?\d*(e-?\d+)?(?![\w.])", text))
    for n, number in enumerate(("nan", "inf", "1e400", "-1", "0", "", "1e308", "x", "9" * 400, "\u0661")):
        at = numbers[-1 - n % min(3, len(numbers))]  # in the last rows
        yield f"number {number[:6]}", (text[: at.start()] + number + text[at.end() :]).encode()


def odd_values(option: click.Option) -> list[str]:
    kind = option.type
    if isinstance(kind, click.Choice):
        return ["x", ""]
    if isinstance(kind, click.Path):
        return ["", "folder", "binary", "missing", "Łódź", "\udcff", "binary/below"]
    if kind.name in ("numbers", "whole numbers", "spans"):
        return ["", "nan", "-1", "1:2:0", "1:1e9:1e-9", ",", "inf:1:1", "9:1", "1e-300", "1e300"]
    if isinstance(kind, (click.types.FloatParamType, click.types.IntParamType)):
        return ["nan", "-inf", "-1", "0", "1e400", "ten", "", "1,5"]
    return ["", "x", "Łódź", "binary", "folder", "#"]


SETTINGS = """m1 m1= =1 m1=nan m1=inf m1=1e308 m1=-1 m1=7=8 M1=7 m1=1e-300 zspring.k=1e300 zspring.d=0 friction=9
friction= suspension=9 solver.step=0 solver.step=-1 solver.max_iterations=1e3 solver.max_iterations=99999999999999999999
gravity=1e300 static_force=0 k3=1e300 head.z=1 Łódź=1""".split()


def cases() -> Iterator[tuple[str, list[str], bytes]]:
    """Name, arguments and what is in the file that they name."""
    for command, good in GOOD.items():
        for option in commands.commands[command].params:
            if isinstance(option, click.Option) and not option.is_flag and option.opts[0] not in ("--set", "--jobs"):
                for value in odd_values(option)[:: 1 if command == "linearize" else 3]:
                    yield f"{command} {option.opts[0]} {value!r}", [*good, option.opts[0], value], b""
        for setting in SETTINGS if command == "linearize" else SETTINGS[::5]:
            yield f"{command} --set {setting}", [*good, "--set", setting], b""
    for name, (text, _, arguments) in READERS.items():
        for how, content in spoiled(text):
            yield f"{name}, {how}", arguments, content
    for arguments in (
        *([], ["fly"], ["--set"], ["frf", "extra"], ["info", "["], ["info", "--sets", "x"], ["export"], ["identify"]),
        *([name, path] for name in ("identify", "study") for path in ("folder", "binary", "missing", "Łódź", "\udcff")),
    ):
        yield " ".join(["zspring", *arguments]), arguments, b""


CASES = list(cases())


def test_there_are_many_odd_inputs_of_every_command():
    assert len(CASES) > 300 and {name.split()[0] for name, *_ in CASES} >= GOOD.keys()


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """With good and odd things to name."""
    folder = tmp_path_factory.mktemp("odd inputs")
    (folder / "folder").mkdir()
    (folder / "binary").write_bytes(BINARY)
    (folder / "good.csv").write_text(FRF)
    (folder / "good.ser").write_text(SERIES)
    return folder


@pytest.mark.parametrize(("arguments", "content"), [case[1:] for case in CASES], ids=[ascii(case[0]) for case in CASES])
def test_an_odd_input_ends_in_one_line_or_is_taken(folder, monkeypatch, arguments, content):
    monkeypatch.chdir(folder)
    for word in arguments:
        if word.startswith("odd."):
            (folder / word).write_bytes(content)
    if arguments[:1] and "--output" in [p.opts[0] for p in getattr(commands.commands.get(arguments[0]), "params", [])]:
        arguments = [arguments[0], "--output", "out", *arguments[1:]]
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        status, _, err = in_process(*arguments)
    lines = [line for line in err.splitlines() if line.startswith("zspring: ")]
    assert status in (0, 1) and len(lines) == status, err


def test_names_in_pictures_are_no_formulas_and_may_have_any_letter(tmp_path):
    """Titles name files. Numbers on a logarithmic axis are formulas, and stay some."""
    figure = new_figure(4, 3)
    axes = figure.add_subplot()
    axes.semilogy([1, 2], [1e-3, 1e3])
    axes.set_title("a$_{$b 测试")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for _ in range(2):
            save(figure, tmp_path / "figure.png")
    assert not axes.title.get_parse_math()
    assert all(label.get_parse_math() for label in axes.get_yticklabels())


@pytest.mark.parametrize("reader", READERS.values(), ids=READERS)
def test_a_file_as_windows_writes_it_is_read_alike(folder, monkeypatch, reader):
    """With both signs at the ends of lines and a byte order mark, which universal files alone may not have. Some of
    these are too short for what they go to, which then is said alike.
    """
    text, name, arguments = reader
    monkeypatch.chdir(folder)
    lines, mark = text.splitlines(), "" if name.endswith(".uff") else "\ufeff"
    results = []
    for content in ("\n".join(lines) + "\n", mark + "\r\n".join(lines) + "\r\n"):
        (folder / name).write_bytes(content.encode())
        results.append(in_process(*arguments)[0::2])
    assert results[0] == results[1]
