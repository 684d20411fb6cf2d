"""A coin, or any flat disc of known diameter, as the scale of a picture.

Ellipses that may outline it run through contours at many grey levels, then through the edge itself.
"""

import math
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import cv2
import numpy as np

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32, as_float_array, robust_std
from fingerpad._display import Displayed
from fingerpad.exceptions import CalibrationError, FitError
from fingerpad.image._masks import sample
from fingerpad.image.ellipse import PlaneEllipse, half_turn
from fingerpad.image.ellipse_fit import correlation_length, direct_ellipse, fit_ellipse
from fingerpad.image.levels import picture_levels
from fingerpad.image.read import ImageLike, levels_of
from fingerpad.image.scale import Scale

_WORKING_SIDE = 640
_MIN_SIDE_PX = 48
_MIN_SUPPORT, _CLEAR_SUPPORT, _INCOMPLETE = 0.75, 0.85, 0.12
_MIN_STRENGTH = 0.3
_REACH_OF_SHADOW = 1.2
_MIN_SHARPNESS, _STEP_SHARPNESS = 0.8, 2.2
# Two ellipses are one, or touch, when no further apart than this share of their size.
_SAME, _TOUCHING, _MIN_TOUCHING = 0.004, 0.012, 0.15
_DEEP_SHADOW, _DEEPEST_SHADOW, _SHADOW_SECTORS = 0.15, 0.5, 36
# A tilt that shortens a semi-axis by this share is one.
_MIN_TILTED: Final = 0.02
# Contours are drawn at so many levels, and ellipses fitted to so many draws of six points of each.
_LEVELS, _DRAWS = 16, 25
_MIN_RADIUS_PX, _MIN_AXIS_RATIO = 10.0, 0.6
# Ellipses through two contours are one when no further apart than this share of their size.
_SAME_CONTOUR = 0.025
# Samples across an edge, px apart, and how many of them the search for the steepest may climb.
_PROFILE_STEP, _CLIMB = 0.25, 8
# An edge is as strong as all but this share of its circumference.
_WEAKEST = 0.35


@dataclass(frozen=True, slots=True, kw_only=True)
class CoinEdge:
    """Standard deviations of what shifts the edge of a coin as a whole, chosen on coins of known size."""

    lens_px: float = 0.08  # px; lens and lamp
    rounding: float = 0.0045  # of the radius; the rounded edge, which mirrors the background
    shadow: float = 0.045  # of the radius; a shadow beside the edge as strong as the coin's contrast
    band: float = 0.006  # of the radius; a band beside the edge as strong as that


COIN_EDGE: Final = CoinEdge()


class Outline(NamedTuple):
    """An ellipse through an edge: the edge's points, how steep they are, and which of them lie on it."""

    ellipse: PlaneEllipse
    points: FloatArray
    slope: FloatArray
    kept: BoolArray

    @property
    def support(self) -> float:
        """Share of the circumference on which the edge lies on the ellipse."""
        return float(self.kept.mean())

    @property
    def strength(self) -> float:
        """Slope of the edge that most of the circumference exceeds."""
        return float(np.quantile(np.where(self.kept, self.slope, 0.0), _WEAKEST))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Coin(Displayed):
    """A coin or disc found in a picture.

    Attributes
    ----------
    centre : (float, float)
        (row, column), px; pixel centres are whole numbers.
    semi_major, semi_major_std : float
        Radius of the disc, px: the semi-axis that a tilt does not shorten. The standard uncertainty is from
        the scatter of the edge, correlated along it, and from its shifts by lens blur, relief and a shadow.
    semi_minor, semi_minor_std : float
        The semi-axis that a tilt shortens, px.
    orientation : float
        Angle of the major axis from straight up, counter-clockwise as seen, radians in (−π/2, π/2].
    shadow : float
        Depth of a shadow beside the edge, as a share of the contrast between coin and background.
    flags : tuple of str
        Doubts: ``coin_shadow`` where it may shift the edge by more than the stated uncertainty,
        ``coin_tilted`` where a tilt shortens one semi-axis by more than 2 %.
    """

    centre: tuple[float, float]
    semi_major: float
    semi_major_std: float
    semi_minor: float
    semi_minor_std: float
    orientation: float
    shadow: float
    flags: tuple[str, ...]

    @property
    def tilt(self) -> float:
        """Angle between the disc and the image plane that the shortening implies, radians."""
        return math.acos(min(1.0, self.semi_minor / self.semi_major))

    def scale(self, diameter_mm: float, diameter_mm_std: float = 0.0) -> Scale:
        """Return the scale in the plane of the coin, from its diameter and the standard uncertainty, mm."""
        # What lies in the coin's plane is shortened across the tilt too, and its area as much.
        shortened = self.semi_major - self.semi_minor if "coin_tilted" in self.flags else 0.0
        own_std = 2 * math.hypot(self.semi_major_std, shortened / 2)
        return Scale._of_length("diameter_mm", diameter_mm, diameter_mm_std, 2 * self.semi_major, own_std)


def measure_coin(image: ImageLike) -> Coin:
    """Find the one coin in a picture, to a fraction of a pixel.

    Of the ellipses that have a sharp edge nearly all round the outermost is the coin's, so that a rim, a ring
    of letters, the hole of a washer or one side of a shadow is not taken for it. It is fitted by least
    orthogonal distance to the edge in the full image, outliers left out. Meant for a coin of 60 px radius or
    more, tilted by less than 45°, on a background that differs from it all round.

    Parameters
    ----------
    image : array_like, (rows, columns), path-like or Picture
        Grey levels of any real type, or the file that holds them.

    Returns
    -------
    Coin

    Raises
    ------
    CalibrationError
        If the array is no grey picture, or shows no coin, more than one, or one that the frame cuts; or if
        its edge is lost in a deep shadow, or on a background as bright as the coin.

    Examples
    --------
    The major axis of a tilted coin, here one euro, keeps its length.

    >>> from fingerpad.image import measure_coin
    >>> from fingerpad.simulate import render_coin
    >>> coin = measure_coin(render_coin(radius=80.0, tilt=0.4, shape=(240, 240)).pixels)
    >>> round(coin.tilt, 1), round(coin.scale(23.25).mm_per_px, 3)
    (0.4, 0.145)
    """
    levels = picture_levels(levels_of(image), "pixels", CalibrationError)
    if min(levels.shape) < _MIN_SIDE_PX:
        raise CalibrationError(
            f"pixels must be {_MIN_SIDE_PX} px or more each way, found shape {levels.shape}"
        )
    values = as_float32(levels)
    step = max(1.0, max(values.shape) / _WORKING_SIDE)
    small = cv2.resize(values, None, fx=1 / step, fy=1 / step, interpolation=cv2.INTER_AREA)
    chosen, shadowed = _coin_outline(as_float32(small), step)
    # Pixel centres of the small image lie at whole numbers of its own.
    x, y = ((place + 0.5) * step - 0.5 for place in (chosen.ellipse.x, chosen.ellipse.y))
    start = replace(chosen.ellipse.scaled(step), x=x, y=y)
    smooth = _smooth(values)
    outline = fit_edge(smooth, start, 3.0 * step)
    if outline is None or outline.support < _MIN_SUPPORT:
        raise CalibrationError("no coin found: no circumference shows a sharp edge all round")
    shadow, band = _beside_edge(smooth, outline.ellipse)
    if shadow > _DEEPEST_SHADOW:
        raise CalibrationError(
            "no coin found: beside its edge it is as dark as the coin, by a shadow or a wider edge: "
            "light it evenly, or draw a line instead"
        )
    return _coin(outline, shadow, band, shadowed)


def _smooth(image: Float32Array, std_px: float = 1.0) -> Float32Array:
    return as_float32(cv2.GaussianBlur(image, (0, 0), std_px))


def _coin_outline(image: Float32Array, step: float) -> tuple[Outline, bool]:
    """Return the one coin's outline in a copy reduced by `step`, and whether a shadow lies against it."""
    found = _outlines(image)
    outlines = _select_sharp(found, image) if found else []
    if not outlines:
        raise CalibrationError(
            "no coin found: show one whole coin, flat, sharp, on a plain background, or draw a line instead"
        )
    apart = [outlines[0]]
    for one in outlines:
        x, y = one.ellipse.x, one.ellipse.y
        if all(math.hypot(x - o.ellipse.x, y - o.ellipse.y) > 0.8 * o.ellipse.size for o in apart):
            apart.append(one)
    if len(apart) > 1:
        places = ", ".join(f"(row {step * o.ellipse.y:.0f}, column {step * o.ellipse.x:.0f})" for o in apart)
        raise CalibrationError(
            f"{len(apart)} coins found where one is expected, at {places}: crop the image to one"
        )
    # A shadow's outline follows the coin on its lit side.
    coin = next(
        o for o in outlines if not any(i.ellipse.size < o.ellipse.size and _touch(o, i) for i in outlines)
    )
    rows, columns = image.shape
    x, y = coin.ellipse.points(72)[0].T
    if x.min() < 1 or y.min() < 1 or x.max() > columns - 2 or y.max() > rows - 2:
        raise CalibrationError("the coin is cut by the frame: show the whole coin, or draw a line instead")
    beyond = (o for o in found if o.support > _CLEAR_SUPPORT and o is not coin)
    return coin, any(
        _touch(coin, o) or 1 < o.ellipse.size / coin.ellipse.size < _REACH_OF_SHADOW for o in beyond
    )


def _outlines(image: Float32Array) -> list[Outline]:
    """Return the different outlines with an edge nearly all round, largest first."""
    smooth = _smooth(image)
    found = _fit_edges(smooth, _contour_ellipses(image))
    if found:
        # No grey level may separate a ring from an uneven background where one separates its hole.
        clearest = max(found, key=lambda o: o.support * o.strength).ellipse
        found += _fit_edges(smooth, [clearest.scaled(1.05**k) for k in range(1, 25)])
    different: list[Outline] = []
    for outline in sorted(found, key=lambda o: -o.support * o.strength):
        if all(_gaps(outline.ellipse, o.ellipse).max() > _SAME for o in different):
            different.append(outline)
    return sorted(different, key=lambda o: -o.ellipse.size)


def _fit_edges(smooth: Float32Array, ellipses: list[PlaneEllipse]) -> list[Outline]:
    fits = (fit_edge(smooth, e, max(3.0, 0.06 * e.size)) for e in ellipses)
    return [o for o in fits if o and o.support > _MIN_SUPPORT]


def _select_sharp(outlines: list[Outline], image: Float32Array) -> list[Outline]:
    """Return the outlines whose edge is nearly complete, sharp, and not faint beside the others."""
    # A wider blur takes much of a sharp edge's slope, and little of a penumbra's.
    coarse = _smooth(image, 3.0)
    blurred = [np.median(_edge_points(coarse, o.ellipse, 1.0)[1]) for o in outlines]
    sharpness = [np.median(o.slope[o.kept]) / slope for o, slope in zip(outlines, blurred, strict=True)]
    support, strength = (max(getattr(o, name) for o in outlines) for name in ("support", "strength"))
    least = _MIN_SHARPNESS * min(max(sharpness), _STEP_SHARPNESS)
    return [
        o
        for o, sharp in zip(outlines, sharpness, strict=True)
        if o.support > support - _INCOMPLETE and o.strength > _MIN_STRENGTH * strength and sharp > least
    ]


def _touch(one: Outline, other: Outline) -> bool:
    """Return whether two outlines run together on one side and apart on another; rings of a coin do not."""
    gap = _gaps(one.ellipse, other.ellipse)
    return float(np.mean(gap < _TOUCHING)) > _MIN_TOUCHING and gap.max() > 2 * _TOUCHING


def _coin(outline: Outline, shadow: float, band: float, shadowed: bool) -> Coin:
    try:
        fit = fit_ellipse(outline.points[outline.kept])
    except FitError as error:
        raise CalibrationError(f"no coin found: {error}") from error
    places = np.flatnonzero(outline.kept)
    correlated = correlation_length(outline.ellipse.offsets(outline.points[places]), places)
    relative = math.hypot(COIN_EDGE.rounding, COIN_EDGE.shadow * shadow, COIN_EDGE.band * min(band, 1.0))
    x, y, semi_major, semi_minor, angle = fit.ellipse.parameters
    moved = math.hypot(COIN_EDGE.lens_px, relative * semi_major)
    major_std, minor_std = (math.hypot(math.sqrt(correlated * fit.covariance[k, k]), moved) for k in (2, 3))
    short = semi_major - semi_minor
    doubts = {
        "coin_shadow": shadowed or shadow > _DEEP_SHADOW,
        "coin_tilted": short > max(_MIN_TILTED * semi_major, 3 * math.hypot(major_std, minor_std)),
    }
    return Coin(
        centre=(y, x),
        semi_major=semi_major,
        semi_major_std=major_std,
        semi_minor=semi_minor,
        semi_minor_std=minor_std,
        orientation=half_turn(math.pi / 2 - angle),
        shadow=shadow,
        flags=tuple(flag for flag, doubted in doubts.items() if doubted),
    )


def _beside_edge(image: Float32Array, ellipse: PlaneEllipse) -> tuple[float, float]:
    """Return the share of the coin's contrast that a shadow beside it takes, which pulls the edge outward.

    With it comes how far a band beside the edge, shadow or rounded metal, departs from the background.
    """
    levels = []
    for factor in (0.97, 1.03, 1.05, 1.3):
        ring = sample(image, ellipse.scaled(factor).points(8 * _SHADOW_SECTORS)[0])
        levels.append(np.median(ring.reshape(_SHADOW_SECTORS, 8), axis=1))
    coin, near, beside, ground = levels
    contrast = np.maximum(np.abs(ground - coin), 1e-6)
    missing = 1 - np.minimum(np.abs(near - coin), np.abs(beside - coin)) / contrast
    band = np.maximum(np.abs(ground - near), np.abs(ground - beside)) / contrast
    return max(0.0, float(np.quantile(missing, 0.9))), float(np.median(band))


def _contour_ellipses(image: Float32Array) -> list[PlaneEllipse]:
    """Return the different ellipses through contours at many grey levels."""
    smooth = _smooth(image, 1.5)
    slope = np.hypot(*(cv2.Sobel(smooth, cv2.CV_32F, *order, scale=1 / 8) for order in ((1, 0), (0, 1))))
    steep = slope > 2 * np.median(slope)
    low, high = np.percentile(smooth, [0.5, 99.5])
    rng = np.random.default_rng(0)
    found: list[PlaneEllipse] = []
    for level in np.linspace(low, high, _LEVELS + 2)[1:-1]:
        above = (smooth > level).astype(np.uint8)
        contours, _ = cv2.findContours(above, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
        for contour in contours:
            points = contour[steep[contour[:, 0, 1], contour[:, 0, 0]], 0]
            if len(points) < 2 * math.pi * _MIN_RADIUS_PX:
                continue
            ellipse = _through_contour(points.astype(np.float64), rng)
            if ellipse and all(_gaps(ellipse, other).max() > _SAME_CONTOUR for other in found):
                found.append(ellipse)
    return found


def _through_contour(points: FloatArray, rng: np.random.Generator) -> PlaneEllipse | None:
    """Return the ellipse that most points of a contour lie on: it may run round a neighbour as well."""
    points = points[:: max(1, len(points) // 100)]
    best, most = None, 0.0
    for draw in range(_DRAWS + 1):
        chosen = points if draw == 0 else points[rng.choice(len(points), 6, replace=False)]
        ellipse = _ellipse_through(chosen)
        if ellipse is None:
            continue
        near = np.abs(ellipse.offsets(points)) < max(1.0, 0.015 * ellipse.size)
        share = min(1.0, np.count_nonzero(near) / len(points))
        if share > most:
            best, most = _ellipse_through(points[near]) or ellipse, share
        if most > 0.85:
            break
    return best if most > 0.4 else None


def _ellipse_through(points: FloatArray) -> PlaneEllipse | None:
    """Return the least-squares ellipse through points, None where it cannot be a disc's image."""
    if len(points) < 6:
        return None
    with suppress(FitError):
        ellipse = PlaneEllipse(*direct_ellipse(points).tolist())
        minor, major = sorted(ellipse.semi_axes)
        if minor > _MIN_RADIUS_PX and minor >= _MIN_AXIS_RATIO * major:
            return ellipse
    return None


def _gaps(ellipse: PlaneEllipse, other: PlaneEllipse) -> FloatArray:
    """Return the distances between two ellipses round the circumference, over their size."""
    return np.abs(other.offsets(ellipse.points(72)[0]) / other.size)


def fit_edge(
    image: Float32Array, ellipse: PlaneEllipse, reach: float, closest: float = 3.0
) -> Outline | None:
    """Fit an ellipse to the steepest places near another one, from within `reach` down to `closest`, px."""
    while True:
        points, slope, found = _edge_points(image, ellipse, reach)
        kept, fitted = found, _ellipse_through(points[found])
        for _ in range(3):
            if fitted is None:
                return None
            off = np.abs(fitted.offsets(points))
            spread = robust_std(off[kept])
            kept = np.asarray(found & (off < np.clip(3 * spread, 0.3, 0.5 + 0.006 * fitted.size)))
            fitted = _ellipse_through(points[kept])
        if fitted is None or reach <= closest:
            return None if fitted is None else Outline(fitted, points, slope, kept)
        ellipse, reach = fitted, max(closest, 0.6 * reach)


def _edge_points(
    image: Float32Array, ellipse: PlaneEllipse, reach: float
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return the steepest place across the ellipse on each of many normals, and where it is an edge."""
    count = int(np.clip(math.pi * ellipse.size, 120, 1440))
    points, normals = ellipse.points(count)
    out = np.arange(-reach, reach + _PROFILE_STEP / 2, _PROFILE_STEP)
    profile = sample(image, points[:, None] + out[:, None] * normals[:, None], cv2.INTER_CUBIC)
    slope = np.abs(np.gradient(profile, axis=1))
    # Of several edges a steep one near the ellipse is the likely one.
    best = (slope * np.exp(-((out / reach) ** 2)))[:, 1:-1].argmax(axis=1) + 1
    every = np.arange(count)
    for _ in range(_CLIMB):
        uphill = slope[every[:, None], best[:, None] + np.array([-1, 0, 1])].argmax(axis=1) - 1
        best = np.clip(best + uphill, 1, out.size - 2)
    before, here, after = (slope[every, best + k] for k in (-1, 0, 1))
    peak = np.clip(0.5 * (before - after) / np.minimum(before - 2 * here + after, -1e-12), -1, 1)
    rows, columns = image.shape
    inside = (np.abs(points - (columns / 2, rows / 2)) < (columns / 2 - 2, rows / 2 - 2)).all(axis=1)
    found = inside & (here >= before) & (here >= after) & (here > 0.3 * np.median(here))
    edge = points + (out[best] + _PROFILE_STEP * peak)[:, None] * normals
    return edge, as_float_array(here), np.asarray(found)
