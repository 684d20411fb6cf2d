"""A manifest without the tables that no edit touches: tomlkit needs long to parse a thousand of them."""

import re
import tomllib
from collections.abc import Collection
from itertools import groupby
from typing import Final

from fingerpad.study.manifest.load import LISTS

_HEADER: Final = re.compile(r"^[ \t]*\[[^,\n]*\][ \t]*(?:#.*)?\r?$", re.MULTILINE)
_LISTED: Final = re.compile(r"[ \t]*\[\[[ \t]*(\w+)[ \t]*\]\].*\n")
_MARK: Final = "# left out: "
# Of lists whose tables are found by their names.
_LISTS: Final = frozenset(name for kind, name in LISTS.items() if kind != "curve")


def folded(text: str, kept: Collection[str]) -> tuple[str, dict[str, str]]:
    """Leave tables out of a manifest.

    Parameters
    ----------
    text : str
        The manifest.
    kept : collection of str
        Names of the tables that stay.

    Returns
    -------
    folded : str
        The manifest, in which tables that follow one another in a list are one without keys.
    left_out : dict of str to str
        The text that stood in place of each line that was added.
    """
    starts = [match.start() for match in _HEADER.finditer(text)]
    pieces = [text[start:stop] for start, stop in zip([0, *starts], [*starts, len(text)], strict=True)]
    try:
        # A piece that is TOML on its own begins and ends between two values.
        lists = [_list_left_out(piece, kept) for piece in pieces]
    except tomllib.TOMLDecodeError:
        return text, {}
    if _MARK in text:
        return text, {}
    parts: list[str] = []
    left_out: dict[str, str] = {}
    for name, group in groupby(zip(lists, pieces, strict=True), key=lambda one: one[0]):
        run = "".join(piece for _, piece in group)
        if name is None:
            parts.append(run)
            continue
        header = _LISTED.match(run)
        assert header is not None
        line = f"{_MARK}{len(left_out)}\n"
        left_out[line] = run.removeprefix(header[0])
        parts.append(header[0] + line)
    return "".join(parts), left_out


def unfolded(text: str, left_out: dict[str, str]) -> str:
    """Put back what `folded` left out."""
    for line, tables in left_out.items():
        before, _, after = text.partition(line)
        text = before + tables + after
    return text


def _list_left_out(piece: str, kept: Collection[str]) -> str | None:
    """Return the list of which a piece of a manifest is a table that is left out, None for any other piece.

    Raises
    ------
    TOMLDecodeError
        If it is not TOML.
    """
    content, header = tomllib.loads(piece), _LISTED.match(piece)
    if header is None or header[1] not in _LISTS or not piece.endswith("\n"):
        return None
    tables = content.pop(header[1])
    return None if content or len(tables) > 1 or str(tables[0].get("name")) in kept else header[1]
