"""`zspring recordings` and bad input: one clear line, and what can be used is used and marked."""

from __future__ import annotations

import re

import numpy as np
import pytest

from commands import in_process, table
from shaker import BASE, FOUR, assert_linear, found, shaken, write_text, written

RECORD = shaken(FOUR)
COLUMNS = {"time__s": RECORD.time, "force__N": RECORD.force, "position__m": RECORD.displacement}
TIME = RECORD.time


ENDS = np.cumsum([round(12 / f * RECORD.rate) for f in FOUR]) / RECORD.rate  # s, of the holds


def changed(**columns: np.ndarray) -> dict[str, np.ndarray]:
    return {**COLUMNS, **columns}


def stretched(values: np.ndarray, first: float, last: float, by) -> np.ndarray:
    """Values with those between two times changed by a function."""
    return np.where((TIME > first) & (TIME < last), by(values), values)


@pytest.mark.parametrize(
    "old, new, message",
    [
        ('sense = "contact"', "", r'force.sense is missing: "contact" where positive values press the head down'),
        ('positive = "up"', "", r'displacement.positive is missing: "up" or "down"'),
        ('channel = "force"', 'channel = "Forse"', r"no channel 'Forse' \(there are: time, force, position\); did you"),
        ("[displacement]", "[acceleration]", r"a.csv, \[acceleration\]: unit \[m\]: must be one of m/s2"),
        (
            'channel = "force"',
            'channel = "force"\nunit = "kN"',
            r"\[force\]: unit = 'kN': the file says N: one of them",
        ),
        ('channel = "force"', 'channel = "force"\nsensitivity = "4 mV"', r"\[force\]: unit \[N\]: must be one of V"),
        ('channel = "time"', "rate = 400\nchannel = 'time'", r"\[time\]: channel and rate: must be one of both"),
        ('file = "a.csv"', 'file = "b.csv"', r"b.csv: No such file"),
        ("[time]", "[sweep]\nfrequencies = [7.0, 8.0]\n[time]", r"a.csv: no hold at any of the frequencies"),
        ("[time]", "[sweep]\nband = [15, 40]\n[time]", r"a.csv: no steady part: no 15 to 40 Hz held in displacement"),
        ("static_force = 90", "static_force = 90\nmotion = 'acceleration'", r"there is no table \[acceleration\]"),
    ],
)
def test_settings_that_are_not_clear_are_asked_for(tmp_path, old, new, message):
    assert old in BASE
    settings = written(tmp_path, BASE.replace(old, new, 1), **COLUMNS)
    status, _, err = in_process("recordings", settings, "--output", tmp_path / "out")
    assert status == 1 and len(err.splitlines()) == 1
    assert re.search(message, err), err


@pytest.mark.parametrize(
    "columns, message",
    [
        (changed(force__N=np.full(TIME.size, 3.0)), r"'force' is 3 all the time: is the sensor connected\?"),
        (changed(force__N=np.full(TIME.size, np.nan)), r"\[force\]: 'force' has no value"),
        (changed(time__s=np.round(TIME, 2)), r"must increase; if its digits are too few, give the sampling rate"),
        (changed(time__s=TIME**1.01), r"uneven times about .* the sampling rate must be one"),
        (
            {"time__s": TIME, "force": RECORD.force, "position__m": RECORD.displacement},
            r"does not tell the unit of 'fo",
        ),
        (changed(position__m=np.cumsum(np.random.default_rng(0).standard_normal(TIME.size))), r"no steady part"),
    ],
)
def test_records_that_cannot_be_used_are_refused(tmp_path, columns, message):
    columns = {name.replace("__", " [") + "]" if "__" in name else name: values for name, values in columns.items()}
    write_text(tmp_path / "a.csv", columns)
    status, _, err = in_process("recordings", written(tmp_path, BASE), "--output", tmp_path / "out")
    assert status == 1 and len(err.splitlines()) == 1
    assert re.search(message, err), err


@pytest.mark.parametrize(
    "name, change, message, kept",
    [  # what happens to the third hold, or within it
        ("force__N", (ENDS[1], ENDS[2], lambda x: np.clip(x, None, 90.15)), r"left out: force clipped", 3),
        ("force__N", (ENDS[1] + 1.0, ENDS[1] + 1.25, lambda x: 0 * x), r"marked: [23] of \d+ periods disturbed", 4),
        ("force__N", (ENDS[1] + 0.9, ENDS[1] + 1.4, lambda x: 0 * x), r"left out: [34] steady periods, 5 at least", 3),
        ("force__N", (ENDS[1] + 1.0, ENDS[1] + 1.3, lambda x: x * np.nan), r"marked: [23] of \d+ periods disturbed", 4),
        ("force__N", (ENDS[1] + 0.2, ENDS[2], lambda x: x * np.nan), r"left out: force has missing values", 3),
    ],
)
def test_what_can_be_used_is_used_and_marked(tmp_path, name, change, message, kept):
    record = changed(**{name: stretched(COLUMNS[name], *change)})
    curves, out, err = found(written(tmp_path, BASE, **record))
    assert re.search(message, err), err
    assert len(err.splitlines()) == 1
    frequencies = np.array(FOUR)[[0, 1, 2, 3] if kept == 4 else [0, 1, 3]]
    assert_linear(curves, frequencies)
    assert f"{kept} used" in out
    assert len(table(tmp_path / "out" / "holds.csv")) == 4


def test_a_limit_is_found_by_how_often_it_comes(tmp_path):
    """At 60 Hz a clipped crest has one or two values, too few to stand still; without noise values repeat."""
    random = np.random.default_rng(4)
    coarse = shaken((2.1, 3.3), rate=60.0, periods=20)
    force = coarse.force + 0.01 * random.standard_normal(coarse.time.size)
    columns = {"time__s": coarse.time, "position__m": coarse.displacement}
    clean = written(tmp_path, BASE, **columns, force__N=coarse.force)
    assert_linear(found(clean)[0], (2.1, 3.3))
    limited = np.minimum(force, np.quantile(force, 0.9))
    (tmp_path / "b").mkdir()
    settings = written(tmp_path / "b", BASE, **columns, force__N=limited)
    status, _, err = in_process("recordings", settings, "--output", tmp_path / "out b")
    assert status == 1 and err.count("left out: force clipped") == 2


def test_a_burst_does_not_tilt_what_is_beside_it(tmp_path):
    """Half of the periods have a disturbance that is a thousand times the force; H of the others is exact."""
    random = np.random.default_rng(6)
    long = shaken((3.3,), periods=30)
    burst = 3e3 * random.standard_normal(long.time.size) * ((long.time > 2.5) & (long.time < 6.0))
    columns = {"time__s": long.time, "position__m": long.displacement, "force__N": long.force + burst}
    curves, _, err = found(written(tmp_path, BASE, **columns))
    assert_linear(curves, (3.3,))
    assert re.search(r"marked: 1[23] of \d+ periods disturbed", err), err


def test_a_hold_that_is_too_short_for_its_noise_is_left_out(tmp_path):
    random = np.random.default_rng(3)
    noisy = RECORD.force + np.where(TIME > ENDS[2], 40.0, 0.001) * random.standard_normal(TIME.size)
    curves, _, err = found(written(tmp_path, BASE, **changed(force__N=noisy)))
    assert re.search(r"9.1 Hz: left out: too short for its noise: standard error \d+ %, more than 30 %", err), err
    assert_linear(curves, FOUR[:3], tolerance=0.01)


def test_a_poor_control_is_left_out_with_its_limit(tmp_path):
    poor = shaken(FOUR, harmonics={2: 0.03, 3: 0.05})
    columns = {"time__s": poor.time, "force__N": poor.force, "position__m": poor.displacement}
    status, _, err = in_process("recordings", written(tmp_path, BASE, **columns), "--output", tmp_path / "out")
    assert status == 1
    assert err.count("left out: distortion of the motion 16 %, more than 10 %") == 4
    assert err.splitlines()[-1].startswith("zspring: no hold can be used: see")


def test_results_of_other_settings_are_kept(tmp_path):
    found(written(tmp_path, BASE, **COLUMNS))
    settings = written(tmp_path, BASE.replace("90", "91"))
    status, _, err = in_process("recordings", settings, "--output", tmp_path / "out")
    assert status == 1 and "is of other settings" in err


def test_displacement_and_acceleration_check_each_other(tmp_path):
    """An accelerometer that is 3 % off and 4 ms late is told; which of both H is of has to be said."""
    both = BASE + '[acceleration]\nchannel = "sensor"\npositive = "up"\n'
    late = shaken(FOUR, late=0.0)
    record = changed(sensor__g=1.03 / 9.80665 * np.roll(late.acceleration, 2))
    status, _, err = in_process("recordings", written(tmp_path, both, **record), "--output", tmp_path / "out")
    assert status == 1 and 'motion is missing: "displacement" or "acceleration", of which H is' in err
    curves, _, err = found(written(tmp_path, 'motion = "displacement"\n' + both, **record))
    assert_linear(curves, FOUR)
    told = re.findall(r"([\d.]+) Hz: marked: displacement from acceleration off by \+3.0 %, (-[\d.]+) deg", err)
    assert [float(f) for f, _ in told] == list(FOUR)
    np.testing.assert_allclose([float(turn) for _, turn in told], [-360 * f * 0.004 for f in FOUR], atol=0.06)


def test_doubts_about_the_bench_are_told(tmp_path):
    """No static force; another one than the load cell has; energy that comes out; holds that miss or are not wanted."""
    without = BASE.replace("static_force = 90\n", "")
    _, _, err = found(written(tmp_path / "", without, **COLUMNS))
    assert err == "static_force is not given: identify needs it, and what it finds depends on it\n"
    (tmp_path / "b").mkdir()
    _, _, err = found(written(tmp_path / "b", BASE.replace("90", "120"), **COLUMNS))
    assert err == "the force has a mean of 90 N, static_force is 120 N: is its zero right?\n"
    (tmp_path / "c").mkdir()
    swapped = changed(force__N=180 - RECORD.force)
    _, _, err = found(written(tmp_path / "c", BASE, **swapped))
    assert "at 4 of 4 points the receptance has a positive imaginary part" in err and '[force] sense = "contact"' in err
    (tmp_path / "d").mkdir()
    some = BASE + "[sweep]\nfrequencies = [2.0, 3.3, 4.0, 9.1]\n"
    curves, _, err = found(written(tmp_path / "d", some, **COLUMNS))
    assert_linear(curves, (2.0, 3.3, 9.1))
    assert "a.csv: no hold at 4 Hz" in err
    assert re.search(r"5.2 Hz: left out: not in the list of frequencies", err)
