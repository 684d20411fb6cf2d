"""The outline of a contact to a fraction of a pixel, its areas, and their uncertainty."""

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray, as_float32
from fingerpad.image._masks import UInt8, longest_contour
from fingerpad.image.contact_image._region import distance_to
from fingerpad.image.ellipse import AreaMoments, evenly_spaced, signed_area

_HALF_LEVEL = 127.5
# All lengths in ridge periods. The outline follows a ridge or not over this length.
_FOLLOWED = 3.0
_ENDS, _FOLLOWING, _NOISE = 0.084, 0.206, 0.192
# Standard deviation of the edge's place in a valley, and by how soft the picture is; neighbours share an
# error over `_STRETCH`.
_IN_VALLEY, _BY_SOFTNESS, _STRETCH = 0.16, 0.092, 2.75
# The interior lies deeper than `_DEEP`, the ground between the distances `_GROUND` outside. Ridges are what
# varies along the outline over less than `_ALONG`, without a `_TRIM`th of it at either end: inside, just
# outside, and beyond.
_DEEP, _GROUND, _ALONG, _TRIM = 3.5, (2.0, 3.0), 2.0, 5
_INSIDE, _OUTSIDE, _BEYOND = (-0.8, -0.2), (0.1, 0.3), (0.4, 0.7)
# How far the edge lies beyond the outline: for a sharp one, by the ridges just outside in parts of those
# inside, by those beyond in parts of the interior's contrast, and by how far the outline follows ridges.
# Means and variations are at least `_LEAST`.
_FADED, _BY_OUTSIDE, _BY_BEYOND, _BY_FOLLOWING, _LEAST = -0.32, 1.75, 3.9, -0.35, 0.03
# The standard deviation that the whole edge shares: its least, as a share of that shift, by the rim, and by
# how uneven the contrast within `_NEAR` outside is between `_SECTORS` of the outline; `_EVEN` is that of a
# sharp edge.
_EDGE_STD, _BY_FADE, _RIM_STD, _BY_UNEVENNESS = 0.1, 0.4, 0.7, 1.2
_NEAR, _SECTORS, _EVEN = 0.5, 24, 0.03
# By a share of it the edge varies independently of other images, alike over a share of its length; and by how
# the contrast at the distances `_RIM` differs between such stretches, as where the tips fade more slowly.
_VARIES, _ALIKE, _RIM, _BY_LACK = 0.7, 0.25, (-1.2, -0.4), 1.0
# A manual edge lies somewhere within one ridge period, uniformly: half of that variance it has everywhere
# alike, as a generous outline is generous all round.
_MANUAL = math.sqrt(1 / 12 / 2)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContactEdge:
    """An outline with what is known at each of its points, all in px of the working copy.

    Attributes
    ----------
    points : ndarray, (n, 2)
        (x, y), about evenly spaced, in order.
    normals : ndarray, (n, 2)
        Outward.
    steps : ndarray, (n,)
        Length of outline that each point stands for.
    along : ndarray, (n,)
        How far the outline follows one ridge (1) or crosses ridges (0), near each point: by how much the
        ridge amount 0.3 periods inside exceeds that 0.8 inside.
    period : float
        Ridge period.
    noise : float
        Standard deviation of the noise, in parts of the rise from valley to ridge.
    softness : float
        By what share the ridges' area would change if their level moved by the whole rise.
    resolved : bool
        Whether the period was seen in the picture, or is one that fingers usually have.
    manual : ndarray of bool, (n,)
        Where a person drew it.
    differs : ndarray, (n,)
        Standard deviation of how far the edge lies further out than elsewhere (or in, below 0), one for all
        points, by how the contrast inside differs from that along the rest of the outline.
    fade : float
        How far beyond the outline the edge lies because the contact fades towards it.
    rim : float
        By how much ridges stand out less at the outline than inside because a halo or a meniscus covers them,
        from 0 to 1; squared.
    unevenness : float
        Standard deviation along the outline of the contrast just outside it, in parts of the interior's; that
        of a sharp edge where it is not known.
    """

    points: FloatArray
    normals: FloatArray
    steps: FloatArray
    along: FloatArray
    period: float
    noise: float
    softness: float
    resolved: bool
    manual: BoolArray
    differs: FloatArray
    fade: float = 0.0
    rim: float = 0.0
    unevenness: float = _EVEN

    def moved(self, outward: FloatArray | float) -> FloatArray:
        """Return the points moved outward."""
        return np.asarray(self.points + self.normals * np.asarray(outward)[..., None])


def contact_outline(
    patch: BoolArray,
    closed: UInt8,
    amount: UInt8,
    period: float,
    *,
    noise: float,
    softness: float,
    resolved: bool,
) -> ContactEdge:
    """Find the outline of a patch where the closed ridge amount falls through half."""
    contour = longest_contour(patch).reshape(-1, 2).astype(np.float64)
    points = evenly_spaced(running_mean(contour, round(period / 2)))
    # Beyond the patch lie whiskers and other patches: they do not count.
    grown = cv2.dilate(patch.astype(np.uint8), np.ones((3, 3), np.uint8))
    field = as_float32(cv2.GaussianBlur(as_float32(cv2.copyTo(closed, grown)), (3, 3), 0))
    normals = outward_normals(points, period)
    for _ in range(3):
        value, slope = _profile(field, points, normals)
        off = np.clip((value - _HALF_LEVEL) / np.maximum(slope, 10.0), -1, 1)
        points = points + normals * off[:, None]
    points = evenly_spaced(running_mean(points, 2))
    normals = outward_normals(points, period)
    levels = as_float32(amount)
    outer, inner = (_sample(levels, points - normals * (depth * period)) for depth in (0.3, 0.8))
    along = running_mean((outer - inner)[:, None] / 255, round(_FOLLOWED * period))[:, 0]
    return ContactEdge(
        points=points,
        normals=normals,
        steps=point_spacings(points),
        along=along,
        period=period,
        noise=noise,
        softness=softness,
        resolved=resolved,
        manual=np.zeros(len(points), dtype=bool),
        differs=np.zeros(len(points)),
    )


def faded_outline(edge: ContactEdge, patch: BoolArray, contact: npt.NDArray[np.float32]) -> ContactEdge:
    """Return an outline with how far the edge of a fading contact lies beyond it, and how unevenly it fades.

    `contact` is the contrast of each place with the ground.

    Pressure falls to nothing at the edge, and with it the width of the ridges and, on many devices, their
    contrast. The outline at half the local contrast then lies inside the edge. How far, what still varies
    along it just outside shows: those are ridges, where a halo, a dark rim or stray light is smooth. How much
    the rim lacks of the interior's contrast says little: ridges that thin out slowly may end sharply.
    """
    parts = min(_SECTORS, len(edge.points))
    depth = distance_to(~patch)
    interior = contact[depth > min(_DEEP * edge.period, 0.6 * float(depth.max()))].mean()

    def around(start: float, end: float) -> FloatArray:
        """Return the contrast at some distances outward of each point of the outline, (n, distances)."""
        distances = np.linspace(start, end, 6) * edge.period
        return np.stack([_sample(contact, edge.moved(distance)) for distance in distances], axis=-1)

    def variation(values: FloatArray) -> float:
        """Return the mean variation along the outline without its extreme parts: dirt is in few of them."""
        varying = np.abs(values - running_mean(values, round(_ALONG * edge.period)))
        means = np.sort([part.mean() for part in np.array_split(varying, parts)])
        return float(means[parts // _TRIM : parts - parts // _TRIM].mean())

    ground = around(*_GROUND)
    plain, floor = float(ground.mean()), variation(ground)
    contrast = max(interior - plain, 1e-9)

    def ridges(values: FloatArray) -> tuple[float, float]:
        """Return the variation along the outline, little of it noise, and its ratio to the mean contrast."""
        above = max(variation(values) ** 2 - floor**2, 0.0)
        seen = above / max(math.hypot(math.sqrt(above), floor / 2), 1e-9) / contrast
        return seen, seen / max((float(values.mean()) - plain) / contrast, _LEAST)

    inside, outside, beyond = (ridges(around(*place)) for place in (_INSIDE, _OUTSIDE, _BEYOND))
    fade = _FADED + _BY_OUTSIDE * outside[0] / max(inside[0], _LEAST) + _BY_BEYOND * beyond[0]
    fade += _BY_FOLLOWING * float(np.average(edge.along, weights=edge.steps))
    rim = running_mean(around(*_RIM).mean(axis=1)[:, None], round(_ALIKE * len(edge.points)))[:, 0]
    near = np.array_split(around(0, _NEAR).mean(axis=1), parts)
    return replace(
        edge,
        differs=_BY_LACK * (rim.mean() - rim) / contrast * edge.period,
        fade=max(0.0, fade) * edge.period,
        rim=max(0.0, 1 - outside[1] / max(inside[1], _LEAST)) ** 2,
        unevenness=float(np.std([part.mean() for part in near]) / contrast),
    )


def point_spacings(points: FloatArray) -> FloatArray:
    """Return the length of a closed outline that each of its points stands for."""
    lengths = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    return np.asarray((lengths + np.roll(lengths, 1)) / 2)


def running_mean(values: FloatArray, width: int) -> FloatArray:
    """Return running means along a closed sequence."""
    width = min(max(1, width) | 1, len(values) | 1)
    total = np.cumsum(np.concatenate([values[-(width // 2 + 1) :], values, values[: width // 2]]), axis=0)
    return np.asarray((total[width:] - total[:-width]) / width)


def outward_normals(points: FloatArray, period: float) -> FloatArray:
    """Return the outward normals of an outline seen at the scale of a ridge period."""
    smooth = running_mean(points, round(period))
    tangent = np.roll(smooth, -2, axis=0) - np.roll(smooth, 2, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-9)
    return np.stack([tangent[:, 1], -tangent[:, 0]], axis=-1) * (1.0 if signed_area(smooth) > 0 else -1.0)


def _profile(
    field: npt.NDArray[np.float32], points: FloatArray, normals: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the level at points and its fall per px outward."""
    value = _sample(field, points)
    inner, outer = _sample(field, points - 0.7 * normals), _sample(field, points + 0.7 * normals)
    return value, (inner - outer) / 1.4


def _sample(field: npt.NDArray[np.float32], points: FloatArray) -> FloatArray:
    x, y = (np.ascontiguousarray(points[:, k], dtype=np.float32) for k in (0, 1))
    found = cv2.remap(field, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
    return np.asarray(found.ravel(), dtype=np.float64)


def edge_shift(edge: ContactEdge) -> FloatArray:
    """Return how far the true edge lies beyond the closed ridges on average, at each point, px.

    A contact that fades towards its edge reaches further than its outline. Where the outline crosses ridges
    it sags between their rounded ends. Where it follows a ridge, the edge lies at random on ridge or valley:
    in a valley of width vP, with probability v, it lies vP/2 further out,
    v²P/2 on average, 0.18 P to 0.25 P for the valleys of 0.6 to 0.7 P there, where ridges thin out. Noise
    moves the closed region outward. The three terms are fitted to rendered contacts (`edge_calibration` in
    benchmarks/contact_images.py prints them).
    """
    return _beyond_ridges(edge) - _NOISE * edge.noise * edge.period + edge.fade


def _beyond_ridges(edge: ContactEdge) -> FloatArray:
    return (_ENDS + _FOLLOWING * edge.along) * edge.period


def axis_weights(moments: AreaMoments, points: FloatArray) -> FloatArray:
    """Return the change of (semi_major, semi_minor, area) for a unit of area added at each point, (n, 3)."""
    place = (points - moments.centroid) @ moments.axes.T
    stretch = (place[:, 0] ** 2 / moments.spread[0] - place[:, 1] ** 2 / moments.spread[1]) / 4
    plain = 0.5 / moments.area
    major, minor = moments.semi_axes
    return np.stack([major * (plain + stretch), minor * (plain - stretch), np.ones(len(points))], axis=-1)


def edge_offset_std(edge: ContactEdge) -> float:
    """Return the standard uncertainty of the edge's place that all of the outline shares, px.

    It holds the definition of the edge of a contact that fades, a third of the correction for noise and,
    where no ridges are resolved, all of the shift for them. Other images of the same device share it too,
    and so does an edge that a person drew, who sees no more of it.
    """
    noise = _NOISE * edge.noise * edge.period / 3
    unknown = 0.0 if edge.resolved else float(np.average(_beyond_ridges(edge), weights=edge.steps))
    uneven = _BY_UNEVENNESS * edge.unevenness * edge.period
    rim = _RIM_STD * edge.rim * edge.period
    return math.hypot(_EDGE_STD * edge.period, _BY_FADE * edge.fade, rim, uneven, noise, unknown)


def outline_noise(edge: ContactEdge, weights: FloatArray) -> FloatArray:
    """Return the covariance of (semi_major, semi_minor, area) from errors of one image's outline.

    Each stretch of outline has an independent error: where it follows a ridge, that of an edge at random on
    valleys of half the period, √(v³/3 − v⁴/4) P = 0.16 P; everywhere that of the local level, which grows
    with the blur. The contribution of blur and the length of a stretch are fitted to the errors of rendered
    contacts (`accuracy_and_coverage` in benchmarks/contact_images.py). Besides, an edge that fades does not
    fade alike all round, nor in all images of one device: less so where the contrast inside differs as well.
    Where the edge was drawn manually, the error of drawing replaces these; half of its variance is shared by
    all that was drawn.
    """
    along = edge.along.clip(0, 1)
    own = edge.period * np.sqrt(along * _IN_VALLEY**2 + (_BY_SOFTNESS * edge.softness) ** 2)
    own = np.where(edge.manual, _MANUAL * edge.period, own)
    # Neighbours share their error over a stretch: a running mean spreads independent errors over it.
    response = weights * (edge.steps * own)[:, None]
    width = min(max(1, round(_STRETCH * edge.period)), len(response))
    spread = running_mean(response, width)
    varying = weights * (edge.steps * ~edge.manual * _VARIES * edge_offset_std(edge))[:, None]
    long = max(1, round(_ALIKE * len(varying)))
    varied = running_mean(varying, long)
    drawn = (weights * (edge.steps * edge.manual * _MANUAL * edge.period)[:, None]).sum(axis=0)
    uneven = weights.T @ (edge.steps * ~edge.manual * edge.differs)
    independent = spread.T @ spread * width + varied.T @ varied * long
    return np.asarray(independent + np.outer(uneven, uneven) + np.outer(drawn, drawn))
