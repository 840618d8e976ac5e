"""The linkage drawn to scale in simulated states, as pictures and as an animation."""
