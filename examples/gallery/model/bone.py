"""
Bone under the pad
==================

What a layer of tissue over bone makes of the modulus read from load and area, and of the slope of area
against indentation, each over that of Hertz theory.
"""

import numpy as np

import fingerpad as fp
from fingerpad.figures import new_figure, plot_layer_effect

pad = fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
place = fp.Placement(pad, wedge_angle=np.radians(30))
thickness = np.linspace(3, 20, 69)  # mm

area = 100.0  # mm², as at some 2 N
layered = fp.fast_contact(place, fp.Tissue(youngs_modulus=1.0, thickness=thickness), area=area)
hertz = fp.hertz_contact(place, fp.Tissue(youngs_modulus=1.0), area=area)
radius_ratio = layered.area_over_pi_indentation / hertz.area_over_pi_indentation

figure, (axes,) = new_figure()
plot_layer_effect(axes, thickness, modulus_ratio=hertz.load / layered.load, radius_ratio=radius_ratio)
