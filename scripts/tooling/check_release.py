"""Makes the release and runs both test suites on it; scripts/release_check starts it in .venv.

    scripts/release_check [pytest's arguments]

The tests find the package of the release's wheel, with the release FMUs, instead of the one built in this clone.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from pathlib import Path

from bootstrap import BUILD, PYTHON, ROOT, TOOLING

sys.path.append(str(ROOT / "tests" / "release"))
from release_tools import missing

INSTALLED = BUILD / "release" / "installed"
REPORT = BUILD / "release" / "tests.xml"
BOTH_SUITES = ["--override-ini=norecursedirs=.* node_modules", "tests"]  # pyproject.toml leaves out tests/release
IN_TURN = "--numprocesses=0"  # tests beside each other would disturb the times that are measured


def run(*command: str | Path, **variables: str) -> int:
    return subprocess.run([str(part) for part in command], cwd=ROOT, env={**os.environ, **variables}).returncode


def table(rows: list[tuple[str, int, int, float]]) -> str:
    """Lines of: what was checked, passed, failed, seconds."""
    lines = [f"{'release check':40} {'passed':>7} {'failed':>7} {'seconds':>8}"]
    lines += [f"{name:40} {good:7} {bad:7} {seconds:8.1f}" for name, good, bad, seconds in rows]
    return "\n".join(lines)


def test_rows() -> list[tuple[str, int, int, float]]:
    """One row for each file of tests in pytest's report."""
    rows: dict[str, tuple[int, int, float]] = {}
    for case in ET.parse(REPORT).iter("testcase"):
        name = (case.get("classname") or case.attrib["name"]).replace(".", "/")
        failed = any(child.tag in ("failure", "error", "skipped") for child in case)
        good, bad, seconds = rows.get(name, (0, 0, 0.0))
        rows[name] = good + (not failed), bad + failed, seconds + float(case.attrib["time"])
    return [(name, *rows[name]) for name in sorted(rows)]


def installed(rows: list[tuple[str, int, int, float]]) -> bool:
    """Whether the tests will find the wheel's package, and nothing else under its name; adds a row for it."""
    begin = time.monotonic()
    (wheel,) = (ROOT / "dist").glob("*.whl")
    shutil.rmtree(INSTALLED, ignore_errors=True)
    done = run(PYTHON, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target", INSTALLED, wheel) == 0
    found = f"import pathlib, zspring; assert pathlib.Path(zspring.__file__).parent.parent.samefile({str(INSTALLED)!r})"
    done = done and run(PYTHON, "-c", found, PYTHONPATH=str(INSTALLED)) == 0
    rows.append(("installation of the wheel", int(done), int(not done), time.monotonic() - begin))
    return done


def main() -> int:
    if len(sys.argv) == 1 and (lacking := missing()):
        sys.exit("\n".join(f"release check: {line}" for line in lacking))
    begin = time.monotonic()
    packaged = run(PYTHON, TOOLING / "release.py") == 0
    rows = [("scripts/package", int(packaged), int(not packaged), time.monotonic() - begin)]
    if packaged and installed(rows):
        arguments = sys.argv[1:]
        if not any((ROOT / argument.partition("::")[0]).exists() for argument in arguments):
            arguments += BOTH_SUITES
        REPORT.unlink(missing_ok=True)
        status = run(PYTHON, "-m", "pytest", f"--junitxml={REPORT}", IN_TURN, *arguments, PYTHONPATH=str(INSTALLED))
        found = test_rows() if REPORT.exists() else []
        rows += found
        if status and not any(failed for _, _, failed, _ in found):
            rows.append((f"pytest, status {status}", 0, 1, 0.0))
    print(table([*rows, ("all", *(sum(column) for column in list(zip(*rows))[1:]))]))
    return int(any(failed for _, _, failed, _ in rows))


if __name__ == "__main__":
    sys.exit(main())
