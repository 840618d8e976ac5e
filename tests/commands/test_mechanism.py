"""The drawn linkage: lengths to scale, rods that stick and slip, an animation without any other file."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

from commands import PNG, table, zspring
from zspring.fmu import Fmu
from zspring.linkage import linkage_points
from zspring.mechanism.cycle import Cycle, simulate_cycle
from zspring.mechanism.plot import spring_line
from zspring.mechanism.run import LARGEST_DRAWN, magnification


@pytest.fixture(scope="module")
def instance():
    with Fmu() as fmu, fmu.instances() as (instance,):
        yield instance


@pytest.mark.parametrize("shape", [{}, {"zspring.L1": 0.05, "zspring.L2": 0.09}])
def test_the_drawn_spring_is_as_long_as_the_fmu_says_and_the_rods_keep_their_lengths(instance, shape):
    bench = {"bench.frequency": 3.0, "bench.acceleration": 6.0}
    instance.start({**shape, **bench, **instance.variables.parse_assignments(["drive=Bench"])})
    names = instance.variables.names("parameter", "calculatedParameter")
    p = dict(zip(names, instance.get(names)))
    lengths, time = [], 0.0
    for _ in range(20):
        instance.step(time, 0.037)
        time += 0.037
        *state, length = instance.get(["head.z", "zspring.alpha", "zspring.beta", "upper_frame.z", "zspring.length"])
        head, head_end, frame_end, top = linkage_points(p, *map(np.array, state))
        assert np.hypot(*(head_end - head)) == pytest.approx(p["zspring.L1"], rel=1e-12)
        assert np.hypot(*(frame_end - top)) == pytest.approx(p["zspring.L2"], rel=1e-12)
        assert top[0] - head[0] == pytest.approx(p["zspring.d"], rel=1e-12)
        assert np.hypot(*(frame_end - head_end)) == pytest.approx(length, rel=1e-9)
        lengths.append(length)
    assert np.ptp(lengths) > 1e-3


def test_at_rest_rods_and_spring_lie_on_one_line(instance):
    rest = simulate_cycle(instance, {}, 2.0, 0.25).points(magnification=0.0)[0]
    slopes = np.diff(rest[:, 1]) / np.diff(rest[:, 0])
    np.testing.assert_allclose(slopes, slopes[0], rtol=1e-9)


def test_a_small_sine_leaves_the_rods_stuck_and_a_large_one_makes_them_slip(instance):
    """Stuck rods of the Coulomb law do not turn at all; those of the regularised one creep a little."""
    coulomb = instance.variables.parse_assignments(["friction=Coulomb"])
    stuck, slipping = (simulate_cycle(instance, coulomb, 2.0, a) for a in (0.25, 4.0))
    assert stuck.swing == 0 and not stuck.slips and np.ptp(stuck.compression) > 5e-4
    assert slipping.slips and np.abs(slipping.moments).max() == pytest.approx(slipping.parameters["zspring.Mf"])
    creeping = simulate_cycle(instance, {}, 2.0, 0.25)
    assert 0 < creeping.swing < 1e-3 and not creeping.slips


def test_the_extremes_are_those_of_the_compression(instance):
    cycle = simulate_cycle(instance, {}, 2.0, 4.0)
    below, above = cycle.extremes
    on_frame = cycle.points(on_frame=True)[:, 0, 1]
    assert on_frame[below] == on_frame.min() < -0.01 and on_frame[above] == on_frame.max() > 0.01


def test_small_motion_is_magnified_and_large_motion_is_not(instance):
    for acceleration in (0.05, 0.25, 4.0, 8.0):
        cycle = simulate_cycle(instance, {}, 2.0, acceleration)
        factor, largest = magnification(cycle), np.abs(cycle.compression).max()
        assert factor == 1 or LARGEST_DRAWN / 2.5 <= factor * largest <= LARGEST_DRAWN
        moved = cycle.points(factor)[:, 0, 1] - cycle.points(0.0)[:, 0, 1]
        np.testing.assert_allclose(moved, factor * cycle.u1, atol=1e-12)


@pytest.mark.parametrize(
    "largest, factor",
    [(0.03, 1), (0.0251, 1), (0.0124, 2), (0.0126, 1), (0.0049, 5), (0.0051, 2), (0.0024, 10), (1e-4, 200)],
)
def test_magnifications_are_one_two_five_ten_and_no_more_than_there_is_room_for(largest, factor):
    """25 mm are drawn; the compression counts, in either direction, not the motion."""
    for sign in (-1, 1):
        motion = np.array([0.0, sign * largest, -0.2 * sign * largest])
        zero = np.zeros(3)
        cycle = Cycle(2.0, 1.0, {}, 7 + zero, zero, zero, 7 + motion, np.zeros((3, 2)))
        assert magnification(cycle) == factor


@pytest.mark.parametrize("share, slips", [(0.095, False), (0.105, True)])
def test_rods_slip_from_a_tenth_of_what_free_ones_would_turn(share, slips):
    """A compression of 10 mm turns free rods by 10 mm cos(theta)^2 / d; the larger of both counts."""
    compression, theta, d = np.array([0.0, 0.004, -0.006]), 0.5, 0.17
    turn = share * 0.010 * np.cos(theta) ** 2 / d * np.array([0.0, 1.0, 0.5])
    parameters = {"zspring.theta": theta, "zspring.d": d}
    for alpha, beta in ((turn, 0 * turn), (0 * turn, turn)):
        cycle = Cycle(2.0, 1.0, parameters, -compression, theta + alpha, theta + beta, 0 * turn, np.zeros((3, 2)))
        assert cycle.slips == slips


def test_a_cycle_is_taken_when_the_start_is_forgotten(instance):
    """A linear head makes the frame follow in one sine; what is left of the start would be none of that frequency."""
    locked = instance.variables.parse_assignments(["suspension=LinearLocked"])
    cycle = simulate_cycle(instance, locked, 3.0, 2.0)
    harmonics = np.abs(np.fft.rfft(cycle.u2))
    assert harmonics[1] > 0 and harmonics[2:].max() < 1e-3 * harmonics[1]
    amplitude = 2.0 / (6 * np.pi) ** 2
    np.testing.assert_allclose((cycle.u1.max(), cycle.u1.min()), (amplitude, -amplitude), rtol=1e-3)


def test_the_spring_is_drawn_from_end_to_end():
    start, end = np.array([1.0, 2.0]), np.array([40.0, -20.0])
    line = spring_line(start, end)
    np.testing.assert_allclose(line[[0, -1]], [start, end])


def test_the_animation_needs_no_other_file_and_shows_the_simulated_states(tmp_path):
    out, _ = zspring(tmp_path, "mechanism", "--accelerations", "0.25,4", "--output", "out")
    assert "stuck" in out and "slipping" in out
    page = (tmp_path / "out/mechanism.html").read_text(encoding="utf-8")
    assert not re.search(r"https?:|src=|href=|import|url\(|fetch|/\*DATA", page)
    data = json.loads(re.search(r"^const data = (.*);$", page, re.MULTILINE).group(1))
    rows = table(tmp_path / "out/mechanism.csv")
    assert len(rows) == 2 * data["count"]
    for case, acceleration in zip(data["cases"], ("0.25", "4")):
        own = [row for row in rows if row["acceleration [m/s2]"] == acceleration]
        assert len(case["points"]) == len(own) == data["count"]
        shown = np.array(case["values"])
        head = [1e3 * float(row["head.z [m]"]) for row in own]
        np.testing.assert_allclose(shown[:, 0], head, atol=1e-4)
        angles = [np.degrees(float(row["zspring.alpha [rad]"])) for row in own]
        np.testing.assert_allclose(shown[:, 2], angles, atol=1e-4)
        left, top, width, height = data["view"]
        points = np.array(case["points"])
        assert points[..., 0].min() >= left and points[..., 0].max() <= left + width
        assert (-points[..., 1]).min() >= top and (-points[..., 1]).max() <= top + height
    assert (tmp_path / "out/mechanism.png").read_bytes().startswith(PNG)


@pytest.mark.parametrize(
    "arguments, named",
    [
        (["--frequency", "0"], ["bench.frequency", "0"]),
        (["--frequency", "0.1"], ["0.1 Hz", "stroke"]),
        (["--frequency", "nan"], ["--frequency", "nan", "finite"]),
        (["--set", "suspension=Linear"], ["suspension", "Linear"]),
        (["--set", "drive=Force"], ["drive", "sets"]),
    ],
)
def test_bad_settings_get_one_clear_line(tmp_path, arguments, named):
    _, err = zspring(tmp_path, "mechanism", *arguments, status=1)
    assert len(err.strip().splitlines()) == 1 and all(word in err for word in named), err
