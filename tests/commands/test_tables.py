"""Tables as people have them: separators, decimal commas, encodings, brackets, units; what is not clear is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from zspring.bench.curves import Source
from zspring.bench.measured import read_curves
from zspring.bench.static_test import read_static_test
from zspring.errors import ZSpringError
from zspring.fmu import Fmu
from zspring.line.series import read_series
from zspring.simulate.inputs import read_inputs
from zspring.tables import read_table, write_table
from zspring.units import conversion, is_unit

PLAIN = "frequency [Hz],amplitude [m/s2],real [m/N],imaginary [m/N]\n2,1,0.5e-3,-1.25e-4\n2.5,1,0.25e-3,-0.5e-4\n"
SPELLINGS = {
    "semicolons and decimal commas": PLAIN.replace(",", ";").replace(".", ","),
    "tabs": PLAIN.replace(",", "\t"),
    "tabs and decimal commas": PLAIN.replace(",", "\t").replace(".", ","),
    "quotes": PLAIN.replace("frequency [Hz]", '"frequency [Hz]"').replace("2.5", '"2.5"'),
    "capitals": PLAIN.replace("frequency", "Frequency").replace("real", "REAL"),
    "round brackets": PLAIN.replace("[", "(").replace("]", ")"),
    "superscripts": PLAIN.replace("m/s2", "m/s²"),
    "exponents": PLAIN.replace("m/s2", "m/s^2"),
    "millimetres": "frequency [Hz],amplitude [mm/s2],real [mm/N],imaginary [mm/N]\n2,1e3,.5,-.125\n2.5,1e3,.25,-.05\n",
    "comments and empty lines": "# a: b\n\n" + PLAIN.replace("\n2.5", "\n\n# later\n2.5"),
    "Windows' ends of lines": PLAIN.replace("\n", "\r\n"),
    "units below the names": "frequency,amplitude,real,imaginary\nHz,[m/s2],(m/N),m/N\n" + PLAIN.split("\n", 1)[1],
    "a separator at the end": PLAIN.replace("\n", ",\n"),
}


@pytest.mark.parametrize("text", SPELLINGS.values(), ids=SPELLINGS)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_a_measurement_is_the_same_however_it_is_written(tmp_path, text, encoding):
    path = tmp_path / "bench.csv"
    path.write_bytes(text.encode(encoding))
    (curve,) = read_curves(Source(path))
    assert curve.frequency.tolist() == [2.0, 2.5] and curve.acceleration.tolist() == [1.0, 1.0]
    np.testing.assert_allclose(curve.H, [0.5e-3 - 1.25e-4j, 0.25e-3 - 0.5e-4j], rtol=1e-14)


def static_test(path):
    test = read_static_test(path, 1.0)
    return test.displacement, test.force


def series(path):
    read = read_series(path)
    return read.time, read.force


def inputs(path):
    with Fmu() as fmu:
        read = read_inputs(path, fmu.variables)
    return float(read.start) + read.time, read.values["wire_height"]


READERS = {
    "inputs": (inputs, "time [s]", "wire_height [m]"),
    "series": (series, "time [s]", "contact force [N]"),
    "static test": (static_test, "displacement [m]", "force [N]"),
}


@pytest.mark.parametrize("reader", READERS)
def test_every_reader_takes_decimal_commas_and_refuses_doubled_columns(tmp_path, reader):
    read, first, second = READERS[reader]
    x, y = np.arange(1, 1102) / 256, np.arange(1101) / 8  # so that a text has all their digits
    path = tmp_path / "table.csv"
    path.write_text("\n".join([f"{first};{second}", *(f"{a};{b}".replace(".", ",") for a, b in zip(x, y))]))
    found = read(path)
    np.testing.assert_array_equal(found[0], x)
    np.testing.assert_array_equal(found[1], y)
    path.write_text("\n".join([f"{first},{second},{second}", *(f"{a},{b},{b}" for a, b in zip(x, y))]))
    with pytest.raises(ZSpringError, match=r"table\.csv: two columns"):
        read(path)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("a;b\n1,5;2\n1.5;2\n", "with decimal commas and with decimal points"),
        ("a;b\n1;2\n1;2;3\n", r"line 3: 3 values for 2 columns"),
        ("# only: this\n", "needs a line of column names"),
        ("a,A\n1,2\n", "two columns 'A'"),
        ("wire_height,wire height\n1,2\n", "two columns 'wire height'"),
        ("time,force,a\ns,tf,g\n0,1,2\n", "line 2: unit 'tf' is none that is known, as 's' beside it is"),
        ("\0\1", "no text in UTF-8"),
    ],
)
def test_what_is_not_clear_in_a_table_is_refused(tmp_path, text, complaint):
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises(ZSpringError, match=rf"bad\.csv.*{complaint}") as error:
        read_table(path)
    assert len(str(error.value).splitlines()) == 1


def test_a_missing_column_tells_which_there_are(tmp_path):
    (tmp_path / "bad.csv").write_text("Time (s),Force (N)\n0,1\n")
    with pytest.raises(ZSpringError, match=r"no column 'position' \(there are: Time \(s\), Force \(N\)\)"):
        read_table(tmp_path / "bad.csv").numbers("position", "m")


# Factors to SI by definition: SI brochure, and 9.80665 m/s2 of the 3rd CGPM, 1901.
@pytest.mark.parametrize(
    ("unit", "target", "factor"),
    [
        *[("mm", "m", 1e-3), ("cm", "m", 1e-2), ("um", "m", 1e-6), ("µm", "m", 1e-6), ("km", "m", 1e3)],
        *[("ms", "s", 1e-3), ("min", "s", 60.0), ("h", "s", 3600.0), ("km/h", "m/s", 1 / 3.6)],
        *[
            ("kN", "N", 1e3),
            ("mN", "N", 1e-3),
            ("daN", "N", 10.0),
            ("kgf", "N", 9.80665),
            ("kN/mm", "N/m", 1e6),
            ("N/mm", "N/m", 1e3),
        ],
        *[("g", "m/s2", 9.80665), ("mm/s^2", "m/s2", 1e-3), ("m s^-2", "m/s2", 1.0), ("m·s⁻²", "m/s2", 1.0)],
        *[("g/N", "1/kg", 9.80665), ("(m/s2)/N", "1/kg", 1.0), ("(mm/s)/N", "m/(N.s)", 1e-3), ("N s/m", "N.s/m", 1.0)],
        *[("deg", "rad", math.pi / 180), ("°", "rad", math.pi / 180), ("mrad", "rad", 1e-3)],
        *[("kHz", "Hz", 1e3), ("rpm", "Hz", 1 / 60), ("rad/s", "Hz", 1 / (2 * math.pi)), ("1/s", "Hz", 1.0)],
        *[("s^-1", "Hz", 1.0), ("1/min", "Hz", 1 / 60), ("Hz", "1/s", 1.0), ("kHz", "1/s", 1e3), ("rad/s", "1/s", 1.0)],
        *[("rpm", "rad/s", math.pi / 30), ("m/s**2", "m/s2", 1.0), ("RPM", "Hz", 1 / 60), ("rad/sec", "rad/s", 1.0)],
        *[("MM/S2", "m/s2", 1e-3), ("G", "m/s2", 9.80665), ("KHZ", "Hz", 1e3), ("RAD/SEC", "Hz", 0.5 / math.pi)],
        *[("N·m", "N.m", 1.0), ("N m", "N.m", 1.0), ("kg", "kg", 1.0), ("1", "1", 1.0)],
    ],
)
def test_units_are_multiples_by_definition(unit, target, factor):
    assert conversion(unit, target) == (target, pytest.approx(factor, rel=1e-14))


@pytest.mark.parametrize("unit", ["lbf", "m//s", "m)", "(m", "N.", "m/N.s", "m/s*N", "2m", "mV", "kg", "s", "MN"])
def test_units_that_are_unknown_doubtful_or_of_another_kind_are_refused(unit):
    with pytest.raises(ZSpringError, match=r"must be one of N, kN, mN"):
        conversion(unit, "N")


def test_the_unit_tells_the_kind():
    kinds = ("m/N", "N/m", "m/(N.s)", "N.s/m", "1/kg", "kg")
    assert [conversion(unit, *kinds)[0] for unit in ("um/N", "kN/mm", "(mm/s)/N", "N/(m/s)", "g/N", "N/g")] == [*kinds]
    assert not is_unit("filtered") and is_unit("N") and is_unit("-")


def test_a_written_table_is_read_back_to_the_last_bit(tmp_path):
    values = [math.pi, 1e-300, -0.1, 3.0, math.nan]
    head = {"speed": "70 m/s", "note": "a: b"}
    path = write_table(tmp_path / "folder/out.csv", head, ["x [m]", "n"], ([v, i] for i, v in enumerate(values)), None)
    table = read_table(path)
    assert head == table.head
    assert [float(cell) for cell in table["x"].cells[:-1]] == values[:-1] and table["x"].cells[-1] == ""
    assert table["n"].cells == ("0", "1", "2", "3", "4")
    write_table(path, {}, ["x"], [[math.pi]], digits=3)
    assert path.read_text() == "x\n3.14\n"
    assert [file.name for file in path.parent.iterdir()] == ["out.csv"]
