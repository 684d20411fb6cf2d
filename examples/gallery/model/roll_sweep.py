"""
Principal radii of a rolled finger
==================================

Rolling the finger about its own axis moves the place of contact to the side. Left: the larger (solid) and
the smaller (dashed) principal radius of curvature there. Right: the aspect ratio of the small contact that
Hertz theory predicts.
"""

import numpy as np

import fingerpad as fp
from fingerpad.figures import new_figure

pad = fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
roll_deg = np.linspace(-60, 60, 121)

figure, (left, right) = new_figure(width_mm=170, columns=2)
for wedge_deg in (15, 30, 45):
    place = fp.Placement(pad, wedge_angle=np.radians(wedge_deg), roll_angle=np.radians(roll_deg))
    smaller, larger = np.sort(place.curvature.principal_radii, axis=0)
    (line,) = left.plot(roll_deg, larger, label=f"wedge {wedge_deg}°")
    left.plot(roll_deg, smaller, "--", color=line.get_color())
    contact = fp.hertz_contact(place, fp.Tissue(youngs_modulus=0.1), load=1.0)
    right.plot(roll_deg, contact.aspect_ratio, label=line.get_label())
left.set(xlabel="roll angle (°)", ylabel="principal radii (mm)")
right.set(xlabel="roll angle (°)", ylabel="aspect ratio of the contact (–)")
right.legend(loc="upper center")
