"""
Ellipsoidal cap and places of contact (Figs 1 and 4)
====================================================

The pad is the palmar cap of an ellipsoid. The parametric angle u counts from the palmar axis towards the
fingertip.
"""

from fingerpad.figures import new_figure, plot_pad
from fingerpad.published import dzidek2017

pad = dzidek2017().semi_axes["ellipse"].ellipsoid  # Table 1, fitted ellipses

figure, (left, right) = new_figure(width_mm=170, height_mm=85, columns=2)
plot_pad(left, pad, u_deg=())
plot_pad(right, pad, u_deg=(0, 30, 45, 60, 90))
