"""Parameter studies: designs, physics of the results, and what happens when workers or the study die."""

from __future__ import annotations

import contextlib
import csv
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import cloudpickle
import dask
import numpy as np
import pytest
from distributed import Client

from commands import PNG, QUICK, begin, start, table, zspring
from paths import ROOT
from zspring.errors import ZSpringError
from zspring.fmu import Fmu
from zspring.parameter_sets import write_set
from zspring.receptance import receptance
from zspring.study.cluster import LOST, _results
from zspring.study.connection import connected
from zspring.study.design import make_cases
from zspring.study.evaluations import FrfQuantity, StaticQuantity, column
from zspring.study.report import sobol_indices
from zspring.study.settings import StudySettings, read_study

EXAMPLE = ROOT / "resources/examples/study.toml"
# What a worker must do without; the modules are refused there as if they were not installed.
NOT_NEEDED = ["zspring", "pydantic", "scipy", "matplotlib", "tqdm", "SALib", "pandas", "pyarrow"]

SLOW = """
design = "latin-hypercube"
samples = 24
[vary]
zspring.Mf = { from = 0.1, to = 0.4 }
[set]
solver.step = 2e-4
[frf]
amplitudes = [2]
frequencies = "3:9:0.5"
"""

COUPLED = f"""
design = "latin-hypercube"
samples = 24
[vary]
zspring.Mf = {{ from = 0.1, to = 0.4 }}
[couple]
line = "{(ROOT / "resources/lines/en-50318-2002.toml").as_posix()}"
spans = [3, 3]
step = 5e-4
[irregularity]
lines = 24
dropper_length = 0.005
contact_wire = 0.001
wavelengths = [2, 60]
exponent = 2
"""


@pytest.fixture(scope="module")
def own_fmu() -> Iterator[Fmu]:
    with Fmu() as fmu:
        yield fmu


def study_of(text: str, fmu: Fmu, folder: Path) -> StudySettings:
    (folder / "study.toml").write_text(text)
    return read_study(folder / "study.toml", fmu)


def wait_for_rows(process: subprocess.Popen, path: Path, count: int) -> None:
    deadline = time.monotonic() + 60
    while not (path.exists() and len(table(path)) >= count):
        assert process.poll() is None and time.monotonic() < deadline
        time.sleep(0.02)


# Designs


def test_the_step_is_the_commands_own_where_a_study_has_none(own_fmu, tmp_path):
    begin, end = 'design = "grid"\n[vary]\n', "[static]\namplitudes = [0.02]\n"
    free = study_of(f"{begin}m1 = [7, 8]\n{end}", own_fmu, tmp_path)
    own = study_of(f"{begin}m1 = [7, 8]\n[set]\nsolver.step = 0.002\n{end}", own_fmu, tmp_path)
    varied = study_of(f"{begin}solver.step = [0.001, 0.002]\n{end}", own_fmu, tmp_path)
    assert [study.common.get("solver.step") for study in (free, own, varied)] == [5e-4, 2e-3, None]


def test_a_grid_has_every_combination_and_a_list_its_rows(own_fmu, tmp_path):
    cases = make_cases(study_of(QUICK, own_fmu, tmp_path))
    assert cases == [
        {"zspring.Mf": pytest.approx(Mf), "zspring.k": k} for Mf in (0.1, 0.2, 0.3, 0.4) for k in (12500, 13500)
    ]
    text = 'design = "list"\n[vary]\nzspring.Mf = [0.1, 0.2]\nfriction = ["Coulomb", "Regularized"]\n'
    cases = make_cases(study_of(text + "[static]\namplitudes = [0.01]\n", own_fmu, tmp_path))
    assert cases == [{"zspring.Mf": 0.1, "friction": 2}, {"zspring.Mf": 0.2, "friction": 1}]


@pytest.mark.parametrize("scale, position", [("linear", lambda x: x - 1), ("log", np.log2)])
def test_a_latin_hypercube_has_one_case_in_each_stratum(own_fmu, tmp_path, scale, position):
    """Strata of equal width on the scale of the range, 1 to 2."""
    vary = "\n".join(f'{name} = {{ from = 1, to = 2, scale = "{scale}" }}' for name in ("m1", "m2"))
    text = f'design = "latin-hypercube"\nsamples = 50\n[vary]\n{vary}\n[static]\namplitudes = [0.01]\n'
    settings = study_of(text, own_fmu, tmp_path)
    for name in ("m1", "m2"):
        values = np.array([case[name] for case in make_cases(settings)])
        assert sorted(np.floor(50 * position(values))) == list(range(50))
    assert make_cases(settings) == make_cases(settings)


def test_sobol_indices_of_a_known_function_come_out(own_fmu, tmp_path):
    """y = x1 + 2 x2 + x1 x3 with x uniform in 0 .. 1: variances by hand.

    Var = 1/12 (3/2)^2 + 4/12 + 1/12 (1/2)^2 + 1/144; parts by the functional ANOVA.
    """
    vary = "\n".join(f"{name} = {{ from = 1, to = 2 }}" for name in ("m1", "m2", "m3"))
    text = f'design = "sobol"\nsamples = 2048\n[vary]\n{vary}\n[static]\namplitudes = [0.01]\n'
    settings = study_of(text, own_fmu, tmp_path)
    cases = make_cases(settings)
    assert len(cases) == 2048 * 5
    x = np.array([[case[name] - 1 for name in ("m1", "m2", "m3")] for case in cases]).T
    y = x[0] + 2 * x[1] + x[0] * x[2]
    rows = {n: {"y": repr(float(value)), "status": "ok"} for n, value in enumerate(y)}
    rows[7]["y"] = ""  # a failed case takes its block along
    parts = np.array([9 / 48, 1 / 3, 1 / 48, 1 / 144])  # x1, x2, x3, x1 x3
    (found,) = sobol_indices(settings, ["y"], rows)
    np.testing.assert_allclose(found.first, parts[:3] / parts.sum(), atol=0.02)
    np.testing.assert_allclose(found.total, (parts[:3] + parts[3] * np.array([1, 0, 1])) / parts.sum(), atol=0.02)


# What is computed


def test_static_stiffness_is_that_of_the_suspension(own_fmu):
    """That of the linear spring; with Coulomb friction from the locked to near the free one."""
    quantity = StaticQuantity((1e-4, 0.03))
    with own_fmu.instances() as (instance,):

        def measured(**names: str) -> list[float]:
            values, problems = quantity.measure(
                instance, own_fmu.variables.parse_assignments(f"{k}={v}" for k, v in names.items())
            )
            assert not problems
            return list(values.values())

        instance.start({})
        k1, locked, free, Mf, d, theta = instance.get(
            ["k1", *(f"zspring.{name}" for name in ("k_locked", "k_free", "Mf", "d", "theta"))]
        )
        small, _, large, loss = measured(suspension="Linear")
        assert small == pytest.approx(k1, rel=1e-6) and large == pytest.approx(k1, rel=1e-6)
        assert loss == pytest.approx(0, abs=1e-8)  # of the frame's damper, the frame being held by springs
        # 0.1 mm: the rods stay stuck, and the spring is linear but for (0.1 mm / 10 mm)^2.
        small, loss, large, loop = measured(friction="Coulomb")
        assert small == pytest.approx(locked, rel=1e-4) and loss == pytest.approx(0, abs=1e-8)
        assert free < large < 1.05 * free
        # Free rods stay in line with the spring; so far they turn there and back, each against Mf.
        turn = np.arctan(np.tan(theta) + 0.03 / d) - np.arctan(np.tan(theta) - 0.03 / d)
        assert loop == pytest.approx(2 * 2 * Mf * turn, rel=0.05)
        # At small amplitude free rods, undamped, still swing from the turns of the motion.
        _, _, large, loss = measured(friction="Free")
        assert large == pytest.approx(free, rel=0.01) and loss == pytest.approx(0, abs=1e-8)


def test_the_resonance_moves_from_the_locked_to_the_free_model(own_fmu, tmp_path):
    """Highest resonance of the linear models at small and at large amplitude."""
    text = QUICK.replace("[1, 4]", "[0.01, 8]").replace("3:8:0.5", "4:8:0.1")
    (quantity,) = study_of(text + "resonance_band = [4, 8]\n", own_fmu, tmp_path).quantities
    assert isinstance(quantity, FrfQuantity)
    names = own_fmu.variables.names("parameter", "calculatedParameter")
    with own_fmu.instances() as (instance,):
        values, problems = quantity.measure(instance, {})
        instance.start({})
        parameters = dict(zip(names, instance.get(names)))
    assert not problems
    frequency = np.arange(4, 8, 0.001)
    for amplitude, model in ((0.01, "locked"), (8, "free")):
        linear = frequency[np.argmax(np.abs(receptance(frequency, parameters, model)))]
        assert values[f"resonance {amplitude} m/s2 [Hz]"] == pytest.approx(linear, rel=0.005)


def test_a_study_gives_what_zspring_frf_gives(tmp_path):
    (tmp_path / "quick.toml").write_text(QUICK)
    out, _ = zspring(tmp_path, "study", "quick.toml", "--output", "out", "--workers", "2", "--parquet")
    rows = table(tmp_path / "out/study.csv")
    assert [int(row["case"]) for row in rows] == list(range(8))
    assert {row["status"] for row in rows} == {"ok"} and "8 cases" in out
    assert (tmp_path / "out/envelope.png").read_bytes().startswith(PNG)
    row = rows[5]
    arguments = ["--amplitudes", "1,4", "--frequencies", "3:8:0.5", "--output", "frf"]
    for name, unit in (("zspring.Mf", "N.m"), ("zspring.k", "N/m")):
        arguments += ["--set", f"{name}={row[f'{name} [{unit}]']}"]
    zspring(tmp_path, "frf", *arguments)
    for point in table(tmp_path / "frf/frf.csv"):
        place = float(point["amplitude [m/s2]"]), float(point["frequency [Hz]"])
        for part in ("H_re", "H_im"):
            assert row[column(part, *place)] == point[f"{part} [m/N]"]

    import pyarrow.parquet

    parquet = pyarrow.parquet.read_table(tmp_path / "out/study.parquet")
    assert parquet.num_rows == 8 and b"zspring.tau" in parquet.schema.metadata
    for name in ("resonance 4 m/s2 [Hz]", "zspring.k [N/m]"):
        assert parquet[name].to_pylist() == [float(row[name]) for row in rows]


def test_the_example_finds_what_moves_what(tmp_path):
    """Static stiffness of large strokes hangs on the spring, lost energy on friction."""
    zspring(tmp_path, "study", str(EXAMPLE), "--output", "out")
    with open(tmp_path / "out/sobol.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    total = {(row["result"], row["parameter"]): float(row["total order"]) for row in rows}
    assert total["static stiffness 0.02 m [N/m]", "zspring.k"] > 0.7
    assert total["static loss 0.02 m [J]", "zspring.Mf"] > 0.7
    assert total["static loss 0.02 m [J]", "zspring.k"] < 0.1
    assert (tmp_path / "out/sobol.png").read_bytes().startswith(PNG)


def test_a_case_that_fails_is_recorded_with_its_reason(tmp_path):
    text = 'design = "list"\n[vary]\nzspring.d = [0.17, 0.1]\n[set]\ngravity = 0\nstatic_force = 0\n'
    (tmp_path / "study.toml").write_text(text + "[static]\namplitudes = [0.001]\n")
    _, err = zspring(tmp_path, "study", "study.toml", "--output", "out")
    good, bad = table(tmp_path / "out/study.csv")
    assert good["status"] == "ok" and float(good["static stiffness 0.001 m [N/m]"]) > 0
    assert bad["status"].startswith("failed: ") and "tension" in bad["status"]
    assert bad["static stiffness 0.001 m [N/m]"] == "" and "case 1: failed" in err


# Interruption and death


def test_an_interrupted_study_continues_to_the_same_file(tmp_path):
    (tmp_path / "slow.toml").write_text(SLOW)
    process = start(tmp_path, "study", "slow.toml", "--output", "broken", "--workers", "2")
    wait_for_rows(process, tmp_path / "broken/study.csv", 5)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    kept = len(table(tmp_path / "broken/study.csv"))
    assert process.returncode == 130 and "Traceback" not in err and 5 <= kept < 24
    process = start(tmp_path, "study", "slow.toml", "--output", "broken", "--workers", "2")
    wait_for_rows(process, tmp_path / "broken/study.csv", kept + 3)
    process.kill()  # as a power failure would
    process.communicate()
    out, _ = zspring(tmp_path, "study", "slow.toml", "--output", "broken", "--workers", "2")
    assert "going on after" in out
    zspring(tmp_path, "study", "slow.toml", "--output", "whole", "--workers", "2")
    assert (tmp_path / "broken/study.csv").read_bytes() == (tmp_path / "whole/study.csv").read_bytes()

    before = (tmp_path / "whole/study.csv").read_bytes()
    (tmp_path / "slow.toml").write_text(SLOW.replace("0.4 }", "0.5 }"))
    _, err = zspring(tmp_path, "study", "slow.toml", "--output", "whole", status=1)
    assert "vary zspring.Mf" in err and "0.5" in err and len(err.splitlines()) == 1
    assert (tmp_path / "whole/study.csv").read_bytes() == before


class Dask:
    """A scheduler and two workers, each a process of its own, the workers without what they do not need."""

    def __init__(self, folder: Path, not_needed: list[str]):
        self.folder = folder
        refuse, file = folder / "refuse.py", folder / "scheduler.json"
        refuse.write_text(f"import sys\nfor name in {not_needed}:\n    sys.modules[name] = None\n")
        own = ["--host", "127.0.0.1", "--port", "0", "--no-show", "--scheduler-file", str(file)]
        self.scheduler = self._start("scheduler", *own)
        self.address = self._address(file)
        options = ["--nthreads", "1", "--no-nanny", "--preload", str(refuse)]
        self.workers = [
            self._start("worker", self.address, *options, "--local-directory", str(folder / f"worker{number}"))
            for number in range(2)
        ]
        with Client(self.address, timeout=60, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)

    def _address(self, file: Path) -> str:
        """From the scheduler's file, once that is written to its end."""
        deadline = time.monotonic() + 60
        while True:
            with contextlib.suppress(OSError, ValueError):
                return json.loads(file.read_text())["address"]
            assert self.scheduler.poll() is None and time.monotonic() < deadline
            time.sleep(0.02)

    def _start(self, what: str, *arguments: str) -> subprocess.Popen:
        command = [sys.executable, "-m", f"distributed.cli.dask_{what}", *arguments, "--no-dashboard"]
        with open(self.folder / f"{what}.log", "a") as log:
            return begin(command, stdout=log, stderr=log, cwd=self.folder)


@pytest.fixture
def cluster(tmp_path, request) -> Dask:
    """Its processes end with the test, as all that the helpers begin."""
    return Dask(tmp_path, getattr(request, "param", NOT_NEEDED))


@pytest.mark.parametrize(
    "cluster, text", [(NOT_NEEDED, SLOW), ([n for n in NOT_NEEDED if n != "scipy"], COUPLED)], indirect=["cluster"]
)
def test_a_killed_worker_costs_only_its_task(cluster, tmp_path, text):
    """On a real scheduler, whose workers get FMUs and code with the work; the same file as from local ones."""
    (tmp_path / "slow.toml").write_text(text)
    process = start(
        tmp_path, "study", "slow.toml", "--output", "cluster", "--scheduler", cluster.address, "--timeout", "20"
    )
    wait_for_rows(process, tmp_path / "cluster/study.csv", 5)
    cluster.workers[0].kill()
    _, err = process.communicate(timeout=100)
    assert process.returncode == 0, err
    assert "Traceback" not in err
    zspring(tmp_path, "study", "slow.toml", "--output", "local", "--workers", "2")
    assert (tmp_path / "cluster/study.csv").read_bytes() == (tmp_path / "local/study.csv").read_bytes()
    assert not list((tmp_path / "worker1").rglob("*resources"))  # the worker was left as it was found


def test_a_study_without_workers_or_scheduler_ends_and_can_go_on(cluster, tmp_path):
    (tmp_path / "slow.toml").write_text(SLOW)
    arguments = ["study", "slow.toml", "--output", "out", "--scheduler", cluster.address, "--timeout", "4"]
    process = start(tmp_path, *arguments)
    wait_for_rows(process, tmp_path / "out/study.csv", 2)
    for worker in cluster.workers:
        worker.kill()
    _, err = process.communicate(timeout=60)
    assert process.returncode == 1 and "no worker is left" in err and "goes on" in err
    assert "Traceback" not in err and len(table(tmp_path / "out/study.csv")) >= 2
    cluster.scheduler.kill()
    _, err = zspring(tmp_path, *arguments, status=1)
    assert cluster.address in err and "no answer in 4 s" in err


def test_results_that_are_lost_with_their_worker_are_not_waited_for_in_vain(cluster):
    with Client(cluster.address) as client:
        future = client.submit(lambda: [{"seconds": 0.0}])
        assert _results(future) == [{"seconds": 0.0}]
        for worker in cluster.workers:
            worker.kill()
            worker.wait()
        assert _results(future) is None


class Poison:
    """A quantity that kills its worker in one case."""

    def measure(self, instance, parameters):
        if parameters["zspring.Mf"] == 0.25:
            os._exit(1)
        time.sleep(0.02)
        return {}, []


def test_a_case_that_kills_workers_is_given_up_and_no_other(own_fmu):
    cases = {n: {"zspring.Mf": 0.05 * n} for n in range(1, 11)}
    cloudpickle.register_pickle_by_value(sys.modules[__name__])
    try:
        with (
            dask.config.set({"distributed.scheduler.allowed-failures": 1}),
            connected(None, 2, 30) as cluster,
            cluster.study(own_fmu, None, (Poison(),)) as study,
        ):
            found = dict(cluster.run(study, cases, threading.Event()))
    finally:
        cloudpickle.unregister_pickle_by_value(sys.modules[__name__])
    assert Counter(result["status"] for result in found.values()) == {"ok": 9, LOST: 1}
    assert found[5]["status"] == LOST


# Settings


def test_a_study_takes_a_set_from_the_package_or_beside_its_file(own_fmu, tmp_path):
    """What is varied or in [set] goes before the set, and the bench's own before all."""
    values = own_fmu.variables.parse_assignments(["m1=7.5", "m2=6.5", "zspring.k=1", "drive=Wire"])
    write_set(tmp_path / "mine.ssv", own_fmu, values, "mine", "")
    text = QUICK.replace("[vary]", 'parameters = "mine.ssv"\n[set]\nm2 = 5\n[vary]')
    common = study_of(text, own_fmu, tmp_path).common
    assert (common["m1"], common["m2"]) == (7.5, 5.0) and not {"zspring.k", "drive"} & common.keys()
    common = study_of(text.replace("mine.ssv", "dsa-250"), own_fmu, tmp_path).common
    assert (common["m1"], common["m2"], common["k2"]) == (7.51, 5.0, 6200.0)


# Bad input


@pytest.mark.parametrize(
    "change, named",
    [
        (('design = "grid"', "design = grid"), ["line 2"]),
        (('"grid"', '"cube"'), ["design", "cube", "sobol"]),
        (("zspring.k", "zspring.kk"), ["[vary]", "zspring.kk", "zspring.k"]),
        (("zspring.k", "zspring.theta"), ["zspring.theta", "not a parameter"]),
        (("zspring.k", "drive"), ["drive"]),
        (("from = 0.1", "from = 0.5"), ["zspring.Mf", "0.5", "below"]),
        (("from = 0.1", "from = -0.1"), ["zspring.Mf", "-0.1", "at least 0"]),
        (("from = 0.1", "from = nan"), ["zspring.Mf", "nan", "number"]),
        ((", to = 0.4", ""), ["zspring.Mf", "to is missing"]),
        ((", count = 4", ""), ["zspring.Mf", "count is missing"]),
        (("count = 4", "counts = 4"), ["counts", "count"]),
        (("13500]", "'much']"), ["zspring.k", "much", "number"]),
        (("[frf]", "[set]\nzspring.k = 13000\n[frf]"), ["zspring.k", "[vary]", "[set]"]),
        (('"grid"', '"list"'), ["design list", "zspring.Mf has 4", "zspring.k has 2"]),
        (('"grid"', '"sobol"'), ["samples", "missing"]),
        (('"grid"', '"sobol"\nsamples = 10'), ["samples = 10", "power of 2"]),
        (('"grid"', '"grid"\nsamples = 8'), ["samples", "grid"]),
        (("[1, 4]", "[1, -4]"), ["[frf] amplitudes", "-4"]),
        (("3:8:0.5", "8:3:0.5"), ["[frf] frequencies", "8:3:0.5"]),
        (("amplitudes =", "amplitude ="), ["[frf]", "amplitude", "amplitudes"]),
        (("[1, 4]", "[1000]"), ["[frf]", "stroke"]),
        (("[frf]\namplitudes = [1, 4]\nfrequencies", "[set]\n#"), ["[frf]", "[static]"]),
        (("[vary]", "[varied]"), ["unknown key 'varied'; did you mean vary"]),
        (("[frf]", "[frff]\n[frf]"), ["unknown key 'frff'; did you mean frf"]),
        (("count = 4", "count = 4, scal = 1"), ["[vary] zspring.Mf: unknown key 'scal'; did you mean scale"]),
        (("from = 0.1", "from = false"), ["[vary] zspring.Mf.from = False: must be a number"]),
        (("to = 0.4", "to = inf"), ["[vary] zspring.Mf.to = inf: must be a finite number"]),
        (("count = 4", "count = 1000000000000"), ["[vary] zspring.Mf.count", "at most 1000000"]),
        (("count = 4", "count = 1"), ["[vary] zspring.Mf.count = 1: must be a whole number of at least 2"]),
        (("[12500, 13500]", "12500"), ["[vary] zspring.k = 12500: needs a range", "or a list"]),
        (("[12500, 13500]", "[true]"), ["[vary] zspring.k = 'True': must be a number"]),
        (("13500]", "nan]"), ["[vary] zspring.k = nan N/m: must be finite"]),
        (("[1, 4]", "[1, true]"), ["[frf] amplitudes = [1, True]: must be positive numbers"]),
        (("[1, 4]", "[1, 4]\nstroke = inf"), ["[frf] stroke = inf: must be a finite number"]),
        (("[1, 4]", "[1, 4]\nmin_periods = 2.5"), ["[frf] min_periods = 2.5: must be a whole number"]),
        (("[1, 4]", '[1, 4]\ndirection = "left"'), ['[frf] direction = \'left\': must be "up", "down" or "rest"']),
        (("[frf]", "[static]\nrate = 1\n[frf]"), ["[static] amplitudes is missing"]),
        (("[vary]", 'parameters = "mine.ssv"\n[vary]'), ["mine.ssv: no such file"]),
    ],
)
def test_a_bad_study_is_refused_with_one_clear_line(own_fmu, tmp_path, change, named):
    assert change[0] in QUICK
    with pytest.raises(ZSpringError) as error:
        study_of(QUICK.replace(*change), own_fmu, tmp_path)
    line = str(error.value)
    assert len(line.splitlines()) == 1 and line.startswith(f"{tmp_path / 'study.toml'}: ")
    assert all(word in line for word in named), line


@pytest.mark.parametrize(
    "arguments, named",
    [
        (["--scheduler", "nonsense"], ["nonsense", "port"]),
        (["--scheduler", "127.0.0.1:PORT", "--timeout", "1"], ["127.0.0.1:", "no answer in 1 s"]),
        (["--workers", "0"], ["--workers", "0"]),
    ],
)
def test_bad_options_get_one_clear_line(tmp_path, arguments, named):
    """The port is of a server that accepts connections and then says nothing."""
    (tmp_path / "study.toml").write_text(QUICK)
    with socket.create_server(("127.0.0.1", 0)) as server:
        arguments = [text.replace("PORT", str(server.getsockname()[1])) for text in arguments]
        _, err = zspring(tmp_path, "study", "study.toml", "--output", "out", *arguments, status=1)
    assert len(err.strip().splitlines()) == 1 and err.startswith("zspring: ")
    assert all(word in err for word in named), err
    assert not (tmp_path / "out").exists()
