"""
Which input should I measure better?
====================================

Shares of the sources in the variance of the corrected radius, to first order (wide bars) and by Sobol's
total indices (narrow). With an angle known to 3°, as without a measurement of it, nothing else matters;
known to 0.5°, the semi-axes come next.
"""

import numpy as np

import fingerpad as fp
from fingerpad.figures import new_figure, plot_uncertainty_budget
from fingerpad.uncertainty import pad_model, sobol_indices

figure, axes = new_figure(width_mm=170, columns=2)
for each, angle_std in zip(axes, (3.0, 0.5), strict=True):
    result = fp.pad_uncertainty(
        palmar=(7.9, 0.1),
        distal=(13.8, 0.1),
        radial_ulnar=(11.8, 0.1),
        wedge_angle=(np.radians(30), np.radians(angle_std)),
        load=(2.0, 0.02),
        semi_major=(7.4, 0.1),
        semi_minor=(5.0, 0.1),
    )
    radius = result["radius_from_indentation"]
    total = sobol_indices(pad_model, result.inputs)["radius_from_indentation"].total
    plot_uncertainty_budget(each, result.budget("radius_from_indentation"), total=total)
    each.set_xlabel(
        f"share of the variance (%)\nangle ± {angle_std}°: {radius.value:.1f} ± {radius.std:.1f} mm"
    )
