"""The exponent of the contact area's growth with load, over contacts or over the frames of presses."""

import math
from typing import Final, NamedTuple, Self

import numpy as np
import pandas as pd
from numpy.polynomial import legendre
from scipy import special

from fingerpad._arrays import FloatArray, as_float_array
from fingerpad.study.results.table import Places, numbered

# A press of fewer frames shows no bends.
_LEAST_FRAMES: Final = 4
_NORMAL_97_5: Final = 1.959963984540054


class Exponent(NamedTuple):
    """Slope of ln A against ln W, with its standard uncertainty, NaN if not known."""

    value: float
    std: float


class PressSlope(NamedTuple):
    """Slope of the frames of presses, each with a level of its own.

    The errors of a press's frames are not independent: they change smoothly from frame to frame, and a part
    of them looks like growth.

    Attributes
    ----------
    value : float
        The slope.
    weights : ndarray
        That of each frame in it.
    scatter_std, freedom : float
        Its standard uncertainty with degrees of freedom, as the bends of presses and the difference between
        their slopes tell: an error that bends a press by a quadratic and a cubic part tilts it as much.
    own_std : float
        The same if the stated uncertainty of a press's areas is one error, independent at its two ends.
    """

    value: float
    weights: FloatArray
    scatter_std: float
    freedom: float
    own_std: float

    @property
    def std(self) -> float:
        """The larger of both, the first as wide as its few degrees of freedom ask: ± 1.96 of it is 95 %."""
        wider = special.stdtrit(self.freedom, 0.975) / _NORMAL_97_5
        return max(float(wider) * self.scatter_std, self.own_std)

    @classmethod
    def of(cls, load: FloatArray, area: FloatArray, own: FloatArray, item: Places) -> Self | None:
        """Return the slope over the presses of four frames or more under different loads; None without any.

        Parameters
        ----------
        load, area : ndarray
            Logarithms.
        own : ndarray
            Standard uncertainties of `area` that no other press shares.
        item : ndarray of int
            Which press each is a frame of.
        """
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


def area_exponent(rows: pd.DataFrame) -> Exponent:
    """Return the exponent of A ∝ W^n over the pooled of some rows: contacts, or frames of sequences.

    Of contacts two loads give a slope and three its uncertainty, from the scatter about it and the edge. Of
    presses it is from their bends, the difference between them and the edge, and no less than from the stated
    uncertainty of their areas.
    """
    sound = rows[rows["pooled"] & (rows["load_N"] > 0)]
    major, minor = sound["semi_major_mm"].to_numpy(), sound["semi_minor_mm"].to_numpy()
    x, y = np.log(sound["load_N"].to_numpy()), np.log(np.pi * major * minor)
    if np.unique(x).size < 2:
        return Exponent(math.nan, math.nan)
    presses = PressSlope.of(x, y, area_noise(sound), items_of(sound))
    if presses is None:
        if x.size < 3:
            return Exponent(float(np.polyfit(x, y, 1)[0]), math.nan)
        (value, _), covariance = np.polyfit(x, y, 1, cov=True)
        weights, std = np.linalg.pinv(np.vander(x, 2))[0], math.sqrt(covariance[0, 0])
    else:
        value, weights, std = presses.value, presses.weights, presses.std
    # An edge further out adds more to the logarithm of a small area: by one line for each device.
    tilts = [float(weights @ edge) for edge in edges_of(sound)]
    return Exponent(float(value), math.hypot(std, *tilts))


def items_of(rows: pd.DataFrame) -> Places:
    """Return a number for the contact, or the sequence, that each row is of."""
    return numbered(rows["sequence"].where(rows["sequence"].notna(), rows["observation"]))


def edges_of(rows: pd.DataFrame) -> list[FloatArray]:
    """Return what the edge of each device adds to the logarithm of each area."""
    curvature = 1 / rows["semi_major_mm"].to_numpy() + 1 / rows["semi_minor_mm"].to_numpy()
    added, device = rows["edge_offset_mm_std"].to_numpy() * curvature, numbered(rows["scale"])
    return [added * (device == each) for each in np.unique(device)]


def area_noise(rows: pd.DataFrame) -> FloatArray:
    """Return the relative standard uncertainty of the ellipse's area from errors of its own image."""
    major, minor = (
        rows[f"{axis}_mm_noise_std"].to_numpy() / rows[f"{axis}_mm"].to_numpy()
        for axis in ("semi_major", "semi_minor")
    )
    noise = rows["gross_area_mm2_noise_std"].to_numpy() / rows["gross_area_mm2"].to_numpy()
    return as_float_array(np.where(np.isfinite(noise), noise, np.hypot(major, minor)))
