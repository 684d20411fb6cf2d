"""Checks of the simulator against known results, printed before the table."""

import numpy as np

from .physics import Gap, Law, Pad, Paraboloid, ellipse_of, elliptic_hertz, press
from .pictures import Device, contact_image


def check_simulator() -> list[str]:
    """Return one line for each check; raises AssertionError where one fails."""
    lines = []
    radius = 12.0
    contact = press(Paraboloid(radius), 0.8, np.inf, 0.5)
    errors = (
        contact.load / (4 / 3 * np.sqrt(radius) * 0.8**1.5) - 1,
        contact.area / (np.pi * radius * 0.8) - 1,
    )
    assert max(map(abs, errors)) < 0.002, errors
    lines.append(f"Hertz, paraboloid: load {errors[0]:+.2%}, area {errors[1]:+.2%}")

    gap = Gap(Pad(7.9, 13.8, 11.8), 45)
    assert abs(gap.mean_curvature_radius() / 9.982357 - 1) < 2e-4, gap.mean_curvature_radius()
    assert abs(Gap(Pad(7.9, 13.8, 11.8), 30).mean_curvature_radius() / 13.607666 - 1) < 2e-4
    contact = press(gap, 0.004, np.inf, 0.5)
    load, area = elliptic_hertz(gap.curvatures())
    errors = contact.load / (load * 0.004**1.5) - 1, contact.area / (area * 0.004) - 1
    assert max(map(abs, errors)) < 0.002, errors
    lines.append(f"Hertz, ellipsoid at 45° and ξ = 4 µm: load {errors[0]:+.2%}, area {errors[1]:+.2%}")

    # a/t, ν: A/(πRξ) and load over Hertz theory at the same ξ
    table = {
        (0.1, 0.5): (1.086, 1.12),
        (0.3, 0.5): (1.264, 1.44),
        (0.5, 0.48): (1.427, 1.82),
        (0.5, 0.45): (1.401, 1.76),
        (1.0, 0.5): (1.80, 3.36),
        (1.0, 0.48): (1.75, 3.18),
        (2.0, 0.45): (1.97, 6.3),
    }
    for (ratio, poisson), (area_ratio, load_ratio) in table.items():
        t = 6.0
        xi = (ratio * t) ** 2 / (radius * area_ratio)
        for _ in range(2):
            contact = press(Paraboloid(radius), xi, t, poisson)
            xi *= (np.pi * (ratio * t) ** 2 / contact.area) ** 0.75
        contact = press(Paraboloid(radius), xi, t, poisson)
        found = contact.area / (np.pi * radius * xi), contact.load / (4 / 3 * np.sqrt(radius) * xi**1.5)
        errors = found[0] / area_ratio - 1, found[1] / load_ratio - 1
        # The table has three digits; of the load at a/t = 2 two.
        assert max(map(abs, errors)) < (0.015 if ratio == 2 else 0.01), (ratio, poisson, found)
        lines.append(f"layer, a/t = {ratio}, ν = {poisson}: area {errors[0]:+.2%}, load {errors[1]:+.2%}")

    chi = 0.27
    contact = press(Paraboloid(radius), (chi * 6) ** 2 / radius, 6.0, 0.5)
    series = 1 + 1.133 * chi + 1.497 * chi**2 + 1.469 * chi**3 + 0.755 * chi**4
    error = contact.load / (4 / 3 * np.sqrt(radius) * ((chi * 6) ** 2 / radius) ** 1.5) / series - 1
    assert abs(error) < 0.003, error
    lines.append(f"layer, García & García (2018) at χ = {chi}: load {error:+.2%}")

    law = Law.of(Gap(Pad(7.9, 13.8, 11.8), 30), 2.8, 8.0, 0.5)
    xi = float(np.interp(116.3, law.area(np.linspace(0.1, 2.8, 200)), np.linspace(0.1, 2.8, 200)))
    ratio = 116.3 / (np.pi * xi)
    assert abs(ratio / 20.45 - 1) < 0.005, ratio
    lines.append(f"pad of Dzidek et al. at 30° on 8 mm: A/(πξ) = {ratio:.2f} mm at 116.3 mm² (20.47)")
    solved = press(Gap(Pad(7.9, 13.8, 11.8), 30), 0.9, 8.0, 0.5, cells=192)
    errors = float(law.load(0.9)) / solved.load - 1, float(law.area(0.9)) / solved.area - 1
    assert max(map(abs, errors)) < 0.003, errors
    lines.append(f"interpolated law against 192² cells: load {errors[0]:+.2%}, area {errors[1]:+.2%}")

    device = Device.draw("sharp", np.random.default_rng(1))
    outline, profile = law.outline(0.9), np.asarray(law.profile(np.sqrt(0.9)))
    _, mask = contact_image(outline, profile, 1.0, device, 0.0508, rng=np.random.default_rng(2))
    error = mask / float(law.area(0.9)) - 1
    assert abs(error) < 0.002, error
    major, minor = ellipse_of(outline)
    lines.append(f"rendered area: {error:+.2%}; π times semi-axes: {np.pi * major * minor / mask - 1:+.2%}")
    return lines
