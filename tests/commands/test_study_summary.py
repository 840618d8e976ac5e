"""What a study makes of its rows: indices, spread and envelopes, with cases that failed among them."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from commands import table, zspring
from zspring.bench.points import FrfSettings
from zspring.errors import ZSpringError
from zspring.fmu import Fmu
from zspring.study.design import make_cases
from zspring.study.evaluations import FrfQuantity, StaticQuantity, column
from zspring.study.file import Range
from zspring.study.files import StudyRecord, write_parquet
from zspring.study.plot import envelope_figure
from zspring.study.report import (
    PERCENTILES,
    Envelope,
    SobolIndices,
    envelopes,
    incomplete_blocks,
    sobol_doubts,
    sobol_indices,
    sobol_table,
    spread_table,
    write_sobol,
)
from zspring.study.settings import StudySettings

RANGE = Range.model_validate({"from": 1, "to": 2})
TWO = StudySettings("sobol", 8, 1, {"m1": RANGE, "m2": RANGE}, {}, (StaticQuantity((0.01,)),))
BLOCK = 4  # cases of two parameters


def rows_of(y: np.ndarray) -> dict[int, dict[str, str]]:
    """Rows of a study with the result y, the last one first, as they come in; NaN: a case that failed."""
    numbers = reversed(range(len(y)))
    return {
        n: {"y": "" if np.isnan(y[n]) else repr(float(y[n])), "status": "failed: so" if np.isnan(y[n]) else "ok"}
        for n in numbers
    }


def results(seed: int, blocks: int = 8) -> np.ndarray:
    return np.random.default_rng(seed).normal(5, 1, blocks * BLOCK)


def test_blocks_with_a_hole_are_left_out_whole_and_no_others():
    """The indices are those of the other blocks alone."""
    y = results(1)
    holes = y.copy()
    holes[[9, 10, 23]] = np.nan  # blocks 2 and 5
    kept = np.delete(y.reshape(8, BLOCK), [2, 5], axis=0).ravel()
    (found,), (expected,) = sobol_indices(TWO, ["y"], rows_of(holes)), sobol_indices(TWO, ["y"], rows_of(kept))
    for name in ("first", "first_confidence", "total", "total_confidence"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), err_msg=name)
    (whole,) = sobol_indices(TWO, ["y"], rows_of(y))
    assert np.all(whole.first != found.first)
    assert incomplete_blocks(TWO, rows_of(holes)) == 2 and incomplete_blocks(TWO, rows_of(y)) == 0


@pytest.mark.parametrize(
    "design, samples, vary, count",
    [
        ("sobol", 2**18, {"m1": RANGE, "m2": RANGE}, 2**20),
        ("latin-hypercube", 1_000_001, {"m1": RANGE}, 1_000_001),
        ("grid", 0, {"m1": (1.0,) * 1001, "m2": (1.0,) * 1000}, 1_001_000),
        ("list", 0, {"m1": (1.0,) * 1_000_001}, 1_000_001),
    ],
)
def test_a_study_of_more_than_a_million_cases_is_refused_before_it_is_made(design, samples, vary, count):
    with pytest.raises(ZSpringError, match=f"{count} cases: a study has at most 1000000"):
        make_cases(StudySettings(design, samples, 1, vary, {}, TWO.quantities))


def test_what_does_not_vary_or_is_in_one_block_only_has_no_index():
    one = results(2)
    one[BLOCK:] = np.nan
    assert sobol_indices(TWO, ["y"], rows_of(one)) == []
    assert sobol_indices(TWO, ["y"], rows_of(np.full(32, 3.0))) == []
    one[BLOCK : 2 * BLOCK] = results(3, 1)
    assert len(sobol_indices(TWO, ["y"], rows_of(one))) == 1


def test_indices_are_printed_and_written_by_parameter(tmp_path):
    found = [SobolIndices("y", *(np.array(pair) for pair in ([0.7, 0.25], [0.01, 0.02], [0.75, 0.304], [0.03, 0.04])))]
    lines = sobol_table(TWO, found)
    assert [line.split() for line in lines] == [
        ["first", "/", "total", "order", "m1", "m2"],
        ["y", *"0.70 ± 0.01 / 0.75 ± 0.03".split(), *"0.25 ± 0.02 / 0.30 ± 0.04".split()],
    ]
    assert sobol_doubts(found) == []
    wide = SobolIndices("z", *map(np.array, ([0.1, 0.01], [0.2, 0.04], [0.1, 0.3], [0.09, 0.31])))
    assert sobol_doubts([*found, wide]) == [
        "2 of 8 Sobol indices are smaller than their 95 % confidence: they need more samples"
    ]
    write_sobol(tmp_path / "sobol.csv", {"design": "sobol"}, TWO, found)
    _, _, *rows = csv.reader(line for line in (tmp_path / "sobol.csv").read_text().splitlines() if line)
    rows = rows[1:]
    assert rows == [["y", "m1", "0.7", "0.01", "0.75", "0.03"], ["y", "m2", "0.25", "0.02", "0.304", "0.04"]]


def test_the_spread_is_that_of_the_cases_that_have_a_value():
    y = np.array([3.0, np.nan, 1.0, 8.0, 2.0])
    first, line = spread_table(["y"], rows_of(y))
    assert first.split() == ["min", "median", "max", "cases"]
    assert line.split() == ["y", "1", "2.5", "8", "4"]
    assert spread_table(["y"], rows_of(np.full(2, np.nan)))[1].split(maxsplit=1) == ["y", "no case has a value"]


def test_envelopes_are_percentiles_of_the_magnitude_by_amplitude_and_frequency():
    """100 cases, of which every tenth failed at 5 Hz; |H| = (3, 4, 5) times the case's number."""
    quantity = FrfQuantity(FrfSettings((1.0, 4.0), (2.0, 5.0)), (0.0, 20.0))
    rows: dict[int, dict[str, str]] = {}
    for n in range(1, 101):
        rows[n] = {}
        for place, (a, f) in enumerate(((1.0, 2.0), (1.0, 5.0), (4.0, 2.0), (4.0, 5.0))):
            H = (place + 1) * n * (3 - 4j)
            failed = f == 5.0 and n % 10 == 0
            rows[n][column("H_re", a, f)] = "" if failed else repr(H.real)
            rows[n][column("H_im", a, f)] = "" if failed else repr(H.imag)
    low, high = envelopes(quantity, rows)
    assert (low.amplitude, high.amplitude) == (1.0, 4.0)
    cases = np.arange(1, 101)
    solved = cases[cases % 10 != 0]
    for envelope, places in ((low, (1, 2)), (high, (3, 4))):
        np.testing.assert_array_equal(envelope.frequency, [2, 5])
        for column_of, place, numbers in zip(envelope.percentiles.T, places, (cases, solved)):
            np.testing.assert_allclose(column_of, [np.percentile(5 * place * numbers, q) for q in (0, 5, 50, 95, 100)])
    assert PERCENTILES == (0, 5, 50, 95, 100)


def test_the_envelopes_share_a_logarithmic_scale_if_there_is_anything_to_draw():
    frequency = np.array([2.0, 5.0])
    some, none = (Envelope(1.0, frequency, np.full((5, 2), value)) for value in (1e-4, np.nan))
    for drawn, scale in (([some, none], "log"), ([none, some], "log"), ([none, none], "linear")):
        assert [axes.get_yscale() for axes in envelope_figure(drawn, 3, "x").axes] == [scale] * 2


def test_parquet_has_the_cases_in_order_with_missing_values(tmp_path):
    import pyarrow.parquet

    write_parquet(
        tmp_path / "a.parquet", {"k": "v"}, ["y", "status"], rows_of(np.array([3.0, np.nan, 1.0])), ["status"]
    )
    found = pyarrow.parquet.read_table(tmp_path / "a.parquet")
    assert found["y"].to_pylist() == [3.0, None, 1.0]
    assert found["status"].to_pylist() == ["ok", "failed: so", "ok"] and found.schema.metadata[b"k"] == b"v"


def test_a_study_with_holes_says_how_many_blocks_it_lacks(tmp_path):
    """Without load the spring of a wide Z-spring pulls, that of a narrow one hangs slack."""
    text = 'design = "sobol"\nsamples = 4\n[vary]\nzspring.d = { from = 0.162, to = 0.2 }\n'
    text += "[set]\ngravity = 0\nstatic_force = 0\n[static]\namplitudes = [0.001]\n"
    (tmp_path / "study.toml").write_text(text)
    out, err = zspring(tmp_path, "study", "study.toml", "--output", "out", "--workers", "1")
    status = [row["status"] == "ok" for row in table(tmp_path / "out/study.csv")]
    blocks = [all(status[i : i + 3]) for i in range(0, 12, 3)]
    failed = status.count(False)
    assert 0 < blocks.count(False) < 4
    assert f"Sobol indices without {blocks.count(False)} of 4 blocks, which have failed cases" in out
    (line,) = (
        line for line in out.splitlines() if line.startswith("static stiffness 0.001 m [N/m]  ") and "/ " not in line
    )
    assert line.split()[-1] == str(12 - failed) and err.count("failed: ") == failed


def test_what_is_printed_of_failures_is_limited(tmp_path):
    """Twelve of thirteen cases fail, at different widths; ten are told."""
    widths = [0.171, *(0.10 + 0.001 * i for i in range(12))]
    text = f'design = "list"\n[vary]\nzspring.d = {[round(d, 3) for d in widths]}\n'
    text += "[set]\ngravity = 0\nstatic_force = 0\n[static]\namplitudes = [0.001]\n"
    (tmp_path / "study.toml").write_text(text)
    _, err = zspring(tmp_path, "study", "study.toml", "--output", "out", "--workers", "1")
    lines = [line for line in err.splitlines() if line.startswith(("case ", "and "))]
    assert [line.split(":")[0] for line in lines[:10]] == [f"case {n}" for n in range(1, 11)]
    assert lines[10:] == [f"and 2 more, see {Path('out/study.csv')}"]


def test_a_study_all_of_whose_cases_fail_is_a_failure(tmp_path):
    """The first step is refused; that they start, the FMU tells before."""
    text = 'design = "list"\n[vary]\nzspring.Mf = [0.1, 0.2]\n[set]\nsolver.tangent = "Exact"\n'
    text += "solver.max_iterations = 1\nsolver.tolerance = 1e-13\n[frf]\namplitudes = [4]\nfrequencies = [4]\n"
    (tmp_path / "study.toml").write_text(text)
    _, err = zspring(tmp_path, "study", "study.toml", "--output", "out", "--workers", "1", status=1)
    assert "all 2 cases failed" in err
    for row in table(tmp_path / "out/study.csv"):
        assert row["status"].startswith("failed: 4 m/s2, 4 Hz: ") and row["resonance 4 m/s2 [Hz]"] == ""


def test_lost_cases_are_run_again_and_failed_ones_are_not(tmp_path):
    """Rows as they come in, and as the same record is opened again; a row that was cut off is missing, too."""
    path, cases = tmp_path / "study.csv", [{"m1 [kg]": str(n)} for n in range(5)]

    def opened() -> StudyRecord:
        return StudyRecord(path, {"date": "now", "design": "list"}, cases, ["y"])

    record = opened()
    assert record.missing == [0, 1, 2, 3, 4]
    with record:
        for number, status in ((3, "lost"), (1, "ok"), (0, "failed: so\n and so")):
            y = 2.5 if status == "ok" else float("nan")
            record.append(record.row(number, {"status": status, "seconds": 0.5, "y": y}))
    assert record.missing == [2, 3, 4]
    assert record.failed == [(0, "failed: so and so"), (3, "lost")]
    with path.open("a") as file:
        file.write("2,ok,2")
    again = opened()
    assert "seconds" not in again.columns
    assert again.missing == [2, 3, 4] and again.rows[1]["y"] == "2.5" and again.rows[0]["y"] == ""
    again.finish()
    assert [row["case"] for row in table(path)] == ["0", "1", "3"]
    with pytest.raises(ZSpringError, match=r"is of other settings \(design: list, now grid"):
        StudyRecord(path, {"date": "later", "design": "grid"}, cases, ["y"])


@pytest.fixture(scope="module")
def measured():
    with Fmu() as fmu, fmu.instances() as (instance,):
        quantity = FrfQuantity(FrfSettings((4.0,), (3.0, 4.0, 5.0), tolerance=1e-9, max_periods=8), (0.0, 20.0))
        yield quantity.measure(instance, {})[0]


def test_points_that_do_not_settle_are_counted(measured):
    assert measured["not settled"] == 3
    assert all(np.isfinite(measured[column("H_re", 4, f)]) for f in (3, 4, 5))
