"""Newton tangents of the steep friction law, and what its steepness costs."""
