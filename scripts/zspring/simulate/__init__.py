"""Simulation of any drive with inputs from a file."""
