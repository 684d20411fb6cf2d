from .loading import (
    plot_area_against_indentation as plot_area_against_indentation,
    plot_contact_compliance as plot_contact_compliance,
    plot_initial_modulus as plot_initial_modulus,
    plot_load_indentation as plot_load_indentation,
    plot_load_residuals as plot_load_residuals,
    plot_modulus_from_area_and_indentation as plot_modulus_from_area_and_indentation,
    plot_press as plot_press,
    plot_relaxation as plot_relaxation,
    plot_secant_modulus as plot_secant_modulus,
    plot_simulated_load as plot_simulated_load,
)
from .marks import new_panels as new_panels
from .mpl import draw as draw
from .pad import plot_pad as plot_pad, plot_pad_with_contact as plot_pad_with_contact
from .publish import save_figure as save_figure
from .results import (
    plot_agreement as plot_agreement,
    plot_area_against_load as plot_area_against_load,
    plot_aspect_ratio as plot_aspect_ratio,
    plot_corrected_radius as plot_corrected_radius,
    plot_layer_effect as plot_layer_effect,
    plot_uncertainty_budget as plot_uncertainty_budget,
)
from .section import (
    mark_receptors as mark_receptors,
    plot_contact_pressure as plot_contact_pressure,
    plot_section as plot_section,
    section_figure as section_figure,
)
from .style import new_figure as new_figure
from .svg import svg as svg
from .wedge import (
    dzidek2017_figures as dzidek2017_figures,
    plot_wedge as plot_wedge,
    plot_wedge_in_pad_axes as plot_wedge_in_pad_axes,
)
