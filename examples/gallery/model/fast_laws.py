"""
Fast laws against the solver
============================

The closed laws for the whole ellipsoid on a layer answer at once what the solver finds on a grid. Lines:
laws; crosses: solver; dashed: Hertz theory.
"""

import numpy as np

import fingerpad as fp
from fingerpad.contact import PadGap, fast_contact
from fingerpad.figures import new_figure

pad = fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
angle, modulus = np.radians(30), 0.1  # MPa
gap = PadGap.of(pad, wedge_angle=angle)
load = np.linspace(0.02, 2, 100)
solved_at = np.array([0.25, 0.75, 1.5])

figure, (left, right) = new_figure(width_mm=170, columns=2)
for thickness, name in ((None, "half-space"), (8.0, "8 mm on bone"), (5.0, "5 mm on bone")):
    law = fast_contact(gap, load=load, thickness=thickness, reduced_modulus=modulus)
    solved = [
        fp.EllipsoidContact.of(
            pad, wedge_angle=angle, thickness=thickness, load=each, reduced_modulus=modulus, points=64
        ).solution
        for each in solved_at
    ]
    for axes, quantity in ((left, "area"), (right, "indentation")):
        (line,) = axes.plot(load, getattr(law, quantity), label=name)
        axes.plot(solved_at, [getattr(each, quantity) for each in solved], "x", color=line.get_color())
radii = fp.Placement(pad, wedge_angle=angle).curvature.principal_radii
hertz = fp.hertz_contact(*radii, load, reduced_modulus=modulus)
left.plot(load, hertz.area, "k--", label="Hertz theory")
right.plot(load, hertz.indentation, "k--")
left.set(xlabel="normal load W (N)", ylabel="contact area (mm²)")
left.legend()
right.set(xlabel="normal load W (N)", ylabel="indentation ξ (mm)")
