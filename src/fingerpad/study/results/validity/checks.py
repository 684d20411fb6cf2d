"""What Hertz theory says of contacts against what they show, the verdicts on results, and what models add.

Of loading data what a misfit of the model adds to the uncertainty is left out: whether the model holds is the
question.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Final, NamedTuple, TypeAlias

import numpy as np
import pandas as pd
from scipy import special

from fingerpad._arrays import FloatArray, as_float_array
from fingerpad._words import counted
from fingerpad.contact.fast_laws import law_form, plate_gap, press
from fingerpad.flags import FLAGS
from fingerpad.loading import LoadingFit
from fingerpad.study.manifest.models import Finger
from fingerpad.study.measuring.curves import CurveResult, LoadingRadius, each_press_once, loading_radius
from fingerpad.study.measuring.fingers import pad_placement
from fingerpad.study.results import summary_file
from fingerpad.study.results.layer import LayerQuantity, curve_on_layer, with_thickness
from fingerpad.study.results.pooling import Summary, area_noise, edges_of, items_of
from fingerpad.study.results.rows import Rows
from fingerpad.study.results.table import COLUMNS, Indices, Row, record_at
from fingerpad.study.results.validity.model_checks import (
    AREA_FALLS,
    CHECKS,
    HEADLINES,
    HOLDS,
    INDENTATION,
    MODULUS,
    NOT_TESTED,
    RADIUS,
    ROUTES,
    STRAINED_BELOW_P,
    ValidityCheck,
    judge_together,
    overall_verdict,
    p_value_of,
)
from fingerpad.uncertainty import layer_model, pad_model, pool, pool_random_effects, propagate
from fingerpad.uncertainty.discrepancy import ModelDiscrepancy, model_discrepancy
from fingerpad.uncertainty.press_slope import PressSlope
from fingerpad.units import KPA_PER_MPA

HERTZ_EXPONENT: Final = 2 / 3
# Loads are the same where their ratio is above this.
SAME_LOAD: Final = 0.9
# How areas of presses of one finger under one load differ, relative, where a study has no repeats: three real
# prints of one finger did so by 4.6 %, and count beside few repeats. A rendered contact has no press.
PRESS_STD: Final = 0.046
_PRESS_FREEDOM: Final = 2
GROWTH: Final = "area_against_load"
NO_AREAS: Final = "the loading curves have no areas, so no radius"
NOTHING_COUNTS: Final = "no contact counts"
_OF_MODULUS: Final = -1.5  # E ∝ W A^−3/2
_LEAST_STD: Final = 1e-6  # areas and loads taken as exact are known to rounding


# What first-order propagation gives of a contact, by model and output: values with their uncertainties.
_Estimates: TypeAlias = Mapping[tuple[str, str], tuple[float, float]]


class FingerAtAngle:
    """A finger at an angle: its contacts, the one at the highest load, its loading data, and their checks."""

    def __init__(
        self, rows: Rows, summary: Summary, curves: Sequence[CurveResult], at_highest_load: _Estimates
    ) -> None:
        self.study, self.pad, self.summary = rows.study, rows.fingers[summary.finger], summary
        self.at_highest_load = at_highest_load
        # The contact at the highest load of those that count, and its row; None where none counts.
        highest = self.highest = rows.highest_load.get(summary.key)
        self.highest_row = highest and record_at(
            rows.table, summary.places[summary.column("observation") == highest.observation][0]
        )
        self.loading = loading_radius(curves, summary.finger_and_wedge)  # R_g
        # Of curves in plausible units on which the place of contact was found.
        placed = (
            one
            for one in curves
            if one.fit is not None
            and one.is_plausible
            and one.manifest.finger_and_wedge == summary.finger_and_wedge
            and 0 < one.fit.contact_offset.std < math.inf
        )
        self.fits = tuple(one.fit for one in each_press_once(placed) if one.fit is not None)
        areas = summary.areas
        self.loaded = areas[areas["pooled"] & (areas["load_N"] > 0)]  # rows of which areas and loads count
        repeats = rows.repeatability.get(summary.synthetic)
        self.press_std = 0.0 if summary.synthetic else PRESS_STD  # relative, of areas of presses at one load
        # Degrees of freedom of that, and of repeats alone.
        self.press_freedom = self.repeat_freedom = math.inf
        if repeats is not None and repeats.known:
            # Few repeats may scatter less than noise by chance: what is usual counts beside them.
            usual = 0 if summary.synthetic else _PRESS_FREEDOM
            self.repeat_freedom, self.press_freedom = float(repeats.freedom), float(repeats.freedom + usual)
            squares = repeats.freedom * repeats.area_std**2 + usual * PRESS_STD**2
            self.press_std = math.sqrt(squares / self.press_freedom)
        # Results that are compared with loading curves at one load; the radius where there is no R_g.
        with_radius = self.fits and self.loading is None
        self.of_curves: tuple[str, ...] = HEADLINES if with_radius else (MODULUS, INDENTATION)
        # Why there is no R_g from loading data, and no contact with a radius, where there is none.
        self.no_loading_radius = (
            NO_AREAS if self.fits else "no fitted loading data of this finger at this angle"
        )
        self.nothing = NOTHING_COUNTS if self.pad.has_semi_axes else "the finger has no semi-axes"
        self.checks = _checks(self)  # of Hertz theory
        self.of_layer = judge_together(tuple(layer_checks(self, curves)))


def _has_modulus(fit: LoadingFit) -> bool:
    """Return whether a loading curve gives a modulus, for which it needs a radius."""
    return fit.loading_radius.known and fit.reduced_modulus.known


def _freedom(freedom: float, part: float, whole: float) -> float:
    """Return the degrees of freedom of a variance of which one part is known from few (Satterthwaite)."""
    return freedom * (whole / part) ** 2 if part > 0 else math.inf


class _Areas(NamedTuple):
    """Logarithms of loads, ascending, and of areas, their uncertainties, and of which item each is."""

    load: FloatArray
    area: FloatArray
    own: FloatArray
    edges: list[FloatArray]
    item: Indices
    freedom: float  # degrees of freedom from which `own` is known


def area_checks(case: FingerAtAngle) -> Iterator[ValidityCheck]:
    """Yield the checks of areas over loads."""
    rows = case.loaded.sort_values("load_N", kind="stable")
    # An error of the load is one of the area that belongs to it.
    load_std = HERTZ_EXPONENT * case.study.uncertainty.load_relative_std
    # Another press has another area; the frames of a sequence are one press.
    press_std = np.where(rows["sequence"].isna(), case.press_std, 0.0)
    own = np.maximum(np.sqrt(area_noise(rows) ** 2 + load_std**2 + press_std**2), _LEAST_STD)
    seen = _Areas(
        load=np.log(rows["load_N"].to_numpy()),
        area=np.log(np.pi * rows["semi_major_mm"].to_numpy() * rows["semi_minor_mm"].to_numpy()),
        own=own,
        edges=edges_of(rows),
        item=items_of(rows),
        # What few repeats scatter beyond noise may be too little by chance, or nothing.
        freedom=case.press_freedom if rows["sequence"].isna().any() else math.inf,
    )
    if not seen.load.size or np.ptp(seen.load) < -math.log(SAME_LOAD):
        why = "all contacts that count are at one load" if seen.load.size else NOTHING_COUNTS
        yield from (CHECKS[name].untested(why) for name in (GROWTH, AREA_FALLS))
        return
    yield _growth(seen)
    yield _largest_fall(seen)


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
    return CHECKS[GROWTH].of_difference(
        (value, std),
        HERTZ_EXPONENT,
        effect=_OF_MODULUS * float(np.ptp(seen.load)),
        difference_of="E",
        degrees_of_freedom=freedom if scatters else seen.freedom,
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
    """Return the most significant fall of the area over loads; p of the largest of so many pairs."""
    seen = _by_level(seen)
    lower, upper = np.triu_indices(seen.load.size, 1)
    shared = sum((edge[lower] - edge[upper]) ** 2 for edge in seen.edges)
    load, grown = seen.load, seen.area[upper] - seen.area[lower]
    std = np.sqrt(seen.own[lower] ** 2 + seen.own[upper] ** 2 + shared)
    worst = int(np.argmin(grown / np.maximum(std, np.finfo(float).tiny))) if grown.size else -1
    if worst < 0 or grown[worst] >= 0:
        return CHECKS[AREA_FALLS].with_fields(
            verdict=HOLDS, note="no area is smaller than one at a lower load"
        )
    deviations, ends = float(grown[worst] / std[worst]), (load[lower[worst]], load[upper[worst]])
    change = _OF_MODULUS * float(grown[worst]) + (ends[1] - ends[0])  # of ln E
    ratio = math.exp(grown[worst])
    return CHECKS[AREA_FALLS].compared_with(
        (ratio, ratio * float(std[worst])),
        (1.0, 0.0),
        change=change,
        difference_of="E",
        relative_std=-_OF_MODULUS * float(std[worst]),
        deviations=deviations,
        p_value=min(1.0, p_value_of(deviations, seen.freedom) / 2 * grown.size),  # of one side
        note=f"from {_range(*ends)}",
    )


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
        freedom=seen.freedom,
    )


# Sizes of the contact, from small to its own, at which the error is known or not.
_SIZES: Final = np.linspace(0.02, 1.0, 50)


class Shape(NamedTuple):
    """ln of length along the finger over width across; of the aspect ratio where it is not `known`."""

    measured: float
    std: float
    predicted: float
    predicted_std: float
    known: bool
    freedom: float  # degrees of freedom from which both together are known

    def against(self, predicted: float, check: ValidityCheck) -> ValidityCheck:
        """Compare what was measured with a prediction, which is as uncertain as that of Hertz theory."""
        ratio = math.exp(self.measured if self.known else math.copysign(self.measured, predicted))
        expected = math.exp(predicted)
        note = "" if self.known else "the contact's direction is not known: only its aspect ratio is compared"
        value, reference = (ratio, ratio * self.std), (expected, expected * self.predicted_std)
        return check.of_ratio(value, reference, degrees_of_freedom=self.freedom, note=note)


def _thickness(finger: Finger) -> float | None:
    """Return what is stated of the tissue's thickness, mm: the effective one before the pad's."""
    return finger.effective_thickness_mm or finger.pad_thickness_mm


def _elongations(**inputs: FloatArray) -> dict[str, FloatArray]:
    # Another press under the same load has another shape.
    half = np.exp(0.5 * (inputs["elongation"] + inputs["elongation_deviation"]))
    radius, edge = inputs["image_scale"] * inputs["contact_radius"], inputs["edge_offset"]
    return {
        "measured": np.log(radius * half + edge) - np.log(radius / half + edge),
        "predicted": pad_model(**inputs)["predicted_elongation"],
    }


def _at_highest_loads(rows: Rows) -> dict[summary_file.PlacementKey, _Estimates]:
    """Return shape, and E and ξ of the whole pad, of the contacts at highest loads, all at once."""
    highest = rows.highest_load
    if not highest:
        return {}
    each = [one.inputs for one in highest.values()]
    mean, covariance = (np.stack([getattr(one, name) for one in each]) for name in ("mean", "covariance"))
    inputs = replace(each[0], mean=mean, covariance=covariance)
    pads = [rows.fingers[finger].manifest for finger, *_ in highest]
    thickness = np.array([_thickness(one) or math.inf for one in pads])
    std = np.array([one.effective_thickness_mm_std or 0.0 for one in pads])
    found = {"shape": propagate(_elongations, inputs)}
    with np.errstate(all="ignore"):
        found["half_space"] = propagate(layer_model, with_thickness(inputs, math.inf, 0.0))
        if np.isfinite(thickness).any():
            found["layer"] = propagate(layer_model, with_thickness(inputs, thickness, std))
    columns = {
        (model, name): zip(value, std, strict=True)
        for model, one in found.items()
        for name, value, std in zip(one.names, one.value.T.tolist(), one.std.T.tolist(), strict=True)
    }
    by_contact = zip(*columns.values(), strict=True)
    return {key: dict(zip(columns, one, strict=True)) for key, one in zip(highest, by_contact, strict=True)}


def _measured_shape(case: FingerAtAngle) -> Shape | None:
    """Return the shape of the contact at the highest load; None without one."""
    row = case.highest_row
    if row is None:
        return None
    direction = {"along": 1.0, "across": -1.0}.get(row["long_axis"] or "")
    if row["orientation_deg"] is not None:
        direction = math.cos(2 * math.radians(row["orientation_deg"]))
    (measured, std), (predicted, predicted_std) = (
        case.at_highest_load["shape", name] for name in ("measured", "predicted")
    )
    return Shape(
        measured=measured * (1.0 if direction is None else direction),
        std=std,
        predicted=predicted,
        predicted_std=predicted_std,
        known=direction is not None,
        freedom=_freedom(case.repeat_freedom, std**2, std**2 + predicted_std**2),
    )


def size_checks(case: FingerAtAngle) -> Iterator[ValidityCheck]:
    """Yield the error of Hertz theory for the contact's size, by the laws of the whole pad."""
    row, thickness = case.highest_row, _thickness(case.pad.manifest)
    for kind in ("half_space", "layer"):
        checks = {name: CHECKS[f"{name.rsplit('_', 1)[0]}_on_{kind}"] for name in (MODULUS, INDENTATION)}
        if row is None or (kind == "layer" and thickness is None):
            why = case.nothing if row is None else "no thickness of the tissue is stated"
            yield from (check.untested(why) for check in checks.values())
        else:
            yield from _errors(case, row, checks, thickness if kind == "layer" else None)


def _errors(
    case: FingerAtAngle, row: Row, checks: Mapping[str, ValidityCheck], thickness: float | None
) -> Iterator[ValidityCheck]:
    """Yield the errors of E and ξ at the contact's load and area, or at the largest area with a law."""
    area = math.pi * row["semi_major_mm"] * row["semi_minor_mm"]
    angles = row["wedge_angle_deg"], row["roll_angle_deg"]
    assumed = pad_placement(case.pad.semi_axes, *angles)
    # Where the outline shows another radius than the ellipsoid's, the pad is larger as a whole.
    larger = row["geometric_mean_radius_mm"] / float(assumed.curvature.geometric_mean_radius)
    better = press(
        plate_gap(pad_placement(larger * case.pad.semi_axes, *angles)),
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
        widest = f"a/R = {ratio:.2f}, the widest in range"
        size += f": {FLAGS['layer'][flag].words}; off by at least this, the error at {widest}"
    exact = KPA_PER_MPA * (1 - case.study.poisson_ratio**2) * row["load_N"] / float(better.load[last])
    model = "half_space" if thickness is None else "layer"
    for name, output, value, reference in (
        (MODULUS, "youngs_modulus_on_layer", row[MODULUS] * share**-1.5, exact),
        (INDENTATION, "indentation_on_layer", row[INDENTATION] * share, float(better.indentation[last])),
    ):
        std = row[f"{name}_std"] * value / row[name]
        of_pad, of_pad_std = case.at_highest_load[model, output]
        reference_std = math.nan if flag else of_pad_std / of_pad * reference
        found = checks[name].of_known_error((value, std), (reference, reference_std), size)
        if flag:  # values of a narrower contact under this load are none of this contact's
            unknown = ("value", "value_std", "reference", "reference_std", "difference")
            found = found.with_fields(**dict.fromkeys(unknown, math.nan))
        yield found


# Loads at which a curve is compared, relative to its highest.
_SMALLEST_LOAD, _LARGEST_LOAD = 0.1, 1.05
_LAW_POINTS: Final = 400


def _without(std: float, part: float) -> float:
    """Return a standard uncertainty without a part of it."""
    return math.sqrt(max(std**2 - part**2, 0.0))


def without_misfit(loading: LoadingRadius) -> tuple[tuple[float, float], str]:
    """Return R_g with its standard uncertainty without that of a misfit, and a note."""
    if math.isnan(loading.std):
        return (loading.value, 0.0), "R_g has no stated uncertainty and is taken as exact"
    return (loading.value, _without(loading.std, loading.misfit_std)), ""


def _radius_check(case: FingerAtAngle) -> ValidityCheck:
    pooled, first = case.summary.compliance_radius, case.summary.first
    # Pooled on 1/H; exact Hertz theory has the geometric mean radius.
    factor = first["geometric_mean_radius_mm"] / first["mean_curvature_radius_mm"]
    value = None if pooled is None else (factor * pooled.value, factor * pooled.total_std)
    return _against_loading(case, CHECKS[ROUTES[RADIUS]], value)


def _against_loading(
    case: FingerAtAngle, check: ValidityCheck, value: tuple[float, float] | None, reading: float = 0.0
) -> ValidityCheck:
    """Compare a radius with R_g, which is uncertain by how it was read too, relative to it."""
    loading = case.loading
    if loading is None or value is None:
        return check.untested(case.no_loading_radius if loading is None else case.nothing)
    (radius, std), note = without_misfit(loading)
    std, log_std = math.hypot(std, reading * radius), None
    if loading.scale is not None and loading.scale == case.pad.scale:
        # Outlines and areas share it: the pad's radius goes with the scale, R_g with its square.
        apart = (value[1] / value[0]) ** 2 + (std / radius) ** 2
        log_std = math.sqrt(apart - (loading.area_std / radius) ** 2)
    read = f"± {100 * reading:.0f} % for how R_g was read" if reading else ""
    note = "; ".join(filter(None, (note, read)))
    return check.of_ratio(value, (radius, std), log_std=log_std, note=note)


def _from_loading_radius(case: FingerAtAngle) -> Iterator[ValidityCheck]:
    """Compare E and ξ with those that follow from the area and R_g, where no loading curve was fitted."""
    row, loading = case.highest_row, case.loading
    # For one area and load ξ goes with 1/R and E with R.
    for name, power in ((MODULUS, 1), (INDENTATION, -1)):
        if row is None or loading is None:
            yield CHECKS[ROUTES[name]].untested(case.no_loading_radius if loading is None else case.nothing)
            continue
        radius = row["geometric_radius_from_compliance_mm"]
        relative = row["geometric_radius_from_compliance_mm_std"] / radius
        other = without_misfit(loading)[0][1] / loading.value
        value, std = row[name], row[f"{name}_std"]
        reference = value * (loading.value / radius) ** power
        of_area = _without(std / value, relative)
        yield CHECKS[ROUTES[name]].of_ratio(
            (value, std),
            (reference, reference * math.hypot(of_area, other)),
            log_std=math.hypot(relative, other),
            note=f"at {row['load_N']:.3g} N, from area and R_g, so the same comparison as that of the radius",
        )


def _curve_checks(case: FingerAtAngle) -> Iterator[ValidityCheck]:
    """Compare results with those of the loading curves, at the highest load of both.

    Curves without areas have ξ alone: for one area and load E and the radius go with 1/ξ.
    """
    load, top = case.summary.column("load_N"), min(fit.modulus_load for fit in case.fits)
    under = (load <= _LARGEST_LOAD * top) & (load >= _SMALLEST_LOAD * top)
    inside = case.summary.where(case.summary.column("pooled") & under)
    if inside.empty or not case.pad.has_semi_axes:
        why = "no contact under a load of the curves" if case.pad.has_semi_axes else case.nothing
        yield from (CHECKS[ROUTES[name]].untested(why) for name in case.of_curves)
        return
    # Single contacts, and of each sequence the frame at the highest load.
    repeats = inside[inside["load_N"] >= SAME_LOAD * inside["load_N"].max()]
    repeats = repeats.sort_values("load_N", ascending=False, kind="stable")
    repeats = repeats.iloc[np.unique(items_of(repeats), return_index=True)[1]]
    common = math.exp(np.log(repeats["load_N"].to_numpy()).mean())
    factor = 1 - case.study.poisson_ratio**2  # the same in both moduli, so without its uncertainty
    given = case.study.uncertainty
    load_std, gain_std = given.load_relative_std, given.load_gain_relative_std
    of_modulus, (log_xi, xi_std) = _at_load(case.fits, common, factor, gain_std)
    modulus, modulus_std = _mean_of_repeats(
        repeats, "reduced_modulus_kpa", np.hypot(1.5 * area_noise(repeats), load_std)
    )
    # The gain of the force is the same in both moduli, and in the load at which the curve is read.
    modulus_std = _without(modulus_std, gain_std * modulus)
    xi, of_xi = _mean_of_repeats(repeats, INDENTATION, area_noise(repeats))
    # The curve's ξ is read at the contact's load, which is uncertain.
    xi_std = math.hypot(xi_std, load_std * 2 / 3)
    first, spread = repeats.iloc[0], math.hypot(of_xi / xi, xi_std)
    radius = tuple(first[f"geometric_radius_from_compliance_mm{end}"] for end in ("", "_std"))
    found = {
        RADIUS: (radius, (math.nan, math.nan)),
        MODULUS: ((factor * modulus, factor * modulus_std), of_modulus),
        INDENTATION: ((xi, of_xi), (log_xi, xi_std)),
    }
    for name in case.of_curves:
        value, (log_reference, log_std) = found[name]
        note, together = f"at {common:.3g} N", None
        if math.isnan(log_reference):
            log_reference = math.log(value[0] * xi) - log_xi
            log_std = math.hypot(xi_std, _without(of_xi / xi, radius[1] / radius[0]))
            note, together = f"{note}, from area and ξ, so the same comparison as that of ξ", spread
        other = math.exp(log_reference)
        yield CHECKS[ROUTES[name]].of_ratio(value, (other, other * log_std), log_std=together, note=note)


def _mean_of_repeats(rows: pd.DataFrame, column: str, own: FloatArray) -> tuple[float, float]:
    """Return the mean of a column over repeats, with what they share and how they scatter."""
    relative = rows[f"{column}_std"].to_numpy() / rows[column].to_numpy()
    own = np.minimum(relative, own)
    shared = np.sqrt(relative**2 - own**2)
    pooled = pool(np.log(rows[column].to_numpy()), own, np.outer(shared, shared))
    return math.exp(pooled.value), math.exp(pooled.value) * pooled.total_std


def _at_load(
    fits: Sequence[LoadingFit], load: float, factor: float, gain_std: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return ln E (kPa) and ln ξ (mm) of some loading curves, without the uncertainty of the force's gain.

    How far curves differ is part of their uncertainty.
    """
    found = []
    for fit in fits:
        law, offset = fit.models["load_dependent"], fit.contact_offset
        radius, top = fit.loading_radius, fit.reduced_modulus
        place_std = _without(offset.std, fit.misfit_std["contact_offset"])
        depth = np.linspace(0, _LARGEST_LOAD * float(fit.secant.indentation.max()), _LAW_POINTS)
        loads = law.load(depth + law.values["contact_offset"])
        xi, deepest = (float(np.interp(at, loads, depth)) for at in (load, fit.modulus_load))
        modulus = math.nan, math.nan
        if _has_modulus(fit):
            of_sphere = 0.75 * KPA_PER_MPA * load / (math.sqrt(radius.value) * xi**1.5)
            e = factor * fit.shape_factor * of_sphere
            more = 1.5 * place_std * (1 / xi - 1 / deepest)  # of the place of contact at a smaller load
            common_std = math.hypot(fit.misfit_std["reduced_modulus"], gain_std * top.value)
            at_top = _without(top.std, common_std) / top.value
            modulus = math.log(e), math.hypot(at_top, more)
        found.append((*modulus, math.log(xi), place_std / xi))
    moduli, modulus_stds, xi_values, xi_stds = np.transpose(found)
    return of_curves(moduli, modulus_stds), of_curves(xi_values, xi_stds)


def of_curves(values: FloatArray, stds: FloatArray) -> tuple[float, float]:
    """Return the mean of curves, with how far another one would differ from it."""
    known = np.isfinite(values) & (stds > 0)
    if not known.any():
        return math.nan, math.nan
    pooled = pool_random_effects(values[known], stds[known])
    return pooled.value, math.hypot(pooled.total_std, pooled.between_std)


# A larger radius makes E from the area larger and E from the indentation smaller; thicker tissue makes both
# larger.
_OPPOSITE: Final = ("semi-axes", "pad shape", "wedge angle", "roll angle")
_ALIKE: Final = ("thickness", "Poisson's ratio")
# On a layer a slope of area against πξ and the ratio at one load differ by so much: docs/explanation/bone.md.
_READING: Final = 0.05


def layer_checks(case: FingerAtAngle, curves: Sequence[CurveResult]) -> Iterator[ValidityCheck]:
    """Yield the checks of the layer; none without a thickness, or out of the range of the laws."""
    if (on_layer := case.summary.on_layer) is None or on_layer.highest_load.layer_flag:
        return
    found = LayerQuantity.of(on_layer.highest_load, "loading_radius_on_layer")
    yield _against_loading(
        case, CHECKS["loading_radius_on_layer"], (found.value, found.std), reading=_READING
    )
    yield _modulus_check(case, on_layer.highest_load, curves)
    yield _shape_check(case)


def _modulus_check(
    case: FingerAtAngle, highest: summary_file.HighestLoadOnLayer, curves: Sequence[CurveResult]
) -> ValidityCheck:
    by_curve = [
        LayerQuantity.of(found, "youngs_modulus_from_indentation_on_layer")
        for curve in curves
        if curve.fit in case.fits
        and (found := curve_on_layer(case.study, case.pad, curve)) is not None
        and not found.layer_flag
    ]
    if not by_curve:
        why = "in the range of the laws" if case.fits else "of this finger at this angle"
        return CHECKS["modulus_on_layer"].untested(f"no loading curve {why}")
    own, first = LayerQuantity.of(highest, "youngs_modulus_on_layer"), by_curve[0]
    stds = np.array([one.std / one.value for one in by_curve])
    log_value, std = of_curves(np.log([one.value for one in by_curve]), stds)
    shared = sum(_relative(own, source) * _relative(first, source) for source in _OPPOSITE)
    shared -= sum(_relative(own, source) * _relative(first, source) for source in _ALIKE)
    shared -= case.study.uncertainty.load_gain_relative_std**2  # both moduli go with the force
    variance = (own.std / own.value) ** 2 + std**2 + 2 * shared
    value = math.exp(log_value)
    return CHECKS["modulus_on_layer"].of_ratio(
        (own.value, own.std), (value, value * std), log_std=math.sqrt(max(variance, 0.0))
    )


def _relative(quantity: LayerQuantity, source: str) -> float:
    """Return the relative standard uncertainty of a quantity from one source."""
    return quantity.std / quantity.value * math.sqrt(max(quantity.budget.get(source, 0.0), 0.0))


def _shape_check(case: FingerAtAngle) -> ValidityCheck:
    shape, row, pad = _measured_shape(case), case.highest_row, case.pad
    if shape is None or row is None:
        return CHECKS["shape_on_layer"].untested(case.nothing)
    form = law_form(
        plate_gap(pad_placement(pad.semi_axes, row["wedge_angle_deg"], row["roll_angle_deg"])),
        area=math.pi * row["semi_major_mm"] * row["semi_minor_mm"],
        thickness=pad.manifest.effective_thickness_mm,
        poisson_ratio=case.study.poisson_ratio,
    )
    ratio = float(form.semi_major / form.semi_minor)
    predicted = math.log(ratio if form.along else 1 / ratio)
    return shape.against(predicted, CHECKS["shape_on_layer"])


def validity_of(
    rows: Rows, summaries: Sequence[Summary], curves: Sequence[CurveResult]
) -> list[summary_file.ValidityRecord]:
    """Check Hertz theory at each finger and angle; its discrepancy is that of all real or synthetic."""
    estimates = _at_highest_loads(rows)
    cases = [FingerAtAngle(rows, one, curves, estimates.get(one.key, {})) for one in summaries]
    routes = {
        (synthetic, route): _discrepancy(
            found
            for case in cases
            for found in case.checks
            if case.summary.synthetic == synthetic and found.check == route
        )
        for synthetic, route in product((False, True), ROUTES.values())
    }
    return [_validity(case, routes) for case in cases]


def _checks(case: FingerAtAngle) -> tuple[ValidityCheck, ...]:
    """Return all checks of Hertz theory at a place."""
    shape, check = _measured_shape(case), CHECKS["shape"]
    found = (
        *(() if RADIUS in case.of_curves else (_radius_check(case),)),
        *(_curve_checks(case) if case.fits else _from_loading_radius(case)),
        check.untested(case.nothing) if shape is None else shape.against(shape.predicted, check),
        *area_checks(case),
        *size_checks(case),
    )
    # What follows from R_g or from ξ alone is one comparison.
    alike = case.of_curves if case.fits else HEADLINES
    same = set() if any(map(_has_modulus, case.fits)) else {ROUTES[name] for name in alike}
    return judge_together(found, same)


def _discrepancy(checks: Iterable[ValidityCheck]) -> ModelDiscrepancy | None:
    """Return the discrepancy that comparisons of two ways to a result show; None without any."""
    pairs = [
        (ratio := math.log1p(one.relative_difference), ratio / one.deviations)
        for one in checks
        if one.deviations and math.isfinite(one.relative_difference)
    ]
    return model_discrepancy(*np.transpose(pairs)) if pairs else None


def _validity(
    case: FingerAtAngle, routes: Mapping[tuple[bool, str], ModelDiscrepancy | None]
) -> summary_file.ValidityRecord:
    """Return the checks of a place with the headlines that they concern."""
    over_loads = _change_over_loads(case)
    headlines = {}
    for name in HEADLINES:
        parts, words = [], []
        if (route := routes[case.summary.synthetic, ROUTES[name]]) is not None:
            parts.append(route.relative_std)
            words.append(f"{counted(route.count, 'comparison')} of images with loading data")
        if name == MODULUS and not math.isnan(over_loads):
            parts.append(over_loads)
            words.append("its change over loads")
        relative = math.hypot(*parts) if parts else math.nan
        value, std = _result(case, name)
        headlines[name] = summary_file.HeadlineRecord(
            value=value,
            value_std=std,
            model_std=value * relative,
            total_std=math.hypot(std, value * relative) if parts else std,
            model_relative_std=relative,
            model_from=" and ".join(words) or "not estimated: no loading data to compare with",
            verdict=overall_verdict(one.verdict for one in case.checks if name in one.headlines),
        )
    worst = overall_verdict(one.verdict for one in case.checks)
    on_layer = summary_file.LayerValidityRecord(
        verdict=overall_verdict(one.verdict for one in case.of_layer), checks=list(case.of_layer)
    )
    return summary_file.ValidityRecord(
        model="Hertz theory",
        # An exponent alone, of a finger without semi-axes, tests no theory.
        verdict=NOT_TESTED if worst == HOLDS and not case.highest else worst,
        observation=case.highest.observation if case.highest else "",
        load_N=case.highest.load if case.highest else math.nan,
        headlines=headlines,
        checks=list(case.checks),
        on_layer=on_layer if case.of_layer else None,
    )


def _result(case: FingerAtAngle, name: str) -> tuple[float, float]:
    """Return a headline and its standard uncertainty from what was measured, NaN without one."""
    row, pooled = case.highest_row, case.summary.corrected_radius
    if name == RADIUS:
        return (pooled.value, pooled.total_std) if pooled else (math.nan, math.nan)
    return (row[name], row[f"{name}_std"]) if row else (math.nan, math.nan)


def _change_over_loads(case: FingerAtAngle) -> float:
    """Return the standard deviation of ln E that its trend over loads makes; NaN at one load."""
    (growth,) = (one for one in case.checks if one.check == GROWTH)
    if math.isnan(growth.value):
        return math.nan
    excess = growth.difference**2 - growth.value_std**2
    return 1.5 * math.sqrt(max(excess, 0.0)) * float(np.log(case.loaded["load_N"].to_numpy()).std())


def with_verdicts(
    table: pd.DataFrame, summaries: Iterable[Summary], validities: Iterable[summary_file.ValidityRecord]
) -> pd.DataFrame:
    """Return the table with the columns of the verdict, of what the model adds, and of the total."""
    stds = [f"{name}_{part}_std" for name in HEADLINES for part in ("model", "total")]
    columns = {name: table[name].to_numpy(copy=True) for name in ("model_verdict", *stds)}
    for summary, validity in zip(summaries, validities, strict=True):
        places = summary.places
        columns["model_verdict"][places] = validity.verdict
        for name in HEADLINES:
            model_std = validity.headlines[name].model_relative_std * summary.column(name).to_numpy()
            columns[f"{name}_model_std"][places] = model_std
            std = summary.column(f"{name}_std")
            columns[f"{name}_total_std"][places] = np.hypot(std, np.nan_to_num(model_std))
    return table.assign(**{name: COLUMNS[name].series(array) for name, array in columns.items()})
