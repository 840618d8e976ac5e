"""The command `zspring linearize`."""

from __future__ import annotations

import click

from ..options import numbers, output_option, pantograph_options
from ..records import claimed


@click.command()
@numbers("--frequencies", "0.05:20:0.05", "Of the receptance in the files, in Hz.")
@pantograph_options
@output_option("results/linearize")
def linearize(pantograph, frequencies, output) -> None:
    """Print and write the linear models about the static state: modes, matrices, receptance.

    linear: three masses with head spring k1. locked, free: the Z-spring with rods held at their static angle,
    and with rods that move without friction. Shapes are in m and rad, scaled so that the largest motion of a
    mass or a rod's end is 1 m; a mode with damping 1 does not oscillate. Frequencies are |s| / 2 pi.

    Writes for each model linear-NAME.npz and .mat with M, C, K in SI units, the degrees of freedom in dof and
    unit, eigenvalues s (1/s), eigenvectors (columns; one of each conjugate pair), natural_frequencies and
    head_held_frequencies (undamped, Hz), the receptance -Z/F at the head (m/N) over frequency (Hz), and
    all parameters as text in head.
    """
    with pantograph.opened(("suspension",)) as (fmu, parameters), claimed(output):
        import numpy as np

        from .run import run_linearize

        run_linearize(fmu, parameters, np.array(frequencies), output)
