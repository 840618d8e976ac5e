"""The command `zspring slip`."""

from __future__ import annotations

import click

from ..bench.measure import BENCH_PARAMETERS
from ..bench.points import FrfSettings
from ..options import POSITIVE, format_option, jobs_option, numbers, option, output_option, pantograph_options
from ..records import claimed

STANDARD = FrfSettings()


@click.command()
@numbers(
    "--amplitudes",
    "0.05,0.07,0.1,0.14,0.2,0.28,0.4,0.56,0.8,1.1,1.6,2.2,3.2,4.5,6.4,9,13",
    "Peak accelerations of the imposed sine in m/s2, raised one after the other.",
)
@numbers("--frequencies", "1:15:0.25", "In Hz: numbers and ranges START:STOP:STEP.")
@pantograph_options
@output_option("results/slip")
@option("--stroke", default=STANDARD.stroke, kind=POSITIVE, help="Largest displacement peak in m.")
@jobs_option("Frequencies at a time.")
@format_option
def slip(pantograph, amplitudes, frequencies, output, stroke, jobs, suffix) -> None:
    """Where the rods stick, slide partly or slide all along, over frequency and amplitude.

    A joint slides while its friction moment is at least 95 % of its bound Mf. Stick: neither joint slides at any time.
    Full slip: both slide for at least 90 % of the period. At each frequency the amplitude is raised from rest, each
    point until it is steady (see `zspring frf`), and where the state changes it is halved into until the two amplitudes
    are 2 % apart: the line of onset, and that of full slip.

    Writes slip.csv (points), onset.csv (lines) and slip.png. Ctrl-C keeps all finished points, and the same command
    goes on from there.
    """
    from .run import run_slip

    with pantograph.opened(BENCH_PARAMETERS) as (fmu, parameters), claimed(output):
        settings = FrfSettings(amplitudes, frequencies, parameters, stroke=stroke)
        run_slip(fmu, settings, output, pantograph.named, suffix, jobs)
