"""Universal files: every kind of axis gives the same response; what does not tell is refused, with how to tell it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import pyuff

from commands import in_process
from linear import PUBLISHED, LinearPantograph
from zspring.bench.curves import Curve, Source
from zspring.bench.measured import read_curves
from zspring.errors import ZSpringError

TABLE = dict(PUBLISHED["DSA-250"])
LINEAR = LinearPantograph(head=TABLE.pop("k1"), **TABLE)
FREQUENCY = np.array([1.0, 2.5, 5.0, 12.0])
OMEGA = 2 * np.pi * FREQUENCY
H = np.array([LINEAR.receptance(f) for f in FREQUENCY])


def universal_file(path: Path, value: np.ndarray, **fields) -> Path:
    defaults = {
        "func_type": 4,
        "rsp_node": 1,
        "rsp_dir": 3,
        "ref_node": 1,
        "ref_dir": 3,
        "binary": 0,
        "ord_data_type": 6,
        "abscissa_spacing": 0,
        "abscissa_spec_data_type": 18,
        "abscissa_axis_units_lab": "Hz",
        "ordinate_spec_data_type": 8,
        "ordinate_axis_units_lab": "m",
        "orddenom_spec_data_type": 13,
        "orddenom_axis_units_lab": "N",
        "z_axis_spec_data_type": 12,
        "z_axis_axis_units_lab": "m/s2",
        "z_axis_value": 0.5,
    }
    dataset = pyuff.prepare_58(**{"x": FREQUENCY, "data": value, **defaults, **fields})
    dataset["type"] = 58
    pyuff.UFF(str(path)).write_sets([dataset], mode="overwrite")
    return path


UNITS = ("ordinate_spec_data_type", "ordinate_axis_units_lab", "orddenom_spec_data_type", "orddenom_axis_units_lab")


@pytest.mark.parametrize(
    "value, fields",
    [
        (H, {}),
        (-H, {"rsp_dir": -3}),
        (1e3 * H, {"ordinate_axis_units_lab": "mm"}),
        (-(OMEGA**2) * H / 9.80665, {"ordinate_spec_data_type": 12, "ordinate_axis_units_lab": "g"}),
        (1e-3 / (1j * OMEGA * H), dict(zip(UNITS, (13, "kN", 11, "m/s")))),
    ],
)
def test_universal_files_give_the_same_receptance(tmp_path, value, fields):
    path = universal_file(tmp_path / "a.uff", value, **fields)
    (curve,) = read_curves(Source(path))
    np.testing.assert_allclose(curve.H, H, rtol=1e-6)  # the file has seven digits of some numbers
    np.testing.assert_allclose(curve.acceleration, 0.5)


def test_a_universal_file_without_labels_uses_its_data_set_of_units(tmp_path):
    """Data set 164 has factors from SI to the units of the file: mm and kN."""
    path = universal_file(tmp_path / "a.uff", 1e6 * H, ordinate_axis_units_lab="", orddenom_axis_units_lab="")
    text = path.read_text()
    units = pyuff.prepare_164(
        units_code=9,
        units_description="mm, kN",
        temp_mode=2,
        length=1e3,
        force=1e-3,
        temp=1.0,
        temp_offset=0.0,
        return_full_dict=True,
    )
    pyuff.UFF(str(path)).write_sets([units], mode="overwrite")
    path.write_text(path.read_text() + text)
    (curve,) = read_curves(Source(path))
    np.testing.assert_allclose(curve.H, H, rtol=1e-6)


# What one unit of each label is in SI units, and the kind of quantity that has it.
MOTION_LABELS = {
    8: {"m": 1.0, "mm": 1e-3, "um": 1e-6},
    11: {"m/s": 1.0, "mm/s": 1e-3},
    12: {"m/s2": 1.0, "m/s^2": 1.0, "mm/s2": 1e-3, "mm/s^2": 1e-3, "g": 9.80665},
}
FORCE_LABELS = {"N": 1.0, "kN": 1e3}


@pytest.mark.parametrize("motion, label", [(kind, label) for kind in MOTION_LABELS for label in MOTION_LABELS[kind]])
@pytest.mark.parametrize("force", [9, 13])
@pytest.mark.parametrize("force_label", FORCE_LABELS)
def test_every_label_of_a_universal_file_counts_above_and_below_the_line(tmp_path, motion, label, force, force_label):
    """Motion over force and force over motion, with the number that the file has in units of its labels."""
    moved = H * (2j * np.pi * FREQUENCY) ** {8: 0, 11: 1, 12: 2}[motion] / MOTION_LABELS[motion][label]
    value = moved * FORCE_LABELS[force_label]
    for number, axes in (
        (value, (motion, label, force, force_label)),
        (1 / value, (force, force_label, motion, label)),
    ):
        path = universal_file(tmp_path / "a.uff", number, **dict(zip(UNITS, axes)))
        (curve,) = read_curves(Source(path))
        np.testing.assert_allclose(curve.H, H, rtol=1e-6)


@pytest.mark.parametrize("response, reference, sign", [(3, 3, 1), (-3, 3, -1), (3, -3, -1), (-3, -3, 1)])
def test_the_directions_of_a_universal_file_count(tmp_path, response, reference, sign):
    path = universal_file(tmp_path / "a.uff", sign * H, rsp_dir=response, ref_dir=reference)
    (curve,) = read_curves(Source(path))
    np.testing.assert_allclose(curve.H, H, rtol=1e-6)


def test_amplitudes_of_a_universal_file_go_before_those_of_the_settings(tmp_path):
    path = universal_file(tmp_path / "a.uff", H, z_axis_value=0.25)
    (curve,) = read_curves(Source(path, amplitude=2.0))
    np.testing.assert_allclose(curve.acceleration, 0.25)
    assert curve.label == "0.25 m/s2"
    path = universal_file(tmp_path / "a.uff", H, z_axis_value=0.0, z_axis_spec_data_type=0)
    (curve,) = read_curves(Source(path, amplitude=2.0))
    np.testing.assert_allclose(curve.acceleration, 2.0)


def test_other_data_sets_and_the_static_line_of_a_universal_file_are_passed_over(tmp_path):
    """A coherence, a transfer between two points, and two responses, the first of which begins at 0 Hz."""
    path = universal_file(tmp_path / "a.uff", np.ones(4), func_type=6)
    with_static = universal_file(tmp_path / "b.uff", np.concatenate([[5.0], H]), x=np.concatenate([[0.0], FREQUENCY]))
    others = [
        universal_file(tmp_path / "c.uff", H, rsp_node=2),
        universal_file(tmp_path / "d.uff", H, z_axis_value=4.0),
    ]
    path.write_text("".join(each.read_text() for each in (path, with_static, *others)))
    small, large = read_curves(Source(path))
    for curve, acceleration in ((small, 0.5), (large, 4.0)):
        np.testing.assert_allclose(curve.frequency, FREQUENCY)
        np.testing.assert_allclose(curve.H, H, rtol=1e-6)
        np.testing.assert_allclose(curve.acceleration, acceleration)


@pytest.mark.parametrize(
    "fields, complaint",
    [
        ({"z_axis_value": -0.5}, "data set 1: no amplitude: the Z-axis value is -0.5"),
        ({"z_axis_value": 0.0}, "data set 1: no amplitude: neither"),
        ({"z_axis_spec_data_type": 8}, r"data set 1: Z axis of type 8, 0.5 \[m/s2\]: must be a peak in m/s2"),
        ({"z_axis_spec_data_type": 13, "z_axis_axis_units_lab": "N"}, r"data set 1: Z axis of type 13, 0.5 \[N\]"),
        ({"z_axis_axis_units_lab": "NONE"}, "data set 1: Z axis of type 12, 0.5 without a unit"),
        ({"x": np.array([1.0, 2.0, 2.0, 3.0])}, "data set 1: the frequencies must all rise or all fall"),
        ({"orddenom_spec_data_type": 12}, "data set 1: types 8 over 12: must be motion over force"),
        ({"orddenom_axis_units_lab": "lbf"}, "data set 1: unit 'lbf': must be one of N, kN"),
        ({"ordinate_axis_units_lab": "NONE"}, "data set 1: unit '': must be one of m, mm"),
        ({"ordinate_spec_data_type": 5}, "data set 1: types 5 over 13: must be motion over force"),
        ({"ref_dir": 1}, r"of a driving point: choose by data_sets = \[1\].* from 1 \(.*1\+Z/.*1\+X\)"),
        ({"rsp_node": 2}, r"of a driving point: choose by data_sets = \[1\].* from 1 \(.*2\+Z/.*1\+Z\)"),
        ({"rsp_ent_name": "HEAD", "ref_ent_name": "FRAME"}, r"of a driving point: choose .*HEAD 1\+Z/FRAME 1\+Z"),
        ({"func_type": 6}, "no data set 58 with the frequency response of a driving point, function type 4$"),
        ({"rsp_node": 0, "ref_node": 0}, r"node 0 does not tell the driving point: choose by data_sets = \[1\]"),
        ({"abscissa_spec_data_type": 17, "abscissa_axis_units_lab": "s"}, r"data set 1: abscissa of type 17.*\[s\]"),
        ({"abscissa_spec_data_type": 20, "abscissa_axis_units_lab": "NONE"}, "data set 1: abscissa of type 20"),
        ({"abscissa_axis_units_lab": "s"}, r"data set 1: abscissa of type 18.*\[s\]: must be a frequency"),
        ({"ord_data_type": 4, "data": np.abs(H)}, "data set 1: ordinate of data type 4, real: the phase is missing"),
    ],
)
def test_unclear_universal_files_are_refused(tmp_path, fields, complaint):
    path = universal_file(tmp_path / "a.uff", H, **fields)
    with pytest.raises(ZSpringError, match=f"a.uff.*{complaint}") as error:
        read_curves(Source(path))
    assert "\n" not in str(error.value)


def read(path: Path, **source) -> Curve:
    (curve,) = read_curves(Source(path, **source))
    return curve


def test_a_sweep_down_stays_one(tmp_path):
    curve = read(universal_file(tmp_path / "a.uff", H[::-1], x=FREQUENCY[::-1]))
    np.testing.assert_array_equal(curve.frequency, FREQUENCY[::-1])
    np.testing.assert_allclose(curve.H, H[::-1], rtol=1e-6)


@pytest.mark.parametrize(
    "kind, label, factor",
    [
        *[(18, "Hz", 1.0), (18, "1/s", 1.0), (18, "s^-1", 1.0), (18, "NONE", 1.0), (1, "Hz", 1.0), (0, "NONE", 1.0)],
        *[(18, "rad/s", 2 * math.pi), (0, "rad/sec", 2 * math.pi), (18, "rpm", 60.0), (19, "NONE", 60.0)],
        *[(18, "1/min", 60.0), (18, "kHz", 1e-3)],
    ],
)
def test_the_unit_of_the_abscissa_counts(tmp_path, kind, label, factor):
    """Numbers that are `factor` times those in Hz give the same frequencies, to the six digits of the file."""
    abscissa = {"abscissa_spec_data_type": kind, "abscissa_axis_units_lab": label}
    curve = read(universal_file(tmp_path / "a.uff", H, x=factor * FREQUENCY, **abscissa))
    np.testing.assert_allclose(curve.frequency, FREQUENCY, rtol=5e-6)
    np.testing.assert_allclose(curve.H, H, rtol=1e-6)


@pytest.mark.parametrize(
    "kind, unit, si",
    [
        *[(12, "m/s2", 1.0), (12, "mm/s2", 1e-3), (12, "g", 9.80665), (0, "m/s^2", 1.0), (1, "m/s\u00b2", 1.0)],
        *[(11, "mm/s", 1e-3), (11, "m/s", 1.0), (8, "mm", 1e-3), (8, "um", 1e-6), (0, "mm", 1e-3)],
    ],
)
def test_the_unit_of_the_z_axis_counts(tmp_path, kind, unit, si):
    """A peak of 0.25 units of acceleration, velocity or displacement: the acceleration at each frequency."""
    fields = {"z_axis_value": 0.25, "z_axis_spec_data_type": kind, "z_axis_axis_units_lab": unit}
    curve = read(universal_file(tmp_path / "a.uff", H, **fields))
    power = 1 if unit in ("mm/s", "m/s") else 2 if unit in ("mm", "um") else 0
    np.testing.assert_allclose(curve.acceleration, 0.25 * si * OMEGA**power, rtol=1e-12)
    assert curve.label == f"0.25 {unit}"


def test_an_amplitude_of_the_settings_goes_instead_of_a_z_axis_that_is_none(tmp_path):
    rpm = {"z_axis_value": 1500.0, "z_axis_spec_data_type": 19, "z_axis_axis_units_lab": "rpm"}
    np.testing.assert_allclose(read(universal_file(tmp_path / "a.uff", H, **rpm), amplitude=2.0).acceleration, 2.0)


def as_text(path: Path, encoding: str = "utf-8", exponent: str = "e", unit: str = "m/s2", **record) -> Path:
    """A file by the format's own columns: accelerance, uneven abscissa, complex double precision."""
    value = -(OMEGA**2) * H
    dof = "{}{:>11}{:>10}{:4d} {:>10}{:10d}{:4d}".format(
        f"{4:5d}{0:10d}{0:5d}{0:10d}", "NONE", record.get("node", 1), 3, "NONE", record.get("node", 1), 3
    )
    axes = [(18, "Frequency", "Hz"), (12, "Acceleration", unit), (13, "Force", "N"), (12, "Acceleration", unit)]
    lines = [
        *("    -1", "    58", *[record.get(f"id{i}", "NONE") for i in range(1, 6)], dof),
        f"{6:10d}{H.size:10d}{0:10d}{0:13.5e}{0:13.5e}{record.get('peak', 0.5):13.5e}",
        *(f"{kind:10d}{0:5d}{0:5d}{0:5d} {name:<20} {label:<20}" for kind, name, label in axes),
        *(f"{f:13.5e}{v.real:20.12e}{v.imag:20.12e}" for f, v in zip(FREQUENCY, value)),
        "    -1",
    ]
    numbers = [
        line.replace("e", exponent) if n == 8 or 12 < n < len(lines) - 1 else line for n, line in enumerate(lines)
    ]
    path.write_bytes("".join(f"{line:<80}\n" for line in numbers).encode(encoding))
    return path


@pytest.mark.parametrize("exponent", ["e", "E", "D", "d"])
@pytest.mark.parametrize("encoding", ["utf-8", "cp1252"])
@pytest.mark.parametrize("unit", ["m/s2", "m/s\u00b2", "m/s**2"])
def test_the_text_of_a_universal_file_may_be_as_people_have_it(tmp_path, exponent, encoding, unit):
    curve = read(as_text(tmp_path / "a.uff", encoding, exponent, unit))
    np.testing.assert_allclose(curve.H, H, rtol=1e-11)
    np.testing.assert_array_equal(curve.frequency, FREQUENCY)
    np.testing.assert_allclose(curve.acceleration, 0.5)


def test_a_binary_universal_file_is_read_with_its_superscripts(tmp_path):
    """Data set 58b: the same head, a line that tells of the bytes, and the numbers as little-endian doubles."""
    *head, _ = as_text(tmp_path / "a.uff", "cp1252", unit="m/s\u00b2").read_bytes().splitlines(keepends=True)[:14]
    value = -(OMEGA**2) * H
    numbers = np.column_stack([FREQUENCY, value.real, value.imag]).astype("<f8").tobytes()
    head[1] = f"    58b{1:6d}{2:6d}{11:12d}{len(numbers):12d}{0:6d}{0:6d}{0:12d}{0:12d}\n".encode()
    (tmp_path / "b.uff").write_bytes(b"".join(head) + numbers + b"    -1\n")
    curve = read(tmp_path / "b.uff")
    np.testing.assert_array_equal(curve.frequency, FREQUENCY)
    np.testing.assert_allclose(curve.H, H, rtol=1e-12)


def files(tmp_path: Path, *records: dict) -> Path:
    """One file of several data sets."""
    parts = [as_text(tmp_path / f"{n}.part", **record).read_bytes() for n, record in enumerate(records)]
    (tmp_path / "all.uff").write_bytes(b"".join(parts))
    return tmp_path / "all.uff"


def test_where_several_points_could_be_meant_the_choice_is_asked_for(tmp_path):
    points = [{"node": 0, "id5": f"H1: #{n}/#1", "peak": n} for n in (2, 3, 4)]
    path = files(tmp_path, *points)
    with pytest.raises(ZSpringError, match=r"node 0 .* data_sets = \[1\].*1 \(H1: #2/#1, 0\+Z/0\+Z\), 2 \(H1: #3"):
        read_curves(Source(path))
    curves = read_curves(Source(path, data_sets=(2, 3)))
    assert [curve.acceleration[0] for curve in curves] == [3.0, 4.0]
    with pytest.raises(ZSpringError, match=r"data set 4 is no frequency response \(those are: 1, 2, 3\)"):
        read_curves(Source(path, data_sets=(4,)))


@pytest.mark.parametrize(
    "command",
    [["frf", "--no-extremes", "--frequencies", "5", "--measured"], ["en50318", "--frf-bands", "1,15", "--frf"]],
)
def test_commands_choose_data_sets(tmp_path, command):
    path = files(tmp_path, {"node": 0})
    option = "--frf-data-sets" if command[0] == "en50318" else "--measured-data-sets"
    command = [*command, path, "--output", tmp_path / "out", "--set", "friction=Coulomb", "--jobs", "1"]
    status, _, err = in_process(*command)
    assert status == 1 and "choose by data_sets = [1] or its option (--frf-data-sets, --measured-data-sets)" in err
    assert in_process(*command, option, "1")[0] == 0


def test_two_driving_points_and_two_data_sets_of_one_level_are_doubtful(tmp_path):
    with pytest.raises(ZSpringError, match=r"driving points at 2 nodes or directions: choose .*1\+Z.*7\+Z"):
        read_curves(Source(files(tmp_path, {}, {"node": 7, "peak": 1.0})))
    same = files(tmp_path, {"id1": "H1"}, {"id1": "H2"})
    with pytest.raises(
        ZSpringError, match=r"data sets 1 and 2 have one place and one amplitude, 0.5 m/s2: choose .*H1.*H2"
    ):
        read_curves(Source(same))
    assert len(read_curves(Source(same, data_sets=(1, 2)))) == 2
    small, large = read_curves(Source(files(tmp_path, {}, {"peak": 1.0})))
    assert (small.label, large.label) == ("0.5 m/s2", "1 m/s2")


@pytest.mark.parametrize(
    "spoil, complaint",
    [
        (lambda t: t[: t.rindex("    -1")], "not complete: the last data set does not end with -1"),
        (lambda t: t.replace("e-0", "q-0"), "data set 1: cannot be read: could not convert string to float"),
        (lambda t: t.replace(f"{4:10d}", f"{5:10d}", 1), "data set 1: 4 values where 5 are announced"),
        (lambda t: "frequency,real\n1,2\n", "no universal file"),
        (lambda t: "", "no universal file"),
    ],
)
def test_a_damaged_universal_file_is_refused_with_its_reason(tmp_path, spoil, complaint):
    path = as_text(tmp_path / "a.uff")
    path.write_text(spoil(path.read_text()))
    with pytest.raises(ZSpringError, match=f"a.uff.*{complaint}") as error:
        read_curves(Source(path))
    assert "\n" not in str(error.value)


def test_data_sets_are_chosen_of_universal_files_alone(tmp_path):
    (tmp_path / "a.csv").write_text("frequency [Hz],real [m/N],imaginary [m/N]\n1,1e-3,-1e-4\n")
    with pytest.raises(ZSpringError, match=r"a\.csv: data_sets are for universal files"):
        read_curves(Source(tmp_path / "a.csv", amplitude=1.0, data_sets=(1,)))
