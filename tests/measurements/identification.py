"""What an identification costs: the standard figure with noise, from starts 50 % off. Part of scripts/benchmark."""

from __future__ import annotations

import io
import tempfile
import threading
import time
from contextlib import redirect_stdout
from pathlib import Path

import numpy as np

from zspring.bench.measure import measure
from zspring.bench.points import FrfSettings, sweeps
from zspring.fmu import Fmu
from zspring.identify.run import identify
from zspring.identify.settings import read_settings
from zspring.parameter_sets import ACCURATE_STEP

NOISE, SEED = 0.02, 1  # of magnitude (relative) and phase (rad)
FREE = {
    "zspring.k": (19575, 5000, 40000),
    "zspring.l0": (0.00855, 0.002, 0.024),
    "zspring.Mf": (0.45, 0.02, 2),
    "m1": (10.7, 3, 20),
    "k2": (7000, 3000, 40000),
    "c3": (105, 0, 300),
}


def identification(fmu: Fmu) -> None:
    """Print seconds of CPU, all told, and how far the parameters are from those of the data."""
    figure = FrfSettings(parameters={"solver.step": ACCURATE_STEP})
    points = [point for point, _ in measure(fmu, figure, sweeps(figure), 1, threading.Event())]
    rng = np.random.default_rng(SEED)
    print(f"\nIdentification: {len(points)} points, {100 * NOISE:g} % of noise, starts 50 % off, one core")
    print("parameters   CPU      farthest from those of the data, in standard errors")
    with tempfile.TemporaryDirectory() as folder:
        data, path = Path(folder) / "bench.csv", Path(folder) / "fit.toml"
        lines = ["# static_force: 120 N", "# friction: Regularized", "# direction: up"]
        lines.append("frequency [Hz],amplitude [m/s2],real [m/N],imaginary [m/N]")
        for p in sorted(points, key=lambda p: p.place):
            H = p.H * np.exp(NOISE * complex(*rng.standard_normal(2)))
            lines.append(f"{p.frequency},{p.amplitude},{H.real},{H.imag}")
        data.write_text("\n".join(lines) + "\n")
        for count in (3, 6):
            free = [f"{n} = {{ start = {s}, min = {a}, max = {b} }}" for n, (s, a, b) in list(FREE.items())[:count]]
            path.write_text('model = "zspring"\n[[measurement]]\nfile = "bench.csv"\n[free]\n' + "\n".join(free) + "\n")
            begin = time.process_time()
            with redirect_stdout(io.StringIO()):
                fit = identify(fmu, read_settings(path, fmu), path, Path(folder) / f"{count}", "png", 1)
            taken = time.process_time() - begin
            truth = [float(fmu.variables[name].start) for name in list(FREE)[:count]]
            off = np.abs(fit.values - truth) / fit.standard_error
            print(f"{count:<11}  {taken:>5.1f} s  {off.max():.1f}")
