"""Studies that are evidence for the paper: commands of their own, see pyproject.toml beside this package."""
