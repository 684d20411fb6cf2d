"""Coverage of repeatability in simulated studies of known truth: ``python -m benchmarks.repeatability``.

The truth is drawn here from the statistics alone: persons, fingers of a person, sessions of a finger and
repeats of a session each add an independent normal deviation to the logarithm of a quantity.
"""

from typing import NamedTuple

import numpy as np

from fingerpad._arrays import FloatArray

# One number of repeats per session, the sessions of each finger, the fingers of each person.
Design = tuple[tuple[tuple[int, ...], ...], ...]


class Population(NamedTuple):
    """The logarithm's mean and the standard deviation that each level adds to it."""

    mean: float = 4.7
    person: float = 0.0
    finger: float = 0.0
    session: float = 0.0
    repeat: float = 0.05


class Draws(NamedTuple):
    """Logarithms of one study, with the person, finger and session of each (finger and session count on)."""

    person: FloatArray
    finger: FloatArray
    session: FloatArray
    log_value: FloatArray


def draw_study(population: Population, design: Design, rng: np.random.Generator) -> Draws:
    """Draw a study: each person, finger, session and repeat once from the population."""
    rows: list[tuple[float, float, float, float]] = []
    finger = session = 0
    for person, fingers in enumerate(design):
        of_person = rng.normal(population.mean, population.person)
        for sessions in fingers:
            of_finger = of_person + rng.normal(0, population.finger)
            for repeats in sessions:
                of_session = of_finger + rng.normal(0, population.session)
                values = of_session + rng.normal(0, population.repeat, repeats)
                rows += [(person, finger, session, value) for value in values]
                session += 1
            finger += 1
    return Draws(*np.array(rows).T)
