"""Agreement of two persons on the contact images that both outlined."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from fingerpad.study.measuring.operators import QUANTITIES, OperatorPair
from fingerpad.uncertainty import Agreement, agreement

QUANTITY_WORDS: Final = dict(
    zip(QUANTITIES, ("semi-major axis", "semi-minor axis", "gross area A", "ridge area"), strict=True)
)


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatorAgreement:
    """How two persons agree on the outlines of contact images.

    Attributes
    ----------
    synthetic : bool
        Whether these are rendered images.
    pairs : tuple of OperatorPair
        Those that could be measured under both outlines.
    quantities : dict of str to Agreement
        By the name of the column.
    iou_mean, iou_least : float
        Intersection over union of the two regions.
    """

    synthetic: bool
    pairs: tuple[OperatorPair, ...]
    quantities: dict[str, Agreement]
    iou_mean: float
    iou_least: float

    @property
    def operators(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Who was first, and who second."""
        first, second = (
            {one.first_operator for one in self.pairs},
            {one.second_operator for one in self.pairs},
        )
        return tuple(sorted(first)), tuple(sorted(second))


def operator_agreement(pairs: Sequence[OperatorPair]) -> list[OperatorAgreement]:
    """Return how the two persons agree, of real images and of synthetic ones, where there are any."""
    found = []
    for synthetic in (False, True):
        some = tuple(one for one in pairs if one.synthetic == synthetic and one.iou is not None)
        if not some:
            continue
        ious = [one.iou for one in some if one.iou is not None]
        found.append(
            OperatorAgreement(
                synthetic=synthetic,
                pairs=some,
                quantities={
                    name: agreement([one.first[name] for one in some], [one.second[name] for one in some])
                    for name in QUANTITIES
                    if all(one.first[name] > 0 and one.second[name] > 0 for one in some)
                },
                iou_mean=float(np.mean(ious)),
                iou_least=min(ious),
            )
        )
    return found
