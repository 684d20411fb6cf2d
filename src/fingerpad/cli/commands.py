"""How commands are read and listed, and what their errors become: lines on stderr, and an exit code."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from enum import IntEnum
from typing import Any

import typer
from typer import BadParameter
from typer.core import TyperCommand, TyperGroup

from fingerpad.cli import show
from fingerpad.exceptions import FingerpadError, GeometryError, is_interrupt, reason_of

_SMALLEST, _LARGEST = 1e-9, 1e9


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
        show.error("interrupted")
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
            show.error(
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
        try:
            return super().parse_args(ctx, spread)
        except BadParameter as error:  # of a value that is none of the choices, in the words of a validator
            error.message = error.message.removeprefix("Value error, ")
            raise

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
