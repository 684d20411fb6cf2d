"""Template environment of all pages: numbers with uncertainty, and the style."""

import re
from importlib.resources import files
from typing import Final

from jinja2 import BytecodeCache, Environment, PackageLoader, StrictUndefined
from jinja2.bccache import Bucket
from markupsafe import Markup, escape

from fingerpad._rounding import (
    positive_with_uncertainty,
    two_digits,
    uncertainty_of_positive,
    value_with_uncertainty,
)
from fingerpad.report.plot import drawing
from fingerpad.report.text import VERDICT_SYMBOLS, percent, probability, remedies


class _Compiled(BytecodeCache):
    """Keeps compiled templates while the process runs: to compile them takes longer than to fill them."""

    def __init__(self) -> None:
        self._kept: dict[str, bytes] = {}

    def load_bytecode(self, bucket: Bucket) -> None:
        """Put the compiled template into a bucket, if it is kept."""
        if bucket.key in self._kept:
            bucket.bytecode_from_string(self._kept[bucket.key])

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep the compiled template of a bucket."""
        self._kept[bucket.key] = bucket.bytecode_to_string()


_COMPILED: Final = _Compiled()
_NBSP: Final = "\N{NO-BREAK SPACE}"
# What stands in texts for what a page shows by lower and raised signs, and where no line may end.
_TYPESET: Final = (
    (re.compile(r"\bR_(0g|g|e)\b"), r"R<sub>\1</sub>"),
    (re.compile(r"R₀g"), "R<sub>0g</sub>"),
    (re.compile(r"ℓ([abcde])\b"), r"ℓ<sub>\1</sub>"),
    (re.compile(r"\^\(([^)]*)\)"), r"<sup>\1</sup>"),
    (re.compile(r"(?<=\d) (?=(?:mm|µm|N|kPa|s|ppi|px)\b|%|±)"), _NBSP),
    (re.compile(r"± (?=\d)"), f"±{_NBSP}"),
    (re.compile(r"(?<=[= (])-(?=\d)"), "−"),
)


def typeset(text: str) -> Markup:
    """Return text with subscripts and exponents, minus signs, and no line ending between number and unit."""
    page = str(escape(text))
    for found, shown in _TYPESET:
        page = found.sub(shown, page)
    return Markup(page)  # noqa: S704 (escaped above)


def signed_with_uncertainty(value: float | None, std: float | None = None) -> str:
    """Return `value_with_uncertainty` with a minus sign in place of a hyphen."""
    return value_with_uncertainty(value, std).replace("-", "−")


def templates() -> Environment:
    """Return the templates of the report's pages; a name that a page is not given is an error."""
    environment = Environment(
        loader=PackageLoader("fingerpad.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        bytecode_cache=_COMPILED,
    )
    style = files("fingerpad.report").joinpath("report.css").read_text(encoding="utf-8")
    # Drawings are read as a page is written: all together they would take more memory than all rows.
    # Macros are compiled with every page that takes some of them: their filters are known to all pages.
    environment.filters |= {
        "typeset": typeset,
        "probability": probability,
        "drawing": drawing,
        "percent": percent,
        "remedies": remedies,
    }
    environment.globals |= {
        "pm": signed_with_uncertainty,
        "positive": positive_with_uncertainty,
        "std_of_positive": uncertainty_of_positive,
        "symbols": VERDICT_SYMBOLS,
        "two": two_digits,
        "style": Markup(style),  # noqa: S704 (our own)
    }
    return environment
