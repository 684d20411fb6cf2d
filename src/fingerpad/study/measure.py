"""Measuring one observation: from its picture, or from the ellipse given, to a contact ellipse."""

import os
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._files import make_folder
from fingerpad.exceptions import FingerpadError
from fingerpad.image import Imprint, measure_imprint, read_image, write_overlay
from fingerpad.study.fingers import scale_of
from fingerpad.study.manifest import Direction, Observation

_FROM_RECORD = (
    "gross_area_mm2",
    "gross_area_mm2_std",
    "ridge_area_mm2",
    "ridge_area_mm2_std",
    "ridge_period_mm",
    "ellipse_iou",
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measurement:
    """What was seen of one contact.

    Attributes
    ----------
    observation : str
        Name of the observation.
    reason : str or None
        Why nothing was measured; None where something was.
    semi_major, semi_minor : float
        Semi-axes of the contact ellipse, mm.
    covariance : ndarray, (2, 2)
        Their covariance, mm².
    long_axis : {"along", "across"} or None
        Whether the long axis lies along or across the finger, where that is known.
    details : dict of str to float
        Further columns of the results that only a picture yields.
    flags : tuple of str
        Doubts about the picture.
    overlay : str or None
        File of the overlay, relative to the output folder.
    """

    observation: str
    reason: str | None = None
    semi_major: float = np.nan
    semi_minor: float = np.nan
    covariance: FloatArray = field(default_factory=lambda: np.full((2, 2), np.nan))
    long_axis: Direction | None = None
    details: dict[str, float] = field(default_factory=dict)
    flags: tuple[str, ...] = ()
    overlay: str | None = None


def measure_observation(observation: Observation, folder: Path, out: Path) -> Measurement:
    """Measure one observation and write its overlay; whatever goes wrong costs this row only.

    Parameters
    ----------
    observation : Observation
        A row of the manifest.
    folder, out : Path
        The study folder, and the folder of results.
    """
    if observation.ellipse_mm is not None:
        ellipse = observation.ellipse_mm
        return Measurement(
            observation=observation.name,
            semi_major=ellipse.semi_major,
            semi_minor=ellipse.semi_minor,
            covariance=ellipse.std**2 * np.eye(2),
            long_axis=ellipse.long_axis,
        )
    try:
        return _measure_image(observation, folder, out)
    except FingerpadError as error:
        reason = str(error).replace(f"{folder}{os.sep}", "")
    except (ArithmeticError, MemoryError, OSError, ValueError, cv2.error) as error:
        # A picture can be odd in ways that nobody has thought of: it costs its row, never the run.
        reason = f"{observation.image}: cannot be measured ({type(error).__name__}: {error})"
    return Measurement(observation=observation.name, reason=reason)


def _measure_image(observation: Observation, folder: Path, out: Path) -> Measurement:
    assert observation.image is not None  # the manifest's own rule
    window = observation.region_of_interest_px
    pixels = read_image(folder / observation.image).pixels
    imprint = measure_imprint(
        pixels,
        scale_of(observation),
        dark_on_light=observation.dark_on_light,
        background=None
        if observation.background is None
        else read_image(folder / observation.background).pixels,
        seed=None if observation.seed_px is None else (observation.seed_px[0], observation.seed_px[1]),
        threshold=observation.threshold,
        mask=observation.mask_px,
        region_of_interest=None if window is None else (window[0], window[1], window[2], window[3]),
    )
    overlay = Path("overlays") / f"{observation.name}.png"
    make_folder((out / overlay).parent)
    write_overlay(out / overlay, pixels, imprint, label="synthetic" if observation.synthetic else None)
    return _from_imprint(imprint, observation, overlay)


def _from_imprint(imprint: Imprint, observation: Observation, overlay: Path) -> Measurement:
    major, minor = float(imprint.ellipse.semi_major), float(imprint.ellipse.semi_minor)
    record = imprint.as_record()
    turn = np.degrees(imprint.orientation) - observation.finger_axis_deg
    orientation = float(90 - (90 - turn) % 180)
    return Measurement(
        observation=observation.name,
        semi_major=major,
        semi_minor=minor,
        covariance=imprint.covariance[:2, :2],
        long_axis="along" if abs(orientation) <= 45 else "across",
        details={
            **{name: record[name] for name in _FROM_RECORD},
            "orientation_deg": orientation,
            "centroid_row_px": imprint.centroid[0],
            "centroid_column_px": imprint.centroid[1],
        },
        flags=imprint.flags,
        overlay=str(overlay),
    )
