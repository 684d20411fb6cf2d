"""Ellipses of key frames, carried to the frames of a sequence that lie between them."""

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.image import ContactImageResult, ImageEllipse, interpolated_ellipse
from fingerpad.study.corrections.changes import ContactCorrection, ManualContactEllipse
from fingerpad.study.corrections.history import ActiveCorrection
from fingerpad.study.corrections.items import frames_of


class InterpolatedCorrection(ContactCorrection):
    """The ellipse between two key frames, with the relative standard uncertainties of its semi-axes.

    The contact lies between those of the key frames, uniformly at most: half-way its semi-axes are known to
    1/√12 of their change, and nearer to a key frame better.
    """

    semi_axes_relative_std: tuple[float, float]

    def widened(self, contact_image: ContactImageResult) -> ContactImageResult:
        """Return a measurement under this ellipse, with what interpolation adds to its uncertainty."""
        major, minor = self.semi_axes_relative_std
        effect = contact_image.values * [major, minor, major + minor, major + minor]
        covariance = contact_image.noise_covariance + np.outer(effect, effect)
        return replace(
            contact_image, noise_covariance=covariance, flags=(*contact_image.flags, "interpolated")
        )


def frame_corrections(
    active_corrections: Mapping[str, ActiveCorrection], sequence: str, within: range | None = None
) -> dict[int, ActiveCorrection]:
    """Return the active corrections of a sequence's frames, by number, ellipses between key frames included.

    Parameters
    ----------
    active_corrections : mapping of str to ActiveCorrection
        Active corrections by item; no frame that was corrected takes a carried ellipse.
    sequence : str
        Name of the sequence.
    within : range, optional
        Frames to which ellipses are carried; by default all.
    """
    frames = frames_of(active_corrections, sequence)
    found = dict(frames)
    for first, last in _key_frame_pairs(frames):
        between = range(first + 1, last)
        if within is not None:
            between = range(max(between.start, within.start), min(between.stop, within.stop))
        for frame in between:
            if frame not in frames:
                found[frame] = _carried(frames, first, last, sequence, frame)
    return found


def frame_edits(active_corrections: Mapping[str, ActiveCorrection], sequence: str) -> list[Any]:
    """Return all that `frame_corrections` edits depend on, without carrying an ellipse, as JSON.

    Parameters
    ----------
    active_corrections : mapping of str to ActiveCorrection
        Active corrections by item.
    sequence : str
        Name of the sequence.

    Returns
    -------
    list
        Edits by frame, pairs of key frames, and the frames between them that only have a verdict.
    """
    frames = frames_of(active_corrections, sequence)
    edits = {frame: edits for frame, one in sorted(frames.items()) if (edits := one.change.edits)}
    pairs = _key_frame_pairs(frames)
    judged = sorted(
        frame for frame in frames.keys() - edits.keys() if any(first < frame < last for first, last in pairs)
    )
    return [edits, pairs, judged]


def _key_frame_pairs(frames: Mapping[int, ActiveCorrection]) -> list[tuple[int, int]]:
    return list(pairwise(sorted(frame for frame, one in frames.items() if _is_key(one))))


def _carried(
    frames: Mapping[int, ActiveCorrection], first: int, last: int, sequence: str, frame: int
) -> ActiveCorrection:
    """Return what two key frames say of a frame between them."""
    return replace(
        frames[first],
        item=f"{sequence}#{frame}",
        change=_between(_ellipse(frames[first]), _ellipse(frames[last]), (frame - first) / (last - first)),
        picture="",
        pooling_who="",
        pooling_when="",
    )


def _is_key(one: ActiveCorrection) -> bool:
    return isinstance(one.change, ContactCorrection) and one.change.key_frame and one.change.rejected is None


def _ellipse(one: ActiveCorrection) -> ImageEllipse:
    assert isinstance(one.change, ContactCorrection)  # as a key frame
    assert one.change.manual_ellipse is not None  # the model's own rule
    return one.change.manual_ellipse


def _between(one: ImageEllipse, other: ImageEllipse, share: float) -> InterpolatedCorrection:
    ellipse = interpolated_ellipse(one, other, share)
    change: FloatArray = np.abs(np.subtract(other.semi_axes, one.semi_axes)) / ellipse.semi_axes
    major, minor = (change * math.sqrt(share * (1 - share) / 3)).tolist()
    return InterpolatedCorrection(
        ellipse_px=ManualContactEllipse(
            centre=list(ellipse.centre),
            semi_axes=list(ellipse.semi_axes),
            orientation_deg=math.degrees(ellipse.orientation),
        ),
        semi_axes_relative_std=(major, minor),
    )
