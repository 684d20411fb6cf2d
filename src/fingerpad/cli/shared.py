"""Shared by all commands: error messages, exit codes, and printing."""

import math
import shlex
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from enum import IntEnum
from functools import wraps
from inspect import Parameter, signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer
from typer import Option
from typer.core import TyperCommand, TyperGroup

from fingerpad._json import dumps, plain
from fingerpad._plausible import in_radians, semi_axes_doubt
from fingerpad._rounding import two_digits, value_with_uncertainty
from fingerpad.exceptions import FingerpadError, GeometryError, LoadingError, is_interrupt, reason_of
from fingerpad.flags import Flagged, flags_in
from fingerpad.units import KPA_PER_MPA

if TYPE_CHECKING:
    from fingerpad.contact import Tissue
    from fingerpad.geometry import Placement

AsJson: TypeAlias = Annotated[bool, Option("--json", help="Print one JSON document instead of text.")]
Columns: TypeAlias = Annotated[
    list[str] | None,
    Option(metavar="QUANTITY=NAME:UNIT", help="A column of another name, as in force=Fz:mN. Repeatable."),
]

# A pad on its wedge, and how it is pressed.
SemiAxes: TypeAlias = Annotated[
    tuple[float, float, float],
    Option(help="Palmar, distal and radial-ulnar semi-axes, mm: half of the finger's thickness and width."),
]
WedgeAngle: TypeAlias = Annotated[
    float, Option(min=0, max=90, help="Wedge angle, degrees: 0 is flat, 90 on the fingertip.")
]
RollAngle: TypeAlias = Annotated[
    float, Option(min=-90, max=90, help="Roll about the finger's long axis, degrees.")
]
YoungsModulus: TypeAlias = Annotated[float, Option(help="Young's modulus E of the tissue, kPa.")]
Thickness: TypeAlias = Annotated[
    float | None, Option(help="Effective thickness of the tissue over bone, mm.", show_default="half-space")
]
PoissonRatio: TypeAlias = Annotated[float, Option(min=0, max=0.5, help="Poisson's ratio of the tissue.")]
_SMALLEST, _LARGEST = 1e-9, 1e9


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


def placement_of(*, semi_axes_mm: SemiAxes, wedge_deg: WedgeAngle, roll_deg: RollAngle = 0.0) -> "Placement":
    """Return the pad of ``--semi-axes-mm``, each of which must be positive, on its wedge."""
    from fingerpad.geometry import Ellipsoid, Placement

    if in_radians(wedge_deg):
        print_note("--wedge-deg: less than 1.6°: angles are in degrees, not radians")
    require_positive("--semi-axes-mm", *semi_axes_mm)
    if doubt := semi_axes_doubt(semi_axes_mm):
        print_note(f"--semi-axes-mm: {doubt}")
    wedge, roll = math.radians(wedge_deg), math.radians(roll_deg)
    return Placement(Ellipsoid(*semi_axes_mm), wedge_angle=wedge, roll_angle=roll)


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


def column_flags(columns: Mapping[str, str]) -> str:
    """Return what to write after the command to have columns read."""
    return " ".join(f"--column {shlex.quote(f'{name}={column}')}" for name, column in columns.items())


def require_positive(flag: str, *values: float | None) -> None:
    """Refuse a value that is given but not positive and finite."""
    for value in values:
        if value is not None and not (value > 0 and math.isfinite(value)):
            raise GeometryError(f"{flag} must be positive and finite, found {value:g}")


def print_result(record: Any, as_json: bool, print_as_text: Callable[[Any], None] | None = None) -> None:
    """Print a record as one JSON document, or as text: by default as lines, one for each key."""
    if as_json:
        typer.echo(dumps(record))
    else:
        (print_as_text or print_text)(record)


def print_folder(title: str, folder: Path | None, as_json: bool) -> None:
    """Say where pictures were written, if any were, unless scripts read the output."""
    if folder is not None and not as_json:
        typer.echo(f"{title}: {folder}")


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


def print_flags(record: Mapping[str, Any], *kinds: Flagged) -> None:
    """Print what each flag of a record means, and what to do about it."""
    for flag in flags_in(record.get("flags", ()), *kinds):
        typer.echo(f"{flag.code}: {flag.words}. To do: {flag.to_do}.")


def _text(value: Any, std: Any = None) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(item, (std or {}).get(key))}" for key, item in value.items())
    if isinstance(value, list):
        parts = (f"({_text(item)})" if isinstance(item, list) else _text(item) for item in value)
        return ", ".join(parts) or "none"
    if value is None:
        return "not known"
    if isinstance(std, float) and std > 0:
        return value_with_uncertainty(value, std)
    return f"{value:.6g}" if isinstance(value, float) else str(value)
