"""A bone as round as the pad over it, under finite strains: what is read with a flat layer.

Pads are spheres of 12 mm, pressed to 2 N by `benchmarks.truth.curved_bone`. E is read of one contact at that
load with the tissue's true thickness, and of loading curves with that thickness or a fitted one.
"""

from functools import partial
from typing import Final

import numpy as np

from benchmarks.claims.loading_truth import TOP, Condition, make_curve
from benchmarks.tables import not_refused, percent, share, table
from benchmarks.truth.curved_bone import pressed_pad
from benchmarks.truth.loading_physics import Contact, Pad
from fingerpad import Ellipsoid, Estimate, Placement
from fingerpad.contact import youngs_modulus
from fingerpad.loading import fit_layer_thickness, fit_loading_curve

RADIUS: Final = 12.0  # mm
REDUCED: Final = 0.06  # E*, MPa
# Thickness over the pad's radius, ν, and the indentation over the radius that 2 N do not exceed.
CASES: Final = ((0.4, 0.45, 0.2), (0.4, 0.49, 0.2), (0.6, 0.45, 0.27), (0.6, 0.49, 0.27))
PLACEMENT: Final = Placement(Ellipsoid(RADIUS, RADIUS, RADIUS), wedge_angle=0.5)


def fit_errors(contact: Contact, thickness: float, poisson_ratio: float, seed: int) -> dict[str, float]:
    """Return what fits of one curve make of E and t, over the truth, and whether their intervals hold it."""
    rng = np.random.default_rng(seed)
    pad = Pad(radius=RADIUS, modulus=REDUCED)
    curve = make_curve(Condition(contact=lambda _pad, _top: contact), pad, rng.uniform(-2, 2), rng)
    stated = Estimate.symmetric(rng.normal(thickness, 0.05 * thickness), 0.05 * thickness)
    on_stated = fit_loading_curve(curve, thickness=stated, poisson_ratio=poisson_ratio, placement=PLACEMENT)
    fitted = fit_layer_thickness(curve, placement=PLACEMENT, radius_std=0.3, poisson_ratio=poisson_ratio)
    modulus = REDUCED * (1 - poisson_ratio**2)
    found: dict[str, float] = {"flagged": float(bool(on_stated.flags))}
    for name, estimate, true in (
        ("stated", on_stated.youngs_modulus, modulus),
        ("fitted", fitted.youngs_modulus, modulus),
        ("thickness", fitted.thickness, thickness),  # infinite where it is open above
    ):
        found[name] = estimate.value / true - 1
        found[f"{name} held"] = estimate.lower <= true <= estimate.upper
    return found


def report(repeats: int = 12, first_seed: int = 60_000) -> None:
    """Print, of each thickness and ν, the errors of E and of the fitted thickness."""
    columns = (
        "t, mm", "ν", "ξ/t", "E of area, true t", "E of indentation", "E of a curve, true t; held; flagged",
        "E of a curve, t fitted; held", "t fitted over true; held",
    )  # fmt: skip
    rows: list[tuple[object, ...]] = []
    for over_radius, poisson_ratio, deepest in CASES:
        depth, load, area = pressed_pad(over_radius, poisson_ratio, deepest)
        contact = depth * RADIUS, load * REDUCED * RADIUS**2, area * RADIUS**2
        thickness = over_radius * RADIUS
        at_top = [float(np.interp(TOP, contact[1], each)) for each in (contact[2], contact[0])]
        layer = {"thickness": thickness, "poisson_ratio": poisson_ratio, "load": TOP}
        modulus = REDUCED * (1 - poisson_ratio**2)
        by_area = float(youngs_modulus(PLACEMENT, area=at_top[0], **layer)) / modulus - 1
        by_depth = float(youngs_modulus(PLACEMENT, indentation=at_top[1], **layer)) / modulus - 1
        measure = partial(fit_errors, contact, thickness, poisson_ratio)
        fits, _ = not_refused(measure, range(first_seed, first_seed + repeats))
        middle = fits.median()
        rows.append(
            (
                f"{thickness:.1f}",
                poisson_ratio,
                f"{at_top[1] / thickness:.2f}",
                percent(by_area, "+"),
                percent(by_depth, "+"),
                f"{percent(middle['stated'], '+')}; {share(fits['stated held'])}; {share(fits['flagged'])}",
                f"{percent(middle['fitted'], '+')}; {share(fits['fitted held'])}",
                f"{1 + middle['thickness']:.2g}; {share(fits['thickness held'])}",
            )
        )
    table(columns, rows, f"Medians of {repeats} curves each; held by 95 % intervals")
