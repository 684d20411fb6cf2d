"""Constants of photographs that were fitted to fingers of known truth (benchmarks/derive)."""

import math
from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeDoubt:
    """How far fingers depart from ellipses, and what that adds to the uncertainty of their semi-axes."""

    # What is known of fingers beforehand.
    exponent_std: float = 0.3  # of the exponents of all quadrants from 2
    quadrant_std: float = 0.15  # of the exponent of one quadrant from the others
    log_odds: float = math.log(3)  # that a finger is no ellipse
    width_std: float = 0.04  # relative; half of the width from the semi-axis across the pad

    # The comparison with a superellipse.
    widening: float = 2.0  # its standard uncertainties over what its points tell
    floor: float = 0.03  # relative; semi-axes of a superellipse are no surer
    rough_std: float = 0.08  # relative; of an ellipse where too few points tell its shape
    significant: float = 3.0  # standard uncertainties of the exponent from 2
    least_significant: float = 0.05  # of the exponent from 2, to be significant

    # The points.
    edge_std: float = 0.45  # blurs of the edge; skin and backdrop shift all of it alike
    least_px: float = 0.12  # px; standard deviation of a block of points at least
    far: float = 4.0  # standard deviations; farther off, a point counts but linearly
    most_alike: float = 0.6  # correlation of neighbouring blocks that is believed at most


@dataclass(frozen=True, slots=True, kw_only=True)
class LengthDoubt:
    """How far an outline's own lengths lie from an ellipse's semi-axes.

    A shaft that widens below hides the pad's widest place; where the pad is no ellipse, what is wider may
    well be pad, and hides as much as it adds.
    """

    side_across_std: float = 0.015  # relative, on an ellipse; across in a side face
    side_along_std: float = 0.02  # relative, on an ellipse; along in a side face
    front_across_std: float = 0.01  # relative, on an ellipse; across in the other faces
    front_along_std: float = 0.015  # relative, on an ellipse; along in the other faces
    side_axis_std: float = math.radians(1.0)  # radians; a side face's axis beyond the ellipse's own
    shaft: float = 0.06  # relative; a shaft is commonly that much wider than the pad
    hidden: float = 3.0  # half of the width is off by so many times what the shaft hides
    height_by_width: float = 5.0  # the height is off by so many times what the width is
    of_tilt_std: float = 0.5  # of the axis's standard uncertainty; turns that are common
    added: float = 0.7  # share of what contradicts the ellipse
    no_ellipse: float = 0.04  # relative; a length so far off shows that it is none

    # Where the outline turns back.
    window: float = 0.35  # radii of curvature on either side
    seen: float = 0.6  # share of the window with points, on either side


@dataclass(frozen=True, slots=True, kw_only=True)
class RadiusDoubt:
    """How an outline's radius of curvature is fitted, and what the fit misses."""

    window: float = 0.35  # radii of curvature on either side
    degree: int = 3  # of the polynomial in it
    seen: float = 0.85  # share of the window with points, on either side
    missed_std: float = 0.06  # relative; by changes of curvature in the window
    axis_std: float = math.radians(2.5)  # radians; the finger's axis from the ellipse's, beyond its own


DOUBT: Final = ShapeDoubt()
LENGTHS: Final = LengthDoubt()
RADIUS: Final = RadiusDoubt()
