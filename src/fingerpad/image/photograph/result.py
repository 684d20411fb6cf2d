"""A face's ellipse from the arc of its outline, with every term of its uncertainty and the flags it earns.

Automatic and manual arcs, of photographs and of outlines given as points, all come here: what is stated is a
function of the arc and of what is known beside it, not of the way it was reached.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import FloatArray, finite_angle
from fingerpad._display import Displayed, record_text
from fingerpad.exceptions import FitError
from fingerpad.image.ellipse import PlaneEllipse, rotation
from fingerpad.image.ellipse_fit import EllipseFit
from fingerpad.image.photograph import shape
from fingerpad.image.photograph.arc import (
    MAX_RELATIVE_STD,
    PAD_MIDDLE,
    FaceArc,
    extend_arc,
    fit_arc_ellipse,
    outline_places,
    turns_from,
)
from fingerpad.image.photograph.calibration import DOUBT, LENGTHS
from fingerpad.image.photograph.faces import FACE_AXES, Face, FaceSemiAxes, implausible_size
from fingerpad.image.scale import Scale

_SHORT_ARC_DEG = 90.0
# Step across the edge over the noise beside it.
_LOW_CONTRAST = 30.0
# Depth of a finger seen end on, dorsal over palmar: 0.5 to 0.8 with a nail, 1 at most.
_DORSAL_DEEPER = 1.1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PhotographFit(Displayed):
    """The ellipse of a finger pad in a photograph of one face.

    Attributes
    ----------
    face : Face
        The face that looked at the camera.
    semi_axes : ndarray, shape (2,)
        Semi-axes across and along, in the order of `FACE_AXES`, mm.
    covariance_terms : mapping from str to ndarray, shape (2, 2)
        Terms of their covariance, mm², by origin: ``noise`` of the points, a ``shape`` that is no ellipse,
        an ``edge`` that lies further out or in all round, and ``lengths`` of the outline that differ; or the
        ``placement`` of an ellipse by hand; and the ``scale``.
    scale : Scale
        The scale that was given.
    centre : (float, float)
        Centre of the ellipse, (row, column), px.
    directions : ndarray, shape (2, 2)
        Unit steps (row, column) along the first and the second semi-axis.
    tilt, tilt_std : float
        Turn of the ellipse from the face's x towards its y, and its standard uncertainty, radians.
    arc : (float, float)
        First and last parametric angle of the points used, radians.
    points, outliers : ndarray, shape (n, 2)
        Points of the outline used and left out, (row, column), px.
    residual_px_std, blur_px : float
        Standard deviation of the points from the ellipse, and of the edges' blur, px.
    flags : frozenset of str
        Doubts, by their codes in `fingerpad.flags`.
    exponent, exponent_std : float
        Exponent p of the superellipse :math:`|x/a|^p + |y/b|^p = 1` that follows the pad best, a mean over
        its quadrants, and its standard uncertainty: 2 for an ellipse, less where the tip is pointed, more
        where it is blunt. NaN where nothing was fitted.
    outline : ndarray, shape (n, 2)
        All points of the outline that can be pad, in order, (row, column), px.
    picture : ndarray or None
        The photograph that was measured, where it is kept.

    Examples
    --------
    >>> from fingerpad.image import photograph_from_ellipse
    >>> fit = photograph_from_ellipse("palmar", Scale(0.05), centre=(300, 200), semi_axes=(236, 276))
    >>> fit.handles.tolist()
    [[300.0, 200.0], [300.0, 436.0], [24.0, 200.0]]
    """

    face: Face
    semi_axes: FloatArray
    covariance_terms: Mapping[str, FloatArray]
    scale: Scale
    centre: tuple[float, float]
    directions: FloatArray
    tilt: float
    tilt_std: float
    arc: tuple[float, float]
    points: FloatArray = field(default_factory=lambda: np.empty((0, 2)))
    outliers: FloatArray = field(default_factory=lambda: np.empty((0, 2)))
    residual_px_std: float = math.nan
    blur_px: float = math.nan
    flags: frozenset[str] = frozenset()
    exponent: float = math.nan
    exponent_std: float = math.nan
    outline: FloatArray = field(default_factory=lambda: np.empty((0, 2)))
    picture: npt.NDArray[Any] | None = field(default=None, repr=False)
    _arc: FaceArc  # that was fitted, for manual changes to it

    @property
    def edge_covariance(self) -> FloatArray:
        """Covariance of the semi-axes from the outline alone: the sum of its terms but the scale's, mm²."""
        terms = [term for name, term in self.covariance_terms.items() if name != "scale"]
        return np.asarray(np.sum(terms, axis=0), dtype=np.float64)

    def summary(self) -> str:
        """Return the measured numbers as text, one line each."""
        numbers: dict[str, Any] = {}
        for name, value in self.semi_axes_mm.items():
            numbers |= {f"{name}_mm": value, f"{name}_mm_std": self.semi_axes_mm_std[name]}
        for name in ("arc_deg", "exponent", "exponent_std"):
            numbers[name] = getattr(self, name)
        for radii in self.side_radii():
            at = f"{radii['wedge_angle_deg']:g}deg"
            numbers[f"outline_radius_mm_{at}"] = radii["outline_mm"]
            numbers[f"outline_radius_mm_std_{at}"] = radii["outline_mm_std"]
            numbers[f"ellipse_radius_mm_{at}"] = radii["ellipse_mm"]
        return record_text(f"Photograph of the {self.face} face", {**numbers, "flags": self.flags})

    def as_record(self) -> dict[str, Any]:
        """Return the numbers by names that end in units, for tables and scripts."""
        return {
            "semi_axes_mm": self.semi_axes_mm,
            "semi_axes_mm_std": self.semi_axes_mm_std,
            "uncertainty_mm_std": self.uncertainty_mm_std,
            "arc_deg": self.arc_deg,
            "exponent": self.exponent,
            "exponent_std": self.exponent_std,
            "radii": self.side_radii(),
            "outlier_fraction": self.outlier_fraction,
            "flags": sorted(self.flags),
        }

    @property
    def covariance(self) -> FloatArray:
        """Covariance of the semi-axes: the sum of its terms, mm²."""
        return self.edge_covariance + self.covariance_terms["scale"]

    @property
    def semi_axes_mm(self) -> dict[str, float]:
        """Semi-axes by anatomical name, mm."""
        return self._by_name(self.semi_axes)

    @property
    def semi_axes_mm_std(self) -> dict[str, float]:
        """Their standard uncertainties, the scale's share included, mm."""
        return self._by_name(np.sqrt(np.diagonal(self.covariance)))

    @property
    def uncertainty_mm_std(self) -> dict[str, dict[str, float]]:
        """Standard uncertainty of each semi-axis by term of the covariance, mm."""
        terms = self.covariance_terms.items()
        return {name: self._by_name(np.sqrt(np.diagonal(term).clip(0))) for name, term in terms}

    def _by_name(self, lengths: FloatArray) -> dict[str, float]:
        return dict(zip(FACE_AXES[self.face], lengths.tolist(), strict=True))

    @property
    def arc_deg(self) -> float:
        """Extent of the arc used, parametric degrees."""
        return math.degrees(self.arc[1] - self.arc[0])

    @property
    def outlier_fraction(self) -> float:
        """Share of the arc's points that were left out."""
        return len(self.outliers) / max(len(self.outliers) + len(self.points), 1)

    @property
    def face_semi_axes(self) -> FaceSemiAxes:
        """The semi-axes as `combine_faces` takes them: equal scales are one, whose error is shared."""
        scale = self.scale
        return FaceSemiAxes(
            face=self.face,
            semi_axes=self.semi_axes,
            covariance=self.edge_covariance,
            relative_scale_std=scale.relative_std,
            scale=f"{scale.mm_per_px!r} ± {scale.mm_per_px_std!r} mm/px" if scale.mm_per_px_std else None,
            flags=self.flags,
        )

    @property
    def handles(self) -> FloatArray:
        """(row, column) of the centre and of the ends of the semi-axes across and along, px, (3, 2)."""
        centre = np.array(self.centre)
        ends = self.directions * self.semi_axes[:, None] / self.scale.mm_per_px
        return np.stack([centre, *(centre + ends)])

    def outline_radius(self, angle: float) -> tuple[float, float]:
        """Return the radius of curvature of the outline itself, mm, and its standard uncertainty.

        Of a side face, with the angle of the wedge, it is the radius of the pad in the plane along the
        finger at the place of contact. It is fitted to the outline within 0.35 radii of that place;
        `ellipse_radius` is that of the ellipse.

        Parameters
        ----------
        angle : float
            Angle of the outward normal from the first semi-axis towards the second, radians.

        Returns
        -------
        (float, float)
            NaN where the outline does not show the place.

        Raises
        ------
        GeometryError
            If the angle is beyond a full turn, as one in degrees is.

        Examples
        --------
        >>> from fingerpad.image import measure_photograph
        >>> from fingerpad.simulate import render_finger
        >>> truth = render_finger("radial", semi_axes=(8, 12), palmar="right", mm_per_px=0.1, seed=1)
        >>> found = measure_photograph(truth.pixels, "radial", Scale(truth.mm_per_px), palmar="right")
        >>> radius, std = found.outline_radius(math.radians(30))
        >>> bool(abs(radius - found.ellipse_radius(math.radians(30))) < 2 * std)
        True
        """
        finite_angle("angle", angle)
        mm_per_px = self.scale.mm_per_px
        points = (self.outline - self.centre) @ self.directions.T
        across, along = map(float, self.semi_axes / mm_per_px)
        radius, std = shape.radius_of_outline(points, (across, along), angle, self.tilt_std)
        return radius * mm_per_px, math.hypot(std * mm_per_px, radius * self.scale.mm_per_px_std)

    def ellipse_radius(self, angle: float) -> float:
        """Return the radius of curvature of the ellipse, mm, at the place that `outline_radius` names."""
        finite_angle("angle", angle)
        across, along = self.semi_axes
        support = math.hypot(across * math.cos(angle), along * math.sin(angle))
        return float((across * along) ** 2 / support**3)

    def side_radii(self) -> list[dict[str, float]]:
        """Return the radii of curvature where wedges of 30, 45 and 60 degrees touch, by outline and ellipse.

        ``wedge_angle_deg``, ``outline_mm``, ``outline_mm_std`` and ``ellipse_mm`` of each place that the
        outline of a side face shows; empty for the other faces.
        """
        if self.face not in ("radial", "ulnar"):
            return []
        seen = [(wedge, *self.outline_radius(math.radians(wedge))) for wedge in (30.0, 45.0, 60.0)]
        return [
            {
                "wedge_angle_deg": wedge,
                "outline_mm": radius,
                "outline_mm_std": std,
                "ellipse_mm": self.ellipse_radius(math.radians(wedge)),
            }
            for wedge, radius, std in seen
            if math.isfinite(radius)
        ]

    def ellipse_points(self, count: int = 361) -> FloatArray:
        """Return so many points (row, column) of the ellipse, px, the first repeated at the end."""
        t = np.linspace(0, 2 * math.pi, count)
        local = np.stack([np.cos(t), np.sin(t)], axis=-1) * self.semi_axes / self.scale.mm_per_px
        return np.asarray(local @ self.directions + self.centre, dtype=np.float64)


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
    average = shape.average_over_shapes(arc, fit)
    ellipse, share = average.ellipse, 1 - average.weight
    scale, semi_px = arc.scale.mm_per_px, ellipse.semi_axes
    tilt_std = math.sqrt(fit.covariance[4, 4])
    terms = {"noise": share * noise * scale**2}
    terms["shape"] = average.covariance * scale**2 - terms["noise"]
    if math.isfinite(arc.blur):
        terms["edge"] = np.full((2, 2), (DOUBT.edge_std * arc.blur * scale) ** 2)
    if not arc.ends_known:
        lengths, turn = shape.contradicted(arc, ellipse, tilt_std, share)
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
    return replace(found, flags=_flags(found))


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


def _flags(found: PhotographFit) -> frozenset[str]:
    """Return what makes a measurement doubtful."""
    arc, semi_px = found._arc, float(found.semi_axes.min()) / found.scale.mm_per_px
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


def size_flags(semi_axes: FloatArray) -> frozenset[str]:
    """Return the flag of semi-axes, mm, that no finger pad has, where it holds."""
    return frozenset({"implausible_size"} if implausible_size(semi_axes).any() else ())
