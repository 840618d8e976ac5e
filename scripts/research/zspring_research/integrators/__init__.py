"""Work against precision: the FMU's HHT method beside the ODE solvers a user would pick instead."""
