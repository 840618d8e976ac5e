"""Modes and matrices of the linear models."""
