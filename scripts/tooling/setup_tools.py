"""What the set-up works with: messages, its lock, quiet commands, and the search for a C++ compiler."""

from __future__ import annotations

import contextlib
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

# Uses what the build needs: the standard library of C++17 and a linker.
TRIAL_PROGRAM = "#include <optional>\nint main() { return std::optional<int>(0).value(); }\n"


class SetupError(Exception):
    """The set-up cannot go on; the message is the line for the user."""


def say(message: str) -> None:
    print(f"set-up: {message}", file=sys.stderr, flush=True)


@contextlib.contextmanager
def lock(path: Path) -> Iterator[int]:
    """Hold the lock of this file. It ends with the last process that has the descriptor, however that ends."""
    path.parent.mkdir(exist_ok=True)
    with open(path, "a+b") as file:
        if sys.platform == "win32":
            import msvcrt

            def acquire() -> None:
                file.seek(0)
                msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            def acquire() -> None:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)

        waiting = False
        while True:
            try:
                acquire()
                break
            except OSError:
                if not waiting:
                    say("another set-up runs in this clone, waiting for it")
                waiting = True
                time.sleep(0.5)
        yield file.fileno()


class Runner:
    """Runs the commands of a set-up: quiet, logged, and holding its lock."""

    def __init__(self, log: Path, folder: Path, variables: dict[str, str], lock_descriptor: int) -> None:
        self.log, self.folder, self.variables = log, folder, variables
        self.inherited = [] if os.name == "nt" else [lock_descriptor]

    def run(self, failure: str, command: list[str | Path], **variables: str) -> None:
        """Run `command`; if it fails, print the end of its output and raise SetupError(failure)."""
        with open(self.log, "ab") as log:
            log.write(f"\n$ {shlex.join(map(str, command))}\n".encode())
            log.flush()
            begin = log.tell()
            result = subprocess.run(
                [str(part) for part in command],
                cwd=self.folder,
                env={**self.variables, **variables},
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                pass_fds=self.inherited,
            )
        if result.returncode:
            output = self.log.read_bytes()[begin:].decode(errors="replace")
            print("\n".join(output.splitlines()[-25:]), file=sys.stderr)
            raise SetupError(f"{failure}; all its output is in {self.log}")


def compiles(compiler: str) -> bool:
    """Whether the C++ compiler, a command with or without arguments, makes a C++17 program that runs."""
    with tempfile.TemporaryDirectory() as folder:
        source, program = Path(folder, "trial.cpp"), Path(folder, "trial.exe")
        source.write_text(TRIAL_PROGRAM)
        compile_it = [*shlex.split(compiler, posix=os.name != "nt"), "-std=c++17", str(source), "-o", str(program)]
        try:
            for command in compile_it, [str(program)]:
                subprocess.run(command, check=True, capture_output=True, stdin=subprocess.DEVNULL)
        except (OSError, subprocess.CalledProcessError):
            return False
    return True


def system_compiler() -> str | None:
    """Command of a C++ compiler that works: CXX, else one of the system; None where there is none."""
    chosen = os.environ.get("CXX")
    if chosen:
        if not compiles(chosen):
            raise SetupError(f"CXX={chosen} does not compile a C++17 program: correct or unset CXX")
        return chosen
    return next((name for name in ("c++", "g++", "clang++") if shutil.which(name) and compiles(name)), None)
