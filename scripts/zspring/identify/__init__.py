"""Identification of the pantograph's parameters from measured frequency responses."""
