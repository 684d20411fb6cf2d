"""What is known of a finger at an angle, for all checks."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Final, NamedTuple, Self

import pandas as pd

from fingerpad.loading import LoadingFit
from fingerpad.study.manifest import Study
from fingerpad.study.measuring.curves import CurveResult, LoadingRadius, loading_radius
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.pooling import Summary
from fingerpad.study.results.rows import HighestLoad, Rows
from fingerpad.study.results.table import Row, first_record
from fingerpad.study.results.validity.model_checks import ValidityCheck

# Results with a verdict, by the column that holds them.
RADIUS: Final = "radius_from_indentation_mm"
MODULUS: Final = "youngs_modulus_kpa"
INDENTATION: Final = "indentation_mm"
HEADLINES: Final = (RADIUS, MODULUS, INDENTATION)
# Checks by two ways to a headline.
ROUTES: Final = {
    RADIUS: "radius_against_loading",
    MODULUS: "modulus_against_curve",
    INDENTATION: "indentation_against_curve",
}
UNITS: Final = {RADIUS: "mm", MODULUS: "kPa", INDENTATION: "mm"}

HERTZ_EXPONENT: Final = 2 / 3
# Loads are the same where their ratio is above this.
SAME_LOAD: Final = 0.9
NO_CURVE: Final = "no loading data of this finger at this angle"
NOTHING_COUNTS: Final = "no contact counts"


class Place(NamedTuple):
    """A finger at an angle: its contacts, the one at the highest load, and its loading data."""

    study: Study
    pad: FingerResult
    summary: Summary
    highest: HighestLoad | None
    highest_row: Row | None
    loading: LoadingRadius | None
    fits: tuple[LoadingFit, ...]
    loaded: pd.DataFrame

    @classmethod
    def of(
        cls,
        study: Study,
        fingers: Mapping[str, FingerResult],
        rows: Rows,
        summary: Summary,
        curves: Sequence[CurveResult],
    ) -> Self:
        """Gather what is known of a summary's finger at its angle."""
        highest = rows.highest_load.get(summary.key)
        compared = summary.contacts_or_frames
        return cls(
            study=study,
            pad=fingers[summary.finger],
            summary=summary,
            highest=highest,
            highest_row=highest and first_record(summary.of_observation(highest.observation)),
            loading=loading_radius(curves, summary.place),
            fits=tuple(_fits(curves, summary)),
            loaded=compared[compared["pooled"] & (compared["load_N"] > 0)],
        )


def _fits(curves: Iterable[CurveResult], of: Summary) -> Iterator[LoadingFit]:
    """Yield the fits of the loading curves of a finger at its angle that found the place of contact."""
    for curve in curves:
        fit = curve.fit
        if fit is None or curve.manifest.place != of.place:
            continue
        if 0 < fit.contact_offset.std < math.inf:
            yield fit


def missing(name: str, compared: str, quantities: Sequence[str], why: str) -> ValidityCheck:
    """Return a check without data."""
    return ValidityCheck(name=name, compared=compared, quantities=tuple(quantities), note=why)
