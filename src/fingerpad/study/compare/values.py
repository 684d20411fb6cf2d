"""Finished studies, what is compared of them, and every finger's values of it."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple

from fingerpad._display import Displayed
from fingerpad.exceptions import FingerpadError
from fingerpad.study.results.result_set import require_result_set
from fingerpad.study.results.summary_file import (
    CurveRecord,
    FingerRecord,
    LayerValidityRecord,
    PlacementRecord,
    SummaryFile,
    ValidityRecord,
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FinishedStudy:
    """The results of one run."""

    folder: Path
    summary: SummaryFile

    @property
    def title(self) -> str:
        """The study's title."""
        return self.summary.title

    def __repr__(self) -> str:
        made = self.summary.provenance.made
        return f"FinishedStudy(folder={str(self.folder)!r}, title={self.title!r}, made={made!r})"


def read_finished(paths: Sequence[Path]) -> list[FinishedStudy]:
    """Read finished runs, each named by its output folder or a file in it."""
    studies: list[FinishedStudy] = []
    for path in paths:
        study = _read(path.parent if path.is_file() else path)
        for other in studies:
            if study.folder.resolve() == other.folder.resolve() or (
                (inputs := study.summary.provenance.inputs_sha256)
                and inputs == other.summary.provenance.inputs_sha256
            ):
                raise FingerpadError(
                    f"{study.folder}: is the same study as {other.folder}: its fingers would count twice; "
                    "name it once"
                )
            if study.title.casefold() == other.title.casefold():
                raise FingerpadError(
                    f"{study.folder} and {other.folder} are both titled {study.title!r}; give one another "
                    "title in its study.toml and run it again: nothing is measured again"
                )
        studies.append(study)
    if not studies:
        raise FingerpadError("no study is named; name output folders of `fingerpad run`")
    return studies


def _read(folder: Path) -> FinishedStudy:
    require_result_set(folder)
    return FinishedStudy(folder=folder, summary=SummaryFile.read(folder))


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """A quantity that fingers are compared by."""

    symbol: str  # as Matplotlib's mathtext
    unit: str  # its unit, empty for a pure number
    words: str
    proportional: bool = True  # whether its uncertainty grows in proportion to it


QUANTITIES: Final[Mapping[str, Quantity]] = {
    "palmar_mm": Quantity(
        symbol=r"$\ell_\mathrm{a}$", unit="mm", words="palmar semi-axis"
    ),
    "distal_mm": Quantity(
        symbol=r"$\ell_\mathrm{b}$", unit="mm", words="distal semi-axis"
    ),
    "radial_ulnar_mm": Quantity(
        symbol=r"$\ell_\mathrm{c}$", unit="mm", words="radial–ulnar semi-axis"
    ),
    "mean_curvature_radius_mm": Quantity(
        symbol=r"$R_\mathrm{0g}$", unit="mm", words="radius of the undeformed pad, 1/H"
    ),
    "radius_from_indentation_mm": Quantity(
        symbol=r"$R_\mathrm{g}^\mathrm{corr}$", unit="mm", words="corrected radius, pooled over contacts"
    ),
    "youngs_modulus_kpa": Quantity(
        symbol="$E$", unit="kPa", words="Young's modulus by Hertz theory, at the highest load"
    ),
    "youngs_modulus_on_layer_kpa": Quantity(
        symbol=r"$E_\mathrm{layer}$",
        unit="kPa",
        words="Young's modulus on tissue of the stated thickness over bone, from the same contact",
    ),
    "initial_modulus_kpa": Quantity(
        symbol=r"$E_\mathrm{0g}$", unit="kPa", words="Young's modulus at small load, from loading curves"
    ),
    "load_exponent": Quantity(symbol="$m$", unit="", words="exponent of W ∝ ξᵐ, from loading curves"),
    "curve_area_exponent": Quantity(
        symbol="$n$", unit="", words="exponent of A ∝ Wⁿ, from loading curves", proportional=False
    ),
    "area_exponent": Quantity(
        symbol="$n$", unit="", words="exponent of A ∝ Wⁿ, from contacts", proportional=False
    ),
}  # fmt: skip
_FROM_CURVES: Final = {
    "initial_modulus_kpa": "initial_modulus_kpa",
    "load_exponent": "load_exponent",
    "curve_area_exponent": "area_exponent",
}
_ON_LAYER: Final = "youngs_modulus_on_layer_kpa"


class Person(NamedTuple):
    """Whose a finger is."""

    name: str  # the person, or the study's title where the manifest names none
    named: bool  # whether the manifest names the person, who is then the same in all studies


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Value(Displayed):
    """One value of one quantity of one finger."""

    quantity: str  # one of `QUANTITIES`
    # study, finger: title of the study, and the finger's name there
    study: str
    finger: str
    person: Person
    synthetic: bool  # whether anything of it was rendered or simulated
    # value, std: value and standard uncertainty with the model's part, in the unit that the quantity's name
    # says; the latter NaN where not known
    value: float
    std: float
    # wedge_angle_deg, roll_angle_deg: its placement; None for what belongs to the finger alone
    wedge_angle_deg: float | None = None
    roll_angle_deg: float | None = None
    shared_std: float = 0.0  # what the wedge's angle, which fingers of a study share, does to it
    # what the gain of the force, which moduli from the contacts of a study share, does to it
    gain_std: float = 0.0
    # what the model's discrepancy does to it, which all values from that model share; zero where nothing
    # tells it
    model_std: float = 0.0
    source: str = ""  # loading curve that it comes from, if one
    velocity_mm_per_s: float = math.nan  # how fast that was; NaN where not known
    verdict: str = ""  # whether the model that it comes from holds there; empty where it comes from none

    @property
    def mean_key(self) -> tuple[str, float | None, float | None, bool]:
        """What values of one mean have in common: quantity, wedge, roll, and whether synthetic."""
        return self.quantity, self.wedge_angle_deg, self.roll_angle_deg, self.synthetic

    def as_record(self) -> dict[str, Any]:
        """Return the value as one row of a table."""
        return {
            "quantity": self.quantity,
            "unit": QUANTITIES[self.quantity].unit or "1",
            "study": self.study,
            "person": self.person.name if self.person.named else None,
            "finger": self.finger,
            "wedge_angle_deg": self.wedge_angle_deg,
            "roll_angle_deg": self.roll_angle_deg,
            "synthetic": self.synthetic,
            "value": self.value,
            "std": self.std,
            "model_std": self.model_std,
            "curve": self.source or None,
            "velocity_mm_per_s": self.velocity_mm_per_s,
            "verdict": self.verdict or None,
        }


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ValidityVerdict(Displayed):
    """Whether a model holds for a finger at one placement, and which checks say so."""

    # study, finger: title of the study, and the finger's name there
    study: str
    finger: str
    person: Person
    wedge_angle_deg: float
    roll_angle_deg: float
    synthetic: bool  # whether anything of it was rendered or simulated
    model: str  # ``Hertz theory``, or the layer with its thickness
    verdict: str  # ``holds``, ``strained``, ``fails`` or ``not tested``
    checks: tuple[str, ...]  # names of the checks with that verdict
    compared: tuple[str, ...]  # what each of them compared

    def as_record(self) -> dict[str, Any]:
        """Return the verdict as one row of a table."""
        return {
            "study": self.study,
            "person": self.person.name if self.person.named else None,
            "finger": self.finger,
            "wedge_angle_deg": self.wedge_angle_deg,
            "roll_angle_deg": self.roll_angle_deg,
            "synthetic": self.synthetic,
            "model": self.model,
            "verdict": self.verdict,
            "checks": " ".join(self.checks),
        }


def verdicts_of(study: FinishedStudy) -> list[ValidityVerdict]:
    """Return the verdicts of a study on Hertz theory and on its layers, in its own order."""
    owners = _owners(study)
    return [
        ValidityVerdict(
            **_whose(one, study, owners),
            wedge_angle_deg=one.wedge_angle_deg,
            roll_angle_deg=one.roll_angle_deg,
            model=model,
            verdict=found.verdict,
            checks=tuple(check.check for check in found.checks if check.verdict == found.verdict),
            compared=tuple(check.compared for check in found.checks if check.verdict == found.verdict),
        )
        for one in study.summary.summaries
        for model, found in _models(one)
    ]


def _models(one: PlacementRecord) -> Iterator[tuple[str, ValidityRecord | LayerValidityRecord]]:
    yield "Hertz theory", one.validity
    if one.validity.on_layer and one.on_layer:
        yield f"{one.on_layer.effective_thickness_mm:g} mm of tissue over bone", one.validity.on_layer


def _owners(study: FinishedStudy) -> dict[str, Person]:
    return {
        finger.finger: Person(finger.person or study.title, bool(finger.person))
        for finger in study.summary.fingers
    }


def _whose(
    of: FingerRecord | PlacementRecord | CurveRecord, study: FinishedStudy, owners: Mapping[str, Person]
) -> dict[str, Any]:
    """Return whose a value or a verdict is."""
    person = owners[of.finger]
    return {"study": study.title, "finger": of.finger, "person": person, "synthetic": of.synthetic}


def values_of(study: FinishedStudy) -> list[Value]:
    """Return all values that a study tells, in its own order; what it does not know is left out."""
    owners = _owners(study)
    found = [*_of_fingers(study, owners), *_of_placements(study, owners), *_of_curves(study, owners)]
    return [value for value in found if math.isfinite(value.value)]


def _of_fingers(study: FinishedStudy, owners: Mapping[str, Person]) -> Iterator[Value]:
    for finger in study.summary.fingers:
        for place, quantity in enumerate(("palmar_mm", "distal_mm", "radial_ulnar_mm")):
            yield Value(
                quantity=quantity,
                **_whose(finger, study, owners),
                value=getattr(finger, quantity),
                std=math.sqrt(finger.covariance_mm2[place][place]),
            )


def _of_placements(study: FinishedStudy, owners: Mapping[str, Person]) -> Iterator[Value]:
    gain = study.summary.load_gain_relative_std
    for summary in study.summary.summaries:
        shares = summary.radius_from_indentation_variance_shares or {}
        angles = sum(shares.get(f"{name} angle", 0.0) for name in ("wedge", "jig", "roll"))
        pad = shares.get("semi-axes", 0.0) + shares.get("pad shape", 0.0) + angles
        # Of what is uncertain in the place of contact the angles have one share in both radii: they reach
        # the corrected radius through R_0g alone.
        shared = {
            "mean_curvature_radius_mm": angles / pad if pad > 0 else 0.0,
            "radius_from_indentation_mm": angles,
        }
        headlines, layer = summary.validity.headlines, summary.on_layer
        found = {
            name: (getattr(summary, name), getattr(summary, f"{name}_std"))
            for name in (*shared, "area_exponent")
        }
        if modulus := headlines.get("youngs_modulus_kpa"):
            found["youngs_modulus_kpa"] = modulus.value, modulus.value_std
        if layer:
            one = layer.highest_load
            found[_ON_LAYER] = one.youngs_modulus_on_layer_kpa, one.youngs_modulus_on_layer_kpa_std
        verdicts = {name: one.verdict for name, one in headlines.items()}
        verdicts[_ON_LAYER] = summary.validity.on_layer.verdict if summary.validity.on_layer else ""
        for quantity, (value, std) in found.items():
            model_std = headlines[quantity].model_std if quantity in headlines else 0.0
            model_std = 0.0 if math.isnan(model_std) else model_std
            yield Value(
                quantity=quantity,
                **_whose(summary, study, owners),
                wedge_angle_deg=summary.wedge_angle_deg,
                roll_angle_deg=summary.roll_angle_deg,
                value=value,
                std=math.hypot(std, model_std),
                shared_std=std * math.sqrt(shared.get(quantity, 0.0)),
                # A modulus from load and area goes with the load, on deep tissue and on a layer.
                gain_std=gain * value if quantity in {"youngs_modulus_kpa", _ON_LAYER} else 0.0,
                model_std=model_std,
                verdict=verdicts.get(quantity, ""),
            )


def _of_curves(study: FinishedStudy, owners: Mapping[str, Person]) -> Iterator[Value]:
    for curve in study.summary.curves:
        for quantity, key in _FROM_CURVES.items() if curve.fit else ():
            yield Value(
                quantity=quantity,
                **_whose(curve, study, owners),
                wedge_angle_deg=curve.wedge_angle_deg,
                roll_angle_deg=0.0,
                value=getattr(curve.fit, key),
                std=getattr(curve.fit, f"{key}_std"),
                source=curve.file or "",
                velocity_mm_per_s=curve.velocity_mm_per_s,
            )
