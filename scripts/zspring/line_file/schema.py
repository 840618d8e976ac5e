"""A line file as its TOML tables describe it; docs/lines.md and the files in resources/lines explain it.

What a table leaves out comes from the set that `parameters` names. Units are SI.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, PlainValidator, model_validator

from ..parameter_sets import LINES
from ..settings import BesidePath, Positive, Table, fitting, set_name
from ..tables import LARGEST

MOST_SPANS = 400
LONGEST, HIGHEST, STEEPEST = 1000.0, 100.0, 0.5  # m of a span, m of what is above another, 1: no slips of units
NotNegative = Annotated[float, Field(ge=0)]
WholeNumbers = Annotated[
    list[int],
    BeforeValidator(lambda numbers: [numbers] if isinstance(numbers, int) else numbers),
    fitting("must be a whole number or a list of them", lambda numbers: len(set(numbers)) == len(numbers) > 0),
]


def _each(least: float, most: float) -> PlainValidator:
    """A number, or a list with one for each dropper of a span."""

    def check(content: Any) -> Any:
        for number in content if isinstance(content, list) else [content]:
            if isinstance(number, bool) or not isinstance(number, (int, float)) or not least <= number <= most:
                raise ValueError(f"must be a number of {least:g} to {most:g}, or a list with one for each dropper")
        return content

    return PlainValidator(check)


Each = Annotated[float | list[float], _each(-HIGHEST, HIGHEST)]
EachLength = Annotated[float | list[float], _each(0.0, HIGHEST)]
EachNotNegative = Annotated[float | list[float], _each(0.0, LARGEST)]
Height = Annotated[float, Field(gt=0, le=HIGHEST)]


class Part(Table):
    """A part of the line, of which everything may be left out that is told elsewhere.

    alternatives    groups of keys, of which one file gives one alone
    """

    alternatives: ClassVar[tuple[tuple[str, ...], ...]] = ()

    @property
    def given(self) -> dict[str, Any]:
        """What the file says, by key."""
        return {name: getattr(self, name) for name in type(self).model_fields if getattr(self, name) is not None}

    @model_validator(mode="after")
    def _one_of_them(self) -> Part:
        first, *others = ({*group} & {*self.given} for group in self.alternatives) if self.alternatives else [set()]
        for other in others:
            if first and other:
                raise ValueError(f"{' and '.join(sorted(first | other))}: give one of both")
        return self


class Wire(Part):
    """Contact wire or messenger."""

    refused: ClassVar = {
        "EA": "the wires' tension is constant in this model, and what they stretch has no effect: leave it out"
    }

    mass: Positive | None = Field(default=None, description="kg/m")
    tension: Positive | None = Field(default=None, description="N")
    EI: NotNegative | None = Field(default=None, description="N.m2")


class Damping(Part):
    """Rayleigh's, one for the whole line."""

    mass: NotNegative | None = Field(default=None, description="1/s")
    stiffness: NotNegative | None = Field(default=None, description="s")


class SteadyArm(Part):
    """On the contact wire at a support: a stiffness, or the geometry that makes one."""

    alternatives: ClassVar = ("stiffness",), ("length", "radial_load")

    mass: NotNegative | None = Field(default=None, description="kg, that moves with the contact wire")
    stiffness: NotNegative | None = Field(default=None, description="N/m, vertical")
    length: Positive | None = Field(default=None, description="m")
    radial_load: NotNegative | None = Field(default=None, description="N, along the arm")

    @model_validator(mode="after")
    def _is_geometry(self) -> SteadyArm:
        if (self.length is None) != (self.radial_load is None):
            raise ValueError("length and radial_load: the stiffness is made of both")
        return self


class Stitch(Part):
    """A stitch wire, in the middle of which a support stands. Droppers between its clamps hang on it."""

    length: Positive | None = Field(default=None, description="m, between the clamps on the messenger")
    tension: Positive | None = Field(default=None, description="N")
    mass: Positive | None = Field(default=None, description="kg/m")
    clamp: NotNegative | None = Field(default=None, description="kg, each of both on the messenger")


class Support(Part):
    """Under the messenger, between two spans; the encumbrance is that of the anchors as well."""

    refused: ClassVar = {"damping": "damping is Rayleigh's, one for the whole line: give [damping]"}

    encumbrance: Height | None = Field(default=None, description="m, of the messenger over the contact wire's height")
    stiffness: NotNegative | None = Field(default=None, description="N/m, under the messenger")


class Dropper(Part):
    """What a dropper is made of; a list in a span has one value for each of its droppers."""

    alternatives: ClassVar = ("stiffness",), ("EA",)

    stiffness: EachNotNegative | None = Field(default=None, description="N/m, whatever its length")
    EA: EachNotNegative | None = Field(default=None, description="N")
    mass: EachNotNegative | None = Field(default=None, description="kg/m")
    clamp_contact: EachNotNegative | None = Field(default=None, description="kg, on the contact wire")
    clamp_messenger: EachNotNegative | None = Field(
        default=None, description="kg, on the messenger, or on the stitch wire"
    )


class Span(Part):
    """A span and its droppers."""

    alternatives: ClassVar = ("sag",), ("dropper_length",)
    refused: ClassVar = {"encumbrance": "it is told of supports: give it in [support] or a [[support_exception]]"}

    length: Annotated[float, Field(gt=0, le=LONGEST)] | None = Field(default=None, description="m")
    gradient: Annotated[float, Field(ge=-STEEPEST, le=STEEPEST)] | None = Field(
        default=None, description="1, rise of the contact wire's height over the span"
    )
    droppers: Annotated[list[float], fitting("must be a list of distances in m")] | None = Field(
        default=None, description="m, of each from the span's begin"
    )
    sag: Each | None = Field(default=None, description="m, by how much the contact wire hangs lower there")
    dropper_length: EachLength | None = Field(
        default=None, description="m, unstretched, from which the height comes out"
    )
    length_error: Each | None = Field(default=None, description="m, that a dropper is too long")
    missing: WholeNumbers | None = Field(default=None, description="droppers of the span that never pull, from 1")


class SpanException(Span):
    """What is otherwise in some spans."""

    spans: WholeNumbers = Field(description="from 1")
    dropper: Dropper | None = None


class SupportException(Support):
    """What is otherwise at some supports."""

    after_spans: WholeNumbers = Field(description="from 1; 0 and the last are the anchors")
    steady_arm: SteadyArm | None = None
    stitch: Stitch | Literal[False] | None = Field(default=None, description="false: there is none")


class PointMass(Table):
    """An insulator, a splice, a clamp."""

    span: int = Field(ge=1)
    at: NotNegative = Field(description="m, from the span's begin")
    wire: Literal["contact_wire", "messenger"]
    mass: Positive = Field(description="kg")
    what: str = ""


class Measured(Table):
    """Heights of the contact wire and lengths of droppers as they were found, in place of those of the design."""

    file: BesidePath
    datum: float | None = Field(
        default=None, description="m, height of the contact wire, as the file counts, at the line's begin"
    )
    lengths: Literal["unstretched", "installed"] | None = None
    use: Literal["heights", "lengths"] | None = None


class Irregularity(Table):
    """Of the contact wire, free of stress: a column of places and one of heights over the wire without it."""

    file: BesidePath


class LineFile(Table):
    """A line file."""

    name: str
    description: str = ""
    synthetic: bool = False
    parameters: Annotated[str, set_name(LINES)] = Field(default="", description="set of what the file leaves out")
    spans: int | None = Field(default=None, ge=1, le=MOST_SPANS)
    contact_wires: Literal[1, 2] = 1
    contact_wire: Wire = Wire()
    messenger: Wire = Wire()
    damping: Damping = Damping()
    support: Support = Support()
    steady_arm: SteadyArm = SteadyArm()
    dropper: Dropper = Dropper()
    stitch: Stitch | None = Field(default=None, description="at all supports")
    span: Span = Span()
    span_exceptions: list[SpanException] = Field(default=[], alias="span_exception")
    support_exceptions: list[SupportException] = Field(default=[], alias="support_exception")
    point_masses: list[PointMass] = Field(default=[], alias="point_mass")
    measured: Measured | None = None
    irregularity: Irregularity | None = None

    def parts(self) -> Mapping[str, Part]:
        """What may be left out, by its table's name."""
        names = "contact_wire", "messenger", "damping", "support", "steady_arm", "dropper", "span"
        return {name: getattr(self, name) for name in names}
