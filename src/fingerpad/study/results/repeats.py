"""Repeats of a contact: how they scatter, and area and modulus of a finger at each load, pooled over them."""

import math
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice, takewhile
from types import MappingProxyType
from typing import Any, Final, NamedTuple

import numpy as np
import pandas as pd
from scipy import special

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array
from fingerpad._plausible import PLAUSIBLE_MODULUS_KPA
from fingerpad._words import counted
from fingerpad.image import implausible_size
from fingerpad.study.manifest.models import Contact, Observation, Study
from fingerpad.study.measuring import contacts
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.layer import LAYER_PART_SOURCES, POOLED_ON_LAYER
from fingerpad.study.results.model import STATED_APART, contact_inputs
from fingerpad.study.results.rows import Rows
from fingerpad.study.results.summary_file import (
    AT_LOAD,
    PLACEMENT,
    AtLoadRecord,
    PlacementKey,
    ScatterLevelRecord,
    ScatterRecord,
    ValidityRecord,
)
from fingerpad.study.results.table import GrowingArray, Indices, groups, items, numbered
from fingerpad.study.results.validity.checks import HERTZ_EXPONENT, PRESS_STD
from fingerpad.study.results.validity.model_checks import MODULUS, NOT_TESTED, RADIUS
from fingerpad.uncertainty import NestedScatter, ScatterComponent, nested_scatter, pad_model
from fingerpad.uncertainty.propagate import NORMAL_97_5
from fingerpad.uncertainty.quantities import evaluate
from fingerpad.uncertainty.repeats import ContactRepeatability, nominal_loads, too_few_repeats
from fingerpad.uncertainty.scatter import LIMIT_FACTOR, MIN_LEVEL_FREEDOM, REPEAT
from fingerpad.units import KPA_PER_MPA

# Quantities of which the scatter is stated, each as the standard deviation of its logarithm.
SCATTER_OF: Final = (
    *("contact_area", "ridge_area", "youngs_modulus"),
    *("aspect_ratio", "radius_from_indentation"),
)
_BETWEEN: Final = ("person", "finger")
# Columns from which `contact_quantity` finds `SCATTER_OF`.
QUANTITY_COLUMNS: Final = (
    *("gross_area_mm2", "aspect_ratio", "ridge_area_mm2", "flags"),
    *("youngs_modulus_kpa", "radius_from_indentation_mm"),
)
_AT_ONCE: Final = 500
_AREA: Final = "gross_area_mm2"
# An area is unlike its repeats from so many usual deviations on, and from this difference of logarithms; a
# median of three is the least, and so many deviations tell what is usual.
_UNLIKE, _LEAST_UNLIKE, _FEWEST_REPEATS, _ENOUGH = 5.0, 0.2, 3, 6
# Through how many loads a line shows which of them lies off it, and from how many at most it is found.
_FEWEST_LOADS, _MOST_LOADS = 4, 60


def conditions_of(placed: Iterable[Hashable], loads: ArrayLike) -> Indices:
    """Return a number for the placement and nominal load of each contact."""
    placement, loads = numbered(placed), as_float_array(loads)
    load = np.zeros(placement.size, dtype=np.intp)
    order = np.argsort(placement, kind="stable")
    for places in np.split(order, np.flatnonzero(np.diff(placement[order])) + 1):
        load[places] = nominal_loads(loads[places])
    return numbered(zip(placement.tolist(), load.tolist(), strict=True))


def contact_repeatability(
    study: Study, fingers: Mapping[str, FingerResult], seen: Iterable[tuple[Contact, contacts.Measurement]]
) -> dict[bool, ContactRepeatability]:
    """Return how the pooled repeats of a study scatter: real contacts (False), and synthetic (True)."""
    known = {False: _Repeats(study, fingers), True: _Repeats(study, fingers)}
    notes = {
        name: [contacts.IMPLAUSIBLE_SIZE] if implausible_size(finger.semi_axes).any() else []
        for name, finger in fingers.items()
    }
    placed = {(one.finger, one.wedge_angle_deg, one.roll_angle_deg) for one in study.observations}
    # Where no finger has two observations at one placement nothing need be read.
    has_repeats = not study.observations or len(placed) < len(study.observations)
    repeated = takewhile(lambda one: has_repeats and isinstance(one[0], Observation), seen)
    while batch := list(islice(repeated, _AT_ONCE)):
        pooled: dict[bool, list[tuple[Observation, contacts.Measurement]]] = {False: [], True: []}
        for contact, measured in batch:
            assert isinstance(contact, Observation)
            finger = fingers[contact.finger]
            excluding = contacts.excluding_flags(contact, measured, notes[contact.finger])
            if contacts.is_pooled(measured, excluding):
                pooled[contact.synthetic or finger.synthetic].append((contact, measured))
        for synthetic, some in pooled.items():
            known[synthetic].add(some)
    return {synthetic: repeats.scatter() for synthetic, repeats in known.items()}


class _Repeats:
    """Ellipses of contacts that count, with what each is a repeat of."""

    def __init__(self, study: Study, fingers: Mapping[str, FingerResult]) -> None:
        self._study, self._fingers = study, fingers
        self._axes, self._noise = GrowingArray(np.empty((0, 2))), GrowingArray(np.empty((0, 2, 2)))
        self._load = GrowingArray(np.empty(0))
        self._placed: list[tuple[float, float]] = []
        self._unit: list[tuple[str, str | None]] = []
        self._tuples: dict[tuple[Any, ...], tuple[Any, ...]] = {}

    def add(self, seen: Sequence[tuple[Observation, contacts.Measurement]]) -> None:
        """Add some contacts, without those whose modulus no finger has: their rows are not pooled either."""
        inputs = contact_inputs(self._study, self._fingers, seen)
        with np.errstate(all="ignore"):
            outputs, values = evaluate(pad_model, inputs.names, inputs.mean)
        modulus, (least, most) = values[:, outputs.index("youngs_modulus")], PLAUSIBLE_MODULUS_KPA
        # Of a finger without semi-axes it is not known.
        plausible = ~((KPA_PER_MPA * modulus < least) | (KPA_PER_MPA * modulus > most))
        inputs, seen = inputs.at(plausible), [one for one, good in zip(seen, plausible, strict=True) if good]
        places = inputs.places(["contact_radius", "elongation"])
        radius = inputs.mean[:, places[0]]
        unit = np.stack([1 / radius, np.ones_like(radius)], axis=-1)
        own = inputs.covariance[:, np.array(places)[:, None], places]
        self._axes.add(np.stack([np.log(radius), inputs.mean[:, places[1]]], axis=-1))
        self._noise.add(own * unit[:, :, None] * unit[:, None, :])
        self._load.add(np.array([measured.load_N for _, measured in seen]))
        self._placed += [self._kept(contact.wedge_angle_deg, contact.roll_angle_deg) for contact, _ in seen]
        self._unit += [self._kept(contact.finger, contact.session) for contact, _ in seen]

    def _kept(self, *values: Any) -> Any:
        """Return the first tuple of some values: hundreds of thousands are equal."""
        return self._tuples.setdefault(values, values)

    def scatter(self) -> ContactRepeatability:
        """Return how they scatter."""
        axes, noise = self._axes.array, self._noise.array
        usable = np.isfinite(axes).all(axis=-1) & np.isfinite(noise).all(axis=(-2, -1))
        # For each finger alone: loads of many run on without a gap.
        placed = ((finger, *at) for (finger, _), at in zip(self._unit, self._placed, strict=True))
        condition = conditions_of(placed, self._load.array)
        group = numbered(zip(self._unit, condition.tolist(), strict=True))
        if _no_repeats(group[usable]):  # sessions of one press each: these are its repeats
            group = condition
        return ContactRepeatability.of(axes[usable], noise[usable], group[usable])


def _no_repeats(group: Indices) -> bool:
    """Return whether no two contacts are of one group."""
    return group.size == np.unique(group).size


def study_scatter(study: Study, table: pd.DataFrame) -> list[ScatterRecord]:
    """Return the scatter of each quantity over the contacts that count; frames repeat nothing."""
    # Not all columns: a copy of them is as large as everything else that a run holds.
    rows = table[[*PLACEMENT, "session", "load_N", *QUANTITY_COLUMNS]]
    rows = rows[table["pooled"] & table["frame"].isna()]
    persons = {finger.name: finger.person for finger in study.fingers}
    return [
        _scatter(name, synthetic, rows.iloc[places], persons)
        for (synthetic,), places in sorted(groups(rows, "synthetic").items())
        for name in SCATTER_OF
    ]


def _scatter(
    quantity: str, synthetic: bool, rows: pd.DataFrame, persons: Mapping[str, str | None]
) -> ScatterRecord:
    """Return how a quantity scatters, by level.

    The limit of agreement is that of two contacts in different groups of the level: of two repeats in one
    session, of two sessions, and so on, with what lies between all levels below.
    """
    values = contact_quantity(rows, quantity)
    usable = np.isfinite(values) & (values > 0)
    rows, values = rows[usable], values[usable]
    fingers, sessions = items(rows["finger"]), items(rows["session"])
    levels = {
        "person": numbered(("", name) if persons[name] is None else (persons[name],) for name in fingers),
        "finger": numbered(fingers),
        "session": numbered(zip(fingers, sessions, strict=True)),
    }
    placed = list(zip(*(items(rows[name]) for name in PLACEMENT[1:]), strict=True))  # of any finger
    # Each finger's nominal load first, by which loads of many fingers run on less.
    own = conditions_of(zip(fingers, placed, strict=True), rows["load_N"].to_numpy())
    condition = conditions_of(placed, rows["load_N"].groupby(own).transform("median").to_numpy())
    in_repeats = _no_repeats(numbered(zip(levels["session"].tolist(), condition.tolist(), strict=True)))
    if in_repeats:
        del levels["session"]
    scatter = nested_scatter(np.log(values), levels, condition, _BETWEEN)
    if in_repeats:
        scatter = _with_sessions_in_repeats(scatter)
    named = {"person": any(persons[name] for name in fingers), "session": any(sessions), "finger": True}
    outwards = np.array([one.std for one in reversed(scatter.components.values())])
    limits = LIMIT_FACTOR * np.sqrt(np.nancumsum(outwards**2))[::-1]
    return ScatterRecord(
        quantity=quantity,
        synthetic=synthetic,
        icc=scatter.icc,
        icc_ci95=scatter.icc_interval,
        levels=[
            ScatterLevelRecord.of(
                one,
                quantity=quantity,
                synthetic=synthetic,
                level=level,
                log_std=one.std,
                log_std_ci95_low=one.interval[0],
                log_std_ci95_high=one.interval[1],
                log_limit_of_agreement=limit if one.known else None,
                degrees_of_freedom=one.freedom,
                includes=" ".join(one.includes),
                missing=_why_missing(level, one, named=named.get(level, True), scatter=scatter),
            )
            for (level, one), limit in zip(scatter.components.items(), limits.tolist(), strict=True)
        ],
    )


def _with_sessions_in_repeats(scatter: NestedScatter) -> NestedScatter:
    """Return the scatter of contacts that are each the only one of their session under a load."""
    *outer, (_, repeat) = scatter.components.items()
    unknown = ScatterComponent(std=math.nan, interval=(math.nan, math.nan), freedom=0, groups=0, count=0)
    repeat = replace(repeat, includes=("session",) if repeat.known else ())
    return replace(scatter, components={**dict(outer), "session": unknown, REPEAT: repeat})


def unlike_repeats(
    table: pd.DataFrame, repeatability: Iterable[ContactRepeatability]
) -> tuple[dict[str, float], float]:
    """Return contacts that count whose areas depart from their repeats' by far more than repeats do.

    Each stands with the ratio of its area to their median. How far repeats depart, relative, is returned too:
    the median over all of them, which a few wrong ones do not move, or how they scatter within sessions, if
    that is less.
    """
    rows, area = _areas(table)
    placed = zip(*(items(rows[name]) for name in PLACEMENT), strict=True)
    repeats = area.groupby(conditions_of(placed, rows["load_N"].to_numpy()))
    size, apart = repeats.transform("size"), area - repeats.transform("median")
    several = apart[(size >= _FEWEST_REPEATS) & (apart != 0)].abs()
    # The median size of a normal deviate is 0.67 standard deviations, and of three about their median 0.7.
    usual = several.median() / 0.7 if several.size >= _ENOUGH else PRESS_STD
    usual = float(min([usual, *(one.area_std for one in repeatability if one.known)]))
    odd = several[several > max(_UNLIKE * usual, _LEAST_UNLIKE)].index
    names = items(rows["observation"].iloc[odd])
    return dict(zip(names, np.exp(apart[odd]).tolist(), strict=True)), usual


def _areas(table: pd.DataFrame) -> tuple[pd.DataFrame, "pd.Series[float]"]:
    """Return the contacts that count, and the logarithms of their areas."""
    rows = table[["observation", *PLACEMENT, "load_N", *QUANTITY_COLUMNS]]
    rows = rows[table["pooled"] & table["frame"].isna() & (table["load_N"] > 0)]
    return rows, pd.Series(np.log(contact_quantity(rows, "contact_area")))


def unlike_growth(table: pd.DataFrame, usual: float) -> dict[str, float]:
    """Return contacts that count whose areas lie far off the growth with load of their finger's others.

    Each stands with the ratio of its area to that growth, a power law through most of the loads; repeats
    depart by `usual`, relative.
    """
    rows, area = _areas(table)
    names = items(rows["observation"])
    found: dict[str, float] = {}
    for places in groups(rows, *PLACEMENT).values():
        load = rows["load_N"].to_numpy()[places]
        one = pd.DataFrame({"load": np.log(load), "area": area[places].to_numpy()})
        nominal = nominal_loads(load)
        line = one.groupby(nominal).median()
        if len(line) < _FEWEST_LOADS:
            continue
        off = _off_line(*line.to_numpy().T)
        odd = np.abs(off) > max(_UNLIKE * max(usual, np.median(np.abs(off)) / 0.67), _LEAST_UNLIKE)
        found |= {names[places[k]]: math.exp(off[at]) for k, at in enumerate(nominal) if odd[at]}
    return found


def _off_line(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return how far points lie off a line through most of them, by the least median of squares.

    Rousseeuw (1984): of the lines through two points, which a half of wrong ones does not move. Areas grow
    with loads, and no faster than they.
    """
    some = np.unique(np.linspace(0, x.size - 1, _MOST_LOADS).round().astype(int))
    first, second = some[np.stack(np.triu_indices(some.size, 1))]
    slope = (y[second] - y[first]) / (x[second] - x[first])
    off = np.abs(y[some] - y[first, None] - slope[:, None] * (x[some] - x[first, None]))
    half = some.size // 2
    typical = np.partition(off, half, axis=1)[:, half]
    best = np.argmin(np.where((slope > 0) & (slope < 1), typical, np.inf))
    off_best = np.abs(y - y[first[best]] - slope[best] * (x - x[first[best]]))
    good = off_best < max(_LEAST_UNLIKE / 2, 2 * typical[best])
    return np.asarray(y - np.polyval(np.polyfit(x[good], y[good], 1), x))


def contact_quantity(rows: pd.DataFrame, quantity: str) -> FloatArray:
    """Return one of `SCATTER_OF`; NaN is unknown."""
    if quantity == "ridge_area":
        merged = [contacts.RIDGES_MERGE in (flags or "").split() for flags in items(rows["flags"])]
        return np.where(merged, np.nan, rows["ridge_area_mm2"].to_numpy())
    columns = {"contact_area": _AREA, "youngs_modulus": MODULUS, "radius_from_indentation": RADIUS}
    return as_float_array(rows[columns.get(quantity, quantity)].to_numpy())


def _why_missing(level: str, one: ScatterComponent, *, named: bool, scatter: NestedScatter) -> str:
    repeat = scatter.components[REPEAT]
    if one.known:
        return ""
    if level == REPEAT:
        return too_few_repeats(one.groups, one.freedom)
    if not repeat.known:
        return "cannot be separated from repeats, which are missing"
    if not named:
        return f"the manifest names no {level}"
    if one.groups == 0:
        return {
            "person": "one person",
            "finger": "no person has two fingers under one load",
            "session": "part of the repeats: no session has two contacts under one load"
            if level in repeat.includes
            else "no finger has two sessions under one load",
        }[level]
    return f"{counted(one.freedom, 'degree')} of freedom; {MIN_LEVEL_FREEDOM} are needed"


_ROUNDING: Final = 1e-9
_ON_LAYER: Final = "youngs_modulus_on_layer"

# Logarithm of a factor by which nothing is known any more; larger ones overflow.
_MOST_UNCERTAIN: Final = 100.0


class _Quantity(NamedTuple):
    """A quantity of all contacts of a finger at one placement."""

    values: FloatArray  # positive, NaN where unknown
    parts: Mapping[str, FloatArray]  # standard uncertainties from noise, repeatability and edge
    total: FloatArray  # and from all
    scatter: ScatterLevelRecord | None  # of sessions, where that is known
    model: float = math.nan  # what the model adds, relative to the values


def _mean(name: str, of: _Quantity, chosen: BoolArray, *, freedom: float, sessions: int) -> dict[str, Any]:
    """Return the geometric mean of `name` over contacts under one load, by keys of a record.

    `freedom` is of the repeatability, infinite where that is not known; `sessions` is their number. Of no
    values nothing is known.

    Noise (in a modulus with the load's) and the scatter of repeats beyond it are divided by √n, the
    difference between sessions by the root of their number; contacts share the rest. The 95 % interval has
    Student's t for noise, repeatability and sessions where these are known.
    """
    chosen = chosen & ~np.isnan(of.values)
    values, scatter, ends = of.values[chosen], of.scatter, ("", *AT_LOAD, "_model_std")
    if not (count := values.size):
        return dict.fromkeys((f"{name}{end}" for end in ends), math.nan)
    relative = {part: np.fmax(std[chosen], 0) / values for part, std in of.parts.items()}
    apart = sum(each**2 for each in relative.values())
    whole = (np.fmax(of.total[chosen], 0) / values) ** 2
    rest = np.where(whole - apart > _ROUNDING * whole, whole - apart, 0.0)
    other = float(np.mean(np.sqrt(rest)))
    noise, repeat = (
        float(np.sqrt(np.sum(relative[part] ** 2)) / count) for part in ("noise", "repeatability")
    )
    edge = float(np.mean(relative["edge"]))
    session = scatter.log_std / math.sqrt(sessions) if scatter is not None else math.nan
    model = np.fmax(of.model, 0.0)
    own, between, shared = math.hypot(noise, repeat), np.fmax(session, 0.0), math.hypot(edge, other)
    half = math.hypot(
        _quantile(freedom) * own,
        _quantile(scatter.degrees_of_freedom if scatter is not None else math.inf) * between,
        NORMAL_97_5 * shared,
        NORMAL_97_5 * math.log1p(model),
    )
    half = min(half, _MOST_UNCERTAIN)
    std = math.hypot(own, between, shared, model)
    repeats = math.nan if math.isinf(freedom) else repeat
    factors = (1.0, std, math.exp(-half), math.exp(half), noise, repeats, session, edge, other, of.model)
    mean = float(np.exp(np.mean(np.log(values))))
    return {f"{name}{end}": mean * factor for end, factor in zip(ends, factors, strict=True)}


def _quantile(freedom: float) -> float:
    """Return the 97.5 % quantile of Student's t."""
    return NORMAL_97_5 if math.isinf(freedom) else float(special.stdtrit(freedom, 0.975))


def pool_by_load(
    rows: Rows,
    scatter: Sequence[ScatterRecord] = (),
    validities: Mapping[PlacementKey, ValidityRecord] = MappingProxyType({}),
) -> list[AtLoadRecord]:
    """Pool the contacts that count for each finger, placement and nominal load; frames are left out."""
    levels = [level for one in scatter for level in one.levels if level.level == "session"]
    between = {(one.quantity, one.synthetic): one for one in levels if not math.isnan(one.log_std)}
    counts = rows.table["pooled"] & rows.table["frame"].isna()
    table = rows.table[list(_COLUMNS)]
    table = table[counts & (table["load_N"] > 0)]
    found: list[AtLoadRecord] = []
    for key, places in groups(table, *PLACEMENT).items():
        group = table.iloc[places].sort_values("load_N", kind="stable")
        found += _at_loads(rows, key, group, validities.get(key), between)
    return found


def _at_loads(
    of: Rows,
    key: PlacementKey,
    rows: pd.DataFrame,
    validity: ValidityRecord | None,
    between: Mapping[tuple[str, bool], ScatterLevelRecord],
) -> Iterator[AtLoadRecord]:
    """Yield what the rows of a placement come to at each nominal load."""
    synthetic = bool(key[-1])
    repeatability = of.repeatability[synthetic]
    freedom = float(repeatability.freedom) if repeatability.known else math.inf
    area, noise, edge, total = (
        rows[f"{_AREA}{end}"].to_numpy() for end in ("", "_noise_std", "_edge_std", "_std")
    )
    repeats = area * repeatability.area_std
    # The load is in error, and the area is that of another load. The scatter of repeats has what differs.
    load = of.study.uncertainty.load_relative_std * (not repeatability.known)
    of_load, of_gain = (
        HERTZ_EXPONENT * std * area for std in (load, of.study.uncertainty.load_gain_relative_std)
    )
    noise, total = np.hypot(noise, of_load), np.sqrt(total**2 + of_load**2 + of_gain**2)
    # Of a finger without semi-axes no modulus is known.
    known = np.isin(rows.index, of.pooled)
    places, output = np.searchsorted(of.pooled, rows.index[known]), POOLED_ON_LAYER.index(_ON_LAYER)
    variances = np.full((len(rows), LAYER_PART_SOURCES.size), np.nan)
    variances[known] = (KPA_PER_MPA * of.layer_parts[places, output]) ** 2
    in_range = np.isfinite(variances).all(axis=-1)
    headline, on_layer = (validity.headlines[MODULUS], validity.on_layer) if validity else (None, None)
    of_area, of_modulus = (between.get((name, synthetic)) for name in ("contact_area", "youngs_modulus"))
    quantities = {
        "contact_area_mm2": _Quantity(
            area,
            {"noise": noise, "repeatability": repeats, "edge": edge},
            as_float_array(np.hypot(total, repeats)),
            of_area,
        ),
        MODULUS: _Quantity(
            rows[MODULUS].to_numpy(),
            {part: rows[f"{MODULUS}_{part}_std"].to_numpy() for part in _PARTS},
            rows[f"{MODULUS}_std"].to_numpy(),
            of_modulus,
            headline.model_relative_std if headline else math.nan,
        ),
        f"{_ON_LAYER}_kpa": _Quantity(
            np.where(in_range, rows[f"{_ON_LAYER}_kpa"], np.nan),
            {
                part: np.sqrt(variances[:, np.isin(LAYER_PART_SOURCES, sources)].sum(axis=-1))
                for part, sources in STATED_APART.items()
            },
            np.sqrt(variances.sum(axis=-1)),
            of_modulus,
        ),
    }
    loads, sessions, scales = (rows[name].to_numpy() for name in ("load_N", "session", "scale"))
    nominal = nominal_loads(loads)
    for here in (nominal == each for each in np.unique(nominal)):
        count, devices = len(set(sessions[here])), set(scales[here])
        means: dict[str, Any] = {}
        for name, quantity in quantities.items():
            means |= _mean(name, quantity, here, freedom=freedom, sessions=count)
        yield AtLoadRecord(
            **dict(zip(PLACEMENT, key, strict=True)),
            load_N=float(np.mean(loads[here])),
            contacts=int(here.sum()),
            sessions=count,
            scale=devices.pop() if len(devices) == 1 else None,
            **means,
            youngs_modulus_kpa_verdict=headline.verdict if headline else NOT_TESTED,
            youngs_modulus_on_layer_kpa_verdict=on_layer.verdict if on_layer and in_range[here].any() else "",
        )


_PARTS: Final = ("noise", "repeatability", "edge")
_COLUMNS: Final = (
    *(*PLACEMENT, "session", "load_N", "scale", *QUANTITY_COLUMNS),
    *("gross_area_mm2_std", "gross_area_mm2_noise_std", "gross_area_mm2_edge_std"),
    "youngs_modulus_kpa_std",
    *(f"youngs_modulus_kpa_{part}_std" for part in _PARTS),
    f"{_ON_LAYER}_kpa",
)
