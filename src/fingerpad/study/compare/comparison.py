"""Studies compared: values, means over people, and what a reader must know of them."""

import math
from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from fingerpad._csv import write_csv
from fingerpad._display import Displayed
from fingerpad._files import make_folder
from fingerpad._json import dumps
from fingerpad._plausible import PLAUSIBLE_MODULUS_KPA
from fingerpad.exceptions import FingerpadError
from fingerpad.study.compare.values import (
    QUANTITIES,
    FinishedStudy,
    Person,
    ValidityVerdict,
    Value,
    read_finished,
    values_of,
    verdicts_of,
)
from fingerpad.uncertainty import RandomEffects, pool_random_effects, proportional_stds


@dataclass(frozen=True, slots=True, kw_only=True)
class PersonMean:
    """The mean over one person's fingers."""

    person: Person
    fingers: int
    # value, std: the mean and its standard uncertainty
    value: float
    std: float


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Mean(Displayed):
    """The mean of a quantity over people, real ones or synthetic ones."""

    quantity: str  # one of `QUANTITIES`
    # wedge_angle_deg, roll_angle_deg: the placement; None for what belongs to the finger alone
    wedge_angle_deg: float | None
    roll_angle_deg: float | None
    synthetic: bool  # whether it is over rendered or simulated fingers; the two never mix
    people: tuple[PersonMean, ...]
    # value, std: the mean and its standard uncertainty, with what fingers of a study share, and values from a
    # model
    value: float
    std: float
    interval: tuple[float, float] | None  # 95 % interval of the mean; None for one person
    # standard deviation between people beyond what uncertainties explain; NaN for one person
    between_people_std: float
    # the same between fingers of a person, over all who have several; NaN where no person has
    between_fingers_std: float

    @property
    def fingers(self) -> int:
        """Number of fingers."""
        return sum(person.fingers for person in self.people)

    def as_record(self) -> dict[str, Any]:
        """Return the mean with units in its keys."""
        return {
            "quantity": self.quantity,
            "unit": QUANTITIES[self.quantity].unit or "1",
            "wedge_angle_deg": self.wedge_angle_deg,
            "roll_angle_deg": self.roll_angle_deg,
            "synthetic": self.synthetic,
            "people": len(self.people),
            "fingers": self.fingers,
            "value": self.value,
            "std": self.std,
            "ci95_low": self.interval and self.interval[0],
            "ci95_high": self.interval and self.interval[1],
            "between_people_std": self.between_people_std,
            "between_fingers_std": self.between_fingers_std,
        }


class _Level(NamedTuple):
    """A value with its own standard uncertainty, and what each study's wedge and force, and the model add."""

    value: float
    own_std: float
    shared: dict[Hashable, float]

    @property
    def std(self) -> float:
        return math.hypot(self.own_std, *self.shared.values())


def means_of(values: Iterable[Value]) -> list[Mean]:
    """Return the mean of each quantity at each placement; values without uncertainty have no weight.

    Three levels of random effects (Paule–Mandel, Hartung–Knapp): a finger's values, as from several curves or
    studies, then a person's fingers, then people. Several fingers of one person are not independent
    people: they make one person better known, and no more people.
    """
    groups: dict[Hashable, list[Value]] = {}
    for value in values:
        if value.std > 0:
            groups.setdefault(value.mean_key, []).append(value)
    return [_mean(members) for members in groups.values()]


def _mean(values: Sequence[Value]) -> Mean:
    quantity, wedge, roll, synthetic = values[0].mean_key
    proportional = QUANTITIES[quantity].proportional
    people: dict[Person, dict[str, list[_Level]]] = {}
    for value in values:
        shared: dict[Hashable, float] = {
            (value.study, value.wedge_angle_deg): value.shared_std,
            (value.study, "force"): value.gain_std,
            "model": value.model_std,
        }
        own = math.sqrt(max(0.0, value.std**2 - sum(std**2 for std in shared.values())))
        level = _Level(value.value, own, shared)
        people.setdefault(value.person, {}).setdefault(value.finger, []).append(level)
    persons, scatters = [], []
    for fingers in people.values():
        members = [_pooled(levels, proportional)[0] for levels in fingers.values()]
        level, pooled = _pooled(members, proportional)
        persons.append((level, len(fingers)))
        if len(fingers) > 1:
            scatters += (len(fingers) - 1) * [pooled.between_std]
    _, pooled = _pooled([level for level, _ in persons], proportional)
    several = len(persons) > 1
    return Mean(
        quantity=quantity,
        wedge_angle_deg=wedge,
        roll_angle_deg=roll,
        synthetic=synthetic,
        people=tuple(
            PersonMean(person=person, fingers=count, value=level.value, std=level.std)
            for person, (level, count) in zip(people, persons, strict=True)
        ),
        value=pooled.value,
        std=pooled.total_std,
        interval=_interval(pooled, proportional) if several else None,
        between_people_std=pooled.between_std if several else math.nan,
        between_fingers_std=float(np.sqrt(np.mean(np.square(scatters)))) if scatters else math.nan,
    )


def _interval(pooled: RandomEffects, positive: bool) -> tuple[float, float]:
    """Return the 95 % interval of a mean, that of a positive quantity on its logarithm.

    Student's t of one or two degrees of freedom would reach below zero otherwise; and the means of few values
    that scatter widely are skewed, as their logarithms are not.
    """
    if not (positive and pooled.value > 0):
        return pooled.interval
    factor = float(np.exp((pooled.interval[1] - pooled.value) / pooled.value))
    return pooled.value / factor, pooled.value * factor


def _pooled(levels: Sequence[_Level], proportional: bool) -> tuple[_Level, RandomEffects]:
    """Pool one level, and return it as a member of the next with its scatter."""
    value = np.array([level.value for level in levels])
    own = np.maximum([level.own_std for level in levels], np.spacing(np.abs(value)))
    sources = list(dict.fromkeys(source for level in levels for source in level.shared))
    parts = np.array([[level.shared.get(source, 0.0) for source in sources] for level in levels])
    stds = proportional_stds(value, own) if proportional else own
    pooled = pool_random_effects(value, stds, parts @ parts.T)
    shared = dict(zip(sources, map(float, pooled.weights @ parts), strict=True))
    return _Level(pooled.value, pooled.std, shared), pooled


# Curves whose velocities differ by more are not of one kind: moduli grow with velocity.
_SAME_VELOCITY: Final = 1.5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Comparison(Displayed):
    """Several finished studies side by side."""

    studies: tuple[FinishedStudy, ...]
    values: tuple[Value, ...]
    means: tuple[Mean, ...]  # over people, for each quantity and placement, real and synthetic apart
    # whether Hertz theory, and the layer where there is one, hold for each finger at each placement
    verdicts: tuple[ValidityVerdict, ...]
    notes: tuple[str, ...]  # what a reader must know

    def of(self, quantity: str) -> tuple[list[Value], list[Mean]]:
        """Return values and means of one quantity, by angle, real before synthetic."""
        values = [value for value in self.values if value.quantity == quantity]
        means = [mean for mean in self.means if mean.quantity == quantity]
        return sorted(values, key=_order), sorted(means, key=_order)

    def as_record(self) -> dict[str, Any]:
        """Return the comparison as plain data."""
        return {
            "studies": [
                {
                    "study": study.title,
                    "folder": str(study.folder),
                    "fingerpad": study.summary.provenance.fingerpad,
                    "made": study.summary.provenance.made,
                    "failures": len(study.summary.failures),
                }
                for study in self.studies
            ],
            "values": [value.as_record() for value in self.values],
            "means": [
                {
                    **mean.as_record(),
                    "by_person": [
                        {
                            "person": each.person.name,
                            "named": each.person.named,
                            "fingers": each.fingers,
                            "value": each.value,
                            "std": each.std,
                        }
                        for each in mean.people
                    ],
                }
                for mean in self.means
            ],
            "verdicts": [{**verdict.as_record(), "compared": verdict.compared} for verdict in self.verdicts],
            "notes": self.notes,
        }


def _order(one: Value | Mean) -> tuple[float, float, bool]:
    return one.wedge_angle_deg or 0.0, one.roll_angle_deg or 0.0, one.synthetic


def compare_studies(paths: Sequence[Path]) -> Comparison:
    """Compare finished studies, each named by its output folder or a file in it."""
    studies = read_finished(paths)
    values = [value for study in studies for value in values_of(study)]
    if not values:
        raise FingerpadError("there is nothing to compare: no finger of these studies could be measured")
    order = list(QUANTITIES)
    plausible = (value for value in values if not _implausible(value))
    means = sorted(means_of(plausible), key=lambda mean: (order.index(mean.quantity), *_order(mean)))
    return Comparison(
        studies=tuple(studies),
        values=tuple(values),
        means=tuple(means),
        verdicts=tuple(verdict for study in studies for verdict in verdicts_of(study)),
        notes=tuple(_notes(studies, values)),
    )


def _implausible(value: Value) -> bool:
    """Return whether a value is a modulus that no finger has, as of loads in another unit."""
    least, most = PLAUSIBLE_MODULUS_KPA
    return QUANTITIES[value.quantity].unit == "kPa" and not least <= value.value <= most


def _notes(studies: Sequence[FinishedStudy], values: Sequence[Value]) -> Iterator[str]:
    versions = {study.summary.provenance.fingerpad for study in studies}
    if len(versions) > 1:
        each = ", ".join(f"{study.title} by {study.summary.provenance.fingerpad}" for study in studies)
        yield f"made by different versions of fingerpad ({each}): run them again with one before you conclude"
    for study in studies:
        unnamed = {value.finger for value in values if value.study == study.title and not value.person.named}
        if unnamed:
            yield (
                f"{study.title}: the manifest names no person for {', '.join(sorted(unnamed))}: taken as "
                "fingers of one person, who is in no other study; "
                'write person = "…" at each finger to say whose it is'
            )
        if failures := len(study.summary.failures):
            yield f"{study.title}: {failures} could not be measured, see its own report"
    if any(value.synthetic for value in values):
        yield "synthetic fingers were rendered or simulated: their means are their own, never with real ones"
    for quantity in QUANTITIES:
        alike = [value for value in values if value.quantity == quantity]
        if alike and not all(value.std > 0 for value in alike):
            lacking = sum(not value.std > 0 for value in alike)
            yield f"{quantity}: {lacking} of {len(alike)} values have no uncertainty and stand in no mean"
    for value in filter(_implausible, values):
        yield (
            f"{value.study}, {value.finger}: {value.quantity} {value.value:.3g} lies outside "
            "1–5000 kPa and stands in no mean: check load and scale"
        )
    speeds = [value.velocity_mm_per_s for value in values if value.velocity_mm_per_s > 0]
    if speeds and max(speeds) > _SAME_VELOCITY * min(speeds):
        yield (
            f"loading curves were taken at {min(speeds):.2g} to {max(speeds):.2g} mm/s; skin is the stiffer "
            "the faster it is pressed, and means of E_0g mix what differs for that reason"
        )


def write_comparison(comparison: Comparison, out: Path) -> None:
    """Write ``compare*.csv`` (values, means, verdicts) and ``compare.json`` into a folder."""
    make_folder(out)
    try:
        for name, rows in (
            ("compare", comparison.values),
            ("compare_means", comparison.means),
            ("compare_validity", comparison.verdicts),
        ):
            records = [row.as_record() for row in rows]
            if records:
                write_csv(out / f"{name}.csv", [records[0], *(record.values() for record in records)])
        (out / "compare.json").write_text(dumps(comparison.as_record(), indent=1) + "\n", encoding="utf-8")
    except OSError as error:
        raise FingerpadError(
            f"{error.filename or out}: cannot be written ({error.strerror}): make room, or choose another"
        ) from error
