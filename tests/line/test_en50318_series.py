"""Contact forces from CSV files: units, forms, and one clear line for every kind of bad file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from zspring.errors import ZSpringError
from zspring.line.result import LineResult, write_result
from zspring.line.series import Series, read_series
from zspring.line.stated import Stated
from zspring.line.statistics import Section, statistics

TIME = np.arange(1001) * 0.002
FORCE = 100 + 20 * np.sin(2 * np.pi * TIME)
POSITION = 40 + 60 * TIME


def write(path: Path, columns: dict[str, object]) -> Path:
    """A CSV of columns by name; texts stay as they are."""
    cells = [[value if isinstance(value, str) else repr(float(value)) for value in c] for c in columns.values()]
    lines = ["# made by a test", ",".join(columns), *(",".join(row) for row in zip(*cells))]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "columns",
    [
        {"time [s]": TIME, "contact_force [N]": FORCE, "position [m]": POSITION},
        {"Contact force [kN]": FORCE / 1e3, "Time [ms]": 1e3 * TIME, "position [km]": POSITION / 1e3},
        {"time [s]": TIME, "contact force 1 [N]": FORCE, "position 1 [m]": POSITION},
        {"time [s]": TIME + 7, "remark": ["-"] * 1001, "contact_force [N]": FORCE, "position [m]": POSITION},
    ],
)
def test_units_and_forms_of_the_columns_make_no_difference(columns, tmp_path):
    found = read_series(write(tmp_path / "a.csv", columns))
    assert found.force == pytest.approx(FORCE) and found.position == pytest.approx(POSITION)
    assert found.step == pytest.approx(0.002)
    assert found.speed == pytest.approx(216)


def test_time_and_position_stand_in_for_each_other_with_a_speed(tmp_path):
    of_position = write(tmp_path / "p.csv", {"position [m]": POSITION, "contact_force [N]": FORCE})
    assert read_series(of_position, speed=60.0).time == pytest.approx(TIME)
    of_time = write(tmp_path / "t.csv", {"time [s]": TIME, "contact_force [N]": FORCE})
    assert read_series(of_time, speed=60.0).position == pytest.approx(60 * TIME)
    assert read_series(of_time).position is None
    with pytest.raises(ZSpringError, match="the positions need the speed"):
        read_series(of_position)


def test_heights_and_uplifts_are_read_in_their_units(tmp_path):
    path = write(
        tmp_path / "a.csv",
        {
            "time [s]": TIME,
            "contact_force [N]": FORCE,
            "wire_height [mm]": 1e3 * TIME,
            "support_uplift at 60 m [mm]": 20 * TIME,
            "support uplift west [cm]": TIME,
        },
    )
    found = read_series(path)
    assert found.height == pytest.approx(TIME)
    assert found.uplift["at 60 m"] == pytest.approx(0.02 * TIME)
    assert found.uplift["west"] == pytest.approx(0.01 * TIME)
    assert found.support_position == {"at 60 m": 60.0}


def test_files_of_our_own_runs_are_read_by_pantograph(tmp_path):
    two = np.column_stack([FORCE, FORCE + 5])
    result = LineResult(
        TIME,
        np.column_stack([POSITION, POSITION - 30]),
        two,
        two / 1e4,
        two / 1e4,
        np.array([60.0, 120.0]),
        np.column_stack([TIME, 2 * TIME]) / 100,
        0 * TIME,
        np.zeros((TIME.size, 2, 2)),
        {"speed": "216 km/h"},
        1.0,
    )
    write_result(result, tmp_path / "line.csv")
    for number in (1, 2):
        found = read_series(tmp_path / "line.csv", pantograph=number)
        assert found.force == pytest.approx(two[:, number - 1])
        assert found.position == pytest.approx(result.position[:, number - 1])
        assert found.height == pytest.approx(two[:, number - 1] / 1e4)
        assert found.support_position == {"at 60 m": 60.0, "at 120 m": 120.0}
    with pytest.raises(ZSpringError, match="no column 'contact force"):
        read_series(tmp_path / "line.csv", pantograph=3)


def changed(values: np.ndarray, at: int, value: float) -> np.ndarray:
    result = values.copy()
    result[at] = value
    return result


@pytest.mark.parametrize(
    "columns",
    [
        {"time_s_": TIME, "contact_force_N_": FORCE, "position_m_": POSITION},
        {"Time (ms)": 1e3 * TIME, "contact.force [N]": FORCE, "position [m]": POSITION},
        {"time [s]": [f"{1700000000 + t:.3f}" for t in TIME], "contact_force [N]": FORCE, "position [m]": POSITION},
    ],
)
def test_tables_as_other_tools_write_them(columns, tmp_path):
    """MATLAB's names, those of `zspring simulate`, seconds since 1970: figures as of the plain table."""
    plain = write(tmp_path / "a.csv", {"time [s]": TIME, "contact force [N]": FORCE, "position [m]": POSITION})
    section = Section.alike(2, 2, 50.0)
    expected, found = (statistics(read_series(path), section) for path in (plain, write(tmp_path / "b.csv", columns)))
    assert found == pytest.approx(expected, rel=1e-6, nan_ok=True)


def test_a_turned_force_is_the_force(tmp_path):
    path = write(tmp_path / "a.csv", {"time [s]": TIME, "contact_force [N]": -FORCE})
    assert read_series(path, turned=True).force == pytest.approx(FORCE)


def headed(path: Path, *lines: str, position: bool = True) -> Path:
    """A file with these lines at its head."""
    own = {"position [m]": POSITION} if position else {}
    write(path, {"time [s]": TIME, "contact_force [N]": FORCE, **own})
    path.write_text("".join(f"# {line}\n" for line in lines) + path.read_text(encoding="utf-8"), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("lines", "stated"),
    [
        ([], Stated()),
        (["span: 0.055 km", "first support: -10 m", "speed: 60 m/s"], Stated(55, None, -10, 60)),
        (["catenary line.span: 55 m", "catenary line.spans: 10", "speed: 216 km/h"], Stated(55, 10, 0, 60)),
        (["speed: as the timetable has it"], Stated()),
    ],
)
def test_the_head_says_where_and_how_fast(lines, stated, tmp_path):
    found = read_series(headed(tmp_path / "a.csv", *lines)).stated
    assert (found.spans, found.span, found.first_support, found.speed) == pytest.approx(
        (stated.spans, stated.span, stated.first_support, stated.speed)
    )


def test_a_speed_of_the_head_places_the_series_and_must_be_that_of_all_others(tmp_path):
    path = headed(tmp_path / "a.csv", "speed: 216 km/h", position=False)
    assert read_series(path).position == pytest.approx(60 * TIME)
    assert read_series(path, speed=60.5).speed == pytest.approx(216)  # within 2 %
    with pytest.raises(ZSpringError, match=r"speed: 216 km/h by the head of the file, but 252 km/h by --speed"):
        read_series(path, speed=70.0)
    with pytest.raises(ZSpringError, match=r"speed: 200 km/h by the head of the file, but 216 km/h by its times"):
        read_series(headed(path, "speed: 200 km/h"))


@pytest.mark.parametrize(
    ("line", "told"), [("span: 55", r"# span: unit \[\]"), ("speed: 60 m", r"# speed: unit \[m\]")]
)
def test_a_number_in_the_head_needs_its_unit(line, told, tmp_path):
    with pytest.raises(ZSpringError, match=told):
        read_series(headed(tmp_path / "a.csv", line))


UNEVEN = np.concatenate([TIME[:500], TIME[500] + 0.003 * np.arange(501)])
GAP = np.where(TIME >= 1.0, TIME + 0.5, TIME)


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"time [s]": GAP, "contact_force [N]": FORCE}, "gap: step of 0.502 s at 0.998 s, 0.002 s elsewhere"),
        ({"time [s]": UNEVEN, "contact_force [N]": FORCE}, "sample rate changes: step of"),
        ({"time [s]": changed(TIME, 30, 0.01), "contact_force [N]": FORCE}, "time does not increase after"),
        ({"time [s]": TIME[:101], "contact_force [N]": FORCE[:101]}, "0.2 s is too short for 20 Hz"),
        ({"time [s]": TIME[:1], "contact_force [N]": FORCE[:1]}, "time does not increase"),
        ({"time [s]": 10 * TIME, "contact_force [N]": FORCE}, "50 samples/s: at least 100 are needed"),
        ({"time [s]": TIME, "contact_force": FORCE}, "'contact force' needs its unit, as in 'contact force .N.'"),
        ({"time": TIME, "contact_force [N]": FORCE}, "column 'time' needs its unit, as in 'time .s.'"),
        ({"time [s]": TIME, "contact_force [lbf]": FORCE}, "column 'contact_force': unit .lbf.: must be one of N, kN"),
        ({"time [s]": TIME, "force [N]": FORCE}, "no column 'contact force .N.' .there are: time"),
        ({"contact_force [N]": FORCE}, "no column 'time .s.' or 'position .m.'"),
        ({"time [s]": TIME, "time [ms]": TIME, "contact_force [N]": FORCE}, "two columns 'time'"),
        ({"time [s]": TIME, "contact_force [N]": changed(FORCE, 7, np.nan)}, "line 10: contact_force = 'nan'"),
        ({"time [s]": TIME, "contact_force [N]": ["1"] * 40 + [""] * 961}, "line 43: contact_force = ''"),
        ({"time [s]": TIME, "contact_force [N]": ["x"] * 1001}, "line 3: contact_force = 'x': must be a finite"),
        ({"time [s]": TIME, "contact_force [N]": FORCE, "position [m]": POSITION[::-1]}, "position decreases"),
        ({"time [s]": [], "contact_force [N]": []}, "no row of values"),
        ({"time [s]": TIME, "contact_force [N]": -FORCE}, "mean contact force = -100 N: must be above 0.*--turn-force"),
        ({"time [s]": TIME, "contact_force [N]": 0 * FORCE}, "mean contact force = 0 N: must be above 0"),
        ({"time [s]": TIME, "contact_force [N]": [*["100"] * 9, "-9999", *["100"] * 991]}, "line 12: .* no value"),
        ({"time [s]": TIME, "contact_force [N]": [*["100"] * 9, "999.90", *["100"] * 991]}, "line 12: .* no value"),
        ({"time [s]": TIME, "contact_force [N]": changed(FORCE, 9, -32768)}, "line 12: contact force = -32768 N: must"),
        (
            {"time [s]": TIME, "contact_force [N]": np.where(TIME < 1, -32768, FORCE)},
            "line 3: contact force = -32768 N",
        ),
        (
            {"time [s]": TIME, "contact_force [kN]": changed(FORCE, 9, 6)},
            "line 3: contact force = 100000 N: must be in",
        ),
        (
            {"time [s]": TIME, "contact_force [N]": FORCE, "wire height [m]": changed(5.3 + 0 * TIME, 9, 0)},
            "line 12: wire height = 0 m: must be in 3.3 .. 7.3 m",
        ),
        (
            {"time [s]": TIME, "contact_force [N]": FORCE, "support uplift at 60 m [mm]": changed(TIME, 9, -9999)},
            r"line 12: support uplift at 60 m = -9999.0: is a sign for no value",
        ),
        (
            {"time [s]": TIME, "contact_force [N]": FORCE, "support uplift [m]": TIME - 3},
            "line 3: support uplift = -3 m",
        ),
    ],
)
def test_bad_files_are_refused_in_one_line(columns, message, tmp_path):
    path = write(tmp_path / "bad.csv", columns)
    with pytest.raises(ZSpringError, match=message) as refusal:
        read_series(path)
    assert "\n" not in str(refusal.value) and "bad.csv" in str(refusal.value)


def test_rounded_times_are_even_enough():
    """Files with few digits: 1 ms at 4 decimals of 500 samples/s."""
    Series("test", np.round(TIME, 5), FORCE).check()


@pytest.mark.parametrize(
    ("time", "complaint"),
    [
        (np.arange(501) / 500, None),
        (np.arange(500) / 500, r"0\.998 s is too short for 20 Hz: at least 1 s"),
        (np.arange(201) / 100, None),
        (np.arange(201) / 99, r"99 samples/s: at least 100 are needed"),
        (np.concatenate([TIME[:500], TIME[500:] + 0.019 * 0.002]), None),
        (np.concatenate([TIME[:500], TIME[500:] + 0.021 * 0.002]), r"gap: step of 0\.002042 s at 0\.998 s, 0\.002 s"),
        (np.concatenate([TIME[:500], TIME[500:] - 0.021 * 0.002]), r"gap: step of 0\.001958 s"),
    ],
)
def test_series_are_refused_just_beyond_the_limits(time, complaint):
    """1 s, 100 samples a second, steps within 2 % of the usual one."""
    series = Series("test", time, np.ones(time.size))
    if complaint is None:
        assert series.check() is series
    else:
        with pytest.raises(ZSpringError, match=complaint):
            series.check()


@pytest.mark.parametrize(("wrong", "what"), [(13, "gap"), (14, "sample rate changes")])
def test_many_uneven_steps_are_another_rate_and_few_are_gaps(wrong, what):
    """More than a hundredth of 1000 steps and three."""
    steps = np.full(1000, 0.002)
    steps[100 : 100 + wrong] = 0.004
    with pytest.raises(ZSpringError, match=f"test: {what}: step of 0.004 s"):
        Series("test", np.concatenate([[0], np.cumsum(steps)]), np.ones(1001)).check()


def test_a_position_that_stands_still_is_no_step_back():
    position = np.maximum(POSITION, 50)
    Series("test", TIME, FORCE, position).check()
    with pytest.raises(ZSpringError, match="position decreases after 50 m"):
        Series("test", TIME, FORCE, changed(position, 1, 49.9)).check()


def test_the_positions_of_a_time_begin_at_the_first_sample(tmp_path):
    path = write(tmp_path / "t.csv", {"time [s]": TIME + 3, "contact_force [N]": FORCE})
    found = read_series(path, speed=60.0)
    assert found.position == pytest.approx(60 * TIME) and found.time == pytest.approx(TIME + 3)
    path = write(tmp_path / "p.csv", {"position [m]": POSITION, "contact_force [N]": FORCE})
    assert read_series(path, speed=60.0).time[0] == 0
