"""Ellipses measured in Fiji or ImageJ, as observations in the CSV that ``observations_csv`` names."""

import math
import re
import struct
import zipfile
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any, Final

import numpy as np
from roifile import ROI_OPTIONS, ROI_SUBTYPE, ROI_TYPE, ImagejRoi

from fingerpad._csv import write_csv
from fingerpad._display import Displayed
from fingerpad._tables import read_table
from fingerpad.exceptions import CalibrationError, FingerpadError, ImageError, ManifestError
from fingerpad.image import ellipse_of_polygon
from fingerpad.study.imports.names import Field, NamePattern, plain_name
from fingerpad.study.manifest.messages import validated
from fingerpad.study.manifest.models import Load, ManifestModel, Name, RollAngle, WedgeAngle

_TRACED: Final = frozenset((ROI_TYPE.POLYGON, ROI_TYPE.FREEHAND, ROI_TYPE.TRACED))
_LARGEST: Final = 16_000_000  # bytes; 65,535 corners take one
# What roifile raises for bytes that are no ROI.
_BROKEN: Final = (
    ValueError,
    TypeError,
    IndexError,
    KeyError,
    struct.error,
    NotImplementedError,
    RuntimeError,
)
_SUMMARY: Final = ["Mean", "SD", "Min", "Max"]  # rows that Fiji's Summarize appends
# Area over that of the ellipse: they differ where holes or a threshold count.
_SAME_AREA: Final = 0.05


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredEllipse:
    """One ellipse, in the unit of its file."""

    label: str  # what Fiji calls it: the picture's name, or the ROI's
    source: str  # file and line, or file and ROI, for messages
    # Half of what Fiji's Major and Minor are.
    semi_major: float
    semi_minor: float
    # Of the long axis from straight up in the picture, counter-clockwise, in (−90, 90]; None if unknown.
    orientation_deg: float | None = None
    doubts: tuple[str, ...] = ()  # what should be looked at


def upward_deg(angle_deg: float) -> float:
    """Turn an angle from the horizontal, as Fiji gives it, into one from straight up, in (−90, 90]."""
    return 90 - (180 - angle_deg) % 180


def is_roi_file(path: Path) -> bool:
    """Tell by its suffix whether a file holds ROIs, which are in pixels, or a table."""
    return path.suffix.lower() in {".roi", ".zip"}


def read_results_table(path: Path) -> list[MeasuredEllipse]:
    """Read the fitted ellipses of a Results table, in its own unit.

    Cells may be separated by commas, tabs or semicolons, the latter two with decimal commas. Rows that Fiji's
    *Summarize* appends are left out.
    """
    table = read_table(path, ManifestError)
    missing = [name for name in ("Major", "Minor") if name not in table.header]
    if missing:
        found = ", ".join(filter(None, table.header)) or "none"
        raise ManifestError(
            f"{path}: no column {' and '.join(missing)}; found {found}. "
            "In Fiji choose Analyze > Set Measurements > Fit ellipse, and measure again"
        )
    table.require_headers(ManifestError)
    names = [name for name in ("Major", "Minor", "Area", "Angle") if name in table.header]
    numbers = zip(*table.texts([table.header.index(name) for name in names]), strict=True)
    rows = []
    for (line, cells), measured in zip(table.rows, numbers, strict=True):
        row = dict(zip(table.header, map(str.strip, cells), strict=False))
        row.update(zip(names, measured, strict=True))
        rows.append((f"{path.name}, {table.line(line)}", row))
    if [row.get("Label") for _, row in rows[-4:]] == _SUMMARY:
        rows = rows[:-4]
    if not rows:
        raise ManifestError(f"{path}: holds no rows below its first line; measure something first")
    return [_row_ellipse(row, place, number) for number, (place, row) in enumerate(rows, start=1)]


def _row_ellipse(row: Mapping[str, str], place: str, number: int) -> MeasuredEllipse:
    major, minor = _number(row, "Major", place), _number(row, "Minor", place)
    if not major >= minor > 0:
        raise ManifestError(
            f"{place}: Major {major:g} and Minor {minor:g} are no full axes of an ellipse; "
            "a line or a point has none: remove the row"
        )
    doubts = []
    if row.get("Area"):
        ratio = _number(row, "Area", place) / (math.pi * major * minor / 4)
        if abs(ratio - 4) < 4 * _SAME_AREA:
            raise ManifestError(
                f"{place}: Area is π times Major times Minor, so these are semi-axes; "
                "Fiji writes full axes: double them, or write observations with semi_major_mm yourself"
            )
        if abs(ratio - 1) > _SAME_AREA:
            doubts.append(f"Area is {ratio:.2f} of the ellipse's; were holes or a threshold measured?")
    angle = _number(row, "Angle", place) if row.get("Angle") else None
    return MeasuredEllipse(
        label=row.get("Label") or f"contact_{number}",
        source=place,
        semi_major=major / 2,
        semi_minor=minor / 2,
        orientation_deg=None if angle is None else upward_deg(angle),
        doubts=tuple(doubts),
    )


def _number(row: Mapping[str, str], column: str, place: str) -> float:
    try:
        value = float(row[column])
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ManifestError(f"{place}: column {column}: expected a number, found {row[column][:40]!r}")
    return value


def read_rois(path: Path) -> list[MeasuredEllipse]:
    """Read the ellipses of a ``.roi`` file or a ``RoiSet.zip``, in px.

    An oval gives its axes as they are, upright or rotated; a polygon or an outline by freehand or wand the
    ellipse of its area and second moments, as Fiji's *Fit ellipse* does.
    """
    try:
        if path.suffix.lower() != ".zip":
            return [_ellipse(path.read_bytes(), path.stem, path.name)]
        with zipfile.ZipFile(path) as archive:
            found = [_ellipse(content, name, place) for name, place, content in _members(archive, path)]
    except OSError as error:
        raise ImageError(f"{path}: cannot be read ({error.strerror})") from error
    except (zipfile.BadZipFile, zlib.error, RuntimeError, EOFError) as error:  # broken or encrypted
        raise ImageError(
            f"{path}: cannot be read as a zip of ROIs ({error}); save it again with the ROI Manager"
        ) from error
    if not found:
        raise ImageError(f"{path}: holds no ROIs; save them by the ROI Manager, More > Save")
    return found


def _members(archive: zipfile.ZipFile, path: Path) -> Iterator[tuple[str, str, bytes]]:
    """Yield name, place and bytes of each ROI."""
    for member in archive.infolist():
        name = PurePosixPath(member.filename.replace("\\", "/"))
        if name.is_absolute() or len(name.parts) > 1:
            raise ImageError(
                f"{path}: holds {member.filename[:60]!r}, with a folder in its name; "
                "the ROI Manager writes none: save the ROIs again"
            )
        if name.suffix.lower() != ".roi":
            raise ImageError(f"{path}: holds {member.filename[:60]!r}, which is no ROI; save the ROIs again")
        if member.file_size > _LARGEST:
            raise ImageError(f"{path}: {member.filename[:60]!r} would be {member.file_size} bytes: no ROI is")
        yield name.stem, f"{path.name}, {name.name}", archive.read(member)


def _ellipse(content: bytes, name: str, place: str) -> MeasuredEllipse:
    """Return the ellipse of one ROI: of each kind the semi-axes, px, and the direction from straight up."""
    try:
        roi = ImagejRoi.frombytes(content)
        label = roi.name or name
        if roi.composite:
            raise ImageError(
                f"{place}: is made of several outlines; select the outer one, or draw an ellipse"
            )
        if roi.options & ROI_OPTIONS.SPLINE_FIT:
            raise ImageError(
                f"{place}: is a spline; make it a polygon first (Edit > Selection > Interpolate)"
            )
        if roi.roitype == ROI_TYPE.OVAL:
            major, minor, orientation_deg = _upright(roi, place)
        elif roi.roitype == ROI_TYPE.FREEHAND and roi.subtype == ROI_SUBTYPE.ELLIPSE:
            major, minor, orientation_deg = _rotated(roi, place)
        elif roi.roitype in _TRACED and roi.subtype != ROI_SUBTYPE.ROTATED_RECT:
            major, minor, orientation_deg = _traced(roi, place)
        else:
            raise ImageError(
                f"{place}: is a {roi.roitype.name.lower()}, not an oval, ellipse or outline; "
                "draw one round the contact"
            )
    except _BROKEN as error:
        raise ImageError(f"{place}: is no ROI of ImageJ, or a broken one ({error})") from error
    return MeasuredEllipse(
        label=label, source=place, semi_major=major, semi_minor=minor, orientation_deg=orientation_deg
    )


def _upright(roi: ImagejRoi, place: str) -> tuple[float, float, float]:
    width, height = float(roi.right - roi.left), float(roi.bottom - roi.top)
    if roi.subpixelrect:
        width, height = roi.widthd, roi.heightd
    if not (width > 0 and height > 0 and math.isfinite(width + height)):
        raise ImageError(f"{place}: an oval of {width:g} × {height:g} px has no area; draw it again")
    return max(width, height) / 2, min(width, height) / 2, upward_deg(90.0 if height >= width else 0.0)


def _rotated(roi: ImagejRoi, place: str) -> tuple[float, float, float]:
    """Return a rotated ellipse, kept as the ends of its major axis and minor over major axis."""
    # The ratio is a float in the place of three small fields of other ROIs.
    small = roi.arrow_style_or_aspect_ratio, roi.arrow_head_size, roi.rounded_rect_arc_size
    (ratio,) = struct.unpack(f"{roi.byteorder}f", struct.pack(f"{roi.byteorder}BBh", *small))
    across, down = roi.x2 - roi.x1, roi.y2 - roi.y1
    major = math.hypot(across, down)
    if not (0 < ratio <= 1 and major > 0 and math.isfinite(major)):
        raise ImageError(f"{place}: an ellipse of {major:g} px with axis ratio {ratio:g}; draw it again")
    return major / 2, ratio * major / 2, upward_deg(math.degrees(math.atan2(-down, across)))


def _traced(roi: ImagejRoi, place: str) -> tuple[float, float, float]:
    corners = np.asarray(roi.coordinates(), dtype=np.float64).reshape(-1, 2)[:, ::-1]
    try:
        found = ellipse_of_polygon(corners)
    except ImageError as error:
        raise ImageError(f"{place}: {error}") from error
    return *found.semi_axes, math.degrees(found.orientation)


# What an ellipse does not tell of its contact.
FIELDS: Final = ("finger", "wedge_angle_deg", "load_N", "roll_angle_deg")
_NEEDED: Final = FIELDS[:3]
# Semi-major axes, mm, between which contacts of finger pads lie: beyond, the unit is wrong.
_PLAUSIBLE: Final = (0.5, 40.0)
_HEADER: Final = (
    "name", *FIELDS, "semi_major_mm", "semi_minor_mm", "ellipse_mm_std", "long_axis", "synthetic", "notes",
)  # fmt: skip
# What a pattern of labels may hold.
_LABEL_FIELDS: Final[tuple[Field, ...]] = ("person", "finger", "wedge", "roll", "load")
_SUFFIX: Final = r"\.(?:tiff?|png|jpe?g|bmp|gif)(?=$|:)"
_LONGEST_NAME: Final = 50


class _LabelValues(ManifestModel):
    """What a manifest takes of it."""

    finger: Name | None = None
    wedge_angle_deg: WedgeAngle | None = None
    load_N: Load | None = None  # noqa: N815 (the unit's own letter)
    roll_angle_deg: RollAngle | None = None


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ManualObservation(Displayed):
    """One row of the CSV: an observation whose ellipse a person measured."""

    name: str  # made from the label, like no other
    values: Mapping[str, str | float]  # those of `FIELDS` that are known
    semi_major_mm: float
    semi_minor_mm: float
    ellipse_mm_std: float  # standard uncertainty of either semi-axis
    long_axis: str | None  # where it lies, if the picture tells
    synthetic: bool  # whether the picture was rendered
    notes: str  # where it comes from, and doubts

    @property
    def missing(self) -> tuple[str, ...]:
        """Columns that a person must fill in before the study can be run."""
        return tuple(name for name in _NEEDED if name not in self.values)

    def as_record(self) -> dict[str, Any]:
        """Return the row, None for what is not known."""
        return {key: self.values.get(key) if key in FIELDS else getattr(self, key) for key in _HEADER}


def manual_observations(
    ellipses: Sequence[MeasuredEllipse],
    *,
    mm_per_unit: float,
    semi_axis_mm_std: float,
    relative_scale_std: float = 0.0,
    known: Mapping[str, str | float] | None = None,
    pattern: str | None = None,
    finger_axis_deg: float = 0.0,
    synthetic: bool = False,
) -> list[ManualObservation]:
    """Turn ellipses into observations.

    `mm_per_unit` is mm per px, or 1 for a table in mm; `semi_axis_mm_std` that of either semi-axis as a
    person finds it; `relative_scale_std` is added to each row as if it were the row's own. `known` are those
    of `FIELDS` that are the same for all; the `pattern` tells others by labels, as of `match_file_names`.
    `finger_axis_deg` is from straight up, counter-clockwise.
    """
    if not (semi_axis_mm_std > 0 and math.isfinite(semi_axis_mm_std)):
        raise ManifestError(f"the standard uncertainty must be positive, found {semi_axis_mm_std:g} mm")
    known = known or {}
    for name, value in {**known, "finger_axis_deg": finger_axis_deg}.items():
        if not isinstance(value, str) and not math.isfinite(value):
            raise ManifestError(f"{name} must be a finite number, found {value:g}")
    labels = _values_of_labels(ellipses, pattern)
    twice = sorted(set(known) & {name for stated in labels for name in stated})
    if twice:
        raise ManifestError(
            f"{twice[0]} is given for all rows and by the label pattern; choose one of the two"
        )
    names: set[str] = set()
    rows = []
    for ellipse, stated in zip(ellipses, labels, strict=True):
        major, minor = mm_per_unit * ellipse.semi_major, mm_per_unit * ellipse.semi_minor
        if not _PLAUSIBLE[0] <= major <= _PLAUSIBLE[1]:
            raise CalibrationError(
                f"{ellipse.source}: a semi-major axis of {major:.3g} mm is none of a finger's contact; "
                "check the unit or the scale (Fiji measures in px until a scale is set)"
            )
        values = {**known, **stated}
        if person := values.pop("person", None):
            values["finger"] = f"{person}_{values['finger']}" if "finger" in values else person
        validated(_LabelValues, values, ellipse.source, strict=True)
        rows.append(
            ManualObservation(
                name=_name(ellipse.label, names),
                values=values,
                semi_major_mm=major,
                semi_minor_mm=minor,
                ellipse_mm_std=math.hypot(semi_axis_mm_std, relative_scale_std * math.sqrt(major * minor)),
                long_axis=_long_axis(ellipse, finger_axis_deg),
                synthetic=synthetic,
                notes="; ".join((f"measured manually: {ellipse.source}", *ellipse.doubts)),
            )
        )
    return rows


def _values_of_labels(ellipses: Sequence[MeasuredEllipse], text: str | None) -> list[dict[str, Any]]:
    """Return what each label states, nothing where it does not fit the pattern."""
    if text is None:
        return [{} for _ in ellipses]
    pattern = NamePattern.of(text, _LABEL_FIELDS)
    stems = [re.split(f"{_SUFFIX}|:", one.label, maxsplit=1, flags=re.IGNORECASE)[0] for one in ellipses]
    found = [pattern.match(one.source, stem) for one, stem in zip(ellipses, stems, strict=True)]
    for match in found:
        if match.fits and match.problem:
            raise ManifestError(f"{match.file}: {match.problem}")
    if ellipses and not any(match.fits for match in found):
        raise ManifestError(
            f"the label pattern {text!r} fits no label, such as {ellipses[0].label!r}; * is anything, and "
            "only hand and digit of a finger may have an underscore between them"
        )
    return [dict[str, Any](match.values) for match in found]


def _long_axis(ellipse: MeasuredEllipse, finger_axis_deg: float) -> str | None:
    if ellipse.orientation_deg is None or ellipse.semi_major == ellipse.semi_minor:
        return None
    from_finger = (ellipse.orientation_deg - finger_axis_deg + 90) % 180 - 90
    return "along" if abs(from_finger) <= 45 else "across"


def _name(label: str, taken: set[str]) -> str:
    """Return a name that a manifest takes, unlike all others even where case does not count."""
    base = plain_name(re.sub(_SUFFIX, "", label, flags=re.IGNORECASE))[:_LONGEST_NAME] or "contact"
    name, number = base, 1
    while name.casefold() in taken:
        number += 1
        name = f"{base}_{number}"
    taken.add(name.casefold())
    return name


def write_observations(path: Path, rows: Iterable[ManualObservation]) -> None:
    """Write the CSV that ``observations_csv`` names; what is there already is never replaced."""
    try:
        write_csv(path, [_HEADER, *(row.as_record().values() for row in rows)], mode="x")
    except FileExistsError:
        raise FingerpadError(f"{path}: is there already, and may be filled in; name another file") from None
    except OSError as error:
        raise FingerpadError(f"{path}: cannot be written ({error.strerror})") from error
