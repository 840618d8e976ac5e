"""Studies over the coupled line: each case is the run that `couple` makes, and no case goes missing."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from commands import PNG, head, in_process, table, zspring
from zspring.errors import ZSpringError
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.study.coupled import CoupledQuantity
from zspring.study.design import make_cases
from zspring.study.settings import StudySettings, read_study

SHORT = """
design = "grid"
[set]
catenary.line.spans = 5
"""
Pair = tuple[Fmu, Fmu]


@pytest.fixture(scope="module")
def fmus() -> Iterator[Pair]:
    with Fmu() as pantograph, Fmu(installed_fmu(CATENARY)) as catenary:
        yield pantograph, catenary


def study_of(text: str, fmus: Pair, folder: Path) -> StudySettings:
    (folder / "study.toml").write_text(text)
    return read_study(folder / "study.toml", *fmus)


def measured(text: str, fmus: Pair, folder: Path) -> list[dict]:
    """Values of all cases by column, made in this process."""
    settings = study_of(text, fmus, folder)
    (quantity,) = settings.quantities
    assert isinstance(quantity, CoupledQuantity)
    return [quantity.measure(*fmus, settings.parameters_of(case))[0] for case in make_cases(settings)]


def test_a_case_is_the_run_that_couple_makes(tmp_path):
    """Its figures by a filter of this test's own; the other case, whose start is not on the line, tells so."""
    text = f'{SHORT}[vary]\ncouple.start = [40, 4000]\n[couple]\nspeed = 280\nstop = 260\nline = "benchmark-2015"\n'
    (tmp_path / "study.toml").write_text(f"{text}spans = [3, 4]\n")
    out, err = zspring(tmp_path, "study", "study.toml", "--output", "out", "--workers", "2", "--parquet")
    good, bad = table(tmp_path / "out/study.csv")
    options = ["--line", "benchmark-2015", "--set-line", "line.spans=5", "--start", "40", "--stop", "260"]
    status, told, _ = in_process("couple", *options, "--speed", "280", "--output", tmp_path / "run", "--spans", "3:4")
    assert status == 0
    rows = table(tmp_path / "run/line.csv")
    position, force, height = (
        np.array([float(row[name]) for row in rows])
        for name in ("position 1 [m]", "contact force 1 [N]", "wire height 1 [m]")
    )
    filtered = sosfiltfilt(butter(4, 20, fs=1000, output="sos"), force, padlen=1000)
    inside = (position >= 110) & (position < 220)
    lifted = max(float(row[f"support uplift at {x} m [m]"]) for row in rows for x in (110, 165, 220))
    expected = {
        "mean_force [N]": filtered[inside].mean(),
        "standard_deviation [N]": filtered[inside].std(),
        "actual_minimum [N]": filtered[inside].min(),
        "contact_point_range [mm]": 1e3 * np.ptp(height[inside]),
        "support_uplift [mm]": 1e3 * lifted,
        "loss_of_contact [%]": 100 * np.mean(force[inside] <= 0),
    }
    for name, value in expected.items():
        assert float(good[name]) == pytest.approx(value, rel=1e-7, abs=1e-9), name
    assert good["status"] == "ok" and good["couple.start [m]"] == "40"
    assert (good["first_span [1]"], good["last_span [1]"], good["uplift_force [N]"]) == ("3", "4", "0.0")
    assert f"{float(good['mean_force [N]']):.1f}" in told
    assert bad["status"] == "failed: start = 4000 m: must be in 0 .. 275 m" and bad["mean_force [N]"] == ""
    assert f"case 1: {bad['status']}" in err
    told_at_head = head(tmp_path / "out/study.csv")
    assert {"# couple speed: 280", "# catenary line.spans: 5", "# catenary line.span: 55 m"} <= set(told_at_head)
    assert not any("pantograph[1].start" in line or "exchange" in line for line in told_at_head)
    assert (tmp_path / "out/distribution.png").read_bytes().startswith(PNG)
    assert out.splitlines()[0] in (tmp_path / "out/study.log").read_text()

    import pyarrow.parquet

    parquet = pyarrow.parquet.read_table(tmp_path / "out/study.parquet")
    assert parquet["mean_force [N]"].to_pylist() == [float(good["mean_force [N]"]), None]
    assert "from 217.9 m on forces are under the influence of the line's far end" in good["remarks"]
    assert f"1 case: {good['remarks']}" in err and parquet["remarks"].to_pylist() == [good["remarks"], ""]
    assert parquet["couple.start [m]"].to_pylist() == [40, 4000]


def test_a_file_has_the_same_bytes_by_one_two_and_four_workers(tmp_path):
    text = f"{SHORT}[vary]\ncouple.speed = {{ from = 240, to = 300, count = 6 }}\n[couple]\nspans = [3, 3]\n"
    (tmp_path / "study.toml").write_text(text)
    for workers in "1", "2", "4":
        zspring(tmp_path, "study", "study.toml", "--output", f"by{workers}", "--workers", workers)
    first, *others = ((tmp_path / f"by{workers}/study.csv").read_bytes() for workers in (1, 2, 4))
    assert len(table(tmp_path / "by1/study.csv")) == 6 and others == [first, first]


def test_a_mean_force_is_met_by_runs_and_a_law_by_statics(fmus, tmp_path):
    """0.00097 v^2 + 70 N at v km/h; without a spring to the base the mean then is near it."""
    text = f"{SHORT}static_force = 90\n[vary]\ncouple.speed = [200, 280]\n[couple]\nspans = [3, 3]\n"
    aimed = measured(f'{text}mean_force = "AC"\n', fmus, tmp_path)
    by_law = measured(f'{text}uplift_law = "AC"\n', fmus, tmp_path)
    for speed, met, near in zip((200, 280), aimed, by_law):
        target = 0.00097 * speed**2 + 70
        assert met["mean_force [N]"] == pytest.approx(target, abs=0.1)
        assert near["uplift_force [N]"] == pytest.approx(target - 90, abs=1e-12)
        assert 0.1 < abs(near["mean_force [N]"] - target) < 5


def test_a_second_pantograph_has_its_own_columns(fmus, tmp_path):
    """The leading one of two is as it is alone, but for the waves that the other one sends along."""
    text = f"{SHORT}[vary]\ncouple.pantographs = [1, 2]\n[couple]\nstart = 80\nspacing = 60\nspans = [3, 3]\n"
    alone, two = measured(f'{text}values = ["mean_force", "standard_deviation"]\n', fmus, tmp_path)
    assert list(alone) == ["mean_force 1 [N]", "standard_deviation 1 [N]", *list(alone)[2:]]
    assert not any(" 2 [" in name for name in alone)
    assert two["mean_force 2 [N]"] == pytest.approx(two["mean_force 1 [N]"], abs=8)
    assert two["standard_deviation 1 [N]"] == pytest.approx(alone["standard_deviation 1 [N]"], rel=0.1)
    assert two["standard_deviation 1 [N]"] != alone["standard_deviation 1 [N]"]


def test_the_compared_get_the_same_cases_and_each_its_own_parameters(fmus, tmp_path):
    """A set of its own stands in for the usual one; [set] counts for all that do not say otherwise."""
    text = f'parameters = "dsa-380-zspring"\n{SHORT}static_force = 100\n[vary]\ncouple.speed = [200, 250]\n[couple]\n'
    text += '[compare]\n"as it is" = {}\nlocked = { suspension = "LinearLocked" }\n'
    text += '"DSA 250" = { parameters = "dsa-250", static_force = 90 }\n'
    settings = study_of(text, fmus, tmp_path)
    cases = make_cases(settings)
    assert [(case["couple.speed"], case["compare"]) for case in cases] == [
        (v, i) for v in (200, 250) for i in (1, 2, 3)
    ]
    own, locked, other = (settings.parameters_of(case) for case in cases[:3])
    assert "suspension" not in other or other["suspension"] != own["suspension"]
    assert {**own, "suspension": locked["suspension"]} == locked and own != locked
    assert (own["static_force"], other["static_force"]) == (100, 90)
    assert other["m1"] == 7.51 and other["couple.speed"] == 200 and other["catenary.line.spans"] == 5


def test_draws_of_an_identification_are_cases_of_runs(fmus, tmp_path):
    (tmp_path / "draws.csv").write_text("zspring.Mf [N.m],zspring.k [N/mm]\n0.2,12\n0.3,13\n0.4,14\n")
    settings = study_of('design = "list"\ndraws = "draws.csv"\n[couple]\nspeed = 200\n', fmus, tmp_path)
    given = [settings.parameters_of(case) for case in make_cases(settings)]
    assert [(each["zspring.Mf"], each["zspring.k"]) for each in given] == [(0.2, 12000), (0.3, 13000), (0.4, 14000)]
    assert all(each["couple.speed"] == 200 for each in given)


def test_what_a_result_must_not_be_read_without_is_told(fmus, tmp_path):
    text = f"{SHORT}[vary]\ncouple.speed = [320, 200]\n[couple]\nspans = [3, 4]\n"
    fast, slow = (values["remarks"] for values in measured(text, fmus, tmp_path))
    assert "0.73 of the contact wire's wave speed" in fast and "far end" not in fast
    assert "pantograph 1: what is evaluated goes to 240 m, but from 198.7 m on" in slow and "wave speed" not in slow
    (early,) = measured(f"{SHORT}[vary]\ncouple.speed = [250]\n[couple]\nstart = 70\nspans = [3, 3]\n", fmus, tmp_path)
    assert early["remarks"] == "pantograph 1: what is evaluated begins at 120 m, but the start-up takes until 130 m"


@pytest.mark.parametrize(
    "text, told",
    [
        ("[vary]\ncouple.speed = [0, -1]\n[couple]", r"\[vary\] couple.speed = -1 km/h: must be at least 0"),
        ("[vary]\ncouple.sped = [200]\n[couple]", r"'couple.sped' in the FMU; did you mean couple.speed"),
        ("[vary]\nline.span = [50]\n[couple]", "no parameter 'line.span' in the FMU; did you mean catenary.line.span"),
        ("[vary]\ncouple.speed = [200]\n[static]\namplitudes = [0.01]", "no parameter 'couple.speed' in the FMU"),
        ("[vary]\ncatenary.exchange = [1]\n[couple]", "no parameter 'catenary.exchange' in the FMU"),
        ('[vary]\ncouple.mean_force = ["DC"]\n[couple]', "'DC': must be one of AC, DC-3kV, DC-1.5kV"),
        ("[vary]\nm1 = [7]\n[couple]\nspans = [4, 3]", r"spans = \[4, 3\]: must be \[first, last\] span"),
        ("[vary]\nm1 = [7]\n[couple]\npantographs = 3", r"couple.pantographs = 3: must be at most 2"),
        ('[vary]\nm1 = [7]\n[couple]\nvalues = ["sigma"]', r"values = \['sigma'\]: must be some of mean_force, "),
        ("[vary]\nm1 = [7]\n[couple]\nvelocity = 200", "unknown key 'velocity'"),
        (
            "[vary]\ncouple.speed = [200]\n[couple]\nspeed = 250",
            r"speed: must be in \[vary\] or in \[couple\], not in both",
        ),
        ("[vary]\nm1 = [7]\n[couple]\n[compare]\na = { m1 = 8 }", r"a: m1: must be in \[vary\] or in \[compare\]"),
        (
            '[vary]\nm1 = [7]\n[couple]\nstatic_law = "AC"\n[compare]\na = { static_force = 80 }',
            "a: static_force and static_law: give one",
        ),
        (
            '[vary]\nm1 = [7]\n[set]\nstatic_force = 80\n[couple]\nstatic_law = "AC"',
            "static_force and static_law: give one",
        ),
        (
            '[vary]\nm1 = [7]\n[set]\ncouple.static_law = "AC"\nstatic_force = 80\n[couple]',
            "static_force and static_law: give one",
        ),
        (
            '[vary]\nstatic_force = [70]\n[couple]\n[compare]\na = { couple.static_law = "AC" }',
            "a: static_force and static_law: give one",
        ),
        (
            '[vary]\nm1 = [7]\n[set]\nstatic_force = 80\n[couple]\n[compare]\na = { couple.static_law = "AC" }',
            "a: static_force and static_law: give one",
        ),
        ("[vary]\nm1 = [7]\n[static]\namplitudes = [0.01]\n[compare]\na = {}", r"\[compare\]: needs \[couple\]"),
    ],
)
def test_a_study_that_cannot_be_meant_is_refused_in_one_line(fmus, tmp_path, text, told):
    with pytest.raises(ZSpringError, match=told) as refusal:
        study_of(f'design = "grid"\n{text}\n', fmus, tmp_path)
    assert "\n" not in str(refusal.value) and "study.toml" in str(refusal.value)


def test_two_ways_to_an_uplift_are_refused(fmus, tmp_path):
    with pytest.raises(ZSpringError, match="mean_force and uplift: give one of them"):
        measured(f'{SHORT}[vary]\ncouple.uplift = [10]\n[couple]\nmean_force = "AC"\n', fmus, tmp_path)


def test_uplift_at_mid_span_says_how_many_spans_were_watched(fmus, tmp_path):
    """Seven points that are asked for leave one of the FMU's eight for the middles of two spans."""
    points = ", ".join(f'"uplift_at_{x}"' for x in range(61, 68))
    text = f'{SHORT}[vary]\ncouple.speed = [200]\n[couple]\nspans = [2, 3]\nvalues = ["midspan_uplift"%s]\n'
    remark = "the largest uplift at mid-span is that of 1 of the 2 spans, which were watched"
    (few,), (all_of_them,) = (measured(text % more, fmus, tmp_path) for more in (f", {points}", ""))
    assert remark in few["remarks"] and "mid-span" not in all_of_them["remarks"]
