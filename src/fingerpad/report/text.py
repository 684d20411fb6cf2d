"""Numbers and remarks in words."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Final

from fingerpad.study.pipeline import StudyResult

FLAG_WORDS: Final[Mapping[str, str]] = {
    "touches_border": "the contact is cut by the edge of the picture",
    "low_contrast": "the contact hardly stands out from its ground",
    "several_regions": "there are other patches beside the one measured",
    "poor_ellipse": "the contact is not well described by an ellipse",
    "cut_by_mask": "the contact is cut by the mask or region of interest",
    "scale_doubtful": "the ridge period is not that of a finger: check the scale",
    "coin_shadow": "a shadow beside the coin may make the scale too small",
    "no_time": "the frame has no time",
    "no_force": "the force does not last so long",
}


def value_with_uncertainty(value: float | None, std: float | None = None) -> str:
    """Return ``value ± standard uncertainty``, the uncertainty with two digits (GUM 7.2.6).

    Examples
    --------
    >>> value_with_uncertainty(13.80484, 0.18442)
    '13.80 ± 0.18'
    >>> value_with_uncertainty(1234.5, 56.7)
    '1234 ± 57'
    >>> value_with_uncertainty(0.5)
    '0.500'
    """
    if value is None or not math.isfinite(value):
        return "–"
    if std is None or not math.isfinite(std) or std <= 0:
        return f"{value:.4g}" if abs(value) >= 1 else f"{value:.3f}"
    decimals = _decimals(std)
    return f"{round(value, decimals):.{max(decimals, 0)}f} ± {two_digits(std)}"


def two_digits(std: float) -> str:
    """Return a standard uncertainty with two digits.

    Examples
    --------
    >>> two_digits(0.0996), two_digits(5678.0)
    ('0.10', '5700')
    """
    decimals = _decimals(std)
    return f"{round(std, decimals):.{max(decimals, 0)}f}"


def _decimals(std: float) -> int:
    """Return the decimal place of the second digit, after rounding: 0.0996 becomes 0.10."""
    decimals = 1 - math.floor(math.log10(std))
    return decimals - 1 if round(std, decimals) >= 10 ** (2 - decimals) else decimals


def in_words(codes: str, words: Mapping[str, str]) -> list[str]:
    """Return the remark for each of the codes, which are separated by spaces."""
    return [words.get(code, code) for code in codes.split()]


def doubtful_frames(result: StudyResult) -> Iterator[tuple[str, int, str]]:
    """Yield for each sequence and flag the sequence's name, the number of frames, and the flag in words."""
    counts: Counter[tuple[str, str]] = Counter()
    for row in result.rows:
        if row["frame"] is not None:
            counts.update((row["sequence"], flag) for flag in row["flags"].split())
    for (name, flag), count in counts.items():
        yield name, count, FLAG_WORDS.get(flag, flag)
