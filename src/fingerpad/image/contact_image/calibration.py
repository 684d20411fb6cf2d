"""Constants that were fitted to contact images of known truth (benchmarks/derive), one class per model.

Thresholds that are plain choices stand beside the functions that use them. Units: "periods" are ridge
periods; "rises" are parts of the rise from valley to ridge; "contrasts" are parts of the interior's contrast
with the ground.
"""

from dataclasses import dataclass
from typing import Final, TypeAlias

# From and to, periods outward of the outline of the closed ridges; below 0 inside.
Band: TypeAlias = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class EdgeModel:
    """How far the edge of a contact lies beyond the closed ridges, and how uncertain that is."""

    # How far the edge lies further out than the outline.
    ends: float = 0.084  # periods; between the ends of ridges
    sharp: float = -0.272  # periods more; for a contact that does not fade, with nothing seen outside
    by_thinning: float = 0.64  # periods; by how much less ridge the last period has than the one before
    by_outside: float = 1.45  # periods; by the ridges just outside in parts of those inside
    by_blur: float = 0.24  # that part counts up to this, which blur shows at a sharp edge too,
    by_blur_and_beyond: float = 6.0  # and up to so much more by the ridges beyond, a contrast
    by_beyond: float = 3.6  # periods a contrast; by the ridges beyond
    by_paleness: float = 2.0  # periods a contrast; by how much less than usual the last period has
    least_usual: float = 0.42  # contrasts; the last period of a contact has, unless pressure falls off slowly
    by_rim: float = -0.3  # periods; where a rim covers all ridges
    by_steepness: float = 2.0  # periods; by how much more the last period thins
    usual_thinning: float = 0.25  # than this, the most of contacts whose pressure does not fall off slowly

    # Where that is looked at.
    ground: Band = (2.0, 3.0)  # the ground
    interior_depth: float = 3.5  # periods; the interior is deeper
    inside: Band = (-0.8, -0.2)  # the last period
    deeper: Band = (-1.6, -0.8)  # the one before
    outside: Band = (0.1, 0.3)  # ridges just outside
    beyond: Band = (0.4, 0.7)  # ridges beyond
    off: Band = (0.9, 1.2)  # a rim has ended, and a halo is still a third of what it is just outside
    rim: Band = (-1.2, -0.4)  # contrast round the outline, and whether there are ridges
    near: Band = (0.0, 0.5)  # contrast just outside
    along: float = 2.0  # periods; ridges are what varies along the outline over less than this
    sectors: int = 24  # parts of the outline whose means are compared
    trimmed: float = 0.2  # share of the sectors at either end that does not count
    least: float = 0.03  # contrasts; variations and means are no less
    hardly: float = 0.01  # contrasts; so little beyond does not move the edge: noise leaves it
    bare: float = 0.45  # of the interior's variation; with less there are no ridges along the outline

    # Standard deviation that all of the edge shares.
    shared_std: float = 0.07  # periods; at least
    small_std: float = 1.4  # periods; over the root of the area in periods: light touch leaves edges bare
    beyond_std: float = 2.1  # periods a contrast; by the ridges beyond
    rim_std: float = 0.34  # periods; where a rim covers all ridges
    paleness_std: float = 2.5  # periods a contrast; by how much less than usual the last period has
    steepness_std: float = 3.0  # periods; by how much more than usual it thins
    unevenness_std: float = 0.5  # periods a contrast; by how uneven the contrast just outside is

    # Standard deviation by which the edge varies within one image.
    varies: float = 0.8  # share of the shared deviation
    alike: float = 0.25  # share of the outline over which it is the same
    lack_std: float = 1.0  # periods a contrast; by how the contrast of the rim differs from elsewhere


@dataclass(frozen=True, slots=True, kw_only=True)
class RidgeLevel:
    """The level above which a place is ridge, at the resolution of the picture."""

    # Means along the ridges.
    direction: float = 0.6  # periods; directions are averaged over this
    sample: float = 0.35  # periods; between samples of a mean

    # Levels of valleys and ridges.
    reach: float = 1.1  # periods; they are the extremes within this
    smoothing: float = 1.0  # periods; smoothed over this

    # The level of dry ridges without pores is half.
    filled: float = 0.01  # rises above half; pores, and sweat beside ridges, are too fine to see

    # Shift of the level from there by blur: near that of a square wave under a Gaussian of 0.1 periods.
    by_blur: float = 0.45  # rises; by how far the share of ridges is from half, times its change with level
    cubic: float = 30.0  # by the cube of the same
    near_half: float = 0.1  # rises; the change is taken within this of half

    # Shift by grain, as if half of it were faint contact; the rest may be gaps.
    crest: float = 0.7  # rises; ridges above vary more than valleys below its mirror
    usual_grain: float = 0.12  # rises; that pores and blur make
    by_grain: float = 0.4  # rises a rise of more grain


@dataclass(frozen=True, slots=True, kw_only=True)
class RidgeAreaError:
    """Standard uncertainty of the ridge area inside a given outline, as a share of it."""

    # The level's: its effect is that times the change of the area with the level.
    level_std: float = 0.03  # rises
    # Mottle in broad, blurred ridges may be of ink or paper.
    by_grain: float = 3.0  # by grain times the change of the ridges' share of the contact with their level
    usual_grain: float = 0.06  # that pores and blur make
    most_grain: float = 0.1  # more than that tells no more

    # The area's own.
    least_std: float = 0.008  # where the level does not matter
    by_rim: float = 0.4  # where a rim covers all ridges
    by_fade: float = 0.1  # a period by which a fading edge lies further out
    sharp_fade: float = 0.08  # periods; fade of a sharp edge
    most_fade: float = 0.2  # periods; more than that tells no more
    by_moisture: float = 2.5  # by the share of ridges above that of dry ones: sweat or ink may fill valleys
    dry_share: float = 0.54  # of the contact that dry ridges fill
    wet_share: float = 0.58  # more than that tells no more
    by_thinness: float = 1.5  # by the share of ridges below this: blur takes narrow ones, or widens them
    thin_share: float = 0.34  # of the contact

    at_rim: float = 0.5  # how much of a strip at the outline is ridge, relative to the interior


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedMarks:
    """Letters in the contact. Real prints have no such dark place of more than 1.2 periods."""

    around: float = 10.0  # periods; they are darker than the ridges within this
    darker: float = 1.1  # by this factor
    stroke: float = 0.4  # periods; least width of their strokes
    reach: float = 2.0  # periods; least reach of a stroke along and across
    minimum: int = 3  # strokes; fewer are no print


@dataclass(frozen=True, slots=True, kw_only=True)
class SmoothModel:
    """The edge of a contact without ridges: what counts as one, and how uncertain its place is."""

    # What counts as a contact.
    least_contrast: float = 3.0  # spreads of the ground around it
    low_contrast: float = 5.0  # spreads; less is flagged
    crest_contrast: float = 0.5  # of these where the edge is a crest, whose foot reaches far
    least_score: float = 0.3  # share; clearness of the step
    least_score_cut: float = 0.25  # share; of one that the frame cuts
    least_seen: float = 0.8  # share of the outline
    most_shared: float = 0.03  # of the radius

    # Standard deviation that all of the edge shares.
    pixel: float = 0.3  # px
    by_width: float = 0.08  # of the step's width
    sharp: float = 4.0  # px; width of the step that a sharp camera shows
    by_wider: float = 0.2  # of what the step is wider, as squares: by blur, or by a film
    by_scatter: float = 5.5  # of the scatter along the outline: a wet rim wobbles
    second: float = 0.3  # of the distance of a second edge
    hidden: float = 0.07  # of the radius, where nothing of the edge is seen
    cut: float = 0.42  # of the radius, where the frame cuts the contact
    beyond: float = 0.4  # of the step's height; where levels beyond it differ by more, a reflection may lie
    straight: float = 0.1  # of the mean curvature; an outline that bends less there follows the reflection
    reflected: float = 0.15  # of the radius, where it does

    # A crest instead of a step: the slope of a gel.
    crest: float = 0.3  # of its width; the edge lies so far outside, inside where the crest is narrow
    crest_std: float = 0.2  # of its width

    # Fringes outside.
    least_overshoot: float = 0.15  # of the step's height
    fringe: float = 1.25  # of the distance of the first; the edge lies so far inside
    fringe_blur: float = 0.2  # of the step's height; less by half where blur leaves so much of it
    fringe_std: float = 0.25  # of that distance
    rim: float = 0.4  # of that distance; where the step is narrower, a film's rim lies there and no fringe

    # A film of water outside, whose step blur has joined to that of the contact.
    even_begin: float = 0.45  # of the step's width; blur alone lets the fall begin no farther inside
    film_begin: float = 0.15  # of that width; where it begins so much farther inside, a film is certain
    film: float = 1.1  # of that distance; the edge lies so far inside
    film_std: float = 0.4  # of that distance


EDGE: Final = EdgeModel()
RIDGE_LEVEL: Final = RidgeLevel()
RIDGE_AREA: Final = RidgeAreaError()
PRINTED_MARKS: Final = PrintedMarks()
SMOOTH: Final = SmoothModel()
