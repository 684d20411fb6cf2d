"""What a terminal shows of a run and of a comparison: the sentences of their pages, as lines."""

import math
from collections.abc import Iterator

from fingerpad._display import aligned
from fingerpad._rounding import positive_with_uncertainty, value_with_uncertainty
from fingerpad.report import text
from fingerpad.study.compare import QUANTITIES, Comparison, Mean, OfFinger, Value
from fingerpad.study.results.output import answers_of
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.validity.model_checks import FAILS, FAILS_ABOVE, STRAINED, STRAINED_ABOVE


def outcome_lines(result: StudyResult) -> Iterator[str]:
    """Yield the answers of a run, and what is doubtful of them."""
    for summary, answer in zip(result.summaries, answers_of(result), strict=True):
        yield answer.sentence
        if not summary.column("pooled").any():
            yield f"{answer.label}: {text.why_not_pooled(summary)}"
    yield from text.fingers_without_results(result)
    if any(one.validity.verdict in {STRAINED, FAILS} for one in result.placements):
        yield (
            f"Hertz theory: {STRAINED} where it is off by more than {100 * STRAINED_ABOVE:.0f} % beyond "
            f"chance, {FAILS} where by more than {100 * FAILS_ABOVE:.0f} % far beyond it; in brackets, its "
            "largest difference"
        )
    yield from text.doubtful_results(result)


def outcome_notes(result: StudyResult) -> Iterator[str]:
    """Yield what looks wrong in the input of a run."""
    yield from result.notes
    yield from text.to_check(result, answers_of(result))
    yield from text.sequence_notes(result)


def comparison_lines(found: Comparison) -> Iterator[str]:
    """Yield values and means of each quantity, whether the model holds, and notes."""
    for name, kind in QUANTITIES.items():
        values, means = found.of(name)
        over_people = (_mean_cells(mean) for mean in means if len(mean.people) > 1)
        if values:
            yield f"{name}: {kind.words}{kind.unit and f', {kind.unit}'}"
            yield from aligned([*map(_value_cells, values), *over_people], "  ")
    if found.verdicts:
        yield "validity: whether the model holds, and which checks say so"
        verdicts = ((_who(v), _place(v), v.model, v.verdict, ", ".join(v.checks)) for v in found.verdicts)
        yield from aligned(verdicts, "  ")
    yield from (f"note: {note}" for note in found.notes)


def _who(one: OfFinger) -> str:
    return f"{one.person.name}, {one.finger}{'  (synthetic)' if one.synthetic else ''}"


def _place(one: OfFinger | Mean) -> str:
    if one.wedge_angle_deg is None:
        return ""
    return f"{one.wedge_angle_deg:g}°" + (f", roll {one.roll_angle_deg:g}°" if one.roll_angle_deg else "")


def _words(one: Value | Mean) -> str:
    """Return a value with ±, or with a factor where only positive values make sense."""
    positive = QUANTITIES[one.quantity].positive
    return (positive_with_uncertainty if positive else value_with_uncertainty)(one.value, one.std)


def _value_cells(value: Value) -> tuple[str, str, str]:
    at = f" at {value.load:.3g} N" if value.load > 0 else ""
    verdict = f" ({value.verdict})" if value.verdict else ""
    return _who(value), _place(value), f"{_words(value)}{at}{verdict}"


def _mean_cells(mean: Mean) -> tuple[str, str, str]:
    low, high = mean.interval or (math.nan, math.nan)
    words = f"{_words(mean)}  95 %: {low:.3g} to {high:.3g}, between people {mean.between_people_std:.2g}"
    at = "" if mean.load is None else f" at {mean.load:g} N"
    label = "  (synthetic)" if mean.synthetic else ""
    return f"mean of {len(mean.people)} people{at}{label}", _place(mean), words
