"""Input that no finger gives, and what it looks like: another unit or order, or widths for semi-axes."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:  # NumPy is slow to import, and a command says its help without it
    from fingerpad._arrays import FloatArray

MOST_N: Final = 100.0  # of a press with one finger
_MOST_MM, _MOST_MM2 = 60.0, 3000.0  # of travel, and of contact
LEAST_SEMI_AXIS_MM: Final = 2.0
# Half of a distal phalanx 30 mm across. Plausibility, no statistic: the pad of Dzidek et al. (2017) has 7.9
# and 11.8 mm, and we know of no survey of pads; what is larger is noted, and measured all the same.
_MOST_SEMI_AXIS_MM: Final = 15.0
_MOST_FLATTENED: Final = 1.2  # palmar over another semi-axis; below 1 on a finger, about 1 on a sphere
_LEAST_LONG: Final = 0.8  # distal over radial–ulnar; above 1 on a finger
PLAUSIBLE_MODULUS_KPA: Final = (1.0, 5000.0)  # Young's modulus
# Of tissue over bone at a fingertip, with room on both sides: outside, the unit is wrong.
PLAUSIBLE_THICKNESS_MM: Final = (0.5, 50.0)


def semi_axes_doubt(semi_axes_mm: Sequence[float]) -> str:
    """Return what palmar, distal and radial–ulnar semi-axes look like, empty where they can be a finger's."""
    palmar, distal, radial_ulnar = semi_axes_mm
    value, name, across = max((palmar, "palmar", "thick"), (radial_ulnar, "radial_ulnar", "wide"))
    if value > _MOST_SEMI_AXIS_MM:
        return (
            f"{name} {value:g} mm would be a finger {2 * value:g} mm {across}: are these full widths? "
            "Semi-axes are half of them"
        )
    if min(semi_axes_mm) < LEAST_SEMI_AXIS_MM:
        return f"{min(semi_axes_mm):g} mm is less than any pad has: semi-axes are in millimetres"
    other, name = min((distal, "distal"), (radial_ulnar, "radial_ulnar"))
    if palmar > _MOST_FLATTENED * other:
        return f"palmar {palmar:g} mm is more than {name} {other:g} mm, as of no finger: are the two swapped?"
    if distal < _LEAST_LONG * radial_ulnar:
        more = f"radial_ulnar {radial_ulnar:g} mm is more than distal {distal:g} mm"
        return f"{more}, as of no finger: are the two swapped?"
    return ""


def thickness_doubt(thickness_mm: float) -> str:
    """Return what a thickness looks like, empty where it can be a fingertip's or is that of a half-space."""
    if PLAUSIBLE_THICKNESS_MM[0] <= thickness_mm <= PLAUSIBLE_THICKNESS_MM[1] or thickness_mm == math.inf:
        return ""
    return f"{thickness_mm:g} mm of tissue over bone, as of no fingertip: is the thickness in another unit?"


def in_radians(angle_deg: float) -> bool:
    """Return whether an angle that should be in degrees looks as if it were in radians."""
    return 0 < angle_deg < math.pi / 2


def load_doubts(load: float, modulus_kpa: float) -> Iterator[str]:
    """Yield what a load, N, and Young's modulus look like, nothing where they can be a finger's."""
    if load > MOST_N:
        yield f"more than {MOST_N:g} N: is the load in millinewtons?"
    if not PLAUSIBLE_MODULUS_KPA[0] <= modulus_kpa <= PLAUSIBLE_MODULUS_KPA[1]:
        yield "Young's modulus lies outside 1–5000 kPa: check load and units"


def unit_doubts(
    load: "FloatArray", displacement: "FloatArray | None" = None, area: "FloatArray | None" = None
) -> Iterator[str]:
    """Yield which quantities of one press, in N, mm and mm², look as if they were in another unit."""
    if load.max() > MOST_N:
        yield f"loads up to {load.max():.0f} N: is the force in millinewtons (force_mN)?"
    if displacement is not None and (travel := displacement.max() - displacement.min()) > _MOST_MM:
        yield f"a travel of {travel:.0f} mm: is the displacement in micrometres (displacement_um)?"
    if area is not None and (area > _MOST_MM2).any():
        yield f"areas up to {area[area > _MOST_MM2].max():.0f} mm²: are they in another unit?"
