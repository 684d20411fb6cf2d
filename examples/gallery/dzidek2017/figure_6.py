"""
Corrected radius against load (Fig. 6)
======================================

The radius corrected for the ellipse of contact, from the numbers that Dzidek et al. (2017) print at 2 N, with
:math:`R_{0g}` (dotted) and :math:`R_g` (dashed). The diamond is the printed value, which none of the
equations gives.
"""

from fingerpad.contact import equivalent_radius_from_indentation
from fingerpad.figures import new_figure, plot_corrected_radius
from fingerpad.published import dzidek2017

figure, axes = new_figure(width_mm=170, height_mm=85, columns=2)
for each, (angle, wedge) in zip(axes, dzidek2017().wedges.items(), strict=False):
    axis_ratio = wedge.semi_minor_mm.value / wedge.semi_major_mm.value
    corrected = equivalent_radius_from_indentation(wedge.mean_curvature_radius_mm.value, axis_ratio)
    plot_corrected_radius(
        each,
        wedge.load_N,
        corrected,
        measured_radius=wedge.measured_radius_mm.value,
        mean_curvature_radius=wedge.mean_curvature_radius_mm.value,
        printed=wedge,
    )
    each.set_xlabel(f"normal load W (N), wedge of {angle}°")
