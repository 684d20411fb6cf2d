"""Template environment of all pages: numbers with uncertainty, and the style."""

from importlib.resources import files

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from fingerpad.units import value_with_uncertainty


def templates() -> Environment:
    """Return the templates of the report's pages; a name that a page is not given is an error."""
    environment = Environment(
        loader=PackageLoader("fingerpad.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
    )
    style = files("fingerpad.report").joinpath("report.css").read_text(encoding="utf-8")
    environment.globals |= {"pm": value_with_uncertainty, "style": Markup(style)}  # noqa: S704 (our own)
    return environment
