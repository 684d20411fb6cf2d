"""A coin, or any flat disc of known diameter, as the scale of a picture."""

import math
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import Float32Array, FloatArray, as_float_array
from fingerpad.exceptions import CalibrationError, FitError
from fingerpad.image.coin._disc import (
    Edges,
    Rim,
    candidates,
    circles,
    edges_of,
    ellipses,
    support,
)
from fingerpad.image.coin._edge import (
    correlation_length,
    edge_points,
    offsets_from,
    rim_of,
    shadow_beside,
    without_outliers,
)
from fingerpad.image.ellipse_fit import EllipseFit
from fingerpad.image.scale import Scale

_WORKING_SIDE = 640
_LEAST_SIDE_PX = 48
_LEAST_SUPPORT, _CLEAR_SUPPORT = 0.62, 0.75
_LEAST_VISIBLE = 0.3
_LEAST_PARTIAL = 0.35
_LEAST_KEPT = 0.5
_ROUNDS = 4
# Two ellipses are one, or touch, when no further apart than this share of their semi-axes.
_SAME, _TOUCHING, _LEAST_TOUCHING = 0.006, 0.012, 0.15
# What moves the edge all round, as standard deviations: lens and lamp, px; relief, of the scatter about the
# ellipse; a shadow beside the edge, of the radius, for a shadow as deep as the contrast of the coin.
_LENS_STD_PX, _RELIEF_STD, _SHADOW_STD = 0.04, 0.17, 0.006
_FAINT_SHADOW, _DEEP_SHADOW, _DEEPEST_SHADOW = 0.12, 0.25, 0.75


@dataclass(frozen=True, slots=True, kw_only=True)
class Coin:
    """A disc found in a picture.

    Attributes
    ----------
    centre : (float, float)
        (row, column), px; pixel centres are whole numbers.
    semi_major, semi_major_std : float
        Radius of the disc, px: the semi-axis that a tilt does not shorten, with its standard uncertainty
        from the scatter of the edge about the ellipse, neighbours along the edge not counted as independent,
        and from what moves the edge all round: the lens, relief on the rim, a shadow beside it.
    semi_minor, semi_minor_std : float
        The semi-axis that a tilt shortens, px.
    orientation : float
        Angle of the major axis from straight up, counter-clockwise as seen, radians in (−π/2, π/2].
    residual_std : float
        Standard deviation of the edge about the ellipse, px.
    support : float
        Share of the circumference on which the edge was found.
    shadow : float
        Depth of the shadow beside the edge where it is deepest, over the contrast of the coin.
    flags : tuple of str
        Doubts: ``shadow`` where it may pull the edge outward by more than the uncertainty says.
    """

    centre: tuple[float, float]
    semi_major: float
    semi_major_std: float
    semi_minor: float
    semi_minor_std: float
    orientation: float
    residual_std: float
    support: float
    shadow: float
    flags: tuple[str, ...]

    @property
    def tilt(self) -> float:
        """Angle between the disc and the image plane that the shortening implies, radians."""
        return math.acos(min(1.0, self.semi_minor / self.semi_major))

    def scale(self, diameter_mm: float, diameter_mm_std: float = 0.0) -> Scale:
        """Return the scale of the picture, in the plane of the coin.

        Parameters
        ----------
        diameter_mm, diameter_mm_std : float
            Diameter of the coin and its standard uncertainty, mm.

        Raises
        ------
        CalibrationError
            If the diameter is not positive and finite, or its uncertainty negative.
        """
        row, column = self.centre
        return Scale.of_line(
            diameter_mm,
            (row, column - self.semi_major),
            (row, column + self.semi_major),
            length_mm_std=diameter_mm_std,
            # Two ends of independent error make √2 of one: the diameter's own error is twice the radius's.
            point_px_std=math.sqrt(2) * self.semi_major_std,
        )


def measure_coin(pixels: npt.ArrayLike) -> Coin:
    """Find the one coin in a picture, to a fraction of a pixel.

    Edges vote for centres; ellipses are drawn through the edges that agree; of concentric ones the outermost
    that most of the circumference supports is the coin's edge, so that a rim, a ring of letters or one side
    of a shadow is not taken for it. The edge is then found on the full picture along the ellipse's normals,
    and an ellipse of least orthogonal distance fitted, outliers left out.

    Parameters
    ----------
    pixels : array_like, (rows, columns)
        Grey levels of any real type.

    Returns
    -------
    Coin

    Raises
    ------
    CalibrationError
        If the array is no grey picture, or shows no coin, more than one, or one that the frame cuts; or if
        its edge is lost in a deep shadow, or on a ground as bright as the coin.

    Notes
    -----
    Meant for a coin of 60 px radius or more, tilted by less than 25°, on a plain ground that differs from it
    all round. A shadow darker than a fifth of the ground pulls the edge outward, more than the uncertainty
    says where it is deep: such coins are flagged.

    Examples
    --------
    >>> from fingerpad.image import measure_coin
    >>> from fingerpad.simulate import render_coin
    >>> truth = render_coin(radius=120.0)
    >>> scale = measure_coin(truth.pixels).scale(23.25)  # one euro
    >>> abs(scale.mm_per_px / (23.25 / 240) - 1) < 0.002
    True
    """
    values = _checked(pixels)
    step = max(1.0, max(values.shape) / _WORKING_SIDE)
    small = cv2.resize(values, None, fx=1 / step, fy=1 / step, interpolation=cv2.INTER_AREA)
    edges = edges_of(np.asarray(small, dtype=np.float32))
    rings = _one_place(_discs(edges), edges)
    # Pixel centres of the small picture lie at whole numbers of its own.
    whole = [r.scaled(step)._replace(x=(r.x + 0.5) * step - 0.5, y=(r.y + 0.5) * step - 0.5) for r in rings]
    coin, chosen = _outermost(values, whole, 1.5 * step)
    _require_end(edges, rings[chosen])
    return coin


def _checked(pixels: npt.ArrayLike) -> Float32Array:
    array = np.asarray(pixels)
    if array.ndim != 2 or array.dtype.kind not in "buif" or min(array.shape) < _LEAST_SIDE_PX:
        raise CalibrationError(
            f"pixels must be a grey (rows, columns) picture of {_LEAST_SIDE_PX} px or more, "
            f"found shape {array.shape}"
        )
    values = array.astype(np.float32)
    if not np.isfinite(values).all():
        raise CalibrationError("pixels hold NaN or infinite values: fill them first")
    return values


def _discs(edges: Edges) -> list[Rim]:
    """Return the circles that the edges support, and where that leaves doubt the ellipses, largest first.

    An ellipse can follow a coin on one side and its shadow on the other; a circle cannot.
    """
    rng = np.random.default_rng(0)
    starts = candidates(edges)
    flat = [rim for start in starts for rim in circles(edges, start, _LEAST_SUPPORT)]
    if any(support(edges, rim)[0] >= _CLEAR_SUPPORT for rim in flat):
        return _distinct(flat, edges)
    tilted = [rim for start in starts for rim in ellipses(edges, start, rng, _LEAST_SUPPORT)]
    return _distinct(flat + tilted, edges)


def _distinct(rims: list[Rim], edges: Edges) -> list[Rim]:
    """Return the well supported ones of many ellipses, each once, largest first."""
    kept: list[Rim] = []
    for rim in sorted(rims, key=lambda rim: -rim.size):
        share, visible = support(edges, rim)
        new = all(_gaps(rim, other).max() > _SAME for other in kept)
        if new and share >= _LEAST_SUPPORT and visible >= _LEAST_VISIBLE:
            kept.append(rim)
    return kept


def _gaps(rim: Rim, other: Rim) -> FloatArray:
    """Return how far `other` lies from `rim` round the circumference, in its semi-axes."""
    x, y, _, _ = rim.points(as_float_array(np.arange(72) * (math.pi / 36)))
    return as_float_array(np.abs(np.hypot(*other.frame(x, y)) - 1))


def _one_place(rims: list[Rim], edges: Edges) -> list[Rim]:
    """Return the ellipses about the place of the largest, or say why there is no one whole coin."""
    if not rims:
        raise CalibrationError(
            "no coin found: show one whole coin, flat, sharp, on a plain ground, or draw a line instead"
        )
    apart = [rims[0]]
    for rim in rims:
        if all(math.hypot(rim.x - k.x, rim.y - k.y) > 0.8 * k.size for k in apart):
            apart.append(rim)
    if len(apart) > 1:
        places = ", ".join(f"(row {rim.y:.0f}, column {rim.x:.0f})" for rim in apart)
        raise CalibrationError(
            f"{len(apart)} coins found where one is expected, at {places}: crop the picture to one"
        )
    if support(edges, rims[0])[1] < 1:
        raise CalibrationError("the coin is cut by the frame: show the whole coin, or draw a line instead")
    return rims


def _require_end(edges: Edges, rim: Rim) -> None:
    """Refuse a ring beyond which a wider one is seen in part: the coin's edge, lost where it is as bright."""
    for factor in np.arange(1.03, 1.35, 0.005):
        share = support(edges, rim.scaled(float(factor)))[0]
        if share > _LEAST_PARTIAL:
            raise CalibrationError(
                f"no coin found: its edge is seen on {share:.0%} of the circumference only, "
                "the rest is as bright as the ground: change the ground or the light"
            )


def _outermost(values: Float32Array, rims: list[Rim], reach: float) -> tuple[Coin, int]:
    """Return the coin of the largest of nested ellipses that is no shadow's, and the ellipse's number."""
    smooth = np.asarray(cv2.GaussianBlur(values, (0, 0), 1.0), dtype=np.float32)
    found = [_refined(smooth, rim, max(reach, 0.006 * rim.size)) for rim in rims]
    pairs = [pair for pair in found if pair is not None]
    coins = {
        number: pair[0]
        for number, pair in enumerate(found)
        if pair is not None and not any(_is_shadowed(*pair, *other) for other in pairs)
    }
    if not coins:
        raise CalibrationError("no coin found: no circumference shows a sharp edge all round")
    best = max(coins, key=lambda number: coins[number].semi_major)
    if coins[best].shadow > _DEEPEST_SHADOW:
        raise CalibrationError(
            "no coin found: beside its edge it is as dark as the coin, by a shadow or a wider edge: "
            "light it evenly, or draw a line instead"
        )
    return coins[best], best


def _is_shadowed(coin: Coin, rim: Rim, inner: Coin, inner_rim: Rim) -> bool:
    """Tell whether an ellipse is led by the shadow of a coin within it: the two touch on the lit side only.

    Rings of one coin keep their distance all round.
    """
    gaps = _gaps(rim, inner_rim)
    contact = float(np.mean(gaps < _TOUCHING))
    return (
        inner_rim.size < rim.size
        and contact > _LEAST_TOUCHING
        and gaps.max() > 2 * _TOUCHING
        and inner.residual_std < coin.residual_std
    )


def _refined(smooth: Float32Array, rim: Rim, reach: float) -> tuple[Coin, Rim] | None:
    """Fit an ellipse to the steepest places near a rim, None where they make none."""
    for _ in range(_ROUNDS):
        points, found = edge_points(smooth, rim, reach)
        try:
            fit, kept = without_outliers(points, found)
        except FitError:
            return None
        rim = rim_of(fit)
        reach = max(1.5, 0.7 * reach)
    if kept.mean() < _LEAST_KEPT:
        return None
    memory = correlation_length(offsets_from(points, rim), kept)
    return _coin(fit, float(kept.mean()), memory, shadow_beside(smooth, rim)), rim


def _coin(fit: EllipseFit, share: float, memory: float, shadow: float) -> Coin:
    moved = math.hypot(
        _LENS_STD_PX,
        _RELIEF_STD * fit.residual_std,
        _SHADOW_STD * max(0.0, shadow - _FAINT_SHADOW) * fit.semi_major,
    )
    major_std, minor_std = (math.hypot(math.sqrt(memory * fit.covariance[k, k]), moved) for k in (2, 3))
    return Coin(
        centre=(float(fit.centre[1]), float(fit.centre[0])),
        semi_major=fit.semi_major,
        semi_major_std=major_std,
        semi_minor=fit.semi_minor,
        semi_minor_std=minor_std,
        # From x towards y, both as the picture counts them, to from straight up towards the left.
        orientation=math.pi / 2
        - (math.pi / 2 - math.atan2(-math.cos(fit.angle), -math.sin(fit.angle))) % math.pi,
        residual_std=fit.residual_std,
        support=share,
        shadow=shadow,
        flags=("shadow",) if shadow > _DEEP_SHADOW else (),
    )
