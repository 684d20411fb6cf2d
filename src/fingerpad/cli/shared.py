"""Shared by all commands: error messages, exit codes, and printing."""

import math
import shlex
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from enum import IntEnum
from functools import wraps
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, NamedTuple, TypeAlias

import typer
from typer.core import TyperCommand, TyperGroup

from fingerpad._json import dumps, plain
from fingerpad._plausible import in_radians, semi_axes_doubt
from fingerpad._rounding import two_digits, value_with_uncertainty
from fingerpad.exceptions import FingerpadError, GeometryError, LoadingError, is_interrupt, reason_of
from fingerpad.units import KPA_PER_MPA

if TYPE_CHECKING:
    from fingerpad.contact import Contact, Tissue
    from fingerpad.estimate import Estimate
    from fingerpad.geometry import Ellipsoid, Placement

AsJson: TypeAlias = Annotated[bool, typer.Option("--json", help="Print one JSON document instead of text.")]

Columns: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        metavar="QUANTITY=NAME:UNIT", help="A column of another name, as in force=Fz:mN. Repeatable."
    ),
]

# A pad on its wedge, and how it is pressed.
SemiAxes: TypeAlias = Annotated[
    tuple[float, float, float],
    typer.Option(
        help="Palmar, distal and radial-ulnar semi-axes, mm: half of the finger's thickness and width."
    ),
]
WedgeAngle: TypeAlias = Annotated[
    float, typer.Option(min=0, max=90, help="Wedge angle, degrees: 0 is flat, 90 on the fingertip.")
]
RollAngle: TypeAlias = Annotated[
    float, typer.Option(min=-90, max=90, help="Roll about the finger's long axis, degrees.")
]
YoungsModulus: TypeAlias = Annotated[float, typer.Option(help="Young's modulus E of the tissue, kPa.")]
Thickness: TypeAlias = Annotated[
    float | None,
    typer.Option(help="Effective thickness of the tissue over bone, mm.", show_default="half-space"),
]
PoissonRatio: TypeAlias = Annotated[
    float, typer.Option(min=0, max=0.5, help="Poisson's ratio of the tissue.")
]
Load: TypeAlias = Annotated[float | None, typer.Option(help="Normal force, N.")]
Area: TypeAlias = Annotated[float | None, typer.Option(help="Contact area, mm², instead of --load-n.")]
Indentation: TypeAlias = Annotated[float | None, typer.Option(help="Indentation, mm, instead of --load-n.")]
Grid: TypeAlias = Annotated[int, typer.Option(min=64, max=1024, help="Grid cells along each side.")]


_ROUND: Final = 1.001  # aspect ratio below which an ellipse has no direction
_SMALLEST: Final = 1e-9
_LARGEST: Final = 1e9


class Pressed(NamedTuple):
    """How a pad is pressed: arguments of a contact, one of which is not None, and its flag."""

    given: dict[str, float | None]
    flag: str

    def __str__(self) -> str:
        """Return the flag and its value."""
        return f"{self.flag} {next(value for value in self.given.values() if value is not None):g}"


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


class Exit(IntEnum):
    """Exit codes."""

    CANNOT_WRITE = 1  # output that nothing can be written to, or an error that was not foreseen
    REFUSED = 2  # manifest, command line, or a place where results cannot be written
    SOME_FAILED = 3
    INTERRUPTED = 130


class Group(TyperGroup):
    """Commands whose help lists them under their panels, each with its whole first sentence."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:  # noqa: ARG002 (the overridden signature)
        """Write the list of commands."""
        panels: dict[str, list[tuple[str, str]]] = {}
        for name, command in self.commands.items():
            summary = " ".join((command.help or "").partition("\n\n")[0].split())
            panel = getattr(command, "rich_help_panel", None)
            panels.setdefault(panel if isinstance(panel, str) else "Commands", []).append((name, summary))
        for title, rows in panels.items():
            with formatter.section(title):
                formatter.write_dl(rows)


@contextmanager
def _reported_interrupt() -> Iterator[None]:
    try:
        yield
    except (Exception, KeyboardInterrupt) as error:
        if not is_interrupt(error):
            raise
        print_error("interrupted")
        raise typer.Exit(Exit.INTERRUPTED) from None


class Commands(Group):
    """Commands whose errors are lines on stderr and an exit code."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run a command; `ModuleNotFoundError` is left to the caller, which handles optional packages."""
        try:
            return super().main(*args, **kwargs)
        except ModuleNotFoundError:
            raise
        except Exception as error:
            print_error(
                reason_of(error, "cannot write" if isinstance(error, OSError) else "this cannot be done")
            )
            sys.exit(Exit.REFUSED if isinstance(error, FingerpadError) else Exit.CANNOT_WRITE)

    def make_context(self, *args: Any, **kwargs: Any) -> Any:
        """Read the arguments, and report an interrupt."""
        with _reported_interrupt():
            return super().make_context(*args, **kwargs)

    def invoke(self, ctx: Any) -> Any:
        """Run a command, and report an interrupt that it does not report."""
        with _reported_interrupt():
            return super().invoke(ctx)


class Command(TyperCommand):
    """A command whose numbers are finite, and of a size that anything about a finger can have.

    A flag that may be repeated takes several numbers at once, too.
    """

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the arguments, with such a flag before each of its numbers."""
        self._check_tuples(args)
        repeated = {flag for one in self.params if getattr(one, "multiple", False) for flag in one.opts}
        flag, spread = "", list[str]()
        for word in args:
            if word in repeated:
                flag = word
            elif not _is_number(word):
                flag = ""
            elif flag and spread[-1] != flag:
                spread.append(flag)
            spread.append(word)
        return super().parse_args(ctx, spread)

    def _check_tuples(self, args: list[str]) -> None:
        """Refuse a flag of several numbers that is followed by something else."""
        for parameter in self.params:
            for place, word in enumerate(args if parameter.nargs > 1 else []):
                if word in parameter.opts:
                    found = args[place + 1 : place + 1 + parameter.nargs]
                    if len(found) < parameter.nargs or not all(map(_is_number, found)):
                        raise GeometryError(
                            f"{word} takes {parameter.nargs} numbers separated by spaces, "
                            f"found {' '.join(found) or 'none'}"
                        )

    def invoke(self, ctx: Any) -> Any:
        """Run it, unless a flag is given a number that nothing can be computed from."""
        for parameter in self.params:
            value = ctx.params.get(parameter.name)
            for number in value if isinstance(value, tuple) else (value,):
                if isinstance(number, float) and number and not _SMALLEST <= abs(number) <= _LARGEST:
                    raise GeometryError(
                        f"{parameter.opts[0]} must be finite, and 0 or {_SMALLEST:g} to {_LARGEST:g} "
                        f"in magnitude, found {number:g}"
                    )
        return super().invoke(ctx)


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def print_error(text: str) -> None:
    """Print lines on stderr, each beginning with the name of the command."""
    for line in text.splitlines():
        typer.echo(f"fingerpad: {line}", err=True)


def print_note(text: str) -> None:
    """Print on stderr what looks wrong in the input."""
    typer.echo(f"note: {text}", err=True)


def print_if_too_large(size: float) -> None:
    """Say of a contact as wide as the bodies, by its a/R, that Hertz theory does not hold for it."""
    from fingerpad.contact.law_factors import WIDEST

    if size > WIDEST:
        typer.echo(
            f"Hertz theory does not hold here: the contact's radius is {size:.2g} times that of curvature; "
            f"beyond {WIDEST:.1f} not even the error is known: check load, modulus and units"
        )


def checked_pad(semi_axes_mm: tuple[float, float, float]) -> "Ellipsoid":
    """Return the pad of ``--semi-axes-mm``, each of which must be positive."""
    from fingerpad.geometry import Ellipsoid

    for semi_axis in semi_axes_mm:
        require_positive("--semi-axes-mm", semi_axis)
    if doubt := semi_axes_doubt(semi_axes_mm):
        print_note(f"--semi-axes-mm: {doubt}")
    return Ellipsoid(*semi_axes_mm)


def placement_of(*, semi_axes_mm: SemiAxes, wedge_deg: WedgeAngle, roll_deg: RollAngle = 0.0) -> "Placement":
    """Return the pad on its wedge."""
    from fingerpad.geometry import Placement

    if in_radians(wedge_deg):
        print_note("--wedge-deg: less than 1.6°: angles are in degrees, not radians")
    return Placement(
        checked_pad(semi_axes_mm), wedge_angle=math.radians(wedge_deg), roll_angle=math.radians(roll_deg)
    )


def tissue_of(
    *, youngs_modulus_kpa: YoungsModulus, poisson_ratio: PoissonRatio = 0.5, thickness_mm: Thickness = None
) -> "Tissue":
    """Return the tissue of ``--youngs-modulus-kpa`` and its other options, in MPa and mm."""
    from fingerpad.contact import Tissue

    require_positive("--youngs-modulus-kpa", youngs_modulus_kpa)
    require_positive("--thickness-mm", thickness_mm)
    return Tissue(
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


def estimate_of(
    flag: str, words: str, unit: str = "", *, read: Callable[[str], float] | None = None, **limits: Any
) -> Callable[..., "Estimate | None"]:
    """Return a function of a flag and its standard uncertainty, for `takes`, which returns the two as one.

    Text is read by a function where it is not a finite number.
    """
    name = flag[2:].replace("-", "_")

    def make(**given: Any) -> "Estimate | None":
        value, std = given[name], given[f"{name}_std"]
        if not std >= 0 or (std and value is None):
            raise LoadingError(f"{flag}-std must not be negative, and goes with {flag}")
        if value is None:
            return None
        from fingerpad.estimate import Estimate

        return Estimate.symmetric(value if read is None else read(value), std)

    kind = str if read else float
    own = Annotated[kind | None, typer.Option(help=words, **limits)]  # type: ignore[valid-type]
    std = Annotated[float, typer.Option(min=0, help=f"Its standard uncertainty{unit and ', '}{unit}.")]
    parameters = ((name, None, own), (f"{name}_std", 0.0, std))
    make.__signature__ = Signature(  # type: ignore[attr-defined]
        [Parameter(each, Parameter.KEYWORD_ONLY, default=of, annotation=to) for each, of, to in parameters]
    )
    return make


def column_flags(columns: Mapping[str, str]) -> str:
    """Return what to write after the command to have columns read."""
    return " ".join(f"--column {shlex.quote(f'{name}={column}')}" for name, column in columns.items())


def require_positive(flag: str, value: float | None) -> None:
    """Refuse a value that is given but not positive and finite."""
    if value is not None and not (value > 0 and math.isfinite(value)):
        raise GeometryError(f"{flag} must be positive and finite, found {value:g}")


def print_json(value: Any) -> None:
    """Print one JSON document."""
    typer.echo(dumps(value))


def pressed_of(*, load_n: Load = None, area_mm2: Area = None, indentation_mm: Indentation = None) -> Pressed:
    """Return the one of load, area and indentation that is given."""
    option = only_one({"--load-n": load_n, "--area-mm2": area_mm2, "--indentation-mm": indentation_mm})
    return Pressed({"load": load_n, "area": area_mm2, "indentation": indentation_mm}, option)


def only_one(given: Mapping[str, float | None]) -> str:
    """Return which of some flags is given, exactly one of which must be, with a positive value."""
    found = [flag for flag, value in given.items() if value is not None]
    if len(found) != 1:
        *most, last = given
        raise typer.BadParameter(f"give exactly one of {', '.join(most)} and {last}")
    require_positive(found[0], given[found[0]])
    return found[0]


def pressed_record(contact: "Contact") -> dict[str, Any]:
    """Return how a pad is pressed."""
    return {
        "load_N": contact.load,
        "area_mm2": contact.area,
        "indentation_mm": contact.indentation,
        "area_over_pi_indentation_mm": contact.area_over_pi_indentation,
    }


def contact_record(contact: "Contact") -> dict[str, Any]:
    """Return one contact, in mm, N and kPa; the long axis lies along either direction of a near-circle."""
    along = "either" if contact.aspect_ratio < _ROUND else "first" if contact.along else "second"
    return {
        **pressed_record(contact),
        "semi_major_mm": contact.semi_major,
        "semi_minor_mm": contact.semi_minor,
        "aspect_ratio": contact.aspect_ratio,
        "long_axis_along": along if contact.load > 0 else None,
        "peak_pressure_kpa": KPA_PER_MPA * contact.peak_pressure,
    }


def print_folder(title: str, folder: Path | None, as_json: bool) -> None:
    """Say where pictures were written, if any were, unless scripts read the output."""
    if folder is not None and not as_json:
        typer.echo(f"{title}: {folder}")


def print_record(record: Mapping[str, Any], as_json: bool) -> None:
    """Print a record as JSON or as lines of text."""
    if as_json:
        print_json(record)
    else:
        print_text(record)


def print_text(record: Mapping[str, Any]) -> None:
    """Print a record as lines of text, each number with its standard uncertainty."""
    values = plain(record)
    shown = {}
    for key, value in values.items():
        if not key.endswith("_std"):
            shown[key] = _text(value, values.get(f"{key}_std"))
        elif key.removesuffix("_std") not in values:
            shown[key] = two_digits(value) if isinstance(value, float) and value > 0 else _text(value)
    print_rows(shown.items())


def print_rows(rows: Iterable[Sequence[str]], indent: str = "") -> None:
    """Print rows of text with their columns below each other."""
    columns = zip(*(rows := list(rows)), strict=True)
    widths = [max(map(len, column)) for column in columns]
    for row in rows:
        cells = (f"{text:<{width}}" for text, width in zip(row, widths, strict=True))
        typer.echo(indent + "  ".join(cells).rstrip())


def print_side_by_side(records: Mapping[str, Mapping[str, Any]]) -> None:
    """Print records, a column each, with the lines of the first."""
    columns = [plain(record) for record in records.values()]
    typer.echo(f"{'':<28}" + "".join(f"{title:<16}" for title in records).rstrip())
    for key in columns[0]:
        cells = (_cell(column[key]) for column in columns)
        typer.echo(f"{key:<28}" + "".join(f"{cell:<16}" for cell in cells).rstrip())


def _cell(value: str | float | None) -> str:
    if value is None:
        return "–"
    return f"{value:.5g}" if isinstance(value, float) else value


def print_law_flag(flag: str | None) -> None:
    """Say what takes a contact out of the range of the fast laws, if anything does."""
    if flag:
        typer.echo(f"The fast laws do not hold here: {flag.replace('_', ' ')}")


def _text(value: Any, std: Any = None) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(item, (std or {}).get(key))}" for key, item in value.items())
    if isinstance(value, list):
        return ", ".join(map(_text, value)) or "none"
    if value is None:
        return "not known"
    if isinstance(std, float) and std > 0:
        return value_with_uncertainty(value, std)
    return f"{value:.6g}" if isinstance(value, float) else str(value)
