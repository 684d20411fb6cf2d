"""Rendered sequences of a pad pressed and released: Hertz contact under given loads."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, check_all, positive_number
from fingerpad._display import Displayed
from fingerpad.contact import Tissue, hertz_contact
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Paraboloid
from fingerpad.simulate.contact_image import Look, render_contact_image
from fingerpad.units import MM_PER_INCH

# Lighter contacts than this are a background without a finger, mm.
_MIN_SEMI_AXIS = 0.05


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SyntheticSequence(Displayed):
    """A sequence to be rendered frame by frame; the contact's major axis points straight up."""

    load: FloatArray  # (count,); true normal force, N
    semi_major: FloatArray  # (count,); mm
    semi_minor: FloatArray  # (count,)
    ppi: float
    look: Look
    flicker: float  # standard deviation of the light from frame to frame, relative
    noise_std: float  # of the camera, grey levels
    seed: int

    @property
    def gross_area(self) -> FloatArray:
        """True area inside the contact ellipse of each frame, mm²."""
        return np.pi * self.semi_major * self.semi_minor

    def pixels(self, index: int) -> npt.NDArray[np.uint8]:
        """Render one frame as grey levels; all have one size, and the contact in the middle."""
        major, minor = float(self.semi_major[index]), float(self.semi_minor[index])
        if minor < _MIN_SEMI_AXIS:
            major = minor = _MIN_SEMI_AXIS / 10
        margin = 1.5 + float(self.semi_major.max()) - major
        rendered = render_contact_image(
            semi_major=major,
            semi_minor=minor,
            ppi=self.ppi,
            look=self.look,
            noise_std=0.0,
            margin=margin,
            seed=self.seed,
        ).pixels
        rng = np.random.default_rng([self.seed, index])
        light = 1 + self.flicker * rng.normal()
        columns = math.floor(2 * (float(self.semi_minor.max()) + 1.5) * self.ppi / MM_PER_INCH) - 1
        start = (rendered.shape[1] - columns) // 2
        middle = rendered[:, start : start + columns]
        exposed = light * middle + rng.normal(0, self.noise_std, middle.shape)
        return np.clip(np.rint(exposed), 0, 255).astype(np.uint8)


def render_sequence(
    load: ArrayLike,
    *,
    radii: tuple[float, float] = (20.0, 14.0),
    reduced_modulus: float = 0.05,
    ppi: float = 300.0,
    look: Look = "livescan",
    flicker: float = 0.0,
    noise_std: float = 6.0,
    seed: int = 0,
) -> SyntheticSequence:
    """Press an elastic pad with a load for each frame: Hertz contact, rendered.

    Parameters
    ----------
    load : array_like, shape (count,)
        Normal force W, N; zero is no contact.
    radii : (float, float)
        Relative principal radii of the undeformed pad along and across the finger, mm, the larger first.
    reduced_modulus : float
        E*, MPa.
    ppi, look, flicker, noise_std, seed
        See `SyntheticSequence`.

    Returns
    -------
    SyntheticSequence
        Frames are rendered when asked for.

    Raises
    ------
    GeometryError
        If a load is negative or not finite, the resolution is not positive, or the radii are swapped.

    Examples
    --------
    >>> press = render_sequence([0.0, 0.5, 1.0], seed=2)
    >>> press.gross_area.round(1).tolist()
    [0.0, 78.5, 124.6]
    """
    load = as_float_array(load)
    check_all(np.isfinite(load) & (load >= 0), "load", load, "zero or positive, and finite", GeometryError)
    positive_number(ppi, "ppi", GeometryError)
    if radii[1] > radii[0]:
        raise GeometryError(f"the larger radius comes first, found {radii}")
    contact = hertz_contact(Paraboloid(*radii), Tissue.of_reduced_modulus(reduced_modulus), load=load)
    return SyntheticSequence(
        load=load,
        semi_major=contact.semi_major,
        semi_minor=contact.semi_minor,
        ppi=ppi,
        look=look,
        flicker=flicker,
        noise_std=noise_std,
        seed=seed,
    )
