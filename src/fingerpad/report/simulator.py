"""The law that simulators take, over the loading curve that it is of."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from fingerpad.contact import Tissue
from fingerpad.exceptions import GeometryError
from fingerpad.figures.simulator import plot_simulated_load
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.report.plot import Plot, panel
from fingerpad.simulator import simulator_law
from fingerpad.study.measuring.curves import CurveResult

_LOWEST: Final = 0.05  # of the curve's highest load
_MASS: Final = 0.1  # kg, as of `fingerpad simulator`


def simulator_plots(curve: CurveResult, pad: Ellipsoid, name: str) -> Iterator[Plot]:
    """Draw the law of the layer that explains a curve, and what simulators make of it, where there is one."""
    of, fit, layer = curve.manifest, curve.fit, curve.layer
    if fit is None or layer is None or not (layer.thickness.known and layer.youngs_modulus.known):
        return
    tissue = Tissue(layer.youngs_modulus.value, thickness=layer.thickness.value)
    placement = Placement(pad, wedge_angle=np.radians(of.wedge_angle_deg))
    highest = float(fit.load.max())
    try:
        law = simulator_law(
            placement,
            tissue,
            (_LOWEST * highest, highest),
            stds={"youngs_modulus": layer.youngs_modulus.std, "thickness": layer.thickness.std},
        )
        simulated = law.simulated_loads(_MASS)
    except GeometryError:  # beyond the law, or too stiff for MuJoCo: `fingerpad simulator` says which
        return
    # The layer has its own place of contact, by which the points count here.
    moved = fit.main.values["contact_offset"] - layer.contact_offset.value
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
        caption="Load by indentation in robot simulators, with numbers fitted to the law of the layer that "
        f"explains the curve; the band is its standard uncertainty ({curve.name}).",
    )
