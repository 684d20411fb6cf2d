"""R_g of Dzidek et al. (2017) by one layer of tissue on bone: its thickness, and what follows from it."""

from collections.abc import Callable

import numpy as np

from benchmarks.arrays import Array
from benchmarks.tables import table
from fingerpad.contact import Tissue, fast_contact
from fingerpad.geometry import Placement
from fingerpad.published import dzidek2017, fit_tissue_thickness
from fingerpad.published.dzidek2017 import PublishedWedge

_SOURCE = dzidek2017()
WEDGES = _SOURCE.wedges


def loading_of(placement: Placement, tissue: Tissue, area: Array) -> tuple[Array, Array, Array, Array]:
    """Fit 64 evenly spaced loads up to the one that gives the area; NaN beyond the range of the laws.

    Returned are slopes of A against πξ with an intercept and without, n of A ∝ W^n and m of W ∝ ξ^m.
    """
    highest = fast_contact(placement, tissue, area=area).load
    loads = np.multiply.outer(np.linspace(0, 1, 65)[1:], highest)
    contact = fast_contact(placement, tissue, load=loads)
    x, y = np.pi * contact.indentation, contact.area
    through_origin = np.sum(x * y, axis=0) / np.sum(x * x, axis=0)
    log_load, log_x, log_y = np.log(loads), np.log(x), np.log(y)
    return _slope(x, y), through_origin, _slope(log_load, log_y), _slope(log_x, log_load)


def _slope(x: Array, y: Array) -> Array:
    """Return the slope of y on x over the first axis, by least squares."""
    deviation = x - x.mean(axis=0)
    return np.sum(deviation * y, axis=0) / np.sum(deviation**2, axis=0)


# How R_g is read from a placement, tissue and contact area.
READINGS: dict[str, Callable[[Placement, Tissue, Array], Array]] = {
    "ratio": lambda pad, tissue, area: fast_contact(pad, tissue, area=area).area_over_pi_indentation,
    "slope": lambda *pressed: loading_of(*pressed)[0],
    "slope_through_origin": lambda *pressed: loading_of(*pressed)[1],
}


def placed(method: str, wedge: PublishedWedge) -> Placement:
    """Return the printed pad on its wedge."""
    pad = _SOURCE.semi_axes[method].ellipsoid
    return Placement(pad, wedge_angle=np.radians(wedge.wedge_angle_deg))


def thicknesses() -> None:
    """Print the fitted thickness over axes, reading of R_g and ν, each also of one angle alone."""
    rows = []
    for method in ("ellipse", "direct"):
        for name, reading in READINGS.items():
            for nu in (0.5, 0.48, 0.45):
                fit = fit_tissue_thickness(method=method, reading=reading, poisson_ratio=nu)
                low, high = fit.interval_mm
                numbers = f"{fit.thickness_mm:.1f}", f"{low:.1f} to {high:.1f}", f"{fit.chi_square:.2f}"
                alone = ", ".join(f"{one:.1f}" for one in fit.thickness_by_angle_mm)
                rows.append((method, name.replace("_", " "), nu, *numbers, alone))
    head = "semi-axes", "R_g read as", "ν", "t (mm)", "95 %", "χ²", "t at 30°, at 45°"
    table(head, rows, "Thickness of the layer")
    parts = ", ".join(f"{name} {one:.2f}" for name, one in fit_tissue_thickness().contribution_mm.items())
    print(f"\nOf the standard uncertainty of t, {fit_tissue_thickness().std_mm:.2f} mm, come from: {parts}.")


def consequences() -> None:
    """Print what follows from the fitted thickness without another fit."""
    rows = []
    fitted = fit_tissue_thickness().thickness_mm
    for name, thickness in (("half-space", np.inf), (f"{fitted:.1f} mm", fitted)):
        for angle, wedge in WEDGES.items():
            place, area = placed("ellipse", wedge), np.array(wedge.area_mm2.value)
            contact = fast_contact(place, Tissue.of_reduced_modulus(1.0, thickness=thickness), area=area)
            *slopes, n, m = loading_of(place, Tissue(1.0, thickness=thickness), area)
            ratio = float(contact.aspect_ratio if contact.along else 1 / contact.aspect_ratio)
            radii = ", ".join(f"{one:.1f}" for one in (contact.area_over_pi_indentation, *slopes))
            cells = radii, f"{1e3 * wedge.load_N / contact.load:.0f}", f"{n:.2f}, {m:.2f}", f"{ratio:.2f}"
            late = ", ".join(f"{one:.1f}" for one in _with_other_depth(place, wedge))
            rows.append((f"{name}, {angle}°", *cells, late))
    head = "tissue", "R_g as ratio, slope, slope through origin (mm)", "E* (kPa)", "n of A ∝ Wⁿ, m of W ∝ ξᵐ"
    table((*head, "along over across", "t with ξ wrong by ∓0.1 mm"), rows, "At the printed area")


def _with_other_depth(place: Placement, wedge: PublishedWedge) -> list[float]:
    """Return the thickness that one angle gives where the place of first contact is wrong."""
    area, depths = wedge.area_mm2.value, np.linspace(4, 14, 1001)
    indentation = area / (np.pi * wedge.measured_radius_mm.value)
    ratio = fast_contact(place, Tissue(1.0, thickness=depths), area=area).area_over_pi_indentation
    radii = [area / (np.pi * (indentation + error)) for error in (-0.1, 0.1)]
    return [float(np.interp(-radius, -ratio, depths)) for radius in radii]


def report() -> None:
    """Print both tables."""
    thicknesses()
    consequences()
