"""Results under way: kept at once, gone on with, never overwritten; one run at a time in a folder."""

from __future__ import annotations

import multiprocessing
import re
from pathlib import Path

import pytest

from commands import in_process, zspring
from zspring.errors import ZSpringError
from zspring.interrupt import Interrupted
from zspring.records import Record, claimed, fill, keep_others
from zspring.tables import write_table

HEAD = {"date": "today", "step": "2 ms"}


def record(path: Path, head: dict[str, str] = HEAD) -> Record[tuple[int, float]]:
    return Record(path, head, ["n", "root"], lambda kept: kept, lambda row: (int(row["n"]), float(row["root"])))


def roots(numbers, fails_at: int | None = None, stops_at: int | None = None):
    def work(stop):
        for n in numbers:
            if n == fails_at:
                raise ZSpringError("no root")
            yield n, n**0.5
            if n == stops_at:
                stop.set()
                return

    return work


def test_what_is_kept_is_gone_on_with(tmp_path, capsys):
    path = tmp_path / "new/roots.csv"
    with pytest.raises(ZSpringError, match=r"no root; 3 of 5 roots are kept in .*roots\.csv; the same command goes on"):
        fill(record(path), 5, 5, "roots", roots(range(5), fails_at=3))
    with path.open("a") as file:
        file.write("3,1.7")  # cut off by a power failure
    again = record(path, {**HEAD, "date": "tomorrow"})
    assert again.results == [(0, 0.0), (1, 1.0), (2, 2**0.5)]
    with pytest.raises(Interrupted, match="interrupted after 4 of 5 roots, kept in"):
        fill(again, 5, 2, "roots", roots([3, 4], stops_at=3))
    assert "going on after 3 of 5 roots" in capsys.readouterr().out
    last = record(path)
    fill(last, 5, 1, "roots", roots([4]))
    assert record(path).results == [(n, n**0.5) for n in range(5)] == last.results


def test_work_that_cannot_begin_leaves_nothing(tmp_path):
    with pytest.raises(ZSpringError, match=r"^no root$"):
        fill(record(tmp_path / "folder/roots.csv"), 3, 3, "roots", roots(range(3), fails_at=0))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("head", "line", "complaint"),
    [
        ({**HEAD, "step": "1 ms"}, "", r"is of other settings \(step: 2 ms, now 1 ms\): remove it, or give"),
        ({**HEAD, "step": 99 * "a" + "1 ms"}, "", rf"\(step: 2 ms, now {80 * 'a'} \.\.\.\)"),
        ({**HEAD, "law": "Coulomb"}, "", r"is of other settings \(law: none, now Coulomb\)"),
        (HEAD, "4,two\n", "is not as it was written: remove it, or give another --output"),
        (HEAD, "4\n", "is not as it was written"),
    ],
)
def test_results_of_other_settings_and_damaged_ones_are_refused_and_stay(tmp_path, head, line, complaint):
    path = tmp_path / "roots.csv"
    fill(record(path), 2, 2, "roots", roots(range(2)))
    path.write_text(path.read_text() + line)
    before = path.read_bytes()
    with pytest.raises(ZSpringError, match=complaint):
        record(path, head)
    assert path.read_bytes() == before


def test_of_long_settings_what_differs_is_told(tmp_path):
    long = ["a" * 200 + end for end in ("1" + "b" * 200, "2")]
    write_table(tmp_path / "a.csv", {"setting": long[0]}, ["x"], [])
    keep_others(tmp_path / "a.csv", {"setting": long[0]})
    shown = rf"\(setting: \.\.\. {20 * 'a'}1{59 * 'b'} \.\.\., now \.\.\. {20 * 'a'}2\)"
    with pytest.raises(ZSpringError, match=shown):
        keep_others(tmp_path / "a.csv", {"setting": long[1]})


def hold(folder: Path, started, end) -> None:
    with claimed(folder):
        started.set()
        end.wait(30)


def test_a_second_run_in_a_folder_ends_before_it_works(tmp_path):
    context = multiprocessing.get_context("spawn")
    started, end = context.Event(), context.Event()
    other = context.Process(target=hold, args=(tmp_path / "out", started, end))
    other.start()
    try:
        assert started.wait(30)
        for command in (["frf", "--amplitudes", "1"], ["simulate"], ["static"], ["couple"], ["en50318", "--quick"]):
            _, err = zspring(tmp_path, *command, "--output", "out", status=1)
            assert err == "zspring: out: another run writes there: wait for its end, or give another --output\n"
    finally:
        end.set()
        other.join()
    assert other.exitcode == 0 and list(tmp_path.iterdir()) == []
    zspring(tmp_path, "linearize", "--output", "out")
    assert not list((tmp_path / "out").glob(".*"))


RUN = ["--step", "0.01", "--stop", "0.02"]
POINT = ["--amplitudes", "1", "--frequencies", "5"]


@pytest.mark.parametrize(
    ("command", "other", "file", "differs"),
    [
        (["frf", *POINT], ["--set", "m1=7"], "frf.csv", "m1: 7.12 kg, now 7 kg"),
        (["frf", *POINT], ["--direction", "down"], "frf.csv", "direction: up, now down"),
        (["static", *POINT[:2], "--rates", "1"], ["--rates", "2"], "stiffness.csv", "rates: 0.001 m/s, now 0.002 m/s"),
        (["simulate", *RUN], ["--stop", "0.03"], "simulation.csv", r"times: 0 to 0.02 s by 0.01 s, now 0 to 0.03 s .*"),
        (["simulate", *RUN], ["--input", "other.csv"], "simulation.csv", "inputs: none, now other.csv"),
        (["mechanism"], ["--frequency", "3"], "mechanism.csv", "frequency: 2 Hz, now 3 Hz"),
        (["linearize"], ["--set", "c1=1"], "linear-linear.npz", "c1: 0 N.s/m, now 1 N.s/m"),
        (["linearize"], ["--frequencies", "1,2"], "linear-linear.npz", r"frequencies: 0.05 .* \.\.\., now 1 2 Hz"),
    ],
)
def test_finished_results_are_repeated_but_not_overwritten_by_others(
    tmp_path, monkeypatch, command, other, file, differs
):
    out = tmp_path / "out"
    monkeypatch.chdir(tmp_path)
    Path("other.csv").write_text("time [s],contact_force [N]\n0,120\n1,130\n")
    for _ in range(2):
        assert in_process(*command, "--output", out)[0] == 0
    before = {path: path.read_bytes() for path in out.iterdir()}
    status, _, err = in_process(*command, *other, "--output", out)
    assert status == 1
    assert re.fullmatch(
        rf"zspring: {out / file} is of other settings \({differs}\): remove it, or give another --output\n", err
    )
    assert {path: path.read_bytes() for path in out.iterdir()} == before


def test_other_inputs_in_a_file_of_the_same_name_are_other_settings(tmp_path):
    path = tmp_path / "force.csv"
    command = ["simulate", *RUN, "--input", path, "--output", tmp_path / "out"]
    for force, status in ((130, 0), (130, 0), (131, 1)):
        path.write_text(f"time [s],contact_force [N]\n0,120\n0.02,{force}\n")
        assert in_process(*command)[0] == status
    assert "simulation.csv is of other settings (SHA-256 of the inputs: " in in_process(*command)[2]


def test_a_fit_is_repeated_but_not_overwritten_by_one_with_other_settings_or_data(tmp_path):
    rows = ["2,1,0.034,0.0243", "2.5,1,0.0243,0.0275", "3,1,0.008,0.035"]
    text = "frequency [Hz],amplitude [m/s2],real [(m/s2)/N],imaginary [(m/s2)/N]\n" + "\n".join(rows) + "\n"
    toml = (
        'model = "linear"\n[[measurement]]\nfile = "b.csv"\n[free]\nk1 = { start = 9000, min = 5000, max = 20000 }\n'
        "[search]\nsamples = 0\n"
    )
    (tmp_path / "b.csv").write_text(text)
    (tmp_path / "fit.toml").write_text(toml)
    command = ["identify", tmp_path / "fit.toml", "--output", tmp_path / "out", "--jobs", "1"]
    assert [in_process(*command)[0] for _ in range(2)] == [0, 0]
    before = (tmp_path / "out/fitted.ssv").read_bytes()
    (tmp_path / "fit.toml").write_text(toml.replace("start = 9000", "start = 9500"))
    _, _, err = in_process(*command)
    assert re.search(r'fit\.csv is of other settings \(setting free: .*"start": 9000.*, now .*"start": 9500', err)
    (tmp_path / "fit.toml").write_text(toml)
    (tmp_path / "b.csv").write_text(text.replace("0.0243", "0.0244"))
    assert "fit.csv is of other settings (file 1: " in in_process(*command)[2]
    assert (tmp_path / "out/fitted.ssv").read_bytes() == before


def test_a_file_of_somebody_else_is_no_result_to_overwrite(tmp_path):
    (tmp_path / "stiffness.csv").write_text("my,own\n1,2\n")
    (tmp_path / "linear-free.npz").write_text("my own")
    for command in (["static"], ["linearize"]):
        status, _, err = in_process(*command, "--output", tmp_path)
        assert status == 1 and "is of other settings (FMU: none, now ZSpringPantograph" in err
