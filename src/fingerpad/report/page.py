"""Writing one page of the report, and its figures."""

import base64
import io
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, TypeAlias

import numpy as np
from PIL import Image

from fingerpad._files import explain_write_errors
from fingerpad._json import dumps
from fingerpad._rounding import two_digits
from fingerpad._words import capitalized, ended
from fingerpad.figures.compare import MOST_NAMES, colours_of
from fingerpad.flags import FLAGS, Flag
from fingerpad.report import plots, text
from fingerpad.report.layer import comparisons, layer_plots
from fingerpad.report.plot import Plot, save_plots
from fingerpad.report.repeatability import repeatability_section
from fingerpad.report.templates import templates
from fingerpad.study.measuring.curves import loading_radius
from fingerpad.study.results.methods import methods_section
from fingerpad.study.results.output import Answer, answers_of
from fingerpad.study.results.pooling import Summary, area_exponent
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.summary_file import UncertaintyCheckRecord
from fingerpad.study.results.table import record_at, records

# Saves plots, and returns what the page shows of them.
_Draw: TypeAlias = Callable[[Iterable[Plot]], list[dict[str, Any]]]

_QUANTITY_WORDS: Final = {
    "semi_major_mm": "semi-major axis",
    "semi_minor_mm": "semi-minor axis",
    "gross_area_mm2": "gross area A",
    "ridge_area_mm2": "ridge area",
}
_OVERLAY_WIDTH_PX = 560
_MOST_ANSWERS = 6
_MOST_FAILED = 200
_MOST_PRESSES = 60
# Of contacts and of sequences each: some twenty kilobytes a picture make a page that still opens.
_MOST_PICTURES = 240


def write_page(
    result: StudyResult,
    out: Path,
    name: str,
    *,
    overlays: Path,
    home: str | None = None,
    pages: Mapping[str, str] = MappingProxyType({}),
    on_drawn: Callable[[str], None] = lambda _: None,
) -> None:
    """Write a page and its figures, ``figures/*.svg, *.json``.

    `overlays` is the run's output folder, which has the overlays. The page of one finger has the address of
    that over it, `home`; that over fingers has those of theirs, `pages`, and tables all but draws none.
    """
    path, found = out / name, answers_of(result)
    draw = partial(save_plots, folder=out / "figures", on_drawn=on_drawn)
    way_out = "what was measured is kept; make room, or choose another --out, and run again to go on"
    with explain_write_errors(path, way_out):
        for folder in (out / "figures", path.parent):
            folder.mkdir(parents=True, exist_ok=True)
        said = {
            "check": [ended(words) for words in text.to_check(result, found)],
            "missing": list(_missing(result, found)),
            "better": [f"{capitalized(words)}." for words in text.to_measure_better(result)],
        }
        if not home:  # for the local page, in the same words
            curves = [text.curve_words(curve, result) for curve in result.curves]
            (out / f"{path.stem}.json").write_text(dumps({**said, "curves": curves}), encoding="utf-8")
        template = templates().get_template("report.html.jinja")
        page = template.stream(
            result=result,
            picture_of=lambda overlay: _picture(overlays / overlay),
            home=home,
            pages=pages,
            failed=result.failed_contacts,
            notes=[*result.notes, *text.sequence_notes(result)],
            odd=said["check"],
            better=said["better"],
            most_failed=_MOST_FAILED,
            corrected=list(records(result.corrected[:_MOST_FAILED])),
            corrections=len(result.corrected),
            answers=found,
            known={
                "modulus": any(math.isfinite(one.modulus) for one in found),
                "corrected": any(one.of.radius_from_indentation_count for one in found),
                "loading": any(one.of.loading_radius_mm > 0 for one in found),
            },
            most_answers=_MOST_ANSWERS,
            colours=colours_of([one.label for one in found]) if len(found) <= MOST_NAMES else {},
            without=list(text.fingers_without_results(result)),
            overview=draw(plots.answer_plots(result, found, f"{path.stem}_" if home else "")),
            by_wedge=draw(plots.wedge_plot(result)) if pages else [],
            **(_tabled(result, found) if pages else _drawn_in_full(result, found, draw)),
            curve_doubts=text.doubtful_curves(result),
            most_presses=_MOST_PRESSES,
            synthetic=bool(result.rows["synthetic"].any()),
            repeats=repeatability_section(result, with_loads=not pages),
            operators=[] if home else result.operators,
            agreement_figures=[] if home else draw(plots.agreement_plots(result)),
            quantity_words=_QUANTITY_WORDS,
            missing=said["missing"],
            first_order=result.study.uncertainty.method == "first_order",
            methods=None if home else methods_section(result),
            thick=any(finger.effective_thickness_mm is not None for finger in result.study.fingers),
        )
        page.enable_buffering()
        with path.with_suffix(".part").open("w", encoding="utf-8") as file:
            file.writelines(page)
        path.with_suffix(".part").replace(path)


def _tabled(result: StudyResult, found: Sequence[Answer]) -> dict[str, Any]:
    """Return what the page over those of the fingers shows: a line of each."""
    return {
        "groups": [_line(result, summary, one) for summary, one in zip(result.summaries, found, strict=True)],
        "curves": [{"curve": curve, "figures": []} for curve in result.curves],
        "velocities": [],
        "photographs": [],
        "sequences": [],
    }


def _drawn_in_full(result: StudyResult, found: Sequence[Answer], draw: _Draw) -> dict[str, Any]:
    """Return what a page with all figures and pictures shows."""
    on_layer = [one for one in result.summaries if one.on_layer and not one.on_layer.highest_load.layer_flag]
    return {
        "groups": [
            _line(result, summary, one)
            | {"validity": one.of.validity}
            | _details(result, summary, one.of.uncertainty_check, draw)
            | {"layer_figures": draw(layer_plots(result, summary, with_section=on_layer[:1] == [summary]))}
            for summary, one in zip(result.summaries, found, strict=True)
        ],
        "curves": [
            {"curve": curve, "figures": draw(plots.curve_plots(result, curve, number))}
            for number, curve in enumerate(result.curves, start=1)
        ],
        "velocities": draw(plots.velocity_plots(result.curves)),
        "photographs": [
            (finger.name, photograph)
            for finger in result.fingers.values()
            for photograph in finger.photographs
        ],
        "sequences": _sequences(result, draw),
    }


def _line(result: StudyResult, summary: Summary, found: Answer) -> dict[str, Any]:
    """Return what a table shows of one finger at one placement."""
    single = summary.column("frame").isna()
    return {
        "summary": summary,
        "row": record_at(summary.table, summary.places[0]),
        "answer": found,
        "contacts": int(single.sum()),
        "pooled": int((single & summary.column("pooled")).sum()),
        "doubtful": int((single & (summary.column("flags") != "")).sum()),
        "loading": loading_radius(result.curves, summary.finger_and_wedge),
    }


def _missing(result: StudyResult, found: Sequence[Answer]) -> Iterator[str]:
    """Yield what is taken as exact, assumed, or missing, and what it does to the results."""
    for one in result.study.taken_as_exact():
        yield f"Taken as exact, since the manifest gives no uncertainty: {one}."
    for one in result.study.assumed():
        yield (
            f"Assumed, since the manifest does not say: {one}. Set wedge_angle_deg_std and "
            "roll_angle_deg_std if you know better."
        )
    if shapeless := [name for name, finger in result.fingers.items() if not finger.has_semi_axes]:
        yield (
            "Missing: semi-axes or photographs, so that there are contact areas alone, no radius and no "
            f"modulus: {', '.join(shapeless)}."
        )
    shaped = [one for one in found if result.fingers[one.of.finger].has_semi_axes]
    if half_space := [one.label for one in shaped if one.of.on_layer is None]:
        yield (
            "Missing: the thickness of the tissue, so that the modulus is that of Hertz theory: "
            f"{', '.join(half_space)}."
        )
    if unloaded := [one.label for one in shaped if math.isnan(one.of.loading_radius_mm)]:
        yield (
            "Missing: fitted loading data, so that there is no loading radius R_g to compare with: "
            f"{', '.join(unloaded)}."
        )
    kinds = set(result.rows["synthetic"])
    for synthetic, repeats in result.repeatability.items():
        if synthetic in kinds and not repeats.known:
            of = " of synthetic contacts" if synthetic and len(kinds) > 1 else ""
            yield f"Missing: repeatability{of}, which another impression would change: {repeats.missing}."


def _details(
    result: StudyResult, summary: Summary, check: UncertaintyCheckRecord | None, draw: _Draw
) -> dict[str, Any]:
    """Return what a section shows of one finger at one placement."""
    contacts, shown = summary.where(summary.column("frame").isna()), plots.shown_rows(summary)
    noted = text.names_by_note(summary)
    doubtful = contacts[contacts["flags"] != ""]
    doubtful = doubtful.iloc[np.argsort(doubtful["pooled"].to_numpy(), kind="stable")]  # those left out first
    out = contacts[~contacts["pooled"]]
    overlays = contacts[contacts["overlay"].notna()]
    edge = shown["edge_offset_mm_std"].to_numpy()
    edge = edge[edge > 0]
    return {
        "shown": list(records(shown)) if len(contacts) else (),
        "check": check,
        "pooled_from": text.pooled_from(summary),
        "budget": draw(plots.budget_plot(summary, check)),
        "figures": draw(plots.summary_plots(result, summary)),
        "doubts": list(records(doubtful[: plots.MOST_POINTS])),
        "repeatability": result.repeatability[summary.synthetic].known,
        "left_out": [
            (row["observation"], text.pooling_words(row)) for row in records(out[: plots.MOST_POINTS])
        ],
        "to_do": list(text.to_do(contacts)),
        "pooled_manually": [
            (row["observation"], text.pooling_words(row))
            for row in records(contacts[contacts["pooled"] & contacts["pooling_corrected_by"].notna()])
        ],
        "edge": "–".join(dict.fromkeys(map(two_digits, (edge.min(), edge.max())))) if edge.size else "",
        "range_notes": [
            (flag, len(noted[code]), len(summary.places))
            for code, flag in FLAGS["row"].items()
            if code in noted
        ],
        "layer_lines": comparisons(result, summary),
        "layer_flag": summary.on_layer and FLAGS["layer"].get(summary.on_layer.highest_load.layer_flag),
        "pictures": len(overlays),
        "overlays": list(records(plots.thinned(overlays, _share(_MOST_PICTURES, len(result.summaries))))),
    }


def _sequences(result: StudyResult, draw: _Draw) -> list[dict[str, Any]]:
    """Return what the template shows of each sequence: never its single rows, which may be thousands."""
    doubts: dict[str, list[tuple[int, Flag]]] = {}
    for name, count, flag in text.doubtful_frames(result):
        doubts.setdefault(name, []).append((count, flag))
    drawn = plots.evenly(len(result.sequences), _MOST_PRESSES)
    pictures = _share(_MOST_PICTURES, len(result.sequences))
    return [
        {
            "sequence": sequence,
            "synthetic": bool(frames["synthetic"].any()),
            "figures": draw(plots.sequence_plots(sequence, frames)) if number in drawn else [],
            "pooled": int(frames["pooled"].sum()),
            "exponent": area_exponent(frames),
            "doubts": doubts.get(sequence.manifest.name, ()),
            "overlays": sequence.overlays[:pictures],
        }
        for number, (sequence, frames) in enumerate(zip(result.sequences, result.frames(), strict=True))
    ]


def _share(whole: int, count: int) -> int:
    """Return how many each of so many may have of a whole, at least one."""
    return max(1, whole // max(count, 1))


def _picture(overlay: Path) -> str:
    """Return an overlay, small enough to travel in the page, as a data URL."""
    with Image.open(overlay) as picture:
        picture.thumbnail((_OVERLAY_WIDTH_PX, 2 * _OVERLAY_WIDTH_PX))
        buffer = io.BytesIO()
        picture.convert("RGB").save(buffer, "JPEG", quality=85)
    return "data:image/jpeg;base64," + base64.b64encode(buffer.getvalue()).decode()
