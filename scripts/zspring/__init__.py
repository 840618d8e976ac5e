"""Runs the ZSpringPantograph FMU: frequency response figure, simulation, list of variables."""
