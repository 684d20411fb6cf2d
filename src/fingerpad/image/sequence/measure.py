"""Measure the contact in every frame of a sequence, against time and force."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import takewhile
from typing import Final, TypeAlias, Unpack

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.exceptions import ImageError, LoadingError, reason_of
from fingerpad.image.contact_image.measure import measure_contact_image, prepare_contact_image
from fingerpad.image.contact_image.result import ContactImageResult
from fingerpad.image.contact_image.view import ContactImageOptions, crop
from fingerpad.image.levels import Pixels, luma
from fingerpad.image.scale import Scale, ScaleLike, as_scale
from fingerpad.image.sequence.force import (
    FORCE_KIND,
    ForceSignal,
    FrameClock,
    check_kind,
    zero_before_contact,
)
from fingerpad.image.sequence.frames import Frame, Frames, FramesLike, as_frames
from fingerpad.image.sequence.phases import Phase, PhaseIntervals, phase_intervals
from fingerpad.image.sequence.result import FrameResult

_SETTINGS_FRAMES: Final = 5
_TEXTURE_WINDOW_MM: Final = 1.5  # wider than a ridge, narrower than a finger: texture is left after it
_REPEATED: Final = 0.02  # of the largest force; by more it changes while the picture does not
_MIN_TEXTURE: Final = 0.01  # of the busiest frame's; with less there is no contact that could be measured


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TextureScan(Displayed):
    """Texture of the frames, before any is measured."""

    index: npt.NDArray[np.int64]  # (count,); their numbers
    texture: FloatArray  # (count,); its power, which grows with the area in contact; NaN where unreadable
    reason: str | None = None  # why the last of the unreadable frames could not be read

    @classmethod
    def joined(cls, parts: Iterable[TextureScan]) -> TextureScan:
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
    """Polarity, contrast, ridge period and border of all frames, so that these do not flicker."""

    settings: ContactImageOptions
    learnt_from: tuple[int, ...]  # frames of the largest contact
    texture: FloatArray  # (count,); that of the `TextureScan`


def _is_smooth(options: ContactImageOptions) -> bool:
    return options.get("surface") == "smooth"


def with_first_frame(frames: Iterable[Frame], options: ContactImageOptions) -> ContactImageOptions:
    """Return a sequence's options: the first frame, before touch, is the background of smooth contacts."""
    if not _is_smooth(options) or options.get("background") is not None:
        return options
    alone: ContactImageOptions = {**options, "background": None}
    first = next((frame for frame in frames if frame.pixels is not None), None)
    if first is None or first.pixels is None:
        return alone
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

    Of smooth contacts it is what differs from the background. Of the options background, mask and region of
    interest count.
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
    # That of a smooth contact may have colours, and takes no part in this.
    limits: ContactImageOptions = {**options, "background": None} if _is_smooth(options) else options
    seen: list[tuple[int, ContactImageResult]] = []
    reason, bordered = "", False
    chosen: Iterable[Frame] = (frame for frame in frames if frame.index in scan.busiest)
    if isinstance(frames, Frames) and frames.kind != "video":  # a video is decoded up to each frame
        chosen = map(frames.at, scan.busiest)
    for frame in chosen:
        if frame.pixels is None:
            continue  # it could be read when it was surveyed
        try:
            seen.append((frame.index, measure_contact_image(frame.pixels, scale, **options)))
            grey = luma(frame.pixels)
            bordered = bordered or not crop(grey, **limits).shown(grey.shape).all()
        except ImageError as error:
            reason = str(error)
    if not seen:
        if any(options.get(name) is not None for name in ("mask", "region_of_interest")):
            reason += "; mask and region of interest must hold a contact and some of what surrounds it"
        raise ImageError(f"no contact found in any frame: {reason}")
    polarity, _ = Counter(contact.dark_on_light for _, contact in seen).most_common(1)[0]
    alike = [(index, contact) for index, contact in seen if contact.dark_on_light == polarity]
    alike.sort(key=lambda entry: entry[1].contrast)
    return SequenceSettings(
        settings={**alike[len(alike) // 2][1].settings, "added_border": bordered},
        learnt_from=tuple(sorted(index for index, _ in alike)),
        texture=scan.texture,
    )


def texture_of(pixels: Pixels, scale: Scale, options: ContactImageOptions) -> float:
    """Return the power of what is finer than a finger, where the frame is looked at.

    A smooth contact has nothing so fine: what differs from its background counts, whatever the light.
    """
    ground = options.get("background")
    if _is_smooth(options) and ground is not None:
        return _power_off_ground(pixels, np.asarray(ground), {**options, "background": None})
    part = crop(pixels, **options)
    values = part.pixels
    # In a picture narrower than the window all that differs from its mean is texture.
    side = 2 * round(min(_TEXTURE_WINDOW_MM / scale.mm_per_px, 2 * max(values.shape)) / 2) + 1
    if part.inside is None:
        return cv2.norm(values, cv2.blur(values, (side, side)), cv2.NORM_L2SQR) / values.size
    # The mean of each window is that of its pixels inside the mask, whatever flickers beside it.
    inside = part.inside.astype(np.float32)
    near, share = (cv2.blur(each, (side, side)) for each in (values * inside, inside))
    fine = (values - near / np.maximum(share, 1e-9))[part.inside]
    return float(np.mean(fine * fine))


def _power_off_ground(pixels: Pixels, ground: Pixels, options: ContactImageOptions) -> float:
    """Return the power of what a frame lies off its background in as much light, where it is looked at."""
    if pixels.shape[:2] != ground.shape[:2]:
        raise ImageError(
            f"background must have the picture's shape {pixels.shape[:2]}, found {ground.shape[:2]}"
        )
    part, light = (crop(each, may_have_colours=True, **options) for each in (pixels, ground))
    inside = np.s_[:] if part.inside is None else part.inside
    values, level = (np.atleast_3d(each.pixels)[inside].astype(np.float64) for each in (part, light))
    if values.shape != level.shape:
        values, level = (each.mean(axis=-1, keepdims=True) for each in (values, level))
    off = values - np.median((values + 1) / (level + 1)) * level
    return float(np.mean(off * off))


Watcher: TypeAlias = Callable[[int, Pixels, ContactImageResult], None]
PERSISTENCE: Final = 3  # a contact persists when it is seen in so many frames in a row


def measure_sequence(
    frames: FramesLike,
    scale: ScaleLike,
    *,
    clock: FrameClock | None = None,
    force: ForceSignal | None = None,
    phases: PhaseIntervals | None = None,
    settings: SequenceSettings | None = None,
    watch: Watcher | None = None,
    **options: Unpack[ContactImageOptions],
) -> Iterator[FrameResult]:
    """Measure the contact in each frame of a sequence while the next is decoded.

    The sequence is read twice: to estimate settings for all frames, and to measure. A frame that cannot be
    read or shows no contact has a reason instead of measures. Results before the first contact are held back
    until three frames in a row show one, for their phase and, where the clock starts at first contact, for
    their time.

    Phases come from the force, or where there is none from the texture of the frames, which grows with the
    area in contact, unless they are given. A frame between first contact of the force and of the pictures
    counts as loading where phases were found, not where they are given.

    Of smooth contacts the first frame that can be read, which must be before touch, is the `background` where
    none is given; what differs from it stands for the texture. Colours count, as of a single picture.

    Parameters
    ----------
    frames : iterable of Frame or path-like
        The sequence, as `open_frames` returns it or takes it: it must be possible to go through it twice.
    scale : Scale or float
        Millimetres per pixel.
    clock : FrameRate or FrameStamps, optional
        Times of the frames on the clock of the force signal. Without it times are NaN.
    force : ForceSignal, optional
        Normal force. A frame outside the signal has load NaN, no phase, and the flag ``no_force``. What it
        is before first contact is subtracted from loads, where that matters and no touch explains it.
    phases : PhaseIntervals, optional
        Phases on the clock of the force, as a person sets them.
    settings : SequenceSettings, optional
        What `estimate_settings` found; estimated here when None.
    watch : callable, optional
        Called with (index, pixels, contact_image) after each measurement, as for drawing overlays.
    **options
        What is known or wanted, as for `measure_contact_image`. How levels are read is estimated with it for
        all frames, or as `settings` say.

    Returns
    -------
    iterator of FrameResult
        Frames are read as it advances.

    Raises
    ------
    ImageError
        If `frames` is no sequence, or can be gone through only once; on the way, if no frame can be read, or
        none shows a contact.
    CalibrationError
        If a number is no length of a pixel, mm.
    LoadingError
        If a force or phases are given without a clock, or force or clock are of another type.

    Examples
    --------
    >>> from fingerpad.image import Frame, FrameRate
    >>> from fingerpad.simulate import render_sequence
    >>> press = render_sequence([0.0, 0.05, 0.1, 0.15], seed=2)
    >>> frames = [Frame(index=k, pixels=press.pixels(k)) for k in range(4)]
    >>> for result in measure_sequence(frames, 25.4 / press.ppi, clock=FrameRate(10)):
    ...     print(result.time, result.is_first_contact, None if result.measures is None else "measured")
    0.0 False None
    0.1 True measured
    0.2 False measured
    0.3 False measured
    """
    if (force is not None or phases is not None) and clock is None:
        raise LoadingError("force and phases need the times of the frames: give frames per second, or stamps")
    check_kind("clock", clock, FrameClock, "a FrameRate, as frame_clock makes it, or FrameStamps")
    check_kind("force", force, ForceSignal, FORCE_KIND)
    check_kind("phases", phases, PhaseIntervals, "PhaseIntervals, as phase_intervals finds them")
    sequence, scale = as_frames(frames, colour=_is_smooth(options)), as_scale(scale)
    if settings is None and iter(sequence) is sequence:
        raise ImageError("frames are read twice, a generator only once: give a list, or settings")

    def results() -> Iterator[FrameResult]:
        wanted = with_first_frame(sequence, options)
        found = settings or estimate_settings(sequence, scale, **wanted)
        measured = measure_frames(sequence, scale, found, watch=watch, **wanted)
        yield from assign_times(measured, found.texture, clock=clock, force=force, phases=phases)

    return results()


def measure_frames(
    frames: Iterable[Frame],
    scale: ScaleLike,
    settings: SequenceSettings,
    *,
    watch: Watcher | None = None,
    **options: Unpack[ContactImageOptions],
) -> Iterator[FrameResult]:
    """Measure frame by frame, without time, load or phase; each result depends on its frame alone.

    `settings` of the whole sequence say how levels are read; options limit where, as
    `measure_contact_image`'s.
    """
    scale = as_scale(scale)
    # Frames share a relative level: a threshold has gone into learning the contrast.
    read: ContactImageOptions = {**options, **settings.settings, "threshold": None}
    least_texture = _MIN_TEXTURE * float(np.nanmax(settings.texture))
    empty = "hardly differs from the background" if _is_smooth(options) else "is smooth"

    def measured(frame: Frame) -> FrameResult:
        if frame.pixels is None:
            return FrameResult(index=frame.index, readable=False, reason=frame.reason)
        try:
            if texture_of(frame.pixels, scale, options) < least_texture:
                reason = f"no contact found: the frame {empty} beside those of the largest contact"
                return FrameResult(index=frame.index, reason=reason)
            contact_image = measure_contact_image(frame.pixels, scale, **read)
        except MemoryError:  # the limit of the process, not a fault of this frame
            raise
        except Exception as error:  # any error fails this frame only
            return FrameResult(index=frame.index, reason=reason_of(error, "the frame cannot be measured"))
        if watch is not None:
            watch(frame.index, frame.pixels, contact_image)
        return FrameResult(index=frame.index, measures=contact_image.as_record(), flags=contact_image.flags)

    return map(measured, frames)


def _zero(seen: list[FrameResult], force: ForceSignal, clock: FrameClock, found: PhaseIntervals) -> float:
    """Return what the force shows without contact, N: while frames show none, or else before its phases."""
    contacts = seen[-PERSISTENCE:]
    empty = [one for one in takewhile(lambda one: one.measures is None, seen) if one.readable]
    before, during = (
        np.array([clock.time_of(one.index, contacts[0].index) for one in part]) for part in (empty, contacts)
    )
    if not (np.isfinite(before).all() and np.isfinite(during).all()):
        return 0.0
    area = np.array([result.measures["gross_area_mm2"] for result in contacts if result.measures])
    own = force.time[force.time < min(during[0], *found.start)]
    return zero_before_contact(force, before, during, area) or zero_before_contact(force, own, during, area)


def assign_times(
    results: Iterable[FrameResult],
    texture: FloatArray,
    *,
    clock: FrameClock | None = None,
    force: ForceSignal | None = None,
    phases: PhaseIntervals | None = None,
) -> Iterator[FrameResult]:
    """Yield all results of a sequence with time, load and phase, once the first contact is known.

    Phases are those given, on the clock of the force; or those of the force; or, without it, those of
    `texture` (`SequenceSettings.texture`). Loads are less the level of the force before contact, where
    `zero_before_contact` finds one.
    """
    by_number = phases is None and force is None
    if phases is not None:
        found = phases
    elif force is not None:
        found = phase_intervals(force.time, force.load)
    else:
        seen = np.flatnonzero(np.isfinite(texture))
        index = np.arange(texture.size, dtype=np.float64)
        found = phase_intervals(index, np.interp(index, seen, texture[seen]))

    def phase_of(result: FrameResult) -> Phase | None:
        place = result.index if by_number else result.time
        if place >= texture.size if by_number else math.isnan(place) or "no_force" in result.flags:
            return None
        phase = found.at(place)
        touching = result.measures is not None and first_contact is not None and result.index >= first_contact
        if phases is None and touching:
            return "loading" if phase == "before" else "unloading" if phase == "after" else phase
        return phase

    shown, shown_load = "", math.nan  # numbers of the last picture, and load of the first that had them
    changed = math.inf if force is None else _REPEATED * float(force.load.max())

    def placed(result: FrameResult) -> FrameResult:
        nonlocal shown, shown_load
        time = math.nan if clock is None else clock.time_of(result.index, first_contact)
        load = math.nan if force is None else float(force.load_at(time)) - zero
        # Noise alone gives every picture other numbers. As text, NaN is equal to NaN.
        numbers = str([(result.measures or {}).get(name) for name in ("gross_area_mm2", "ridge_area_mm2")])
        if result.measures is None or numbers != shown:
            shown, shown_load = numbers, load
        doubts = {
            "no_time": clock is not None and math.isnan(time),
            "no_force": force is not None and math.isnan(load),
            "repeated_frame": abs(load - shown_load) > changed,
        }
        flags = (*result.flags, *(flag for flag, doubted in doubts.items() if doubted))
        timed = replace(result, time=time, load=load, flags=flags)
        return replace(timed, phase=phase_of(timed), is_first_contact=result.index == first_contact)

    waiting: list[FrameResult] = []
    run, zero = 0, 0.0
    first_contact: int | None = None
    for result in results:
        if first_contact is not None:
            yield placed(result)
            continue
        waiting.append(result)
        run = run + 1 if result.measures is not None else 0
        if run == PERSISTENCE:
            first_contact = waiting[-PERSISTENCE].index
            if force is not None and clock is not None:
                zero = _zero(waiting, force, clock, found)
            yield from map(placed, waiting)
            waiting.clear()
    yield from map(placed, waiting)
