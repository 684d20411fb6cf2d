"""A face's ellipse from the arc of its outline, with every term of its uncertainty and the flags it earns.

Automatic and manual arcs, of photographs and of outlines given as points, all come here: what is stated is a
function of the arc and of what is known beside it, not of the way it was reached.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray
from fingerpad.exceptions import FitError
from fingerpad.image.ellipse import PlaneEllipse, rotation
from fingerpad.image.ellipse_fit import EllipseFit
from fingerpad.image.photograph import shape
from fingerpad.image.photograph.arc import (
    MAX_RELATIVE_STD,
    PAD_MIDDLE,
    SURELY_PAD,
    extend_arc,
    fit_arc_ellipse,
    initial_ellipse,
    outline_places,
    turns_from,
)
from fingerpad.image.photograph.calibration import DOUBT, LENGTHS
from fingerpad.image.photograph.faces import Face
from fingerpad.image.photograph.result import PhotographFit, size_flags
from fingerpad.image.scale import Scale

# So many points left out at an end of the arc say that the pad ends there.
_END = 8

_SHORT_ARC_DEG = 90.0
# Step across the edge over the noise beside it.
_LOW_CONTRAST = 30.0
# Depth of a finger seen end on, dorsal over palmar: 0.5 to 0.8 with a nail, 1 at most.
_DORSAL_DEEPER = 1.1

_POINT = np.dtype(
    [
        ("xy", np.float64, 2),  # px, in the face's frame
        ("step_ratio", np.float64),  # step across the edge over the noise beside it, NaN without an edge
        ("pad", np.bool_),  # whether it can be pad
        ("used", np.bool_),  # whether it is of the arc
        ("rejected", np.bool_),  # whether it would be, and stands out
        ("marked", np.bool_),  # whether it was added manually
    ]
)


def outline_points(xy: FloatArray, **known: ArrayLike) -> npt.NDArray[np.void]:
    """Return points of an outline: of the pad's arc, without an edge, unless other things are known."""
    points = np.zeros(len(xy), dtype=_POINT)
    for name, values in {"xy": xy, "step_ratio": math.nan, "pad": True, "used": True, **known}.items():
        points[name] = values
    return points


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FaceArc:
    """The arc of a face's outline, in the outline, and what is known beside it.

    Lengths are px of the picture. The outline's points are in order; the arc is one piece of them.
    """

    face: Face
    scale: Scale
    frame: tuple[FloatArray, FloatArray]  # steps (row, column) of the face's x and y; their origin there
    tilt: tuple[float, float]  # radians; of the finger's axis, known without the arc, and its std
    points: npt.NDArray[np.void]  # (n,); see `outline_points`
    start: FloatArray  # (x, y, semi_x, semi_y, tilt) of a rough ellipse
    ends_known: bool = True  # whether they were given: what lies beyond tells nothing of the lengths then
    erased: FloatArray = field(default_factory=lambda: np.empty((0, 2)))  # points of the arc
    alike: int = 8  # so many neighbouring points share an error
    blur: float = math.nan  # standard deviation of the edges' blur, NaN without edges
    border: tuple[float, float, float] | None = None  # last row, last column, how near the frame cuts an arc

    @property
    def xy(self) -> FloatArray:
        """The points in the face's frame, (n, 2), px."""
        return np.asarray(self.points["xy"], dtype=np.float64)

    @property
    def searched(self) -> BoolArray:
        """Among which points the arc was found."""
        arc: BoolArray = self.points["used"] | self.points["rejected"]
        return arc if self.ends_known else np.asarray(self.points["pad"])

    def about(self, ellipse: PlaneEllipse, angle: float) -> tuple[FloatArray, FloatArray]:
        """Return two outlines about an ellipse's centre, x turned by an angle, without points added manually.

        The first is, of a palmar face, all that was found, the shaft with it; the second what can be pad.
        """
        found = self.points[~self.points["marked"]]
        local = (found["xy"] - ellipse.parameters[:2]) @ rotation(angle)
        pad = local[found["pad"]]
        return local if self.face == "palmar" else pad, pad

    def in_picture(self, points: FloatArray) -> FloatArray:
        """Return points of the face's frame as (row, column), px."""
        axes, place = self.frame
        return np.asarray(points @ axes + place)

    def without(self, gone: BoolArray) -> Self:
        """Return the arc without some points of the outline.

        Where the end of the arc goes, so does all beyond it: the pad ends there.
        """
        used = self.points["used"]
        gone, left = gone.copy(), np.flatnonzero(used & ~gone)
        for beyond in (slice(left[0]), slice(left[-1] + 1, None)) if len(left) else ():
            gone[beyond] |= (gone & used)[beyond].sum() >= _END
        of_arc = gone & (used | self.points["rejected"])
        erased = np.concatenate([self.erased, self.xy[of_arc]])
        return replace(self, erased=erased, points=self.points[~gone])

    def with_marks(self, marks: FloatArray) -> Self:
        """Return the arc with points on the pad, (row, column), px, added manually, each in its turn."""
        axes, place = self.frame
        local = (marks - place) @ axes.T
        near = np.flatnonzero(self.points["pad"] | self.searched)
        turns, wanted = (turns_from(PAD_MIDDLE[self.face], xy, self.start) for xy in (self.xy[near], local))
        sign = -1.0 if len(turns) and turns[-1] < turns[0] else 1.0
        order = np.argsort(sign * wanted, kind="stable")
        before = np.searchsorted(np.maximum.accumulate(sign * turns), sign * wanted[order])
        at = np.append(near, near[-1] + 1 if len(near) else 0)[before]
        return replace(self, points=np.insert(self.points, at, outline_points(local[order], marked=True)))


def face_from_arc(arc: FaceArc) -> PhotographFit:
    """Return a face's semi-axes from an arc of its outline, with the terms of their covariance, and flags."""
    fit = _fitted(arc)
    noise = fit.covariance[2:4, 2:4]
    known = float((np.sqrt(np.diagonal(noise)) / fit.ellipse.semi_axes).max())
    middle, local = PAD_MIDDLE[arc.face], arc.xy[arc.points["used"]]
    angles = middle + turns_from(middle, local, fit.ellipse.parameters)
    if not known < MAX_RELATIVE_STD:
        raise FitError(
            f"the {arc.face} face's arc of {math.degrees(np.ptp(angles)):.0f} degrees leaves an axis unknown "
            f"by {100 * known:.0f} %: mark a longer arc, come nearer, or choose a backdrop of another colour "
            "than the skin"
        )
    average = _average_over_shapes(arc, fit)
    ellipse, share = average.ellipse, 1 - average.weight
    scale, semi_px = arc.scale.mm_per_px, ellipse.semi_axes
    tilt_std = math.sqrt(fit.covariance[4, 4])
    terms = {"noise": share * noise * scale**2}
    terms["shape"] = average.covariance * scale**2 - terms["noise"]
    if math.isfinite(arc.blur):
        terms["edge"] = np.full((2, 2), (DOUBT.edge_std * arc.blur * scale) ** 2)
    if not arc.ends_known:
        lengths, turn = _contradicted(arc, ellipse, tilt_std, share)
        tilt_std = math.hypot(tilt_std, LENGTHS.added * turn)
        both = np.outer(lengths, lengths) + turn**2
        terms["lengths"] = LENGTHS.added**2 * both * np.outer(semi_px, semi_px) * scale**2
    found = photograph_fit(arc, ellipse, terms, tilt_std, (float(angles.min()), float(angles.max())))
    found = replace(
        found,
        residual_px_std=fit.residual_std,
        exponent=average.exponent,
        exponent_std=average.exponent_std,
    )
    return replace(found, flags=_flags(found, arc))


def photograph_fit(
    arc: FaceArc,
    ellipse: PlaneEllipse,
    terms: Mapping[str, FloatArray],
    tilt_std: float,
    angles: tuple[float, float],
) -> PhotographFit:
    """Return an ellipse, px in the face's frame, as a result, to whose uncertainty the scale adds a term."""
    row, column = arc.in_picture(ellipse.parameters[:2]).tolist()
    semi_axes = ellipse.semi_axes * arc.scale.mm_per_px
    of_scale = arc.scale.relative_std**2 * np.outer(semi_axes, semi_axes)
    return PhotographFit(
        face=arc.face,
        semi_axes=semi_axes,
        covariance_terms={**terms, "scale": of_scale},
        scale=arc.scale,
        centre=(row, column),
        directions=rotation(ellipse.angle).T @ arc.frame[0],
        tilt=ellipse.angle,
        tilt_std=tilt_std,
        arc=angles,
        points=arc.in_picture(arc.xy[arc.points["used"]]),
        outliers=arc.in_picture(np.concatenate([arc.xy[arc.points["rejected"]], arc.erased])),
        blur_px=arc.blur,
        outline=arc.in_picture(arc.xy[arc.points["pad"] & ~arc.points["marked"]]),
        _arc=arc,
    )


def _fitted(arc: FaceArc) -> EllipseFit:
    """Return the arc's ellipse, to which the outline just beyond ends that were given contributes.

    An arc found automatically ends where no ellipse follows the outline further.
    """
    used, (places, _) = np.flatnonzero(arc.points["used"]), outline_places(arc.xy)
    fit = fit_arc_ellipse(arc.xy[used], arc.tilt, places=places[used], start=arc.start)
    return extend_arc(arc.xy, used, fit, arc.tilt) if arc.ends_known else fit


def _average_over_shapes(arc: FaceArc, fit: EllipseFit) -> shape.ShapeAverage:
    """Average with a superellipse along the arc, and along the pad's middle where the arc leaves it out."""
    guess = initial_ellipse(arc.xy, arc.face)
    middle = PAD_MIDDLE[arc.face]
    core = np.abs(turns_from(middle, arc.xy, guess)) < SURELY_PAD
    if arc.face in ("radial", "ulnar"):  # below the widest place the palmar side may be shaft
        core &= turns_from(middle, arc.xy, fit.ellipse.parameters) > -middle
    half, hidden = math.nan, 0.0
    outline, pad = arc.about(fit.ellipse, arc.tilt[0])
    # A side face shows the nail's side too, whose distance is no semi-axis.
    if arc.face in ("palmar", "distal") and len(outline):
        across, along = fit.ellipse.semi_axes
        half, hidden, _ = shape.half_width(outline, pad, across, along, arc.face)
    return shape.average_over_shapes(
        arc.xy[arc.searched & (arc.points["used"] | core)],
        fit.ellipse,
        fit.covariance[2:4, 2:4],
        tilt=arc.tilt,
        half_width=half,
        hidden=hidden,
        alike=arc.alike,
    )


def _contradicted(
    arc: FaceArc, ellipse: PlaneEllipse, tilt_std: float, share: float
) -> tuple[FloatArray, float]:
    """Return by how much the outline's lengths and the finger's axis differ from an ellipse beyond chance.

    Where the ellipse is tilted otherwise than the finger, another curve was taken for a turned ellipse: its
    axis is uncertain by that turn, and its semi-axes by about as many radians.
    """
    outline, pad = arc.about(ellipse, ellipse.angle)
    lengths = shape.contradicted_by_lengths(
        arc.face, outline, ellipse.semi_axes, pad=pad, tilt_std=tilt_std, ellipse=share
    )
    if arc.face == "distal":
        return lengths, 0.0
    return lengths, float(shape.beyond_chance(ellipse.angle - arc.tilt[0], LENGTHS.of_tilt_std * arc.tilt[1]))


def _flags(found: PhotographFit, arc: FaceArc) -> frozenset[str]:
    """Return what makes a measurement doubtful."""
    semi_px = float(found.semi_axes.min()) / found.scale.mm_per_px
    relative = np.sqrt(np.diagonal(found.edge_covariance)) / found.semi_axes
    by_lengths = np.diagonal(found.covariance_terms.get("lengths", np.zeros((2, 2))))
    no_ellipse = float((np.sqrt(by_lengths) / found.semi_axes).max()) > LENGTHS.added * LENGTHS.no_ellipse
    used, rejected = arc.points[arc.points["used"]], arc.points["rejected"]
    ratios = used["step_ratio"][np.isfinite(used["step_ratio"])]
    palmar_px = (arc.in_picture(arc.xy) - found.centre) @ found.directions[1]
    deepest = _DORSAL_DEEPER * found.semi_axes[1] / found.scale.mm_per_px
    margin = math.inf
    if arc.border is not None:
        *last, near = arc.border
        margin = float(np.minimum(found.points, np.array(last) - found.points).min()) - near
    holds = {
        "short_arc": found.arc_deg < _SHORT_ARC_DEG,
        "uncertain": float(relative.max()) > 0.02,
        "many_outliers": float(rejected.sum() / (rejected | arc.points["used"]).sum()) > 0.15,
        "low_contrast": len(ratios) > 0 and float(np.quantile(ratios, 0.25)) < _LOW_CONTRAST,
        "soft_edges": found.blur_px > 0.02 * semi_px,
        "touches_border": margin < 0,
        "poor_ellipse": found.residual_px_std > max(0.01 * semi_px, 0.5),
        "not_an_ellipse": no_ellipse or shape.is_significant(found.exponent, found.exponent_std),
        "dorsal_deeper": arc.face == "distal" and not arc.ends_known and palmar_px.min() < -deepest,
        "tilted": abs(found.tilt) > math.radians(10),
        "fitted_manually": bool(arc.points["marked"].any()) or len(arc.erased) > 0,
    }
    return frozenset(name for name, held in holds.items() if held) | size_flags(found.semi_axes)
