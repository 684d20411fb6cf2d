"""Contact images that two persons outlined, the second without seeing what the first drew; how they agree."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from fingerpad.image import read_image
from fingerpad.study.corrections.apply import corrected_contact_image
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.engine.runner import Perform
from fingerpad.study.engine.task import Record, Task, in_study
from fingerpad.study.manifest.models import Observation, ScaleKey
from fingerpad.study.measuring.context import FoundScale, RunContext, require_scale

QUANTITY_WORDS: Final = {
    "semi_major_mm": "semi-major axis",
    "semi_minor_mm": "semi-minor axis",
    "gross_area_mm2": "gross area A",
    "ridge_area_mm2": "ridge area",
}
QUANTITIES: Final = tuple(QUANTITY_WORDS)


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatorPair:
    """A contact image measured under the outlines of two persons."""

    observation: str
    first_operator: str
    second_operator: str
    synthetic: bool
    # By the names of `QUANTITIES`, empty where a measurement failed.
    first: dict[str, float] = field(default_factory=dict)
    second: dict[str, float] = field(default_factory=dict)
    iou: float | None = None  # of the two regions
    reason: str | None = None

    def as_record(self) -> dict[str, object]:
        """Return it as a line of ``second_operator.csv``."""
        measured = {"first": self.first, "second": self.second}
        return {
            "observation": self.observation,
            "synthetic": self.synthetic,
            "first_operator": self.first_operator,
            "second_operator": self.second_operator,
            **{f"{who}_{name}": of.get(name) for who, of in measured.items() for name in QUANTITIES},
            "iou": self.iou,
            "reason": self.reason,
        }


def blind_order(names: Sequence[str]) -> list[str]:
    """Return names in a random order, the same everywhere, whose first few are a random sample."""
    return sorted(names, key=lambda name: hashlib.sha256(name.encode(errors="surrogatepass")).hexdigest())


def operator_pairs(context: RunContext, perform: Perform) -> list[OperatorPair]:
    """Return the images that two persons outlined, in the manifest's order; those not stored are measured.

    What either rejected is left out, and what the first has not looked at; so is a second look by the first.
    """
    outlined = list(_outlined(context))
    tasks = [
        Task(
            name=f"/second operator {observation.name}",  # no item's name begins like this
            item=observation.name,
            file=observation.file or "",
            key=context.key(observation, one.edits, other.edits),
            work=partial(_compare, observation, context.scale(scale), one, other),
            inputs=context.inputs_of(observation),
        )
        for observation, scale, one, other in outlined
    ]
    records = perform(tasks)
    return [
        OperatorPair(
            observation=observation.name,
            first_operator=context.active_corrections[observation.name].who,
            second_operator=context.second_operator[observation.name].who,
            synthetic=observation.synthetic,
            **record,
        )
        for (observation, *_), record in zip(outlined, records.values(), strict=True)
    ]


def _outlined(
    context: RunContext,
) -> Iterator[tuple[Observation, ScaleKey, ContactCorrection, ContactCorrection]]:
    """Yield contact images with their scale and what two persons made of them."""
    for observation in context.study.observations:
        name = observation.name
        first, second = context.active_corrections.get(name), context.second_operator.get(name)
        if observation.file is None or observation.scale is None or first is None or second is None:
            continue
        one, other = first.change, second.change
        assert isinstance(one, ContactCorrection)  # the items' own rule
        assert isinstance(other, ContactCorrection)
        looked = (each.accepted or each.edits for each in (one, other))
        if first.who != second.who and not (one.rejected or other.rejected) and all(looked):
            yield observation, observation.scale, one, other


def _compare(
    observation: Observation,
    scale: FoundScale | str,
    one: ContactCorrection,
    other: ContactCorrection,
    folder: Path,
    _out: Path,
) -> Record:
    assert observation.file is not None  # as the task was made
    pixels, found = read_image(folder / observation.file).pixels, require_scale(scale)
    regions, record = [], Record()
    for name, correction in {"first": one, "second": other}.items():
        seen = corrected_contact_image(pixels, found.scale, observation, folder, correction).contact_image
        if seen is None:
            return {"reason": in_study(f"the {name} operator's correction leaves no contact", folder)}
        record[name] = dict(zip(QUANTITIES, seen.values.tolist(), strict=True))
        regions.append(seen.region)
    both, either = np.logical_and(*regions), np.logical_or(*regions)
    return record | {"iou": np.count_nonzero(both) / np.count_nonzero(either)}
