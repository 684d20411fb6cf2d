"""Estimate the settings of a sequence from the frames that show the largest contact."""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Unpack

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.exceptions import ImageError
from fingerpad.image.contact_image.measure import measure_contact_image, prepare_contact_image
from fingerpad.image.contact_image.result import ContactImageResult
from fingerpad.image.contact_image.view import ContactImageOptions, crop
from fingerpad.image.levels import Pixels
from fingerpad.image.scale import Scale, ScaleLike, as_scale
from fingerpad.image.sequence.frames import Frame, Frames

_SETTINGS_FRAMES: Final = 5
# Wider than a ridge, narrower than a finger: what is left after it is texture.
_TEXTURE_WINDOW_MM: Final = 1.5
# Less texture than this share of the busiest frame's is no contact that could be measured.
_MIN_TEXTURE: Final = 0.01


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TextureScan(Displayed):
    """Texture of the frames, before any is measured."""

    index: npt.NDArray[np.int64]  # (count,); their numbers
    texture: FloatArray  # (count,); its power, which grows with the area in contact; NaN where unreadable
    reason: str | None = None  # why the last of the unreadable frames could not be read

    @classmethod
    def joined(cls, parts: Iterable["TextureScan"]) -> "TextureScan":
        """Return the scan of a sequence from those of its parts, in order."""
        parts = list(parts)
        return cls(
            index=np.concatenate([part.index for part in parts]),
            texture=np.concatenate([part.texture for part in parts]),
            reason=next((part.reason for part in reversed(parts) if part.reason is not None), None),
        )

    @property
    def busiest(self) -> tuple[int, ...]:
        """The few frames of most texture, in their order: those of the largest contact."""
        seen = np.flatnonzero(np.isfinite(self.texture))
        most = seen[np.argsort(-self.texture[seen], kind="stable")][:_SETTINGS_FRAMES]
        return tuple(sorted(self.index[most].tolist()))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SequenceSettings(Displayed):
    """Polarity, contrast and ridge period of all frames, so that these do not flicker."""

    settings: ContactImageOptions
    learnt_from: tuple[int, ...]  # frames of the largest contact
    texture: FloatArray  # (count,); that of the `TextureScan`

    @property
    def min_texture(self) -> float:
        """Texture below which a frame shows no contact that could be measured."""
        return _MIN_TEXTURE * float(np.nanmax(self.texture))


def with_first_frame(frames: Iterable[Frame], options: ContactImageOptions) -> ContactImageOptions:
    """Return a sequence's options: the first frame, before touch, is the background of smooth contacts."""
    if options.get("surface") != "smooth" or options.get("background") is not None:
        return options
    first = next((frame for frame in frames if frame.pixels is not None), None)
    if first is None or first.pixels is None:
        return {**options, "background": None}
    alone: ContactImageOptions = {**options, "background": None}
    # The scale does not decide whether there is a contact; a reflection alone is doubtful.
    prepared = prepare_contact_image(first.pixels, 1.0, **alone)
    if prepared.reason is None and not prepared.measure().flags:
        raise ImageError(
            f"the sequence begins in contact: frame {first.index} shows one, and is no empty view: "
            "give background, a picture without a finger"
        )
    return {**options, "background": first.pixels}


def scan_texture(
    frames: Iterable[Frame], scale: ScaleLike, **options: Unpack[ContactImageOptions]
) -> TextureScan:
    """Measure the texture of each frame, to find those of the largest contact.

    Of smooth contacts it is what differs from the background. Options count that say where to look.
    """
    scale = as_scale(scale)
    index, texture, reason = [], [], None
    for frame in frames:
        index.append(frame.index)
        try:
            texture.append(math.nan if frame.pixels is None else texture_of(frame.pixels, scale, options))
            reason = frame.reason or reason
        except ImageError as error:
            texture.append(math.nan)
            reason = str(error)
    return TextureScan(index=np.array(index, dtype=np.int64), texture=np.array(texture), reason=reason)


def estimate_settings(
    frames: Iterable[Frame],
    scale: ScaleLike,
    *,
    scan: TextureScan | None = None,
    **options: Unpack[ContactImageOptions],
) -> SequenceSettings:
    """Estimate one set of settings for a sequence from its frames of largest contact, reading it twice.

    Ridges lie above half the local rise from valley to ridge, which a flicker of the light scales without
    moving its half. The contrast of the largest contact defines a rise in every frame, so that neither noise
    nor faint traces count as first contact.
    """
    scale = as_scale(scale)
    options = with_first_frame(frames, options)
    scan = scan_texture(frames, scale, **options) if scan is None else scan
    if not scan.busiest:
        raise ImageError(f"no frame can be read: {scan.reason or 'there is none'}")
    seen: list[tuple[int, ContactImageResult]] = []
    reason: str | None = None
    chosen: Iterable[Frame] = (frame for frame in frames if frame.index in scan.busiest)
    if isinstance(frames, Frames) and frames.kind != "video":  # a video is decoded up to each frame
        chosen = map(frames.at, scan.busiest)
    for frame in chosen:
        if frame.pixels is None:
            continue  # it could be read when it was surveyed
        try:
            seen.append((frame.index, measure_contact_image(frame.pixels, scale, **options)))
        except ImageError as error:
            reason = str(error)
    if not seen:
        raise ImageError(f"no contact found in any frame: {reason}")
    polarity, _ = Counter(contact.dark_on_light for _, contact in seen).most_common(1)[0]
    alike = [(index, contact) for index, contact in seen if contact.dark_on_light == polarity]
    alike.sort(key=lambda entry: entry[1].contrast)
    return SequenceSettings(
        settings=alike[len(alike) // 2][1].settings,
        learnt_from=tuple(sorted(index for index, _ in alike)),
        texture=scan.texture,
    )


def texture_of(pixels: Pixels, scale: Scale, options: ContactImageOptions) -> float:
    """Return the power of what is finer than a finger, where the frame is looked at.

    A smooth contact has nothing so fine: what differs from its background counts, whatever the light.
    """
    ground = options.get("background")
    if options.get("surface") == "smooth" and ground is not None:
        off = _off_ground(pixels, np.asarray(ground), {**options, "background": None})
        return float(np.mean(off * off))
    part = crop(pixels, **options)
    values = part.pixels.astype(np.float32)
    # In a picture narrower than the window all that differs from its mean is texture.
    side = 2 * round(min(_TEXTURE_WINDOW_MM / scale.mm_per_px, 2 * max(values.shape)) / 2) + 1
    if part.inside is None:
        fine = values - cv2.blur(values, (side, side))
        return float(np.mean(fine * fine))
    # The mean of each window is that of its pixels inside the mask, whatever flickers beside it.
    inside = part.inside.astype(np.float32)
    near = cv2.blur(values * inside, (side, side)) / np.maximum(cv2.blur(inside, (side, side)), 1e-9)
    fine = (values - near)[part.inside]
    return float(np.mean(fine * fine))


def _off_ground(pixels: Pixels, ground: Pixels, options: ContactImageOptions) -> FloatArray:
    """Return how far a frame lies off its background in as much light, where it is looked at."""
    if pixels.shape[:2] != ground.shape[:2]:
        raise ImageError(
            f"background must have the picture's shape {pixels.shape[:2]}, found {ground.shape[:2]}"
        )
    grey = ground.mean(axis=2) if ground.ndim == 3 else ground
    part, light = (crop(each, **options) for each in (pixels, grey))
    inside = np.s_[:] if part.inside is None else part.inside
    values, level = (each.pixels[inside].astype(np.float64) for each in (part, light))
    return np.asarray(values - np.median((values + 1) / (level + 1)) * level)
