"""
Which equivalent sphere?
========================

An elliptical contact has no single equivalent sphere: the sphere of the same indentation is larger than
that of the same area. Loading data give the third one, which has the same area at the same indentation.
"""

import numpy as np

from fingerpad.contact import (
    equivalent_radius_from_area,
    equivalent_radius_from_compliance,
    equivalent_radius_from_indentation,
)
from fingerpad.figures import new_figure

aspect_ratio = np.linspace(1, 3, 200)
figure, (axes,) = new_figure()
for function, name in (
    (equivalent_radius_from_indentation, "same indentation"),
    (equivalent_radius_from_compliance, "same area at the same indentation"),
    (equivalent_radius_from_area, "same area"),
):
    axes.plot(aspect_ratio, function(1.0, 1 / aspect_ratio), label=name)
axes.set(xlabel="aspect ratio ℓd/ℓe (–)", ylabel="radius over √(R′R″) (–)")
axes.legend()
