"""What the report shows of the pad on its layer of tissue over bone, beside Hertz theory."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from fingerpad import figures
from fingerpad.contact import ContactField, Tissue, solve_contact
from fingerpad.contact.contact import from_reduced_modulus
from fingerpad.contact.fast_laws import find_modulus, plate_gap
from fingerpad.exceptions import ConvergenceError, GeometryError
from fingerpad.figures.marks import new_panels, synthetic_tag
from fingerpad.flags import FLAGS
from fingerpad.report.plot import Plot
from fingerpad.report.plots import group_name, placement_of, where
from fingerpad.study.results.layer import HERTZ_OF, LayerQuantity, curve_on_layer
from fingerpad.study.results.pooling import Summary
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.summary_file import Quantities
from fingerpad.units import KPA_PER_MPA

_IF_THICKNESS: Final = (4.0, 8.0, 12.0)
_THICKNESSES: Final = np.unique([*np.geomspace(3, 16, 40), *_IF_THICKNESS])
# A drawing needs no finer grid, and takes half a second with this one.
_CELLS, _SECTION_POINTS, _SECTION_LEVELS = 64, 91, 31
_LEAST_SHARE: Final = 0.01
_WORDS: Final = {
    "youngs_modulus_on_layer": "Young's modulus E from load and area (kPa)",
    "indentation_on_layer": "indentation ξ from the area (mm)",
    "loading_radius_on_layer": "R_g to expect, A/(πξ) (mm)",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """A line of the table: a quantity by Hertz theory and on the layer."""

    quantity: str
    source: str
    hertz: LayerQuantity
    layered: LayerQuantity
    shares: str


def comparisons(result: StudyResult, summary: Summary) -> list[Comparison]:
    """Return the lines of a summary's table; none without a thickness."""
    if summary.on_layer is None:
        return []
    highest, pooled, modulus = (
        summary.on_layer.highest_load,
        summary.on_layer.pooled,
        "youngs_modulus_on_layer",
    )
    at = f"{highest.observation}, {highest.load_N:.3g} N"
    lines = {name: _comparison(words, at, highest, HERTZ_OF[name], name) for name, words in _WORDS.items()}
    count, mean = pooled.youngs_modulus_on_layer_count, []
    if count > 1:
        mean = [_comparison(_WORDS[modulus], f"mean of {count} contacts", pooled, "youngs_modulus", modulus)]
    radius = lines.pop("loading_radius_on_layer")
    return [*mean, *lines.values(), *_of_curves(result, summary), radius]


def _of_curves(result: StudyResult, summary: Summary) -> Iterator[Comparison]:
    """Yield a line for each loading curve of the finger at the angle."""
    for curve in result.curves:
        of = curve.manifest
        if of.finger_and_wedge != summary.finger_and_wedge:
            continue
        found = curve_on_layer(result.study, result.fingers[of.finger], curve)
        if found is not None:
            yield _comparison(
                "E from load and indentation (kPa)",
                f"{of.file}, {found.load_N:.3g} N"
                + (f": {FLAGS['layer'][found.layer_flag].words}" if found.layer_flag else ""),
                found,
                "youngs_modulus_from_indentation",
                "youngs_modulus_from_indentation_on_layer",
            )


def _comparison(words: str, source: str, record: Quantities, hertz: str, on_layer: str) -> Comparison:
    """Return a line with two quantities of a record, by their names."""
    layered = LayerQuantity.of(record, on_layer)
    largest = sorted(layered.budget.items(), key=lambda item: -item[1])
    shares = ", ".join(
        f"{name} {100 * share:.0f}\N{NO-BREAK SPACE}%" for name, share in largest if share >= _LEAST_SHARE
    )
    other = LayerQuantity.of(record, hertz)
    return Comparison(quantity=words, source=source, hertz=other, layered=layered, shares=shares)


def layer_plots(result: StudyResult, summary: Summary, *, with_section: bool) -> Iterator[Plot]:
    """Draw the section under the contact at the highest load; without a thickness, what one would change.

    The section takes longer than all else of a report.
    """
    finger = result.fingers[summary.finger]
    if not finger.has_semi_axes:
        return
    if finger.manifest.effective_thickness_mm is None:
        yield from _conditional(result, summary)
    elif with_section:
        yield from _section(result, summary)


def _conditional(result: StudyResult, summary: Summary) -> Iterator[Plot]:
    """Draw what would follow for the contact at the highest load that is in the range of the laws."""
    pooled = summary.where(summary.column("pooled"))
    area = np.pi * pooled["semi_major_mm"].to_numpy() * pooled["semi_minor_mm"].to_numpy()
    nu = result.study.poisson_ratio
    reduced, contacts = find_modulus(
        plate_gap(placement_of(result, summary)),
        thickness=_THICKNESSES,
        poisson_ratio=nu,
        load=pooled["load_N"].to_numpy()[:, None],
        area=area[:, None],
    )
    known = np.flatnonzero(np.isfinite(reduced).any(axis=-1))
    if not known.size:
        return
    place = int(known[-1])
    row, radius = pooled.iloc[place], contacts.area_over_pi_indentation[place]
    modulus = from_reduced_modulus(reduced[place], nu)
    figure, (axes,) = new_panels(height_mm=56)
    figures.plot_layer_effect(
        axes,
        _THICKNESSES,
        modulus_ratio=KPA_PER_MPA * modulus / row["youngs_modulus_kpa"],
        radius_ratio=radius / row["geometric_radius_from_compliance_mm"],
        marked=_IF_THICKNESS,
        synthetic=summary.synthetic,
    )
    yield Plot(
        name=f"{group_name(summary.key)}_if_on_layer",
        figure=figure,
        caption=(
            f"Conditional: no thickness is stated for {summary.finger}. If its tissue acted like a layer of "
            f"this thickness on bone, modulus and loading radius of {row['observation']} "
            f"({row['load_N']:.3g} N) would be those of Hertz theory times these factors."
        ),
    )


def _section(result: StudyResult, summary: Summary) -> Iterator[Plot]:
    """Draw the section along the finger under the contact at the highest load."""
    on_layer = summary.on_layer
    if on_layer is None or on_layer.highest_load.layer_flag:
        return
    highest, thickness = on_layer.highest_load, on_layer.effective_thickness_mm
    placement, load = placement_of(result, summary), highest.load_N
    try:
        modulus = highest.youngs_modulus_on_layer_kpa / KPA_PER_MPA
        tissue = Tissue(modulus, result.study.poisson_ratio, thickness)
        solved = solve_contact(placement, tissue, load=load, points=_CELLS)
    except (GeometryError, ConvergenceError):
        return
    figure = figures.section_figure(
        ContactField.of_solution(solved),
        hertz=ContactField.of_hertz(placement, tissue, load=load),
        points=_SECTION_POINTS,
        levels=_SECTION_LEVELS,
    )
    figure.panels[0].add(*synthetic_tag(summary.synthetic))
    at = where(summary.finger, summary.wedge_angle_deg, summary.synthetic)
    yield Plot(
        name=f"{group_name(summary.key)}_section",
        figure=figure,
        caption=(
            f"Section along the finger under {highest.observation} ({load:.3g} N; {at}): pressure, and "
            f"maximum shear stress in {thickness:g} mm of tissue over bone, with the modulus on the "
            "layer. Dashed: pressure of Hertz theory for the same load and modulus."
        ),
    )
