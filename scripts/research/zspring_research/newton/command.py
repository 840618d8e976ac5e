"""The command `zspring newton`."""

from __future__ import annotations

import click

from zspring.bench.measure import FrfSettings
from zspring.options import (
    Numbers,
    chosen_parameters,
    fmu_option,
    format_option,
    opened,
    output_option,
    parameters_option,
    set_option,
)
from zspring.records import claimed

STANDARD = FrfSettings()
SET_HERE = ("drive", "suspension", "friction", "solver.tangent", "bench.frequency", "bench.acceleration")


@click.command()
@click.option(
    "--amplitudes",
    type=Numbers(),
    default=STANDARD.amplitudes,
    metavar="LIST",
    help="Peak accelerations of the figure in m/s2.  [default: the standard figure's]",
)
@click.option(
    "--frequencies",
    type=Numbers(),
    default=STANDARD.frequencies,
    metavar="LIST",
    help="Frequencies of the figure in Hz.  [default: the standard figure's]",
)
@click.option(
    "--taus",
    type=Numbers(),
    default="10,100,1e3,1e4,1e5,1e6",
    show_default=True,
    metavar="LIST",
    help="Steepnesses of the friction law in s.",
)
@click.option(
    "--tau-stride",
    type=click.IntRange(min=1),
    default=5,
    show_default=True,
    metavar="N",
    help="Each N-th point of the figure is enough for the work over tau, where the exact tangent is slow.",
)
@click.option(
    "--bench-frequency",
    type=float,
    default=5.0,
    show_default=True,
    metavar="HZ",
    help="Bench on which the step is recorded and force and position are compared.",
)
@click.option(
    "--bench-acceleration",
    type=float,
    default=1.0,
    show_default=True,
    metavar="A",
    help="Its peak acceleration in m/s2.",
)
@parameters_option
@set_option
@output_option("results/newton")
@format_option
@fmu_option
def newton(
    amplitudes,
    frequencies,
    taus,
    tau_stride,
    bench_frequency,
    bench_acceleration,
    parameter_set,
    assignments,
    output,
    suffix,
    fmu_path,
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
    with opened(fmu_path) as fmu, claimed(output):
        parameters = chosen_parameters(fmu, parameter_set, assignments, but_not=SET_HERE)
        from .run import NewtonSettings, run_newton

        settings = NewtonSettings(amplitudes, frequencies, taus, tau_stride, bench_frequency, bench_acceleration)
        run_newton(fmu, parameters, settings, output, suffix)
