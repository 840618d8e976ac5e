"""EN 50318: statistics of a contact force, comparison with accepted ranges, and the validation report."""
