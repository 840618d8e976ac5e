"""What the compiler sees: a variable without its member or definition, a member that is no variable or not kept."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from importlib.metadata import files
from pathlib import Path

import pytest

from paths import ROOT

COMPILER = next(filter(None, map(shutil.which, ("c++", "g++", "clang++"))), None)
DEFINITION = r"OUTPUT\((energy_dot_elastic), (x.m.strain_energy\(.*\)), elastic_change.*\n"
# The file, what in it is changed to what, and what the compiler complains of.
CHANGES = {
    "nothing changed": ("outputs.cpp", "$^", "", None),
    "an output without definition": ("outputs.cpp", DEFINITION, "", "incomplete|undefined template"),
    "a continuous output without change": ("outputs.cpp", DEFINITION, r"OUTPUT(\1, \2)\n", "macro|argument"),
    "a continuous output as a discrete one": (
        "outputs.cpp",
        DEFINITION,
        r"DISCRETE(\1, \2)\n",
        "see common/outputs.hpp",
    ),
    "a parameter without its member": ("parameters.hpp", "double gravity;", "", "gravity"),
    "an input without its member": (
        "parameters.hpp",
        "head, upper_frame, lower_frame",
        "head, upper_frame",
        "lower_frame",
    ),
    "a parameter that is no variable": ("parameters.hpp", "double gravity;", r"\g<0> double more;", "no variable"),
    "a part of the state that is not kept": (
        "state.hpp",
        "double work = 0;",
        r"\g<0> double more = 0;",
        "only 13 names",
    ),
}


def eigen() -> Path:
    """The folder that holds Eigen/Core."""
    header = next(f for f in files("cmeel-eigen") if f.as_posix().endswith("eigen3/Eigen/Core"))
    return Path(header.locate()).resolve().parents[1]


if COMPILER:

    @pytest.mark.parametrize("change", CHANGES)
    def test_does_not_compile(tmp_path, change):
        file, pattern, replacement, complaint = CHANGES[change]
        sources = tmp_path / "fmu_src"
        shutil.copytree(ROOT / "fmu_src", sources)
        generator = [sys.executable, sources / "generate_variables.py", ROOT / "modelDescription.xml", tmp_path]
        subprocess.run(generator, check=True)
        changed, found = re.subn(pattern, replacement, (sources / "pantograph" / file).read_text("utf-8"))
        assert found or complaint is None
        (sources / "pantograph" / file).write_text(changed, "utf-8")
        source = tmp_path / "all.cpp"
        source.write_text('#include "pantograph/outputs.cpp"\n#include "fmi/variables.hpp"\n', "utf-8")
        folders = [tmp_path, sources, sources / "fmi" / "pantograph", eigen()]
        command = [COMPILER, "-std=c++17", "-fsyntax-only", *(f"-I{folder}" for folder in folders), str(source)]
        done = subprocess.run(command, capture_output=True, text=True)
        assert (done.returncode == 0) == (complaint is None), done.stderr
        assert complaint is None or re.search(complaint, done.stderr), done.stderr
