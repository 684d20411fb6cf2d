"""Tables of a TOML document, changed in place with tomlkit: comments and order stay."""

from collections.abc import Mapping
from typing import Any

import tomlkit
from tomlkit.items import AoT


def update(table: Any, values: Mapping[str, Any]) -> None:
    """Set the keys of a table; None removes one."""
    for key, value in values.items():
        if value is None:
            table.pop(key, None)
        else:
            table[key] = _item(value)


def _item(value: Any) -> Any:
    """Return a value as TOML writes it in place: tables inline, lists of tables one a line."""
    if isinstance(value, Mapping):
        table = tomlkit.inline_table()
        for key, item in value.items():
            if item is not None:
                table[key] = _item(item)
        return table
    if isinstance(value, list | tuple):
        array = tomlkit.array()
        for item in value:
            array.append(_item(item))
        return array.multiline(any(isinstance(item, Mapping) for item in value))
    return tomlkit.item(value)


def new_table(tables: Any, key: str) -> Any:
    """Return a new table of this name."""
    tables[key] = spaced(tomlkit.table())
    return tables[key]


def added(home: Any, name: str) -> Any:
    """Return a new table at the end of a list of tables."""
    if name not in home:
        home[name] = tomlkit.aot()
    listed = home[name]
    listed.append(spaced(tomlkit.table()) if isinstance(listed, AoT) else tomlkit.inline_table())
    return listed[-1]


def spaced(table: Any) -> Any:
    """Return a table with an empty line before it."""
    table.trivia.indent = "\n"
    return table


def remove(home: Any, name: str, table: Any) -> None:
    """Remove a table from a list of tables, and the list with its last one."""
    listed = home[name]
    listed.pop(next(place for place, one in enumerate(listed) if one is table))
    if not listed:
        home.pop(name)


def remove_scale(home: Any, name: str) -> None:
    """Remove a scale, and the table of scales with its last one."""
    home["scales"].pop(name)
    if not home["scales"]:
        home.pop("scales")
