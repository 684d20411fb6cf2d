"""Photographs of a finger's faces, measured under corrections, and their combination."""

import math
from contextlib import suppress
from functools import lru_cache
from typing import Final, Literal, TypeAlias, get_args

import numpy as np

from fingerpad._rounding import value_with_uncertainty
from fingerpad.exceptions import FingerpadError
from fingerpad.image import (
    FACE_AXES,
    Face,
    FaceSemiAxes,
    PhotographFit,
    combine_faces,
    photograph_from_handles,
    with_marked_points,
)
from fingerpad.report.text import p_words
from fingerpad.study.corrections.apply import corrected_photograph, photograph_correction
from fingerpad.study.corrections.changes import ManualFaceEllipse, PhotographCorrection
from fingerpad.study.corrections.log import is_rejected
from fingerpad.study.manifest.models import Finger, Photograph, ScaleKey, validated
from fingerpad.study.measuring.fingers import (
    FingerResult,
    face_in_scale,
    finger_from_faces,
    outline_face,
    outline_radii,
    photograph_item,
)
from fingerpad.web.answers import Answer, Axis, Point, Quantity, RequestError, quantities, semi_axes
from fingerpad.web.api.base import Body, Item, Opened, Params, PointParam, router
from fingerpad.web.api.scales import scale_of
from fingerpad.web.pictures import Cache
from fingerpad.web.study_session import StudySession

_FITS: Final[Cache[PhotographFit | FingerpadError]] = Cache(120)
_outline_radii: Final = lru_cache(maxsize=120)(outline_radii)  # once for each fit that is kept
# A manual ellipse needs none.
_NO_PICTURE: Final = np.zeros((1, 1), dtype=np.uint8)
_Radius: TypeAlias = Literal["wedge_angle_deg", "outline_mm", "ellipse_mm"]


class CombinedFaces(Answer):
    """The semi-axes that all faces of a finger give, and by how much those of each exceed them, relative."""

    semi_axes_mm: dict[Axis, Quantity]
    chi_square: float
    degrees_of_freedom: int
    p_words: str
    disagree: bool
    disagreements: list[tuple[Face, dict[Axis, float | None]]]


class PhotographMeasurement(Answer):
    """A photograph measured under a correction; the terms of its uncertainty in words.

    `handles_px` are the centre and the ends of the semi-axes across and along, `radii` those of a side face
    where a wedge touches, of the outline itself and of the ellipse.
    """

    by: Literal["automatic", "corrected", "manual"]
    semi_axes_mm: dict[Axis, Quantity]
    ellipse_px: ManualFaceEllipse
    handles_px: tuple[Point, Point, Point]
    points_px: list[Point]
    outliers_px: list[Point]
    uncertainty_words: dict[Axis, str]
    arc_deg: Quantity
    exponent: Quantity
    radii: list[dict[_Radius, Quantity]]
    tilt_deg: Quantity
    flags: list[str]
    mm_per_px: float
    automatic: dict[Axis, Quantity] | None
    finger: CombinedFaces | None
    finger_error: str | None


class PhotographParams(Params):
    """A photograph, and the correction under which it is measured."""

    item: Item
    change: PhotographCorrection | None = None
    handles_px: tuple[PointParam, PointParam, PointParam] | None = None
    face: Face | None = None
    scale: ScaleKey | None = None
    with_finger: bool = False


@router.post("/measure/photograph")
def measure(opened: Opened, params: Body[PhotographParams]) -> PhotographMeasurement:
    """Measure a photograph under a correction; nothing is stored."""
    finger, photograph = _table(opened, params)
    change = params.change or _stored(opened, params.item)
    fit = _fit(opened, params.item, photograph, change, params.handles_px)
    together, error = None, None
    if params.with_finger and finger is not None:
        try:
            together = _together(opened, finger, params.item, fit)
        except FingerpadError as fault:
            error = str(fault)
    elif params.with_finger and not params.item.startswith("file:"):
        error = "The other faces of this finger are not complete yet."
    manual = params.handles_px is not None or change.ellipse_px is not None
    edited = manual or bool(change.edits)
    automatic = None
    if edited:
        with suppress(FingerpadError):
            automatic = _axes(_fit(opened, params.item, photograph, PhotographCorrection()))
    size = fit.scale.mm_per_px
    tilt = (math.degrees(fit.tilt) + 90) % 180 - 90  # by half a turn more it is the same ellipse
    ellipse = {"centre": list(fit.centre), "semi_axes": (fit.semi_axes / size).tolist(), "tilt_deg": tilt}
    return PhotographMeasurement.of(
        fit,
        by="manual" if manual else "corrected" if edited else "automatic",
        ellipse_px=validated(ManualFaceEllipse, ellipse, params.item, strict=False),
        handles_px=fit.handles,
        points_px=fit.points.round(2),
        outliers_px=fit.outliers.round(2),
        uncertainty_words={axis: _terms(fit, axis) for axis in FACE_AXES[fit.face]},
        semi_axes_mm=_axes(fit),
        radii=[quantities(one.get, get_args(_Radius)) for one in fit.side_radii()],
        tilt_deg=tilt,
        flags=sorted(fit.flags),
        mm_per_px=size,
        automatic=automatic,
        finger=together,
        finger_error=error,
    )


def _table(opened: StudySession, params: PhotographParams) -> tuple[Finger | None, Photograph]:
    """Return the table of a photograph, with the face and scale requested, and its finger."""
    if not params.item.startswith("file:"):
        finger, photograph = opened.photograph(params.item)
        stated = {"face": params.face, "scale": params.scale}
        return finger, photograph.model_copy(update={k: v for k, v in stated.items() if v is not None})
    if params.face is None or params.scale is None:
        raise RequestError.impossible(f"{params.item}: state its face and its scale")
    return None, Photograph(face=params.face, file=params.item.removeprefix("file:"), scale=params.scale)


def _axes(fit: PhotographFit) -> dict[Axis, Quantity]:
    known = fit.semi_axes_mm | {f"{axis}_std": std for axis, std in fit.semi_axes_mm_std.items()}
    return quantities(known.get, FACE_AXES[fit.face], "mm")


def _terms(fit: PhotographFit, axis: str) -> str:
    """Return the terms of a semi-axis' uncertainty, largest first."""
    stds = {term: by_axis[axis] for term, by_axis in fit.uncertainty_mm_std.items() if by_axis[axis] > 0}
    ordered = sorted(stds, key=lambda term: -stds[term])
    return ", ".join(f"{term} {value_with_uncertainty(stds[term])} mm" for term in ordered)


def _fit(
    opened: StudySession,
    item: str,
    photograph: Photograph,
    change: PhotographCorrection,
    handles: tuple[PointParam, PointParam, PointParam] | None = None,
) -> PhotographFit:
    """Return the manual ellipse, or the fitted one; outlines that were found are cached."""
    assert photograph.scale is not None  # the manifest's own rule
    scale = scale_of(opened, photograph.scale).scale
    if handles is not None:
        return photograph_from_handles(
            photograph.face,
            scale,
            centre=handles[0],
            across_end=handles[1],
            along_end=handles[2],
            tip=change.tip or photograph.tip,
            palmar=change.palmar_side or photograph.palmar_side,
        )
    if change.ellipse_px is not None:
        return corrected_photograph(_NO_PICTURE, photograph, scale, change)
    place = opened.image_location(item)
    before = change.model_copy(update={"added_points_px": [], "erased": []})

    def find() -> PhotographFit | FingerpadError:
        try:
            return corrected_photograph(opened.pictures.pixels(place), photograph, scale, before)
        except FingerpadError as error:
            return error

    key = place.stamp, scale, photograph.model_dump_json(), before.model_dump_json()
    if isinstance(found := _FITS.get(key, find), FingerpadError):
        raise found
    erased = [(stroke.points_px, stroke.radius_px) for stroke in change.erased]
    return with_marked_points(found, added=change.added_points_px, erased=erased)


def measured_finger(opened: StudySession, name: str) -> FingerResult | None:
    """Return a finger's semi-axes as entered or of the last run, or else as its photographs give them now.

    None where it has neither; raises `FingerpadError` where its photographs cannot be measured.
    """
    found, finger = opened.known_finger(name), opened.finger(name)
    if found is not None or finger is None:
        return found
    faces = _faces(opened, finger)
    sides = (
        _outline_radii(_fit(opened, item, one, _stored(opened, item)))
        for one in finger.photographs
        if one.outline is None and (item := photograph_item(finger, one)) in faces
    )
    return finger_from_faces(finger, combine_faces(faces.values()), sides)


def _together(opened: StudySession, finger: Finger, item: str, fit: PhotographFit) -> CombinedFaces:
    """Return the finger's semi-axes with the current fit of one face."""
    faces = _faces(opened, finger, item, fit)
    found = combine_faces(faces.values())
    return CombinedFaces.of(
        found,
        semi_axes_mm=semi_axes(found.semi_axes, found.stds),
        p_words=p_words(found.p_value),
        disagreements=list(zip((one.face for one in found.faces), found.disagreements, strict=True)),
    )


def _faces(
    opened: StudySession, finger: Finger, item: str = "", fit: PhotographFit | None = None
) -> dict[str, FaceSemiAxes]:
    """Return the faces of a finger by their items, one of them with its current fit."""
    faces = {}
    for one in finger.photographs:
        own = photograph_item(finger, one)
        scale = one.scale if isinstance(one.scale, str) else None
        if fit is not None and own == item:
            faces[own] = face_in_scale(fit.face_semi_axes, scale)
        elif is_rejected(opened.corrections.active_correction(own)):
            continue
        elif one.outline is not None:
            known = None if one.scale is None else scale_of(opened, one.scale)
            faces[own] = outline_face(one, known, opened.folder)
        else:
            found = _fit(opened, own, one, _stored(opened, own))
            faces[own] = face_in_scale(found.face_semi_axes, scale)
    return faces


def _stored(opened: StudySession, item: str) -> PhotographCorrection:
    return photograph_correction(opened.corrections.active_correction(item))
