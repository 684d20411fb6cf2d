"""Options that several commands take, and what they mean."""

import math
import shlex
from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from inspect import Parameter, signature
from typing import Annotated, Any, TypeAlias

from typer import CallbackParam, Option

import fingerpad as fp
from fingerpad._plausible import in_radians, semi_axes_doubt, thickness_doubt
from fingerpad.cli import show
from fingerpad.exceptions import GeometryError, LoadingError
from fingerpad.units import KPA_PER_MPA


def positive(words: str, look: Callable[[Any], Any] = lambda value: value, **settings: Any) -> Any:
    """Return an option whose value, if it is given, must be positive and finite, and is then looked at."""

    def check(flag: CallbackParam, value: Any) -> Any:
        for number in value if isinstance(value, tuple) else (value,):
            if number is not None and not 0 < number < math.inf:
                raise GeometryError(f"{flag.opts[0]} must be positive and finite, found {number:g}")
        return value if value is None else look(value)

    return Option(help=words, callback=check, **settings)


def noted_thickness(value: float) -> float:
    """Note a thickness that no fingertip has, and return it."""
    if doubt := thickness_doubt(value):
        show.note(f"--thickness-mm: {doubt}")
    return value


AsJson: TypeAlias = Annotated[bool, Option("--json", help="Print one JSON document instead of text.")]
Columns: TypeAlias = Annotated[
    list[str] | None,
    Option(metavar="QUANTITY=NAME:UNIT", help="A column of another name, as in force=Fz:mN. Repeatable."),
]

# A pad on its wedge, and how it is pressed.
SemiAxes: TypeAlias = Annotated[
    tuple[float, float, float],
    positive("Palmar, distal and radial-ulnar semi-axes, mm: half of the finger's thickness and width."),
]
WedgeAngle: TypeAlias = Annotated[
    float, Option(min=0, max=90, help="Wedge angle, degrees: 0 is flat, 90 on the fingertip.")
]
RollAngle: TypeAlias = Annotated[
    float, Option(min=-90, max=90, help="Roll about the finger's long axis, degrees.")
]
YoungsModulus: TypeAlias = Annotated[float, positive("Young's modulus E of the tissue, kPa.")]
Thickness: TypeAlias = Annotated[
    float | None,
    positive("Effective thickness of the tissue over bone, mm.", noted_thickness, show_default="half-space"),
]
PoissonRatio: TypeAlias = Annotated[float, Option(min=0, max=0.5, help="Poisson's ratio of the tissue.")]


def takes(**groups: Callable[..., Any]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the flags of functions, and pass it what these return, each by its name.

    Flags stand where the command has that name; those without a default come first.
    """

    def with_groups(command: Callable[..., None]) -> Callable[..., None]:
        own, flags = signature(command), {name: signature(make).parameters for name, make in groups.items()}

        @wraps(command)
        def called(**given: Any) -> None:
            values = {name: {flag: given.pop(flag) for flag in flags[name]} for name in groups}
            command(**given, **{name: make(**values[name]) for name, make in groups.items()})

        parts = (flags[name].values() if name in flags else [one] for name, one in own.parameters.items())
        ordered = sorted(
            (one for part in parts for one in part), key=lambda one: one.default is not one.empty
        )
        parameters = [one.replace(kind=Parameter.KEYWORD_ONLY) for one in ordered]
        called.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
        called.__annotations__ = {one.name: one.annotation for one in parameters}
        return called

    return with_groups


def placement_of(
    *, semi_axes_mm: SemiAxes, wedge_deg: WedgeAngle, roll_deg: RollAngle = 0.0
) -> "fp.Placement":
    """Return the pad of ``--semi-axes-mm`` on its wedge."""
    if in_radians(wedge_deg):
        show.note("--wedge-deg: less than 1.6°: angles are in degrees, not radians")
    if doubt := semi_axes_doubt(semi_axes_mm):
        show.note(f"--semi-axes-mm: {doubt}")
    wedge, roll = math.radians(wedge_deg), math.radians(roll_deg)
    return fp.Placement(fp.Ellipsoid(*semi_axes_mm), wedge_angle=wedge, roll_angle=roll)


def tissue_of(
    *, youngs_modulus_kpa: YoungsModulus, poisson_ratio: PoissonRatio = 0.5, thickness_mm: Thickness = None
) -> "fp.Tissue":
    """Return the tissue of ``--youngs-modulus-kpa`` and its other options, in MPa and mm."""
    return fp.Tissue(
        youngs_modulus=youngs_modulus_kpa / KPA_PER_MPA,
        poisson_ratio=poisson_ratio,
        thickness=math.inf if thickness_mm is None else thickness_mm,
    )


def columns_of(texts: list[str] | None, *known: str) -> dict[str, str]:
    """Return the columns of ``--column`` by quantity."""
    columns = {}
    for text in texts or []:
        quantity, _, column = text.partition("=")
        if quantity not in known or ":" not in column:
            raise LoadingError(f"--column takes QUANTITY=NAME:UNIT with {', '.join(known)}, found {text!r}")
        columns[quantity] = column
    return columns


def column_flags(columns: Mapping[str, str]) -> str:
    """Return what to write after the command to have columns read."""
    return " ".join(f"--column {shlex.quote(f'{name}={column}')}" for name, column in columns.items())


def note_unread(columns: Mapping[str, Sequence[str]]) -> None:
    """Say of columns that were not read, by the quantity that they may be, how to have them read."""
    from fingerpad._columns import unread_notes

    for words in unread_notes(columns, lambda name, column: f": {column_flags({name: column})}"):
        show.note(words)
