"""Ellipses measured in Fiji or ImageJ: its Results table, and its ROIs."""

import math
import struct
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import Final

import numpy as np
from roifile import ROI_OPTIONS, ROI_SUBTYPE, ROI_TYPE, ImagejRoi

from fingerpad._tables import read_table
from fingerpad.exceptions import ImageError, ManifestError
from fingerpad.image import ellipse_of_polygon
from fingerpad.study.imports.ellipses import MeasuredEllipse, upward_deg

UNIT_HINT: Final = "Fiji measures in px until a scale is set"
_TRACED: Final = frozenset((ROI_TYPE.POLYGON, ROI_TYPE.FREEHAND, ROI_TYPE.TRACED))
_LARGEST: Final = 16_000_000  # bytes; 65,535 corners take one
# What roifile raises for bytes that are no ROI.
_BROKEN: Final = (ValueError, TypeError, LookupError, struct.error, RuntimeError)
_SUMMARY: Final = ["Mean", "SD", "Min", "Max"]  # rows that Fiji's Summarize appends
# Area over that of the ellipse: they differ where holes or a threshold count.
_SAME_AREA: Final = 0.05


def is_roi_file(path: Path) -> bool:
    """Tell by its suffix whether a file holds ROIs, which are in pixels, or a table."""
    return path.suffix.lower() in {".roi", ".zip"}


def read_results_table(path: Path) -> list[MeasuredEllipse]:
    """Read the fitted ellipses of a Results table, in its own unit, without rows that *Summarize* appends."""
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
