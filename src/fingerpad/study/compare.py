"""Finished studies side by side: each finger's values, and means with the scatter between people."""

import math
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from fingerpad._csv import package_table, write_csv
from fingerpad._display import Displayed
from fingerpad._files import explain_write_errors, make_folder
from fingerpad._json import dumps
from fingerpad._plausible import PLAUSIBLE_MODULUS_KPA
from fingerpad.exceptions import FingerpadError
from fingerpad.study.results import summary_file
from fingerpad.study.results.result_set import require_result_set
from fingerpad.study.results.validity.checks import HERTZ_EXPONENT
from fingerpad.uncertainty import RandomEffects, pool_random_effects, proportional_stds
from fingerpad.uncertainty.repeats import nominal_loads


class FinishedStudy(NamedTuple):
    """The results of one run."""

    folder: Path
    summary: summary_file.SummaryFile

    @property
    def title(self) -> str:
        """The study's title."""
        return self.summary.title

    def owner(
        self, of: summary_file.FingerRecord | summary_file.PlacementRecord | summary_file.CurveRecord
    ) -> dict[str, Any]:
        """Return the first fields of an `OfFinger` from a part of the summary."""
        finger = self.summary.finger(of.finger)
        assert finger is not None  # as a run writes it
        return {
            "study": self.title,
            "finger": of.finger,
            "digit": finger.digit,
            "person": Person(finger.person or self.title, bool(finger.person)),
            "synthetic": of.synthetic,
            # What is of the finger alone has no angles.
            "wedge_angle_deg": None if isinstance(of, summary_file.FingerRecord) else of.wedge_angle_deg,
            "roll_angle_deg": of.roll_angle_deg if isinstance(of, summary_file.PlacementRecord) else None,
        }

    def __repr__(self) -> str:
        made = self.summary.provenance.made
        return f"FinishedStudy(folder={str(self.folder)!r}, title={self.title!r}, made={made!r})"


def read_finished(paths: Sequence[Path]) -> list[FinishedStudy]:
    """Read finished runs, each named by its output folder or a file in it."""
    studies: list[FinishedStudy] = []
    for path in paths:
        folder = path.parent if path.is_file() else path
        require_result_set(folder)
        study = FinishedStudy(folder, summary_file.SummaryFile.read(folder))
        inputs = study.summary.provenance.inputs_sha256
        for other in studies:
            same = inputs and inputs == other.summary.provenance.inputs_sha256
            if same or folder.resolve() == other.folder.resolve():
                raise FingerpadError(
                    f"{folder}: is the same study as {other.folder}: its fingers would count twice; "
                    "name it once"
                )
            if study.title.casefold() == other.title.casefold():
                raise FingerpadError(
                    f"{folder} and {other.folder} are both titled {study.title!r}; give one another "
                    "title in its study.toml and run it again: nothing is measured again"
                )
        studies.append(study)
    if not studies:
        raise FingerpadError("no study is named; name output folders of `fingerpad run`")
    return studies


class Quantity(NamedTuple):
    """A quantity that fingers are compared by."""

    symbol: str  # as Matplotlib's mathtext
    unit: str  # its unit, empty for a pure number
    words: str
    positive: bool  # and known in proportion to its size


QUANTITIES: Final[Mapping[str, Quantity]] = {
    line["quantity"]: Quantity(line["symbol"], line["unit"], line["words"], line["positive"] == "yes")
    for line in package_table("fingerpad.study", "quantities.csv")
}
_FROM_CURVES: Final = ("initial_modulus_kpa", "load_exponent", "curve_area_exponent")
_ON_LAYER: Final = "youngs_modulus_on_layer_kpa"
_AREA: Final = "highest_area_mm2"
# Quantities at the highest load, and their names in the table of loads.
_MEANS_AT_LOAD: Final = {
    _AREA: "contact_area_mm2",
    "youngs_modulus_kpa": "youngs_modulus_kpa",
    _ON_LAYER: "youngs_modulus_on_layer_kpa",
}
# By what power of the load they go: moduli from load and area, and areas.
_BY_LOAD: Final = {_AREA: HERTZ_EXPONENT, "youngs_modulus_kpa": 1.0, _ON_LAYER: 1.0}


class Person(NamedTuple):
    """Whose a finger is."""

    name: str  # the person, or the study's title where the manifest names none
    named: bool  # whether the manifest names the person, who is then the same in all studies


def _fields(of: object, *names: str) -> dict[str, Any]:
    return {name: getattr(of, name) for name in names}


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class OfFinger(Displayed):
    """What is known of a finger of a study, at a placement where that matters."""

    study: str  # its title
    finger: str
    person: Person
    synthetic: bool  # whether anything of it was rendered or simulated
    digit: str | None = None  # which finger of the person it is, where that is not its name
    wedge_angle_deg: float | None = None
    roll_angle_deg: float | None = None

    def as_record(self) -> dict[str, Any]:
        """Return one row of a table."""
        person = self.person.name if self.person.named else None
        placed = _fields(self, "wedge_angle_deg", "roll_angle_deg", "synthetic")
        return {"study": self.study, "person": person, "finger": self.finger, **placed}


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Value(OfFinger):
    """One value of one of `QUANTITIES`, in the unit that its name says."""

    quantity: str
    value: float
    std: float  # with the model's part; NaN where not known
    shared_std: float = 0.0  # what the pose of the jig, which fingers of a study share, does to it
    gain_std: float = 0.0  # what the gain of the force, which contacts of a study share, does to it
    scale_std: float = 0.0  # what `scale` does to it, which contacts of a study that name it share
    edge_std: float = 0.0  # what the place of their edge does to it, which they share too
    scale: str | None = None
    model_std: float = 0.0  # of the model's discrepancy, which all values from that model share; zero without
    source: str = ""  # loading curve that it comes from, if one
    velocity_mm_per_s: float = math.nan  # how fast that was; NaN where not known
    verdict: str = ""  # whether the model that it comes from holds there; empty where it comes from none
    load: float = math.nan  # N, at which it holds; NaN where it goes with no load

    @property
    def mean_key(self) -> tuple[str, float | None, float | None, bool]:
        """What values of one mean share: quantity, placement, and whether synthetic."""
        return self.quantity, self.wedge_angle_deg, self.roll_angle_deg, self.synthetic

    def as_record(self) -> dict[str, Any]:
        """Return one row of a table."""
        return {
            "quantity": self.quantity,
            "unit": QUANTITIES[self.quantity].unit or "1",
            **OfFinger.as_record(self),
            "load_N": self.load,
            **_fields(self, "value", "std", "model_std"),
            "curve": self.source or None,
            "velocity_mm_per_s": self.velocity_mm_per_s,
            "verdict": self.verdict or None,
        }


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ValidityVerdict(OfFinger):
    """Whether a model holds for a finger at one placement, and which checks say so."""

    model: str  # ``Hertz theory``, or the layer with its thickness
    verdict: str  # ``holds``, ``strained``, ``fails`` or ``not tested``
    checks: tuple[str, ...]  # names of the checks with that verdict
    compared: tuple[str, ...]  # what each of them compared

    def as_record(self) -> dict[str, Any]:
        """Return one row of a table."""
        record = OfFinger.as_record(self)
        return {**record, "model": self.model, "verdict": self.verdict, "checks": " ".join(self.checks)}


def verdicts_of(study: FinishedStudy) -> list[ValidityVerdict]:
    """Return the verdicts of a study on Hertz theory and on its layers, in its own order."""
    verdicts = []
    for one in study.summary.summaries:
        models: dict[str, summary_file.ValidityRecord | summary_file.LayerValidityRecord] = {
            "Hertz theory": one.validity
        }
        if one.validity.on_layer and one.on_layer:
            models[f"{one.on_layer.effective_thickness_mm:g} mm of tissue over bone"] = one.validity.on_layer
        for model, found in models.items():
            telling = [check for check in found.checks if check.verdict == found.verdict]
            verdicts.append(
                ValidityVerdict(
                    **study.owner(one),
                    model=model,
                    verdict=found.verdict,
                    checks=tuple(check.check for check in telling),
                    compared=tuple(check.compared for check in telling),
                )
            )
    return verdicts


def values_of(study: FinishedStudy) -> list[Value]:
    """Return all values that a study tells, in its own order; what it does not know is left out."""
    found = [
        Value(
            quantity=quantity,
            **study.owner(finger),
            value=getattr(finger, quantity),
            std=math.sqrt(finger.covariance_mm2[place][place]),
        )
        for finger in study.summary.fingers
        for place, quantity in enumerate(("palmar_mm", "distal_mm", "radial_ulnar_mm"))
    ]
    found += _of_placements(study)
    gain = study.summary.load_gain_relative_std
    # A press that is given twice, as with another fit, is no second one.
    presses: dict[object, summary_file.CurveRecord] = {}
    for one in study.summary.curves:
        if one.fit:
            presses.setdefault((one.finger, one.wedge_angle_deg, one.synthetic, one.file, one.cycle), one)
    for curve in presses.values():
        for quantity in _FROM_CURVES:
            key = quantity.removeprefix("curve_")
            value = getattr(curve.fit, key)
            found.append(
                Value(
                    quantity=quantity,
                    **study.owner(curve) | {"roll_angle_deg": 0.0},
                    value=value,
                    std=getattr(curve.fit, f"{key}_std"),
                    gain_std=gain * value if quantity == "initial_modulus_kpa" else 0.0,
                    source=curve.file or "",
                    velocity_mm_per_s=curve.velocity_mm_per_s,
                )
            )
    return [value for value in found if math.isfinite(value.value)]


def _of_placements(study: FinishedStudy) -> Iterator[Value]:
    gain = study.summary.load_gain_relative_std
    at_loads: dict[summary_file.PlacementKey, list[summary_file.AtLoadRecord]] = {}
    for at in sorted(study.summary.by_load, key=lambda one: one.load_N):
        at_loads.setdefault(at.key, []).append(at)
    for summary in study.summary.summaries:
        # Of what is uncertain in a radius the pose of the jig has the same relative part in 1/H, in the
        # corrected radius, which it reaches through 1/H alone, and, nearly, in R_e and so in the moduli.
        jig_share = (summary.radius_from_indentation_variance_shares or {}).get("jig angle", 0.0)
        radius = summary.radius_from_indentation_mm
        jig = math.sqrt(jig_share) * summary.radius_from_indentation_mm_std / radius if jig_share else 0.0
        headlines = summary.validity.headlines
        found = {
            name: _Found(
                getattr(summary, name),
                getattr(summary, f"{name}_std"),
                headlines[name].model_std if name in headlines else math.nan,
            )
            for name in ("mean_curvature_radius_mm", "radius_from_indentation_mm", "area_exponent")
        }
        if summary.key in at_loads:
            found |= _of_contacts(at_loads[summary.key])
        else:
            found |= _of_one_frame(summary, gain)
        verdicts = {name: one.verdict for name, one in headlines.items()}
        verdicts[_ON_LAYER] = summary.validity.on_layer.verdict if summary.validity.on_layer else ""
        finger = study.summary.finger(summary.finger)
        for quantity, (value, std, of_model, load, mean_of) in found.items():
            model_std = 0.0 if math.isnan(of_model) else of_model
            yield Value(
                quantity=quantity,
                **study.owner(summary),
                value=value,
                std=math.hypot(std, model_std),
                shared_std=0.0 if quantity in {_AREA, "area_exponent"} else jig * value,
                gain_std=gain * value * _BY_LOAD.get(quantity, 0.0),
                **_of_device(mean_of, quantity, gain, finger.scale if finger else None),
                model_std=model_std,
                verdict=verdicts.get(quantity, ""),
                load=load,
            )


class _Found(NamedTuple):
    """A value with its standard uncertainty, apart that of the model, and its load, N; NaN is not known."""

    value: float
    std: float
    model_std: float = math.nan
    load: float = math.nan
    at: summary_file.AtLoadRecord | None = None  # what it is a mean of


def _of_device(
    at: summary_file.AtLoadRecord | None, quantity: str, gain: float, pad_scale: str | None
) -> dict[str, Any]:
    """Return what one scale and its edge, if contacts name one, do to a mean over them."""
    if at is None or not at.scale:
        return {}
    # Beside noise, repeats and the edge, areas are in error by scale and gain.
    other = at.contact_area_mm2_other_std / at.contact_area_mm2
    scale = math.sqrt(max(0.0, other**2 - (HERTZ_EXPONENT * gain) ** 2))
    name = _MEANS_AT_LOAD[quantity]
    # E goes with R A^(−3/2), and the pad's R with the scale where its photographs name it, too.
    power = 1.0 if quantity == _AREA or pad_scale == at.scale else 1.5
    return {
        "scale": at.scale,
        "scale_std": power * scale * getattr(at, name),
        "edge_std": getattr(at, f"{name}_edge_std"),
    }


def _of_contacts(at_loads: Sequence[summary_file.AtLoadRecord]) -> dict[str, _Found]:
    """Return area and moduli at the highest load that gives them, means over the contacts there.

    One contact of several would differ from its repeats by more than its area's own uncertainty says.
    """
    found = {}
    for quantity, name in _MEANS_AT_LOAD.items():
        known = [at for at in at_loads if math.isfinite(getattr(at, name))]
        if known:
            at = known[-1]
            total_std, model_std = getattr(at, f"{name}_std"), getattr(at, f"{name}_model_std", math.nan)
            std = math.sqrt(max(0.0, total_std**2 - np.nan_to_num(model_std) ** 2))
            found[quantity] = _Found(getattr(at, name), std, model_std, at.load_N, at)
    return found


def _of_one_frame(summary: summary_file.PlacementRecord, gain: float) -> dict[str, _Found]:
    """Return area and moduli of a sequence's frame at the highest load."""
    load, layer, area = summary.highest_load_N, summary.on_layer, summary.highest_area_mm2
    area_std = math.hypot(summary.highest_area_mm2_std, HERTZ_EXPONENT * gain * area)
    found = {_AREA: _Found(area, area_std, load=load)}
    if modulus := summary.validity.headlines.get("youngs_modulus_kpa"):
        found["youngs_modulus_kpa"] = _Found(modulus.value, modulus.value_std, modulus.model_std, load)
    if layer:
        at = layer.highest_load
        found[_ON_LAYER] = _Found(
            at.youngs_modulus_on_layer_kpa, at.youngs_modulus_on_layer_kpa_std, load=at.load_N
        )
    return found


class PersonMean(NamedTuple):
    """The mean over one person's fingers."""

    person: Person
    fingers: int
    value: float
    std: float


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Mean(Displayed):
    """The mean of a quantity over people, real ones or synthetic ones."""

    quantity: str  # one of `QUANTITIES`
    wedge_angle_deg: float | None  # None for what belongs to the finger alone, as the roll
    roll_angle_deg: float | None
    synthetic: bool  # whether it is over rendered or simulated fingers; the two never mix
    load: float | None  # N, of areas, which have one mean at each load, to two digits; None for the others
    people: tuple[PersonMean, ...]
    value: float
    std: float  # with what fingers of a study share, and values from a model
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
            **_fields(self, "wedge_angle_deg", "roll_angle_deg"),
            "load_N": self.load,
            "synthetic": self.synthetic,
            "people": len(self.people),
            **_fields(self, "fingers", "value", "std"),
            "ci95_low": self.interval and self.interval[0],
            "ci95_high": self.interval and self.interval[1],
            **_fields(self, "between_people_std", "between_fingers_std"),
        }


class _Level(NamedTuple):
    """A value with its own standard uncertainty, and what each study's jig and force, and the model add."""

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
    return [_mean(members) for alike in groups.values() for members in _by_nominal_load(alike)]


def _two_digits(load: float) -> float:
    return float(f"{load:.2g}")


def _by_nominal_load(values: list[Value]) -> list[list[Value]]:
    """Return areas by nominal load, and values of another quantity together."""
    if values[0].quantity != _AREA:
        return [values]
    # Of loads that run on without a gap those that are equal to two digits are one.
    nominal = nominal_loads([_two_digits(value.load) for value in values])
    return [[values[k] for k in np.flatnonzero(nominal == one)] for one in np.unique(nominal)]


def _mean(values: Sequence[Value]) -> Mean:
    quantity, wedge, roll, synthetic = values[0].mean_key
    positive = QUANTITIES[quantity].positive
    people: dict[Person, dict[str, list[_Level]]] = {}
    for value in values:
        shared: dict[Hashable, float] = {
            (value.study, "jig"): value.shared_std,
            (value.study, "force"): value.gain_std,
            (value.study, "scale", value.scale): value.scale_std,
            (value.study, "edge", value.scale): value.edge_std,
            "model": value.model_std,
        }
        own = math.sqrt(max(0.0, value.std**2 - sum(std**2 for std in shared.values())))
        level = _Level(value.value, own, shared)
        people.setdefault(value.person, {}).setdefault(value.digit or value.finger, []).append(level)
    persons, scatters = [], []
    for fingers in people.values():
        members = [_pooled(levels, positive)[0] for levels in fingers.values()]
        level, pooled = _pooled(members, positive)
        persons.append((level, len(fingers)))
        if len(fingers) > 1:
            scatters += (len(fingers) - 1) * [pooled.between_std]
    _, pooled = _pooled([level for level, _ in persons], positive)
    several = len(persons) > 1
    return Mean(
        quantity=quantity,
        wedge_angle_deg=wedge,
        roll_angle_deg=roll,
        synthetic=synthetic,
        load=_two_digits(float(np.mean([value.load for value in values]))) if quantity == _AREA else None,
        people=tuple(
            PersonMean(person=person, fingers=count, value=level.value, std=level.std)
            for person, (level, count) in zip(people, persons, strict=True)
        ),
        value=pooled.value,
        std=pooled.total_std,
        interval=_interval(pooled, positive) if several else None,
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


def _pooled(levels: Sequence[_Level], positive: bool) -> tuple[_Level, RandomEffects]:
    """Pool one level, and return it as a member of the next with its scatter."""
    value = np.array([level.value for level in levels])
    own = np.maximum([level.own_std for level in levels], np.spacing(np.abs(value)))
    sources = list(dict.fromkeys(source for level in levels for source in level.shared))
    parts = np.array([[level.shared.get(source, 0.0) for source in sources] for level in levels])
    stds = proportional_stds(value, own) if positive else own
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
                            **_fields(each, "fingers", "value", "std"),
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
    with explain_write_errors(out, "make room, or choose another"):
        for name, rows in (
            ("compare", comparison.values),
            ("compare_means", comparison.means),
            ("compare_validity", comparison.verdicts),
        ):
            records = [row.as_record() for row in rows]
            (out / f"{name}.csv").unlink(missing_ok=True)  # of an earlier comparison
            if records:
                write_csv(out / f"{name}.csv", [records[0], *(record.values() for record in records)])
        (out / "compare.json").write_text(dumps(comparison.as_record(), indent=1) + "\n", encoding="utf-8")
