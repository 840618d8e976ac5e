"""The libraries built here: they export the functions of FMI 2.0 and nothing else, and need only the C library."""

from __future__ import annotations

import fmpy
import pytest

import libraries
from zspring.fmu import CATENARY, PANTOGRAPH, installed_fmu


@pytest.mark.parametrize("model", [PANTOGRAPH, CATENARY])
def test_exports_and_needs(model, tmp_path):
    fmpy.extract(str(installed_fmu(model)), unzipdir=str(tmp_path))
    files = list((tmp_path / "binaries").glob("*/*"))
    assert files
    for file in files:
        library = libraries.read(file)
        assert libraries.exported(library) == libraries.fmi2_functions()
        assert libraries.foreign(library) == []
