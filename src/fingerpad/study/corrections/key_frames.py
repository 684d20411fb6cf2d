"""Ellipses of key frames, carried to the frames of a sequence that lie between them."""

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.image import ContactImageResult, ImageEllipse, interpolated_ellipse
from fingerpad.study.corrections.changes import ContactCorrection, ManualContactEllipse
from fingerpad.study.corrections.history import ActiveCorrection


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


def with_interpolated(frames: Mapping[int, ActiveCorrection], sequence: str) -> dict[int, ActiveCorrection]:
    """Return what rules for frames, with the ellipses between key frames for those without a correction.

    Parameters
    ----------
    frames : mapping of int to ActiveCorrection
        What people decided, by the number of the frame.
    sequence : str
        Name of the sequence.
    """
    found = dict(frames)
    keys = sorted(frame for frame, one in frames.items() if _is_key(one))
    for first, last in pairwise(keys):
        one, other = (_ellipse(frames[frame]) for frame in (first, last))
        for frame in range(first + 1, last):
            if frame not in frames:
                found[frame] = replace(
                    frames[first],
                    item=f"{sequence}#{frame}",
                    change=_between(one, other, (frame - first) / (last - first)),
                    picture="",
                    pooling_who="",
                    pooling_when="",
                )
    return found


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
