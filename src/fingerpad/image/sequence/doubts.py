"""What is doubtful in a sequence: whether areas, force and times of its frames go together."""

import math
from collections.abc import Iterator, Mapping
from typing import Final, NamedTuple

import numpy as np
from scipy.ndimage import rank_filter

from fingerpad._arrays import BoolArray, FloatArray, as_float_array, robust_std
from fingerpad._plausible import unit_doubts
from fingerpad._words import joined
from fingerpad.image.sequence.force import ForceSignal, FrameClock, FrameRate, level_before_contact

_MIN_FRAMES_TO_COMPARE = 8  # with fewer contacts nothing is said of how area and force go together
_MIN_CORRELATION = 0.5
_MIN_LOAD_SHARE = 0.1  # of the largest force; a sequence that stays below it is timed wrongly, or cut
# After the contact the force is doubted above this share of the largest, and above the load of first contact,
_LEFT_LOAD_SHARE = 0.05
_FRAMES_LEFT = 3  # in so many frames in a row: one may be that in which the pad leaves
_SURELY_SEEN: Final = 0.05  # of the largest area
_SPANS_APART = 100.0  # times of force and frames that differ by such a factor may be in different units
# A jump exceeds what the changes around it lead to expect.
_LEAST_JUMP: Final = 0.07  # by this share of the area,
_DEVIATIONS: Final = 6.0  # by so many times the scatter of such excesses,
_TIMES_EXPECTED: Final = 1.5  # and by so many times what is expected
_LASTING: Final = 0.7  # of it; the least of three areas after it exceeds the largest of three before by this
_MIN_TESTED: Final = 4
_HERTZ: Final = 2 / 3
_COMPARED: Final = 0.2  # of the largest force; with less, a wrong zero matters
# A pad that is held creeps, and says nothing of how area and force go together.
_HELD_LOAD, _HELD_AREA = 0.1, 0.2  # of the largest; both change by less
# Areas under no force, large and alike, are of a print, or of a finger under which the force was zeroed.
_NO_LOAD, _ALIKE = 0.01, 0.1  # of the largest load, and of their median
_LEFT_AREA = (0.25, 0.9)  # of the largest area; one that is held has all of it
_COARSE: Final = 0.1  # of the largest load; with more from frame to frame first contact is a poor clock
_LEAST_PRESSURE_KPA: Final = 0.1  # mean, under the largest load; skin of 5 kPa has some ten times as much
_GAP: Final = 10.0  # times the usual interval of samples
# A force that saturates repeats its largest value though it is noisy elsewhere.
_REPEATS: Final = 10  # samples in a row
_MOST_EQUAL: Final = 0.5  # of the others, equal to the one before: more shows coarse steps,
_LEAST_TURNS: Final = 0.1  # and turning from rise to fall or back: fewer show no noise
_LEAST_OFF: Final = 0.15  # of the area; by more it is outside those beside it where frames are exchanged


class LoadedFrames(NamedTuple):
    """The frames of a sequence under a known load, or those of them in contact."""

    frame: FloatArray
    time: FloatArray  # s
    load: FloatArray  # N
    area: FloatArray  # mm², 0 without contact
    direction: FloatArray  # 1 while loading, −1 while unloading, else 0


def doubts_of(
    loaded: LoadedFrames,
    counts: Mapping[str, int],
    span: tuple[float, float],
    first_contact: int | None,
    *,
    clock: FrameClock | None,
    force: ForceSignal | None,
) -> tuple[list[str], bool]:
    """Return what is doubtful in a sequence, and whether its areas are in step with its force.

    `counts` tell how many frames there are in `all`, and with `no_force`; `span` is from the first frame's
    time to the last one's.
    """
    touching = np.flatnonzero(loaded.area > 0)
    contacts = LoadedFrames(*(values[touching] for values in loaded))
    doubts: list[str] = []
    if clock is not None:
        doubts += _clock_doubts(clock, counts["all"], first_contact, contacts)
    if force is not None:
        doubts += _spans_apart(force, span, counts)
        first, last = (touching[0], touching[-1]) if touching.size else (0, -1)
        doubts += _off_zero(contacts, loaded.load[:first], loaded.load[last + 1 :], force)
        doubts += _signal_doubts(contacts, force)
        doubts += unit_doubts(force.load, force.displacement)
    reason = _out_of_step(contacts, force)
    doubts += _unlike_others(contacts) if reason is None else [reason]
    return doubts, reason is None


def _area_follows_load(loads: FloatArray, areas: FloatArray) -> bool:
    """Return whether the area follows the load, by the larger of two correlations.

    In a long hold the ranks of the load are those of its noise; one outlier is enough for the linear one.
    With nothing but a hold, nothing tells that it does not.
    """
    if np.ptp(loads) < _HELD_LOAD * loads.max() and np.ptp(areas) < _HELD_AREA * areas.max():
        return True
    if not (np.ptp(loads) > 0 and np.ptp(areas) > 0):
        return False
    from scipy import stats  # noqa: PLC0415 (slow to import, seldom needed)

    of_ranks, _ = stats.spearmanr(loads, areas)
    return bool(max(of_ranks, np.corrcoef(loads, areas)[0, 1]) > _MIN_CORRELATION)


def find_jump(time: FloatArray, load: FloatArray, area: FloatArray, loading: BoolArray) -> int | None:
    """Return the frame in contact after which the area jumps up while the load does not; None without one.

    All frames after lost ones are late by as much, and their areas too large for their loads. Each change
    between two `loading` frames is compared with the mean rate of the two before and the two after it; where
    the load grows faster than at its own mean rate, by Hertz theory, so may the area.
    """
    if time.size < _MIN_TESTED + 5 or not load.max() > 0:
        return None
    tested, apart = np.arange(2, time.size - 3), np.diff(time)
    around = tested + np.array([[-2], [-1], [1], [2]])

    def usual_of(changes: FloatArray) -> FloatArray:
        """Return what is expected of each change from those around it."""
        return as_float_array(np.mean((changes / apart)[around], axis=0) * apart[tested])

    by_load = area.max() * (np.maximum(load, 0) / load.max()) ** _HERTZ
    grown, driven = np.diff(area), np.diff(by_load)
    middle = (area[tested] + area[tested + 1]) / 2
    faster = np.maximum(driven[tested] - usual_of(driven), 0)
    excess = (grown[tested] - usual_of(grown) - faster) / middle
    expected = usual_of(np.abs(grown)) / middle
    before, after = (np.log(area)[tested + np.array(near)[:, None]] for near in ([-2, -1, 0], [1, 2, 3]))
    both = loading[tested] & loading[tested + 1]
    if np.count_nonzero(both) < _MIN_TESTED:
        return None
    scatter = robust_std(excess - np.median(excess))
    least = np.maximum(max(_LEAST_JUMP, _DEVIATIONS * scatter), _TIMES_EXPECTED * expected)
    jumps = both & (excess > least) & (after.min(axis=0) - before.max(axis=0) > _LASTING * excess)
    return int(tested[np.argmax(np.where(jumps, excess, -np.inf))]) if jumps.any() else None


def _out_of_step(contacts: LoadedFrames, force: ForceSignal | None) -> str | None:
    """Return why frames in contact are not in step with the force, None where nothing tells."""
    frames, times, loads, areas, loading = contacts
    if areas.size < _MIN_FRAMES_TO_COMPARE:
        return None
    idle = areas[loads < _NO_LOAD * loads.max()]
    usual = float(np.median(idle)) if idle.size >= _FRAMES_LEFT else 0.0
    least, most = (share * areas.max() for share in _LEFT_AREA)
    if least < usual < most and np.ptp(idle) < _ALIKE * usual:
        return (
            f"{idle.size} frames show {usual:.3g} mm² under no force, all alike: was a print left on the "
            "plate or in the background, which counts in all areas, or the force zeroed under the finger?"
        )
    reach = 0.0 if force is None else _MIN_LOAD_SHARE * float(force.load.max())
    if loads.max() < reach or not _area_follows_load(loads, areas):
        return (
            "area and force do not rise and fall together: check frame rate, trigger, force file and its "
            "sign, and that no print stays on the plate"
        )
    jump = find_jump(times, loads, areas, loading > 0)
    if jump is None:
        return None
    place = slice(jump, jump + 2)
    (first, then), (below, above), (small, large) = frames[place], loads[place], areas[place]
    return (
        f"from frame {first:.0f} to {then:.0f} the area grows by {100 * (large / small - 1):.0f} %, unlike "
        f"before and after, the force from {below:.3g} to {above:.3g} N: where frames are lost between them, "
        "all that follow have the load of an earlier time: give the frames' own times (times, or --times)"
    )


def _off_neighbours(values: FloatArray) -> FloatArray:
    """Return by how much each value lies outside the two before and the two after it, where it does."""
    second, last_but_one = (rank_filter(values, rank, size=5) for rank in (1, -2))
    return as_float_array(np.maximum(second - values, values - last_but_one))


def _unlike_others(contacts: LoadedFrames) -> Iterator[str]:
    """Yield what no finger does with its area from frame to frame, or while it is unloaded."""
    frames, _, loads, areas, phases = contacts
    if unloaded := np.count_nonzero(loads <= 0):
        yield (
            f"{unloaded} of {loads.size} frames show contact while the force is not above zero: check "
            "trigger, frame rate and zero of the force"
        )
    if areas.size < _MIN_FRAMES_TO_COMPARE:
        return
    grown, ordered = np.log(areas), np.log(areas)
    odd = np.flatnonzero(_off_neighbours(grown) > _LEAST_OFF)
    ordered[odd[np.argsort(loads[odd])]] = np.sort(grown[odd])
    # Outliers of any other kind, and turning points, are no better in each other's place.
    if odd.size and _off_neighbours(ordered)[odd].max() < _LEAST_JUMP:
        yield (
            f"the areas of frames {joined((f'{frame:.0f}' for frame in frames[odd]), 6)} are far off those "
            "before and after, and would fit in each other's place: are these frames exchanged?"
        )
        return
    up = sorted(np.flatnonzero((phases > 0) & (loads > 0)), key=loads.item)
    if not up:
        return
    down = (phases < 0) & (loads > max(_COMPARED * loads.max(), loads[up[0]]))
    larger = grown[down] - np.interp(np.log(loads[down]), np.log(loads[up]), grown[up])
    # Areas lag behind the force, and those of a held pad grow.
    if larger.size >= _MIN_TESTED and np.quantile(larger, 0.75) < -_LEAST_JUMP:
        yield (
            f"areas are {-100 * math.expm1(np.median(larger)):.0f} % smaller while unloading than while "
            "loading under the same force, as of no finger: are frames early, or does the force come late or "
            "drift?"
        )


def _off_zero(
    contacts: LoadedFrames, before: FloatArray, after: FloatArray, force: ForceSignal
) -> Iterator[str]:
    """Yield what was subtracted from the force of frames in contact, and what it is beside them.

    `before` and `after` are the loads of the frames before the first in contact and after the last.
    """
    if not contacts.area.size:
        return
    _, times, loads, areas, _ = contacts
    zero = float(force.load_at(times[0]) - loads[0])
    if level := zero or max(0.0, level_before_contact(force, force.time[force.time < times[0]])):
        done = "was subtracted from" if zero else "may be a touch too light to be seen, and is kept in"
        yield (
            f"the force was {level:.2g} N before first contact, which {done} all loads: tare the "
            "sensor before a press"
        )
    least = _LEFT_LOAD_SHARE * float(loads.max())
    # The area grows no faster than in proportion to the load: so large a contact would have been seen.
    # A clock that starts at first contact is late by up to one frame.
    unseen = float(before[-2]) if before.size > 1 else 0.0
    if unseen > least and areas[0] * unseen / max(unseen, loads[0]) > _SURELY_SEEN * areas.max():
        yield (
            f"under {unseen:.2g} N the last but one frame before contact shows none, the first in contact "
            f"{areas[0]:.3g} mm² under {loads[0]:.2g} N: are frames late, or is contact_load_N or the "
            "zero of the force wrong?"
        )
    if after.size < _FRAMES_LEFT:
        return
    # What begins in contact does not show the load of first contact.
    left = max(least, abs(float(loads[0])) if before.size else 0.0)
    if np.lib.stride_tricks.sliding_window_view(np.abs(after), _FRAMES_LEFT).min(axis=-1).max() > left:
        yield (
            f"after the last frame in contact the force is {np.median(after[:_FRAMES_LEFT]):.2g} N, and "
            f"{np.median(after[-_FRAMES_LEFT:]):.2g} N at the end, where it should be zero: does it drift or "
            "come late, is the frame rate wrong, or are frames lost? Loads may be wrong by as much"
        )


def _signal_doubts(contacts: LoadedFrames, force: ForceSignal) -> Iterator[str]:
    """Yield where a force has gaps, saturates, or is too small for the areas of frames in contact."""
    times, largest, top = contacts.time, contacts.area.max(initial=0.0), float(force.load.max())
    steps, moves = np.diff(force.time), np.diff(force.load)
    for gap in np.flatnonzero(steps > _GAP * np.median(steps)):
        low, high = force.time[gap], force.time[gap + 1]
        if inside := np.count_nonzero((times > low) & (times < high)):
            yield (
                f"the force has no samples between {low:.4g} and {high:.4g} s: the loads of {inside} frames "
                "in contact there are interpolated"
            )
    at_top = np.flatnonzero(np.diff(np.pad(force.load == top, 1).astype(np.int8)))
    longest = int(np.max(at_top[1::2] - at_top[::2]))
    others = moves[(force.load[1:] < top) & (force.load[:-1] < top)]
    if (
        longest >= _REPEATS
        and others.size
        and np.mean(others == 0) < _MOST_EQUAL
        and np.mean(others[1:] * others[:-1] < 0) > _LEAST_TURNS
    ):
        yield (
            f"the force stays at its largest value, {top:.4g} N, for {longest} samples without any noise: "
            "does the sensor or its amplifier saturate? Loads there are too small"
        )
    if largest and 1000 * top < _LEAST_PRESSURE_KPA * largest:
        yield f"loads up to {top:.2g} N on {largest:.0f} mm² are tiny: is the force in newtons (force_N)?"


def _spans_apart(force: ForceSignal, frames: tuple[float, float], counts: Mapping[str, int]) -> Iterator[str]:
    """Yield how force and frames differ in the time they take, where that matters."""
    (low, high), (start, end) = force.span, frames
    lasting, shown = high - low, max(0.0, end - start)
    if counts["no_force"]:
        yield (
            f"the force lasts {lasting:.4g} s (from {low:.4g} to {high:.4g} s), the frames {shown:.4g} s "
            f"(from {start:.4g} to {end:.4g} s): {counts['no_force']} of {counts['all']} frames have no load"
        )
    if shown and not 1 / _SPANS_APART < lasting / shown < _SPANS_APART:
        yield (
            f"the force lasts {lasting:.4g} s and the frames {shown:.4g} s: is one of their times in another "
            "unit, as milliseconds (time_ms)?"
        )


def _clock_doubts(
    clock: FrameClock, count: int, first_contact: int | None, contacts: LoadedFrames
) -> Iterator[str]:
    """Yield what may be wrong with the times of frames, by their number and the first in contact."""
    if isinstance(clock, FrameRate):
        loads = contacts.load
        growth = np.diff(loads[contacts.direction > 0])
        if clock.anchor_frame is None and growth.size and np.median(growth) > _COARSE * loads.max():
            yield (
                f"first contact, which starts the clock, is known to one frame, and the force grows by "
                f"{np.median(growth):.2g} N in it: give a trigger, start_s or times"
            )
        if clock.anchor_frame is None and first_contact == 0:
            yield (
                "the first frame is in contact already, so that the frame in which the force passes "
                "contact_load_N is not known: give start_s"
            )
    elif clock.time.size != count:
        yield (
            f"there are {clock.time.size} times for {count} frames, given to them in order: unless only the "
            "last are missing or too many, loads are those of other times"
        )
