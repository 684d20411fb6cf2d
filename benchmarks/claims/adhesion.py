"""Coverage of the law of JKR on records that no closed law made.

Records are those of `adhesion_truth`: contact energy from Boussinesq's kernel, a machine's spring, and a
contact line that moves downhill. The radius is exact, so that nothing but the fit is tried; w is that of the
way out.
"""

from typing import Any

import numpy as np

from benchmarks.tables import percent, table
from benchmarks.truth.adhesion import KINDS, records
from fingerpad.exceptions import FingerpadError
from fingerpad.loading import LawFit, LoadingCurve, fit_adhesion


def fit_record(record: dict[str, Any]) -> LawFit | None:
    """Return the fit of one record, None where it is refused."""
    truth = record["truth"]
    curve = LoadingCurve(time=record["time_s"], load=record["force_n"], indentation=record["displacement_mm"])
    compliance = truth["machine_compliance_mm_per_n"] if truth["displacement_is_stage"] else None
    try:
        return fit_adhesion(
            curve,
            poisson_ratio=truth["poisson"],
            loading_radius=truth["radius_mm"],
            stage_compliance=compliance,
        )
    except FingerpadError:
        return None


def judged(record: dict[str, Any]) -> dict[str, float]:
    """Return whether the intervals of one record hold the truth, its flags, and E of Hertz over E."""
    fit, truth = fit_record(record), record["truth"]
    if fit is None or not all(found.known for found in fit.parameters.values()):
        return {"refused": 1.0}
    modulus, work = fit.parameters["youngs_modulus"], fit.parameters["work_of_adhesion"]
    place = fit.contact_offset
    held = {
        "E": modulus.lower <= truth["modulus_mpa"] <= modulus.upper,
        "w": work.lower <= truth["work_retract_n_per_mm"] <= work.upper,
        "x0": place.lower <= truth["contact_displacement_mm"] <= place.upper,
    }
    hertz = fit.models["hertz"].values["youngs_modulus"] if "hertz" in fit.models else np.nan
    return {
        "refused": 0.0,
        **{name: float(inside) for name, inside in held.items()},
        "flagged": float(bool(fit.flags)),
        "silent": float(not (held["E"] and held["w"]) and not fit.flags),
        "E std": modulus.std / modulus.value,
        "w std": work.std / work.value,
        "hertz": hertz / truth["modulus_mpa"],
    }


def report(count: int = 20, seed: int = 23) -> None:
    """Print one line per kind of record."""
    names = "E", "w", "x0", "flagged", "silent"

    def cells(kind: str) -> tuple[object, ...]:
        found = [judged(record) for record in records(seed=seed, count=count, kind=kind)]
        fitted = [one for one in found if not one["refused"]]
        if not fitted:
            return kind, f"{len(found)} of {len(found)}", *8 * ("–",)
        shares = [f"{sum(one[name] for one in fitted):.0f}" for name in names]
        modulus, work, hertz = (
            float(np.nanmedian([one[name] for one in fitted])) for name in ("E std", "w std", "hertz")
        )
        refused = f"{len(found) - len(fitted)} of {len(found)}"
        return kind, refused, *shares, percent(modulus), percent(work), f"{hertz:.2f}"

    held = "E held", "w held", "x₀ held", "flagged", "silent"
    table(("records", "refused", *held, "± E", "± w", "E of Hertz theory / E"), map(cells, KINDS))
