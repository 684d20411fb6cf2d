"""
Elliptical Hertz contact
========================

Contact ellipses and pressures of one pad at 30° under 0.25, 0.5, 1 and 2 N. The library takes any consistent
units, which the axes name: here lengths are in mm, and pressure and moduli in MPa.
"""

import numpy as np

import fingerpad as fp

pad = fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
place = fp.Placement(pad, wedge_angle=np.radians(30))
soft = fp.Tissue(youngs_modulus=0.1024, poisson_ratio=0.5)
contact = fp.hertz_contact(place, soft, load=[0.25, 0.5, 1.0, 2.0])
print(contact.summary())

drawing = fp.show(contact)
