"""Designs of experiments: from what varies to cases."""

from __future__ import annotations

import itertools
import math

import numpy as np

from ..errors import ZSpringError
from ..variables import Value
from .factors import LINE_NUMBER
from .file import MOST_CASES, SAMPLED, Range
from .settings import COMPARED, StudySettings

Case = dict[str, Value]  # values of the parameters that vary


def make_cases(settings: StudySettings) -> list[Case]:
    """All cases of a study, the same for the same settings.

    grid                every combination, the last parameter changing fastest
    list                the first value of each parameter, the second of each, ...
    latin-hypercube     McKay, Beckman, Conover 1979, as scipy.stats.qmc has it
    sobol               Saltelli et al. 2010 on a scrambled Sobol sequence, as SALib has it: blocks of D + 2
                        cases, from which first and total order indices follow
    Those of a grid or list on each of the lines; a case of others, or a whole block of sobol, on one that is drawn, all
    lines as often (in turn, they would go with the first parameters of a Sobol sequence); and each for all compared.
    Raises ZSpringError if there are more than MOST_CASES.
    """
    compared = [{COMPARED: i + 1} for i in range(len(settings.compared))] or [{}]
    lines = [{LINE_NUMBER: i + 1} for i in range(settings.lines)] or [{}]
    if settings.design in SAMPLED:
        block = len(settings.vary) + 2 if settings.design == "sobol" else 1
        drawn = np.random.default_rng([settings.seed, 1]).permutation(settings.samples) % len(lines)
        cases = [{**case, **lines[drawn[n // block]]} for n, case in enumerate(_designed(settings, len(compared)))]
    else:
        each = _designed(settings, len(lines) * len(compared))
        cases = [{**case, **line} for case in each for line in lines]
    return [{**case, **which} for case in cases for which in compared]


def _designed(settings: StudySettings, copies: int) -> list[Case]:
    names, dimension = list(settings.vary), len(settings.vary)
    varied = [given for given in settings.vary.values() if isinstance(given, tuple)]
    spans = [given for given in settings.vary.values() if isinstance(given, Range)]
    count = {
        "grid": lambda: math.prod(map(len, varied)),
        "list": lambda: len(varied[0]),
        "latin-hypercube": lambda: settings.samples,
        "sobol": lambda: settings.samples * (dimension + 2),
    }[settings.design]()
    if count * copies > MOST_CASES:
        raise ZSpringError(f"{count * copies} cases: a study has at most {MOST_CASES}")
    if settings.design in ("grid", "list"):
        rows = itertools.product(*varied) if settings.design == "grid" else zip(*varied)
        return [dict(zip(names, row)) for row in rows]

    if settings.design == "sobol":
        from SALib.sample import sobol

        positions = sobol.sample(unit_problem(names), settings.samples, calc_second_order=False, seed=settings.seed)
    else:
        from scipy.stats import qmc

        sampler = qmc.LatinHypercube(dimension, rng=np.random.default_rng(settings.seed))
        positions = sampler.random(settings.samples)
    columns = [span.at(column).tolist() for span, column in zip(spans, positions.T)]
    return [dict(zip(names, row)) for row in zip(*columns)]


def unit_problem(names: list[str]) -> dict:
    """SALib's description of parameters that are positions between 0 and 1."""
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
