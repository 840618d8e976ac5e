"""How many small faults the tests notice: planted one at a time, drawn at random, in a copy of the clone.

For each fault the tests that name the file's module run first, then all others, until one fails. Figures are left out,
as no test judges how they look. Each fault is a row of a CSV at once, so that after Ctrl-C the same command goes on.
A fault takes some ten seconds, and as long as all tests where nobody notices it.
"""

from __future__ import annotations

import argparse
import csv
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from fnmatch import fnmatch
from pathlib import Path

from tqdm import tqdm

from mutations import Mutation, cpp_mutations, python_mutations
from paths import ROOT
from zspring.fmu import CATENARY, PANTOGRAPH, installed_fmu

SOURCES = ("scripts/zspring/*.py", "fmu_src/*/*.cpp", "fmu_src/*/*.hpp")
LEFT_OUT = ("*/plot.py", "*/figures.py", "*/__init__.py", "*/__main__.py", "fmu_src/zig/*")
COLUMNS = ["number", "file", "line", "fault", "result", "noticed by"]
KILLED, SURVIVED, NOT_VIABLE = "killed", "survived", "not viable"
LONGEST = 1200  # s, of a run of tests; a fault that makes it endless is noticed by that
NOT_THESE = "not no_memory_error"  # builds everything anew, with sanitizers
# Where the tests of a C++ file are; those of a Python file name its module or its command.
TESTS_OF = {
    "fmu_src/pantograph": ("core", "fmi"),
    "fmu_src/catenary": ("line", "fmi"),
    "fmu_src": ("fmi", "core", "line"),
}


class Clone:
    """A copy of the clone's files with FMUs of its own, in which the tests run."""

    def __init__(self, folder: Path):
        self.folder, self.package = folder, folder / "scripts" / "zspring"
        listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
        for name in filter(None, listed.split("\0")):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
        shutil.copytree(ROOT / "resources", self.package / "resources", dirs_exist_ok=True)
        browser = ROOT / "tests" / "browser" / "node_modules"
        if browser.exists():
            os.symlink(browser, folder / "tests" / "browser" / "node_modules")
        for model in (PANTOGRAPH, CATENARY):
            shutil.copy2(installed_fmu(model), self.package)
        paths = [folder / "scripts", folder / "scripts" / "research"]
        self.environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join(map(str, paths)),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        self._is_configured = self._is_of_a_fault = False

    def built(self) -> bool:
        """Whether the C++ sources can be compiled; then the FMUs and test programs are of them."""
        build, cmake = self.folder / "build", [sys.executable, "-m", "cmake"]
        if not self._is_configured:
            own = ["-DZSPRING_TESTS=ON", f"-DPython3_EXECUTABLE={sys.executable}", "-DCMAKE_BUILD_TYPE=Release"]
            self._run(*cmake, "-S", self.folder, "-B", build, "-G", "Ninja", *own)
            self._is_configured = True
        if self._run(*cmake, "--build", build, "--target", "all", "probes").returncode:
            return False
        for model in (PANTOGRAPH, CATENARY):
            shutil.copy2(build / f"{model}.fmu", self.package)
        self.environment["ZSPRING_PROBES"] = str(build / "bin")
        return True

    def first_failure(self, *tests: str) -> str | None:
        """The first test that fails of these, or of all; None if none does."""
        chosen = [*tests, "-n", "0" if tests else "auto", "-k", NOT_THESE]
        try:
            done = self._run(sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *chosen)
        except subprocess.TimeoutExpired:
            return "no end"
        if done.returncode in (0, 5):  # 5: no test was chosen
            return None
        found = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", done.stdout, re.MULTILINE)
        return found[1] if found else (done.stdout.strip().splitlines() or ["nothing ran"])[-1]

    def tests_of(self, file: str) -> list[str]:
        """Test files for a source file, the closest ones first."""
        if file.startswith("fmu_src"):
            folders = next(names for start, names in TESTS_OF.items() if file.startswith(start))
            return [f"tests/{name}" for name in folders]
        module = ".".join(Path(file).with_suffix("").parts[1:])
        package, _, name = module.rpartition(".")
        words = [
            rf"\b{re.escape(module)}\b",
            rf"{re.escape(package)} import .*\b{name}\b",
            rf'"{package.partition(".")[2]}"',
        ]
        texts = {path: path.read_text("utf-8") for path in sorted(self.folder.glob("tests/*/test_*.py"))}
        near = [path for word in words for path, text in texts.items() if re.search(word, text)]
        return [str(path.relative_to(self.folder)) for path in dict.fromkeys(near) if "release" not in path.parts]

    def judge(self, file: str, mutation: Mutation) -> tuple[str, str]:
        """Result and first test that fails with a fault planted; the file is whole again afterwards."""
        path = self.folder / file
        kept, is_cpp = path.read_text("utf-8"), not file.endswith(".py")
        if self._is_of_a_fault and not is_cpp:
            self._is_of_a_fault = not self.built()
        try:
            path.write_text(mutation.text(), "utf-8")
            self._is_of_a_fault |= is_cpp
            if is_cpp and not self.built():
                return NOT_VIABLE, ""
            near = self.tests_of(file)
            failed = (near and self.first_failure(*near)) or self.first_failure()
            return (KILLED, failed) if failed else (SURVIVED, "")
        finally:
            path.write_text(kept, "utf-8")

    def _run(self, *command: object) -> subprocess.CompletedProcess:
        words = [str(word) for word in command]
        return subprocess.run(
            words, cwd=self.folder, env=self.environment, capture_output=True, text=True, timeout=LONGEST
        )


def drawn(only: str, count: int, seed: int) -> list[tuple[str, Mutation]]:
    """Faults drawn from all those of the files that fit the pattern, each as likely."""
    files = sorted({path for source in SOURCES for path in ROOT.rglob(source.rpartition("/")[2]) if path.is_file()})
    names = [path.relative_to(ROOT).as_posix() for path in files]
    names = [n for n in names if any(fnmatch(n, s) for s in SOURCES) and not any(fnmatch(n, x) for x in LEFT_OUT)]
    faults = []
    for name in (name for name in names if fnmatch(name, only)):
        source = (ROOT / name).read_text("utf-8")
        faults += [(name, m) for m in (python_mutations if name.endswith(".py") else cpp_mutations)(source)]
    return random.Random(seed).sample(faults, min(count, len(faults)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="of the draw (1)")
    parser.add_argument("--count", type=int, default=30, help="faults (30)")
    parser.add_argument("--only", default="*", metavar="GLOB", help="files, as 'fmu_src/*' or '*/study/*.py'")
    parser.add_argument("--output", type=Path, metavar="FILE", help="CSV (results/mutants-SEED.csv)")
    arguments = parser.parse_args()
    output = arguments.output or ROOT / "results" / f"mutants-{arguments.seed}.csv"
    faults = drawn(arguments.only, arguments.count, arguments.seed)
    rows = list(csv.DictReader(output.open(encoding="utf-8", newline=""))) if output.exists() else []
    for row, (file, mutation) in zip(rows, faults):
        if (row["file"], row["fault"]) != (file, mutation.fault):
            sys.exit(f"{output} is of other faults or sources: remove it, or give another --output")
    output.parent.mkdir(parents=True, exist_ok=True)
    try:
        with tempfile.TemporaryDirectory() as folder, output.open("a", encoding="utf-8", newline="") as file:
            clone, writer = Clone(Path(folder)), csv.DictWriter(file, COLUMNS, lineterminator="\n")
            if not rows:
                if failed := clone.first_failure():
                    sys.exit(f"without any fault fails {failed}")
                writer.writeheader()
            for number, (name, mutation) in enumerate(tqdm(faults[len(rows) :], unit=" faults"), len(rows)):
                result = clone.judge(name, mutation)
                rows.append(dict(zip(COLUMNS, (number, name, mutation.line, mutation.fault, *result))))
                writer.writerow(rows[-1])
                file.flush()
    except KeyboardInterrupt:
        print(f"interrupted: {len(rows)} of {len(faults)} faults are in {output}; the same command goes on")
    for row in rows:
        print(f"{row['result']:10s}  {row['file']}:{row['line']}  {row['fault']}  {row['noticed by']}")
    counts = Counter(row["result"] for row in rows)
    viable = counts[KILLED] + counts[SURVIVED]
    print(f"noticed {counts[KILLED]} of {viable}; {counts[NOT_VIABLE]} cannot be compiled; written: {output}")


if __name__ == "__main__":
    main()
