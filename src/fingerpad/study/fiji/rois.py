"""ImageJ's ROIs: ellipses that were drawn, and outlines that were traced, in pixels."""

import math
import struct
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Final

import numpy as np
from roifile import ROI_OPTIONS, ROI_SUBTYPE, ROI_TYPE, ImagejRoi

from fingerpad.exceptions import ImageError
from fingerpad.image import ellipse_of_polygon
from fingerpad.study.fiji.ellipse import MeasuredEllipse, upward_deg

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


def read_rois(path: Path) -> list[MeasuredEllipse]:
    """Read the ellipses of a ``.roi`` file or a ``RoiSet.zip``, in px.

    An oval gives its axes as they are, upright or rotated; a polygon or an outline by freehand or wand the
    ellipse of its area and second moments, as Fiji's *Fit ellipse* does.

    Parameters
    ----------
    path : Path
        The file. Nothing of a zip is unpacked to disk.

    Raises
    ------
    ImageError
        Naming file and ROI, what was found, and what to do in Fiji.
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
            return _upright(roi, label, place)
        if roi.roitype == ROI_TYPE.FREEHAND and roi.subtype == ROI_SUBTYPE.ELLIPSE:
            return _rotated(roi, label, place)
        if roi.roitype in _TRACED and roi.subtype != ROI_SUBTYPE.ROTATED_RECT:
            return _traced(roi, label, place)
    except _BROKEN as error:
        raise ImageError(f"{place}: is no ROI of ImageJ, or a broken one ({error})") from error
    raise ImageError(
        f"{place}: is a {roi.roitype.name.lower()}, not an oval, ellipse or outline; "
        "draw one round the contact"
    )


def _upright(roi: ImagejRoi, label: str, place: str) -> MeasuredEllipse:
    width, height = float(roi.right - roi.left), float(roi.bottom - roi.top)
    if roi.subpixelrect:
        width, height = roi.widthd, roi.heightd
    if not (width > 0 and height > 0 and math.isfinite(width + height)):
        raise ImageError(f"{place}: an oval of {width:g} × {height:g} px has no area; draw it again")
    return MeasuredEllipse(
        label=label,
        place=place,
        semi_major=max(width, height) / 2,
        semi_minor=min(width, height) / 2,
        orientation_deg=upward_deg(90.0 if height >= width else 0.0),
    )


def _rotated(roi: ImagejRoi, label: str, place: str) -> MeasuredEllipse:
    """Return a rotated ellipse, kept as the ends of its major axis and minor over major axis."""
    # The ratio is a float in the place of three small fields of other ROIs.
    packed = struct.pack(
        f"{roi.byteorder}BBh",
        roi.arrow_style_or_aspect_ratio,
        roi.arrow_head_size,
        roi.rounded_rect_arc_size,
    )
    (ratio,) = struct.unpack(f"{roi.byteorder}f", packed)
    across, down = roi.x2 - roi.x1, roi.y2 - roi.y1
    major = math.hypot(across, down)
    if not (0 < ratio <= 1 and major > 0 and math.isfinite(major)):
        raise ImageError(f"{place}: an ellipse of {major:g} px with axis ratio {ratio:g}; draw it again")
    return MeasuredEllipse(
        label=label,
        place=place,
        semi_major=major / 2,
        semi_minor=ratio * major / 2,
        orientation_deg=upward_deg(math.degrees(math.atan2(-down, across))),
    )


def _traced(roi: ImagejRoi, label: str, place: str) -> MeasuredEllipse:
    corners = np.asarray(roi.coordinates(), dtype=np.float64).reshape(-1, 2)[:, ::-1]
    try:
        found = ellipse_of_polygon(corners)
    except ImageError as error:
        raise ImageError(f"{place}: {error}") from error
    return MeasuredEllipse(
        label=label,
        place=place,
        semi_major=found.semi_axes[0],
        semi_minor=found.semi_axes[1],
        orientation_deg=math.degrees(found.orientation),
    )
