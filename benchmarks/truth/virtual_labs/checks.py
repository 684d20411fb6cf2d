"""Checks of the simulator against known results, printed below the table."""

import numpy as np

from benchmarks.arrays import Array
from benchmarks.truth.hertz import hertz_ellipse
from benchmarks.truth.true_image import equal_ellipse

from .physics import Contact, Gap, Law, Pad, press
from .pictures import Device, contact_image

RADIUS, THICKNESS = 12.0, 6.0
PAD = Pad(7.9, 13.8, 11.8)
# By a/t and ν: A/(πRξ), and load over Hertz theory at the same ξ; three digits, of the load at a/t = 2 two.
ON_LAYER = {
    (0.1, 0.5): (1.086, 1.12),
    (0.3, 0.5): (1.264, 1.44),
    (0.5, 0.48): (1.427, 1.82),
    (0.5, 0.45): (1.401, 1.76),
    (1.0, 0.5): (1.80, 3.36),
    (1.0, 0.48): (1.75, 3.18),
    (2.0, 0.45): (1.97, 6.3),
}


def _hertz(xi: float) -> float:
    return float(4 / 3 * np.sqrt(RADIUS) * xi**1.5)


def _paraboloid(along: Array, across: Array) -> Array:
    return (along**2 + across**2) / (2 * RADIUS)


def _at(ratio: float, poisson: float, area_ratio: float) -> tuple[Contact, float]:
    """Return the contact at a/t, and its indentation."""
    xi = (ratio * THICKNESS) ** 2 / (RADIUS * area_ratio)
    for _ in range(2):
        area = press(_paraboloid, xi, THICKNESS, poisson).area
        xi *= (np.pi * (ratio * THICKNESS) ** 2 / area) ** 0.75
    return press(_paraboloid, xi, THICKNESS, poisson), xi


def check_simulator() -> list[str]:
    """Return one line for each check; raises AssertionError where one fails."""
    lines: list[str] = []

    def check(what: str, most: float, **errors: float) -> None:
        assert max(map(abs, errors.values())) < most, (what, errors)
        lines.append(f"{what}: " + ", ".join(f"{name} {error:+.2%}" for name, error in errors.items()))

    contact = press(_paraboloid, 0.8, np.inf, 0.5)
    area = contact.area / (np.pi * RADIUS * 0.8) - 1
    check("Hertz, paraboloid", 0.002, load=contact.load / _hertz(0.8) - 1, area=area)
    for wedge, radius in ((45, 9.982357), (30, 13.607666)):
        check(f"1/H at {wedge}°", 2e-4, radius=Gap(PAD, wedge).mean_curvature_radius() / radius - 1)
    contact = press(Gap(PAD, 45), 0.004, np.inf, 0.5)
    low, high = Gap(PAD, 45).curvatures()
    _, F1, F2 = hertz_ellipse(high / low)
    load, area = 4 / 3 / np.sqrt(np.sqrt(low * high) * F2**3), np.pi / np.sqrt(low * high) * F1**2 / F2
    errors = {"load": contact.load / (load * 0.004**1.5) - 1, "area": contact.area / (area * 0.004) - 1}
    check("Hertz, ellipsoid at 45° and ξ = 4 µm", 0.002, **errors)
    for (ratio, poisson), (area_ratio, load_ratio) in ON_LAYER.items():
        contact, xi = _at(ratio, poisson, area_ratio)
        area = contact.area / (np.pi * RADIUS * xi) / area_ratio - 1
        errors = {"area": area, "load": contact.load / _hertz(xi) / load_ratio - 1}
        check(f"layer, a/t = {ratio}, ν = {poisson}", 0.015 if ratio == 2 else 0.01, **errors)
    chi = 0.27
    xi = (chi * THICKNESS) ** 2 / RADIUS
    series = np.polynomial.polynomial.polyval(chi, (1, 1.133, 1.497, 1.469, 0.755))
    load = float(press(_paraboloid, xi, THICKNESS, 0.5).load / _hertz(xi) / series - 1)
    check(f"layer, García & García (2018) at χ = {chi}", 0.003, load=load)

    law, depths = Law(Gap(PAD, 30), 2.8, 8.0, 0.5), np.linspace(0.1, 2.8, 200)
    ratio = 116.3 / (np.pi * float(np.interp(116.3, law.area(depths), depths)))
    check("pad of Dzidek et al. at 30° on 8 mm, 116.3 mm²", 0.005, **{"A/(πξ)": ratio / 20.45 - 1})
    solved = press(Gap(PAD, 30), 0.9, 8.0, 0.5, cells=192)
    errors = {"load": float(law.load(0.9)) / solved.load - 1, "area": float(law.area(0.9)) / solved.area - 1}
    check("interpolated law against 192² cells", 0.003, **errors)
    device = Device.draw("sharp", np.random.default_rng(1))
    outline, profile = law.outline(0.9), np.asarray(law.profile(np.sqrt(0.9)))
    _, mask = contact_image(outline, profile, 1.0, device, 0.0508, rng=np.random.default_rng(2))
    check("rendered", 0.002, area=mask / float(law.area(0.9)) - 1)
    check("ellipse", 0.05, area=np.pi * float(np.prod(equal_ellipse(outline))) / mask - 1)
    return lines
