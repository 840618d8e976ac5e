"""Prints the requirements in a pyproject.toml, one a line; runs in .venv, whose pip has tomli for Python 3.10.

python requirements.py pyproject.toml [GROUP ...]    always and in these dependency groups
python requirements.py pyproject.toml extras         of all extras
"""

import sys

if sys.version_info >= (3, 11):
    import tomllib
else:
    from pip._vendor import tomli as tomllib

with open(sys.argv[1], "rb") as file:
    table = tomllib.load(file)
if sys.argv[2:] == ["extras"]:
    groups = table["project"]["optional-dependencies"].values()
else:
    groups = [table["build-system"]["requires"], table["project"]["dependencies"]]
    groups += [table["dependency-groups"][name] for name in sys.argv[2:]]
print("\n".join(requirement for group in groups for requirement in group))
