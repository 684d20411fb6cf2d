"""Bias and coverage of everything that is pooled, in simulations.

Truths are drawn here, without the code under test; measured values scatter about them as their standard
uncertainties say, in proportion to the truth, and state uncertainties in proportion to themselves.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray
from fingerpad.contact import equivalent_radius_from_compliance, equivalent_radius_from_indentation
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.image import FACE_AXES, SEMI_AXES, Face, FaceSemiAxes, combine_faces
from fingerpad.study.compare import Person, Value
from fingerpad.study.compare.comparison import means_of
from fingerpad.study.manifest import Observation, Study
from fingerpad.study.measuring.contacts import Measurement
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.pooling import pool_contacts
from fingerpad.study.results.rows import model_contacts
from fingerpad.uncertainty import pool, pool_random_effects, proportional_stds

PAD = np.array([7.9, 13.8, 11.8])
RADIUS = 14.0


class Score(NamedTuple):
    """Bias over the stated standard uncertainty, its standard error, and the share of intervals that hold."""

    bias: FloatArray
    error: FloatArray
    covered: FloatArray


def _score(off: ArrayLike, std: ArrayLike, held: ArrayLike) -> Score:
    """Score repeats along the first axis: errors, stated uncertainties, and whether intervals held."""
    off, typical = np.asarray(off, dtype=float), np.sqrt(np.mean(np.square(std), axis=0))
    return Score(
        bias=off.mean(axis=0) / typical,
        error=off.std(axis=0) / typical / np.sqrt(len(off)),
        covered=np.asarray(held, dtype=float).mean(axis=0),
    )


def faces(names: Sequence[Face], std: ArrayLike, scale_std: float, repeats: int, seed: int = 0) -> Score:
    """Score the three semi-axes from faces whose outlines err by `std` (mm), each in a scale of its own."""
    random, off, stds = np.random.default_rng([seed, 1]), [], []
    for _ in range(repeats):
        seen = []
        for name, own in zip(names, np.broadcast_to(std, len(names)), strict=True):
            lengths = PAD[[SEMI_AXES.index(axis) for axis in FACE_AXES[name]]]
            measured = (lengths + own * random.normal(size=2)) * (1 + scale_std * random.normal())
            seen.append(
                FaceSemiAxes(
                    face=name,
                    semi_axes=measured,
                    covariance=own**2 * np.eye(2),
                    relative_scale_std=scale_std,
                )
            )
        found = combine_faces(seen)
        off.append(found.semi_axes - PAD)
        stds.append(found.stds)
    return _score(off, stds, np.abs(off) < 1.96 * np.array(stds))


def estimates(count: int, relative_std: float, repeats: int, seed: int = 0) -> Score:
    """Score the mean of estimates of one value, as of the radii from several loading curves."""
    random, rows = np.random.default_rng([seed, 2]), []
    for _ in range(repeats):
        relative = relative_std * random.uniform(0.5, 1.5, count)
        values = RADIUS * (1 + relative * random.normal(size=count))
        found = pool(values, proportional_stds(values, relative * values))
        off = found.value - RADIUS
        rows.append((off, found.total_std, abs(off) < 1.96 * found.total_std))
    return _score(*np.array(rows).T)


def varying(count: int, relative_std: float, between: float, repeats: int, seed: int = 0) -> Score:
    """Score the mean of values that differ by `between` of themselves, and share an error of 1 %."""
    random, rows = np.random.default_rng([seed, 3]), []
    for _ in range(repeats):
        relative = relative_std * random.uniform(0.5, 1.5, count)
        truths = RADIUS * (1 + between * random.normal(size=count))
        values = truths * (1 + relative * random.normal(size=count)) * (1 + 0.01 * random.normal())
        shared = 0.01**2 * np.outer(values, values)
        found = pool_random_effects(values, proportional_stds(values, relative * values), shared)
        low, high = found.interval
        rows.append((found.value - RADIUS, found.total_std, low <= RADIUS <= high))
    return _score(*np.array(rows).T)


def people(count: int, relative_std: float, repeats: int, seed: int = 0) -> Score:
    """Score the mean over people of three fingers each, who differ by 10 %, their fingers by 5 %."""
    random, rows = np.random.default_rng([seed, 4]), []
    given: dict[str, Any] = {"quantity": "radius_from_indentation_mm", "study": "A", "synthetic": False}
    for _ in range(repeats):
        person = RADIUS * (1 + 0.1 * random.normal(size=(count, 1)))
        seen = person * (1 + 0.05 * random.normal(size=(count, 3)))
        seen = seen * (1 + relative_std * random.normal(size=(count, 3)))
        (mean,) = means_of(
            Value(
                value=value, std=relative_std * value, person=Person(f"P{p}", True), finger=f"f{f}", **given
            )
            for (p, f), value in np.ndenumerate(seen)
        )
        assert mean.interval is not None
        low, high = mean.interval
        rows.append((mean.value - RADIUS, mean.std, low <= RADIUS <= high))
    return _score(*np.array(rows).T)


def contacts(count: int, relative_std: float, elongation: float, repeats: int, seed: int = 0) -> Score:
    """Score R_δ and R_Aξ pooled over contacts on a pad that is known exactly."""
    curvature = Placement(Ellipsoid(*PAD), wedge_angle=np.radians(30)).curvature
    truth = np.array(
        [
            radius(curvature.mean_curvature_radius, np.exp(-elongation))
            for radius in (equivalent_radius_from_indentation, equivalent_radius_from_compliance)
        ]
    )
    names = ("palmar", "distal", "radial_ulnar")
    finger = {
        "name": "f",
        "semi_axes_mm": dict(zip(names, PAD.tolist(), strict=True)),
        "semi_axes_mm_std": dict.fromkeys(names, 1e-9),
    }
    study = Study.model_validate({"title": "simulated", "fingers": [finger]})
    pads = {
        "f": FingerResult(name="f", semi_axes=PAD, covariance=1e-18 * np.eye(3), source="given"),
    }
    random, off, stds = np.random.default_rng([seed, 5]), [], []
    for _ in range(repeats):
        seen = [
            _contact(random, float(load), relative_std, elongation) for load in np.geomspace(0.25, 4, count)
        ]
        (summary,) = pool_contacts(model_contacts(study, pads, seen))
        pooled = [summary.corrected_radius, summary.compliance_radius]
        off.append([one.value - true for one, true in zip(pooled, truth, strict=True) if one])
        stds.append([one.std for one in pooled if one])
    return _score(off, stds, np.abs(off) < 1.96 * np.array(stds))


def _contact(
    random: np.random.Generator, load: float, relative_std: float, elongation: float
) -> tuple[Observation, Measurement]:
    true = 5 * load**0.3 * np.exp([0.5 * elongation, -0.5 * elongation])
    major, minor = sorted(true * (1 + relative_std * random.normal(size=2)), reverse=True)
    name = f"c{load:g}"
    observation = Observation(name=name, finger="f", wedge_angle_deg=30, load_N=load, file="x.png", scale="s")
    return observation, Measurement(
        observation=name,
        load_N=load,
        semi_major_mm=major,
        semi_minor_mm=minor,
        covariance_mm2=np.diag(np.square([relative_std * major, relative_std * minor])),
        scale="s",
    )


def report(repeats: int = 1000) -> None:
    """Print bias and coverage of each mean: of its components the largest bias, and each coverage."""
    print(f"\nPooled means in {repeats} simulations each: asked a bias below 0.1 of the uncertainty, 93-97 %")
    for words, score in _cases():
        found = score(repeats)
        worst = np.argmax(np.abs(found.bias))
        bias, error = np.ravel(found.bias)[worst], np.ravel(found.error)[worst]
        covered = " ".join(f"{100 * share:5.1f} %" for share in np.ravel(found.covered))
        print(f"    {words:<50} bias {bias:+.2f} ± {error:.2f}   covered {covered}", flush=True)


def _cases() -> Iterator[tuple[str, Callable[[int], Score]]]:
    two: tuple[Face, ...] = ("palmar", "radial")
    for names in (two, (*two, "distal")):
        for std, scale in ((1e-6, 0.02), (0.05, 0.0), (0.05, 0.02), (0.4, 0.03)):
            words = f"{len(names)} faces, outlines to {std:g} mm, scales to {scale:.0%}"
            yield words, partial(faces, names, std, scale)
    levels = (0.01, 0.03, 0.1)
    for count, level in product((5, 10), levels):
        yield f"{count} estimates to {level:.0%}", partial(estimates, count, level)
    for count, level in product((5, 10), levels):
        yield f"{count} values to {level:.0%}, that differ by 10 %", partial(varying, count, level, 0.1)
    for level in levels:
        yield f"fingers of 8 people to {level:.0%}", partial(people, 8, level)
    for count, level, elongation in product((5, 10), levels, (0.2, 0.39)):
        words = f"{count} contacts to {level:.0%}, elongation {elongation:g}"
        yield words, partial(contacts, count, level, elongation)
