"""Set-up shared by the commands in scripts/: the built package in the virtual environment .venv.

Done in stages, each repeated when what it depends on has changed: the environment with the dependencies of
pyproject.toml, the package zspring with its FMUs; for measurements the C++ probes, for the tests also all extras of
pyproject.toml and a headless browser; for a release its dependency groups. A stage is struck from the stamp file before
it starts and written there when it is complete, so an interruption costs that stage only.
Needs nothing but the standard library.
"""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from setup_tools import Runner, SetupError, lock, say, system_compiler

TOOLING = Path(__file__).resolve().parent
ROOT = TOOLING.parents[1]
VENV = ROOT / ".venv"
BIN = VENV / ("Scripts" if os.name == "nt" else "bin")
PYTHON = BIN / ("python.exe" if os.name == "nt" else "python")
CMAKE: list[str | Path] = [PYTHON, "-m", "cmake"]
STAMP = VENV / "stages.json"
BUILD = ROOT / "build"
PACKAGE_BUILD = BUILD / "package"
PROBES_BUILD = BUILD / "probes"
PROBES = PROBES_BUILD / "bin"
BROWSER = ROOT / "tests" / "browser"
ZIG = "python-zig c++"  # from the package ziglang, for systems without a C++ compiler

DESCRIPTIONS = ["modelDescription.xml", "modelDescription.catenary.xml"]
PROBE_SOURCES = [*DESCRIPTIONS, "CMakeLists.txt", "fmu_src", "tests/native"]
PACKAGE_SOURCES = [
    *DESCRIPTIONS,
    "CMakeLists.txt",
    "LICENSE",
    "README.md",
    "pyproject.toml",
    "fmu_src",
    "resources",
    "scripts/zspring",
]
RESEARCH = "scripts/research"

# Stages beyond the environment and the package.
MEASUREMENTS = ("probes",)
TESTS = ("extras", "research", "probes", "browser")


def environment() -> dict[str, str]:
    """Environment variables for all commands: the user's, without what would reach around .venv."""
    inherited = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PYTHONHOME")}
    path = os.pathsep.join([*filter(None, [os.environ.get("PATH")]), str(BIN)])
    return {**inherited, "PATH": path, "PIP_USER": "0", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}


def fingerprint(*paths: str, also: str = "") -> str:
    """Hash of the files at or below `paths` and of the text `also`."""
    digest = hashlib.sha256(also.encode())
    for path in paths:
        top = ROOT / path
        for file in sorted(top.rglob("*")) if top.is_dir() else [top]:
            if file.is_file() and file.suffix != ".pyc":
                content = file.read_bytes()
                digest.update(f"{file.relative_to(ROOT).as_posix()} {len(content)} ".encode() + content)
    return digest.hexdigest()


def site_packages() -> Path:
    if os.name == "nt":
        return VENV / "Lib" / "site-packages"
    return VENV / "lib" / f"python{sys.version_info[0]}.{sys.version_info[1]}" / "site-packages"


def installed() -> set[str]:
    """Names of all that is installed in .venv."""
    return set(os.listdir(site_packages())) - {"__pycache__"}


def read_stamp() -> dict:
    """Complete stages with their fingerprints; those that were damaged since are missing."""
    try:
        stamp = json.loads(STAMP.read_text())
        names = installed()
    except (OSError, ValueError):
        return {}
    if not (PYTHON.exists() and names.issuperset(stamp.get("dependencies", ()))):
        return {}
    if "zspring" not in names:
        stamp.pop("package", None)
    if "zspring_research" not in names:
        stamp.pop("research", None)
    if not PROBES.is_dir():
        stamp.pop("probes", None)
    if not (BROWSER / "node_modules").is_dir():
        stamp.pop("browser", None)
    return stamp


def write_stamp(stamp: dict) -> None:
    unfinished = STAMP.with_suffix(".part")
    unfinished.write_text(json.dumps(stamp))
    os.replace(unfinished, STAMP)


def note_dependencies(stamp: dict) -> None:
    """Write the stamp with what is installed now, so that a dependency that is lost is noticed."""
    stamp["dependencies"] = sorted(name for name in installed() if "spring" not in name)
    write_stamp(stamp)


def make_environment(runner: Runner, keep: bool) -> str:
    """Make .venv, or update one that is to be kept; returns the compiler's command."""
    if importlib.util.find_spec("ensurepip") is None:
        raise SetupError("Python's venv with ensurepip is missing (Debian, Ubuntu: apt install python3-venv)")
    compiler = system_compiler()
    if not keep:
        say(f"making .venv with Python {sys.version_info[0]}.{sys.version_info[1]}")
        runner.run("cannot make .venv", [sys.executable, "-m", "venv", "--clear", VENV])

    say(
        "installing the dependencies"
        + ("" if compiler else " and, as there is no C++ compiler, zig")
        + " (one to three minutes)"
    )
    install_requirements(runner, *(["build"] if compiler else ["build", "zig"]))
    return compiler or ZIG


def install_requirements(runner: Runner, *groups: str) -> None:
    """Install what pyproject.toml requires: always and in these dependency groups, or all "extras"."""
    listing = subprocess.run(
        [PYTHON, TOOLING / "requirements.py", ROOT / "pyproject.toml", *groups],
        env=environment(),
        check=True,
        capture_output=True,
        text=True,
    )
    runner.run(
        "cannot install the dependencies (is there a network?)",
        [PYTHON, "-m", "pip", "install", "--progress-bar=off", *listing.stdout.splitlines()],
    )


def install_extras(runner: Runner, _compiler: str) -> None:
    say("installing what the tests and all studies need (one to three minutes)")
    install_requirements(runner, "extras")


def install_group(group: str, runner: Runner, _compiler: str) -> None:
    say(f"installing the dependency group {group} (up to three minutes)")
    install_requirements(runner, group)


def python_identity() -> str:
    return f"{sys.version_info[0]}.{sys.version_info[1]} {VENV}"


def use_compiler(build: Path, compiler: str) -> None:
    """Empty a build directory of another compiler, Python or path: CMake keeps those it first found."""
    note = build.with_suffix(".made-with")
    identity = f"{compiler}\n{python_identity()}\n"
    if not (note.exists() and note.read_text() == identity):
        shutil.rmtree(build, ignore_errors=True)
        build.mkdir(parents=True)
        note.write_text(identity)


def how_long(compiler: str) -> str:
    # zig first compiles the C++ library itself.
    return "at the first time one to four minutes" if compiler == ZIG else "less than a minute"


def build_package(runner: Runner, compiler: str) -> None:
    """Build the FMU and install the package with it, as a user's `pip install .` does."""
    say(f"building and installing the FMU with {compiler} ({how_long(compiler)})")
    use_compiler(PACKAGE_BUILD, compiler)
    for pattern in ("zspring", "zspring-*", "~spring*"):  # the last: what an interrupted pip leaves
        for leftover in site_packages().glob(pattern):
            shutil.rmtree(leftover, ignore_errors=True)
    runner.run(
        "cannot build the package",
        [PYTHON, "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index", ROOT],
        CXX=compiler,
        SKBUILD_BUILD_DIR=str(PACKAGE_BUILD),
    )


def install_research(runner: Runner, _compiler: str) -> None:
    """Install the commands of scripts/research, a package of its own."""
    runner.run(
        "cannot install scripts/research",
        [PYTHON, "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index", ROOT / RESEARCH],
    )


def build_probes(runner: Runner, compiler: str) -> None:
    """Build the C++ programs of tests/native."""
    say(f"building the C++ test probes ({how_long(compiler)})")
    use_compiler(PROBES_BUILD, compiler)
    failure = "cannot build the test probes"
    settings = ["-DZSPRING_TESTS=ON", f"-DCMAKE_MAKE_PROGRAM={BIN / 'ninja'}", f"-DPython3_EXECUTABLE={PYTHON}"]
    runner.run(failure, [*CMAKE, "-S", ROOT, "-B", PROBES_BUILD, "-G", "Ninja", *settings], CXX=compiler)
    runner.run(failure, [*CMAKE, "--build", PROBES_BUILD, "--target", "probes"])


def install_browser(runner: Runner, _compiler: str) -> None:
    """Install what tests/browser/package.json names, with the npm of .venv: the browser is in an npm package."""
    say("installing a headless browser for the tests (less than a minute)")
    runner.run(
        "cannot install the browser (is there a network?)",
        [BIN / "npm", "install", "--prefix", BROWSER, "--no-package-lock", "--no-audit", "--no-fund"],
        PATH=os.pathsep.join([str(BIN), os.environ.get("PATH", "")]),
    )  # .venv's node before any other


def set_up(also: Sequence[str], groups: Sequence[str]) -> None:
    """Bring .venv and the builds up to date, these stages and groups as well; returns at once where they are."""
    wanted = {
        "python": python_identity(),
        "requirements": fingerprint("pyproject.toml", also=os.environ.get("CXX", "")),
        "package": fingerprint(*PACKAGE_SOURCES),
    }
    sources = {
        "research": (RESEARCH, "modelDescription.xml"),
        "probes": PROBE_SOURCES,
        "browser": ("tests/browser/package.json",),
    }
    for stage in also:
        wanted[stage] = fingerprint(*sources[stage]) if stage in sources else wanted["requirements"]
    for group in groups:
        wanted[group] = wanted["requirements"]

    def outdated(stage: str) -> bool:
        return stamp.get(stage) != wanted[stage]

    stamp = read_stamp()
    if not any(map(outdated, wanted)):
        return
    with lock(BUILD / "setup.lock") as descriptor:
        runner = Runner(BUILD / "setup.log", ROOT, environment(), descriptor)
        begin = time.monotonic()
        stamp = read_stamp()  # as a set-up that was waited for left it
        if outdated("python") or outdated("requirements"):
            keep = not outdated("python")
            STAMP.unlink(missing_ok=True)
            compiler = make_environment(runner, keep)
            stamp = {stage: wanted[stage] for stage in ("python", "requirements")}
            stamp["compiler"] = compiler
            note_dependencies(stamp)
        stages = {
            "extras": install_extras,
            "package": build_package,
            "research": install_research,
            "probes": build_probes,
            "browser": install_browser,
        }
        stages |= {group: partial(install_group, group) for group in groups}
        for stage, build in stages.items():
            if stage in wanted and outdated(stage):
                stamp.pop(stage, None)
                write_stamp(stamp)
                build(runner, stamp["compiler"])
                stamp[stage] = wanted[stage]
                note_dependencies(stamp)
        say(f"ready after {time.monotonic() - begin:.0f} s")


def run(command: list[str], also: Sequence[str] = (), groups: Sequence[str] = (), folder: Path | None = None) -> None:
    """Set up, then become `command`, whose first item is a program of .venv; `folder` is where to start it.

    `also` are MEASUREMENTS or TESTS: with probes it finds the folder of the C++ test programs in the environment
    variable ZSPRING_PROBES, and the modules of tests/helpers. `groups` are dependency groups of pyproject.toml to
    install as well.
    """
    try:
        set_up(also, groups)
    except (SetupError, OSError) as error:
        sys.exit(f"set-up: {error}")
    except KeyboardInterrupt:
        sys.exit("set-up: interrupted; start it again to go on")
    variables = environment()
    if "probes" in also:
        variables |= {"ZSPRING_PROBES": str(PROBES), "PYTHONPATH": str(ROOT / "tests" / "helpers")}
    program = [str(BIN / command[0]), *command[1:]]
    if folder:
        os.chdir(folder)
    if os.name == "nt":  # there exec would return to the prompt at once
        sys.exit(subprocess.run(program, env=variables).returncode)
    os.execve(program[0], program, variables)
