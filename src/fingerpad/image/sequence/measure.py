"""Measure the contact in every frame of a sequence, against time and force."""

import heapq
import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Final, TypeAlias, TypedDict, Unpack

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import ImageError, LoadingError
from fingerpad.image._grey import Pixels
from fingerpad.image.imprint.measure import measure_imprint
from fingerpad.image.imprint.result import Imprint, ImprintSettings
from fingerpad.image.scale import Scale
from fingerpad.image.sequence.force import ForceSignal, FrameClock
from fingerpad.image.sequence.frames import Frame
from fingerpad.image.sequence.phases import PHASES, Phase, phases_of
from fingerpad.image.sequence.result import FrameResult

Watcher: TypeAlias = Callable[[int, Pixels, Imprint], None]


class Place(TypedDict, total=False):
    """Where every frame is looked at, as keyword arguments of `measure_imprint`."""

    background: npt.ArrayLike | None
    seed: tuple[float, float] | None
    mask: npt.ArrayLike | None
    region_of_interest: tuple[int, int, int, int] | None


# A contact persists when it is seen in so many frames in a row.
PERSISTENCE: Final = 3
_TEACHERS: Final = 5
# Wider than a ridge, narrower than a finger: what is left after it is texture.
_TEXTURE_WINDOW_MM: Final = 1.5
# Less texture than this share of the busiest frame's is no contact that could be measured.
_LEAST_TEXTURE: Final = 0.01


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reading:
    """How every frame of one sequence is read.

    Attributes
    ----------
    settings : ImprintSettings
        Polarity, contrast and ridge period for `measure_imprint`, the same for all frames: those of each
        frame's own would flicker, and differ between a first touch and the largest contact.
    learnt_from : tuple of int
        Frames of the largest contact from which this was learnt.
    texture : ndarray, (count,)
        Power of each frame's texture, which grows with the area in contact; NaN where it cannot be read.
    """

    settings: ImprintSettings
    learnt_from: tuple[int, ...]
    texture: FloatArray


def learn_reading(
    frames: Iterable[Frame],
    scale: Scale,
    *,
    dark_on_light: bool | None = None,
    threshold: float | None = None,
    **place: Unpack[Place],
) -> Reading:
    """Learn from the frames of largest contact how to read a sequence: one relative level for all its frames.

    Ridges lie above half the local rise from valley to ridge, which a flicker of the light scales without
    moving its half. What counts as a rise is told from the contrast of the largest contact in every frame,
    so that neither noise nor faint traces pass for a first contact.

    Parameters
    ----------
    frames : iterable of Frame
        The sequence, gone through once.
    scale : Scale
        Millimetres per pixel.
    dark_on_light : bool, optional
        Whether contact is darker than the ground, where it is known.
    threshold : float, optional
        Grey levels from the ground to a ridge, where it is known.
    **place
        Background, seed, mask and region of interest, as for `measure_imprint`.

    Raises
    ------
    ImageError
        If not one frame can be read, or none of those with the most texture shows a contact.
    """
    textures: list[float] = []
    # A handful of frames is held: the busiest so far.
    busiest: list[tuple[float, int, Pixels]] = []
    reason = "there is none"
    for frame in frames:
        textures.append(math.nan if frame.pixels is None else _texture(frame.pixels, scale, place))
        if frame.pixels is None:
            reason = frame.reason or reason
            continue
        entry = (textures[-1], -frame.index, frame.pixels)
        if len(busiest) < _TEACHERS:
            heapq.heappush(busiest, entry)
        elif entry[:2] > busiest[0][:2]:
            heapq.heapreplace(busiest, entry)
    if not busiest:
        raise ImageError(f"no frame can be read: {reason}")
    seen: list[tuple[int, Imprint]] = []
    for _, index, pixels in sorted(busiest, key=lambda entry: entry[:2], reverse=True):
        try:
            imprint = measure_imprint(
                pixels, scale, dark_on_light=dark_on_light, threshold=threshold, **place
            )
        except ImageError as error:
            reason = str(error)
            continue
        seen.append((-index, imprint))
    if not seen:
        raise ImageError(f"no contact found in any frame: {reason}")
    polarity, _ = Counter(imprint.dark_on_light for _, imprint in seen).most_common(1)[0]
    alike = sorted(
        ((index, imprint) for index, imprint in seen if imprint.dark_on_light == polarity),
        key=lambda entry: entry[1].contrast,
    )
    return Reading(
        settings=alike[len(alike) // 2][1].settings,
        learnt_from=tuple(sorted(index for index, _ in alike)),
        texture=np.array(textures),
    )


def measure_sequence(
    frames: Iterable[Frame],
    scale: Scale,
    *,
    clock: FrameClock | None = None,
    force: ForceSignal | None = None,
    reading: Reading | None = None,
    dark_on_light: bool | None = None,
    threshold: float | None = None,
    watch: Watcher | None = None,
    **place: Unpack[Place],
) -> Iterator[FrameResult]:
    """Measure the contact in each frame of a sequence, one frame in memory at a time.

    The sequence is gone through twice: to learn one reading for all frames, and to measure. A frame that
    cannot be read or shows no contact has a reason instead of measures, and the rest go on. Results before
    the first contact are held back until three frames in a row show one, for their phase and, where the
    clock starts at first contact, for their time.

    Phases come from the force, or where there is none from the texture of the frames, which grows with the
    area in contact. Between the force's and the pictures' first contact a frame counts as loaded.

    Parameters
    ----------
    frames : iterable of Frame
        The sequence, as `open_frames` returns it: it must be possible to go through it twice.
    scale : Scale
        Millimetres per pixel.
    clock : FrameRate or FrameStamps, optional
        Times of the frames on the clock of the force signal. Without it times are NaN.
    force : ForceSignal, optional
        Normal force. A frame outside the signal has load NaN, no phase, and the flag ``no_force``.
    reading : Reading, optional
        What `learn_reading` found; learnt here when None.
    dark_on_light, threshold
        As for `learn_reading`, without `reading`.
    watch : callable, optional
        Called with (index, pixels, imprint) after each measurement, as for drawing overlays.
    **place
        Background, seed, mask and region of interest, as for `measure_imprint`.

    Yields
    ------
    FrameResult

    Raises
    ------
    ImageError
        If no frame can be read, or none shows a contact.
    LoadingError
        If a force is given without a clock.
    """
    if force is not None and clock is None:
        raise LoadingError("a force signal needs the times of the frames: give frames per second, or stamps")
    if reading is None:
        reading = learn_reading(frames, scale, dark_on_light=dark_on_light, threshold=threshold, **place)
    measured = _measured_frames(frames, scale, reading, place, watch)
    yield from _timed(measured, clock, force, _PhaseRecord.of(reading, force))


def _measured_frames(
    frames: Iterable[Frame],
    scale: Scale,
    reading: Reading,
    place: Place,
    watch: Watcher | None,
) -> Iterator[FrameResult]:
    """Measure frame by frame, without time, load or phase."""
    least = _LEAST_TEXTURE * float(np.nanmax(reading.texture))
    for frame in frames:
        if frame.pixels is None:
            yield FrameResult(index=frame.index, readable=False, reason=frame.reason)
            continue
        if _texture(frame.pixels, scale, place) < least:
            reason = "no contact found: the frame is smooth beside those of the largest contact"
            yield FrameResult(index=frame.index, reason=reason)
            continue
        try:
            imprint = _imprint(frame.pixels, scale, reading, place)
        except ImageError as error:
            yield FrameResult(index=frame.index, reason=str(error))
            continue
        if watch is not None:
            watch(frame.index, frame.pixels, imprint)
        yield FrameResult(index=frame.index, measures=imprint.as_record(), flags=imprint.flags)


def _imprint(pixels: Pixels, scale: Scale, reading: Reading, place: Place) -> Imprint:
    """Measure one frame as the whole sequence is read: the only place that hands a reading on."""
    return measure_imprint(pixels, scale, **reading.settings, **place)


def _texture(pixels: Pixels, scale: Scale, place: Place) -> float:
    """Return the power of what is finer than a finger, where the frame is looked at."""
    row, column, last_row, last_column = place.get("region_of_interest") or (0, 0, *pixels.shape)
    part = pixels[max(row, 0) : last_row, max(column, 0) : last_column]
    pixels = part if part.size else pixels  # a region that misses the frame is refused where it is measured
    side = 2 * round(_TEXTURE_WINDOW_MM / scale.mm_per_px / 2) + 1
    values = pixels.astype(np.float32)
    fine = values - cv2.blur(values, (side, side))
    return float(np.mean(fine * fine))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _PhaseRecord:
    """Phases along the force signal, or along the frames themselves."""

    labels: npt.NDArray[np.int8]
    time: FloatArray | None

    @classmethod
    def of(cls, reading: Reading, force: ForceSignal | None) -> "_PhaseRecord":
        if force is not None:
            return cls(labels=phases_of(force.time, force.load), time=force.time)
        index = np.arange(reading.texture.size, dtype=np.float64)
        seen = np.isfinite(reading.texture)
        texture = np.interp(index, index[seen], reading.texture[seen])
        return cls(labels=phases_of(index, texture), time=None)

    def at(self, result: FrameResult, first_contact: int | None) -> Phase | None:
        """Return the phase of a frame whose time is known, None outside the record."""
        if self.time is None:
            if result.index >= self.labels.size:
                return None
            place = result.index
        elif math.isnan(result.load):
            return None
        else:
            place = min(int(np.searchsorted(self.time, result.time)), self.labels.size - 1)
        phase = PHASES[self.labels[place]]
        seen = result.measures is not None and first_contact is not None and result.index >= first_contact
        if seen and phase == "before":
            return "loading"
        return "unloading" if seen and phase == "after" else phase


def _timed(
    results: Iterator[FrameResult],
    clock: FrameClock | None,
    force: ForceSignal | None,
    record: _PhaseRecord,
) -> Iterator[FrameResult]:
    """Give each result its time, load and phase, once the first contact is known."""
    waiting: list[FrameResult] = []
    run = 0
    first_contact: int | None = None
    for result in results:
        if first_contact is not None:
            yield _placed(result, first_contact, clock, force, record)
            continue
        waiting.append(result)
        run = run + 1 if result.measures is not None else 0
        if run == PERSISTENCE:
            first_contact = waiting[-PERSISTENCE].index
            yield from (_placed(held, first_contact, clock, force, record) for held in waiting)
            waiting.clear()
    yield from (_placed(held, None, clock, force, record) for held in waiting)


def _placed(
    result: FrameResult,
    first_contact: int | None,
    clock: FrameClock | None,
    force: ForceSignal | None,
    record: _PhaseRecord,
) -> FrameResult:
    time = math.nan if clock is None else clock.time_of(result.index, first_contact)
    load = math.nan if force is None else float(force.load_at(time))
    doubts = {
        "no_time": clock is not None and math.isnan(time),
        "no_force": force is not None and math.isnan(load),
    }
    flags = (*result.flags, *(flag for flag, doubted in doubts.items() if doubted))
    placed = replace(result, time=time, load=load, flags=flags)
    return replace(
        placed,
        phase=record.at(placed, first_contact),
        is_first_contact=first_contact is not None and result.index == first_contact,
    )
