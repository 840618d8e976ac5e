"""Builds the WebAssembly modules into the installed package and runs `zspring explore`; scripts/explore starts it."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import webassembly
import zspring.explore
from bootstrap import BUILD, ROOT, environment
from setup_tools import Runner, SetupError, lock, say
from zspring.cli import main


def install_modules() -> None:
    """Into the folder where `zspring explore` looks for them. Raises SetupError."""
    with lock(BUILD / "package.lock") as descriptor:
        log = BUILD / "webassembly.log"
        log.unlink(missing_ok=True)
        if not webassembly.are_built():
            say("building the WebAssembly modules (at the first time one to four minutes)")
        for module in webassembly.build(Runner(log, ROOT, environment(), descriptor)).values():
            shutil.copy2(module, Path(zspring.explore.__file__).parent / module.name)


if __name__ == "__main__":
    try:
        install_modules()
    except (SetupError, OSError) as error:
        sys.exit(f"set-up: {error}")
    except KeyboardInterrupt:
        sys.exit("set-up: interrupted; start it again to go on")
    sys.exit(main(["explore", *sys.argv[1:]]))
