"""The runs that are compared between platforms, as calls for the C host (host.c)."""

from __future__ import annotations

import struct

import numpy as np
from fmpy.model_description import ModelDescription

from any_line import STITCHED

STEP = 0.002  # s, communication step


def bits(value: float) -> str:
    return struct.pack(">d", value).hex()


def pantograph_force(t: np.ndarray) -> tuple[dict, dict]:
    """Force on the head: a rising tone from 0.5 Hz, large enough that the rods slide."""
    return {"drive": 1}, {"contact_force": 120 + 60 * np.sin(2 * np.pi * (0.5 + t) * t)}


def pantograph_wire(t: np.ndarray) -> tuple[dict, dict]:
    """Wire with spans of 1 s and a hump that the head loses and meets again."""
    hump = 0.030 * np.exp(-(((t - 2.5) / 0.01) ** 2))
    return {"drive": 3}, {"wire_height": 0.010 * np.sin(2 * np.pi * t) ** 3 + hump}


def catenary_load(t: np.ndarray) -> tuple[dict, dict]:
    """A force on the line at 60 m/s, strong enough that droppers slacken."""
    force = 180 + 40 * np.sin(2 * np.pi * 5 * t)
    return {}, {"pantograph[1].force": force, "pantograph[1].speed": np.full_like(t, 60.0)}


RUNS = {
    "pantograph driven by a force": ("ZSpringPantograph", pantograph_force),
    "pantograph driven by the wire": ("ZSpringPantograph", pantograph_wire),
    "moving load on the catenary": ("Catenary", catenary_load),
    "moving load on a stitched line": ("Catenary", catenary_load),
}
TABLES = {"moving load on a stitched line": STITCHED}


def host_calls(description: ModelDescription, name: str) -> str:
    """The host's input for this run: it prints all Real outputs after every step."""
    stop = 3.0 if name in TABLES else 4.0  # that line is shorter
    settings, inputs = RUNS[name][1](np.arange(0, stop, STEP))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    outputs = [v.valueReference for v in description.modelVariables if v.causality == "output" and v.type == "Real"]
    calls = [f"integer {reference[name]} {value}" for name, value in settings.items()]
    for number, values in enumerate(zip(*inputs.values())):
        calls += [f"real {reference[name]} {bits(value)}" for name, value in zip(inputs, values)]
        calls.append(f"step {bits(STEP)}" if number else "initialize")
        calls.append("print " + " ".join(map(str, outputs)))
    return "\n".join(calls) + "\n"
