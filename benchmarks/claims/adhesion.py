"""Coverage of the law of JKR on records that no closed law made.

Records are those of `benchmarks.truth.adhesion`: the energy of a bonded disc, a machine's spring,
and a contact line that moves downhill. The radius is exact, so that nothing but the fit is tried; w is that
of the way out.
"""

from typing import Any

import numpy as np
import pandas as pd

from benchmarks.tables import or_none, percent, table
from benchmarks.truth.adhesion import KINDS, POISSON, Record, records
from fingerpad.loading import LoadingCurve, fit_adhesion


def judged(record: Record) -> dict[str, float]:
    """Return whether the intervals of one record hold the truth, its flags, and E of Hertz over E."""
    curve = LoadingCurve(time=record.time, load=record.force, indentation=record.displacement)
    known: dict[str, Any] = {"stage_compliance": record.compliance} if record.is_stage else {}
    fit = or_none(fit_adhesion, curve, poisson_ratio=POISSON, loading_radius=record.radius, **known)
    if fit is None or not all(found.known for found in fit.parameters.values()):
        return {"refused": 1.0}
    modulus, work = fit.parameters["youngs_modulus"], fit.parameters["work_of_adhesion"]
    pairs = {"E": modulus, "w": work, "x0": fit.contact_offset}
    truths = record.modulus, record.work_of_adhesion, record.contact_offset
    held = {
        name: float(one.lower <= true <= one.upper)
        for (name, one), true in zip(pairs.items(), truths, strict=True)
    }
    hertz = fit.models["hertz"].values["youngs_modulus"] if "hertz" in fit.models else np.nan
    return held | {
        "refused": 0.0,
        "flagged": float(bool(fit.flags)),
        "silent": float(not (held["E"] and held["w"]) and not fit.flags),
        "E std": modulus.std / modulus.value,
        "w std": work.std / work.value,
        "E off": modulus.value / record.modulus - 1,
        "hertz": hertz / record.modulus,
    }


def report(count: int = 20, seed: int = 23) -> None:
    """Print one line per kind of record."""

    def cells(kind: str) -> tuple[object, ...]:
        found = pd.DataFrame([judged(record) for record in records(seed, count, kind)])
        fitted = found[found["refused"] == 0]
        refused = f"{len(found) - len(fitted)} of {len(found)}"
        if fitted.empty:
            return KINDS[kind], refused, *9 * ("–",)
        shares = (f"{fitted[name].sum():.0f}" for name in ("E", "w", "x0", "flagged", "silent"))
        modulus, work, hertz = fitted[["E std", "w std", "hertz"]].median()
        off = " to ".join(percent(one, "+") for one in fitted["E off"].agg(["min", "max"]))
        return KINDS[kind], refused, *shares, off, percent(modulus), percent(work), f"{hertz:.2f}"

    head = "records, refused, E held, w held, x₀ held, flagged, silent, errors of E, ± E, ± w"
    table((*head.split(", "), "E of Hertz theory / E"), map(cells, KINDS))
