"""
Predicted and measured contact on the pad
=========================================

The pad as seen through the platen. Dzidek et al. (2017) measured a contact that is longer along the finger
than the undeformed ellipsoid lets expect, whose predicted ellipse is almost a circle.
"""

import numpy as np

import fingerpad as fp
from fingerpad.figures import new_figure, plot_pad_with_contact
from fingerpad.published import dzidek2017

article = dzidek2017()
pad = article.semi_axes["ellipse"].ellipsoid

figure, axes = new_figure(width_mm=170, height_mm=90, columns=2)
for each, (angle, wedge) in zip(axes, article.wedges.items(), strict=False):
    place = fp.Placement(pad, wedge_angle=np.radians(angle))
    hertz = fp.hertz_contact(place, fp.Tissue(youngs_modulus=0.1024), load=wedge.load_N)
    plot_pad_with_contact(
        each,
        pad,
        wedge_angle=np.radians(angle),
        predicted=fp.Ellipse(hertz.semi_major, hertz.semi_minor),
        measured=fp.Ellipse(wedge.semi_major_mm.value, wedge.semi_minor_mm.value),
    )
