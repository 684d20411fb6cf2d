"""Where results come from: versions, input hashes, and the formulas used."""

import hashlib
import platform
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

import numpy as np
import scipy

import fingerpad

FORMULAS: Final = {
    "mean_curvature_radius": "1/H, H from the shape operator of the ellipsoid; equals ESM Eq. (1)",
    "geometric_mean_radius": "sqrt(R'R''), Johnson (4.25)",
    "radius_from_indentation": "R_0g F2^-3; what ESM Eq. (2) means, with Johnson's F2 (4.26c)",
    "radius_from_area": "R_0g F1^3, Johnson's F1 (4.29)",
    "radius_from_compliance": "R_0g F1^2/F2; matches R_g, the slope of A against pi xi",
    "indentation": "A/(pi R_e F1^2/F2), Johnson (4.26)",
    "reduced_modulus": "3 W R_e F1^3/(4 (l_d l_e)^(3/2)), Johnson (4.26a)",
    "effective_radius": "slope of contact area against pi xi, least squares, intercept free",
    "uncertainty": "first order, J S J^T (GUM Eq. 13), central differences",
    "pooled": "inverse-variance mean; standard uncertainty times the Birge ratio where it exceeds one",
}


def provenance(folder: Path, files: Iterable[str]) -> dict[str, Any]:
    """Return what is needed to repeat a run: versions, SHA-256 of every input file, formulas."""
    return {
        "fingerpad": fingerpad.__version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "inputs_sha256": {
            name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in sorted(set(files))
        },
        "formulas": FORMULAS,
    }
