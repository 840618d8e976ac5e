"""What `zspring identify` reads, measured responses, static tests and settings, and what it refuses."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from linear import PUBLISHED, LinearPantograph
from zspring.bench.curves import Source, in_band, sign_warning
from zspring.bench.measured import read_curves
from zspring.bench.static_test import read_static_test
from zspring.errors import ZSpringError
from zspring.fmu import Fmu
from zspring.identify.settings import read_settings

TABLE = dict(PUBLISHED["DSA-250"])
LINEAR = LinearPantograph(head=TABLE.pop("k1"), **TABLE)
FREQUENCY = np.array([1.0, 2.5, 5.0, 12.0])
OMEGA = 2 * np.pi * FREQUENCY
H = np.array([LINEAR.receptance(f) for f in FREQUENCY])

KINDS = {
    "m/N": H,
    "mm/N": 1e3 * H,
    "N/mm": 1e-3 / H,
    "(m/s)/N": 1j * OMEGA * H,
    "N/(m/s)": 1 / (1j * OMEGA * H),
    "(m/s2)/N": -(OMEGA**2) * H,
    "1/kg": -(OMEGA**2) * H,
    "kg": -1 / (OMEGA**2 * H),
}


def write(path: Path, columns: str, *values: np.ndarray) -> Path:
    rows = [",".join(map(repr, map(float, row))) for row in zip(*values)]
    path.write_text("\n".join(["# from a bench", columns, *rows]) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("unit", KINDS)
def test_every_kind_of_response_gives_the_same_receptance(tmp_path, unit):
    value, steps = KINDS[unit], np.full(FREQUENCY.shape, 0.5)
    cartesian = write(
        tmp_path / "a.csv",
        f"amplitude [m/s2],imaginary [{unit}],frequency [Hz],real [{unit}]",
        steps,
        value.imag,
        FREQUENCY,
        value.real,
    )
    polar = write(
        tmp_path / "b.csv",
        f"frequency [Hz],coherence,magnitude [{unit}],phase [deg]",
        FREQUENCY,
        np.ones(4),
        np.abs(value),
        np.degrees(np.angle(value)),
    )
    for source in (Source(cartesian), Source(polar, amplitude=0.5)):
        (curve,) = read_curves(source)
        np.testing.assert_allclose(curve.H, H, rtol=1e-12)
        np.testing.assert_allclose(curve.acceleration, 0.5)
        assert curve.label == "0.5 m/s2"


def test_amplitudes_become_curves_and_displacements_become_accelerations(tmp_path):
    path = write(
        tmp_path / "a.csv",
        "frequency [Hz],amplitude [mm],real [m/N],imaginary [m/N]",
        np.tile(FREQUENCY, 2),
        np.repeat([2.0, 5.0], 4),
        np.tile(H.real, 2),
        np.tile(H.imag, 2),
    )
    small, large = read_curves(Source(path))
    np.testing.assert_allclose(small.acceleration, 2e-3 * OMEGA**2)
    np.testing.assert_allclose(large.acceleration, 5e-3 * OMEGA**2)
    assert (small.label, large.label) == ("2 mm", "5 mm")
    for band in (2.0, 6.0), (2.5, 5.0), (2.502, 4.998):  # its ends belong to it, a thousandth either way
        (kept, _) = in_band([small, large], band)
        np.testing.assert_array_equal(kept.frequency, [2.5, 5.0])
        np.testing.assert_array_equal(kept.H, H[1:3])
        np.testing.assert_allclose(kept.acceleration, 2e-3 * OMEGA[1:3] ** 2)
    with pytest.raises(ZSpringError, match="band 6 to 7 Hz: no data with 2 mm"):
        in_band([small], (6.0, 7.0))


def test_a_contact_force_turns_the_sign_and_a_wrong_one_is_noticed(tmp_path):
    path = write(tmp_path / "a.csv", "frequency [Hz],real [m/N],imaginary [m/N]", FREQUENCY, -H.real, -H.imag)
    (wrong,) = read_curves(Source(path, amplitude=1.0))
    (right,) = read_curves(Source(path, amplitude=1.0, force="contact"))
    np.testing.assert_allclose(right.H, H, rtol=1e-12)
    assert "contact" in sign_warning([wrong])
    assert sign_warning([right]) is None


def test_a_sign_is_doubted_where_most_points_give_energy_out(tmp_path):
    """Two of four may be noise, three of four are not; counted over all curves."""
    curves = {}
    for wrong in range(5):
        imaginary = np.where(np.arange(4) < wrong, 1, -1) * np.abs(H.imag)
        path = write(tmp_path / "a.csv", "frequency [Hz],real [m/N],imaginary [m/N]", FREQUENCY, H.real, imaginary)
        (curves[wrong],) = read_curves(Source(path, amplitude=1.0))
    assert [sign_warning([curves[n]]) is None for n in range(5)] == [True, True, True, False, False]
    assert sign_warning([curves[4], curves[0]]) is None
    assert "at 7 of 8 points" in sign_warning([curves[4], curves[3]])


@pytest.mark.parametrize("status, kept", [("settled", 2), ("not settled", 2), ("left out", 1), ("failed: x", 1)])
def test_points_that_a_file_marks_as_not_measured_are_passed_over(tmp_path, status, kept):
    """Their cells may be empty."""
    cells = ",," if kept == 1 else ",1e-3,-1e-4"
    lines = "frequency [Hz],amplitude [m/s2],status,H_re [m/N],H_im [m/N]", f"1,0.5,{status}{cells}"
    (tmp_path / "frf.csv").write_text("\n".join([*lines, "2,0.5,settled,2e-3,-1e-4\n"]))
    (curve,) = read_curves(Source(tmp_path / "frf.csv"))
    assert curve.frequency.size == kept and curve.H[-1] == pytest.approx(2e-3 - 1e-4j)


def test_the_fixture_behind_the_load_cell_is_taken_off(tmp_path):
    """The load cell sees a pantograph whose head is heavier by the fixture."""
    heavier = dataclasses.replace(LINEAR, m1=LINEAR.m1 + 1.3)
    seen = np.array([heavier.receptance(f) for f in FREQUENCY])
    path = write(tmp_path / "a.csv", "frequency [Hz],real [m/N],imaginary [m/N]", FREQUENCY, seen.real, seen.imag)
    (curve,) = read_curves(Source(path, amplitude=1.0, fixture_mass=1.3))
    np.testing.assert_allclose(curve.H, H, rtol=1e-10)


GOOD = "frequency [Hz],amplitude [m/s2],real [m/N],imaginary [m/N]\n1,0.5,1e-3,-1e-4\n2,0.5,2e-3,-1e-4\n"


@pytest.mark.parametrize(
    "text, complaint",
    [
        (GOOD.replace("real [m/N]", "real"), "column 'real' needs its unit"),
        (GOOD.replace("m/N", "furlong"), r"column 'real': unit \[furlong\]: must be one of m/N"),
        (GOOD.replace("imaginary [m/N]", "imaginary [mm/N]"), r"column 'imaginary': unit \[mm/N\]: must be m/N"),
        (GOOD.replace("m/s2", "rpm"), r"column 'amplitude': unit \[rpm\]"),
        (GOOD.replace("amplitude", "level"), "no column 'amplitude', and none given"),
        (GOOD.replace("frequency", "f"), "no column 'frequency'"),
        (GOOD.replace("imaginary", "im"), "no column 'imaginary'"),
        (GOOD.replace("\n1,", "\n-1,"), "line 2: frequency = -1: must be positive"),
        (GOOD.replace("2e-3", "nan"), "line 3: real = 'nan': must be a finite number"),
        (GOOD.replace("2,0.5", "2,"), "line 3: amplitude = '': must be a finite number"),
        (GOOD.replace("2e-3,-1e-4", "0,0"), "line 3: the response is 0"),
        (GOOD + "3,0.5,1e-3\n", "line 4: 3 values for 4 columns"),
        (GOOD.replace("real [m/N]", "frequency [Hz]"), "two columns 'frequency'"),
        (GOOD.splitlines()[0] + "\n", "no row with a measured point"),
    ],
)
def test_a_bad_measurement_is_refused_with_file_line_and_column(tmp_path, text, complaint):
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises(ZSpringError, match=f"bad.csv.*{complaint}") as error:
        read_curves(Source(path))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "text, complaint",
    [
        ("displacement [mm],force\n0,1\n1,2\n2,3\n", r"column 'force' needs its unit, as in 'force \[N\]'"),
        ("displacement [mm]\n0\n1\n2\n", "no column 'force'"),
        ("displacement [mm],force [N]\n0,1\n1,x\n2,3\n", "line 3: force = 'x': must be a finite number"),
        ("displacement [mm],force [N],time [s]\n0,1,0\n1,2,1\n2,3,1\n", "line 4: time must increase"),
    ],
)
def test_a_bad_static_test_is_refused_with_file_line_and_column(tmp_path, text, complaint):
    path = tmp_path / "static.csv"
    path.write_text(text)
    with pytest.raises(ZSpringError, match=f"static.csv.*{complaint}"):
        read_static_test(path, 0.005)


def static_file(path: Path, columns: str, *values) -> Path:
    return write(path, columns, *map(np.asarray, values))


def test_a_static_test_without_time_moves_with_the_given_speed(tmp_path):
    """The way to the first point begins at displacement 0; a pause takes a millisecond."""
    path = static_file(tmp_path / "a.csv", "force [kN],displacement [mm]", [0.01, 0.02, 0.02, -0.03], [2, -4, -4, 1])
    test = read_static_test(path, 0.005)
    np.testing.assert_allclose(test.displacement, [2e-3, -4e-3, -4e-3, 1e-3])
    np.testing.assert_allclose(test.force, [10, 20, 20, -30])
    np.testing.assert_allclose(test.duration, [0.4, 1.2, 1e-3, 1.0])


def test_times_of_a_static_test_may_be_uneven_and_begin_anywhere(tmp_path):
    """Only the way to the first point, which no time tells, takes what the speed makes of it."""
    columns = "displacement [m],time [s],force [N]"
    path = static_file(tmp_path / "a.csv", columns, [-0.003, 0.001, 0.002, 0.004], [7, 7.5, 9.5, 9.625], [1, 2, 3, 4])
    test = read_static_test(path, 0.01)
    np.testing.assert_allclose(test.displacement, [-0.003, 0.001, 0.002, 0.004])
    np.testing.assert_allclose(test.force, [1, 2, 3, 4])
    np.testing.assert_allclose(test.duration, [0.3, 0.5, 2.0, 0.125])


def test_a_damper_in_a_static_test_feels_the_speed_of_each_way(tmp_path):
    """A linear head on a blocked frame: the force on it rises by k1 z and by c1 times the speed to each point."""
    times, z = np.array([0.0, 0.4, 1.0, 1.2, 2.2]), np.array([1.0, 3.0, -2.0, 4.0, 2.0])
    path = static_file(tmp_path / "a.csv", "time [s],displacement [mm],force [N]", times, z, z)
    test = read_static_test(path, 0.005)
    stiffness, damper = 9000.0, 2000.0
    speeds = 1e-3 * np.array([5.0, 5.0, -5 / 0.6, 30.0, -2.0])
    with Fmu() as model, model.instances() as (instance,):
        names = ["suspension=Linear", f"k1={stiffness}", f"c1={damper}", "static_force=100"]
        found = test.simulated(instance, model.variables.parse_assignments(names))
    np.testing.assert_allclose(found, stiffness * 1e-3 * z + damper * speeds - 100, atol=0.05)


@pytest.mark.parametrize(
    "text, complaint",
    [
        ("displacement [mm],force [N]\n0,1\n1,2\n", "needs at least three rows"),
        (
            "displacement [mm],force [N],time [kg]\n0,1,0\n1,2,1\n2,3,2\n",
            r"column 'time': unit \[kg\]: must be one of s, ms",
        ),
        ("displacement [mm],force [N],time [s]\n0,1,0\n1,2,0\n2,3,1\n", "line 3: time must increase"),
    ],
)
def test_a_static_test_that_is_short_or_stands_still_is_refused(tmp_path, text, complaint):
    path = tmp_path / "static.csv"
    path.write_text(text)
    with pytest.raises(ZSpringError, match=f"static.csv.*{complaint}"):
        read_static_test(path, 0.005)


SETTINGS = """
model = "zspring"
[[measurement]]
file = "bench.csv"
[free]
zspring.k = { start = 15000, min = 5000, max = 40000 }
[tied]
zspring.J2 = { to = "zspring.J1", factor = 2 }
[fixed]
m1 = 7.5
"""
HEAD = "# static_force: 120 N\n# friction: Coulomb\n"


def settings_file(folder: Path, text: str, head: str = HEAD) -> Path:
    """Beside the measurement that they name."""
    (folder / "bench.csv").write_text(head + GOOD)
    path = folder / "fit.toml"
    path.write_text(text)
    return path


def test_settings_give_the_parameters_of_every_x(tmp_path):
    path = settings_file(tmp_path, SETTINGS)
    with Fmu() as model:
        settings = read_settings(path, model, "dsa-380-zspring", ("friction=Coulomb",))
        inertia = float(model.variables["zspring.J1"].start)
    for x, stiffness in ((0.0, 5000.0), (1.0, 40000.0), (0.2, 12000.0)):
        values = settings.parameters([x])
        assert values["zspring.k"] == pytest.approx(stiffness, rel=1e-15)
        assert (values["m1"], values["friction"]) == (7.5, 2)
        assert values["zspring.J2"] == 2 * inertia
        assert values["solver.step"] == 5e-4  # unless given: at 2 ms the solver's own error would be fitted
    (free,) = settings.free.values()
    assert free.value(free.x(free.start)) == pytest.approx(free.start, rel=1e-12)


@pytest.mark.parametrize(
    "old, new, complaint",
    [
        ("zspring.k =", "zspring.q =", "no parameter 'zspring.q'"),
        ("start = 15000", "start = 1", "free.zspring.k: start = 1 must lie in 5000 .. 40000"),
        ("min = 5000", "min = 50000", "free.zspring.k: min = 50000 must be below max = 40000"),
        ("min = 5000", "min = -1", "free.zspring.k: min = -1: the FMU allows min 0.001"),
        (
            "zspring.k = ",
            "solver.alpha = { start = -0.1, min = -0.2, max = 0.1 }\n#",
            "max = 0.1: the FMU allows max 0",
        ),
        ("min = 5000, ", "", "free.zspring.k: min is missing"),
        ("max = 40000", 'max = "big"', "free.zspring.k: max = 'big': must be a number"),
        ('"zspring"', '"spring"', 'model = \'spring\': must be "linear" or "zspring"'),
        ('"zspring"', '"linear"', "free.zspring.k: the linear model has only m1"),
        ("m1 = 7.5", "zspring.k = 7", "zspring.k is free, so it cannot be fixed, too"),
        ("m1 = 7.5", "m9 = 7", "no parameter 'm9'"),
        ("m1 = 7.5", "bench.frequency = 7", "the measurement itself sets"),
        ("[fixed]", "[fixxed]", "unknown key 'fixxed'; did you mean fixed"),
        ("[[measurement]]", "[[measurements]]", "measurement: needs at least one"),
        ('file = "bench.csv"', 'file = "bench.csv"\nforce = "up"', "measurement 1: force = 'up'"),
        ('model = "zspring"', 'model = "zspring"\nband = [5, 2]', "band = .*: must be .*frequency in Hz"),
        ('model = "zspring"', 'model = "zspring"\nparameters = "none.ssv"', "none.ssv: no such file"),
        ('to = "zspring.J1"', 'to = "friction"', "tied.zspring.J2: friction is no Real parameter"),
        ("[free]", "[free", "no TOML"),
        ("start = 15000", "start = true", "free.zspring.k: start = True: must be a number"),
        ("max = 40000", "max = inf", "free.zspring.k: max = inf: must be a finite number"),
        ("max = 40000", "max = 40000, maximum = 1", "free.zspring.k: unknown key 'maximum'; did you mean max"),
        ('{ to = "zspring.J1", factor = 2 }', "2", "tied.zspring.J2: to = 2: must be a text"),
        ("factor = 2", "factor = nan", "tied.zspring.J2: factor = nan: must be a finite number"),
        ("[[measurement]]", "[measurement]", r"measurement = {.*}: must be tables \[\[measurement\]\]"),
        ('"bench.csv"', '"bench.csv"\namplitude = 0', "measurement 1: amplitude = 0: must be a number above 0"),
        ('"bench.csv"', '"bench.csv"\nfixture = 1', "measurement 1: unknown key 'fixture'; did you mean fixture_mass"),
        ("[fixed]", "[search]\nsample = 3\n[fixed]", "search: unknown key 'sample'; did you mean samples"),
        ("[fixed]", "[search]\nseed = true\n[fixed]", "search: seed = True: must be a whole number"),
        ("[fixed]", "[search]\npoints = 2.0\n[fixed]", "search: points = 2.0: must be a whole number"),
        ("[fixed]", "[search]\npoints = 0\n[fixed]", "search: points = 0: must be a whole number of at least 1"),
        ("[tied]", "[static]\nfile = 1\n[tied]", "static: file = 1: must be a text"),
        ('model = "zspring"', 'model = "zspring"\nsearch = 3', "search = 3: must be a table"),
        (
            "[free]",
            '[[measurement]]\nfile = "./bench.csv"\n[free]',
            "measurement: bench.csv is named twice: its points",
        ),
        ('model = "zspring"', 'model = "zspring"\nband = [0, nan]', "band = .0, nan.: must be .*frequency in Hz"),
    ],
)
def test_bad_settings_are_refused_with_file_and_key(tmp_path, old, new, complaint):
    path = settings_file(tmp_path, SETTINGS.replace(old, new, 1))
    with Fmu() as model, pytest.raises(ZSpringError, match=f"fit.toml: .*{complaint}") as error:
        read_settings(path, model)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "head, fixed, found",
    [
        (HEAD, "", (120, 2, "file")),
        ("# Static force: 0.11 kN\n# friction: regularized\n# direction: down\n", "", (110, 1, "down")),
        ("", 'static_force = 70\nfriction = "Coulomb"', (70, 2, "file")),
        ("# static_force: 70\n", 'static_force = 70.0\nfriction = "Free"', (70, 4, "file")),
    ],
)
def test_static_force_and_friction_are_the_bench_s_and_not_the_set_s(tmp_path, head, fixed, found):
    """The set says 120 N and Regularized."""
    path = settings_file(tmp_path, f'parameters = "dsa-380-zspring"\n{SETTINGS}{fixed}\n', head)
    with Fmu() as model:
        settings = read_settings(path, model)
    assert (settings.fixed["static_force"], settings.fixed["friction"], settings.direction) == found


@pytest.mark.parametrize(
    "head, fixed, complaint",
    [
        (
            "",
            "",
            "static_force of the bench is not known: neither does the head of bench.csv say '# static_force: 110 N'",
        ),
        ("# static_force: 120 N\n", "", "friction of the bench is not known: .*'# friction: Coulomb'"),
        (HEAD, "static_force = 119", "static_force: .*bench.csv says 120 N, the settings 119 N"),
        (HEAD, 'friction = "Regularized"', "friction: .*bench.csv says Coulomb, the settings Regularized"),
        ("# static_force: 120 kg\n", "", r"bench.csv: static_force = 120 kg: unit \[kg\]: must be one of N"),
        ("# static_force: much\n", "", "bench.csv: static_force = 'much': must be a number"),
        (HEAD + "# direction: sideways\n", "", "bench.csv: direction = 'sideways': must be one of up, down, rest"),
    ],
)
def test_a_bench_that_nobody_knows_or_two_know_otherwise_is_refused(tmp_path, head, fixed, complaint):
    path = settings_file(tmp_path, f"{SETTINGS}{fixed}\n", head)
    with Fmu() as model, pytest.raises(ZSpringError, match=complaint) as error:
        read_settings(path, model)
    assert "\n" not in str(error.value)


def test_two_files_of_one_fit_agree(tmp_path):
    path = settings_file(tmp_path, SETTINGS.replace("[free]", '[[measurement]]\nfile = "b.csv"\n[free]', 1))
    (tmp_path / "b.csv").write_text("# static_force: 70 N\n" + GOOD)
    with Fmu() as model, pytest.raises(ZSpringError, match=r"b.csv: static_force = 70 N: .*bench.csv says another"):
        read_settings(path, model)


def test_what_one_file_says_of_the_bench_for_another_is_told(tmp_path, capsys):
    path = settings_file(tmp_path, SETTINGS.replace("[free]", '[[measurement]]\nfile = "b.csv"\n[free]', 1))
    (tmp_path / "b.csv").write_text("# static_force: 120 N\n" + GOOD)
    with Fmu() as model:
        read_settings(path, model)
    assert capsys.readouterr().err == "b.csv does not say friction: taken as bench.csv says\n"


def test_the_direction_may_come_from_the_settings(tmp_path):
    for head, complaint in ((HEAD, None), (HEAD + "# direction: up\n", "says up, the settings down")):
        path = settings_file(tmp_path, f'direction = "down"\n{SETTINGS}', head)
        with Fmu() as model:
            if complaint:
                with pytest.raises(ZSpringError, match=complaint):
                    read_settings(path, model)
            else:
                assert read_settings(path, model).direction == "down"


def test_a_static_test_may_have_a_contact_force_and_a_wrong_sign_is_said(tmp_path):
    """The suspension pushes back against the way it is moved: the force on the head rises with it."""
    columns, z = "displacement [mm],force [N]", [0.0, 5.0, 10.0, 5.0]
    right = static_file(tmp_path / "a.csv", columns, z, [-120, -90, -60, -100])
    assert read_static_test(right, 0.005).sign_warning is None
    pressing = static_file(tmp_path / "b.csv", columns, z, [120, 90, 60, 100])
    assert "contact force" in read_static_test(pressing, 0.005).sign_warning
    turned = read_static_test(pressing, 0.005, "contact")
    np.testing.assert_array_equal(turned.force, [-120, -90, -60, -100])
    assert turned.sign_warning is None
