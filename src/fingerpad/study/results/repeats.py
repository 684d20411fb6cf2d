"""Repeats of a contact, recognised by finger, placement and load, and how they scatter."""

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, takewhile
from typing import Any, Final

import numpy as np
import pandas as pd

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad._words import counted
from fingerpad.image import implausible_size
from fingerpad.study.manifest.models import Contact, Observation, Study
from fingerpad.study.measuring.contacts import RIDGES_MERGE, Measurement, excluding_flags, is_pooled
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.model import contact_inputs
from fingerpad.study.results.table import GrowingArray, Indices, groups, items, numbered
from fingerpad.uncertainty import NestedScatter, ScatterComponent, nested_scatter
from fingerpad.uncertainty.repeats import ContactRepeatability, nominal_loads, too_few_repeats
from fingerpad.uncertainty.scatter import MIN_LEVEL_FREEDOM, REPEAT

# Columns of which the scatter is stated, each as the standard deviation of its logarithm.
SCATTER_OF: Final[Mapping[str, str]] = {
    "contact_area": "contact area A",
    "ridge_area": "ridge area",
    "youngs_modulus": "Young's modulus E from load and area",
    "aspect_ratio": "aspect ratio ℓd/ℓe",
    "radius_from_indentation": "corrected radius",
}
LEVELS: Final[Mapping[str, str]] = {
    "person": "between persons",
    "finger": "between fingers",
    "session": "between sessions",
    REPEAT: "repeats",
}
_BETWEEN: Final = ("person", "finger")
_PLACED: Final = ("wedge_angle_deg", "roll_angle_deg", "synthetic")
# Columns from which `contact_quantity` finds `SCATTER_OF`.
QUANTITY_COLUMNS: Final = (
    *("gross_area_mm2", "semi_major_mm", "semi_minor_mm", "aspect_ratio"),
    *("ridge_area_mm2", "flags", "youngs_modulus_kpa", "radius_from_indentation_mm"),
)
_AT_ONCE: Final = 500


def conditions_of(placed: Iterable[Hashable], loads: ArrayLike) -> Indices:
    """Return a number for the placement and nominal load of each contact."""
    placement, loads = numbered(placed), as_float_array(loads)
    load = np.zeros(placement.size, dtype=np.intp)
    for one in np.unique(placement):
        load[placement == one] = nominal_loads(loads[placement == one])
    return numbered(zip(placement.tolist(), load.tolist(), strict=True))


def contact_repeatability(
    study: Study, fingers: Mapping[str, FingerResult], seen: Iterable[tuple[Contact, Measurement]]
) -> dict[bool, ContactRepeatability]:
    """Return how the pooled repeats of a study scatter: real contacts (False), and synthetic (True)."""
    known = {False: _Repeats(), True: _Repeats()}
    plausible = {name: not implausible_size(finger.semi_axes).any() for name, finger in fingers.items()}
    repeated = iter(_repeated(study, seen))
    while batch := list(islice(repeated, _AT_ONCE)):
        pooled: dict[bool, list[tuple[Observation, Measurement]]] = {False: [], True: []}
        for contact, measured in batch:
            finger = fingers[contact.finger]
            excluding = excluding_flags(contact, measured, plausible=plausible[contact.finger])
            if is_pooled(measured, excluding):
                pooled[contact.synthetic or finger.synthetic].append((contact, measured))
        for synthetic, some in pooled.items():
            known[synthetic].add(study, fingers, some)
    return {synthetic: repeats.scatter() for synthetic, repeats in known.items()}


def _repeated(
    study: Study, seen: Iterable[tuple[Contact, Measurement]]
) -> Iterable[tuple[Observation, Measurement]]:
    """Yield observations, none if no finger has two at one placement: then nothing need be read."""
    placed = {(one.finger, one.wedge_angle_deg, one.roll_angle_deg) for one in study.observations}
    if study.observations and len(placed) == len(study.observations):
        return ()
    return (
        (contact, measured)
        for contact, measured in takewhile(lambda one: isinstance(one[0], Observation), seen)
        if isinstance(contact, Observation)
    )


class _Repeats:
    """Ellipses of contacts that count, with what each is a repeat of."""

    def __init__(self) -> None:
        self._axes, self._noise = GrowingArray(np.empty((0, 2))), GrowingArray(np.empty((0, 2, 2)))
        self._load = GrowingArray(np.empty(0))
        self._placed: list[tuple[float, float]] = []
        self._unit: list[tuple[str, str | None]] = []
        self._tuples: dict[tuple[Any, ...], tuple[Any, ...]] = {}

    def add(
        self,
        study: Study,
        fingers: Mapping[str, FingerResult],
        seen: Sequence[tuple[Observation, Measurement]],
    ) -> None:
        """Add some contacts."""
        inputs = contact_inputs(study, fingers, seen)
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
        condition = conditions_of(self._placed, self._load.array)
        group = numbered(zip(self._unit, condition.tolist(), strict=True))
        return ContactRepeatability.of(axes[usable], noise[usable], group[usable])


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyScatter:
    """How a quantity scatters over a study's contacts, on the scale of its logarithm."""

    quantity: str  # one of `SCATTER_OF`
    synthetic: bool  # whether it is of rendered contacts
    scatter: NestedScatter
    missing: dict[str, str]  # why a level is not known, in words


def study_scatter(study: Study, table: pd.DataFrame) -> list[StudyScatter]:
    """Return the scatter of each quantity over the contacts that count; frames repeat nothing."""
    # Not all columns: a copy of them is as large as everything else that a run holds.
    rows = table[["finger", "session", *_PLACED, "load_N", *QUANTITY_COLUMNS]]
    rows = rows[table["pooled"] & table["frame"].isna()]
    persons = {finger.name: finger.person for finger in study.fingers}
    return [
        _scatter(name, synthetic, rows.iloc[places], persons)
        for (synthetic,), places in sorted(groups(rows, "synthetic").items())
        for name in SCATTER_OF
    ]


def _scatter(
    quantity: str, synthetic: bool, rows: pd.DataFrame, persons: Mapping[str, str | None]
) -> StudyScatter:
    values = contact_quantity(rows, quantity)
    usable = np.isfinite(values) & (values > 0)
    rows, values = rows[usable], values[usable]
    fingers, sessions = items(rows["finger"]), items(rows["session"])
    levels = {
        "person": numbered(("", name) if persons[name] is None else (persons[name],) for name in fingers),
        "finger": numbered(fingers),
        "session": numbered(zip(fingers, sessions, strict=True)),
    }
    placed = zip(*(items(rows[name]) for name in _PLACED), strict=True)
    condition = conditions_of(placed, rows["load_N"].to_numpy())
    scatter = nested_scatter(np.log(values), levels, condition, _BETWEEN)
    named = {"person": any(persons[name] for name in fingers), "session": any(sessions), "finger": True}
    missing = {
        level: _why_missing(level, one, named=named.get(level, True), scatter=scatter)
        for level, one in scatter.components.items()
        if not one.known
    }
    return StudyScatter(quantity=quantity, synthetic=synthetic, scatter=scatter, missing=missing)


def contact_quantity(rows: pd.DataFrame, quantity: str) -> FloatArray:
    """Return one of `SCATTER_OF`; without an image the area is the ellipse's. NaN is unknown."""
    if quantity == "contact_area":
        gross = rows["gross_area_mm2"].to_numpy()
        ellipse = np.pi * rows["semi_major_mm"].to_numpy() * rows["semi_minor_mm"].to_numpy()
        return as_float_array(np.where(np.isfinite(gross), gross, ellipse))
    if quantity == "ridge_area":
        merged = [RIDGES_MERGE in (flags or "").split() for flags in items(rows["flags"])]
        return np.where(merged, np.nan, rows["ridge_area_mm2"].to_numpy())
    names = {
        "youngs_modulus": "youngs_modulus_kpa",
        "aspect_ratio": "aspect_ratio",
        "radius_from_indentation": "radius_from_indentation_mm",
    }
    return as_float_array(rows[names[quantity]].to_numpy())


def _why_missing(level: str, one: ScatterComponent, *, named: bool, scatter: NestedScatter) -> str:
    repeat = scatter.components[REPEAT]
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
            "session": "no finger has two sessions under one load",
        }[level]
    return f"{counted(one.freedom, 'degree')} of freedom; {MIN_LEVEL_FREEDOM} are needed"
