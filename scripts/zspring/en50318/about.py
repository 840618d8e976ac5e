"""The chapters of every report that say what it proves, how values are taken, and what made it."""

from __future__ import annotations

import platform
from collections.abc import Iterable, Mapping
from datetime import datetime, timezone
from importlib.metadata import version
from pathlib import Path

import fmpy
import numpy
import scipy

from ..fmu import Fmu
from ..line.mean_force import TOLERANCE
from ..line.series import BAND, LEAST_RATE
from ..line.statistics import ORDER
from ..page import WORDS, Cell, Chapter, Table

TITLE = "What this report shows, and what not"
NO_CERTIFICATE = "It is no certificate and does not replace the assessment that the standard asks for."


def own_runs() -> Chapter:
    """What a report on our runs proves, and what not."""
    shows = (
        "What it shows: the finite-element line and the coupling, with published data for line and pantograph, "
        "come to the values in this report; how far single choices and numerical settings move them; and, where "
        "ranges are given, which values lie inside."
    )
    not_shown = (
        "What it does not show: that any simulation of a real line is right. The data and ranges of EN 50318:2002 "
        "are second-hand, as papers and codes quote them, and that edition is superseded; where they leave a "
        "choice, published values were chosen knowing the ranges, so that values inside are no validation. "
        "Those of EN 50318:2018 are not public and have to be put in by the user. No line test and no measured "
        "pantograph is compared. The line is planar (no stagger, no lateral motion) with small displacements, "
        "the pantograph a few lumped masses: results hold for 0 to 20 Hz. The Z-spring's parameters are "
        "synthetic."
    )
    return Chapter(TITLE, [shows, f"{not_shown} {NO_CERTIFICATE}"])


def own_data() -> Chapter:
    """What a report on a user's data proves, and what not."""
    shows = (
        "What it shows: values of the given data, taken as told below; how they compare with each other, with "
        "the FMU's frequency response and with accepted ranges, as far as these are given."
    )
    not_shown = (
        "What it does not show: that the data are right, or that ranges and limits are those of the standard: "
        "each has its source beside it. A contact force is taken as it is; whether it was measured and corrected "
        "as the standard asks cannot be seen in it."
    )
    return Chapter(TITLE, [shows, f"{not_shown} {NO_CERTIFICATE}"])


def method() -> Chapter:
    """How the values are taken."""
    return Chapter(
        "How the values are taken",
        [
            f"Filter: a Butterworth low-pass of order {ORDER} at {BAND:g} Hz, run forwards and backwards over the "
            "whole series before spans are cut out: no phase shift; gain 0.5 (-6 dB) at the band's edge, 0.71 at "
            "0.90 and 0.97 at 0.65 of it. All other bands are taken alike; one that does not begin at 0 Hz is the "
            f"difference of two. Series need even samples, at least {LEAST_RATE:g} a second.",
            "Statistical maximum and minimum are mean ± 3 standard deviations; actual maximum and minimum are of "
            "the filtered force. Loss of contact is the share of time in which the unfiltered force is not "
            "positive. Uplift is the largest of the supports at and between the ends of the evaluated spans, at "
            "any time of the run, whichever pantograph lifts them; at mid-span it is the largest of the points there. "
            "The range of the contact point is that of the wire's height at the pantograph, unfiltered. The limit of "
            "standard deviation over mean force, and the target mean force of AC lines, 0.00097 v² + 70 N with v in "
            "km/h, are as papers quote them.",
            "Our runs start at rest and pass over the first span from the wire's unloaded height to the wire (a "
            "half cosine), so that the static force holds at the unloaded height and the pantograph's own springs "
            "take their share when the wire lifts. Where a mean force by speed is asked for, the uplift on the upper "
            f"frame is the one with which the run has it over the evaluated spans, to {TOLERANCE:g} N. Of spans in "
            "which the far end's reflection of the start is felt it is told.",
        ],
    )


def made_with(fmus: Iterable[Fmu], settings: Mapping[str, str], files: Iterable[Path]) -> Chapter:
    """Versions, settings and the files beside the report."""
    now = datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
    rows = [["date", now]]
    for fmu in fmus:
        name = fmu.description.modelName
        rows += [[name, f"{fmu.description.version}, GUID {fmu.description.guid}"], [f"{name}, SHA-256", fmu.sha256]]
    rows += [
        ["zspring", version("zspring")],
        ["Python", f"{platform.python_version()}, {platform.system()} {platform.machine()}"],
        *([module.__name__, module.__version__] for module in (numpy, scipy, fmpy)),
        *([key, value] for key, value in settings.items()),
        ["files beside this report", ", ".join(path.name for path in files)],
    ]
    table = Table("Made with", ["", ""], [[row[0], Cell(row[1], WORDS)] for row in rows])
    return Chapter("Versions, settings, files", [table])
