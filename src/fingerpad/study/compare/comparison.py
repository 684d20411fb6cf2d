"""Studies compared: values, means, and what a reader must know of them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from fingerpad._csv import write_csv
from fingerpad._display import Displayed
from fingerpad._files import make_folder
from fingerpad._json import dumps
from fingerpad.exceptions import FingerpadError
from fingerpad.study.compare.finished import FinishedStudy, read_finished
from fingerpad.study.compare.means import Mean, means_of
from fingerpad.study.compare.values import QUANTITIES, ValidityVerdict, Value, values_of, verdicts_of

# Curves whose velocities differ by more are not of one kind: moduli grow with velocity.
_SAME_VELOCITY: Final = 1.5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Comparison(Displayed):
    """Several finished studies side by side.

    Attributes
    ----------
    studies : tuple of FinishedStudy
        What was compared.
    values : tuple of Value
        Every value of every finger.
    means : tuple of Mean
        Over people, for each quantity and placement, real and synthetic apart.
    verdicts : tuple of ValidityVerdict
        Whether Hertz theory, and the layer where there is one, hold for each finger at each placement.
    notes : tuple of str
        What a reader must know.
    """

    studies: tuple[FinishedStudy, ...]
    values: tuple[Value, ...]
    means: tuple[Mean, ...]
    verdicts: tuple[ValidityVerdict, ...]
    notes: tuple[str, ...]

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
    """Compare finished studies, each named by its output folder or a file in it.

    Raises
    ------
    FingerpadError
        If one is no finished run, two are the same, or none tells a value.
    """
    studies = read_finished(paths)
    values = [value for study in studies for value in values_of(study)]
    if not values:
        raise FingerpadError("there is nothing to compare: no finger of these studies could be measured")
    order = list(QUANTITIES)
    means = sorted(means_of(values), key=lambda mean: (order.index(mean.quantity), *_order(mean)))
    return Comparison(
        studies=tuple(studies),
        values=tuple(values),
        means=tuple(means),
        verdicts=tuple(verdict for study in studies for verdict in verdicts_of(study)),
        notes=tuple(_notes(studies, values)),
    )


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
    speeds = [value.velocity_mm_per_s for value in values if value.velocity_mm_per_s > 0]
    if speeds and max(speeds) > _SAME_VELOCITY * min(speeds):
        yield (
            f"loading curves were taken at {min(speeds):.2g} to {max(speeds):.2g} mm/s; skin is the stiffer "
            "the faster it is pressed, and means of E_0g mix what differs for that reason"
        )


def write_comparison(comparison: Comparison, out: Path) -> None:
    """Write ``compare*.csv`` (values, means, verdicts) and ``compare.json`` into a folder.

    Raises
    ------
    FingerpadError
        If a file cannot be written.
    """
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
        raise FingerpadError(f"{error.filename}: cannot be written ({error.strerror})") from error
