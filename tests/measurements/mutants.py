"""How many small faults the tests notice: planted one at a time, drawn at random, in a copy of the clone.

The kinds are the same in Python (by its syntax tree) and in C++ (by its tokens): comparisons, arithmetic and logical
operators, signs, constants and indices, conditions turned round, arguments swapped, statements left out. For each fault
the tests that name the file's module run first, then all others, until one fails. Figures are left out, as no test
judges how they look. A fault that nobody notices takes as long as all tests; many such change nothing that matters.
"""

from __future__ import annotations

import argparse
import ast
import csv
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path
from typing import NamedTuple

from tqdm import tqdm

from commands import begin, end_all
from paths import ROOT
from zspring.fmu import CATENARY, PANTOGRAPH, installed_fmu

LEFT_OUT = ("*/plot.py", "*/figures.py", "*/__init__.py", "*/__main__.py", "fmu_src/zig/*")
COLUMNS = ["file", "line", "fault", "result", "noticed by"]
KILLED, SURVIVED, NOT_VIABLE = "noticed", "NOT NOTICED", "not viable"
LONGEST = 1200  # s, of a run of tests; a fault that makes it endless is noticed by that
NOT_THESE = "not no_memory_error and not test_style"  # builds anew with sanitizers; runs nothing
# Where the tests of a C++ file are; those of a Python file name its module or its command.
TESTS_OF = {"fmu_src/pantograph": ["core", "fmi"], "fmu_src/catenary": ["line", "fmi"], "fmu_src": ["fmi", "core"]}

COMPARE = {"Lt": "LtE Gt", "LtE": "Lt GtE", "Gt": "GtE Lt", "GtE": "Gt LtE", "Eq": "NotEq", "NotEq": "Eq"}
COMPARE |= {"Is": "IsNot", "IsNot": "Is", "In": "NotIn", "NotIn": "In"}
ARITHMETIC = {"Add": "-", "Sub": "+", "Mult": "/", "Div": "*", "Pow": "*", "FloorDiv": "*", "Mod": "*"}
TOKENS = {" < ": "<= >", " > ": ">= <", " <= ": "< >=", " >= ": "> <=", " == ": "!=", " != ": "=="}
TOKENS |= {" && ": "||", " || ": "&&", " + ": "-", " - ": "+", " * ": "/", " / ": "*", " += ": "-=", " -= ": "+="}
PATTERNS = {
    r"(?<=[(=,] )-(?=[\w(])|(?<=\()-(?=[\w(])|(?<=return )-|!(?=[\w(])": "",
    r"\btrue\b": "false",
    r"\bfalse\b": "true",
    r"(?<![\w.])\d+(?![\w.])": r"(\g<0> + 1)",
    r"(?<![\w.])\d+(?:\.\d*|(?=e))(?:e[-+]?\d+)?(?![\w.])": r"(2 * \g<0>)",
    r"(?<=\bif )\((?!constexpr).+\)(?= return| throw| continue| break| \w[\w.]* [-+]?= )": r"(!\g<0>)",
    r"(?m)^ +(?!(?:return|throw|const|using|auto|else|case) )[\w.:>\[\]-]+(?:\(.*\)| [-+*/]?= .*);$": ";",
}


class Fault(NamedTuple):
    """In the text of a file a part is replaced."""

    file: str
    text: str
    begin: int
    end: int
    new: str

    @property
    def changed(self) -> str:
        return self.text[: self.begin] + self.new + self.text[self.end :]

    @property
    def line(self) -> int:
        return self.text.count("\n", 0, self.begin) + 1

    def __str__(self) -> str:
        """The line, or lines, with what is replaced and by what between brackets."""
        first, last = self.text.rfind("\n", 0, self.begin) + 1, self.text.find("\n", self.end)
        before, old, after = self.text[first : self.begin], self.text[self.begin : self.end], self.text[self.end : last]
        return " ".join(f"{before}[{old} -> {self.new}]{after}".split())[:240]


def python_faults(source: str) -> Iterator[tuple[int, int, str]]:
    """Begin, end and replacement of each fault."""
    tree, starts = ast.parse(source), [0]
    for line in source.encode().splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def place(line: int, column: int) -> int:
        """In characters: the syntax tree counts bytes."""
        return len(source.encode()[: starts[line - 1] + column].decode())

    formats = [node for node in ast.walk(tree) if isinstance(node, ast.JoinedStr)]
    ignored = {id(child) for node in formats for child in ast.walk(node)}  # before Python 3.12 they have no places
    ignored |= {
        id(child) for node in ast.walk(tree) for child in ast.walk(getattr(node, "annotation", None) or ast.Pass())
    }
    for node in ast.walk(tree):
        if id(node) not in ignored:
            for target, new in python_variants(node):
                yield place(target.lineno, target.col_offset), place(target.end_lineno, target.end_col_offset), new


def python_variants(node: ast.AST) -> Iterator[tuple[ast.AST, str]]:
    """What to replace by what, for each fault that fits the node."""
    kind = type(getattr(node, "op", None)).__name__
    match node:
        case ast.Compare():
            for other in COMPARE[type(node.ops[0]).__name__].split():
                ops = [getattr(ast, other)(), *node.ops[1:]]
                yield node, f"({ast.unparse(ast.Compare(node.left, ops, node.comparators))})"
        case ast.BinOp() if kind in ARITHMETIC and "/ '" not in ast.unparse(node):  # paths
            yield node, f"(({ast.unparse(node.left)}) {ARITHMETIC[kind]} ({ast.unparse(node.right)}))"
        case ast.AugAssign() if kind in ARITHMETIC:
            yield node, f"{ast.unparse(node.target)} {ARITHMETIC[kind]}= {ast.unparse(node.value)}"
            yield node, "pass"
        case ast.UnaryOp() if kind in ("USub", "Not"):
            yield node, f"({ast.unparse(node.operand)})"
        case ast.BoolOp():
            yield node, f"({(' or ' if kind == 'And' else ' and ').join(f'({ast.unparse(v)})' for v in node.values)})"
        case ast.Constant(value=bool()):
            yield node, str(not node.value)
        case ast.Constant(value=int()):
            yield node, str(node.value + 1)
            yield node, f"({node.value - 1})"
        case ast.Constant(value=float()):
            yield node, repr(2 * node.value or 1.0)
        case ast.IfExp() | ast.If() | ast.While():
            yield node.test, f"(not ({ast.unparse(node.test)}))"
        case ast.Call(args=[first, second, *_]) if not isinstance(first, ast.Starred) and not isinstance(
            second, ast.Starred
        ):
            swapped = ast.Call(node.func, [second, first, *node.args[2:]], node.keywords)
            yield node, ast.unparse(ast.fix_missing_locations(swapped))
        case ast.Expr(value=ast.Call()) | ast.Raise():
            yield node, "pass"
        case ast.Return() if node.value and ast.unparse(node.value) != "None":
            yield node, "return None"


def cpp_faults(source: str) -> Iterator[tuple[int, int, str]]:
    """Begin, end and replacement of each fault; comments, texts and directives are passed over."""
    passed_over = r'//.*|"(?:\\.|[^"\\\n])*"|(?m:^[ ]*(?:#|template|static_assert).*)'
    code = re.sub(passed_over, lambda found: "\v" * len(found[0]), source)
    for token, others in TOKENS.items():
        for found in re.finditer(re.escape(token), code):
            yield from ((found.start() + 1, found.end() - 1, other) for other in others.split())
    for pattern, replacement in PATTERNS.items():
        yield from ((*found.span(), found.expand(replacement)) for found in re.finditer(pattern, code))


def drawn(only: str, count: int, seed: int) -> list[Fault]:
    """Faults drawn from all those of the files that fit the pattern, each as likely."""
    faults = []
    for path in sorted([*ROOT.glob("scripts/zspring/**/*.py"), *ROOT.glob("fmu_src/*/**/*.?pp")]):
        name = path.relative_to(ROOT).as_posix()
        if fnmatch(name, only) and not any(fnmatch(name, pattern) for pattern in LEFT_OUT):
            text, places = path.read_text("utf-8"), python_faults if name.endswith(".py") else cpp_faults
            faults += [Fault(name, text, *place) for place in places(text) if text[place[0] : place[1]] != place[2]]
    return random.Random(seed).sample(faults, min(count, len(faults)))


class Clone:
    """A copy of the clone's files with FMUs of its own, in which the tests run."""

    def __init__(self, folder: Path):
        self.folder, self.package = folder, folder / "scripts" / "zspring"
        listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
        for name in filter(None, listed.split("\0")):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
        shutil.copytree(ROOT / "resources", self.package / "resources", dirs_exist_ok=True)
        os.symlink(ROOT / "tests" / "browser" / "node_modules", folder / "tests" / "browser" / "node_modules")
        for model in (PANTOGRAPH, CATENARY):
            shutil.copy2(installed_fmu(model), self.package)
        paths = os.pathsep.join(str(folder / name) for name in ("scripts", "scripts/research"))
        self.environment = {**os.environ, "PYTHONPATH": paths, "PYTHONDONTWRITEBYTECODE": "1"}
        self._built_from: Fault | None = None

    def judge(self, fault: Fault) -> tuple[str, str]:
        """Result, and the first test that fails with the fault planted; the file is whole again afterwards."""
        path, is_cpp = self.folder / fault.file, not fault.file.endswith(".py")
        if self._built_from and not is_cpp:
            self._build(None)
        try:
            path.write_text(fault.changed, "utf-8")
            if is_cpp and not self._build(fault):
                return NOT_VIABLE, ""
            near = self._tests_of(fault.file)
            failed = (near and self.first_failure(*near)) or self.first_failure()
            return (KILLED, failed) if failed else (SURVIVED, "")
        finally:
            path.write_text(fault.text, "utf-8")

    def first_failure(self, *tests: str) -> str | None:
        """The first test that fails of these, or of all; None if none does."""
        chosen = [*tests, "-n", "0"] if tests else []
        try:
            status, printed = self._run("-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "-k", NOT_THESE, *chosen)
        except subprocess.TimeoutExpired:
            return "no end"
        if status in (0, 5):  # 5: no test was chosen
            return None
        found = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", printed, re.MULTILINE)
        return found[1] if found else (printed.strip().splitlines() or ["nothing ran"])[-1]

    def _build(self, fault: Fault | None) -> bool:
        """Whether the C++ sources, with this fault in them, can be compiled; then FMUs and probes are of them."""
        self._built_from, build = fault, self.folder / "build"
        if not build.exists():
            own = ["-DZSPRING_TESTS=ON", f"-DPython3_EXECUTABLE={sys.executable}"]
            self._run("-m", "cmake", "-S", self.folder, "-B", build, "-G", "Ninja", *own)
        if self._run("-m", "cmake", "--build", build, "--target", "all", "probes")[0]:
            return False
        for model in (PANTOGRAPH, CATENARY):
            shutil.copy2(build / f"{model}.fmu", self.package)
        self.environment["ZSPRING_PROBES"] = str(build / "bin")
        return True

    def _tests_of(self, file: str) -> list[str]:
        if file.startswith("fmu_src"):
            return [f"tests/{name}" for name in next(TESTS_OF[start] for start in TESTS_OF if file.startswith(start))]
        *_, package, name = Path(file).with_suffix("").parts
        words = rf"\b{package}\.{name}\b", rf"\b{package} import .*\b{name}\b", f'"{package}"'
        texts = {
            path: path.read_text("utf-8") for path in sorted(self.folder.glob("tests/[!r]*/test_*.py"))
        }  # no release
        near = [path for word in words for path, text in texts.items() if re.search(word, text)]
        return [str(path.relative_to(self.folder)) for path in dict.fromkeys(near)]

    def _run(self, *arguments: object) -> tuple[int, str]:
        """Status and output of Python with these arguments; nothing of it runs on, whatever happens."""
        words, own = [sys.executable, *map(str, arguments)], {"cwd": self.folder, "env": self.environment, "text": True}
        process = begin(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **own)
        try:
            printed, _ = process.communicate(timeout=LONGEST)
            return process.returncode, printed
        finally:
            end_all()


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
    if any((row["file"], row["fault"]) != (fault.file, str(fault)) for row, fault in zip(rows, faults)):
        sys.exit(f"{output} is of other faults or sources: remove it, or give another --output")
    output.parent.mkdir(parents=True, exist_ok=True)
    try:
        with tempfile.TemporaryDirectory() as folder, output.open("a", encoding="utf-8", newline="") as file:
            clone, writer = Clone(Path(folder)), csv.DictWriter(file, COLUMNS, lineterminator="\n")
            if not rows:
                if failed := clone.first_failure():
                    sys.exit(f"without any fault fails {failed}")
                writer.writeheader()
            for fault in tqdm(faults[len(rows) :], total=len(faults), initial=len(rows), unit=" faults"):
                rows.append(dict(zip(COLUMNS, (fault.file, fault.line, str(fault), *clone.judge(fault)))))
                writer.writerow(rows[-1])
                file.flush()  # so that the same command goes on after Ctrl-C
    except KeyboardInterrupt:
        print(f"interrupted after {len(rows)} of {len(faults)} faults; the same command goes on")
    for row in rows:
        print(f"{row['result']:11s}  {row['file']}:{row['line']}  {row['fault']}  {row['noticed by']}")
    counts = Counter(row["result"] for row in rows)
    print(f"noticed: {counts[KILLED]} of {counts[KILLED] + counts[SURVIVED]}; written: {output}")


if __name__ == "__main__":
    main()
