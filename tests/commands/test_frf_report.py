"""What `zspring frf` says of its points: resonances, errors, doubts, Newton's statistics, and where it writes."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from zspring.bench.points import FrfPoint, FrfSettings
from zspring.bench.refine import Extreme
from zspring.fmu import Fmu
from zspring.frf.backbone import Row
from zspring.frf.report import difference_lines, doubtful_lines, error_line, resonance_table, richardson, solver_line
from zspring.frf.run import default_folder
from zspring.interrupt import stop_on_interrupt
from zspring.options import Numbers
from zspring.text_tables import with_error


def test_the_table_lists_extremes_in_mm_per_newton_with_the_digits_that_are_known():
    peak, valley = Extreme(True, 6.5302, 0.0011, 4.0004e-4, 6e-9), Extreme(False, 4.1103, 0.03, 4e-5, 1.2e-7)
    jump = Extreme(True, 5.31, 0.004, 3e-4, 1e-7, "jump")
    unsettled = Extreme(False, 9.5, 0.25, 2e-5, 4e-7, "not settled")
    locked, free = (Row(name, "", [Extreme(True, f, 0, 3e-4, 0)]) for name, f in (("locked", 6.0), ("free", 5.0)))
    rows = [locked, Row("0.5 m/s2", "up", [valley, peak]), Row("4 m/s2", "up", [jump, unsettled]), free]
    header, *lines, legend = resonance_table(rows)
    assert header.split() == ["resonances:", "Hz,", "mm/N", "antiresonances"]
    assert [line.split() for line in lines] == [
        ["locked", "6.000", "0.3000"],
        ["0.5", "m/s2", "6.530(2)", "0.4000(1)", "4.11(3)", "0.0400(2)"],
        ["4", "m/s2", "5.310(4)", "0.3000(1)|", "9.5(3)", "0.0200(4)?"],
        ["free", "5.000", "0.3000"],
    ]
    assert legend == "in brackets: error of the last digit; ? rests on points not settled; | the curve jumps there"
    both = resonance_table([locked, Row("1 m/s2", "up", [peak]), Row("1 m/s2", "down", [peak]), free])
    assert [line.split()[:3] for line in both[2:4]] == [["1", "m/s2", "up"], ["1", "m/s2", "down"]]


@pytest.mark.parametrize(
    "value, error, text",
    [
        (6.53456, 0.0023, "6.535(3)"),
        (6.53456, 0.0091, "6.53(1)"),
        (6.53456, 0.01, "6.53(1)"),
        (6.53456, 1e-7, "6.535(1)"),
        (6.53456, 0.0, "6.535"),
        (1234.5, 21.0, "1230(30)"),
    ],
)
def test_no_digit_is_printed_beyond_the_error(value, error, text):
    assert with_error(value, error, 3) == text


def test_sweeps_that_end_in_different_states_are_told():
    up = [FrfPoint(1, f, "settled", 1 + 0j, remaining=1e-4) for f in (2.0, 3.0)]
    down = [FrfPoint(1, f, "settled", H, remaining=1e-4) for f, H in ((2.0, 1.001 + 0j), (3.0, 1 + 0.016j))]
    assert difference_lines(up, down[:1], 1e-3) == ["up and down differ by at most 0.1 % at 1 m/s2 (2 Hz)"]
    assert difference_lines(up, down, 1e-3) == [
        "up and down differ by at most 1.6 % at 1 m/s2 (3 Hz)",
        "at 1 of 2 points by more than is left of both transients: two steady states",
    ]


def test_the_error_estimate_is_exact_for_an_error_of_second_order():
    """H = 1 + e h^2: what is left at h is e h^2, of which half the step takes three quarters."""
    for error in (0.01, 0.01 - 0.02j):
        H, finer = 1 + error, 1 + error / 4
        assert richardson(H, finer) == pytest.approx(abs(H - 1) / abs(H), rel=1e-12)


def test_median_and_worst_error_are_told_in_percent_with_the_place():
    errors = {(0.5, 3.0): 0.001, (0.5, 6.0): 0.002, (4.0, 3.0): 0.075}
    assert error_line(errors) == "error estimate of H from half the step: 0.2 % median, 7.5 % worst (at 3 Hz, 4 m/s2)"


def test_newtons_statistics_are_sums_but_for_the_worst_step():
    points = [
        FrfPoint(1, 2, "settled", steps=100, iterations=150, refinements=1, iterations_max=4),
        FrfPoint(1, 3, "settled", steps=300, iterations=350, refinements=2, iterations_max=3),
    ]
    assert solver_line(points) == "Newton: 1.25 iterations per step, at most 4; 400 steps, 3 halvings"
    assert solver_line([FrfPoint(1, 2, "failed: x")]).startswith("Newton: 0.00 iterations per step")


def test_only_points_that_failed_or_found_no_steady_state_of_the_drives_period_are_doubtful():
    points = [
        FrfPoint(1, 2, "settled", 1.0, 8, 1e-4),
        FrfPoint(1, 3, "not settled", 1.0, 400, 0.0123, remaining=0.0456),
        FrfPoint(2, 3, "period 2", 1.0, 60, 0.0123),
        FrfPoint(8, 1, "left out"),
        FrfPoint(8, 4, "failed: no solution"),
    ]
    assert doubtful_lines(points) == [
        "1 m/s2, 3 Hz: not settled after 400 periods (change 0.012, about 0.046 from steady)",
        "2 m/s2, 3 Hz: period 2: repeats only after so many periods of the drive (change 0.012)",
        "8 m/s2, 4 Hz: failed: no solution",
    ]


def test_results_of_other_settings_go_to_other_folders():
    """The standard figure's folder is named by friction and direction; anything else adds a code."""
    with Fmu() as fmu:

        def folder(**settings) -> str:
            return default_folder(fmu, FrfSettings(**settings)).as_posix()

        assert folder() == "results/frf-regularized-up"
        assert folder(direction="down", parameters={"friction": 2}) == "results/frf-coulomb-down"
        assert folder(parameters={"friction": 1}) == folder()
        others = [
            {"tolerance": 1e-4},
            {"amplitudes": (1.0,)},
            {"parameters": {"m1": 7.0}},
            {"through": "inputs"},
            {"max_periods": 500},
        ]
        names = {folder(**each) for each in others}
        assert len(names) == len(others)
        assert all(name.startswith("results/frf-regularized-up-") and len(Path(name).name) == 27 for name in names)


@pytest.mark.parametrize(
    "text, numbers",
    [
        ("3", [3]),
        ("0.1:0.7:0.1", [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]),
        ("0.5:1:0.2", [0.5, 0.7, 0.9]),
        ("2:2:1", [2]),
        ("4, 1:3:1,2 0.5", [0.5, 1, 2, 3, 4]),
        ("1:1.3:0.1", [1, 1.1, 1.2, 1.3]),
    ],
)
def test_lists_of_numbers_are_sorted_and_ranges_hold_their_ends(text, numbers):
    assert Numbers().convert(text, None, None) == tuple(numbers)
    assert len(Numbers().convert("0.5:20:0.25", None, None)) == 79


@pytest.fixture
def python_interrupts() -> Iterator[None]:
    """Also where the tests were started in the background, where a shell makes Ctrl-C be ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("python_interrupts")
def test_the_first_ctrl_c_is_a_wish_and_the_second_an_interruption():
    before = signal.getsignal(signal.SIGINT)
    with stop_on_interrupt() as stop:
        assert not stop.is_set()
        signal.raise_signal(signal.SIGINT)
        assert stop.is_set()
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is before
