"""What a study found of each finger at each placement, in one sentence."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from fingerpad._rounding import positive_with_uncertainty
from fingerpad.study.error_text import counted
from fingerpad.study.results.summary_file import AtLoadRecord, CheckRecord, PlacementRecord
from fingerpad.study.results.validity import MODULUS
from fingerpad.study.results.validity.model_checks import FAILS, STRAINED

# What a check compares, by the first word of its name.
_COMPARED: Final = {
    "radius": "radius",
    "loading": "radius",
    "modulus": "modulus",
    "youngs": "modulus",
    "indentation": "indentation",
    "shape": "shape",
    "area": "modulus over loads",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What was found of a finger at a placement.

    Attributes
    ----------
    of : PlacementRecord
        The placement, its corrected radius, R_g and checks.
    load : float
        Its highest load, N; NaN where no contact counts.
    area, area_std : float
        Contact area there, mm², with its standard uncertainty; NaN where single contacts have none.
    modulus, modulus_std : float
        Young's modulus there, kPa, with its standard uncertainty, the model's part included.
    on_bone : bool
        Whether that is of tissue of the stated thickness over bone; otherwise it is by Hertz theory.
    """

    of: PlacementRecord
    load: float
    area: float
    area_std: float
    modulus: float
    modulus_std: float
    on_bone: bool

    @property
    def label(self) -> str:
        """The finger and its angles."""
        roll = f", roll {self.of.roll_angle_deg:g}°".replace("-", "−") if self.of.roll_angle_deg else ""
        return f"{self.of.finger}, {self.of.wedge_angle_deg:g}°{roll}"

    @property
    def text(self) -> str:
        """What was found, without whose it is."""
        of, hertz = self.of, self.of.validity
        if not of.radius_from_indentation_count:
            seen = counted(of.count or of.frames, "contact" if of.count else "frame")
            return f"no modulus and no corrected radius, as none of {seen} counts"
        if self.on_bone and hertz.on_layer and hertz.on_layer.verdict in {STRAINED, FAILS}:
            layer = _largest(hertz.on_layer.verdict, hertz.on_layer.checks)
            bone = f" on its bone (layer {hertz.on_layer.verdict}{layer and f': {layer}'})"
        else:
            bone = " on its bone" if self.on_bone else " without bone" if of.on_layer else ", bone unknown"
        largest = _largest(hertz.verdict, hertz.checks)
        return (
            f"{_quantity('modulus', self.modulus, self.modulus_std, 'kPa')}{bone}; "
            f"Hertz theory {hertz.verdict}{largest and f' ({largest})'}; "
            + _quantity(
                "corrected radius",
                of.radius_from_indentation_mm,
                of.radius_from_indentation_mm_total_std,
                "mm",
            )
        )

    @property
    def sentence(self) -> str:
        """Both as one sentence."""
        return f"{self.label}{' (synthetic)' if self.of.synthetic else ''}: {self.text}."


def answers(placements: Iterable[PlacementRecord], by_load: Iterable[AtLoadRecord]) -> list[Answer]:
    """Return what was found at each placement.

    Parameters
    ----------
    placements : iterable of PlacementRecord
        ``summaries`` of a `SummaryFile`.
    by_load : iterable of AtLoadRecord
        Its ``by_load``.

    Returns
    -------
    list of Answer
        One for each placement.
    """
    highest = {one.key: one for one in sorted(by_load, key=lambda one: one.load_N)}
    return [_answer(one, highest.get(one.key)) for one in placements]


def _answer(of: PlacementRecord, highest: AtLoadRecord | None) -> Answer:
    if highest is None:  # frames alone: of the one at the highest load
        modulus = of.validity.headlines[MODULUS]
        return Answer(
            of=of,
            load=of.validity.load_N,
            area=math.nan,
            area_std=math.nan,
            modulus=modulus.value,
            modulus_std=modulus.total_std,
            on_bone=False,
        )
    on_bone = not math.isnan(highest.youngs_modulus_on_layer_kpa)
    name = "youngs_modulus_on_layer_kpa" if on_bone else "youngs_modulus_kpa"
    return Answer(
        of=of,
        load=highest.load_N,
        area=highest.contact_area_mm2,
        area_std=highest.contact_area_mm2_std,
        modulus=getattr(highest, name),
        modulus_std=getattr(highest, f"{name}_std"),
        on_bone=on_bone,
    )


def _quantity(words: str, value: float, std: float, unit: str) -> str:
    if math.isnan(value):
        return f"{words} unknown"
    return f"{words} {positive_with_uncertainty(value, std)} {unit}"


def _largest(verdict: str, checks: Sequence[CheckRecord]) -> str:
    """Return the largest difference that a verdict rests on; empty where it rests on none."""
    concerned = [one for one in checks if one.verdict == verdict and math.isfinite(one.relative_difference)]
    if verdict not in {STRAINED, FAILS} or not concerned:
        return ""
    # Of one comparison in several words the first.
    worst = max(concerned, key=lambda one: round(abs(math.log1p(one.relative_difference)), 9))
    difference = f"{100 * worst.relative_difference:+.0f} %".replace("-", "−")
    return f"{_COMPARED[worst.check.split('_')[0]]} {difference}"
