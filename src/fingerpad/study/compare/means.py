"""Means over people: first within a finger, then within a person, then between people."""

import math
from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from fingerpad._display import Displayed
from fingerpad.study.compare.values import QUANTITIES, Person, Value
from fingerpad.uncertainty import RandomEffects, pool_random_effects, proportional_stds


@dataclass(frozen=True, slots=True, kw_only=True)
class PersonMean:
    """The mean over one person's fingers.

    Attributes
    ----------
    person : Person
        Who.
    fingers : int
        How many fingers.
    value, std : float
        The mean and its standard uncertainty.
    """

    person: Person
    fingers: int
    value: float
    std: float


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Mean(Displayed):
    """The mean of a quantity over people, real ones or synthetic ones.

    Attributes
    ----------
    quantity : str
        One of `QUANTITIES`.
    wedge_angle_deg, roll_angle_deg : float or None
        The placement; None for what belongs to the finger alone.
    synthetic : bool
        Whether it is over rendered or simulated fingers; the two never mix.
    people : tuple of PersonMean
        What it is made of.
    value, std : float
        The mean and its standard uncertainty, with what fingers of a study share, and values from a model.
    interval : (float, float) or None
        95 % interval of the mean; None for one person.
    between_people_std : float
        Standard deviation between people beyond what uncertainties explain; NaN for one person.
    between_fingers_std : float
        The same between fingers of a person, over all who have several; NaN where no person has.
    """

    quantity: str
    wedge_angle_deg: float | None
    roll_angle_deg: float | None
    synthetic: bool
    people: tuple[PersonMean, ...]
    value: float
    std: float
    interval: tuple[float, float] | None
    between_people_std: float
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
    """A value with its own standard uncertainty, and what each study's wedge and the model add to it."""

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
            groups.setdefault(value.place, []).append(value)
    return [_mean(members) for members in groups.values()]


def _mean(values: Sequence[Value]) -> Mean:
    quantity, wedge, roll, synthetic = values[0].place
    proportional = QUANTITIES[quantity].proportional
    people: dict[Person, dict[str, list[_Level]]] = {}
    for value in values:
        own = math.sqrt(max(0.0, value.std**2 - value.shared_std**2 - value.model_std**2))
        shared: dict[Hashable, float] = {
            (value.study, value.wedge_angle_deg): value.shared_std,
            "model": value.model_std,
        }
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
        interval=pooled.interval if several else None,
        between_people_std=pooled.between_std if several else math.nan,
        between_fingers_std=float(np.sqrt(np.mean(np.square(scatters)))) if scatters else math.nan,
    )


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
