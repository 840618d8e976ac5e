"""The command `zspring`, started as a user starts it, and what it writes."""

from __future__ import annotations

import contextlib
import csv
import io
import os
import signal
import subprocess
import sys
from pathlib import Path

from zspring.cli import main

PNG = b"\x89PNG\r\n"

# A study of eight cases that takes a second.
QUICK = """
design = "grid"
[vary]
zspring.Mf = { from = 0.1, to = 0.4, count = 4 }
zspring.k = [12500, 13500]
[frf]
amplitudes = [1, 4]
frequencies = "3:8:0.5"
"""


_started: list[subprocess.Popen] = []


def begin(command: list[str], **options) -> subprocess.Popen:
    """A process, with whatever it starts in turn, that `end_all` ends if it has not ended by then."""
    process = subprocess.Popen(command, start_new_session=True, **options)
    _started.append(process)
    return process


def end_all() -> None:
    """End all processes of `begin` and what they left behind."""
    while _started:
        process = _started.pop()
        if hasattr(os, "killpg"):
            try:
                os.killpg(process.pid, signal.SIGKILL)  # the group outlives its first process
            except ProcessLookupError:
                pass
        elif process.poll() is None:
            process.kill()
        process.wait()
        for stream in (process.stdout, process.stderr):
            if stream:
                stream.close()


def start(folder: Path, *arguments: str) -> subprocess.Popen:
    command = [sys.executable, "-m", "zspring", *arguments]
    return begin(command, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def zspring(folder: Path, *arguments: str, status: int = 0) -> tuple[str, str]:
    """Standard output and error of a run that ends with `status`."""
    process = start(folder, *arguments)
    out, err = process.communicate(timeout=120)
    assert process.returncode == status, err
    assert "Traceback" not in err
    return out, err


def in_process(*arguments: str | Path) -> tuple[int, str, str]:
    """Status, standard output and error of `zspring` with these arguments, in this process."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = main([str(argument) for argument in arguments])
    return status, out.getvalue(), err.getvalue()


def table(path: Path) -> list[dict[str, str]]:
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def head(path: Path) -> list[str]:
    return [line for line in path.read_text(encoding="utf-8").splitlines() if line.startswith("#")]


def receptances(path: Path) -> dict[tuple[float, float], complex]:
    return {
        (float(row["amplitude [m/s2]"]), float(row["frequency [Hz]"])): complex(
            float(row["H_re [m/N]"]), float(row["H_im [m/N]"])
        )
        for row in table(path)
        if row["H_re [m/N]"]
    }
