"""Contact forces from CSV files: units, forms, and one clear line for every kind of bad file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from zspring.errors import ZSpringError
from zspring.line.result import LineResult, write_result
from zspring.line.series import Series, read_series

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
