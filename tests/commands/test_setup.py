"""The set-up of the clone, scripts/tooling/bootstrap.py, with nothing installed."""

from __future__ import annotations

import importlib
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
        bootstrap.set_up(with_probes=False, groups=())
    bootstrap.broken.clear()
    for _ in range(2):  # the second time all is there
        bootstrap.set_up(with_probes=False, groups=())
    assert bootstrap.stages == ["environment", "package", "package"]


def test_a_dependency_that_is_lost_is_noticed_after_a_stage_that_failed(bootstrap):
    with pytest.raises(bootstrap.SetupError):
        bootstrap.set_up(with_probes=False, groups=())
    assert bootstrap.read_stamp()["dependencies"] == ["numpy"]
    (bootstrap.site_packages() / "numpy").rmdir()
    assert bootstrap.read_stamp() == {}


def test_a_stamp_without_dependencies_is_completed(bootstrap):
    """As earlier versions left it when a stage failed."""
    bootstrap.broken.clear()
    bootstrap.set_up(with_probes=False, groups=())
    stamp = bootstrap.read_stamp()
    bootstrap.write_stamp({key: stamp[key] for key in ("python", "requirements", "compiler")})
    bootstrap.set_up(with_probes=False, groups=())
    assert bootstrap.stages == ["environment", "package", "package"]
    assert bootstrap.read_stamp()["dependencies"] == ["numpy"]
