"""Sequences: a pad pressed and released, measured against the truth of every frame."""

import math
from dataclasses import replace

import numpy as np
import pytest
import tifffile

from fingerpad.exceptions import ImageError, LoadingError
from fingerpad.image import (
    ForceSignal,
    Frame,
    FrameRate,
    FrameResult,
    FrameStamps,
    Scale,
    assign_times,
    estimate_settings,
    frame_clock,
    measure_sequence,
    open_frames,
    scan_texture,
    sequence_summary,
)
from fingerpad.image.sequence.doubts import find_jump
from fingerpad.image.sequence.force import zero_before_contact
from fingerpad.simulate import render_sequence

FPS, CONTACT = 20.0, 8
CORNERS, LOADS = [0, 0.4, 1.2, 1.8, 2.4, 3.0], [0, 0, 1.5, 1.5, 0, 0]
TIME = np.arange(49) / FPS
SCALE = Scale.of_ppi(300)


def true_load(time):
    return np.interp(time, CORNERS, LOADS)


@pytest.fixture(scope="module")
def press():
    return render_sequence(true_load(TIME), seed=3)


@pytest.fixture(scope="module")
def frames(press, tmp_path_factory):
    path = tmp_path_factory.mktemp("frames") / "press.tif"
    tifffile.imwrite(path, np.stack([press.pixels(k) for k in range(TIME.size)]), photometric="minisblack")
    return open_frames(path)


@pytest.fixture(scope="module")
def signal():
    time = np.arange(-0.2, 4, 0.001)
    noise = np.random.default_rng(0).normal(0, 0.004, time.size)
    return ForceSignal(time, true_load(time) + noise, np.where(time > 0, 5.0, 0.0))


@pytest.fixture(scope="module")
def settings(frames):
    return estimate_settings(frames, SCALE)


@pytest.fixture(scope="module")
def results(frames, signal, settings):
    clock = frame_clock(FPS, signal)
    return list(measure_sequence(frames, SCALE, clock=clock, force=signal, settings=settings))


def test_area_accuracy(results, press):
    errors = [
        result.measures["gross_area_mm2"] / press.gross_area[result.index] - 1
        for result in results
        if result.measures
    ]
    assert len(errors) > 30
    assert np.quantile(np.abs(errors), 0.95) < 0.015
    assert np.std(errors) < 0.008


def test_times_loads_and_phases_of_frames(results):
    np.testing.assert_allclose([r.time for r in results], TIME, atol=1e-3)
    np.testing.assert_allclose([r.load for r in results], true_load(TIME), atol=0.02)
    expected = [(0.2, "before"), (0.8, "loading"), (1.5, "hold"), (2.1, "unloading")]
    assert [results[round(FPS * time)].phase for time, _ in expected] == [phase for _, phase in expected]


def test_phases_from_texture(frames, settings, results):
    watched = []
    blind = list(
        measure_sequence(
            frames, SCALE, settings=settings, watch=lambda k, _, image: watched.append((k, image.gross_area))
        )
    )
    assert watched == [(one.index, one.measures["gross_area_mm2"]) for one in blind if one.measures]
    same = [one.phase == other.phase for one, other in zip(blind, results, strict=True)]
    assert np.mean(same) > 0.9
    assert all(math.isnan(result.time) and math.isnan(result.load) for result in blind)
    assert not any("no_force" in result.flags for result in blind)


def test_first_contact_and_summary(results, signal):
    summary = sequence_summary(results, signal)
    assert summary.first_contact in {CONTACT + 1, CONTACT + 2}
    assert [r.index for r in results if r.is_first_contact] == [summary.first_contact]
    assert summary.count == TIME.size
    assert summary.measured + summary.without_contact == TIME.size
    assert true_load(TIME[summary.largest]) == pytest.approx(1.5)
    assert summary.notes == ()


def test_pictures_contradicting_force(results, signal):
    assert sequence_summary(results, signal).notes == ()
    late = [replace(result, load=4.0 - result.load) for result in results]
    slow = [replace(result, load=0.01 * result.load) for result in results]
    for wrong in (late, slow):
        *_, note = sequence_summary(wrong, signal).notes
        assert "area and force do not rise and fall together" in note


def test_contact_without_force_is_noted(results, signal):
    offset = [replace(result, load=result.load - 0.2) for result in results]
    *_, note = sequence_summary(offset, signal).notes
    assert "frames show contact while the force is not above zero" in note


@pytest.mark.parametrize("zero", [0.05, -0.1])
def test_the_level_of_the_force_before_contact_is_subtracted(frames, settings, signal, results, zero):
    offset = ForceSignal(signal.time, signal.load + zero)
    clock = FrameRate(FPS)
    shifted = list(measure_sequence(frames, SCALE, clock=clock, force=offset, settings=settings))
    np.testing.assert_allclose([r.load for r in shifted], [r.load for r in results], atol=0.01)
    assert [r.phase for r in shifted] == [r.phase for r in results]
    (note,) = sequence_summary(shifted, offset).notes
    assert note.startswith(f"the force was {zero:.2g} N before first contact, which was subtracted")


@pytest.mark.parametrize(
    ("level", "area"),
    [
        (lambda time: 0.003 + 0 * time, [2, 5, 8]),  # does not matter
        (lambda time: 0.1 * time, [2, 5, 8]),  # drifts
        (lambda time: 0.01 + 0 * time, [2.0, 2.1, 2.2]),  # may be a touch too light to be seen
        (lambda time: np.where(time > 2.5, 0, 1.5), [2, 5, 8]),  # a hold
        (lambda time: np.where(time < 0.7, 0, time - 0.7), [2, 5, 8]),  # a touch not yet seen
    ],
)
def test_what_may_be_no_zero_of_the_force_is_kept(level, area):
    time = np.arange(0, 3, 0.01)
    load = np.where(time < 1, level(time), level(time) + np.clip(time - 1, 0, 1))
    force = ForceSignal(time, load + np.random.default_rng(1).normal(0, 0.002, time.size))
    before, during = np.arange(10) / 10, np.array([1.0, 1.1, 1.2])
    assert zero_before_contact(force, before, during, np.array(area)) == 0


def test_short_force_flagged(frames, settings, signal):
    short = ForceSignal(*(values[signal.time < 1.02] for values in (signal.time, signal.load)))
    covered = list(measure_sequence(frames, SCALE, clock=FrameRate(FPS), force=short, settings=settings))
    for result in covered:
        outside = result.time > 1.02
        assert ("no_force" in result.flags) == outside == math.isnan(result.load)
        assert (result.phase is None) == outside
    assert covered[30].measures is not None
    (note,) = sequence_summary(covered, short).notes
    assert "the force lasts 1.219 s" in note
    assert "the frames 2.4 s" in note
    assert "28 of 49 frames" in note


def test_unreadable_frames_have_reason(frames, settings):
    class Damaged:
        def __iter__(self):
            for frame in frames:
                bad = frame.index in {20, 21}
                yield Frame(index=frame.index, pixels=None, reason="torn") if bad else frame

    damaged = list(measure_sequence(Damaged(), SCALE))
    assert [r.index for r in damaged if not r.readable] == [20, 21]
    assert damaged[20].reason == "torn"
    assert damaged[22].measures is not None
    summary = sequence_summary(damaged)
    assert summary.failed == 2
    assert "first frame 20: torn" in summary.notes[0]


def test_settings_from_largest_contact(settings, press):
    assert settings.settings["dark_on_light"]
    assert (press.load[list(settings.learnt_from)] > 1.2).all()
    assert settings.texture[:CONTACT].max() < 0.3 * settings.texture.max()


def test_settings_have_the_polarity_of_most_frames(press):
    dark = [press.pixels(k) for k in (28, 29, 30)]
    frames = [Frame(index=k, pixels=pixels) for k, pixels in enumerate([*dark, 255 - dark[0]])]
    found = estimate_settings(frames, SCALE)
    assert found.settings["dark_on_light"]
    assert found.learnt_from == (0, 1, 2)


def test_border_looked_for_in_key_frames(press, frames, settings):
    assert settings.settings["added_border"] is False
    bordered = [replace(frame, pixels=np.pad(frame.pixels, 40, constant_values=255)) for frame in frames]
    assert estimate_settings(bordered[::4], SCALE).settings["added_border"]
    kept = estimate_settings(bordered[::4], SCALE, added_border=False)
    assert kept.settings["added_border"] is False
    # A contact at the side of what was there before the border is cut.
    cut = replace(bordered[30], pixels=np.pad(frames.at(30).pixels[:, 90:], 40, constant_values=255))
    look = estimate_settings(bordered[::4], SCALE)
    assert "touches_border" in next(measure_sequence([cut], SCALE, settings=look)).flags


def test_faint_contact_refused(press, frames, settings):
    whole = press.pixels(30)
    ground = np.median(whole)
    faint, thin = (np.uint8(ground - share * (ground - whole)) for share in (0.25, 0.7))
    sequences = [[Frame(index=0, pixels=pixels)] for pixels in (faint, thin)]
    # With settings of its own even the faint frame passes for a contact.
    assert next(measure_sequence(sequences[0], SCALE)).measures
    refused, kept = (next(measure_sequence(sequence, SCALE, settings=settings)) for sequence in sequences)
    assert refused.measures is None
    assert kept.measures["gross_area_mm2"] == pytest.approx(press.gross_area[30], rel=0.01)


def test_first_contact_persists(press):
    order = [0, 0, 30, 0, 0, 28, 29, 30, 31]
    frames = [Frame(index=k, pixels=press.pixels(at)) for k, at in enumerate(order)]
    assert sequence_summary(measure_sequence(frames, SCALE)).first_contact == 5


@pytest.mark.parametrize(
    ("frames", "words"),
    [
        ([], "no frame can be read"),
        ([Frame(index=0, pixels=None, reason="torn")], "no frame can be read: torn"),
        ([Frame(index=0, pixels=np.zeros((90, 90), np.uint8))] * 3, "no contact found in any frame"),
        ([Frame(index=0, pixels=np.zeros((1, 1), np.uint8))], "1 × 1 px is too small"),
    ],
)
def test_sequence_without_contact_refused(frames, words):
    with pytest.raises(ImageError, match=words):
        list(measure_sequence(frames, SCALE))


def test_a_mask_or_region_within_the_contact_is_named(press):
    at_most = press.pixels(int(np.argmax(LOADS[2] == true_load(TIME))))
    row, column = (size // 2 for size in at_most.shape)
    inside = (row - 20, column - 20, row + 20, column + 20)
    with pytest.raises(ImageError, match="mask and region of interest must hold a contact and some of what"):
        list(measure_sequence([Frame(index=0, pixels=at_most)], SCALE, region_of_interest=inside))


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"clock": 20.0}, "clock must be a FrameRate"),
        ({"clock": FrameRate(FPS), "phases": "loading"}, "phases must be PhaseIntervals"),
        ({"force": "force.csv"}, "force must be a ForceSignal, as read_force_signal reads it, found str"),
    ],
)
def test_a_number_for_the_clock_and_a_path_for_the_force_are_refused_in_words(frames, signal, wrong, words):
    with pytest.raises(LoadingError, match=words):
        measure_sequence(frames, SCALE, **{"clock": FrameRate(FPS), "force": signal, **wrong})


def test_texture_beside_the_mask_and_of_the_background_is_no_contact():
    time = np.arange(30) / 10
    press = render_sequence(np.interp(time, [0, 0.5, 1, 2, 2.5, 3], [0, 0, 2, 2, 0, 0]), seed=4)
    rows, columns = press.pixels(0).shape
    label = np.kron(np.indices((rows // 8, 5)).sum(axis=0) % 2, np.ones((8, 8)))[:rows] * 200
    dirt = 255 - 120 * (np.random.default_rng(1).random((rows, columns)) > 0.7)
    mask = np.ones((rows, columns + 40), bool)
    mask[:, :40] = False
    bare = [press.pixels(k) for k in range(time.size)]
    flickering, soiled = [], []
    for k, pixels in enumerate(bare):
        beside = np.full((rows, 40), 255.0)
        beside[: len(label)] -= label * (k % 3 == 0)
        flickering.append(np.hstack([beside, pixels]).astype(np.uint8))
        soiled.append((pixels * (dirt / 255)).astype(np.float32))
    truth = textures(bare)
    assert textures(flickering, mask=mask) == pytest.approx(truth, rel=0.02, abs=1e-3 * truth.max())
    # Where there is no contact, what is left is noise: dirt that the background shows is divided out.
    soiled = textures(soiled, background=dirt)
    assert soiled == pytest.approx(truth, rel=0.2, abs=0.02 * truth.max())


def textures(pictures, **place):
    frames = [Frame(index=k, pixels=pixels) for k, pixels in enumerate(pictures)]
    return scan_texture(frames, SCALE, **place).texture


def ramp(kind, *, noise, rng, rate=12.0, late=0.0, lost=slice(0)):
    """Return times, loads, areas and loading of the frames in contact of a press, `lost` ones left out."""
    time = np.arange(0, 9, 1 / rate)
    corners, loads = {
        "press": ([1, 4, 6, 8], [0, 2, 2, 0]),
        "cycles": ([1, 2.5, 3, 4, 4.3, 5.8, 6.3, 7.3], [0, 2, 2, 0, 0, 2, 2, 0]),
        "steps": ([1, 2, 3, 4, 5, 6, 7], [0, 0.5, 0.5, 1, 1, 2, 2]),
    }[kind]
    area = 60 * np.interp(time, corners, loads) ** (2 / 3) * np.exp(rng.normal(0, noise, time.size))
    area = np.delete(area, lost)
    shown = time[: area.size]
    load = np.interp(shown - late, corners, loads) + rng.normal(0, 0.003, shown.size)
    seen = area > 3
    loading = np.gradient(np.interp(shown - late, corners, loads)) > 0
    return shown[seen], load[seen], area[seen], loading[seen]


@pytest.mark.parametrize("kind", ["press", "cycles", "steps"])
@pytest.mark.parametrize("late", [0.0, 0.1, -0.2, 0.5])
def test_undisturbed_presses_have_no_jump(kind, late):
    rng = np.random.default_rng(4)
    for noise in (0.003, 0.01, 0.02, 0.04):
        for _ in range(5):
            assert find_jump(*ramp(kind, noise=noise, rng=rng, late=late)) is None


@pytest.mark.parametrize(("lost", "late"), [(3, 0.0), (4, 0.1), (6, -0.1)])
def test_lost_frames_of_a_ramp_are_a_jump(lost, late):
    rng = np.random.default_rng(4)
    for first in range(18, 30):
        time, load, area, loading = ramp(
            "press", noise=0.005, rng=rng, late=late, lost=slice(first, first + lost)
        )
        jump = find_jump(time, load, area, loading)
        assert jump is not None
        assert round(12 * time[jump]) == first - 1


def test_lost_frames_are_noted_and_flagged(results, signal):
    contacts = [result for result in results if result.measures]
    lost = contacts[:5] + [
        replace(late, time=early.time, load=early.load, phase=early.phase)
        for early, late in zip(contacts[5:], contacts[8:], strict=False)
    ]
    assert sequence_summary(contacts, signal).flags == ()
    summary = sequence_summary(lost, signal)
    assert summary.flags == ("out_of_step",)
    assert f"from frame {contacts[4].index} to {contacts[8].index} the area grows by" in summary.notes[0]


def with_force(results, load):
    """Return results, and half a second of empty frames after them, with the loads that `load` gives."""
    last = results[-1]
    empty = [FrameResult(index=last.index + k, time=last.time + k / FPS) for k in range(1, 11)]
    return [replace(result, load=float(load(result.time))) for result in [*results, *empty]]


@pytest.mark.parametrize(
    ("load", "noted"),
    [
        (true_load, False),
        (lambda time: true_load(time - 0.15), True),
        (lambda time: true_load(time / 1.1), True),
        (lambda time: true_load(time) + 0.05 * time, True),
        (lambda time: true_load(time) - 0.05 * time, True),
    ],
)
def test_a_force_that_is_left_after_the_contact_is_noted(results, signal, load, noted):
    summary = sequence_summary(with_force(results, load), signal)
    assert any("after the last frame in contact" in note for note in summary.notes) == noted
    assert summary.flags == ()


def test_a_force_that_is_left_after_a_contact_that_the_frames_begin_in_is_noted(results, signal):
    seen = with_force(results, lambda time: true_load(time) + 0.1)[CONTACT + 10 :]
    assert "after the last frame in contact the force is 0.1 N" in sequence_summary(seen, signal).notes[-1]


@pytest.mark.parametrize(("late", "noted"), [(0.0, False), (1 / FPS, False), (0.15, True), (0.3, True)])
def test_a_force_without_a_contact_is_noted(results, signal, late, noted):
    summary = sequence_summary(with_force(results, lambda time: true_load(time + late)), signal)
    assert any("the last but one frame before contact shows none" in note for note in summary.notes) == noted


def test_a_print_left_on_the_plate_is_noted_and_flagged(results, signal):
    most = max(one.measures["gross_area_mm2"] for one in results if one.measures)

    def with_print(share, growth=0.0):
        seen = zip(range(len(results)), results, strict=True)
        least = {k: share * most * (1 + growth * k) for k in range(len(results))}
        areas = {k: max(least[k], (one.measures or {}).get("gross_area_mm2", 0)) for k, one in seen}
        return [replace(one, measures={"gross_area_mm2": areas[k]}) for k, one in enumerate(results)]

    left = sequence_summary(with_print(0.5), signal)
    assert "mm² under no force, all alike: was a print left on the plate" in left.notes[-1]
    assert left.flags == ("out_of_step",)
    for other in (with_print(0.1), with_print(0.95), with_print(0.3, growth=0.02)):
        assert "all alike" not in " ".join(sequence_summary(other, signal).notes)


def test_a_clock_by_first_contact_is_noted_where_the_force_grows_fast(results):
    clock = FrameRate(FPS, anchor_frame=None)
    assert sequence_summary(results, clock=clock).notes == ()
    (note,) = sequence_summary(results[::3], clock=clock).notes
    assert (
        "first contact, which starts the clock, is known to one frame, and the force grows by 0.28 N" in note
    )


def test_a_hold_alone_is_in_step(results, signal):
    held = [one for one in results if one.phase == "hold"]
    assert len(held) > 8
    assert sequence_summary(held, signal).flags == ()
    assert sequence_summary([replace(one, load=1.5) for one in results if one.measures], signal).flags


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda time, load: (time[abs(time - 1) > 0.2], load[abs(time - 1) > 0.2]), "has no samples between"),
        (lambda time, load: (time, np.minimum(load, 1.0)), "its largest value, 1 N, for"),
        (lambda time, load: (time, load / 1000), "is the force in newtons"),
        (lambda time, load: (time[::40], load[::40]), None),
        (lambda time, load: (time, np.round(load / 0.05) * 0.05), None),  # coarse steps are equal in a hold
        (lambda time, load: (time, true_load(time)), None),  # without noise as well
    ],
)
def test_gaps_and_limits_of_a_force_are_noted(results, signal, change, words):
    force = ForceSignal(*change(signal.time, signal.load))
    doubts = ("has no samples between", "its largest value, 1 N, for", "is the force in newtons")
    notes = " ".join(sequence_summary(results, force).notes)
    assert [one for one in doubts if one in notes] == ([words] if words else [])


def test_times_that_may_not_be_those_of_the_frames_are_noted(results):
    few, no_first = FrameStamps(TIME[:-1]), FrameRate(FPS, anchor_frame=None)
    (note,) = sequence_summary(results, clock=few).notes
    assert "there are 48 times for 49 frames" in note
    assert sequence_summary(results, clock=FrameStamps(TIME)).notes == ()
    assert sequence_summary(results, clock=no_first).notes == ()
    seen = [replace(one, index=k) for k, one in enumerate(results[CONTACT + 5 :])]
    (note,) = sequence_summary([replace(seen[0], is_first_contact=True), *seen[1:]], clock=no_first).notes
    assert "the first frame is in contact already" in note


@pytest.mark.parametrize("kind", ["noise", "hum", "step", "pulses"])
def test_a_trigger_rises_from_one_level_to_another(kind):
    time = np.arange(0, 2, 0.001)
    noise = np.random.default_rng(1).normal(0, 0.02, time.size)
    high = {
        "noise": np.full(time.size, 5.0),
        "hum": np.sin(100 * np.pi * time),
        "step": np.where(time > 0.5, 5.0, 0.0),
        "pulses": np.where((time > 0.5) & (time % 0.02 < 0.005), 5.0, 0.0),
    }[kind]
    signal = ForceSignal(time, time, high + noise)
    if kind in {"noise", "hum"}:
        with pytest.raises(LoadingError, match="the trigger never rises"):
            frame_clock(FPS, signal)
    else:
        assert frame_clock(FPS, signal).anchor_time == pytest.approx(0.5, abs=0.002)


def test_the_force_before_the_frames_shows_its_zero(results, signal):
    offset, seen = ForceSignal(signal.time, signal.load + 0.05), results[CONTACT - 1 :]  # few are empty
    shifted = list(assign_times(seen, np.empty(0), clock=FrameRate(FPS), force=offset))
    np.testing.assert_allclose([one.load for one in shifted], [one.load for one in seen], atol=0.01)


@pytest.mark.parametrize(
    ("of_frame", "late", "words"),
    [
        ({14: 20, 20: 14}, 0.0, "the areas of frames 14 and 20 are far off"),
        ({}, 0.1, "smaller while unloading"),
        ({}, -0.1, None),  # as areas that lag behind
    ],
)
def test_areas_that_no_finger_has_are_noted(results, of_frame, late, words):
    odd = [
        replace(one, measures=results[of_frame.get(k, k)].measures, load=float(true_load(one.time - late)))
        for k, one in enumerate(results)
    ]
    notes = sequence_summary(odd).notes
    assert words in notes[-1] if words else not any("areas" in note for note in notes)
