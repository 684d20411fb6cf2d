"""
Synthetic contact image
=======================

A rendered contact, measured. Green: the edge of the contact; orange: the ellipse of equal area and second
moments.
"""

import fingerpad as fp
from fingerpad.simulate import render_contact_image

truth = render_contact_image(semi_major=7.4, semi_minor=5.0, seed=3)
image = fp.measure_contact_image(truth.pixels, fp.Scale(truth.mm_per_px))
print(image.summary())
print(f"true area {truth.gross_area:.1f} mm²")

drawing = fp.show(image)
