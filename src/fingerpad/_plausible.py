"""Input that no finger gives, and what it looks like: another unit, or widths in place of semi-axes."""

from collections.abc import Iterator, Sequence
from typing import Final

from fingerpad._loading_curve import LoadingCurve

MOST_N: Final = 100.0  # of a press with one finger
_MOST_MM, _MOST_MM2 = 60.0, 3000.0  # of travel, and of contact
# Half of 30 mm: thumbs of British men are 23 ± 2 mm wide and 22 ± 2 mm thick at the joint (Pheasant 1996), so
# that fewer than one in a thousand is as large. Whole widths of most adult fingers are larger.
_MOST_SEMI_AXIS_MM: Final = 15.0


def semi_axes_doubt(semi_axes_mm: Sequence[float]) -> str:
    """Return what palmar, distal and radial–ulnar semi-axes look like, empty where they can be a finger's.

    Examples
    --------
    >>> semi_axes_doubt((7.9, 13.8, 11.8))
    ''
    >>> semi_axes_doubt((15.0, 28.4, 23.0))
    'radial_ulnar 23 mm: a finger 46 mm wide; semi-axes are half of the widths that a caliper shows'
    """
    palmar, _, radial_ulnar = semi_axes_mm
    name, value, across = max(
        ("palmar", palmar, "thick"), ("radial_ulnar", radial_ulnar, "wide"), key=lambda x: x[1]
    )
    if value <= _MOST_SEMI_AXIS_MM:
        return ""
    return (
        f"{name} {value:g} mm: a finger {2 * value:g} mm {across}; semi-axes are half of the widths that a "
        "caliper shows"
    )


def curve_doubts(curve: LoadingCurve) -> Iterator[str]:
    """Yield which quantities of a loading curve look as if they were in another unit."""
    load, travel = float(curve.load.max()), float(curve.indentation.max() - curve.indentation.min())
    if load > MOST_N:
        yield f"loads up to {load:.0f} N: is the force in millinewtons (force_mN)?"
    if travel > _MOST_MM:
        yield f"a travel of {travel:.0f} mm: is the displacement in micrometres (displacement_um)?"
    if curve.area is not None and curve.area.max() > _MOST_MM2:
        yield f"areas up to {curve.area.max():.0f} mm²: are they in another unit?"
