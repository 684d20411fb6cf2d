"""The fingers of a study: semi-axes as given, or measured in photographs of the faces or their outlines."""

import hashlib
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Any, Final

import numpy as np

from fingerpad import image
from fingerpad._arrays import ArrayLike, FloatArray
from fingerpad._files import file_stem, make_folder
from fingerpad._records import fields_from, from_record
from fingerpad.exceptions import FingerpadError, StoreError
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.study.corrections.apply import corrected_photograph, photograph_correction
from fingerpad.study.corrections.changes import PhotographCorrection
from fingerpad.study.engine.task import Work, in_study
from fingerpad.study.manifest.models import Finger, Photograph
from fingerpad.study.measuring.context import FoundScale, OneTaskItem, RunContext, require_scale

# Relative standard deviation of a finger's radius of curvature at one place from that of the ellipsoid that
# follows its outlines; more where the outline hides that place. See benchmarks/claims/photograph_errors.py.
ELLIPSOID_STD: Final = 0.1
HIDDEN_STD: Final = 0.2


def radius_deviation(
    ellipsoid: float, ellipsoid_std: float, outline: float, outline_std: float
) -> tuple[float, float]:
    """Return how far a radius of curvature lies from the ellipsoid's, by the outline, and how far it may.

    The outline shows the radius at the place itself, and the ellipsoid knows it only as far as fingers are
    ellipsoids, to 10 %, or to what the two differ by beyond the outline's uncertainty. Both are averaged as
    logarithms with weights of their inverse variances. NaN is the radius of an outline that hides the place.
    """
    if not math.isfinite(outline):
        return 0.0, HIDDEN_STD
    own, seen = (ellipsoid_std / ellipsoid) ** 2, (outline_std / outline) ** 2
    apart = math.log(outline / ellipsoid)
    model = max(own + ELLIPSOID_STD**2, apart**2 - seen)
    return apart * model / (model + seen), math.sqrt(max(model * seen / (model + seen) - own, 0.0))


def pad_placement(
    semi_axes: Iterable[ArrayLike], wedge_deg: ArrayLike, roll_deg: ArrayLike = 0.0
) -> Placement:
    """Return the ellipsoid of some semi-axes on its wedge."""
    wedge, roll = np.radians(wedge_deg), np.radians(roll_deg)
    return Placement(Ellipsoid(*semi_axes), wedge_angle=wedge, roll_angle=roll)


# Wedge angles between which an outline's radius of curvature is interpolated.
_WEDGE_STEP_DEG: Final = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class PhotographResult:
    """What was seen in one photograph."""

    manifest: Photograph
    scale: FoundScale
    overlay: str  # relative to the output folder
    uncertainty: Mapping[str, Mapping[str, float]]  # of each semi-axis by term of the covariance, mm
    arc_deg: float  # parametric
    exponent: tuple[float, float] | None  # of the superellipse that follows the pad best, and its std
    # Of a side face: wedge angle, degrees, radius of curvature there and its standard uncertainty, mm.
    outline_radii: tuple[tuple[float, float, float], ...]
    flags: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FingerResult:
    """A finger's semi-axes with their covariance."""

    manifest: Finger  # what the manifest says of it
    source: str  # `given`, `photographs` or `none`
    # Palmar, distal, radial–ulnar, mm; NaN where they could not be had.
    semi_axes: FloatArray = field(default_factory=lambda: np.full(3, np.nan))
    covariance: FloatArray = field(default_factory=lambda: np.full((3, 3), np.nan))
    outlines: image.PadSemiAxes | None = None
    photographs: tuple[PhotographResult, ...] = ()
    outline_radii: tuple[tuple[tuple[float, float, float], ...], ...] = ()
    scale: str | None = None  # shared by all its photographs
    reason: str | None = None

    @property
    def name(self) -> str:
        """Its name."""
        return self.manifest.name

    @property
    def synthetic(self) -> bool:
        """Whether anything of it was rendered or simulated."""
        return self.manifest.synthetic or any(one.synthetic for one in self.manifest.photographs)

    @property
    def has_semi_axes(self) -> bool:
        """Whether semi-axes are known, without which there are contact areas alone."""
        return bool(np.isfinite(self.semi_axes).all())

    def outline_radius(self, wedge_deg: float) -> tuple[float, float]:
        """Return the radius along the finger by the outlines of side faces, and its std, mm; NaN without."""
        found = np.array([_interpolated(radii, wedge_deg) for radii in self.outline_radii]).reshape(-1, 2)
        found = found[np.isfinite(found).all(axis=1)]
        if not len(found):
            return np.nan, np.nan
        relative = (found[:, 0] / found[:, 1]) ** 2
        radius = float(np.exp(relative @ np.log(found[:, 0]) / relative.sum()))
        return radius, radius / float(np.sqrt(relative.sum()))

    def shape_deviation(self, wedge_deg: float, roll_deg: float) -> tuple[float, float, float]:
        """Return how far ln of the radius along lies from the ellipsoid's, its std, and that across."""
        if self.source == "given":
            return 0.0, 0.0, 0.0
        if roll_deg != 0 or not self.outline_radii:
            return 0.0, ELLIPSOID_STD, ELLIPSOID_STD
        ellipsoid, std = self._in_plane_radius(wedge_deg), self.in_plane_radius_std(wedge_deg)
        return *radius_deviation(ellipsoid, std, *self.outline_radius(wedge_deg)), ELLIPSOID_STD

    def _in_plane_radius(self, wedge_deg: float) -> float:
        angle, axes = np.radians(wedge_deg), self.semi_axes[:2]
        return float(axes.prod() ** 2 / np.linalg.norm(axes * [np.cos(angle), np.sin(angle)]) ** 3)

    def in_plane_radius_std(self, wedge_deg: float) -> float:
        """Return the standard uncertainty of the ellipsoid's radius along the finger there, mm."""
        angle, axes = np.radians(wedge_deg), self.semi_axes[:2]
        shares = np.square(axes * [np.cos(angle), np.sin(angle)])
        slope = self._in_plane_radius(wedge_deg) * (2 - 3 * shares / shares.sum()) / axes
        return float(np.sqrt(slope @ self.covariance[:2, :2] @ slope))


def _interpolated(radii: Sequence[tuple[float, float, float]], wedge_deg: float) -> tuple[float, float]:
    """Return radius and uncertainty between the nearest angles on either side, NaN where one is missing."""
    known = {angle: (radius, std) for angle, radius, std in radii}
    low = _WEDGE_STEP_DEG * math.floor(wedge_deg / _WEDGE_STEP_DEG)
    high = low if low == wedge_deg else low + _WEDGE_STEP_DEG
    if low not in known or high not in known:
        return math.nan, math.nan
    share = (wedge_deg - low) / _WEDGE_STEP_DEG
    radius, std = (
        math.exp((1 - share) * math.log(first) + share * math.log(second))
        for first, second in zip(known[low], known[high], strict=True)
    )
    return radius, std


def given_pad(finger: Finger) -> FingerResult:
    """Return the semi-axes that the manifest states of a finger."""
    given, std = finger.semi_axes_mm, finger.semi_axes_mm_std
    assert given is not None
    assert std is not None  # the manifest's own rule
    return FingerResult(
        manifest=finger,
        semi_axes=np.array([given.palmar, given.distal, given.radial_ulnar]),
        covariance=np.diag(np.square([std.palmar, std.distal, std.radial_ulnar])),
        source="given",
    )


def finger_from_faces(
    finger: Finger, joint: image.PadSemiAxes, outline_radii: Iterable[tuple[tuple[float, float, float], ...]]
) -> FingerResult:
    """Return a finger with the semi-axes of its faces, and the radii that side faces' outlines show."""
    names = {face.scale for face in joint.faces}
    return FingerResult(
        manifest=finger,
        semi_axes=joint.semi_axes,
        covariance=joint.covariance,
        source="photographs",
        scale=names.pop() if len(names) == 1 else None,
        outlines=joint,
        outline_radii=tuple(filter(None, outline_radii)),
    )


def photograph_item(finger: Finger, photograph: Photograph) -> str:
    """Return the name under which a photograph is corrected."""
    return f"{finger.name}/{photograph.file or photograph.outline}"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PhotographItem(OneTaskItem[Photograph]):
    """A face of a finger: its photograph, or points of its outline, of which nothing is measured before."""

    finger: Finger

    def work(self) -> Work:
        """Return what measures it."""
        assert self.scale is not None  # the manifest's own rule
        return partial(
            face_record,
            photograph=self.table,
            correction=photograph_correction(self.correction),
            overlay=_overlay(self.finger.name, self.table.face, self.file),
            scale=self.scale,
        )

    def face(self) -> tuple[image.FaceSemiAxes, PhotographResult | None]:
        """Return what is known of the face; `FingerpadError` says why nothing is."""
        if self.table.outline is not None:
            own = None if self.scale is None else require_scale(self.scale)
            return outline_face(self.table, own, self.context.folder), None
        record = self.record
        if record.get("reason") is not None:
            raise FingerpadError(record["reason"])
        assert self.scale is not None
        scale = require_scale(self.scale)
        axes = face_in_scale(from_record(image.FaceSemiAxes, record["axes"]), scale.name)
        found = fields_from(PhotographResult, record)
        return axes, PhotographResult(manifest=self.table, scale=scale, **found)


def photograph_items(finger: Finger, context: RunContext) -> list[PhotographItem]:
    """Return the faces of a finger that are not rejected."""
    named = ((photograph_item(finger, one), one) for one in finger.photographs)
    items = (PhotographItem(context=context, name=name, finger=finger, table=one) for name, one in named)
    return [one for one in items if not context.is_rejected(one.name)]


def pad_of(finger: Finger, photographs: Iterable[PhotographItem], context: RunContext) -> FingerResult:
    """Return a finger's semi-axes, from what the store holds of its photographs where none are given.

    A photograph or outline that cannot be used costs this finger only.
    """
    if finger.semi_axes_mm is not None:
        return given_pad(finger)
    reason = None
    try:
        seen = [one.face() for one in photographs]
        if finger.photographs:
            joint = image.combine_faces(face for face, _ in seen)
            results = tuple(result for _, result in seen if result is not None)
            found = finger_from_faces(finger, joint, (one.outline_radii for one in results))
            return replace(found, photographs=results)
    except StoreError:
        raise
    except FingerpadError as error:
        reason = in_study(f"finger {finger.name}: {error}", context.folder)
    source = "photographs" if finger.photographs else "none"
    return FingerResult(manifest=finger, source=source, reason=reason)


def _overlay(finger: str, face: str, file: str) -> str:
    """Return the name of a photograph's overlay, which no other photograph has, now or in another run."""
    name = re.sub(r"[^\w-]+", "-", PurePosixPath(file).stem)  # folders, blanks and # are for the digest
    stem = file_stem(f"{finger}_{face}_{name}_{hashlib.sha256(file.encode()).hexdigest()[:8]}")
    return f"overlays/photographs/{stem}.png"


def face_record(
    folder: Path,
    out: Path,
    *,
    photograph: Photograph,
    correction: PhotographCorrection,
    overlay: str,
    scale: FoundScale | str,
) -> dict[str, Any]:
    """Measure one photograph of a finger and draw it, and return what was found as plain values."""
    assert photograph.file is not None  # the manifest's own rule
    known = require_scale(scale)
    pixels = image.read_image(folder / photograph.file, colour=True).pixels
    found = corrected_photograph(pixels, photograph, known.scale, correction)
    make_folder((out / overlay).parent)
    image.write_overlay(out / overlay, pixels, found, label="synthetic" if photograph.synthetic else None)
    return {
        "axes": found.face_semi_axes,
        "overlay": overlay,
        "uncertainty": found.uncertainty_mm_std,
        "arc_deg": found.arc_deg,
        "exponent": None if np.isnan(found.exponent) else (found.exponent, found.exponent_std),
        "outline_radii": outline_radii(found),
        "flags": [*sorted(found.flags), *known.flags],
    }


def face_in_scale(face: image.FaceSemiAxes, name: str | None) -> image.FaceSemiAxes:
    """Return a face whose scale has the name that the study gives it, if any."""
    return face if name is None else replace(face, scale=name)


def outline_radii(found: image.PhotographFit) -> tuple[tuple[float, float, float], ...]:
    """Return wedge angles, degrees, and radii with standard uncertainties, mm, of a side face's outline."""
    if found.face not in ("radial", "ulnar"):
        return ()
    angles = range(0, 90, _WEDGE_STEP_DEG)
    radii = [(float(angle), *found.outline_radius(math.radians(angle))) for angle in angles]
    return tuple(one for one in radii if math.isfinite(one[1]))


def outline_face(photograph: Photograph, scale: FoundScale | None, folder: Path) -> image.FaceSemiAxes:
    """Return the semi-axes of a face from points of its outline, and the scale that they were made with."""
    assert photograph.outline is not None
    relative_std = photograph.outline_relative_std if scale is None else scale.scale.relative_std
    face = image.face_from_outline(
        photograph.face, image.read_outline(folder / photograph.outline), relative_std
    )
    return face if scale is None else face_in_scale(face, scale.name)
