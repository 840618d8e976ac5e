"""The pantograph on a bench: what commands share to measure responses and to read measured ones."""
