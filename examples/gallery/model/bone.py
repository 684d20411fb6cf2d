"""
Bone under the pad
==================

What a layer of tissue over bone makes of the modulus read from load and area, and of the slope of area
against indentation, each over that of Hertz theory.
"""

import numpy as np

import fingerpad as fp
from fingerpad.contact import PadGap, fast_contact
from fingerpad.figures import new_figure, plot_layer_effect

pad = fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
gap = PadGap.of(pad, wedge_angle=np.radians(30))
radii = fp.Placement(pad, wedge_angle=np.radians(30)).curvature.principal_radii
thickness = np.linspace(3, 20, 69)  # mm

area = 100.0  # mm², as at some 2 N
layered = fast_contact(gap, area=area, thickness=thickness, reduced_modulus=1.0)
# The load of Hertz theory for this area goes with its 3/2 power, the indentation with A itself.
unit = fp.hertz_contact(*radii, 1.0, reduced_modulus=1.0)
hertz_load = (area / unit.area) ** 1.5
radius_ratio = layered.area_over_pi_indentation / (unit.area / (np.pi * unit.indentation))

figure, (axes,) = new_figure()
plot_layer_effect(axes, thickness, modulus_ratio=hertz_load / layered.load, radius_ratio=radius_ratio)
