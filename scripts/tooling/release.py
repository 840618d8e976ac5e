"""Makes the release FMUs and the wheel that carries them, as WebAssembly too; scripts/package starts it in .venv.

    scripts/package [FOLDER]    FOLDER is where they go (dist)

Each FMU holds a library for every platform, cross built with zig, and the model's source form. The same sources
give the same bytes. A platform that cannot be built is told in one line and the others are still tried, but
nothing is written to FOLDER then.
"""

from __future__ import annotations

import argparse
import os
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import webassembly
from bootstrap import BIN, BUILD, CMAKE, PYTHON, ROOT, environment
from mach_o import make_reproducible
from setup_tools import Runner, SetupError, lock

sys.path.insert(0, str(ROOT / "fmu_src"))
from package_fmu import write_fmu
from source_form import source_form

# FMI platform: (system in CMake's words, zig's target with the oldest C library or macOS that is supported)
PLATFORMS = {
    "linux64": ("Linux", "x86_64-linux-gnu.2.17"),
    "aarch64-linux": ("Linux", "aarch64-linux-gnu.2.17"),
    "win64": ("Windows", "x86_64-windows-gnu"),
    "darwin64": ("Darwin", "x86_64-macos.10.15"),
    "aarch64-darwin": ("Darwin", "aarch64-macos.11.0"),
}
SUFFIXES = {"Linux": ".so", "Windows": ".dll", "Darwin": ".dylib"}
RELEASE_BUILD = BUILD / "release"
WHEEL_EPOCH = "315532800"  # 1980-01-01, the first day of zip archives


def say(message: str) -> None:
    print(f"package: {message}", file=sys.stderr, flush=True)


def build(platform: str, descriptor: int) -> Path:
    """Cross build the libraries of one platform; returns the build directory. Raises SetupError."""
    system, target = PLATFORMS[platform]
    folder = RELEASE_BUILD / platform
    folder.mkdir(parents=True, exist_ok=True)
    toolchain = folder / "toolchain.cmake"
    toolchain.write_text(
        f"set(CMAKE_SYSTEM_NAME {system})\n"
        f"set(CMAKE_SYSTEM_PROCESSOR {target.split('-')[0]})\n"
        f'set(CMAKE_CXX_COMPILER "{(BIN / "python-zig").as_posix()}" c++)\n'
        f"set(CMAKE_CXX_COMPILER_TARGET {target})\n"
    )
    log = RELEASE_BUILD / f"{platform}.log"
    log.unlink(missing_ok=True)
    runner = Runner(log, ROOT, environment(), descriptor)
    runner.run(
        f"{platform}: cannot configure the build",
        [
            *CMAKE,
            "-S",
            ROOT,
            "-B",
            folder,
            "-G",
            "Ninja",
            f"-DCMAKE_MAKE_PROGRAM={BIN / 'ninja'}",
            f"-DCMAKE_TOOLCHAIN_FILE={toolchain}",
            f"-DPython3_EXECUTABLE={PYTHON}",
        ],
    )
    runner.run(f"{platform}: cannot build the libraries", [*CMAKE, "--build", folder])
    for library in folder.glob("*.dylib"):
        try:
            make_reproducible(library)
        except ValueError as error:
            raise SetupError(f"{platform}: {library.name}: {error}") from None
    return folder


def build_all(descriptor: int) -> dict[str, Path]:
    """Build directories by platform. Raises SetupError, after all were tried, if any failed."""
    builds, failures = {}, []
    for number, platform in enumerate(PLATFORMS, 1):
        say(f"building {platform} ({number}/{len(PLATFORMS)}, at the first time one to four minutes)")
        try:
            builds[platform] = build(platform, descriptor)
        except SetupError as error:
            failures.append(str(error))
    if failures:
        raise SetupError("\npackage: ".join(failures))
    return builds


def cached(build_folder: Path, variable: str) -> Path:
    """A path among the settings of a CMake build."""
    lines = (build_folder / "CMakeCache.txt").read_text().splitlines()
    return Path(next(line.partition("=")[2] for line in lines if line.startswith(f"{variable}:")))


def write_fmus(builds: dict[str, Path], output: Path) -> list[Path]:
    """Write the FMU of every model that the builds made. Raises SetupError if their descriptions differ."""
    written = []
    some_build = next(iter(builds.values()))
    eigen = cached(some_build, "EIGEN3_INCLUDE_DIR")
    for description in sorted(some_build.glob("generated/*/modelDescription.xml")):
        model = description.parent.name
        for platform, folder in builds.items():
            if (folder / description.relative_to(some_build)).read_bytes() != description.read_bytes():
                raise SetupError(f"{model}: the model description for {platform} differs from the others")
        name = next(ET.parse(description).iter("CoSimulation")).attrib["modelIdentifier"]
        libraries = {
            platform: folder / (name + SUFFIXES[PLATFORMS[platform][0]]) for platform, folder in builds.items()
        }
        fmu = output / f"{name}.fmu"
        write_fmu(
            description, ROOT / "resources" / model, fmu, libraries, source_form(name, model, description.parent, eigen)
        )
        written.append(fmu)
    return written


def build_modules(descriptor: int) -> dict[str, Path]:
    """The models as WebAssembly modules, by identifier. Raises SetupError."""
    say("building the WebAssembly modules (at the first time one to four minutes)")
    log = RELEASE_BUILD / "webassembly.log"
    log.unlink(missing_ok=True)
    return webassembly.build(Runner(log, ROOT, environment(), descriptor))


def write_wheel(fmus: list[Path], modules: dict[str, Path], output: Path, descriptor: int) -> Path:
    """Write the wheel for any platform, with these FMUs and WebAssembly modules inside."""
    for old in output.glob("zspring-*.whl"):
        old.unlink()
    runner = Runner(RELEASE_BUILD / "wheel.log", ROOT, environment(), descriptor)
    places = {fmu: fmu.name for fmu in fmus} | {module: f"explore/{module.name}" for module in modules.values()}
    contents = [f"--config-settings=wheel.force-include.{path}=zspring/{place}" for path, place in places.items()]
    runner.run(
        "cannot build the wheel",
        [
            PYTHON,
            "-m",
            "pip",
            "wheel",
            "--no-build-isolation",
            "--no-deps",
            "--wheel-dir",
            output,
            "--config-settings=wheel.cmake=false",
            *contents,
            ROOT,
        ],
        SOURCE_DATE_EPOCH=WHEEL_EPOCH,
    )
    (wheel,) = output.glob("zspring-*.whl")
    return wheel


def main() -> None:
    parser = argparse.ArgumentParser(prog="scripts/package", description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / "dist", help="where they go (dist)")
    output = parser.parse_args().folder.resolve()
    try:
        with lock(BUILD / "package.lock") as descriptor:
            builds = build_all(descriptor)
            modules = build_modules(descriptor)
            output.mkdir(parents=True, exist_ok=True)
            fmus = write_fmus(builds, output)
            written = [*fmus, write_wheel(fmus, modules, output, descriptor)]
    except (SetupError, OSError) as error:
        sys.exit(f"package: {error}")
    except KeyboardInterrupt:
        sys.exit("package: interrupted; start it again to go on")
    print("written:", *(os.path.relpath(path) for path in written))


if __name__ == "__main__":
    main()
