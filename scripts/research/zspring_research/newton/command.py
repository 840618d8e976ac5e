"""The command `zspring newton`."""

from __future__ import annotations

import click

from zspring.bench.points import FrfSettings
from zspring.options import format_option, numbers, option, output_option, pantograph_options
from zspring.records import claimed

STANDARD = FrfSettings()
STEP = 2e-3  # s, the paper's: what its tangents cost shows at its step
SET_HERE = ("drive", "suspension", "friction", "solver.tangent", "bench.frequency", "bench.acceleration")


@click.command()
@numbers(
    "--amplitudes", STANDARD.amplitudes, "Peak accelerations of the figure in m/s2.  [default: the standard figure's]"
)
@numbers("--frequencies", STANDARD.frequencies, "Frequencies of the figure in Hz.  [default: the standard figure's]")
@numbers("--taus", "10,100,1e3,1e4,1e5,1e6", "Steepnesses of the friction law in s.")
@option(
    "--tau-stride",
    default=5,
    kind=click.IntRange(min=1),
    metavar="N",
    help="Each N-th point of the figure is enough for the work over tau, where the exact tangent is slow.",
)
@option(
    "--bench-frequency",
    default=5.0,
    metavar="HZ",
    help="Bench on which the step is recorded and force and position are compared.",
)
@option("--bench-acceleration", default=1.0, metavar="A", help="Its peak acceleration in m/s2.")
@pantograph_options
@output_option("results/newton")
@format_option
def newton(
    pantograph, amplitudes, frequencies, taus, tau_stride, bench_frequency, bench_acceleration, output, suffix
) -> None:
    """Compare Newton tangents of the steep friction law, and what its steepness costs.

    The exact tangent jumps between two states in steps that lead from stick to slip. Such a step is recorded
    from the FMU and iterated again in Python with each tangent, from positions, velocities and rod rates that
    are the FMU's outputs; the converged result is the FMU's. Then the FMU itself runs the whole figure with
    each tangent: iterations, steps that had to be halved, discarded points, time; by amplitude and by tau.
    Last the error that a finite tau makes against the Coulomb law, at the same time step; what remains of it
    at large tau is the step's own.

    Takes about one minute. Writes jump.csv, newton.csv, accuracy.csv and the figures jump and newton.
    """
    with pantograph.opened(SET_HERE, STEP) as (fmu, parameters), claimed(output):
        from .run import NewtonSettings, run_newton

        settings = NewtonSettings(amplitudes, frequencies, taus, tau_stride, bench_frequency, bench_acceleration)
        run_newton(fmu, parameters, settings, output, suffix)
