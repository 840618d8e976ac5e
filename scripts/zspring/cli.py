"""The command `zspring`."""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence
from importlib.metadata import entry_points

import click

from .couple.command import couple
from .en50318.command import en50318
from .errors import ZSpringError
from .explore.command import explore
from .export import export
from .frf.command import frf
from .identify.command import identify
from .info import info
from .interrupt import Interrupted
from .line_file.command import line
from .linearize.command import linearize
from .mechanism.command import mechanism
from .recordings.command import recordings
from .simulate.command import simulate
from .slip.command import slip
from .static.command import static
from .study.command import study

RESEARCH = ("newton", "integrators")  # commands of scripts/research, a package of its own


@click.group(
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100}, invoke_without_command=True
)
@click.version_option(package_name="zspring")
@click.pass_context
def commands(context: click.Context) -> None:
    """DSA-380 pantograph with Z-spring head suspension, as an FMI 2.0 co-simulation FMU."""
    if context.invoked_subcommand is None:
        print(context.get_help())


def research_command(name: str) -> click.Command:
    """A command of the package in scripts/research, or one that tells how to install it."""
    for found in entry_points(group="zspring.commands", name=name):
        return found.load()
    how = "in the clone, pip install ./scripts/research"

    def refuse(**_) -> None:
        raise ZSpringError(f"{name} is not installed: {how}")

    anything = click.Argument(["arguments"], nargs=-1, type=click.UNPROCESSED)
    settings = {"ignore_unknown_options": True}
    return click.Command(name, settings, refuse, [anything], short_help=f"Not installed: {how}.", add_help_option=False)


for command in (
    *(frf, simulate, recordings, identify, info, export),
    *(static, slip, mechanism, linearize, study, line, couple, en50318, explore),
):
    commands.add_command(command)
for name in RESEARCH:
    commands.add_command(research_command(name))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line or these arguments: 0 (fine), 1 (failure, one line on stderr) or 130 (interrupted)."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # what a terminal cannot show is shown as its code
            stream.reconfigure(errors="backslashreplace")
    arguments = sys.argv[1:] if arguments is None else arguments
    try:
        for argument in arguments:  # results name their sources in UTF-8
            if argument.encode(errors="replace").decode() != argument:
                raise ZSpringError(f"{argument}: is not in the encoding of this system's file names: rename it")
        return commands.main(list(arguments), standalone_mode=False) or 0
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
