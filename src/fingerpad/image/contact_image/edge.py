"""The edge of a contact: where ridges end, how far beyond them the contact does, how certain that is."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt
from scipy.ndimage import uniform_filter1d

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32
from fingerpad.exceptions import ImageError
from fingerpad.image._masks import UInt8, distance_to, longest_contour
from fingerpad.image.contact_image.background import quantile
from fingerpad.image.contact_image.calibration import EDGE, Band
from fingerpad.image.contact_image.region import Region
from fingerpad.image.contact_image.ridges import Ridges
from fingerpad.image.contact_image.view import View
from fingerpad.image.ellipse import AreaMoments, evenly_spaced, outward_normals, shifted, signed_area

_MOSTLY: Final = 0.45  # share of an outline without ridges beyond which it may be that of something else
_MOST_FADE: Final = 2.0  # ridge periods over which contacts fade at most
_NO_EDGE: Final = (
    "no contact found: the largest patch of ridges does not stand out from what lies around it: give "
    "dark_on_light, or a region of interest"
)
_HALF_LEVEL: Final = 127.5
_LITTLE: Final = 25.5  # amounts of ridge, of 255, are taken for no less
_ACROSS: Final = np.linspace(0.042, 0.958, 4)[:, None]  # of a band's width; samples, as far apart as six
# A manual edge lies somewhere within one ridge period, uniformly: half of that variance it has everywhere
# alike, as a generous outline is generous all round.
_MANUAL: Final = math.sqrt(1 / 12 / 2)
_DRAWN_ALIKE: Final = 2.75  # ridge periods; the other half is the same over this length


class FadeSigns(NamedTuple):
    """What shows how a contact with ridges ends."""

    thinning: float = 0.0  # how much less ridge the last period inside has than the one before, as a part
    outside: float = 0.0  # how much ridges vary along the outline just outside it, in parts of that inside
    beyond: float = 0.0  # the same further out, in parts of the interior's contrast
    paleness: float = 0.0  # how much less contrast than usual the last period inside has, in the same parts
    cover: float = 0.0  # how much less ridges stand out just outside than inside, as under a halo, 0 to 1
    rim: float = 0.0  # the same where it ends within a period, as a rim does and a halo does not
    unevenness: float = 0.0  # standard deviation of the contrast just outside, in parts of the interior's
    steepness: float = 0.0  # by how much more than usual the last period thins, as a part
    bare: float = 0.0  # share of the outline along which there are no ridges, or much fainter ones

    @property
    def mostly_bare(self) -> bool:
        """Whether a halo, a window's border or fainter ridges may have been taken for the contact's edge."""
        return self.bare > _MOSTLY


_NO_SIGNS: Final = FadeSigns()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Edge:
    """An outline with what is known at each of its points, all in px of the copy."""

    points: FloatArray  # (n, 2); (x, y), about evenly spaced, in order
    normals: FloatArray  # (n, 2); outward
    steps: FloatArray  # (n,); length of outline that each point stands for
    period: float  # ridge period
    resolved: bool  # whether the period was seen in the picture, or is one that fingers usually have
    manual: BoolArray  # (n,); where a person drew it
    # (n,); Standard deviation of how far the edge lies further out than elsewhere (or in, below 0), one for
    # all points, by how the contrast inside differs from that along the rest of the outline
    differs: FloatArray
    # Standard uncertainty of the edge's place all round, which other images of the device share, and so does
    # an edge that a person drew, who sees no more of it
    offset_std: float
    varying_std: float  # that by which it varies round the outline, where it was not drawn manually
    fade: float = 0.0  # how far further out the edge of a contact that fades lies; below 0 where it is sharp
    signs: FadeSigns = _NO_SIGNS
    doubts: frozenset[str] = frozenset()  # flags of this edge

    def moved(self, outward: FloatArray | float) -> FloatArray:
        """Return the points moved outward."""
        return np.asarray(self.points + self.normals * np.asarray(outward)[..., None])


def even_edge(points: FloatArray, view: View, *, drawn: bool = False) -> Edge:
    """Return an edge (x, y) of the copy that is alike all round, found automatically or drawn manually."""
    offset_std = EDGE.shared_std * view.period
    return Edge(
        points=points,
        normals=smooth_normals(points, view.period),
        steps=point_spacings(points),
        period=view.period,
        resolved=drawn or view.resolved,
        manual=np.full(len(points), drawn),
        differs=np.zeros(len(points)),
        offset_std=offset_std,
        varying_std=EDGE.varies * offset_std,
    )


def trace_edge(view: View, ridges: Ridges, region: Region) -> Edge:
    """Trace a region to a fraction of a pixel, and move the outline to where the contact ends."""
    edge = _outline(view, ridges, region.patch)
    # A given level says what counts as contact; without ridges nothing tells fading from blur.
    if view.resolved and ridges.threshold is None:
        signs, lack = fade_signs(edge, view.contact, ridges.amount, region.patch)
        shift = sum(getattr(EDGE, f"by_{name}") * value for name, value in telling(signs).items())
        fade = (EDGE.sharp + float(shift)) * edge.period
        edge = replace(edge, signs=signs, differs=EDGE.lack_std * lack * edge.period, fade=fade)
    if edge.fade > _MOST_FADE * edge.period:
        raise ImageError(_NO_EDGE)
    # The outline sags between the rounded ends of ridges that it crosses, and the edge may lie in a valley
    # beyond a ridge that it follows. Without resolved ridges there may be such ends or none: half of it.
    beyond = EDGE.ends * edge.period * (1.0 if edge.resolved else 0.5) + edge.fade
    offset_std = _offset_std(edge)
    rows, columns = region.patch.shape
    return replace(
        edge,
        points=edge.moved(beyond).clip(-0.5, [columns - 0.5, rows - 0.5]),
        offset_std=offset_std,
        varying_std=EDGE.varies * offset_std,
    )


def _outline(view: View, ridges: Ridges, patch: BoolArray) -> Edge:
    """Return the outline of a patch where the closed ridges fall through half."""
    period = view.period
    contour = longest_contour(patch).reshape(-1, 2).astype(np.float64)
    points = evenly_spaced(running_mean(contour, round(period / 2)))
    normals = smooth_normals(points, period)
    # Beyond the patch lie whiskers and other patches: they do not count.
    grown = cv2.dilate(patch.astype(np.uint8), np.ones((3, 3), np.uint8))
    field = as_float32(cv2.GaussianBlur(as_float32(cv2.copyTo(ridges.closed, grown)), (3, 3), 0))
    for _ in range(2):
        value, inner, outer = profiles(field, points, normals, (0.0, -0.7, 0.7))
        slope = (inner - outer) / 1.4
        off = ((value - _HALF_LEVEL) / np.maximum(slope, 10.0)).clip(-1, 1)
        points = points + normals * off[:, None]
    return even_edge(evenly_spaced(running_mean(points, 2)), view)


def fade_signs(
    edge: Edge, contact: Float32Array, amount: UInt8, patch: BoolArray
) -> tuple[FadeSigns, FloatArray]:
    """Return what shows how a contact ends at an outline of its closed ridges.

    And how much less the contrast inside each point is than elsewhere, in parts of the interior's.
    """
    # A quarter of the pixels shows the interior.
    depth = 2 * distance_to(~patch[::2, ::2])
    deep = depth > min(EDGE.interior_depth * edge.period, 0.6 * float(depth.max()))
    few = np.ascontiguousarray(contact[::2, ::2])
    interior = few[deep].mean()
    ground, inside, outside, beyond, off, rim, near = _across(
        contact, edge, EDGE.ground, EDGE.inside, EDGE.outside, EDGE.beyond, EDGE.off, EDGE.rim, EDGE.near
    )
    plain = float(ground.mean())
    contrast = np.float32(interior - plain)
    if not contrast > 0:
        raise ImageError(_NO_EDGE)
    # The variation along the outline that is not noise: inside and just outside by squares, whose noise adds
    # up, also in parts of the mean contrast; beyond by sizes, which few specks and fibres hardly change.
    (noise, *squares), (floor, *_, far) = _variations([ground, inside, outside, beyond], edge.period)
    within, without = np.sqrt(np.maximum(np.array(squares[:2]) - noise, 0.0)) / contrast
    means = np.maximum([(band.mean() - plain) / contrast for band in (inside, outside, off)], EDGE.least)
    cover = max(1 - float(without / means[1] / max(within / means[0], EDGE.least)), 0.0)
    floor, far = floor / contrast, far / contrast
    above = max(far**2 - floor**2, 0.0)
    ridged = _across(as_float32(amount), edge, EDGE.inside, EDGE.deeper)
    last, before = ridged.mean(axis=(1, 2)).tolist()
    thinning = 1 - last / max(before, _LITTLE)
    side = round(edge.period) | 1
    varies = _deviations(few, lambda values: cv2.blur(values, (side, side)))[deep]
    along = _deviations(rim.T, lambda values: running_mean(values.mean(axis=1), round(1.5 * edge.period)))
    rim = running_mean(rim.mean(axis=0), round(EDGE.alike * len(edge.points)))
    signs = FadeSigns(
        thinning=thinning,
        outside=float(without / max(within, EDGE.least)),
        beyond=above / max(math.hypot(math.sqrt(above), floor / 2), 1e-9),
        paleness=max(EDGE.least_usual - float(means[0]), 0.0),
        cover=cover,
        rim=cover * max(1 - 3 * float(means[2] / means[1]), 0.0),
        unevenness=float(np.std(_sector_means(near.mean(axis=0))) / contrast),
        steepness=max(thinning - EDGE.usual_thinning, 0.0),
        bare=float(np.mean(along < EDGE.bare * quantile(varies, 0.75))),
    )
    return signs, np.asarray((rim.mean() - rim) / contrast, dtype=np.float64)


def telling(signs: FadeSigns) -> dict[str, float]:
    """Return what of each sign tells how far the edge lies beyond its outline; `EDGE` says by how much.

    Pressure falls to nothing at the edge, and with it the width of the ridges and often their contrast. Blur
    shows ridges just outside that end at a sharp edge, or whose width falls as a root of the distance to it,
    within a tenth of a mm. More of them tell no more, unless ridges are seen beyond too. Where pressure falls
    off slowly, as that of a bell, ridges get too thin to be seen long before the contact ends, and the last
    period thins more than usual, or is pale. A dark rim reaches beyond the contact.
    """
    beyond = max(signs.beyond - EDGE.hardly, 0.0)
    return {
        "thinning": signs.thinning,
        "outside": min(signs.outside, EDGE.by_blur + EDGE.by_blur_and_beyond * beyond),
        "beyond": beyond,
        "paleness": signs.paleness,
        "rim": signs.rim,
        "steepness": signs.steepness,
    }


def _deviations(values: npt.NDArray[Any], means: Callable[[Any], npt.NDArray[Any]]) -> npt.NDArray[Any]:
    """Return the standard deviation of values about their local means."""
    return np.asarray(np.sqrt(np.maximum(means(values * values) - means(values) ** 2, 0)))


def _across(field: Float32Array, edge: Edge, *bands: Band) -> Float32Array:
    """Return the levels in bands along an outline, (bands, across, along)."""
    low, high = np.array(bands).T
    distances = low + _ACROSS * (high - low)
    levels = profiles(field, edge.points, edge.normals, distances.T.ravel() * edge.period)
    return levels.reshape(len(bands), len(_ACROSS), -1)


def _variations(bands: list[FloatArray], period: float) -> FloatArray:
    """Return the mean square and the mean size of the variation of bands along the outline, (2, bands).

    Extreme sectors do not count: dirt is in few.
    """
    values = np.concatenate(bands).T
    size = np.abs(values - running_mean(values, round(EDGE.along * period)))
    varying = np.stack([size * size, size], axis=1).reshape(len(values), 2, len(bands), -1).mean(axis=3)
    means = np.sort(_sector_means(varying), axis=0)
    few = int(EDGE.trimmed * len(means))
    return np.asarray(means[few : len(means) - few].mean(axis=0))


def _sector_means(values: FloatArray) -> FloatArray:
    """Return means over equal parts of an outline."""
    # As `np.array_split` parts them; one call, since a hundred of means cost more than all they add up.
    count = min(EDGE.sectors, len(values))
    size, longer = divmod(len(values), count)
    lengths = np.repeat([size + 1, size], [longer, count - longer])
    starts = np.append(0, np.cumsum(lengths[:-1]))
    return np.asarray((np.add.reduceat(values, starts, axis=0).T / lengths).T)


def point_spacings(points: FloatArray) -> FloatArray:
    """Return the length of a closed outline that each of its points stands for."""
    lengths = np.hypot(*(shifted(points, 1) - points).T)
    return np.asarray((lengths + shifted(lengths, -1)) / 2)


def running_mean(values: FloatArray, width: int) -> FloatArray:
    """Return running means along a closed sequence."""
    width = min(max(1, width) | 1, len(values) | 1)
    return np.asarray(uniform_filter1d(values, width, axis=0, mode="wrap"))


def flattest(points: FloatArray, share: float) -> float:
    """Return how far the flattest piece of a closed outline departs from a line, rms; no unit matters.

    Its points are evenly spaced. The piece is as long as a share of the root of the area, which the distance
    is divided by.
    """
    size = math.sqrt(abs(signed_area(points)))
    place = points @ [1, 1j]
    place -= place.mean()
    spacing = float(np.abs(shifted(place, 1) - place).mean())
    count = min(max(3, round(share * size / spacing)), len(points))
    # Of complex numbers x + iy the mean square holds xx − yy and xy, and that of their sizes is xx + yy.
    sums = np.array([place, place * place, np.abs(place) ** 2])
    mean, square, total = uniform_filter1d(sums, count, mode="wrap")
    across = (total.real - np.abs(mean) ** 2 - np.abs(square - mean * mean)) / 2  # the smaller variance
    return math.sqrt(max(float(across.min()), 0.0)) / size


def smooth_normals(points: FloatArray, period: float) -> FloatArray:
    """Return the outward normals of an outline seen at the scale of a ridge period."""
    return outward_normals(running_mean(points, round(period)), 2)


def profiles(
    field: Float32Array,
    points: FloatArray,
    normals: FloatArray,
    distances: npt.ArrayLike,
    beyond: float = 0.0,
) -> Float32Array:
    """Return levels at distances outward of each point, (distances, points), and beyond the field a value."""
    out = as_float32(distances)[:, None]
    x, y = (as_float32(points[:, k]) + out * as_float32(normals[:, k]) for k in (0, 1))
    levels = cv2.remap(field, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=beyond)
    return as_float32(levels)


def axis_weights(moments: AreaMoments, points: FloatArray) -> FloatArray:
    """Return the change of (semi_major, semi_minor, area) for a unit of area added at each point, (n, 3)."""
    place = (points - moments.centroid) @ moments.axes.T
    stretch = (place[:, 0] ** 2 / moments.spread[0] - place[:, 1] ** 2 / moments.spread[1]) / 4
    plain = 0.5 / moments.area
    major, minor = moments.semi_axes
    return np.stack([major * (plain + stretch), minor * (plain - stretch), np.ones(len(points))], axis=-1)


def _offset_std(edge: Edge) -> float:
    """Return the standard uncertainty of the edge's place that all of the outline shares, px.

    It holds the definition of the edge of a contact that fades, the low pressure of a light touch and, where
    no ridges are resolved, all of the shift for them.
    """
    signs = edge.signs
    return edge.period * math.hypot(
        EDGE.shared_std,
        EDGE.small_std * edge.period / math.sqrt(abs(signed_area(edge.points))),
        EDGE.beyond_std * signs.beyond,
        EDGE.rim_std * signs.cover**2,
        EDGE.unevenness_std * signs.unevenness,
        EDGE.paleness_std * signs.paleness,
        EDGE.steepness_std * signs.steepness,
        0.0 if edge.resolved else EDGE.ends / 2,
    )


def outline_noise(edge: Edge, weights: FloatArray) -> FloatArray:
    """Return the covariance of (semi_major, semi_minor, area) from errors of one image's outline.

    An edge that fades does so unevenly, as the contrast inside shows. Where it was drawn manually, the error
    of drawing replaces these; half of its variance is shared by all that was drawn.
    """
    seen, drawn = edge.steps * ~edge.manual, edge.steps * edge.manual * _MANUAL * edge.period
    noise = _spread_noise(weights, seen * edge.varying_std, EDGE.alike * len(weights))
    noise += _spread_noise(weights, drawn, _DRAWN_ALIKE * edge.period)
    for shared in (weights.T @ (seen * edge.differs), weights.T @ drawn):
        noise += np.outer(shared, shared)
    return noise


def _spread_noise(weights: FloatArray, areas: FloatArray, shared_by: float) -> FloatArray:
    """Return the covariance from errors of the area at each point that so many neighbours share.

    A running mean spreads independent errors over these.
    """
    count = min(max(1, round(shared_by)), len(weights))
    spread = running_mean(weights * areas[:, None], count)
    return np.asarray(spread.T @ spread * count)
