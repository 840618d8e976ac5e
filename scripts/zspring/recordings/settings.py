"""What was recorded and how: a TOML file, explained by resources/examples/recordings.toml."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, Strict, model_validator

from ..bench.curves import SENSES
from ..errors import ZSpringError
from ..settings import Band, BesidePath, Pair, Positive, Table, fitting, settings_of
from ..units import UnitError, conversion

MOTIONS = {"displacement": "m", "acceleration": "m/s2"}
_NUMBER_AND_UNIT = re.compile(r"\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*(\S.*)")

Frequencies = Annotated[
    tuple[Annotated[float, Field(gt=0)], ...], Strict(False), fitting("must be frequencies in Hz, above 0")
]
Limit = Annotated[Pair, fitting("must be [marked from, left out from]", lambda pair: 0 < pair[0] <= pair[1])]


class Time(Table):
    """Time of the values: a channel, or the sampling rate where there is none."""

    channel: str | None = None
    unit: str | None = Field(default=None, description="where the file does not tell it")
    rate: Positive | None = Field(default=None, description="Hz")

    @model_validator(mode="after")
    def _one_of_both(self) -> Time:
        if self.channel is not None and self.rate is not None:
            raise ValueError("channel and rate: must be one of both")
        return self


Names = Annotated[
    tuple[str, ...],
    BeforeValidator(lambda names: (names,) if isinstance(names, str) else names),
    Strict(False),
    fitting("must be the name of a channel, or a list of names", len),
]


class Sensor(Table):
    """A channel of the bench, or several whose sum counts."""

    channel: Names
    unit: str | None = Field(default=None, description="of the file's values, where it does not tell it")
    sensitivity: str | None = Field(default=None, description='number and unit, as "22.4 mV/N"')
    delay: float = Field(default=0.0, description="s, by which its values come late")
    limit: Positive | None = Field(
        default=None, description="largest value that can be recorded, in the channel's unit"
    )

    @property
    def named(self) -> str:
        return " + ".join(map(repr, self.channel))

    def factor(self, file_unit: str | None, wanted: str, where: str) -> float:
        """From the file's values to `wanted`. Raises ZSpringError where units are missing, disagree or do not fit."""
        if file_unit and self.unit and not _same(file_unit, self.unit):
            raise ZSpringError(f"{where}: unit = {self.unit!r}: the file says {file_unit}: one of them is wrong")
        unit = self.unit or file_unit
        if unit is None:
            given = "V" if self.sensitivity else wanted
            raise ZSpringError(f'{where}: the file does not tell the unit of {self.named}: unit = "{given}", say')
        try:
            if self.sensitivity is None:
                return conversion(unit, wanted)[1]
            value, per = self._sensitivity(where)
            return conversion(unit, "V")[1] / (value * conversion(per, f"V/({wanted})")[1])
        except UnitError as error:
            raise ZSpringError(f"{where}: {error}") from None

    def _sensitivity(self, where: str) -> tuple[float, str]:
        found = _NUMBER_AND_UNIT.fullmatch(self.sensitivity or "")
        if found is None or float(found[1]) == 0:
            raise ZSpringError(
                f'{where}: sensitivity = {self.sensitivity!r}: must be a number and a unit, as "10 mV/N"'
            )
        return float(found[1]), found[2]


def _same(one: str, other: str) -> bool:
    """Whether two units are one."""
    try:
        return abs(conversion(one, other)[1] - 1) < 1e-9
    except UnitError:
        return one.strip() == other.strip()


class Force(Sensor):
    """How the load cell counts."""

    sense: Literal["specimen", "contact"] | None = Field(default=None, description="of SENSES in bench/curves.py")


class Motion(Sensor):
    """Which way a motion counts."""

    positive: Literal["up", "down"] | None = None

    @property
    def sign(self) -> int:
        return -1 if self.positive == "down" else 1


class File(Table):
    """A file, and what is one for all that is in it."""

    path: BesidePath = Field(alias="file")
    level: str | None = Field(default=None, description="of the amplitude, for all holds of the file")
    skip: int = Field(default=0, ge=0, description="lines of a text before that with the names of the columns")


class Sweep(Table):
    """How the frequencies were driven."""

    kind: Literal["holds", "slow"] = "holds"
    direction: Literal["up", "down", "rest"] | None = Field(default=None, description="None: as the records have it")
    frequencies: Frequencies | None = Field(default=None, description="Hz, of the holds; None: all that are found")
    band: Band = (0.3, 40.0)
    settle: float = Field(default=2.0, ge=0, description="periods at the begin of a hold to leave out at least")
    periods: int = Field(default=10, ge=6, description="for each point of a slow sweep")
    rate: Positive | None = Field(default=None, description="Hz/s, of a slow sweep")
    octaves: Positive | None = Field(default=None, description="octaves a minute, of a slow one that is logarithmic")

    @model_validator(mode="after")
    def _fit_together(self) -> Sweep:
        if self.kind == "slow":
            if (self.rate is None) == (self.octaves is None):
                raise ValueError("a slow sweep needs its rate in Hz/s, or octaves, in a minute: one of both")
            if self.frequencies:
                raise ValueError('frequencies: are of kind = "holds"')
        elif self.rate or self.octaves:
            raise ValueError('rate and octaves: are of kind = "slow"')
        return self


class Limits(Table):
    """Up to where a hold is used, and from where it is marked; relative."""

    distortion: Limit = (0.02, 0.10)
    error: Limit = (0.03, 0.30)


class Settings(Table):
    """All that turns recordings into frequency responses."""

    recording: list[File] = Field([], min_length=1, validate_default=True)
    time: Time = Time()
    force: Force
    displacement: Motion | None = None
    acceleration: Motion | None = None
    motion: Literal["displacement", "acceleration"] | None = Field(default=None, description="which of both H is of")
    fixture_mass: float = Field(default=0.0, ge=0, description="kg, of what moves between load cell and head")
    static_force: float | None = Field(default=None, ge=0, description="N")
    sweep: Sweep = Sweep()
    limits: Limits = Limits()

    @model_validator(mode="after")
    def _clear(self) -> Settings:
        if self.force.sense is None:
            raise ValueError(
                'force.sense is missing: "contact" where positive values press the head down, "specimen" where they '
                "are along the motion as it is recorded"
            )
        if not self.motions:
            raise ValueError("a motion is missing: a table [displacement] or [acceleration]")
        if len(self.motions) > 1 and self.motion is None:
            raise ValueError('motion is missing: "displacement" or "acceleration", of which H is; the other checks it')
        if self.motion and self.motion not in self.motions:
            raise ValueError(f"motion = {self.motion!r}: there is no table [{self.motion}]")
        for name, motion in self.motions.items():
            if motion.positive is None and (self.force.sense == "contact" or len(self.motions) > 1):
                raise ValueError(f'{name}.positive is missing: "up" or "down"')
        return self

    @property
    def motions(self) -> dict[str, Motion]:
        """The channels of motion that there are, that of H first."""
        both = {"displacement": self.displacement, "acceleration": self.acceleration}
        names = sorted((name for name in both if both[name] is not None), key=lambda name: name != self.motion)
        return {name: motion for name in names if (motion := both[name]) is not None}

    @property
    def contact_sign(self) -> int:
        """From the recorded force to one that presses the head down."""
        along = next(iter(self.motions.values())).sign if self.force.sense == "specimen" else 1
        return -SENSES[self.force.sense or ""] * along


def read_settings(path: Path) -> Settings:
    """Settings of a file. Raises ZSpringError with file and key for anything unknown, missing or not clear."""
    with settings_of(path, Settings, brackets=True) as settings:
        for name, wanted in (("force", "N"), *((name, MOTIONS[name]) for name in settings.motions)):
            sensor: Sensor = getattr(settings, name)
            if sensor.unit and not sensor.sensitivity:
                sensor.factor(None, wanted, f"[{name}]")
        return settings
