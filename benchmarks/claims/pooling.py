"""Bias and coverage of everything that is pooled, in simulations.

Truths are drawn here, without the code under test; measured values scatter about them as their standard
uncertainties say, in proportion to the truth, and state uncertainties in proportion to themselves.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import product
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np

from benchmarks.arrays import Array, Rng
from benchmarks.simulated import contact, finger, study_of
from benchmarks.tables import table
from fingerpad._arrays import ArrayLike
from fingerpad.contact import equivalent_radius_from_compliance, equivalent_radius_from_indentation
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.image import FACE_AXES, SEMI_AXES, Face, FaceSemiAxes, combine_faces
from fingerpad.study.compare import Person, Value, means_of
from fingerpad.study.results.pooling import pool_contacts
from fingerpad.study.results.rows import Rows
from fingerpad.uncertainty import pool, pool_random_effects, proportional_stds

PAD = np.array([7.9, 13.8, 11.8])
RADIUS = 14.0
_STUDY, _PADS = study_of({"f": None}, PAD), {"f": finger("f", PAD)}
_MEAN = Placement(Ellipsoid(*PAD), wedge_angle=np.radians(30)).curvature.mean_curvature_radius
_VALUE: Final[dict[str, Any]] = {"quantity": "radius_from_indentation_mm", "study": "A", "synthetic": False}
# An error, the uncertainty stated, and whether the interval held.
Trial: TypeAlias = tuple[ArrayLike, ArrayLike, ArrayLike]


class Score(NamedTuple):
    """Bias over the stated standard uncertainty, its standard error, and the share of intervals that hold."""

    bias: Array
    error: Array
    covered: Array


def faces(random: Rng, names: Sequence[Face], std: ArrayLike, scale_std: float) -> Trial:
    """Combine faces whose outlines err by `std` (mm), each in a scale of its own, to three semi-axes."""
    seen = []
    for name, own in zip(names, np.broadcast_to(std, len(names)), strict=True):
        lengths = PAD[[SEMI_AXES.index(axis) for axis in FACE_AXES[name]]]
        measured = (lengths + own * random.normal(size=2)) * (1 + scale_std * random.normal())
        known = {"covariance": own**2 * np.eye(2), "relative_scale_std": scale_std}
        seen.append(FaceSemiAxes(face=name, semi_axes=measured, **known))
    found = combine_faces(seen)
    off = found.semi_axes - PAD
    return off, found.stds, np.abs(off) < 1.96 * found.stds


def estimates(random: Rng, count: int, relative_std: float) -> Trial:
    """Take the mean of estimates of one value, as of the radii from several loading curves."""
    relative = relative_std * random.uniform(0.5, 1.5, count)
    values = RADIUS * (1 + relative * random.normal(size=count))
    found = pool(values, proportional_stds(values, relative * values))
    off = found.value - RADIUS
    return off, found.total_std, abs(off) < 1.96 * found.total_std


def varying(random: Rng, count: int, relative_std: float, between: float) -> Trial:
    """Take the mean of values that differ by `between` of themselves, and share an error of 1 %."""
    relative = relative_std * random.uniform(0.5, 1.5, count)
    truths = RADIUS * (1 + between * random.normal(size=count))
    values = truths * (1 + relative * random.normal(size=count)) * (1 + 0.01 * random.normal())
    shared = 0.01**2 * np.outer(values, values)
    found = pool_random_effects(values, proportional_stds(values, relative * values), shared)
    low, high = found.interval
    return found.value - RADIUS, found.total_std, low <= RADIUS <= high


def people(random: Rng, count: int, relative_std: float, *, fingers_as_people: bool = False) -> Trial:
    """Take the mean over people of three fingers each, who differ by 10 %, their fingers by 5 %."""
    person = RADIUS * (1 + 0.1 * random.normal(size=(count, 1)))
    seen = person * (1 + 0.05 * random.normal(size=(count, 3)))
    seen = seen * (1 + relative_std * random.normal(size=(count, 3)))
    values = []
    for (p, f), value in np.ndenumerate(seen):
        who = Person(f"P{p}f{f}" if fingers_as_people else f"P{p}", True)
        values.append(Value(value=value, std=relative_std * value, person=who, finger=f"f{f}", **_VALUE))
    (mean,) = means_of(values)
    assert mean.interval is not None
    low, high = mean.interval
    return mean.value - RADIUS, mean.std, low <= RADIUS <= high


def contacts(random: Rng, count: int, relative_std: float, elongation: float) -> Trial:
    """Pool R_δ and R_Aξ over contacts on a pad that is known exactly."""
    radii = equivalent_radius_from_indentation, equivalent_radius_from_compliance
    truth = np.array([radius(_MEAN, np.exp(-elongation)) for radius in radii])
    seen = []
    for load in np.geomspace(0.25, 4, count).tolist():
        true = 5 * load**0.3 * np.exp([0.5 * elongation, -0.5 * elongation])
        axes = true * (1 + relative_std * random.normal(size=2))
        covariance = np.diag(np.square(relative_std * np.sort(axes)[::-1]))
        seen.append(contact(f"c{load:g}", load, axes, covariance))
    (summary,) = pool_contacts(Rows(_STUDY, _PADS, seen))
    pooled = [each for each in (summary.corrected_radius, summary.compliance_radius) if each]
    values, stds = np.array([(each.value, each.total_std) for each in pooled]).T
    return values - truth, stds, np.abs(values - truth) < 1.96 * stds


_MEANS: Final = faces, estimates, varying, people, contacts


def score(mean: Callable[..., Trial], *of: Any, repeats: int, **how: bool) -> Score:
    """Score repeats of a mean; `of` and `how` are what it takes beside random numbers."""
    rng = np.random.default_rng([0, 1 + _MEANS.index(mean)])
    trials = zip(*(mean(rng, *of, **how) for _ in range(repeats)), strict=True)
    off, std, held = (np.array(each, dtype=float) for each in trials)
    typical = np.sqrt(np.mean(np.square(std), axis=0))
    error = off.std(axis=0) / typical / np.sqrt(repeats)
    return Score(bias=off.mean(axis=0) / typical, error=error, covered=held.mean(axis=0))


def report(repeats: int = 400) -> None:
    """Print bias and coverage of each mean: of its components the largest bias, and each coverage."""
    rows = []
    for words, scored in _cases():
        bias, error, covered = map(np.ravel, scored(repeats=repeats))
        worst = np.argmax(np.abs(bias))
        held = ", ".join(f"{100 * one:.1f} %" for one in covered)
        rows.append((words, f"{bias[worst]:+.2f} ± {error[worst]:.2f}", held))
    table(("mean", "largest bias, in uncertainties", "held by the 95 % interval"), rows)


def _cases() -> Iterator[tuple[str, Callable[..., Score]]]:
    two: tuple[Face, ...] = ("palmar", "radial")
    for names in (two, (*two, "distal")):
        for std, scale in ((1e-6, 0.02), (0.05, 0.0), (0.05, 0.02), (0.4, 0.03)):
            words = f"{len(names)} faces, outlines to {std:g} mm, scales to {scale:.0%}"
            yield words, partial(score, faces, names, std, scale)
    levels = (0.01, 0.03, 0.1)
    for count, level in product((5, 10), levels):
        yield f"{count} estimates to {level:.0%}", partial(score, estimates, count, level)
    for count, level in product((5, 10), levels):
        yield (
            f"{count} values to {level:.0%}, that differ by 10 %",
            partial(score, varying, count, level, 0.1),
        )
    for level in levels:
        yield f"fingers of 8 people to {level:.0%}", partial(score, people, 8, level)
    taken = partial(score, people, 8, 0.03, fingers_as_people=True)
    yield "fingers of 8 people to 3%, each taken for a person", taken
    for count, level, elongation in product((5, 10), levels, (0.2, 0.39)):
        words = f"{count} contacts to {level:.0%}, elongation {elongation:g}"
        yield words, partial(score, contacts, count, level, elongation)
