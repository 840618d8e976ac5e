"""Pantographs along a line: the co-simulation, its result, and the statistics of a contact force."""
