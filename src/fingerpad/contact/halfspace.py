"""The true ellipsoid on an elastic half-space: how far Hertz theory is out on a finger pad.

Hertz theory replaces the gap between pad and platen by its paraboloid, which holds while the contact is small
beside the radii of curvature. Here the gap is that of the whole ellipsoid, and the elastic half-space is
solved on a grid (Polonsky and Keer's conjugate gradients, by Tamaas). What is left of Hertz theory is the
half-space itself: the pad is neither thick nor flat, and this says nothing of that.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from fingerpad._arrays import BoolArray, FloatArray, check_all
from fingerpad.contact.hertz import HertzContact, HertzGeometry
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, platen_normal
from fingerpad.geometry.ellipsoid import tangents

_WIDTH = 1.3  # of the grid over the Hertz contact; the true contact is the smaller one
_TOLERANCE = 1e-8


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HalfSpaceContact:
    """The contact of a whole ellipsoid with a plate, on an elastic half-space.

    Attributes
    ----------
    hertz : HertzContact
        Hertz theory for the same pad, placement, load and modulus.
    semi_major, semi_minor : float
        Semi-axes of the contact, of its area and second moments.
    indentation : float
        Mutual approach ξ.
    peak_pressure : float
        Highest pressure.
    """

    hertz: HertzContact
    semi_major: float
    semi_minor: float
    indentation: float
    peak_pressure: float

    @property
    def area(self) -> float:
        """Contact area."""
        return float(np.pi * self.semi_major * self.semi_minor)

    @property
    def modulus_disagreement(self) -> float:
        r"""E* that Hertz theory would read from the area, over that from the indentation.

        :math:`(A_H/A)^{3/2} / (\xi_H/\xi)^{3/2}`, A_H and ξ_H being Hertz theory's: one where it holds.
        """
        area, indentation = (
            self.area / float(self.hertz.area),
            self.indentation / float(self.hertz.indentation),
        )
        return float((indentation / area) ** 1.5)

    @classmethod
    def of(
        cls,
        pad: Ellipsoid,
        *,
        wedge_angle: float,
        roll_angle: float = 0.0,
        load: float,
        reduced_modulus: float,
        points: int = 128,
    ) -> Self:
        """Press an ellipsoid against a plate.

        Parameters
        ----------
        pad : Ellipsoid
            One pad.
        wedge_angle, roll_angle : float
            Placement, radians.
        load, reduced_modulus : float
            Normal force W and E*.
        points : int
            Grid points along each side; the error of area and indentation falls with it, 0.5 % at 128.

        Raises
        ------
        GeometryError
            If load or modulus is not positive and finite, or the pad would be flattened to its silhouette.
        ModuleNotFoundError
            If Tamaas is not installed: ``pip install 'fingerpad[halfspace]'``.

        Examples
        --------
        The source's pad at 2 N: the true ellipsoid curves away from the plate faster than its paraboloid.

        >>> import numpy as np
        >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
        >>> contact = HalfSpaceContact.of(
        ...     pad, wedge_angle=np.radians(30), load=2.0, reduced_modulus=0.1365, points=64
        ... )
        >>> print(f"area {contact.area / float(contact.hertz.area) - 1:+.0%}")
        area -4%
        """
        for name, value in (("load", load), ("reduced_modulus", reduced_modulus)):
            check_all(np.isfinite(value) and value > 0, name, value, "positive and finite", GeometryError)
        normal = platen_normal(wedge_angle, roll_angle)
        radii = pad.principal_radii_at_normal(normal)
        hertz = HertzGeometry(radii[0], radii[1]).under_load(load, reduced_modulus=reduced_modulus)
        width = 2 * _WIDTH * float(hertz.semi_major)
        spacing = width / points
        along = (np.arange(points) + 0.5) * spacing - width / 2
        gap = ellipsoid_gap(pad, normal, *np.meshgrid(along, along, indexing="ij"))
        pressure, indentation = _solve(gap, width, load, reduced_modulus)
        touching = pressure > 0
        at_silhouette = np.isnan(np.gradient(gap)).any(axis=0)
        if touching[[0, -1]].any() or touching[:, [0, -1]].any() or (touching & at_silhouette).any():
            raise GeometryError(
                f"a load of {load:g} would flatten the pad to its silhouette: check load and modulus"
            )
        semi_major, semi_minor = _semi_axes(touching, spacing)
        return cls(
            hertz=hertz,
            semi_major=semi_major,
            semi_minor=semi_minor,
            indentation=indentation,
            peak_pressure=float(pressure.max()),
        )


def ellipsoid_gap(pad: Ellipsoid, normal: FloatArray, along: FloatArray, across: FloatArray) -> FloatArray:
    """Return the gap between a pad and the plate that touches it, NaN beyond the pad's silhouette.

    Parameters
    ----------
    pad : Ellipsoid
        One pad.
    normal : ndarray, shape (3,)
        Its outward normal at the place of contact.
    along, across : ndarray
        Coordinates in the plate, along and across the finger, from the place of contact.

    Examples
    --------
    >>> import numpy as np
    >>> ball = Ellipsoid(10.0, 10.0, 10.0)
    >>> ellipsoid_gap(ball, np.array([1.0, 0.0, 0.0]), np.array(6.0), np.array(0.0)).round(12)
    np.float64(2.0)
    """
    first, second = tangents(normal)
    start = pad.contact_point(normal) + along[..., None] * first + across[..., None] * second
    # |(start − g n)/ℓ|² = 1, of which the smaller root g is the near side of the pad.
    quadratic = np.sum((normal / pad.semi_axes) ** 2)
    half_linear = np.sum(start * normal / pad.semi_axes**2, axis=-1)
    constant = np.sum((start / pad.semi_axes) ** 2, axis=-1) - 1
    with np.errstate(invalid="ignore"):
        root = np.sqrt(half_linear**2 - quadratic * constant)
    gap: FloatArray = constant / (half_linear + root)
    return gap


def _solve(gap: FloatArray, width: float, load: float, modulus: float) -> tuple[FloatArray, float]:
    """Return the pressure on the grid, and the approach."""
    import tamaas

    tamaas.set_log_level(tamaas.LogLevel.error)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [width] * 2, list(gap.shape))
    model.E, model.nu = modulus, 0.0
    tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
    height = np.where(np.isnan(gap), 10 * width, gap)
    solver = tamaas.PolonskyKeerRey(model, -height, _TOLERANCE)
    solver.setIntegralOperator("dcfft")
    solver.solve(load / width**2)
    pressure = np.array(model.traction)
    displacement = np.zeros_like(pressure)  # the solver's own is relative to the plate
    model.operators["dcfft"](pressure, displacement)
    touching = pressure > 0
    return pressure, float(np.mean((displacement + height)[touching]))


def _semi_axes(touching: BoolArray, spacing: float) -> tuple[float, float]:
    """Return the semi-axes of an ellipse with the area and the ratio of second moments of a region."""
    places = np.argwhere(touching)
    spread = np.sqrt(np.linalg.eigvalsh(np.cov(places.T)))
    mean = spacing * np.sqrt(len(places) / np.pi)
    ratio = np.sqrt(spread[1] / spread[0])
    return float(mean * ratio), float(mean / ratio)
