"""By how much a pad's radii of curvature may differ from those of the ellipsoid of its photographs."""

import math
from typing import Final

# Relative standard deviation of a finger's radius of curvature at one place from that of the ellipsoid that
# follows its outlines; more where the outline hides that place. See benchmarks/finger_shapes.py.
ELLIPSOID_STD: Final = 0.1
HIDDEN_STD: Final = 0.2


def radius_deviation(
    ellipsoid: float, ellipsoid_std: float, outline: float, outline_std: float
) -> tuple[float, float]:
    """Return how far a radius of curvature lies from the ellipsoid's, by the outline, and how far it may.

    The outline shows the radius at the place itself, and the ellipsoid knows it only as far as fingers are
    ellipsoids, to 10 %, or to what the two differ by beyond the outline's uncertainty. Both are averaged as
    logarithms with weights of their inverse variances.

    Parameters
    ----------
    ellipsoid, ellipsoid_std : float
        Radius of the ellipsoid and its standard uncertainty.
    outline, outline_std : float
        Radius of the outline and its standard uncertainty, NaN where it does not show the place.

    Returns
    -------
    (float, float)
        Deviation of the logarithm from the ellipsoid's, and the standard uncertainty that it has beside the
        ellipsoid's own.

    Examples
    --------
    >>> deviation, std = radius_deviation(15.0, 0.1, 15.3, 1.2)
    >>> round(deviation, 3), round(std, 3)
    (0.012, 0.061)
    >>> deviation, std = radius_deviation(15.0, 0.1, 22.0, 1.8)
    >>> round(deviation, 2), round(std, 2)
    (0.37, 0.08)
    """
    if not math.isfinite(outline):
        return 0.0, HIDDEN_STD
    own, seen = (ellipsoid_std / ellipsoid) ** 2, (outline_std / outline) ** 2
    apart = math.log(outline / ellipsoid)
    model = max(own + ELLIPSOID_STD**2, apart**2 - seen)
    return apart * model / (model + seen), math.sqrt(max(model * seen / (model + seen) - own, 0.0))
