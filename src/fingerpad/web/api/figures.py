"""Figures of the last report: their list, and each as a file for publication."""

import re
from html import unescape
from pathlib import Path
from typing import Annotated, Final, Literal

from fastapi import Response
from pydantic import Field

from fingerpad._files import file_stem
from fingerpad.figures.marks import Figure
from fingerpad.figures.publish import FigureSettings, Format, Scale, figure_colours, figure_file, plain_text
from fingerpad.study.results.result_set import RERUN, result_files
from fingerpad.web.answers import Answer
from fingerpad.web.api.base import MEDIA_TYPES, Opened, Params, Query, router, saved_as
from fingerpad.web.api.results import require_results
from fingerpad.web.errors import RequestError
from fingerpad.web.last_results import require_file
from fingerpad.web.study_session import StudySession

_CAPTION: Final = re.compile(r'aria-label="([^"]*)"')
# Settings of a figure that a request states as they are.
_AS_THEY_ARE: Final = ("width_mm", "height_mm", "font_pt", "x_scale", "y_scale", "dpi")


class FigureEntry(Answer):
    """A figure of the report, and the addresses of its files."""

    name: str
    caption: str
    svg: str
    png: str | None
    settable: bool


class FigureAxis(Answer):
    """An axis of a figure; it can be set where all panels show one quantity on it."""

    axis: Literal["x", "y"]
    name: str
    scale: Literal["linear", "log"]
    settable: bool


class FigureDetails(Answer):
    """What can be set of a figure, as it is in the report."""

    name: str
    width_mm: float
    height_mm: float
    colours: list[str]
    axes: list[FigureAxis]


class FigureParams(Params):
    """A figure, by its name."""

    name: Annotated[str, Field(min_length=1, max_length=300)]


class FigureFileParams(FigureParams):
    """A figure, the format of its file, and how to draw it; what is left out stays as in the report."""

    kind: Format
    width_mm: float | None = None
    height_mm: float | None = None
    font_pt: float | None = None
    x_low: float | None = None
    x_high: float | None = None
    y_low: float | None = None
    y_high: float | None = None
    x_scale: Scale | None = None
    y_scale: Scale | None = None
    colours: Annotated[str, Field(max_length=500, description="Separated by commas.")] = ""
    dpi: float = 300.0
    attachment: bool = False


@router.get("/results/figures")
def figures(opened: Opened) -> list[FigureEntry]:
    """Return the report's figures with their captions."""
    require_results(opened)
    names = result_files(opened.out)
    files = set(names)

    def entry(drawing: str) -> FigureEntry:
        name = Path(drawing).stem
        png = f"figures/{name}.png"
        return FigureEntry(
            name=name,
            caption=_caption(opened.out / drawing) or name,
            svg=opened.address(f"/download/{drawing}"),
            png=opened.address(f"/download/{png}") if png in files else None,
            settable=f"figures/{name}.json" in files,
        )

    return [entry(one) for one in names if one.startswith("figures/") and one.endswith(".svg")]


def _caption(drawing: Path) -> str:
    with drawing.open(encoding="utf-8") as file:
        found = _CAPTION.search(file.read(4000))
    return unescape(found[1]) if found else ""


@router.get("/results/figure")
def figure(opened: Opened, params: Query[FigureParams]) -> FigureDetails:
    """Return what can be set of a figure, as it is in the report."""
    found = _read(opened, params.name)
    return FigureDetails.of(
        found, name=params.name, colours=figure_colours(found), axes=[_axis(found, axis) for axis in "xy"]
    )


def _axis(found: Figure, axis: str) -> FigureAxis:
    first, *others = (getattr(panel, axis) for panel in found.panels)
    return FigureAxis.of(
        axis=axis,
        name=plain_text(first.label),
        scale="log" if first.log else "linear",
        settable=all(one.label == first.label for one in others),
    )


@router.get("/results/figure/file", response_class=Response)
def figure_download(opened: Opened, params: Query[FigureFileParams]) -> Response:
    """Return a figure as a file."""
    settings = FigureSettings(
        x_range=(params.x_low, params.x_high),
        y_range=(params.y_low, params.y_high),
        colours=tuple(filter(None, params.colours.split(","))),
        **{name: getattr(params, name) for name in _AS_THEY_ARE},
    )
    content = figure_file(_read(opened, params.name), params.kind, settings)
    headers = {"cache-control": "private, no-cache"}
    if params.attachment:
        headers |= saved_as(f"{file_stem(params.name)}.{params.kind}")
    return Response(content, media_type=MEDIA_TYPES[f".{params.kind}"], headers=headers)


def _read(opened: StudySession, name: str) -> Figure:
    """Return a figure of the results as data."""
    require_results(opened)
    file = f"figures/{name}.json"
    if file not in result_files(opened.out):
        raise RequestError.not_there(f"{name[:80]!r}: no figure of the last run that can be set")
    require_file(opened, file)
    try:
        return Figure.of_json((opened.out / file).read_text(encoding="utf-8"))
    except ValueError as error:
        raise RequestError.conflict(f"{file}: is damaged: {RERUN}") from error
