"""Coverage of repeatability in simulated studies of known truth.

The truth is drawn here from the statistics alone: persons, fingers of a person, sessions of a finger and
repeats of a session each add an independent normal deviation to the logarithm of a quantity.
"""

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pandas as pd

from benchmarks.arrays import Rng
from benchmarks.simulated import contact, finger, study_of
from benchmarks.tables import share, table
from fingerpad.image import SEMI_AXES
from fingerpad.study.results.repeats import contact_repeatability, pool_by_load, study_scatter
from fingerpad.study.results.rows import Rows
from fingerpad.study.results.summary_file import AtLoadRecord
from fingerpad.uncertainty import nested_scatter, pad_model

# Whether each interval of a kind held the truth.
Held = dict[str, list[bool]]
# One number of repeats per session, the sessions of each finger, the fingers of each person.
Design = tuple[tuple[tuple[int, ...], ...], ...]

PAD = np.array([7.9, 13.8, 11.8])
LOADS = (0.5, 1.0, 2.0)
ELONGATION = 0.3
NOISE = 0.01


class Population(NamedTuple):
    """The logarithm's mean and the standard deviation that each level adds to it."""

    mean: float = 4.7
    person: float = 0.0
    finger: float = 0.0
    session: float = 0.0
    repeat: float = 0.05


def draw_study(population: Population, design: Design, rng: Rng) -> pd.DataFrame:
    """Draw a study: each person, finger, session and repeat once from the population.

    Rows have a logarithm with that of its finger, and person, finger and session (the last two count on).
    """
    rows: list[tuple[float, ...]] = []
    finger = session = 0
    for person, fingers in enumerate(design):
        of_person = rng.normal(population.mean, population.person)
        for sessions in fingers:
            of_finger = of_person + rng.normal(0, population.finger)
            for repeats in sessions:
                of_session = of_finger + rng.normal(0, population.session)
                values = of_session + rng.normal(0, population.repeat, repeats)
                rows += [(person, finger, session, of_finger, value) for value in values]
                session += 1
            finger += 1
    return pd.DataFrame(rows, columns=["person", "finger", "session", "of_finger", "log_value"])


def component_coverage(population: Population, design: Design, studies: int) -> Held:
    """Return whether each interval of a study holds the truth, where there is one."""
    rng = np.random.default_rng([0, 11])
    true = population._asdict()
    between = population.person**2 + population.finger**2
    icc = between / (between + population.session**2 + population.repeat**2)
    held: Held = defaultdict(list)
    for _ in range(studies):
        drawn = draw_study(population, design, rng)
        levels = {level: drawn[level].to_numpy() for level in ("person", "finger", "session")}
        found = nested_scatter(drawn["log_value"].to_numpy(), levels, between=("person", "finger"))
        for level, one in found.components.items():
            if one.known:
                truth = np.hypot.reduce([true[each] for each in (level, *one.includes)])
                held[level].append(one.interval[0] <= truth <= one.interval[1])
        # Sessions that cannot be separated from fingers are part of what lies between these.
        if np.isfinite(found.icc) and (population.session == 0 or found.components["session"].known):
            held["icc"].append(found.icc_interval[0] <= icc <= found.icc_interval[1])
    return held


def mean_coverage(population: Population, design: Design, studies: int) -> Held:
    """Return the same of area and modulus at each load, from measured ellipses to the pooled means.

    The logarithm that is drawn is that of the contact radius √(ℓd ℓe); the elongation scatters from repeat to
    repeat as much. Semi-axes have noise of `NOISE`, as stated.
    """
    rng = np.random.default_rng([0, 12])
    held: Held = defaultdict(list)
    fingers = [f"p{person}" for person, of in enumerate(design) for _ in of]
    persons = {f"f{number}": person for number, person in enumerate(fingers)}
    study = study_of(persons, PAD)
    pads = {name: finger(name, PAD, person=person) for name, person in persons.items()}
    for _ in range(studies):
        drawn = draw_study(population, design, rng)
        seen, truths = [], {}
        for load in LOADS:
            # The same fingers under another load: the same sessions, new repeats.
            of_session = rng.normal(0, population.session, drawn["session"].max() + 1)[drawn["session"]]
            again = drawn["of_finger"] + of_session + rng.normal(0, population.repeat, len(drawn))
            for row, log_radius in zip(drawn.itertuples(), again + 0.25 * np.log(load), strict=True):
                elongation = ELONGATION + rng.normal(0, population.repeat)
                of, session = f"f{row.finger}", f"s{row.session}"
                axes = np.exp(log_radius + np.array([0.5, -0.5]) * elongation)
                axes = axes * (1 + NOISE * rng.normal(size=2))
                noise, name = np.diag(np.square(NOISE * np.sort(axes)[::-1])), f"c{rng.integers(2**60)}"
                seen.append(contact(name, load, axes, noise, finger=of, session=session))
                truths[of, load] = row.of_finger + 0.25 * np.log(load)
        repeatability = contact_repeatability(study, pads, seen)
        rows = Rows(study, pads, seen, repeatability)
        for at in pool_by_load(rows, study_scatter(study, rows.table)):
            for name, (low, high), truth in _pairs(at, truths[at.finger, at.load_N]):
                held[name].append(low <= truth <= high)
    return held


def _pairs(at: AtLoadRecord, log_radius: float) -> Iterator[tuple[str, tuple[float, float], float]]:
    radius = float(np.exp(log_radius))
    yield "area", (at.contact_area_mm2_ci95_low, at.contact_area_mm2_ci95_high), np.pi * radius**2
    exact = dict(zip(SEMI_AXES, PAD.tolist(), strict=True))
    exact |= {"wedge_angle": math.radians(30), "roll_angle": 0.0, "poisson_ratio": 0.5, "image_scale": 1.0}
    exact |= {"edge_offset": 0.0, "load": at.load_N, "contact_radius": radius, "elongation": ELONGATION}
    outputs = pad_model(**{name: np.array(value) for name, value in exact.items()})
    interval = at.youngs_modulus_kpa_ci95_low, at.youngs_modulus_kpa_ci95_high
    yield "modulus", interval, 1000 * float(outputs["youngs_modulus"])


_TWO_LEVELS = Population(person=0.1)
_FOUR_LEVELS = Population(person=0.1, finger=0.05, session=0.04, repeat=0.03)


def _alone(*repeats: int) -> Design:
    """Return persons of one finger and one session each."""
    return tuple(((each,),) for each in repeats)


_UNEVEN: Design = ((2, 3), (5, 1)), ((2,), (3, 3, 2)), ((4, 1),), ((2, 2), (2, 2), (6,))
CONDITIONS: tuple[tuple[str, Population, Design], ...] = (
    ("3 persons, 3 repeats", _TWO_LEVELS, _alone(3, 3, 3)),
    ("10 persons, 5 repeats", _TWO_LEVELS, _alone(*10 * (5,))),
    ("6 persons, 1 to 8 repeats", _TWO_LEVELS, _alone(2, 3, 8, 2, 1, 4)),
    ("4 much alike, 2 repeats", Population(person=0.02), _alone(2, 2, 2, 2)),
    ("5 all alike, 3 repeats", Population(), _alone(*5 * (3,))),
    ("4 persons, 3 fingers, 2 sessions, 3", _FOUR_LEVELS, 4 * (3 * ((3, 3),),)),
    ("4 persons, 1 to 3 of each, 1 to 6", _FOUR_LEVELS, _UNEVEN),
)
# The radius of a contact: half the relative scatter of its area.
MEANS: tuple[tuple[str, Population, Design], ...] = (
    ("1 finger, 3 repeats", Population(mean=1.6, repeat=0.02), _alone(3)),
    ("4 persons, 1 to 4 repeats", Population(mean=1.6, person=0.1, repeat=0.02), _alone(1, 2, 4, 3)),
    ("8 persons, 5 repeats", Population(mean=1.6, person=0.1, repeat=0.04), _alone(*8 * (5,))),
    ("4 persons, 3 sessions of 2", Population(1.6, 0.1, session=0.03, repeat=0.02), 4 * (((2, 2, 2),),)),
)
# Of one finger whose areas differ by 4.5 % from press to press, and by 6 % from session to session.
_ONE_SESSION = Population(mean=1.6, repeat=0.0225)
_SESSIONS = Population(mean=1.6, session=0.03, repeat=0.0225)
FEW: tuple[tuple[str, Population, Design], ...] = (
    ("1 press", _ONE_SESSION, _alone(1)),
    ("2 presses", _ONE_SESSION, _alone(2)),
    ("3 presses", _ONE_SESSION, _alone(3)),
    ("2 sessions of 2 presses", _SESSIONS, (((2, 2),),)),
    ("3 sessions of 2 presses", _SESSIONS, (((2, 2, 2),),)),
    ("6 sessions of 1 press", _SESSIONS, ((6 * (1,),),)),
)


def report(studies: int = 1000, chains: int = 150) -> None:
    """Print the coverage of intervals of standard deviations, of the ICC, and of means at each load."""
    levels, few = ("repeat", "session", "finger", "person", "icc"), f"{chains} studies each"
    components = f"Standard deviations and intraclass correlation, {studies} simulated studies each"
    for title, names, coverage, count, conditions in (
        (components, levels, component_coverage, studies, CONDITIONS),
        (f"Area and modulus at each load, {few}", ("area", "modulus"), mean_coverage, chains, MEANS),
        (f"Area of one finger at each load, {few}", ("area",), mean_coverage, chains, FEW),
    ):
        rows = {name: coverage(population, design, count) for name, population, design in conditions}
        rows["in all"] = {name: [one for found in rows.values() for one in found[name]] for name in names}
        cells = ((name, *(share(found[of], 1) for of in names)) for name, found in rows.items())
        table(("design", *names), cells, title)
