"""Where the command `zspring` begins: Ctrl-C gets one line also while the rest is loading."""

import signal
import sys


def main() -> int:
    """`cli.main`, and its status."""
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
