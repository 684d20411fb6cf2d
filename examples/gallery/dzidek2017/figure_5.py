"""
Finger on a wedge (Fig. 5)
==========================

Under a level platen the finger meets it where its normal is vertical: u follows from the wedge angle by tan
u = (ℓb/ℓa) tan θ. The second drawing shows the same section in the axes of the pad.
"""

import numpy as np

from fingerpad.figures import new_figure, plot_wedge, plot_wedge_in_pad_axes
from fingerpad.published import dzidek2017

pad = dzidek2017().semi_axes["ellipse"].ellipsoid

figure, axes = new_figure(width_mm=170, height_mm=150, rows=2, columns=2)
for row, angle in enumerate((30, 45)):
    plot_wedge(axes[2 * row], pad, wedge_angle=np.radians(angle))
    plot_wedge_in_pad_axes(axes[2 * row + 1], pad, wedge_angle=np.radians(angle))
