"""Remarks in words."""

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
    "edited_by_person": "a person drew part of the contact, or all of it",
    "coin_shadow": "a shadow beside the coin may make the scale too small",
    "no_time": "the frame has no time",
    "no_force": "the force does not last so long",
}


def in_words(codes: str, words: Mapping[str, str]) -> list[str]:
    """Return the remark for each of the codes, which are separated by spaces."""
    return [words.get(code, code) for code in codes.split()]


def doubtful_frames(result: StudyResult) -> Iterator[tuple[str, int, str]]:
    """Yield for each sequence and flag the sequence's name, the number of frames, and the flag in words."""
    frames = result.rows.at(result.rows.known("frame"))
    doubts = Counter(zip(frames.column("sequence"), frames.column("flags"), strict=True))
    counts: Counter[tuple[str, str]] = Counter()
    for (name, flags), count in doubts.items():
        for flag in flags.split():
            counts[name, flag] += count
    for (name, flag), count in counts.items():
        yield name, count, FLAG_WORDS.get(flag, flag)
