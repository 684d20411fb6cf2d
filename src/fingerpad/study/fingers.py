"""The fingers of a study: semi-axes as given, or fitted to the outlines of photographs."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import FingerpadError
from fingerpad.image import OutlineSemiAxes, read_outline, semi_axes_from_outlines
from fingerpad.study.manifest import Finger


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FingerResult:
    """A finger's semi-axes with their covariance.

    Attributes
    ----------
    name : str
        The finger.
    semi_axes : ndarray, shape (3,)
        Palmar, distal, radial–ulnar, mm; NaN where they could not be had.
    covariance : ndarray, shape (3, 3)
        Their covariance, mm².
    source : str
        ``given`` or ``photographs``.
    outlines : OutlineSemiAxes or None
        The fit to the photographs' outlines, with its consistency.
    pad_thickness : float or None
        Thickness of the soft pad, mm.
    synthetic : bool
        Whether anything of it was rendered or simulated.
    reason : str or None
        Why there are no semi-axes.
    """

    name: str
    semi_axes: FloatArray
    covariance: FloatArray
    source: str
    outlines: OutlineSemiAxes | None = None
    pad_thickness: float | None = None
    synthetic: bool = False
    reason: str | None = None


def finger_result(finger: Finger, folder: Path) -> FingerResult:
    """Return a finger's semi-axes; outlines that cannot be fitted cost this finger only."""
    common: dict[str, Any] = {
        "name": finger.name,
        "pad_thickness": finger.pad_thickness_mm,
        "synthetic": finger.synthetic or any(photograph.synthetic for photograph in finger.photographs),
    }
    if finger.semi_axes_mm is not None and finger.semi_axes_std_mm is not None:
        given, std = finger.semi_axes_mm, finger.semi_axes_std_mm
        return FingerResult(
            semi_axes=np.array([given.palmar, given.distal, given.radial_ulnar]),
            covariance=np.diag(np.square([std.palmar, std.distal, std.radial_ulnar])),
            source="given",
            **common,
        )
    try:
        outlines = semi_axes_from_outlines(
            {photograph.face: read_outline(folder / photograph.outline) for photograph in finger.photographs}
        )
    except FingerpadError as error:
        return FingerResult(
            semi_axes=np.full(3, np.nan),
            covariance=np.full((3, 3), np.nan),
            source="photographs",
            reason=f"finger {finger.name}: {error}".replace(f"{folder}{os.sep}", ""),
            **common,
        )
    return FingerResult(
        semi_axes=np.array([outlines.palmar, outlines.distal, outlines.radial_ulnar]),
        covariance=outlines.covariance,
        source="photographs",
        outlines=outlines,
        **common,
    )
