"""
Fast laws against the solver
============================

The closed laws for the whole ellipsoid on a layer answer at once what the solver finds on a grid. Lines:
laws; crosses: solver; dashed: Hertz theory.
"""

import numpy as np

import fingerpad as fp
from fingerpad.figures import new_figure

pad = fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
place = fp.Placement(pad, wedge_angle=np.radians(30))
load = np.linspace(0.02, 2, 100)
solved_at = np.array([0.25, 0.75, 1.5])

figure, (left, right) = new_figure(width_mm=170, columns=2)
for thickness, name in ((np.inf, "half-space"), (8.0, "8 mm on bone"), (5.0, "5 mm on bone")):
    tissue = fp.Tissue(youngs_modulus=0.075, thickness=thickness)  # MPa, mm
    law = fp.fast_contact(place, tissue, load=load)
    solved = [fp.solve_contact(place, tissue, load=each, points=64) for each in solved_at]
    for axes, quantity in ((left, "area"), (right, "indentation")):
        (line,) = axes.plot(load, getattr(law, quantity), label=name)
        axes.plot(solved_at, [getattr(each, quantity) for each in solved], "x", color=line.get_color())
hertz = fp.hertz_contact(place, fp.Tissue(youngs_modulus=0.075), load=load)
left.plot(load, hertz.area, "k--", label="Hertz theory")
right.plot(load, hertz.indentation, "k--")
left.set(xlabel="normal load W (N)", ylabel="contact area (mm²)")
left.legend()
right.set(xlabel="normal load W (N)", ylabel="indentation ξ (mm)")
