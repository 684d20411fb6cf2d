"""
Radius and modulus from a loading curve
=======================================

Area against π times indentation has the slope :math:`R_g`; load against indentation then gives the modulus.
Simulated data.
"""

import fingerpad as fp
from fingerpad.figures import new_figure, plot_contact_compliance, plot_secant_modulus
from fingerpad.simulate import simulate_loading_curve

curve = simulate_loading_curve(force_std=0.005, displacement_std=0.005, area_std=1.0, seed=4)
fit = fp.fit_loading_curve(curve)
print(fit.summary())

figure, (left, right) = new_figure(width_mm=170, columns=2)
depth = curve.indentation - fit.contact_offset.value
touching = depth > 0
plot_contact_compliance(
    left,
    depth[touching],
    curve.area[touching],
    loading_radius=fit.loading_radius.value,
    loading_radius_std=fit.loading_radius.std,
    synthetic=True,
)
secant = fit.secant
plot_secant_modulus(right, secant.load, secant.modulus, against="load", synthetic=True)
