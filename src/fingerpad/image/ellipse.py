"""Ellipses in images, and the areas and second moments of regions.

There are two descriptions. `ImageEllipse` is for users: centre (row, column), sorted semi-axes, and the
orientation of the major axis from straight up, counter-clockwise as seen on the screen, in (−π/2, π/2].
`PlaneEllipse` is for fits to points (x, y): unsorted semi-axes along and across an angle from x towards y.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from fingerpad._arrays import (
    ArrayLike,
    BoolArray,
    FloatArray,
    IndexArray,
    as_float_array,
    finite_angle,
    finite_number,
    finite_pair,
    positive_number,
    set_fields,
)
from fingerpad.exceptions import GeometryError, ImageError


@dataclass(frozen=True, slots=True, kw_only=True)
class ImageEllipse:
    """An ellipse in an image.

    Attributes
    ----------
    centre : (float, float)
        (row, column), px; pixel centres are whole numbers.
    semi_axes : (float, float)
        Major and minor, px.
    orientation : float
        Angle of the major axis from straight up, counter-clockwise as seen on the screen, radians.

    Raises
    ------
    ImageError
        If the centre is not finite, or the semi-axes are not positive, finite and the larger first.
    GeometryError
        If the orientation is not finite or beyond a full turn, as degrees are.

    Examples
    --------
    >>> ellipse = ImageEllipse(centre=(100.0, 80.0), semi_axes=(40.0, 30.0))
    >>> ellipse.points(4).round(6).tolist()
    [[140.0, 80.0], [100.0, 110.0], [60.0, 80.0], [100.0, 50.0]]
    """

    centre: tuple[float, float]
    semi_axes: tuple[float, float]
    orientation: float = 0.0

    def __post_init__(self) -> None:
        centre = finite_pair(self.centre, "centre", ImageError)
        major, minor = finite_pair(self.semi_axes, "semi_axes", ImageError)
        if not major >= minor > 0:
            raise ImageError(f"semi_axes must be positive and the larger first, found {self.semi_axes}")
        orientation = finite_angle("orientation", self.orientation)
        set_fields(self, centre=centre, semi_axes=(major, minor), orientation=orientation)

    @property
    def area(self) -> float:
        """Area, px²."""
        return math.pi * self.semi_axes[0] * self.semi_axes[1]

    def points(self, count: int) -> FloatArray:
        """Return points on the ellipse, evenly spaced in the parametric angle.

        Parameters
        ----------
        count : int
            Number of points.

        Returns
        -------
        ndarray, shape (count, 2)
            (row, column), px.
        """
        t = np.linspace(0, 2 * math.pi, count, endpoint=False)
        local = np.stack([np.cos(t), np.sin(t)], axis=-1) * self.semi_axes
        return np.asarray(local @ rotation(self.orientation).T + self.centre)


def interpolated_ellipse(first: ImageEllipse, second: ImageEllipse, share: float) -> ImageEllipse:
    """Return the ellipse at a share of the way from one to another.

    Its centre, and the symmetric matrix that stretches the unit circle into it, change linearly: so do the
    semi-axes where the orientation stays, and what is nearly a circle does not turn.
    """
    stretch = sum(
        weight * rotation(one.orientation) @ np.diag(one.semi_axes) @ rotation(one.orientation).T
        for weight, one in ((1 - share, first), (share, second))
    )
    lengths, directions = np.linalg.eigh(stretch)
    row, column = directions[:, 1]
    centre = (1 - share) * as_float_array(first.centre) + share * as_float_array(second.centre)
    return ImageEllipse(
        centre=(float(centre[0]), float(centre[1])),
        semi_axes=(float(lengths[1]), float(lengths[0])),
        orientation=half_turn(math.atan2(column, row)),
    )


@dataclass(frozen=True, slots=True)
class PlaneEllipse:
    """An ellipse in the plane (x, y), its semi-axes not sorted."""

    x: float
    y: float
    semi_x: float  # along `angle`
    semi_y: float
    angle: float = 0.0  # turn from x towards y, radians

    def __post_init__(self) -> None:
        set_fields(
            self,
            x=finite_number(self.x, "x", GeometryError),
            y=finite_number(self.y, "y", GeometryError),
            semi_x=positive_number(self.semi_x, "semi_x", GeometryError),
            semi_y=positive_number(self.semi_y, "semi_y", GeometryError),
            angle=finite_angle("angle", self.angle),
        )

    @property
    def parameters(self) -> FloatArray:
        """The numbers that a fit finds: (x, y, semi_x, semi_y, angle)."""
        return np.array([self.x, self.y, self.semi_x, self.semi_y, self.angle])

    @property
    def semi_axes(self) -> FloatArray:
        """(semi_x, semi_y)."""
        return np.array([self.semi_x, self.semi_y])

    @property
    def size(self) -> float:
        """Geometric mean of the semi-axes."""
        return math.sqrt(self.semi_x * self.semi_y)

    def scaled(self, factor: float) -> Self:
        """Return a concentric ellipse, its semi-axes times a factor."""
        return replace(self, semi_x=self.semi_x * factor, semi_y=self.semi_y * factor)

    def offsets(self, points: FloatArray) -> FloatArray:
        """Return the signed distances of points (x, y) from the ellipse, to first order, positive outside."""
        u, v = ((points - (self.x, self.y)) @ rotation(self.angle) / self.semi_axes).T
        radius = np.hypot(u, v) + 1e-12
        return as_float_array((radius - 1) * radius / (np.hypot(u / self.semi_x, v / self.semi_y) + 1e-12))

    def points(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return points (x, y) evenly spaced in the parametric angle, and the outward unit normals there."""
        t = np.arange(count) * (2 * math.pi / count)
        turn = rotation(self.angle).T
        local = np.stack([self.semi_x * np.cos(t), self.semi_y * np.sin(t)], axis=-1)
        normal = np.stack([np.cos(t) / self.semi_x, np.sin(t) / self.semi_y], axis=-1)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        return as_float_array(local @ turn + (self.x, self.y)), as_float_array(normal @ turn)


def rotation(angle: float) -> FloatArray:
    """Return the matrix that turns column vectors from the first axis towards the second."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def half_turn(angle: float) -> float:
    """Return the direction of an axis in (−π/2, π/2]."""
    turned = math.pi / 2 - (math.pi / 2 - angle) % math.pi
    return turned if turned > -math.pi / 2 else math.pi / 2  # a remainder may round to the whole half turn


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AreaMoments:
    """Area, centroid (x, y) and second moments of a region."""

    area: float
    centroid: FloatArray
    axes: FloatArray  # (2, 2); directions of the major and the minor axis as rows
    spread: FloatArray  # (2,); second moments of the area along them, about the centroid

    @property
    def semi_axes(self) -> FloatArray:
        """Semi-axes of the ellipse of the same area and the same ratio of second moments."""
        mean, ratio = math.sqrt(self.area / math.pi), (self.spread[0] / self.spread[1]) ** 0.25
        return np.array([mean * ratio, mean / ratio])

    @property
    def orientation(self) -> float:
        """Angle of the major axis from straight up, counter-clockwise as seen, in (−π/2, π/2]."""
        return half_turn(math.atan2(*self.axes[0]))

    @property
    def ellipse(self) -> ImageEllipse:
        """Ellipse of the same area and centroid, with the axis ratio and direction of the second moments."""
        (x, y), (major, minor) = map(float, self.centroid), map(float, self.semi_axes)
        return ImageEllipse(centre=(y, x), semi_axes=(major, minor), orientation=self.orientation)

    def overlap(self, outline: FloatArray) -> float:
        """Return the intersection over union of the outline (x, y) of this region and its ellipse.

        In units of the semi-axes that is a unit disk: rays from its centre end at the outline or at 1.
        """
        place = ((outline - self.centroid) @ self.axes.T / self.semi_axes) @ [1, 1j]
        turn = np.angle(shifted(place, 1) * place.conj())
        squares = np.minimum(np.abs(place) ** 2, 1)
        both = abs(float((squares + shifted(squares, 1)) @ turn)) / 4
        return both / (2 * math.pi - both)


def evenly_spaced(
    points: FloatArray, spacing: float = 1.0, *, closed: bool = True, min_count: int = 16
) -> FloatArray:
    """Return points along an outline, about `spacing` apart."""
    path = points @ [1, 1j]
    path = np.append(path, path[0]) if closed else path
    along = np.append(0.0, np.cumsum(np.abs(path[1:] - path[:-1])))
    count = max(min_count, round(along[-1] / spacing))
    places = np.interp(np.linspace(0, along[-1], count, endpoint=not closed), along, path)
    return np.asarray(places.view(np.float64).reshape(-1, 2))


def runs(mask: BoolArray, *, closed: bool = True) -> list[IndexArray]:
    """Return the indices of each run of an outline's points for which a mask holds."""
    # A closed outline is turned to begin outside, so that none is cut in two.
    order = np.roll(np.arange(len(mask)), -int(np.argmin(mask)) if closed else 0)
    pieces = np.split(order, np.flatnonzero(np.diff(mask[order])) + 1)
    return [piece for piece in pieces if mask[piece[0]]]


def nearest_on_sides(points: FloatArray, starts: FloatArray, ends: FloatArray) -> FloatArray:
    """Return the place nearest to each point on its side from a start to an end; shapes broadcast."""
    along = ends - starts
    share = ((points - starts) * along).sum(axis=-1) / np.maximum((along**2).sum(axis=-1), 1e-12)
    return np.asarray(starts + share.clip(0, 1)[..., None] * along)


def signed_area(points: FloatArray) -> float:
    """Return the area of a closed polygon (x, y), positive if it turns from x towards y."""
    following = shifted(points, 1)
    return float(points[:, 0] @ following[:, 1] - following[:, 0] @ points[:, 1]) / 2


def shifted(points: FloatArray, step: int) -> FloatArray:
    """Return for each point of a closed outline the one so many steps further on."""
    return np.concatenate([points[step:], points[:step]])


def outward_normals(points: FloatArray, step: int = 1, *, closed: bool = True) -> FloatArray:
    """Return the outward unit normals of an outline, across the chord of so many steps to either side."""
    around = shifted(points, step) - shifted(points, -step)
    tangent = around if closed else np.gradient(points, step, axis=0)
    outward = np.stack([tangent[:, 1], -tangent[:, 0]], axis=-1)
    length = np.maximum(np.hypot(*tangent.T), 1e-9)
    return np.asarray(outward * (math.copysign(1.0, signed_area(points)) / length)[:, None])


def polygon_moments(points: FloatArray) -> AreaMoments:
    """Return the moments of a closed polygon (x, y), in either direction (Green's theorem)."""
    # As complex numbers x + iy, whose squares hold xx − yy and xy, and squared lengths xx + yy.
    corners = points @ [1, 1j]
    origin = corners.mean()
    p = corners - origin
    q = shifted(p, 1)
    product = p.conj() * q
    area = float(product.imag.sum()) / 2
    weights = product.imag / (12 * area)
    centroid = complex(weights @ (p + q)) * 2
    difference = complex(weights @ (p * p + p * q + q * q)) - centroid**2
    total = float(weights @ (np.abs(p) ** 2 + product.real + np.abs(q) ** 2)) - abs(centroid) ** 2
    minor = cmath.exp(cmath.phase(0 - difference) / 2 * 1j)
    place = centroid + origin
    return AreaMoments(
        area=abs(area),
        centroid=np.array([place.real, place.imag]),
        axes=np.array([[-minor.imag, minor.real], [minor.real, minor.imag]]),
        spread=np.array([total + abs(difference), total - abs(difference)]) * (abs(area) / 2),
    )


def ellipse_of_polygon(corners: ArrayLike) -> ImageEllipse:
    """Return a polygon's ellipse: its area and centroid, ratio and direction of its second moments.

    Corners are (row, column), in order, open or closed, in either direction.
    """
    points = as_float_array(corners, "corners", ImageError)
    if points.ndim != 2 or points.shape[-1] != 2 or len(points) < 3 or not np.isfinite(points).all():
        raise ImageError(f"an outline needs three corners or more, all finite; found shape {points.shape}")
    if not abs(signed_area(points - points.mean(axis=0))) > 1e-9 * np.ptp(points, axis=0).max() ** 2:
        raise ImageError("the outline encloses no area: trace round the contact")
    moments = polygon_moments(points[:, ::-1])
    if not (moments.spread > 0).all():
        raise ImageError("the outline crosses itself: trace once round the contact")
    return moments.ellipse
