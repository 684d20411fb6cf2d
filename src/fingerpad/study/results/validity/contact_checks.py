"""The contact's area over loads, shape and size against those of Hertz theory."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from scipy import special

from fingerpad._arrays import FloatArray, as_float_array
from fingerpad.contact.fast_laws import plate_gap, press
from fingerpad.flags import FLAGS
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.study.results.pooling import PressSlope, area_noise, edges_of, items_of
from fingerpad.study.results.table import Indices, Row
from fingerpad.study.results.validity.model_checks import (
    HEADLINES,
    HERTZ_EXPONENT,
    HOLDS,
    INDENTATION,
    MODULUS,
    NOTHING_COUNTS,
    RADIUS,
    SAME_LOAD,
    STRAINED_BELOW_P,
    UNITS,
    FingerAtAngle,
    ValidityCheck,
    p_value_of,
)
from fingerpad.uncertainty import pad_model, propagate
from fingerpad.units import KPA_PER_MPA

GROWTH: Final = "area_against_load"
_FALL: Final = "area_falls"
_OVER_LOADS: Final = {
    name: ValidityCheck(name=name, compared=words, quantities=(MODULUS, INDENTATION))
    for name, words in (
        (GROWTH, "exponent n of A ∝ Wⁿ, and 2/3 of Hertz theory"),
        (_FALL, "area over that at a lower load, where it falls most significantly"),
    )
}
_OF_MODULUS: Final = -1.5  # E ∝ W A^−3/2
_EFFECT_ON: Final = "E"
_LEAST_STD: Final = 1e-6  # areas and loads taken as exact are known to rounding


class _Areas(NamedTuple):
    """Logarithms of loads and areas, ascending, their own uncertainties, and what edges add to each area.

    `item` numbers contacts and sequences, whose frames are not independent.
    """

    load: FloatArray
    area: FloatArray
    own: FloatArray
    edges: list[FloatArray]
    item: Indices


def area_checks(case: FingerAtAngle) -> Iterator[ValidityCheck]:
    """Yield the checks of areas over loads."""
    seen = _areas_of(case)
    if not seen.load.size or np.ptp(seen.load) < -math.log(SAME_LOAD):
        why = "all contacts that count are at one load" if seen.load.size else NOTHING_COUNTS
        yield from (check.untested(why) for check in _OVER_LOADS.values())
        return
    yield _growth(seen)
    yield _largest_fall(seen)


def _areas_of(case: FingerAtAngle) -> _Areas:
    rows = case.loaded.sort_values("load_N", kind="stable")
    # An error of the load is one of the area that belongs to it.
    load_std = HERTZ_EXPONENT * case.study.uncertainty.load_relative_std
    return _Areas(
        load=np.log(rows["load_N"].to_numpy()),
        area=np.log(np.pi * rows["semi_major_mm"].to_numpy() * rows["semi_minor_mm"].to_numpy()),
        own=np.maximum(np.hypot(area_noise(rows), load_std), _LEAST_STD),
        edges=edges_of(rows),
        item=items_of(rows),
    )


def _growth(seen: _Areas) -> ValidityCheck:
    """Compare the exponent of the area with 2/3, by what the difference makes of E from load to load."""
    presses = PressSlope.of(*seen[:3], seen.item)
    if presses is None:
        value, slope, own, scatters, freedom = _slope_of_contacts(seen)
    else:
        value, slope, freedom = presses.value, presses.weights, presses.freedom
        scatters = presses.scatter_std > presses.own_std
        own = max(presses.scatter_std, presses.own_std) ** 2
    std = math.sqrt(own + sum(float(slope @ edge) ** 2 for edge in seen.edges))
    return _OVER_LOADS[GROWTH].of_difference(
        (value, std),
        HERTZ_EXPONENT,
        effect=_OF_MODULUS * float(np.ptp(seen.load)),
        effect_on=_EFFECT_ON,
        degrees_of_freedom=freedom if scatters else math.inf,
        note=f"over {_range(seen.load[0], seen.load[-1])}; ± from the "
        + ("scatter about the line" if scatters else "stated uncertainties of areas and loads")
        + (" and the contact edge" if np.any(seen.edges) else ""),
    )


def _slope_of_contacts(seen: _Areas) -> tuple[float, FloatArray, float, bool, float]:
    """Return the slope over contacts, its weights, own variance, whether that is of scatter, and freedom."""
    weights = seen.own**-2.0
    centred = seen.load - weights @ seen.load / weights.sum()
    slope = weights * centred / (weights @ centred**2)
    value, freedom = float(slope @ seen.area), seen.load.size - 2
    residuals = seen.area - value * centred
    residuals -= weights @ residuals / weights.sum()
    own, chi_square = 1 / float(weights @ centred**2), float(weights @ residuals**2)
    # Areas that scatter more about the line than chance allows tell its uncertainty themselves.
    scatters = bool(freedom > 0 and special.chdtrc(freedom, chi_square) < STRAINED_BELOW_P)
    return value, slope, own * chi_square / freedom if scatters else own, scatters, freedom


def _largest_fall(seen: _Areas) -> ValidityCheck:
    """Return the most significant fall of the area from a lower load to a higher one.

    Its p is that of the largest of so many pairs. Repeats at one load that scatter more than stated widen it.
    """
    seen = _by_level(seen)
    lower, upper = np.triu_indices(seen.load.size, 1)
    shared = sum((edge[lower] - edge[upper]) ** 2 for edge in seen.edges)
    load, grown = seen.load, seen.area[upper] - seen.area[lower]
    std = np.sqrt(seen.own[lower] ** 2 + seen.own[upper] ** 2 + shared)
    worst = int(np.argmin(grown / np.maximum(std, np.finfo(float).tiny))) if grown.size else -1
    if worst < 0 or grown[worst] >= 0:
        return replace(_OVER_LOADS[_FALL], verdict=HOLDS, note="no area is smaller than one at a lower load")
    deviations, ends = float(grown[worst] / std[worst]), (load[lower[worst]], load[upper[worst]])
    change = _OF_MODULUS * float(grown[worst]) + (ends[1] - ends[0])  # of ln E
    ratio = math.exp(grown[worst])
    return replace(
        _OVER_LOADS[_FALL],
        value=ratio,
        value_std=ratio * float(std[worst]),
        reference=1.0,
        reference_std=0.0,
        relative_difference=math.expm1(change),
        difference_of=_EFFECT_ON,
        relative_std=-_OF_MODULUS * float(std[worst]),
        deviations=deviations,
        p_value=min(1.0, p_value_of(deviations) / 2 * grown.size),  # of one side
        note=f"from {_range(*ends)}",
    ).judged()


def _range(low: float, high: float) -> str:
    return f"{math.exp(low):.3g} to {math.exp(high):.3g} N"


def _by_level(seen: _Areas) -> _Areas:
    """Return one area for each level of load; repeats that scatter more than stated widen all."""
    level, first = np.zeros(seen.load.size, dtype=np.intp), seen.load[0]
    for place, load in enumerate(seen.load):
        if load - first > -math.log(SAME_LOAD):
            first = load
            level[place:] += 1
    weights = seen.own**-2.0

    def mean(of: FloatArray) -> FloatArray:
        return as_float_array(np.bincount(level, weights * of) / np.bincount(level, weights))

    # Frames of a sequence show the same skin: together they are as uncertain as one.
    items = np.unique(np.stack([level, seen.item]), axis=1)[0]
    at_middle = seen.area - HERTZ_EXPONENT * (seen.load - mean(seen.load)[level])
    freedom = items.size - level[-1] - 1
    scatter = float(weights @ (at_middle - mean(at_middle)[level]) ** 2) / freedom if freedom else 1.0
    return _Areas(
        load=mean(seen.load),
        area=mean(at_middle),
        own=math.sqrt(max(1.0, scatter)) * mean(seen.own) / np.sqrt(np.bincount(items)),
        edges=[mean(edge) for edge in seen.edges],
        item=np.arange(level[-1] + 1),
    )


_SHAPE: Final = ValidityCheck(
    name="shape",
    compared="length along the finger over that across, and of Hertz theory for the pad",
    quantities=HEADLINES,
)
_NO_DIRECTION: Final = "the contact's direction is not known: only its aspect ratio is compared"
_OF_SIZE: Final = {
    kind: {
        name: ValidityCheck(
            name=f"{name.rsplit('_', 1)[0]}_on_{kind}",
            compared=f"{symbol} of Hertz theory and the whole pad on {words}",
            quantities=of,
            unit=UNITS[name],
        )
        # A/(πξ) is as wrong as ξ.
        for name, symbol, of in ((MODULUS, "E", (MODULUS,)), (INDENTATION, "ξ", (INDENTATION, RADIUS)))
    }
    for kind, words in (("half_space", "a half-space"), ("layer", "tissue over bone"))
}
# Sizes of the contact, from small to its own, at which the error is known or not.
_SIZES: Final = np.linspace(0.02, 1.0, 50)


class Shape(NamedTuple):
    """ln of the length along the finger over that across, measured and of Hertz theory for the pad.

    Where the direction is not `known`, `measured` is that of the aspect ratio.
    """

    measured: float
    std: float
    predicted: float
    predicted_std: float
    known: bool

    def against(self, predicted: float, check: ValidityCheck) -> ValidityCheck:
        """Compare what was measured with a prediction, which is as uncertain as that of Hertz theory."""
        ratio = math.exp(self.measured if self.known else math.copysign(self.measured, predicted))
        expected = math.exp(predicted)
        return check.of_ratio(
            (ratio, ratio * self.std),
            (expected, expected * self.predicted_std),
            note="" if self.known else _NO_DIRECTION,
        )


def measured_shape(case: FingerAtAngle) -> Shape | None:
    """Return the shape of the contact at the highest load; None without one."""
    row = case.highest_row
    if case.highest is None or row is None:
        return None

    def elongations(**inputs: FloatArray) -> dict[str, FloatArray]:
        radius, half = inputs["image_scale"] * inputs["contact_radius"], np.exp(0.5 * inputs["elongation"])
        edge = inputs["edge_offset"]
        return {
            "measured": np.log(radius * half + edge) - np.log(radius / half + edge),
            "predicted": pad_model(**inputs)["predicted_elongation"],
        }

    found = propagate(elongations, case.highest.inputs)
    direction = {"along": 1.0, "across": -1.0}.get(row["long_axis"] or "")
    if row["orientation_deg"] is not None:
        direction = math.cos(2 * math.radians(row["orientation_deg"]))
    return Shape(
        measured=float(found["measured"].value) * (1.0 if direction is None else direction),
        std=float(found["measured"].std),
        predicted=float(found["predicted"].value),
        predicted_std=float(found["predicted"].std),
        known=direction is not None,
    )


def contact_shape_check(case: FingerAtAngle) -> ValidityCheck:
    """Compare the contact's length along the finger over that across with Hertz theory for the pad."""
    shape = measured_shape(case)
    return _SHAPE.untested(NOTHING_COUNTS) if shape is None else shape.against(shape.predicted, _SHAPE)


def size_checks(case: FingerAtAngle) -> Iterator[ValidityCheck]:
    """Yield the error of Hertz theory for the contact's size, by the laws of the whole pad."""
    row, thickness = case.highest_row, case.pad.effective_thickness or case.pad.pad_thickness
    for kind, checks in _OF_SIZE.items():
        if row is None or (kind == "layer" and thickness is None):
            why = NOTHING_COUNTS if row is None else "no thickness of the tissue is stated"
            yield from (check.untested(why) for check in checks.values())
        else:
            yield from _errors(case, row, checks, thickness if kind == "layer" else None)


def _errors(
    case: FingerAtAngle, row: Row, checks: Mapping[str, ValidityCheck], thickness: float | None
) -> Iterator[ValidityCheck]:
    """Yield the errors of E and ξ at the contact's load and area, or at the largest area with a law."""
    area = math.pi * row["semi_major_mm"] * row["semi_minor_mm"]
    wedge, roll = math.radians(row["wedge_angle_deg"]), math.radians(row["roll_angle_deg"])
    assumed = Placement(Ellipsoid(*case.pad.semi_axes), wedge_angle=wedge, roll_angle=roll)
    # Where the outline shows another radius than the ellipsoid's, the pad is larger as a whole.
    larger = row["geometric_mean_radius_mm"] / float(assumed.curvature.geometric_mean_radius)
    pad = Ellipsoid(*(larger * case.pad.semi_axes))
    better = press(
        plate_gap(Placement(pad, wedge_angle=wedge, roll_angle=roll)),
        reduced_modulus=1.0,
        thickness=thickness,
        poisson_ratio=case.study.poisson_ratio,
        area=area * _SIZES,
    )
    size = f"a/R = {row['contact_radius_ratio']:.2f}"
    if thickness is not None:
        a = math.sqrt(area / math.pi)
        size = f"a/t = {a / thickness:.2f}, ξ/t = {row[INDENTATION] / thickness:.2f}"
    flag, known = str(better.flags[-1]), np.flatnonzero(better.flag_code == 0)
    if not known.size:
        yield from (check.untested(f"{size}; {FLAGS['layer'][flag].words}") for check in checks.values())
        return
    last, share = known[-1], _SIZES[known[-1]]
    if flag:  # the contact's own size is out of the range of the laws
        ratio = row["contact_radius_ratio"] * math.sqrt(share)
        size += (
            f": {FLAGS['layer'][flag].words}; both are of the largest in range, a/R = {ratio:.2f}, under "
            "this load, so at least this"
        )
    exact = KPA_PER_MPA * (1 - case.study.poisson_ratio**2) * row["load_N"] / float(better.load[last])
    yield checks[MODULUS].of_known_error(row[MODULUS] * share**-1.5, exact, size)
    yield checks[INDENTATION].of_known_error(row[INDENTATION] * share, float(better.indentation[last]), size)
