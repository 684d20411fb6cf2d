"""Photographs of a finger's faces measured while a person corrects them, and what they say together."""

import math
import time
from collections.abc import Mapping
from typing import Any, Final, Literal

import numpy as np

from fingerpad.exceptions import FingerpadError
from fingerpad.image import (
    FACE_AXES,
    Face,
    OutlineSemiAxes,
    PhotographFit,
    combine_faces,
    face_from_outline,
    measure_photograph,
    photograph_from_ellipse,
    read_outline,
    with_points,
)
from fingerpad.study.manifest import Finger, Photograph, ScaleKey
from fingerpad.study.scales import FoundScale
from fingerpad.web.asked import Item, Spot
from fingerpad.web.bench import Bench
from fingerpad.web.open_study import OpenStudy
from fingerpad.web.operations import Operation, Question
from fingerpad.web.pictures import Cache
from fingerpad.web.refusal import Refusal
from fingerpad.web.scales import scale_of

_FITS: Final[Cache[PhotographFit]] = Cache(60, lambda _: 1)
_CURVE_POINTS: Final = 181


class Handles(Question):
    """The ends of an ellipse's semi-axes as dragged."""

    centre_px: Spot
    across_end_px: Spot
    along_end_px: Spot


class PhotographQuestion(Question):
    """Which photograph, and the correction under which it is measured."""

    item: Item
    change: dict[str, Any] | None = None
    handles: Handles | None = None
    face: Literal["palmar", "distal", "radial", "ulnar"] | None = None
    scale: ScaleKey | None = None
    with_finger: bool = False


def measure(bench: Bench, _: Any, asked: PhotographQuestion) -> dict[str, Any]:
    """Measure a photograph as it is being corrected; nothing is stored."""
    began = time.perf_counter()
    opened = bench.study
    finger, photograph = (None, None) if asked.item.startswith("file:") else opened.photograph(asked.item)
    face = asked.face or (photograph and photograph.face)
    key = asked.scale or (photograph and photograph.scale)
    if face is None or key is None:
        raise Refusal.impossible(f"{asked.item}: say its face and its scale first")
    scale = scale_of(opened, key)
    fit = _fit(opened, asked.item, face, scale, _said(photograph, asked.change or {}), asked.handles)
    together: dict[str, Any] | None = None
    error = None
    if asked.with_finger and finger is not None:
        try:
            together = _together(opened, finger, asked.item, fit)
        except FingerpadError as refused:
            error = str(refused)
    return {
        "item": asked.item,
        "by": "person"
        if asked.handles or (asked.change or {}).get("ellipse_px")
        else "program with corrections"
        if asked.change
        else "program",
        **described(fit),
        "finger": together,
        "finger_error": error,
        "milliseconds": 1000 * (time.perf_counter() - began),
    }


def described(fit: PhotographFit) -> dict[str, Any]:
    """Return a fit's numbers, and what is drawn of it."""
    centre, across, along = fit.handles
    return {
        "face": fit.face,
        "axes": list(FACE_AXES[fit.face]),
        "semi_axes_mm": fit.semi_axes_mm,
        "semi_axes_mm_std": fit.semi_axes_mm_std,
        "ellipse_px": {
            "centre": fit.centre,
            "semi_axes": fit.semi_axes / fit.scale.mm_per_px,
            "lean_deg": math.degrees(fit.lean),
        },
        "handles": {"centre_px": centre, "across_end_px": across, "along_end_px": along},
        "curve_px": fit.ellipse_points(_CURVE_POINTS).round(2),
        "points_px": fit.points.round(2),
        "outliers_px": fit.outliers.round(2),
        "arc_deg": fit.arc_deg,
        "lean_deg": math.degrees(fit.lean),
        "flags": sorted(fit.flags),
        "mm_per_px": fit.scale.mm_per_px,
        "mm_per_px_std": fit.scale.mm_per_px_std,
    }


def _said(photograph: Photograph | None, change: Mapping[str, Any]) -> dict[str, Any]:
    """Return what manifest and correction say of a photograph."""
    names = ("tip", "palmar_side", "region_of_interest_px")
    known = {name: getattr(photograph, name, None) for name in names}
    return {**known, "tip": known["tip"] or "up", **change}


def _fit(
    opened: OpenStudy,
    item: str,
    face: Face,
    scale: FoundScale,
    said: Mapping[str, Any],
    handles: Handles | None = None,
) -> PhotographFit:
    """Return the ellipse as drawn, or as found and corrected by points."""
    side: dict[str, Any] = {"tip": said["tip"], "palmar": said["palmar_side"]}
    if handles is not None:
        return _dragged(face, scale, handles, side)
    if (hand := said.get("ellipse_px")) is not None:
        return photograph_from_ellipse(
            face,
            scale.scale,
            centre=tuple(hand["centre"]),
            semi_axes=tuple(hand["semi_axes"]),
            lean=math.radians(hand.get("lean_deg", 0.0)),
            **side,
        )
    place = opened.place_of(item)
    window = said["region_of_interest_px"]
    found = _FITS.get(
        (place.stamp, face, scale.scale, repr((side, window))),
        lambda: measure_photograph(
            opened.pictures.colour(place),
            face,
            scale.scale,
            region_of_interest=None if window is None else tuple(window),
            **side,
        ),
    )
    return with_points(
        found,
        added=said.get("added_points_px") or (),
        erased=[(one["points_px"], one["radius_px"]) for one in said.get("erased") or ()],
    )


def _dragged(face: Face, scale: FoundScale, handles: Handles, side: Mapping[str, Any]) -> PhotographFit:
    """Return the ellipse of dragged handles: the two semi-axes stay square, turned as the farther is."""
    centre = np.array(handles.centre_px)
    ends = np.array([handles.across_end_px, handles.along_end_px]) - centre
    sizes = np.linalg.norm(ends, axis=1)

    def placed(lean: float) -> PhotographFit:
        return photograph_from_ellipse(
            face,
            scale.scale,
            centre=(float(centre[0]), float(centre[1])),
            semi_axes=(float(sizes[0]), float(sizes[1])),
            lean=lean,
            **side,
        )

    longer = int(np.argmax(sizes))
    upright = placed(0.0).directions
    lean = math.atan2(float(ends[longer] @ upright[1 - longer]), float(ends[longer] @ upright[longer]))
    return placed(lean if longer == 0 else -lean)


def _together(opened: OpenStudy, finger: Finger, item: str, fit: PhotographFit) -> dict[str, Any]:
    """Return the finger's semi-axes with one face as it is being corrected."""
    faces = []
    items = []
    for one in finger.photographs:
        own = f"{finger.name}/{one.image or one.outline}"
        items.append(own)
        if own == item:
            faces.append(fit.face_semi_axes)
        elif one.outline is not None:
            points = read_outline(opened.folder / one.outline)
            faces.append(face_from_outline(one.face, points, one.outline_relative_std))
        else:
            assert one.scale is not None  # the manifest's own rule
            faces.append(
                _fit(opened, own, one.face, scale_of(opened, one.scale), _said(one, {})).face_semi_axes
            )
    return _joint(combine_faces(faces), items)


def _joint(found: OutlineSemiAxes, items: list[str]) -> dict[str, Any]:
    axes = ("palmar", "distal", "radial_ulnar")
    return {
        "semi_axes_mm": {name: getattr(found, name) for name in axes},
        "semi_axes_mm_std": dict(zip(axes, found.stds, strict=True)),
        "chi_square": found.chi_square,
        "degrees_of_freedom": found.degrees_of_freedom,
        "p_value": found.p_value,
        "disagreements": [
            {"item": item, "face": face.face, **off}
            for item, face, off in zip(items, found.faces, found.disagreements, strict=True)
        ],
    }


OPERATIONS: Final = (
    Operation(
        method="POST",
        path="/api/measure/photograph",
        answer=measure,
        summary="Measure a photograph under a correction, without storing it",
        body=PhotographQuestion,
    ),
)
