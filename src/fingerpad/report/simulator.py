"""The law that simulators take, over the loading curve that it is of."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from fingerpad.contact import Tissue
from fingerpad.exceptions import GeometryError
from fingerpad.figures.loading import plot_simulated_load
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.report.plot import Plot, panel
from fingerpad.simulator import simulator_law
from fingerpad.study.measuring.curves import CurveResult
from fingerpad.study.results.layer import curve_on_layer
from fingerpad.study.results.study_result import StudyResult
from fingerpad.units import KPA_PER_MPA

_LOWEST: Final = 0.05  # of the curve's highest load


def simulator_plots(result: StudyResult, curve: CurveResult, name: str) -> Iterator[Plot]:
    """Draw the law of a curve's finger on its bone, and what simulators make of it.

    With a stated thickness the modulus is that of the curve's highest load; else thickness and modulus are
    those that explain the curve, where they are known.
    """
    of, fit, finger = curve.manifest, curve.fit, result.fingers.get(curve.manifest.finger)
    if fit is None or finger is None or not np.isfinite(finger.semi_axes).all():
        return
    nu = result.study.poisson_ratio
    if (stated := curve_on_layer(result.study, finger, curve)) and not stated.flag:
        modulus = stated.quantities["youngs_modulus_from_indentation_on_layer"]
        tissue = Tissue(modulus.value / KPA_PER_MPA, nu, finger.effective_thickness or np.inf)
        # Its uncertainty holds that of the thickness.
        stds, moved = {"youngs_modulus": modulus.std / KPA_PER_MPA}, stated.contact_shift
        words = "tissue of the stated thickness on bone"
    elif (layer := curve.layer) and layer.thickness.known and layer.youngs_modulus.known:
        tissue = Tissue(layer.youngs_modulus.value, nu, layer.thickness.value)
        stds = {"youngs_modulus": layer.youngs_modulus.std, "thickness": layer.thickness.std}
        # The layer has its own place of contact, by which the points count here.
        moved = fit.main.values["contact_offset"] - layer.contact_offset.value
        words = "the layer that explains the curve"
    else:
        return
    placement = Placement(Ellipsoid(*finger.semi_axes), wedge_angle=np.radians(of.wedge_angle_deg))
    highest = float(fit.load.max())
    try:
        law = simulator_law(placement, tissue, (_LOWEST * highest, highest), stds=stds)
        simulated = law.simulated_loads()
    except GeometryError:  # beyond the law, or too stiff for MuJoCo: `fingerpad simulator` says which
        return
    yield Plot(
        name=f"{name}_simulator",
        figure=panel(
            plot_simulated_load,
            law.indentation,
            law.load,
            load_std=law.load_std,
            simulated=simulated,
            measured=(fit.indentation + moved, fit.load),
            synthetic=of.synthetic,
        ),
        caption="Load by indentation in robot simulators, with numbers fitted to the law of "
        f"{words}; the band is its standard uncertainty ({curve.name}).",
    )
