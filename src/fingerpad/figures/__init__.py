"""All drawing: the figures of Dzidek et al. (2017) and those of a study, on axes that the caller provides.

Every ``plot_*`` draws on Matplotlib axes and returns them; `new_figure` makes axes without any global state,
`save_figure` and `figure_svg` write them.
"""

from fingerpad.figures.loading import (
    plot_area_against_indentation,
    plot_contact_compliance,
    plot_initial_modulus,
    plot_load_indentation,
    plot_load_residuals,
    plot_modulus_from_area_and_indentation,
    plot_press,
    plot_relaxation,
    plot_secant_modulus,
    plot_simulated_load,
)
from fingerpad.figures.marks import new_panels
from fingerpad.figures.mpl import draw
from fingerpad.figures.pad import plot_pad, plot_pad_with_contact
from fingerpad.figures.results import (
    plot_agreement,
    plot_area_against_load,
    plot_aspect_ratio,
    plot_corrected_radius,
    plot_layer_effect,
    plot_uncertainty_budget,
)
from fingerpad.figures.section import mark_receptors, plot_contact_pressure, plot_section, section_figure
from fingerpad.figures.style import figure_svg, new_figure, save_figure
from fingerpad.figures.svg import save_panels, svg
from fingerpad.figures.wedge import dzidek2017_figures, plot_wedge, plot_wedge_in_pad_axes

__all__ = [
    "draw",
    "dzidek2017_figures",
    "figure_svg",
    "mark_receptors",
    "new_figure",
    "new_panels",
    "plot_agreement",
    "plot_area_against_indentation",
    "plot_area_against_load",
    "plot_aspect_ratio",
    "plot_contact_compliance",
    "plot_contact_pressure",
    "plot_corrected_radius",
    "plot_initial_modulus",
    "plot_layer_effect",
    "plot_load_indentation",
    "plot_load_residuals",
    "plot_modulus_from_area_and_indentation",
    "plot_pad",
    "plot_pad_with_contact",
    "plot_press",
    "plot_relaxation",
    "plot_secant_modulus",
    "plot_section",
    "plot_simulated_load",
    "plot_uncertainty_budget",
    "plot_wedge",
    "plot_wedge_in_pad_axes",
    "save_figure",
    "save_panels",
    "section_figure",
    "svg",
]
