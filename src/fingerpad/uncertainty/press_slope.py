"""The slope of frames of presses, whose errors are not independent."""

import math
from typing import Final, NamedTuple, Self, TypeAlias

import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre
from scipy import special

from fingerpad._arrays import FloatArray
from fingerpad.uncertainty.propagate import NORMAL_97_5

Indices: TypeAlias = npt.NDArray[np.intp]
# A press of fewer frames shows no bends.
_LEAST_FRAMES: Final = 4


class PressSlope(NamedTuple):
    """Slope of the frames of presses, each with a level of its own.

    The errors of a press's frames are not independent: they change smoothly from frame to frame, and a part
    of them looks like growth.
    """

    value: float
    weights: FloatArray  # that of each frame in it
    # Its standard uncertainty with degrees of freedom, as the bends of presses and the difference between
    # their slopes tell: an error that bends a press by a quadratic and a cubic part tilts it as much.
    scatter_std: float
    freedom: float
    # The same if the stated uncertainty of a press's areas is one error, independent at its two ends.
    own_std: float

    @property
    def std(self) -> float:
        """The larger of both, the first as wide as its few degrees of freedom ask: ± 1.96 of it is 95 %."""
        wider = special.stdtrit(self.freedom, 0.975) / NORMAL_97_5
        return max(float(wider) * self.scatter_std, self.own_std)

    @classmethod
    def of(
        cls, load: FloatArray, area: FloatArray, own: FloatArray, item: npt.NDArray[np.intp]
    ) -> Self | None:
        """Return the slope of ln area on ln load over presses of four frames or more; None without any."""
        weights, found = np.zeros(load.size), []
        for each in np.flatnonzero(np.bincount(item) >= _LEAST_FRAMES):
            of = np.flatnonzero(item == each)
            x, span = load[of], np.ptp(load[of])
            if np.unique(x).size < _LEAST_FRAMES:
                continue
            basis, _ = np.linalg.qr(legendre.legvander(2 * (x - x.min()) / span - 1, 3))
            weights[of] = x - x.mean()
            spread = weights[of] @ weights[of]
            ends = math.sqrt(2 * float(np.mean(own[of] ** 2))) / span
            found.append(
                (spread, weights[of] @ area[of] / spread, np.sum((basis[:, 2:].T @ area[of]) ** 2), ends)
            )
        if not found:
            return None
        spread, slope, bends, ends = np.transpose(found)
        value, apart = float(spread @ slope / spread.sum()), len(found) - 1
        between = float(spread @ (slope - value) ** 2)
        freedom = 2 * len(found) + apart
        variance = (float(bends.sum()) + between) / freedom
        if apart and between / apart > variance:
            variance, freedom = between / apart, apart
        return cls(
            value=value,
            weights=weights / spread.sum(),
            scatter_std=math.sqrt(variance / spread.sum()),
            freedom=freedom,
            own_std=float(np.linalg.norm(spread * ends) / spread.sum()),
        )
