"""The release FMUs and their wheel: what the libraries for all platforms export and need, the archive, the source
form, and that the same sources give the same bytes."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import lief
import numpy as np
import pytest
from fmpy.model_description import read_build_description
from fmpy.validation import validate_fmu
from platform_runs import RUNS
from release_tools import DIST, PLATFORMS, ROOT, tool

import libraries
from zspring.fmu import CATENARY, PANTOGRAPH

MODELS = [PANTOGRAPH, CATENARY]
OLDEST_MACOS = {"darwin64": [10, 15, 0], "aarch64-darwin": [11, 0, 0]}

each_model = pytest.mark.parametrize("model", MODELS)
each_platform = pytest.mark.parametrize("platform", PLATFORMS)


@each_model
@each_platform
def test_exports_and_needs(release, model, platform):
    (file,) = (release[model].folder / "binaries" / platform).iterdir()
    library = libraries.read(file)
    assert libraries.exported(library) == libraries.fmi2_functions()
    assert libraries.foreign(library) == []
    if isinstance(library, lief.ELF.Binary):
        assert libraries.glibc_needed(library) <= (2, 17)
    if isinstance(library, lief.MachO.Binary):
        assert library.build_version.minos == OLDEST_MACOS[platform]
        assert library.has_code_signature == (platform == "aarch64-darwin")  # which that system demands


@each_model
@each_platform
def test_library_is_of_this_description_and_names_no_folder_of_the_build(release, model, platform):
    (file,) = (release[model].folder / "binaries" / platform).iterdir()
    content = file.read_bytes()
    assert release[model].description.guid.encode() in content
    for folder in ROOT, Path.home():
        assert os.fsencode(folder) + b"/" not in content


@each_model
def test_archive(release, model):
    assert validate_fmu(str(release[model].path)) == []
    with zipfile.ZipFile(release[model].path) as archive:
        names = archive.namelist()
        assert archive.testzip() is None
    assert {name.split("/")[1] for name in names if name.startswith("binaries/")} == set(PLATFORMS)
    assert not [
        name
        for name in names
        if Path(name).name.startswith("fmi2")  # the standard's headers
        and name.endswith(".h")
    ]
    compiled = [name.removeprefix("sources/") for name in names if name.endswith(".cpp")]
    assert compiled
    # of the model description and of buildDescription.xml, which is checked by its schema
    for configurations in (
        release[model].description.buildConfigurations,
        read_build_description(str(release[model].path)),
    ):
        (configuration,) = configurations
        assert configuration.modelIdentifier == model
        (sources,) = configuration.sourceFileSets
        assert sorted(sources.sourceFiles) == sorted(compiled)


@pytest.fixture(scope="module")
def compiled_sources(release, tmp_path_factory):
    """compiled_sources(model): the library that `fmpy compile` makes of the source form."""
    known: dict[str, Path] = {}

    def library(model: str) -> Path:
        if model not in known:
            tool("c++")
            folder = tmp_path_factory.mktemp("compiled")
            fmu = folder / f"{model}.fmu"
            with zipfile.ZipFile(release[model].path) as old, zipfile.ZipFile(fmu, "w") as new:
                for name in old.namelist():
                    if not name.startswith("binaries/"):
                        new.writestr(name, old.read(name))
            subprocess.run(
                [sys.executable, "-m", "fmpy", "compile", fmu],
                check=True,
                cwd=folder,
                env={**os.environ, "CMAKE_GENERATOR": "Ninja"},
            )
            fmpy.extract(str(fmu), str(folder / "fmu"))
            (known[model],) = (folder / "fmu" / "binaries" / "linux64").glob("*.so")
        return known[model]

    return library


@pytest.mark.parametrize("name", RUNS)
def test_source_form_compiles_and_gives_the_same_results(run, name, compiled_sources):
    model = RUNS[name][0]
    expected, result = run(name, "linux64"), run(name, "linux64", compiled_sources(model))
    moves = np.ptp(expected, axis=0) > 0
    assert (np.abs(result - expected)[:, moves] <= 1e-9 * np.ptp(expected, axis=0)[moves]).all()


def test_two_builds_are_the_same_bytes(tmp_path):
    copy = tmp_path / "a copy elsewhere"
    shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(".git", ".venv", "build*", "dist", "results"))
    (copy / ".venv").symlink_to(ROOT / ".venv")
    subprocess.run([sys.executable, copy / "scripts" / "tooling" / "release.py", tmp_path / "again"], check=True)
    first = {path.name: path.read_bytes() for path in DIST.iterdir()}
    again = {path.name: path.read_bytes() for path in (tmp_path / "again").iterdir()}
    assert first.keys() == again.keys()
    assert not [name for name in first if first[name] != again[name]]


def test_wheel_carries_the_release():
    (path,) = DIST.glob("*.whl")
    assert path.name.endswith("-py3-none-any.whl")
    with zipfile.ZipFile(path) as wheel:
        for model in MODELS:
            assert wheel.read(f"zspring/{model}.fmu") == (DIST / f"{model}.fmu").read_bytes()
            module = wheel.read(f"zspring/explore/{model}.wasm")
            assert module.startswith(b"\0asm") and os.fsencode(ROOT) + b"/" not in module
        names = set(wheel.namelist())
    for file in (ROOT / "scripts/zspring/explore").glob("*.[!w]*"):  # scripts and page; modules are above
        assert f"zspring/explore/{file.name}" in names
    for file in (ROOT / "resources").glob("*/*.ssv"):
        assert f"zspring/{file.relative_to(ROOT).as_posix()}" in names
