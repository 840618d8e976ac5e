"""The map of stick and slip: its line of onset in closed form, what is measured next, and an interrupted run."""

from __future__ import annotations

import threading

import numpy as np
import pytest

from linear import LinearPantograph, ZSpringLinear
from zspring.bench.measure import FmuBench
from zspring.bench.points import FrfSettings
from zspring.bench.slip import FULL, PARTIAL, SLIDES, SLIP, Raising, SlipPoint, bounds, missing, raise_amplitude
from zspring.cli import main
from zspring.fmu import Fmu
from zspring.tables import read_rows


@pytest.fixture(scope="module")
def own_fmu():
    with Fmu() as fmu:
        yield fmu


def raised(fmu: Fmu, task: Raising, friction: str, **settings):
    chosen = fmu.variables.parse_assignments([f"friction={friction}", "solver.step=0.0005"])
    with fmu.instances() as (instance,):
        bench, wanted = FmuBench(instance, chosen), FrfSettings(**settings)
        return list(raise_amplitude(bench, task, wanted, threading.Event()))


@pytest.mark.parametrize("friction", ["Regularized", "Coulomb"])
@pytest.mark.parametrize("frequency", [2.0, 6.0, 9.0])
def test_slip_begins_where_the_moment_of_stuck_rods_reaches_its_bound(own_fmu, pantograph, friction, frequency):
    """The moment by the closed form of the linearised Z-spring under the relative motion of head and upper frame."""
    spring = ZSpringLinear.of(p := pantograph({"suspension": "ZSpring"}))
    omega = 2 * np.pi * frequency
    m, c, k = LinearPantograph.of(p, spring.k_locked).matrices()
    dynamic = k + 1j * omega * c - omega**2 * m
    upper_frame, _ = -np.linalg.solve(dynamic[1:, 1:], dynamic[1:, 0])  # under a head motion of 1 m
    moment = abs(spring.stiffness()[1] @ [1, 0, 0, upper_frame, 0])  # N m
    onset = SLIDES * p["zspring.Mf"] / moment * omega**2
    task = Raising(frequency, (0.5 * onset, 0.9 * onset, 1.2 * onset))
    points = [point for point, _ in raised(own_fmu, task, friction, tolerance=1e-4)]
    low, high = bounds(points, PARTIAL)
    # Before it is reached the head moves so far that the geometry shows.
    assert high / low < 1.021 and 0.95 * onset < low < high < 1.05 * onset
    assert points[0].state == "stick" and points[0].moment[0] == pytest.approx(0.5 * SLIDES, rel=0.03)


def test_both_laws_slide_for_the_same_part_of_the_period(own_fmu):
    laws = [raised(own_fmu, Raising(3.0, (0.1, 1.0, 8.0)), law) for law in ("Regularized", "Coulomb")]
    asked = [[point for point, _ in law[:3]] for law in laws]
    for one, other in zip(*asked):
        assert one.state == other.state
        np.testing.assert_allclose(one.sliding, other.sliding, atol=0.02)
    assert {point.state for point in asked[0]} == {"stick", "partial slip", "full slip"}


def test_a_run_that_goes_on_gives_the_same_points(own_fmu):
    amplitudes = (0.1, 0.2, 0.4)
    whole = raised(own_fmu, Raising(3.0, amplitudes), "Coulomb")
    for count in (1, 3, len(whole) - 1):
        rest = raised(own_fmu, Raising(3.0, amplitudes, whole[:count]), "Coulomb")
        assert [point for point, _ in rest] == [point for point, _ in whole[count:]]


def test_amplitudes_between_two_states_are_halved_until_they_are_close():
    """Onset at 1.37, full slip at 6.1 m/s2; a point that failed is as if it were not there."""
    points: list[SlipPoint] = []
    while (amplitude := missing(points, (0.5, 1.0, 3.0, 4.0, 8.0))) is not None:
        slides = 0.0 if amplitude < 1.37 else 0.5 if amplitude < 6.1 else FULL
        status = "failed: no solution" if amplitude == 3.0 else "settled"
        points.append(SlipPoint(3.0, amplitude, status, (0.5, 0.5) if slides == 0 else (1.0, 1.0), (slides, slides)))
    for state, at in ((PARTIAL, 1.37), (SLIP, 6.1)):
        low, high = bounds(points, state)
        assert low <= at <= high < 1.021 * low
    assert len(points) < 5 + 2 * 7
    assert bounds([SlipPoint(3.0, 1.0, "settled", (1.0, 0.2), (0.4, 0.0))], PARTIAL) == (0.0, 1.0)
    assert np.isnan(bounds(points[:1], SLIP)).all()


def test_rods_of_which_one_slides_slide_partly():
    assert SlipPoint(3.0, 1.0, "settled", (1.0, 0.5), (0.95, 0.0)).state == PARTIAL
    assert SlipPoint(3.0, 1.0, "settled", (1.0, 1.0), (0.95, 0.9)).state == SLIP
    assert SlipPoint(3.0, 1.0, "settled", (0.94, 0.5), (0.0, 0.0)).state == "stick"


def test_the_command_writes_points_lines_and_figure(tmp_path, capsys):
    arguments = ["slip", "--frequencies", "4,11", "--amplitudes", "0.1,0.2", "--output", str(tmp_path)]
    assert main(arguments) == 0
    said = capsys.readouterr().out
    assert "slip begins at 0.13 m/s2 (4 Hz)" in said
    assert "rods stick at the highest amplitude still: at 1 of 2 frequencies, from 11 to 11 Hz" in said
    _, rows = read_rows(tmp_path / "onset.csv")
    assert [float(row["frequency [Hz]"]) for row in rows] == [4, 11]
    assert float(rows[0]["onset_high [m/s2]"]) == pytest.approx(0.132, rel=0.03)
    assert rows[1]["onset_low [m/s2]"] == rows[0]["full_high [m/s2]"] == ""
    assert (tmp_path / "slip.png").exists() and not (tmp_path / "slip.partial.csv").exists()


@pytest.mark.parametrize("setting", ["friction=Free", "suspension=Linear", "zspring.Mf=0"])
def test_rods_that_cannot_stick_and_slide_are_refused(tmp_path, capsys, setting):
    assert main(["slip", "--set", setting, "--output", str(tmp_path / "out")]) == 1
    assert setting.split("=")[0] in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
