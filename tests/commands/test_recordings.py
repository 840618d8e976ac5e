"""`zspring recordings` finds the response of a linear pantograph in its time records; the truth is a closed form."""

from __future__ import annotations

import itertools
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from commands import head, in_process, table
from paths import ROOT
from shaker import BASE, FOUR, LINEAR, STATIC_FORCE, Shaken, assert_linear, found, shaken, swept, write_text, written
from zspring.bench.curves import Source
from zspring.bench.fmu_bench import FmuBench
from zspring.bench.measured import read_curves
from zspring.fmu import Fmu
from zspring.recordings.evaluate import evaluate
from zspring.recordings.example import recorded
from zspring.recordings.groups import grouped
from zspring.recordings.moderation import moderated, shrunk
from zspring.recordings.points import Point
from zspring.recordings.run import holds_in
from zspring.recordings.settings import Settings, read_settings
from zspring.recordings.signals import Record, Signal, read_record
from zspring.recordings.sine import error_of_mean, students, variance_of_mean
from zspring.recordings.track import Stretch

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


def test_units_signs_delay_and_fixture_are_accounted_for(tmp_path):
    """A load cell in volts that pulls, comes late and carries the fixture; a displacement in mm, downward."""
    record = shaken(FOUR, late=0.0013, fixture_mass=0.8)
    settings = BASE.replace('"up"', '"down"').replace('sense = "contact"', 'sense = "specimen"\nsensitivity = "4 mV/N"')
    settings = "fixture_mass = 0.8\n" + settings.replace("[time]", "[time]\nunit = 'ms'")
    settings = settings.replace('channel = "force"', 'channel = "force"\ndelay = 0.0013')
    columns = {
        "time__ms": 1e3 * record.time,
        "force__V": 4e-3 * record.force,
        "position__mm": -1e3 * record.displacement,
    }
    curves, out, err = found(written(tmp_path, settings, **columns))
    assert_linear(curves, FOUR)
    (curve,) = curves
    np.testing.assert_allclose(curve.acceleration, 1.0, rtol=1e-6)
    assert not err and "4 holds: 4 used" in out and "up" in out
    assert "# static_force: 90 N" in head(tmp_path / "out" / "frf.csv")
    assert "# direction: up" in head(tmp_path / "out" / "frf.csv")


def test_acceleration_tells_as_much_as_displacement(tmp_path):
    """By way of frequencies that fall, which is a sweep down; in g, from a sensor that hangs upside down."""
    record = shaken(FOUR[::-1])
    settings = BASE.replace("[displacement]", "[acceleration]").replace('"up"', '"down"')
    g = 9.80665
    columns = {"time__s": record.time, "force__N": record.force, "position__g": -record.acceleration / g}
    curves, _, _ = found(written(tmp_path, settings, **columns))
    assert_linear(curves, FOUR[::-1])
    assert "# direction: down" in head(tmp_path / "out" / "frf.csv")


def test_harmonics_distortion_and_loss_are_those_of_the_record(tmp_path):
    """A third harmonic of 1 % of the displacement: 3 % of the velocity, marked; the force has its own share of it."""
    record = shaken(FOUR, harmonics={3: 0.01})
    settings = written(tmp_path, BASE, time__s=record.time, force__N=record.force, position__m=record.displacement)
    curves, _, err = found(settings)
    assert_linear(curves, FOUR)
    assert err.count("marked: distortion of the motion 3 %") == len(FOUR)
    for f, row, hold in zip(FOUR, table(tmp_path / "out" / "frf.csv"), table(tmp_path / "out" / "holds.csv")):
        peak = 1.0 / (2 * np.pi * f) ** 2
        assert float(hold["motion_3 [m]"]) == pytest.approx(0.01 * peak, rel=1e-5)
        assert float(row["harmonic_3 [N]"]) == pytest.approx(
            0.01 * peak * abs(LINEAR.dynamic_stiffness(3 * f)), rel=1e-5
        )
        assert float(row["harmonic_2 [N]"]) < 1e-8
        loss = sum(
            np.pi * k * (size * peak) ** 2 * (LINEAR.dynamic_stiffness(k * f)).imag / k
            for k, size in ((1, 1), (3, 0.01))
        )
        assert float(hold["force_mean [N]"]) == pytest.approx(STATIC_FORCE, rel=1e-5)
        assert float(row["loss [J]"]) == pytest.approx(loss, rel=1e-3)


def test_a_harmonic_that_the_motion_makes_is_within_its_error(tmp_path):
    """Of a linear pantograph, whose force has none of its own: what is found is dynamic stiffness times motion.

    At 2 and 4 Hz the stiffness at the third harmonic is that of the points at 6 and 12 Hz; above, inertia makes it.
    """
    frequencies = (2.0, 4.0, 6.0, 12.0)
    record = shaken(frequencies, harmonics={3: 0.005})
    settings = written(tmp_path, BASE, time__s=record.time, force__N=record.force, position__m=record.displacement)
    found(settings)
    rows = table(tmp_path / "out" / "frf.csv")
    ratios = [float(row["harmonic_3 [N]"]) / float(row["harmonic_3_error [N]"]) for row in rows]
    np.testing.assert_allclose(ratios[:2], np.sqrt(2), rtol=1e-3)
    expected = np.sqrt(2) * abs(LINEAR.dynamic_stiffness(36.0)) / 9 / abs(LINEAR.dynamic_stiffness(12.0))
    assert ratios[3] == pytest.approx(expected, rel=1e-3)


def test_harmonics_beyond_the_sampling_rate_are_not_told(tmp_path):
    """At 40 Hz a drive of 5.2 Hz has two harmonics; the others are empty cells, which `identify` reads."""
    record = shaken(FOUR[1:3], rate=40.0, periods=30)
    settings = written(tmp_path, BASE, time__s=record.time, force__N=record.force, position__m=record.displacement)
    curves, _, _ = found(settings)
    assert_linear(curves, FOUR[1:3])
    rows = table(tmp_path / "out" / "frf.csv")
    assert [rows[1][f"harmonic_{k} [N]"] != "" for k in range(2, 8)] == [True, False, False, False, False, False]
    assert rows[0]["harmonic_3 [N]"] != ""


def test_up_and_down_have_files_of_their_own_and_universal_ones(tmp_path):
    """Two levels up and down in one file; the universal file says what the other does."""
    both = (*FOUR, 5.2, 3.3, 2.0)
    records = [shaken(both, acceleration=level) for level in (0.5, 2.0)]
    force, position = (np.concatenate([getattr(r, name) for r in records]) for name in ("force", "displacement"))
    settings = written(tmp_path, BASE, time__s=np.arange(force.size) / 500, force__N=force, position__m=position)
    status, out, err = in_process("recordings", settings, "--uff", "--output", tmp_path / "out")
    assert status == 0, err
    assert out.count("up and down: 3 frequencies, 0 of them beyond 3 standard errors") == 2
    for way, frequencies in (("up", both[:4]), ("down", both[4:])):
        curves = read_curves(Source(tmp_path / "out" / f"frf-{way}.csv"))
        assert [curve.label for curve in curves] == ["0.5 m/s2", "2 m/s2"]
        for curve, universal in zip(curves, read_curves(Source(tmp_path / "out" / f"frf-{way}.uff"))):
            assert_linear([curve], frequencies)
            rising = np.argsort(curve.frequency)
            np.testing.assert_allclose(universal.frequency, curve.frequency[rising], rtol=1e-5)
            np.testing.assert_allclose(universal.H, curve.H[rising], rtol=1e-5)
            np.testing.assert_allclose(universal.acceleration, np.median(curve.acceleration), rtol=1e-4)


@pytest.mark.parametrize("periods", [2, 3, 4])
def test_a_force_that_repeats_only_after_several_periods_is_told(tmp_path, periods):
    """3 % of the force at a part of the frequency, in noise; H is that of the rest."""
    settings = read_settings(written(tmp_path, BASE))
    record = shaken([5.2], periods=40)
    peak = np.ptp(record.force) / 2
    slow = 0.03 * peak * np.sin(2 * np.pi * 5.2 / periods * record.time + 1)
    noise = 0.02 * peak * np.random.default_rng(periods).standard_normal(slow.size)
    stretch = Stretch(0.0, record.time[-1], 5.2, 1.0)
    point = evaluate(as_record(record, record.displacement, record.force + noise + slow), stretch, settings)
    assert point.subharmonic == periods
    assert point.status == f"marked: the force repeats only after {periods} periods (3.0 % of the fundamental)"
    assert abs(point.H / LINEAR.receptance(5.2) - 1) < 3 * max(point.magnitude_error, point.phase_error)
    alone = evaluate(as_record(record, record.displacement, record.force + noise), stretch, settings)
    assert alone.subharmonic == 1 and alone.status == "used"


@pytest.mark.parametrize("octaves, way", [(False, (2.0, 8.0)), (True, (8.0, 2.0))])
def test_a_slow_sweep_gives_the_response_within_its_errors(tmp_path, octaves, way):
    """Up in Hz/s, down in octaves a minute. Its rate shows: errors grow with it, and cover what it does."""
    record = swept(*way, 100.0, octaves)
    rate = "octaves = 1.2" if octaves else "rate = 0.06"
    settings = BASE + f"[sweep]\nkind = 'slow'\n{rate}\n"
    columns = {"time__s": record.time, "force__N": record.force, "position__m": record.displacement}
    (curve,), _, _ = found(written(tmp_path, settings, **columns))
    assert curve.frequency.size > 30 and f"# direction: {'down' if octaves else 'up'}" in head(
        tmp_path / "out" / "frf.csv"
    )
    error = np.abs(curve.H / [LINEAR.receptance(f) for f in curve.frequency] - 1)
    settled = slice(3, None)  # it starts from rest
    assert curve.error is not None
    assert np.mean(error[settled] < 1.96 * np.linalg.norm(curve.error, axis=1)[settled]) > 0.9
    assert np.median(error[settled]) < 0.01 and np.median(curve.error[settled]) < 0.01
    wrong = written(tmp_path, settings.replace("1.2", "0.6").replace("0.06", "0.03"), **columns)
    status, _, err = in_process("recordings", wrong, "--output", tmp_path / "other")
    assert status == 1
    assert re.search(r"the sweep goes by -?(0\.06|1\.2)\d* .*, the settings say 0\.(03|6)", err), err


@pytest.mark.parametrize("duration, periods", [(120.0, 10), (240.0, 10), (240.0, 40)])
def test_noise_is_not_taken_for_the_lag_of_a_slow_sweep(tmp_path, duration, periods):
    """The closer points are, the more does noise bend the curve through them: errors stay those that there are."""
    record = swept(2.0, 8.0, duration, octaves=True)
    random = np.random.default_rng(5)
    force = record.force + 0.3 * random.standard_normal(record.force.size)
    settings = BASE + f"[sweep]\nkind = 'slow'\noctaves = {120 / duration}\nperiods = {periods}\n"
    columns = {"time__s": record.time, "force__N": force, "position__m": record.displacement}
    (curve,), _, _ = found(written(tmp_path, settings, **columns))
    settled = slice(3, None)
    off = np.abs(curve.H / [LINEAR.receptance(f) for f in curve.frequency] - 1)[settled]
    assert curve.error is not None
    stated = np.linalg.norm(curve.error, axis=1)[settled]
    assert np.mean(off < 1.96 * stated) > 0.9
    assert 0.7 < np.sqrt(np.mean(stated**2) / np.mean(off**2)) < 2


def as_record(shaker: Shaken, displacement: np.ndarray, force: np.ndarray, steps=(0.0, 0.0)) -> Record:
    def signal(values: np.ndarray, step: float) -> Signal:
        values = step * np.round(values / step) if step else values
        return Signal(values, 0.0, step, np.zeros(values.size, bool))

    motions = {"displacement": signal(displacement, steps[0])}
    parts = [(0, displacement.size)]
    return Record(Path("a.csv"), None, shaker.rate, shaker.time, parts, signal(force, steps[1]), motions, [])


def test_the_stated_errors_are_those_that_there_are(tmp_path):
    """95 % intervals cover 93 to 97 % of 200 points: noise that hangs together, few and many periods, 16-bit steps.

    By each point's own scatter, and by what that of all tells.
    """
    settings = read_settings(written(tmp_path, BASE))
    random = np.random.default_rng(5)
    points, off = [], []
    for number, f in enumerate(np.linspace(1.2, 13, 200)):
        record = shaken([f], rate=250.0, periods=(9, 14, 30)[number % 3] + 0.4)
        noise = random.standard_normal((2, record.time.size + 50))
        for _ in range(number % 2):  # every second one is red
            noise[:, 1:] += 0.7 * noise[:, :-1]
        noise = noise[:, 50:]
        peak = 1.0 / (2 * np.pi * f) ** 2
        stained = as_record(
            record, record.displacement + 0.05 * peak * noise[0], record.force + 0.2 * noise[1], (peak / 400, 0.02)
        )
        point = evaluate(stained, Stretch(0.0, record.time[-1], f * 1.0005, peak), settings)
        points.append(point)
        error = point.H / LINEAR.receptance(f) - 1
        off.append(np.abs([error.real, error.imag]))
    for each in (points, moderated(points)):
        errors = np.array([point.errors for point in each])
        assert 0.93 <= np.mean(np.array(off) < 1.96 * errors) <= 0.97
        assert np.median(errors) < 0.02


def test_the_error_of_a_mean_knows_that_few_values_tell_little():
    """For white noise +- 1.96 cover 95 % whatever the number of values; a slow wave in them makes it larger."""
    random = np.random.default_rng(1)
    for count in (5, 8, 20, 100):
        values = random.standard_normal((1500, count))
        covered = np.mean([abs(row.mean()) < 1.96 * error_of_mean(row) for row in values])
        assert covered == pytest.approx(0.95, abs=0.02)
    assert np.isnan(error_of_mean(np.ones(4)))
    slow = np.sin(np.linspace(0, 3, 100))
    assert error_of_mean(slow) > 2 * slow.std() / 10


def test_variances_move_towards_what_all_points_tell():
    """True ones are s0^2 d0 / chi-squared(d0), drawn by SciPy: what is found is their mean, given what was seen."""
    d, d0, usual = 6.0, 9.0, 2.0
    true = stats.invgamma(d0 / 2, scale=d0 * usual / 2).rvs(40_000, random_state=1)
    seen = true * stats.chi2(d).rvs(true.size, random_state=2) / d
    found, freedom = shrunk(seen, np.full(true.size, d))
    np.testing.assert_allclose(freedom, d0 + d, rtol=0.05)
    for low, high in itertools.pairwise(np.quantile(seen, [0, 0.1, 0.5, 0.9, 1])):
        part = (low <= seen) & (seen < high)
        assert students(found, freedom)[part].mean() == pytest.approx(true[part].mean(), rel=0.05)


def test_variances_that_scatter_by_chance_alone_are_one():
    random, freedom = np.random.default_rng(3), np.array([4.0, 6.0, 11.0] * 6)
    seen = stats.chi2(freedom).ppf(random.permutation(np.linspace(0.1, 0.9, 18))) / freedom
    found, told = shrunk(seen, freedom)
    np.testing.assert_allclose(found, freedom @ seen / freedom.sum())
    np.testing.assert_array_equal(told, freedom.sum())


def test_a_mean_that_weighs_points_by_their_errors_is_as_good_as_it_says():
    """17 points of 20 periods. By its own few numbers each point's weight makes the mean a fifth worse than it says."""
    random, pulls = np.random.default_rng(4), {"own": [], "all": []}
    for _ in range(300):
        size = random.uniform(0.5, 2, 17)  # known, as white noise is
        values = size[:, None] * random.standard_normal((17, 20))
        variance, freedom = np.array([variance_of_mean(each) for each in values]).T
        shares = shrunk(variance / size**2, freedom)
        for name, error in ("own", students(variance, freedom)), ("all", size**2 * students(*shares)):
            pulls[name].append(values.mean(1) @ (1 / error) / np.sqrt(np.sum(1 / error)))
    assert np.std(pulls["own"]) > 1.12
    assert np.std(pulls["all"]) == pytest.approx(1, abs=0.08)


def test_steps_that_are_alike_in_every_period_are_no_certainty(tmp_path):
    """Without noise and with a whole number of values in a period the scatter is 0; the converter's steps are not."""
    settings = read_settings(written(tmp_path, BASE))
    pulls = []
    for f in (2.0, 4.0, 5.0, 6.25, 8.0, 10.0, 12.5):
        record = shaken([f], rate=500.0, periods=20)
        peak = 1.0 / (2 * np.pi * f) ** 2
        stained = as_record(record, record.displacement, record.force, (peak / 20, 0.3))
        point = evaluate(stained, Stretch(0.0, record.time[-1], f, peak), settings)
        error = point.H / LINEAR.receptance(f) - 1
        pulls += [error.real / point.magnitude_error, error.imag / point.phase_error]
    assert 0.3 < np.sqrt(np.mean(np.square(pulls))) < 1.5


def test_a_point_has_no_less_in_common_than_its_neighbours():
    """Within 0.2 in the logarithm of the frequency, of its own level alone."""
    frequency, common = (2.0, 3.0, 3.5, 4.0, 9.0, 3.6), (0.004, 0.001, 0.0, 0.003, 0.002, 0.01)
    points = [
        Point("a", "1" if i < 5 else "2", 0, 1, f, 9, H=1e-4j, acceleration=1.0 + (i == 5), harmonics=c)
        for i, (f, c) in enumerate(zip(frequency, common))
    ]
    one, other = grouped(points, "up")
    assert [point.common for point in one.points] == [0.004, 0.001, 0.003, 0.003, 0.002]
    assert [point.common for point in other.points] == [0.01]


def test_the_virtual_bench_gives_what_the_bench_in_the_fmu_has(tmp_path):
    """All its faults together; the truth is the FMU's own, which knows neither samples nor fits."""
    example = tomllib.loads((ROOT / "resources/examples/recordings.toml").read_text("utf-8"))
    frequencies = np.array([3.0, 4.5, 5.5, 6.5, 8.0, 11.0])
    with Fmu() as fmu, fmu.instances() as (instance,):
        columns = recorded(instance, 1.0, frequencies, np.random.default_rng(2), dropout=2)
        write_text(tmp_path / "level-1.csv", columns, digits=7)
        settings = Settings.model_validate({**example, "recording": [{"file": "level-1.csv"}]}, context=tmp_path)
        record = read_record(settings.recording[0], settings)
        points, said = holds_in(record, settings)
        bench, pulls = FmuBench(instance, {"solver.step": 0.0005}), []
        for point in points:
            bench.start(point.frequency, point.acceleration)
            bench.run(100)
            error = point.H / bench.H - 1
            pulls += [error.real / point.magnitude_error, error.imag / point.phase_error]
    np.testing.assert_allclose([point.frequency for point in points], frequencies, rtol=1e-3)
    assert not said and not any(point.left_out for point in points)
    assert [point.found - point.periods for point in points] == pytest.approx([2, 2, 4, 2, 2, 2], abs=1)
    assert max(map(abs, pulls)) < 3.5 and np.sqrt(np.mean(np.square(pulls))) > 0.4
    assert all(abs(point.agreement - 1) < 0.01 for point in points)
