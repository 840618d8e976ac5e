"""The second suite: what only a release needs to pass. scripts/release_check makes the release and runs it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import fmpy
import numpy as np
import pytest
from platform_runs import RUNS, TABLES, host_calls
from release_tools import DIST, PLATFORMS, tool
from windows_python import place_c_library

from harness import Fmu


@pytest.fixture(scope="session")
def release(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Fmu]:
    """The release FMUs in dist/ by model name, extracted."""
    files = sorted(DIST.glob("*.fmu"))
    if not files:
        pytest.fail("there is no release in dist/: run scripts/package", pytrace=False)
    folder = tmp_path_factory.mktemp("release")
    return {file.stem: Fmu(file, Path(fmpy.extract(str(file), str(folder / file.stem)))) for file in files}


@pytest.fixture(scope="session")
def host(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """host(platform): the program of host.c for that platform; for Windows beside Microsoft's own C library."""
    folder = tmp_path_factory.mktemp("host")
    headers = Path(fmpy.__file__).parent / "c-code"

    def compiled(platform: str) -> Path:
        program = folder / f"{platform}.exe"
        if not program.exists():
            system, target = PLATFORMS[platform]
            libraries = ["-ldl"] if system == "Linux" else []
            subprocess.run(
                [
                    sys.executable,
                    "-m",
                    "ziglang",
                    "cc",
                    f"--target={target}",
                    "-Wall",
                    "-Werror",
                    f"-I{headers}",
                    Path(__file__).with_name("host.c"),
                    "-o",
                    program,
                    *libraries,
                ],
                check=True,
            )
            if system == "Windows":
                place_c_library(folder)
        return program

    return compiled


@pytest.fixture(scope="session")
def wine_variables(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    """The environment of programs under wine, in which a folder of its own is drive C."""
    variables = {
        **os.environ,
        "WINEPREFIX": str(tmp_path_factory.mktemp("wine")),
        "WINEDEBUG": "-all",
        # Without the first it asks to install Mono and Gecko. The second is Microsoft's where it is beside the program.
        "WINEDLLOVERRIDES": "mscoree,mshtml=;ucrtbase=n,b",
    }
    yield variables
    if shutil.which("wineserver"):
        subprocess.run(["wineserver", "--kill"], env=variables)


@pytest.fixture(scope="session")
def emulated(wine_variables: dict[str, str]) -> Callable[..., str]:
    """emulated(platform, command, input): output of a program for that platform, run on x86_64 Linux."""

    def emulator(platform: str) -> list[str]:
        if platform == "win64":
            return [tool("wine")]
        if platform == "aarch64-linux":
            qemu = tool("qemu-aarch64")
            system = Path("/usr/aarch64-linux-gnu")
            if not (system / "lib").is_dir():
                pytest.fail(f"{system}/lib is missing: apt install libc6-arm64-cross", pytrace=False)
            return [qemu, "-L", str(system)]
        return []

    def run(platform: str, command: list[str | Path], text: str) -> str:
        done = subprocess.run(
            [*emulator(platform), *command], input=text, text=True, capture_output=True, env=wine_variables, timeout=600
        )
        assert done.returncode == 0, done.stderr[-2000:]
        return done.stdout

    return run


def location(folder: Path, platform: str) -> str:
    """The URI of a folder, as it is there: wine has the machine's root as drive Z."""
    return folder.as_uri().replace("file:///", "file:///Z:/" if platform == "win64" else "file:///")


@pytest.fixture(scope="session")
def run(release, host, emulated, tmp_path_factory) -> Callable[..., np.ndarray]:
    """run(name in RUNS, platform): Real outputs (times, outputs), computed once.

    library     another one than the release's
    """
    known: dict[tuple, np.ndarray] = {}
    folder = tmp_path_factory.mktemp("lines")

    def run_on(name: str, platform: str, library: Path | None = None) -> np.ndarray:
        key = name, platform, library
        if key not in known:
            fmu = release[RUNS[name][0]]
            library = library or next((fmu.folder / "binaries" / platform).iterdir())
            command = [host(platform), library, fmu.description.guid]
            if name in TABLES:
                copy = fmu.with_line(TABLES[name].content, folder / f"line über {len(known)} %")
                command[2:] = [fmu.description.guid + copy.told, location(copy.folder / "resources", platform)]
            lines = emulated(platform, command, host_calls(fmu.description, name)).splitlines()
            values = np.array([np.frombuffer(bytes.fromhex(line), ">f8") for line in lines])
            known[key] = values.astype(float)
        return known[key]

    return run_on
