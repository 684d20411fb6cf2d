"""Template environment of all pages: numbers with uncertainty, and the style."""

from importlib.resources import files
from typing import Final

from jinja2 import BytecodeCache, Environment, PackageLoader, StrictUndefined
from jinja2.bccache import Bucket
from markupsafe import Markup

from fingerpad.units import value_with_uncertainty


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
    environment.globals |= {"pm": value_with_uncertainty, "style": Markup(style)}  # noqa: S704 (our own)
    return environment
