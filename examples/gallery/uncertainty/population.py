"""
A population of fingers
=======================

Two hundred pads drawn with a scatter of 10 % in each semi-axis about that of Dzidek et al. (2017): how much
of what differs between people is their fingers' shape? Everything broadcasts, so that a population costs no
loop.
"""

import numpy as np

import fingerpad as fp
from fingerpad.figures import new_figure

random = np.random.default_rng(5)
palmar, distal, across = np.exp(np.log([[7.9], [13.8], [11.8]]) + 0.1 * random.standard_normal((3, 200)))
pads = fp.Ellipsoid(palmar=palmar, distal=distal, radial_ulnar=across)
wedge_deg = np.linspace(0, 60, 61)[:, None]
place = fp.Placement(pads, wedge_angle=np.radians(wedge_deg))
contact = fp.hertz_contact(place, fp.Tissue(youngs_modulus=0.1024), load=2.0)

figure, (left, right) = new_figure(width_mm=170, columns=2)
geometric_mean = place.curvature.geometric_mean_radius
for axes, values, name in (
    (left, geometric_mean, "√(R′R″) (mm), synthetic"),
    (right, contact.area, "contact area at 2 N (mm²), synthetic"),
):
    low, lower, middle, upper, high = np.percentile(values, [2.5, 25, 50, 75, 97.5], axis=1)
    axes.fill_between(wedge_deg[:, 0], low, high, alpha=0.2, label="95 % of fingers")
    axes.fill_between(wedge_deg[:, 0], lower, upper, alpha=0.4, label="half of the fingers")
    axes.plot(wedge_deg[:, 0], middle, "k", label="median")
    axes.set(xlabel="wedge angle (°)", ylabel=name)
left.legend()
