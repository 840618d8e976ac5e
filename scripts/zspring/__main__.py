"""Where the command `zspring` begins: Ctrl-C gets one line also while the rest is loading."""

import io
import signal
import sys


def main() -> int:
    """`cli.main`, and its status."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(
            errors="backslashreplace"
        )  # a file or pipe on Windows has no character beyond its code page
    try:
        from .cli import main as command

        status = command()
    except KeyboardInterrupt:
        print("zspring: interrupted", file=sys.stderr)
        status = 130
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # nothing is left to stop but the interpreter's own end
    return status


if __name__ == "__main__":
    sys.exit(main())
