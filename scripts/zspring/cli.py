"""The command `zspring`."""

from __future__ import annotations

import sys

import click

from .couple.command import couple
from .en50318.command import en50318
from .errors import ZSpringError
from .export import export
from .frf.command import frf
from .identify.command import identify
from .info import info
from .interrupt import Interrupted
from .simulation.command import simulate
from .studies.integrators.command import integrators
from .studies.linearize.command import linearize
from .studies.mechanism.command import mechanism
from .studies.newton.command import newton
from .studies.static.command import static
from .study.command import study


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="zspring")
def commands() -> None:
    """DSA-380 pantograph with Z-spring head suspension, as an FMI 2.0 co-simulation FMU."""


for command in (
    *(frf, simulate, identify, info, export),
    *(static, newton, integrators, mechanism, linearize, study, couple, en50318),
):
    commands.add_command(command)


def main() -> int:
    """Run the command line; returns 0 (fine), 1 (failure, one line on stderr) or 130 (interrupted)."""
    try:
        return commands.main(standalone_mode=False) or 0
    except click.ClickException as error:
        message, status = error.format_message(), 1
    except ZSpringError as error:
        message, status = str(error), 1
    except OSError as error:
        message, status = f"{error.filename}: {error.strerror}" if error.filename else str(error), 1
    except Interrupted as error:
        message, status = str(error), 130
    except (click.Abort, KeyboardInterrupt):
        message, status = "interrupted", 130
    print(f"zspring: {message}", file=sys.stderr)
    return status
