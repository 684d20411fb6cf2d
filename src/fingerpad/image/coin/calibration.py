"""What moves the edge of a coin all round, as chosen on coins of known size.

How well it does on others: docs/reference/accuracy.md.
"""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True, kw_only=True)
class CoinEdge:
    """Standard deviations of what shifts the edge of a coin as a whole."""

    lens_px: float = 0.08  # px; lens and lamp
    rounding: float = 0.0045  # of the radius; the rounded edge, which mirrors the background
    shadow: float = 0.045  # of the radius; a shadow beside the edge as strong as the coin's contrast
    band: float = 0.006  # of the radius; a band beside the edge as strong as that


COIN_EDGE: Final = CoinEdge()
