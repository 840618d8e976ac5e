"""Target mean contact forces by speed, as the standards give them (quoted in papers: check before use)."""

from __future__ import annotations

AERODYNAMIC = 0.00097  # N/(km/h)^2
STANDING = {"AC": 70.0, "DC-3kV": 110.0, "DC-1.5kV": 140.0}  # N


def mean_force(supply: str, speed: float) -> float:
    """Target mean force in N at `speed` in km/h for a supply of STANDING."""
    return STANDING[supply] + AERODYNAMIC * speed**2
