"""Phases of a record, its first contact, relaxation and lost energy, and records with nothing to find."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from tests.loading.options import DEEP

from fingerpad.exceptions import FingerpadError, FitError, LoadingError
from fingerpad.image import ForceSignal
from fingerpad.loading import (
    Cycle,
    LoadingCurve,
    Segment,
    find_cycles,
    fit_contact_compliance,
    fit_loading_curve,
    fit_relaxation,
    hysteresis,
)
from fingerpad.loading.contact_point import first_contact
from fingerpad.loading.curve import saturated_rows
from fingerpad.simulate import simulate_loading_curve

NOISE = {"force_std": 0.005, "displacement_std": 0.005, "area_std": 1.0}


@pytest.mark.parametrize("noise", [{}, NOISE])
@pytest.mark.parametrize("points", [120, 600, 2000])
def test_phases_of_three_cycles(points: int, noise: dict) -> None:
    curve = simulate_loading_curve(points=points, cycles=3, hold=0.6, unloading=True, seed=2, **noise)
    cycles = find_cycles(curve)
    assert len(cycles) == 3
    third = points / 3
    for number, cycle in enumerate(cycles):
        # Way in 1.39 s of which 0.3 s before contact, hold 0.6 s, way out 1.39 s.
        edges = np.array([cycle.loading.start, cycle.hold.start, cycle.unloading.start]) / third - number
        assert_allclose(edges, [0.3 / 3.37, 1.39 / 3.37, 1.99 / 3.37], atol=max(0.035, 2 / third))


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6])
def test_hysteresis_is_loop_area(share: float) -> None:
    curve = simulate_loading_curve(points=4000, unloading=True, hysteresis=share, load_coefficient=0.0)
    found = hysteresis(curve, find_cycles(curve)[0])
    # Of W = k x^(3/2), the work is 2/5, and the loop's share h (2/5 - 2/7) / (2/5).
    assert_allclose(found.fraction, share * (1 - 5 / 7), atol=2e-3)
    assert found.energy >= -1e-3


CURVE = simulate_loading_curve(points=300, **NOISE)
WAY_OUT = {"load": np.maximum(np.linspace(2, -1, 300), 0) ** 1.5, "indentation": np.linspace(2, -1, 300)}


@pytest.mark.parametrize(
    ("columns", "kind", "message"),
    [
        ({"load": -CURVE.load}, LoadingError, "force falls as the displacement grows"),
        ({"indentation": -CURVE.indentation}, LoadingError, "displacement never grows"),
        # A way in alone, reversed, has no cycle at all.
        (
            {"load": -CURVE.load, "indentation": -CURVE.indentation},
            LoadingError,
            "both of the wrong sign .* reverse both columns",
        ),
        ({"load": np.ones(300)}, LoadingError, "force is 1 N in every row"),
        ({"indentation": np.ones(300)}, LoadingError, "displacement is 1 mm in every row"),
        (
            {"load": 0.01 * np.random.default_rng(0).standard_normal(300)},
            FitError,
            "no contact in the record",
        ),
        ({"area": -CURVE.area}, LoadingError, "contact area falls"),
        ({"area": np.full(300, np.nan)}, LoadingError, "area is unknown in every row: leave it out"),
        (WAY_OUT | {"area": None, "time": None}, LoadingError, "the way out alone"),
    ],
)
def test_invalid_records(columns: dict, kind: type[FingerpadError], message: str) -> None:
    with pytest.raises(kind, match=message):
        fit_loading_curve(replace(CURVE, **columns))


@pytest.mark.parametrize("points", [40, 400])
def test_reversed_record_is_detected(points: int) -> None:
    curve = simulate_loading_curve(points=points, approach=0.8, hold=0.5, unloading=True, **NOISE)
    with pytest.raises(LoadingError, match="both of the wrong sign .* reverse both columns"):
        fit_loading_curve(replace(curve, load=0.1 - curve.load, indentation=3 - curve.indentation))


@pytest.mark.parametrize("name", ["load", "indentation", "area", "time"])
def test_nan_and_unequal_lengths_refused(name: str) -> None:
    values = getattr(CURVE, name).copy()
    values[7] = np.inf if name == "area" else np.nan
    with pytest.raises(LoadingError, match=f"{name} is not finite in row 8"):
        replace(CURVE, **{name: values})
    if name != "load":
        with pytest.raises(LoadingError, match=f"{name} has shape"):
            replace(CURVE, **{name: values[:9]})


def test_time_checks() -> None:
    time = CURVE.time.copy()
    time[100] = time[98]
    with pytest.raises(LoadingError, match="runs backwards at row 101"):
        replace(CURVE, time=time)
    time = CURVE.time.copy()
    time[100] = time[99]
    time[150:] += 1.0
    flags = fit_loading_curve(replace(CURVE, time=time), **DEEP).flags
    assert {"duplicated_time", "time_gap"} <= set(flags)


def test_saturated_rows_left_out_and_flagged() -> None:
    clipped = replace(CURVE, load=np.minimum(CURVE.load, 1.5))
    fit = fit_loading_curve(clipped)
    assert "saturated_force" in fit.flags
    assert fit.loading_radius.lower < 15 < fit.loading_radius.upper
    assert fit.initial_modulus.lower < 0.04 < fit.initial_modulus.upper
    assert fit.modulus_load < 1.52


@pytest.mark.parametrize("clip", ["none below 15 mm²", "lost frames", "larger than the frame"])
def test_areas_that_are_none_are_left_out_and_flagged(clip) -> None:
    area, top = CURVE.area.copy(), np.max(CURVE.area)
    if clip == "none below 15 mm²":
        area[area < 15] = 0
    elif clip == "lost frames":
        area[np.flatnonzero(area > top / 2)[3::40]] = 0
    else:
        area = np.minimum(area, 0.7 * top)
    clipped = replace(CURVE, area=area)
    assert abs(fit_contact_compliance(clipped).value - 15) < 0.5
    fit = fit_loading_curve(clipped, **DEEP)
    assert "clipped_area" in fit.flags
    assert {"misfit", "area_offset", "correlated_area"}.isdisjoint(fit.flags)
    assert abs(fit.loading_radius.value - 15) < 3 * fit.loading_radius.std < 1.5


def test_a_rounded_force_is_right_within_its_uncertainty() -> None:
    """Hertz's sphere of 12 mm and 60 kPa: every reading before contact is off by the same part of a step."""
    rng, step = np.random.default_rng(4), 0.05
    depth = np.arange(-2, 1.9, 0.02)
    pressed, noise = np.maximum(depth, 0), rng.standard_normal((3, depth.size))
    for zero in (np.arange(4) / 4 + 0.1) * step:
        load = 4 / 3 * 0.06 / 0.75 * 12**0.5 * pressed**1.5 + zero + 0.0005 * noise[0]
        curve = LoadingCurve(
            load=step * np.round(load / step),
            indentation=depth + 7.3 + 0.002 * noise[1],
            area=np.where(depth > 0, np.pi * 12 * pressed + 0.5 * noise[2], 0),
            time=depth / 2 + 1,
        )
        fit = fit_loading_curve(curve, **DEEP)
        assert fit.flags == ("rounded_force",)
        assert abs(fit.youngs_modulus.value - 0.06) < 3 * fit.youngs_modulus.std < 0.006
        assert abs(fit.contact_offset.value - 7.3) < 3 * fit.contact_offset.std < 0.2
    # At its limit the sensor stands still for longer than at a step.
    clipped = replace(curve, load=np.minimum(curve.load, 15 * step))
    assert "saturated_force" in fit_loading_curve(clipped, **DEEP).flags


def test_the_loop_covers_the_ground_of_the_way_in_and_counts_from_the_baseline() -> None:
    """A press from 2 to 3 mm with W = x above a baseline of 0.2 N, and W = x/2 on the way out, to 1 mm."""
    way_in, way_out = np.linspace(2, 3, 11), np.linspace(3, 1, 21)
    sticking = np.where(way_out >= 2, 0.5 * (way_out - 2), -0.3)
    curve = LoadingCurve(
        load=0.2 + np.concatenate([np.zeros(3), way_in - 2, sticking]),
        indentation=np.concatenate([[1.7, 1.8, 1.9], way_in, way_out]),
    )
    cycle = Cycle(
        baseline=Segment(start=0, stop=3),
        loading=Segment(start=3, stop=14),
        hold=None,
        unloading=Segment(start=14, stop=35),
    )
    found = hysteresis(curve, cycle)
    assert_allclose([found.energy, found.fraction], [0.5 - 0.25, 0.5])
    bare = hysteresis(replace(curve, load=curve.load - 0.2), replace(cycle, baseline=None))
    assert_allclose([bare.energy, bare.fraction], [0.25, 0.5])


def test_a_sensor_at_its_limit_is_told_from_a_platen_at_rest() -> None:
    """Four rows of the segment's own maximum, whatever the record reaches elsewhere, in which it moves on."""
    depth, segment = np.arange(9.0), Segment(start=0, stop=7)
    load = np.array([0.0, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0, 5.0, 6.0])
    flat = LoadingCurve(load=load, indentation=depth)
    assert saturated_rows(flat, segment).tolist() == 3 * [False] + 4 * [True]
    assert not saturated_rows(replace(flat, load=np.where(depth == 3, 2.9, load)), segment).any()
    assert not saturated_rows(replace(flat, indentation=np.minimum(depth, 3)), segment).any()


def pressed(
    way: list[tuple[float, float]], *, contact: float, sticks: float = 0.0, rows: int = 1500, seed: int = 1
):
    """Return a record of a sphere on a way of (mm, mm/s), or (nan, s) at rest, that sticks (N) coming out."""
    times, places = [0.0], [0.0]
    for target, speed in way:
        rests = np.isnan(target)
        times.append(times[-1] + (speed if rests else abs(target - places[-1]) / speed))
        places.append(places[-1] if rests else target)
    rng = np.random.default_rng(seed)
    clock = np.sort(rng.uniform(0, times[-1], rows))
    travel = np.interp(clock, times, places)
    out = clock > times[int(np.argmax(places))]
    load = 0.2 * np.maximum(travel - contact, 0) ** 1.5 * np.where(out, 0.8, 1.0)
    load = load - out * sticks * np.exp(-(((travel - contact) / 0.3) ** 2)) + 0.002 * clock
    return LoadingCurve(
        load=load + rng.normal(0, 0.005, rows), indentation=travel + rng.normal(0, 0.002, rows), time=clock
    )


REST = np.nan
WAYS = {  # targets (mm) with speeds (mm/s), or rests with their time (s), and the place of contact (mm)
    "fast way out": ([(12, 1), (0, 10)], 10),
    "very fast way out": ([(12, 1), (0, 50)], 10),
    "ends in mid-air": ([(12, 1), (-20, 10)], 10),
    "long approach": ([(32, 1), (0, 1)], 30),
    "very long approach": ([(62, 1), (0, 5)], 60),
    "ends soon after the top": ([(12, 1), (11, 10)], 10),
    "fast approach": ([(9.5, 10), (12, 0.5), (0, 10)], 10),
    "fast approach and rest": ([(9.5, 10), (REST, 2), (12, 0.5), (0, 10)], 10),
    "rests before and in contact": ([(REST, 5), (12, 1), (REST, 5), (0, 5)], 10),
}


@pytest.mark.parametrize(("way", "contact"), WAYS.values(), ids=WAYS)
@pytest.mark.parametrize("sticks", [0.0, 0.3])
def test_the_press_of_ordinary_records_is_found(way, contact: float, sticks: float) -> None:
    curve = pressed(way, contact=contact, sticks=sticks)
    (cycle,) = find_cycles(curve)
    top = np.nanmax([target for target, _ in way])
    loading = curve.indentation[cycle.loading.rows]
    assert abs(loading[0] - contact) < 0.3
    assert abs(loading[-1] - top) < 0.3
    assert cycle.unloading is not None
    assert (cycle.hold is not None) == bool(np.isnan(way[-2][0]))


def displacement_of(signal: ForceSignal) -> float:
    return first_contact(signal.time, signal.load, signal.displacement)


def press(approach: float, rows: int = 400, noise: float = 0.0, exponent: float = 1.5) -> ForceSignal:
    """A platen that starts so far above the pad, whose surface is at 3 mm, presses it and goes back."""
    depth = np.interp(np.linspace(0, 1, rows), [0, 0.5, 0.7, 1], [-approach, 1.5, 1.5, -approach])
    load = 1.1 * np.maximum(depth, 0) ** exponent + np.random.default_rng(1).normal(0, noise, rows)
    return ForceSignal(np.linspace(0, 5, rows), load, displacement=3 + depth)


@pytest.mark.parametrize(("noise", "off"), [(0.0, 0.02), (0.005, 0.02), (0.02, 0.05)])
def test_contact_is_where_the_force_begins_to_rise(noise: float, off: float) -> None:
    for approach in (0.1, 0.5, 2.0):
        assert displacement_of(press(approach, noise=noise)) == pytest.approx(3, abs=off)
    # A pad that stiffens faster or more slowly than a sphere.
    assert displacement_of(press(0.5, noise=noise, exponent=1.8)) == pytest.approx(3, abs=2 * off + 0.05)


@pytest.mark.parametrize(
    ("signal", "words"),
    [
        (press(-0.3), "the record begins in contact"),
        (press(0.5, rows=12), "after 5 rows; 6 are needed"),
        (ForceSignal([0, 1], [0, 1]), "no displacement was recorded"),
    ],
)
def test_without_an_approach_contact_is_unknown(signal: ForceSignal, words: str) -> None:
    with pytest.raises(LoadingError, match=words):
        displacement_of(signal)


PAD = {"load_coefficient": 0.0, "points": 600, "force_std": 0.003, "displacement_std": 0.002, "hold": 10.0}


def relaxation(**options):
    curve = simulate_loading_curve(**{**PAD, **options})
    return fit_relaxation(curve, find_cycles(curve)[0], 1.0)


def test_one_term_with_ramp() -> None:
    found = relaxation(relaxation=[(0.3, 3.0)], seed=1)
    (term,) = found.terms
    assert abs(term.time.value - 3.0) < 4 * term.time.std
    assert abs(term.share.value - 0.3) < 4 * term.share.std
    assert_allclose([term.time.value, term.share.value], [3.0, 0.3], rtol=0.1)


def test_no_term_without_relaxation() -> None:
    assert relaxation(seed=2).terms == ()


def test_times_outside_record_undetermined() -> None:
    fast = relaxation(relaxation=[(0.3, 0.2)], rate=1.0, seed=3)
    assert fast.terms
    assert all("faster than the ramp" in term.time.reason for term in fast.terms)
    slow = relaxation(relaxation=[(0.5, 60.0)], seed=4)
    assert slow.terms
    assert all("slower than the hold" in term.time.reason for term in slow.terms)
    with pytest.raises(FitError, match="no hold"):
        relaxation(hold=0.0)
