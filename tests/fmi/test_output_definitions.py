"""An output that has no definition, or a continuous one without its change, does not compile (common/outputs.hpp)."""

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
# What it is changed to, and what the compiler complains of.
CHANGES = {
    "no definition": ("", "incomplete|undefined template"),
    "no change": (r"OUTPUT(\1, \2)\n", "macro|argument"),
    "the definition of what is discrete": (r"DISCRETE(\1, \2)\n", "see common/outputs.hpp"),
}


def eigen() -> Path:
    """The folder that holds Eigen/Core."""
    header = next(f for f in files("cmeel-eigen") if f.as_posix().endswith("eigen3/Eigen/Core"))
    return Path(header.locate()).resolve().parents[1]


if COMPILER:

    @pytest.mark.parametrize("change", CHANGES)
    def test_a_continuous_output_does_not_compile_with(tmp_path, change):
        generator = ROOT / "fmu_src" / "generate_variables.py"
        subprocess.run([sys.executable, generator, ROOT / "modelDescription.xml", tmp_path], check=True)
        definition, complaint = CHANGES[change]
        outputs = (ROOT / "fmu_src" / "pantograph" / "outputs.cpp").read_text("utf-8")
        changed, found = re.subn(DEFINITION, definition, outputs)
        assert found == 1
        source = tmp_path / "outputs.cpp"
        source.write_text(changed, "utf-8")
        folders = [tmp_path, ROOT / "fmu_src", ROOT / "fmu_src" / "pantograph", eigen()]
        command = [COMPILER, "-std=c++17", "-fsyntax-only", *(f"-I{folder}" for folder in folders), str(source)]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode != 0 and re.search(complaint, done.stderr), done.stderr
