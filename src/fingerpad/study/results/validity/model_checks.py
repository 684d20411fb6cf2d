"""Whether a model holds: comparisons of two ways to a quantity, known errors, and by how much it is wrong."""

import math
from collections.abc import Collection, Iterable, Sequence
from typing import Any, Final, Self

from pydantic import Field
from scipy import special

from fingerpad._csv import package_table
from fingerpad.study.results.summary_file import CheckRecord
from fingerpad.uncertainty.propagate import NORMAL_97_5

HOLDS: Final = "holds"
STRAINED: Final = "strained"
FAILS: Final = "fails"
NOT_TESTED: Final = "not tested"
# From good to bad; what was not tested says nothing.
VERDICTS: Final = (NOT_TESTED, HOLDS, STRAINED, FAILS)

# A difference counts where chance does not explain it, and where it is large enough to matter.
STRAINED_BELOW_P, FAILS_BELOW_P = 0.05, 0.001
STRAINED_ABOVE, FAILS_ABOVE = 0.05, 0.2


class ValidityCheck(CheckRecord):
    """One check of a model: what it compares, and what comes of it."""

    # Standard uncertainty of the relative difference, as of a logarithm; NaN for a known error.
    relative_std: float = Field(default=math.nan, exclude=True)

    def with_fields(self, **changed: Any) -> Self:
        """Return the check with some fields changed; all of them stand in the file, null where unknown."""
        # One set of the fields that are set serves all checks: of their memory it would be the most.
        return self.model_construct(_fields_set=_ALL_SET, **{**dict(self), **changed})

    def untested(self, why: str) -> Self:
        """Return the check without data."""
        return self.with_fields(unit="", note=why)

    def compared_with(
        self,
        value: tuple[float, float],
        reference: tuple[float, float],
        *,
        change: float,
        relative_std: float,
        deviations: float,
        degrees_of_freedom: float = math.inf,
        **found: Any,
    ) -> Self:
        """Return the check of a value against another, each with its standard uncertainty, with its verdict.

        `change` is by how much the difference changes the logarithm of the results that the check concerns.
        """
        names = ("value", "value_std", "reference", "reference_std")
        values: dict[str, Any] = {
            **dict(zip(names, (*value, *reference), strict=True)),
            "difference": value[0] - reference[0],
            "relative_difference": math.expm1(change),
            "relative_std": relative_std,
            "deviations": deviations,
            "p_value": p_value_of(deviations, degrees_of_freedom),
        }
        return self.with_fields(**{**values, **found}).judged()

    def of_ratio(
        self,
        value: tuple[float, float],
        reference: tuple[float, float],
        *,
        log_std: float | None = None,
        **found: Any,
    ) -> Self:
        """Compare a positive quantity with another value of it, by the logarithm of their ratio.

        `log_std` is its standard uncertainty where both have errors in common.
        """
        spread = math.hypot(value[1] / value[0], reference[1] / reference[0]) if log_std is None else log_std
        ratio = math.log(value[0] / reference[0])
        deviations = _deviations(ratio, spread)
        return self.compared_with(
            value, reference, change=ratio, relative_std=spread, deviations=deviations, **found
        )

    def of_difference(
        self, value: tuple[float, float], reference: float, *, effect: float, **found: Any
    ) -> Self:
        """Compare a pure number, such as an exponent, with the model's.

        `effect` is by how much a unit of the difference changes the logarithm of what the check concerns.
        """
        difference = value[0] - reference
        return self.compared_with(
            value,
            (reference, 0.0),
            change=effect * difference,
            relative_std=abs(effect) * value[1],
            deviations=_deviations(difference, value[1]),
            **found,
        )

    def of_known_error(self, value: tuple[float, float], reference: tuple[float, float], note: str) -> Self:
        """Compare a model with a better one on the same data: a known error, without a probability.

        Both have nearly all their errors in common, so that their difference is known far better than they.
        """
        error = value[0] / reference[0] - 1
        return self.with_fields(
            verdict=verdict_of(0.0, math.expm1(abs(math.log1p(error)))),
            value=value[0],
            value_std=value[1],
            reference=reference[0],
            reference_std=reference[1],
            difference=value[0] - reference[0],
            relative_difference=error,
            note=note,
        )

    def judged(self, p_value: float | None = None) -> Self:
        """Return the check with the verdict by its p, or by one that allows for others beside it."""
        if math.isnan(self.p_value):
            return self
        p_value = self.p_value if p_value is None else p_value
        size = math.expm1(abs(math.log1p(self.relative_difference)))
        verdict, note = verdict_of(p_value, size, self.relative_std), self.note
        if verdict == NOT_TESTED:
            why = f"uncertain by {100 * self.relative_std:.0f} %, which would hide a difference of 20 %"
            if self.p_value < STRAINED_BELOW_P:
                why = f"p = {p_value:.2g} among all comparisons: it may be chance"
            if why not in note:
                note = f"{note}; {why}" if note else why
        return self.with_fields(verdict=verdict, note=note)


_ALL_SET: Final = set(ValidityCheck.model_fields)


def judge_together(checks: Sequence[ValidityCheck], same: Collection[str] = ()) -> tuple[ValidityCheck, ...]:
    """Judge several checks so that the chance of any false alarm among them is that of one (Holm).

    The smallest of n probabilities counts n times, the next n − 1 times, and so on, each at least as much as
    the one before. A difference that is certain thus takes nothing from the others.

    Checks without a probability stay as they are; those named `same` are one comparison.
    """
    comparisons = [-1 if one.check in same else number for number, one in enumerate(checks)]
    least: dict[int, float] = {}
    for comparison, one in zip(comparisons, checks, strict=True):
        if not math.isnan(one.p_value):
            least[comparison] = min(least.get(comparison, 1.0), one.p_value)
    adjusted, largest = {}, 0.0
    for place, (comparison, p_value) in enumerate(sorted(least.items(), key=lambda item: item[1])):
        largest = adjusted[comparison] = min(1.0, max(largest, (len(least) - place) * p_value))
    return tuple(
        one.judged(max(one.p_value, adjusted.get(comparison, 1.0)))
        for comparison, one in zip(comparisons, checks, strict=True)
    )


def verdict_of(p_value: float, relative_difference: float, relative_std: float = 0.0) -> str:
    """Return the verdict on a difference from its probability and its size.

    Strained: p < 0.05 and more than 5 %. Fails: p < 0.001 and more than 20 %. Where p ≥ 0.05, but the
    uncertainty would hide a difference of 20 %, nothing was tested.
    """
    size = abs(relative_difference)
    if p_value < FAILS_BELOW_P and size > FAILS_ABOVE:
        return FAILS
    if p_value < STRAINED_BELOW_P:
        return STRAINED if size > STRAINED_ABOVE else HOLDS
    return NOT_TESTED if not NORMAL_97_5 * relative_std <= FAILS_ABOVE else HOLDS


def p_value_of(deviations: float, degrees_of_freedom: float = math.inf) -> float:
    """Return the chance of a larger difference of either sign, by Student's t."""
    return float(2 * special.stdtr(degrees_of_freedom, -abs(deviations)))


def overall_verdict(verdicts: Iterable[str]) -> str:
    """Return the worst of some verdicts; ``not tested`` where nothing was."""
    return max(verdicts, key=VERDICTS.index, default=NOT_TESTED)


def _deviations(difference: float, spread: float) -> float:
    """Return a difference in its standard uncertainties: infinite where it is exact, and not zero."""
    if spread > 0:
        return difference / spread
    return math.copysign(math.inf, difference) if difference else 0.0


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
_TABLE: Final = package_table("fingerpad.study.results.validity", "checks.csv")
# All checks, without what comes of them, and what each compares, in short.
CHECKS: Final = {
    line["check"]: ValidityCheck.model_validate({**line, "headlines": line["headlines"].split()})
    for line in _TABLE
}
QUANTITIES_COMPARED: Final = {line["check"]: line["quantity"] for line in _TABLE}

AREA_FALLS: Final = "area_falls"
OF_PAD: Final = "youngs_modulus_on_half_space"
