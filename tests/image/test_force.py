"""Force signals and frame clocks: interpolation, alignment, and everything a signal can have wrong."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingerpad.exceptions import LoadingError
from fingerpad.image import (
    ForceSignal,
    FrameRate,
    FrameStamps,
    alignment_scatter,
    frame_clock,
    read_force_signal,
    read_frame_stamps,
)


def write(folder, text):
    path = folder / "force.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_units_and_trigger(tmp_path):
    signal = read_force_signal(
        write(tmp_path, "time_ms,force_mN,trigger_V\n0,0,0\n1,500,0\n2,1000,5\n3,1500,5\n")
    )
    np.testing.assert_allclose(signal.time, [0, 0.001, 0.002, 0.003])
    np.testing.assert_allclose(signal.load, [0, 0.5, 1, 1.5])
    assert frame_clock(1, signal).anchor_time == pytest.approx(0.0015)


def test_columns_can_be_named(tmp_path):
    path = write(tmp_path, "t,Fz\n0,1\n1,2\n")
    signal = read_force_signal(path, {"time": "t:min", "force": "Fz:gf"})
    np.testing.assert_allclose(signal.time, [0, 60])
    np.testing.assert_allclose(signal.load, [9.80665e-3, 19.6133e-3])
    assert signal.trigger is None


def test_displacement_of_the_platen(tmp_path):
    text = "time_s,force_N,displacement_um\n0,0,500\n1,1,1500\n2,3,2500\n"
    signal = read_force_signal(write(tmp_path, text))
    np.testing.assert_allclose(
        signal.displacement_at([0, 0.5, 2, 2.1, -1]), [0.5, 1, 2.5, math.nan, math.nan]
    )
    named = read_force_signal(
        write(tmp_path, "time_s,force_N,stage\n0,0,1\n1,1,2\n"), {"displacement": "stage:mm"}
    )
    np.testing.assert_allclose(named.displacement, [1, 2])
    with pytest.raises(LoadingError, match="no column 'travel' for displacement; found time_s, force_N"):
        read_force_signal(write(tmp_path, "time_s,force_N\n0,0\n1,1\n"), {"displacement": "travel:mm"})
    without = read_force_signal(write(tmp_path, "time_s,force_N\n0,0\n1,1\n"))
    assert without.displacement is None
    assert math.isnan(without.displacement_at(0.5))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time_s,force_N\n0,1\n", "needs 2 samples or more, found 1"),
        ("time_s,force_N,displacement_V\n0,1,0\n1,2,1\n", "unit 'V'; displacement is read in mm, um"),
        ("time_s,force_N,displacement_mm\n0,1,0\n1,2,\n", "line 3, column 'displacement_mm': ''"),
        ("time_s,force_N,displacement_mm\n0,0,3\n1,1,3\n2,2,3\n", "the displacement is 3 mm throughout"),
        ("time_s,force_N,displacement_mm\n0,0,3\n1,1,2\n2,2,1\n", "falls while the force rises"),
        ("time_s,force_N\n0,1\n2,1\n1,1\n", r"after row 2 \(2 s\) it falls to 1 s"),
        ("time_s,force_N\n0,1\n1,1\n1,2\n", r"after row 2 \(1 s\) it is repeated"),
        ("time_s,force_lb\n0,1\n1,2\n", "unit 'lb'"),
        ("time_s,force_N\n0,0\n1,0\n2,0\n", "the force is 0 N throughout"),
        ("time_s,force_N\n0,0\n1,-1\n2,-2\n", "positive in compression: reverse its sign"),
        ("time_s,force_N\n0,0.1\n1,-1\n2,-0.5\n", "goes down to -1 N and up to 0.1 N only"),
    ],
)
def test_invalid_files(tmp_path, text, words):
    with pytest.raises(LoadingError, match=words) as caught:
        read_force_signal(write(tmp_path, text))
    assert "force.csv" in str(caught.value)


@given(st.floats(-5, 5), st.floats(0.1, 3), st.floats(0, 1))
def test_interpolation_without_extrapolation(start, step, share):
    signal = ForceSignal(start + step * np.arange(5), 2.0 * np.arange(5))
    low, high = signal.span
    assert signal.load_at(low + share * (high - low)) == pytest.approx(8 * share, abs=1e-9)
    assert np.isnan(signal.load_at([low - 1e-6, high + 1e-6])).all()


def test_clocks():
    assert FrameRate(100, anchor_time=2.0, anchor_frame=50).time_of(0, None) == pytest.approx(1.5)
    assert math.isnan(FrameRate(100, anchor_frame=None).time_of(3, None))
    for frame in (-1, 3):
        with pytest.raises(LoadingError, match="one of the 3 frames"):
            FrameRate(100, anchor_frame=frame, numbers=(0, 1, 4))
    assert FrameRate(100, anchor_time=1.0, anchor_frame=None).time_of(13, 3) == pytest.approx(1.1)
    stamps = FrameStamps([0.1, 0.4])
    assert stamps.time_of(1, None) == 0.4
    assert math.isnan(stamps.time_of(2, None))


def test_frames_anchored_by_trigger_and_contact():
    time = np.arange(0, 1, 0.001)
    load = np.maximum(0, time - 0.4)
    signal = ForceSignal(time, load, np.where(time >= 0.2505, 5.0, 0.02))
    assert frame_clock(100, signal).time_of(10, None) == pytest.approx(0.3505, abs=6e-4)
    assert frame_clock(100, signal, contact_load=0.05).time_of(7, 7) == pytest.approx(0.45, abs=1e-6)


@pytest.mark.parametrize("zero", [0.0, -0.1, -0.3])
def test_the_load_of_first_contact_counts_from_a_zero_below_zero(zero):
    time = np.arange(0, 1, 0.001)
    noise = np.random.default_rng(2).normal(0, 0.003, time.size)
    signal = ForceSignal(time, np.maximum(0, time - 0.4) + zero + noise)
    assert frame_clock(100, signal, contact_load=0.05).anchor_time == pytest.approx(0.45, abs=0.008)


@pytest.mark.parametrize("load", [0.001, 0.005, 0.02])
def test_noise_before_contact_does_not_start_the_clock(load):
    time = np.arange(0, 2, 0.001)
    for seed in range(10):
        noise = np.random.default_rng(seed).normal(0, 0.005, time.size)
        signal = ForceSignal(time, 1.5 * np.clip(time - 1, 0, 0.5) + noise)
        assert frame_clock(100, signal, contact_load=load).anchor_time == pytest.approx(1.0, abs=0.03)


def test_spike_is_no_contact():
    load = np.zeros(50)
    load[5], load[10:12], load[20:23] = 1.0, 1.0, 1.0  # three samples are the minimum
    signal = ForceSignal(np.arange(50.0), load)
    assert frame_clock(1, signal, contact_load=0.5).anchor_time == pytest.approx(19.5)
    load[21] = 0.0
    with pytest.raises(LoadingError, match="never rises"):
        frame_clock(1, ForceSignal(np.arange(50.0), load), contact_load=0.5)


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda s: frame_clock(1, ForceSignal(s.time, s.load, np.full(4, 3.0))), "never rises: it stays"),
        (lambda s: frame_clock(1, ForceSignal(s.time, s.load, [5, 5, 0, 0])), "never rises"),
        (lambda s: frame_clock(1, s, contact_load=9.0), "never rises through 9 N"),
        (lambda s: frame_clock(1, s, contact_load=0.0), "contact_load must be positive and finite, found 0"),
        (lambda s: ForceSignal([0, 1], [0, math.nan]), "load is not finite at sample 1"),
        (lambda s: ForceSignal([0, math.inf], [0, 1]), "time is not finite"),
        (lambda s: ForceSignal([0, 1, 2], [0, 1]), "3 samples"),
        (lambda s: ForceSignal([0, 1], None), "load must be a row of 2 samples"),
        (lambda s: ForceSignal(None, [0, 1]), "time must be a row of 2 samples"),
        (lambda s: frame_clock(10, "force.csv"), "ForceSignal, as read_force_signal reads it, found str"),
        (lambda s: ForceSignal([[0, 1]], [[0, 1]]), "row"),
        (lambda s: frame_clock(10, s, start_time=1.0, contact_load=0.5), "not both"),
        (lambda s: frame_clock(10, contact_load=0.5), "give the force too"),
        (lambda s: alignment_scatter([0.1, 0.2], [1], s), "one area for each frame"),
        (lambda s: alignment_scatter(["late"], [1], s), "time must be numeric"),
        (lambda s: FrameRate(0), "frames_per_second must be positive"),
        (lambda s: FrameRate(math.nan), "frames_per_second must be positive"),
        (lambda s: FrameRate(10, anchor_time=math.inf), "anchor_time must be finite"),
        (lambda s: FrameStamps([1.0, 1.0]), "is repeated"),
        (lambda s: FrameStamps([1.0, math.nan]), "finite"),
    ],
)
def test_signals_and_clocks_that_are_none_are_refused(ask, words):
    with pytest.raises(LoadingError, match=words):
        ask(ForceSignal([0, 1, 2, 3], [0, 1, 2, 3]))


def test_stamps_from_a_file(tmp_path):
    np.testing.assert_allclose(read_frame_stamps(write(tmp_path, "time_ms\n5\n7\n")).time, [0.005, 0.007])
    with pytest.raises(LoadingError, match=r"force\.csv: time of the frames must increase"):
        read_frame_stamps(write(tmp_path, "time_s\n5\n4\n"))


def test_frame_clock_preferences():
    plain = ForceSignal([5.0, 6.0, 7.0, 8.0, 9.0], [0.0, 0.0, 1.0, 2.0, 2.0])
    triggered = ForceSignal(plain.time, plain.load, trigger=[0, 0, 5, 5, 5])
    assert frame_clock(10).time_of(3, None) == pytest.approx(0.3)
    assert frame_clock(10, plain).time_of(3, None) == pytest.approx(5.3)
    assert frame_clock(10, triggered).time_of(3, None) == pytest.approx(6.8)
    assert frame_clock(10, triggered, start_time=0.0).time_of(3, None) == pytest.approx(0.3)
    assert frame_clock(10, triggered, contact_load=0.5).time_of(3, first_contact=1) == pytest.approx(6.7)


def test_a_zero_below_zero_is_kept(tmp_path):
    signal = read_force_signal(write(tmp_path, "time_s,force_N\n0,-0.3\n1,0.2\n2,1.7\n"))
    assert signal.load[0] == -0.3


@pytest.mark.parametrize("late", [-0.2, 0.0, 0.13])
def test_least_scatter_where_frames_are_aligned(late):
    clock = np.linspace(0, 5, 400)
    signal = ForceSignal(clock, 2 * np.exp(-((clock - 2.5) ** 2)))
    time = np.linspace(0.5, 4.5, 120)
    grown = 45 * signal.load_at(time) ** 0.62 * np.exp(0.01 * np.random.default_rng(1).normal(size=120))
    grown[::7] = np.nan  # frames that could not be measured
    shifts = np.linspace(-0.4, 0.4, 81)
    scatter = alignment_scatter(time + late, grown, signal, shifts)
    assert shifts[np.argmin(scatter)] == pytest.approx(-late, abs=0.011)
    assert scatter.min() == pytest.approx(0.01, rel=0.25)


def test_scatter_of_too_few_frames_is_unknown():
    signal = ForceSignal([0, 1], [0, 1])
    assert math.isnan(alignment_scatter([0.1, 0.2], [1, 2], signal))
