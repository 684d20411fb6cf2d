"""The methods section of a study in words, what is missing in it, and where results come from."""

import platform
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from datetime import UTC, datetime
from functools import cache
from typing import Any, Final

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined, Template

import fingerpad
from fingerpad._arrays import FloatArray
from fingerpad._csv import package_table
from fingerpad._rounding import two_digits, value_with_uncertainty
from fingerpad._words import counted, joined
from fingerpad.image import FACE_AXES
from fingerpad.study.engine.task import MEASUREMENT_VERSIONS, library_versions
from fingerpad.study.manifest.models import is_exact
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.summary_file import MethodsRecord

FORMULAS: Final = {
    line["result"]: line["formula"] for line in package_table("fingerpad.study.results", "formulas.csv")
}


def provenance(files: Iterable[str], digest: Callable[[str], str]) -> dict[str, Any]:
    """Return what is needed to repeat a run: versions, SHA-256 of every input by `digest`, formulas."""
    return {
        "fingerpad": fingerpad.__version__,
        "python": platform.python_version(),
        "libraries": library_versions(),
        "measurement_versions": dict(MEASUREMENT_VERSIONS),
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "inputs_sha256": {name: digest(name) for name in sorted(set(files))},
        "formulas": FORMULAS,
    }


_MOST_LISTED: Final = 4


def methods_section(result: StudyResult) -> MethodsRecord:
    """Describe how the numbers of a study came about, as a paper does."""
    template = _template()
    context = template.new_context(_template_values(result))
    texts = (" ".join("".join(block(context)).split()) for block in template.blocks.values())
    return MethodsRecord(paragraphs=list(filter(None, texts)), missing=list(_missing(result)))


@cache
def _template() -> Template:
    environment = Environment(
        loader=PackageLoader("fingerpad.study.results", "."),
        undefined=StrictUndefined,
        autoescape=False,  # noqa: S701 (plain text)
    )
    environment.filters |= {
        "counted": counted,
        "doubt": _doubt,
        "joined": joined,
        "listed": _listed,
        "named": _named,
    }
    return environment.get_template("methods.txt.jinja")


def _template_values(result: StudyResult) -> dict[str, Any]:
    """Return what the template says of a study."""
    study, rows = result.study, result.rows
    placed = [*study.observations, *study.sequences]
    fingers = [finger for finger in result.fingers.values() if finger.has_semi_axes]
    ways: dict[str, list[str]] = {}
    for finger in fingers:
        ways.setdefault(_semi_axes_from(finger), []).append(finger.name)
    # Not contacts: one may be given for each of two ways to measure its finger.
    counts = {"observation": len(study.observations), "sequence": len(study.sequences)}
    scales = [_scale(result, name) for name in result.scales]
    more = [f"{len(scales) - _MOST_LISTED} more"] if len(scales) > _MOST_LISTED else []
    reviewed, edge_stds = result.corrected, rows["edge_offset_mm_std"].to_numpy()
    single = (rows["status"] == "measured") & rows["frame"].isna()
    thick = [one for one in study.fingers if one.effective_thickness_mm is not None]
    stated = [(one.name, one.effective_thickness_mm, one.effective_thickness_mm_std) for one in thick]
    return {
        "result": result,
        "of": study.apparatus,
        "given": study.uncertainty,
        "areas_alone": [finger.name for finger in result.fingers.values() if not finger.has_semi_axes],
        "modelled": fingers,
        "persons": len({finger.manifest.person for finger in fingers} - {None}),
        "semi_axes_from": [
            way if len(ways) == 1 else f"{way} for {_named(names)}" for way, names in ways.items()
        ],
        "rendered": [finger.name for finger in fingers if finger.synthetic],
        "placed": placed,
        "wedges": {one.wedge_angle_deg for one in placed},
        "rolls": {one.roll_angle_deg for one in placed},
        "loads": _range(rows["load_N"].to_numpy()),
        "counts": [counted(count, noun) for noun, count in counts.items() if count],
        "velocity": _velocity(result),
        "has_images": _has_images(result),
        "scales": [*scales[:_MOST_LISTED], *more],
        "edge": _range(edge_stds[edge_stds > 0], two_digits),
        "verdicts": [f"{count} {verdict}" for verdict, count in Counter(reviewed["reviewed"]).items()],
        "people": sorted(set(reviewed["reviewed_by"]) - {None}),
        "left_out": int((single & ~rows["pooled"]).sum()),
        "single": int(single.sum()),
        "thicknesses": [f"{value_with_uncertainty(t, std)} mm ({name})" for name, t, std in stated],
        "fitted": sum(curve.fit is not None for curve in result.curves),
        "assumed": study.assumed(),
        "exact": list(study.taken_as_exact()),
        "versions": [f"{name} {of}" for name, of in result.provenance["measurement_versions"].items()],
    }


def _named(fingers: list[str]) -> str:
    """Name fingers, since one may stand under two names, measured in two ways; count many."""
    return joined(fingers) if len(fingers) <= _MOST_LISTED else counted(len(fingers), "finger")


def _semi_axes_from(finger: FingerResult) -> str:
    photographs = finger.manifest.photographs
    if not photographs:
        return "given"
    seen = [face for face in FACE_AXES if any(one.face == face for one in photographs)]
    kind = "photographs" if any(one.file for one in photographs) else "outlines"
    return f"fitted to {kind} of the {joined(seen)} faces"


def _velocity(result: StudyResult) -> str:
    if stated := result.study.apparatus.approach_mm_per_s:
        return f"at {stated:g} mm/s"
    found = _range(np.array([curve.velocity for curve in result.curves]))
    return f"at {found} mm/s in the loading curves" if found else ""


def _has_images(result: StudyResult) -> bool:
    return bool(result.study.sequences) or any(one.file for one in result.study.observations)


def _missing(result: StudyResult) -> Iterator[str]:
    study, of = result.study, result.study.apparatus
    images, models = _has_images(result), study.has_models
    thickness = any(finger.effective_thickness_mm for finger in study.fingers)
    kinds = set(result.rows["synthetic"].tolist())
    repeated = all(result.repeatability[kind].known for kind in kinds)
    asked = (
        (True, repeated, "repeats, which tell by how much a second impression would differ"),
        (images, of.imaging, "the device that took the contact images (apparatus.imaging)"),
        (images, of.scale_calibration, "how the scales were calibrated (apparatus.scale_calibration)"),
        (True, of.platen, "what the finger was pressed against (apparatus.platen)"),
        (True, of.force_sensor, "the force sensor (apparatus.force_sensor)"),
        (True, of.stage, "what moved finger or platen (apparatus.stage)"),
        (True, _velocity(result), "the velocity of approach (apparatus.approach_mm_per_s)"),
        (bool(study.observations), of.dwell_s, "how long contacts were held (apparatus.dwell_s)"),
        (models, of.poisson_ratio_basis, "the basis of Poisson's ratio (apparatus.poisson_ratio_basis)"),
        (models, thickness, "the thickness of the tissue over bone (effective_thickness_mm of the fingers)"),
        (thickness, of.thickness_basis, "the basis of the effective thickness (apparatus.thickness_basis)"),
    )
    return (words for needed, stated, words in asked if needed and not stated)


def _scale(result: StudyResult, name: str) -> str:
    found, table = result.scales[name], result.study.scales[name]
    if isinstance(found, str):
        return f"{name}, not found"
    if is_exact(table):
        return f"{name}, {found.scale.mm_per_px:.4g} mm/px, taken as exact"
    return f"{name}, {value_with_uncertainty(found.scale.mm_per_px, found.scale.mm_per_px_std)} mm/px"


def _doubt(std: float, unit: str = "") -> str:
    return f"± {std:.2g}{unit}" if std else "taken as exact"


def _listed(values: Iterable[float]) -> str:
    found = sorted(set(values))
    if len(found) > _MOST_LISTED:
        return f"{found[0]:g} to {found[-1]:g}"
    return joined([f"{value:g}" for value in found])


def _range(values: FloatArray, written: Callable[[float], str] = "{:.2g}".format) -> str:
    """Return the least and the largest value that are known, empty where none is."""
    if not np.isfinite(values).any():
        return ""
    return " to ".join(dict.fromkeys(map(written, (np.nanmin(values), np.nanmax(values)))))
