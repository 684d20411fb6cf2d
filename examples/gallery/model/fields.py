"""
Shear stress under the contact
==============================

The maximum shear stress in the section along the finger, for 8 mm of tissue bonded to bone, at 2 N and
E = 75 kPa, with the depths at which mechanoreceptors lie. Dashed: the pressure of Hertz theory.
"""

import numpy as np

import fingerpad as fp
from fingerpad.contact import ContactField
from fingerpad.figures import section_figure

pad = fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
place = fp.Placement(pad, wedge_angle=np.radians(30))
tissue = fp.Tissue(youngs_modulus=0.075, thickness=8.0)

figure = section_figure(
    ContactField.of_solution(fp.solve_contact(place, tissue, load=2.0, points=96)),
    hertz=ContactField.of_hertz(place, tissue, load=2.0),
    receptors={"Meissner": (0.5, 0.7), "Merkel": (0.7, 1.0), "Pacinian": (1.5, 2.5)},
    width_mm=120,
)
