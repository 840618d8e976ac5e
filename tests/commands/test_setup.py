"""The set-up of the clone, scripts/tooling/bootstrap.py, with nothing installed."""

from __future__ import annotations

import contextlib
import importlib
import os
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from paths import SCRIPTS

TOOLING = SCRIPTS / "tooling"


@pytest.fixture
def bootstrap(monkeypatch, tmp_path):
    """The module, working in tmp_path. Its `stages` are those that were begun; those in `broken` fail."""
    monkeypatch.syspath_prepend(TOOLING)
    module = importlib.import_module("bootstrap")
    packages = tmp_path / "site-packages"
    (packages / "numpy").mkdir(parents=True)
    paths = {"STAMP": tmp_path / "stages.json", "BUILD": tmp_path / "build", "PYTHON": Path(sys.executable)}
    for name, path in paths.items():
        monkeypatch.setattr(module, name, path)
    monkeypatch.setattr(module, "site_packages", lambda: packages)
    module.stages, module.broken = [], {"package"}

    def begin(stage: str) -> str:
        module.stages.append(stage)
        if stage in module.broken:
            raise module.SetupError(f"no {stage}")
        (packages / "zspring").mkdir(exist_ok=True)
        return "c++"

    monkeypatch.setattr(module, "make_environment", lambda *_: begin("environment"))
    monkeypatch.setattr(module, "build_package", lambda *_: begin("package"))
    return module


def test_a_set_up_goes_on_with_the_stage_that_failed(bootstrap):
    with pytest.raises(bootstrap.SetupError, match="no package"):
        bootstrap.set_up(also=(), groups=())
    bootstrap.broken.clear()
    for _ in range(2):  # the second time all is there
        bootstrap.set_up(also=(), groups=())
    assert bootstrap.stages == ["environment", "package", "package"]


def test_a_dependency_that_is_lost_is_noticed_after_a_stage_that_failed(bootstrap):
    with pytest.raises(bootstrap.SetupError):
        bootstrap.set_up(also=(), groups=())
    assert bootstrap.read_stamp()["dependencies"] == ["numpy"]
    (bootstrap.site_packages() / "numpy").rmdir()
    assert bootstrap.read_stamp() == {}


def test_a_stamp_without_dependencies_is_completed(bootstrap):
    """As earlier versions left it when a stage failed."""
    bootstrap.broken.clear()
    bootstrap.set_up(also=(), groups=())
    stamp = bootstrap.read_stamp()
    bootstrap.write_stamp({key: stamp[key] for key in ("python", "requirements", "compiler")})
    bootstrap.set_up(also=(), groups=())
    assert bootstrap.stages == ["environment", "package", "package"]
    assert bootstrap.read_stamp()["dependencies"] == ["numpy"]


def test_measurements_need_no_browser_and_tests_need_all(bootstrap, monkeypatch):
    for stage, function in (
        ("extras", "install_extras"),
        ("research", "install_research"),
        ("browser", "install_browser"),
    ):
        monkeypatch.setattr(bootstrap, function, lambda *_, stage=stage: bootstrap.stages.append(stage))
    monkeypatch.setattr(bootstrap, "build_probes", lambda *_: bootstrap.stages.append("probes"))
    bootstrap.broken.clear()
    bootstrap.set_up(also=bootstrap.MEASUREMENTS, groups=())
    assert bootstrap.stages == ["environment", "package", "probes"]
    for folder in "zspring_research", "numpy":
        (bootstrap.site_packages() / folder).mkdir(exist_ok=True)
    monkeypatch.setattr(bootstrap, "PROBES", bootstrap.BUILD)
    bootstrap.set_up(also=bootstrap.TESTS, groups=())
    assert bootstrap.stages[3:] == ["extras", "research", "browser"]


@pytest.mark.parametrize("name", ["benchmark", "trust", "mutants"])
def test_what_a_script_starts_finds_its_modules(bootstrap, monkeypatch, name):
    """Each file of tests/measurements that a script names, in the environment that it is started in."""
    started = []
    monkeypatch.setattr(bootstrap, "set_up", lambda *_: None)
    monkeypatch.setattr(bootstrap.subprocess, "run", lambda command, env: started.append((command, env)) or sys.exit(0))
    monkeypatch.setattr(bootstrap.os, "execve", lambda program, command, env: started.append((command, env)))
    monkeypatch.setattr(sys, "argv", [name])
    with contextlib.suppress(SystemExit):  # on Windows
        runpy.run_path(str(SCRIPTS / name))
    monkeypatch.undo()
    (((_, file), environment),) = started
    paths = os.pathsep.join(filter(None, [environment.get("PYTHONPATH"), os.environ.get("PYTHONPATH")]))
    load = f"import runpy, sys; sys.path.insert(0, {str(Path(file).parent)!r}); runpy.run_path({file!r})"
    done = subprocess.run(
        [sys.executable, "-c", load], env={**environment, "PYTHONPATH": paths}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert environment["ZSPRING_PROBES"]
