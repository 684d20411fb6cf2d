"""Writing the report and its figures."""

import base64
import io
from collections.abc import Iterable
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from PIL import Image

from fingerpad.exceptions import FingerpadError
from fingerpad.figures import save_figure
from fingerpad.image import PHOTOGRAPH_FLAGS
from fingerpad.loading import Quantity, Unknown
from fingerpad.report.plot import Plot
from fingerpad.report.plots import (
    budget_plot,
    curve_plots,
    loading_radius_of,
    press_plot,
    summary_plots,
    velocity_plots,
)
from fingerpad.report.text import FLAG_WORDS, doubtful_frames, in_words
from fingerpad.study.pipeline import StudyResult
from fingerpad.study.rows import RANGE_NOTES
from fingerpad.study.sequences import SequenceResult
from fingerpad.study.summary import Summary, area_exponent
from fingerpad.units import two_digits, value_with_uncertainty

_OVERLAY_WIDTH_PX = 560


def write_report(result: StudyResult, out: Path) -> Path:
    """Write ``report.html`` and ``figures/*.svg, *.png`` into `out`, and return the report's path.

    Raises
    ------
    FingerpadError
        If a file cannot be written.
    """
    environment = Environment(
        loader=PackageLoader("fingerpad.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
    )
    environment.filters |= {
        "flags": lambda codes: in_words(codes, FLAG_WORDS),
        "photograph_flags": lambda codes: in_words(codes, {**FLAG_WORDS, **PHOTOGRAPH_FLAGS}),
    }
    environment.globals |= {
        "pm": value_with_uncertainty,
        "two": two_digits,
        "exponent": area_exponent,
        "quantity": _quantity,
    }
    try:
        (out / "figures").mkdir(parents=True, exist_ok=True)
        page = environment.get_template("report.html.jinja").render(
            result=result,
            style=Markup(files("fingerpad.report").joinpath("report.css").read_text(encoding="utf-8")),  # noqa: S704
            groups=[_group(result, summary, out) for summary in result.summaries],
            curves=[
                {"curve": curve, "figures": _drawn(curve_plots(curve, number), out)}
                for number, curve in enumerate(result.curves, start=1)
            ],
            velocities=_drawn(velocity_plots(result.curves), out),
            photographs=[
                (finger.name, photograph, _picture(photograph.overlay, out))
                for finger in result.fingers.values()
                for photograph in finger.photographs
            ],
            sequences=[_sequence(result, film, out) for film in result.sequences],
            synthetic=any(row["synthetic"] for row in result.rows),
            certain=bool(result.study.uncertainty.model_fields_set),
        )
        path = out / "report.html"
        path.write_text(page, encoding="utf-8")
    except OSError as error:
        raise FingerpadError(f"{error.filename}: cannot be written ({error.strerror})") from error
    return path


def _group(result: StudyResult, summary: Summary, out: Path) -> dict[str, Any]:
    """Return what the template shows of one finger at one placement."""
    codes = [code for row in summary.rows for code in row["range_notes"].split()]
    return {
        "summary": summary,
        "loading": loading_radius_of(result, summary),
        "check": result.checks[result.summaries.index(summary)],
        "budget": _drawn(budget_plot(result, summary), out),
        "figures": _drawn(summary_plots(result, summary), out),
        "doubtful": [row for row in summary.contacts if row["flags"]],
        "largest_size": max(row["contact_size"] for row in summary.rows),
        "deepest": max((row["indentation_over_thickness"] or 0.0) for row in summary.rows),
        "range_notes": [
            (RANGE_NOTES[code], codes.count(code), len(summary.rows)) for code in RANGE_NOTES if code in codes
        ],
        "overlays": [(row, _picture(row["overlay"], out)) for row in summary.contacts if row["overlay"]],
    }


def _quantity(found: Quantity, factor: float = 1.0) -> Markup:
    """Return a quantity from loading data as a cell, or a dash that tells the reason."""
    if isinstance(found, Unknown):
        return Markup('<span title="{}">–</span>').format(found.reason)
    return Markup("{}").format(value_with_uncertainty(factor * found.value, factor * found.std))


def _sequence(result: StudyResult, film: SequenceResult, out: Path) -> dict[str, Any]:
    """Return what the template shows of one sequence: never its single rows, which may be thousands."""
    frames = [row for row in result.rows if row["sequence"] == film.manifest.name]
    return {
        "film": film,
        "synthetic": any(row["synthetic"] for row in frames),
        "figures": _drawn(press_plot(result, film), out),
        "pooled": sum(row["pooled"] for row in frames),
        "exponent": area_exponent(frames),
        "doubts": [entry[1:] for entry in doubtful_frames(result) if entry[0] == film.manifest.name],
        "overlays": [(overlay, _picture(overlay.file, out)) for overlay in film.overlays],
    }


def _drawn(plots: Iterable[Plot], out: Path) -> list[dict[str, str]]:
    """Save each plot as files, and return it as SVG for the page."""
    drawn = []
    for plot in plots:
        file, _ = save_figure(plot.figure, out / "figures" / plot.name, description=plot.caption)
        _, _, drawing = file.read_text(encoding="utf-8").partition("\n")  # without the XML declaration
        drawn.append({"svg": Markup(drawing), "caption": plot.caption})  # noqa: S704 (drawn here)
    return drawn


def _picture(overlay: str, out: Path) -> str:
    """Return an overlay, small enough to travel in the page, as a data URL."""
    with Image.open(out / overlay) as picture:
        picture.thumbnail((_OVERLAY_WIDTH_PX, 2 * _OVERLAY_WIDTH_PX))
        buffer = io.BytesIO()
        picture.convert("RGB").save(buffer, "JPEG", quality=85)
    return "data:image/jpeg;base64," + base64.b64encode(buffer.getvalue()).decode()
