"""Where results come from: versions, input hashes, and the formulas used."""

import platform
from collections.abc import Callable, Iterable
from datetime import UTC, datetime
from typing import Any, Final

import fingerpad
from fingerpad.study.engine.versions import MEASUREMENT_VERSIONS, library_versions

FORMULAS: Final = {
    "contact_edge": "where the pressure vanishes: the outline at half the ridges' local contrast, moved out "
    "by what the contrast within 1.33 ridge periods of it, over the interior's, tells of fading",
    "mean_curvature_radius": "R₀g = 1/H, H from the ellipsoid's shape operator, ESM Eq. (1); of fingers with "
    "photographs the radius along the finger is the mean of the ellipsoid's and the outline's, weighted by "
    "inverse variances, and the uncertainty contains that of the pad's shape",
    "geometric_mean_radius": "R_e = √(R′R″), Johnson (4.25)",
    "radius_from_indentation": "R₀g F₂⁻³, what ESM Eq. (2) means, with Johnson's F₂ (4.26c)",
    "radius_from_area": "R₀g F₁³, Johnson's F₁ (4.29)",
    "radius_from_compliance": "R₀g F₁²/F₂, which matches R_g, the slope of A against πξ",
    "indentation": "ξ = A/(π R_e F₁²/F₂), Johnson (4.26)",
    "reduced_modulus": "E* = 3 W R_e F₁³/(4 (ℓd ℓe)^(3/2)), Johnson (4.26a)",
    "loading_radius": "R_g of A = π R_g ξ, fitted together with the force, F = W(ξ) + zero + drift",
    "uncertainty": "J Σ Jᵀ (GUM Eq. 13), J by complex steps, with the second-order term of each input; or "
    "Monte Carlo (GUM Supplement 1)",
    "pooled": "inverse-variance mean; its standard uncertainty times the Birge ratio where that exceeds one, "
    "and with what contacts share added. The frames of a sequence count as one contact",
}


def provenance(files: Iterable[str], digest: Callable[[str], str]) -> dict[str, Any]:
    """Return what is needed to repeat a run: versions, SHA-256 of every input by `digest`, formulas."""
    return {
        "fingerpad": fingerpad.__version__,
        "python": platform.python_version(),
        "libraries": library_versions(),
        "measurement_versions": dict(MEASUREMENT_VERSIONS),
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "inputs_sha256": {name: digest(name) for name in sorted(set(files))},
        "formulas": FORMULAS,
    }
