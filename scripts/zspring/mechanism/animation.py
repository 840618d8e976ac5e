"""The animation: one HTML file that holds its drawing, its data and its script."""

from __future__ import annotations

import importlib.resources
import json
from collections.abc import Sequence

import numpy as np

from .cycle import FRAMES, Cycle
from .plot import BASE, SIDES, STRIP, case_title


def animation_html(cycles: Sequence[Cycle], magnifications: Sequence[float], about: str) -> str:
    """Text of a web page that moves the linkages side by side, as seen from the track.

    All cycles have the same frequency; each has its own magnification of the motion.
    """
    cases = []
    for cycle, magnification in zip(cycles, magnifications):
        bound = cycle.parameters["zspring.Mf"] or 1.0
        angles = np.degrees([cycle.alpha, cycle.beta])
        values = np.stack([1e3 * cycle.u1, 1e3 * cycle.compression, *angles], -1)
        cases.append(
            {
                "title": case_title(cycle, magnification),
                "points": np.round(1e3 * cycle.points(magnification), 3).tolist(),
                "joint": round(1e3 * float(cycle.points(0.0)[0, 3, 1]), 3),
                "moments": np.round(cycle.moments / bound, 4).tolist(),
                "values": np.round(values, 4).tolist(),
            }
        )
    data = {
        "about": about,
        "frequency": cycles[0].frequency,
        "count": FRAMES,
        "phase": 0.25,
        "view": _view([case["points"] for case in cases]),
        "strip": STRIP,
        "base": BASE,
        "sides": SIDES,
        "cases": cases,
    }
    page = importlib.resources.files(__package__).joinpath("animation.html").read_text(encoding="utf-8")
    # "</" would end the script.
    return page.replace("/*DATA*/null", json.dumps(data, ensure_ascii=False).replace("</", "<\\/"))


def _view(points: Sequence[Sequence]) -> list[float]:
    """Left, top, width, height of what the drawing needs, in mm, downward as SVG counts."""
    heights = np.array(points)[..., 1]
    joint, top = heights[..., 0], heights[..., 3]
    highest = max(joint.max() + STRIP, top.max())
    lowest = min(joint.min(), BASE + (top - top.mean()).min())
    margin = 15.0
    return [SIDES[0] - margin, -(highest + margin), SIDES[1] - SIDES[0] + 2 * margin, highest - lowest + 2 * margin]
