"""Template environment of all pages: numbers with uncertainty, and the style."""

import re
from functools import cache
from importlib.resources import files
from typing import Final

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from fingerpad._rounding import (
    positive_with_uncertainty,
    two_digits,
    uncertainty_of_positive,
    value_with_uncertainty,
)
from fingerpad._words import ended, unbroken
from fingerpad.estimate import Estimate
from fingerpad.flags import flags_in
from fingerpad.report import text
from fingerpad.report.plot import drawing

# What stands in texts for what a page shows by lower and raised signs.
_TYPESET: Final = (
    (re.compile(r"\bR_(0g|g|e)\b"), r"R<sub>\1</sub>"),
    (re.compile(r"R₀g"), "R<sub>0g</sub>"),
    (re.compile(r"ℓ([abcde])\b"), r"ℓ<sub>\1</sub>"),
    (re.compile(r"\^\(([^)]*)\)"), r"<sup>\1</sup>"),
)


def typeset(words: str) -> Markup:
    """Return text with subscripts and exponents, minus signs, and no line ending between number and unit."""
    page = str(escape(unbroken(words)))
    for found, shown in _TYPESET:
        page = found.sub(shown, page)
    return Markup(page)  # noqa: S704 (escaped above)


def signed_with_uncertainty(value: float | None, std: float | None = None) -> str:
    """Return `value_with_uncertainty` with a minus sign in place of a hyphen."""
    return value_with_uncertainty(value, std).replace("-", "−")


def quantity(found: Estimate, factor: float = 1.0) -> Markup:
    """Return a quantity from loading data as a cell, or a dash with the reason."""
    if not found.known:
        return Markup('<span title="{}">–</span>').format(found.reason)
    return Markup("{}").format(signed_with_uncertainty(factor * found.value, factor * found.std))


@cache
def templates() -> Environment:
    """Return the templates of the report's pages; a name that a page is not given is an error.

    They are kept: to compile them takes longer than to fill them.
    """
    environment = Environment(
        loader=PackageLoader("fingerpad.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
    )
    style = files("fingerpad.report").joinpath("report.css").read_text(encoding="utf-8")
    # Drawings are read as a page is written: all together they would take more memory than all rows.
    environment.filters |= {
        "ended": ended,
        "typeset": typeset,
        "probability": text.probability,
        "drawing": drawing,
        "percent": text.percent,
        "remedies": text.remedies,
        "flags": text.contact_flags,
        "advice": text.advice,
        "noted_flags": lambda codes, notes: flags_in(codes, "curve", notes=notes),
        "face_differences": text.face_differences,
        "phases": text.phase_words,
        "outline_doubts": text.outline_doubts,
        "photograph_flags": text.photograph_flags,
    }
    environment.globals |= {
        "pm": signed_with_uncertainty,
        "positive": positive_with_uncertainty,
        "std_of_positive": uncertainty_of_positive,
        "quantity": quantity,
        "symbols": text.VERDICT_SYMBOLS,
        "headlines": text.HEADLINE_WORDS,
        "two": two_digits,
        "interval_difference": text.interval_difference,
        "style": Markup(style),  # noqa: S704 (our own)
    }
    return environment
