"""Figures of Dzidek et al. (2017), as far as they follow from its printed numbers."""

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure

from fingerpad.contact import equivalent_radius_from_indentation
from fingerpad.figures.pad import plot_pad
from fingerpad.figures.results import plot_corrected_radius
from fingerpad.figures.style import new_figure
from fingerpad.figures.wedge import plot_wedge, plot_wedge_in_pad_axes
from fingerpad.published import dzidek2017


def dzidek2017_figures() -> Iterator[tuple[str, Figure, str]]:
    """Yield the supplement's Figs 1, 4, 5 and 6, as far as they follow from printed numbers.

    Fig. 6 shows 2 N, the one load of which numbers are printed: R_g^corr from the printed R_0g and contact
    ellipse, R_0g F₂⁻³, beside the printed value.
    """
    article = dzidek2017()
    pad = article.semi_axes["ellipse"].ellipsoid
    figure, (axes,) = new_figure(height_mm=80)
    plot_pad(axes, pad, u_deg=())
    yield "dzidek2017_figure_1", figure, "The ellipsoid of Table 1 (ellipse approach) and its axes."
    figure, (axes,) = new_figure(height_mm=80)
    plot_pad(axes, pad)
    yield "dzidek2017_figure_4", figure, "The places u = 0°, 30°, 45°, 60° and 90° on the pad."
    for angle, wedge in article.wedges.items():
        theta = np.radians(angle)
        k = wedge.semi_minor_mm.value / wedge.semi_major_mm.value
        figure, (left, right) = new_figure(width_mm=170, height_mm=95, columns=2)
        plot_wedge(left, pad, wedge_angle=theta)
        plot_wedge_in_pad_axes(right, pad, wedge_angle=theta)
        yield (
            f"dzidek2017_figure_5_{angle}deg",
            figure,
            f"The finger on its wedge of {angle}°, and in its own axes.",
        )
        figure, (axes,) = new_figure()
        plot_corrected_radius(
            axes,
            wedge.load_N,
            equivalent_radius_from_indentation(wedge.mean_curvature_radius_mm.value, k),
            measured_radius=wedge.measured_radius_mm.value,
            mean_curvature_radius=wedge.mean_curvature_radius_mm.value,
            printed=wedge,
        )
        yield (
            f"dzidek2017_figure_6_{angle}deg",
            figure,
            f"Corrected radius at {angle}° and 2 N, from printed numbers.",
        )
