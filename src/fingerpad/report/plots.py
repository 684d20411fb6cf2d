"""The figures of a study's report, one set for each finger and placement."""

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import pandas as pd

from fingerpad import figures
from fingerpad._arrays import FloatArray, as_float_array
from fingerpad._files import file_stem
from fingerpad.contact import Tissue, hertz_contact
from fingerpad.estimate import Estimate
from fingerpad.exceptions import GeometryError
from fingerpad.figures.compare import (
    MOST_NAMES,
    Series,
    colours_of,
    plot_by_wedge,
    plot_over_load,
)
from fingerpad.figures.marks import Figure, Marker, new_panels
from fingerpad.geometry import Ellipse, Placement
from fingerpad.report.loading import loading_plots
from fingerpad.report.plot import Plot, panel
from fingerpad.simulator import simulator_law
from fingerpad.study.measuring.curves import CurveResult, loading_radius
from fingerpad.study.measuring.fingers import pad_placement
from fingerpad.study.measuring.sequences import SequenceResult
from fingerpad.study.results.layer import LayerQuantity, curve_on_layer
from fingerpad.study.results.output import Answer
from fingerpad.study.results.pooling import Summary, area_exponent
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.summary_file import PlacementKey, UncertaintyCheckRecord
from fingerpad.study.results.table import Indices, Row, records
from fingerpad.study.results.validity.model_checks import RADIUS
from fingerpad.uncertainty import Agreement
from fingerpad.units import KPA_PER_MPA

if TYPE_CHECKING:
    from fingerpad.study.compare import Mean

# More than these only make a page heavy.
_MOST_FRAMES: Final = 150
MOST_POINTS: Final = 60
_LOWEST: Final = 0.05  # of a curve's highest load, from which simulators are fitted
_LEAST_SHARE: Final = 0.001  # of a variance
_BESIDE: Final = (r"$R_\mathrm{g}$", r"$R_\mathrm{0g}$")
# By whether a modulus is on bone, what it is, its mark, and the mark's name; the page draws them alike.
_MODULI: Final[dict[bool, tuple[str, Marker, str]]] = {
    False: ("by Hertz theory", "o", "circle"),
    True: ("on the layer over bone", "s", "square"),
}


def group_name(key: PlacementKey) -> str:
    """Return the file name of a group of rows, which no other group has."""
    finger, wedge_angle_deg, roll_angle_deg, synthetic = key
    roll = f"_roll{roll_angle_deg!r}" if roll_angle_deg else ""
    name = f"{finger}_{wedge_angle_deg!r}deg{roll}".replace(".0deg", "deg")
    return file_stem(name + ("_synthetic" if synthetic else ""))


def answer_plots(result: StudyResult, found: Sequence[Answer], prefix: str) -> Iterator[Plot]:
    """Draw area, modulus and corrected radius of all fingers and angles against load.

    A modulus is that on bone where the tissue's thickness is stated, else that of Hertz theory.
    """
    pairs = [(shown_rows(summary), one) for summary, one in zip(result.summaries, found, strict=True)]
    if not pairs:
        return
    colours = colours_of([one.label for one in found])
    beside = "; points at one load stand side by side" if len(pairs) <= MOST_NAMES else ", of each contact"
    shown = (_MODULI[one.on_bone] for one in found)
    moduli = dict.fromkeys(f"{kind} ({mark}s)" for kind, _, mark in shown)
    loading = "" if all(np.isnan(one.of.loading_radius_mm) for one in found) else "loading radius R_g and "
    for name, label, caption, values in (
        ("area", "contact area A (mm²)", f"Contact area against load{beside}.", _areas),
        (
            "modulus",
            "Young's modulus E (kPa)",
            f"Young's modulus against load, {' and '.join(moduli)}.",
            _moduli,
        ),
        (
            "radius",
            "corrected radius (mm)",
            f"Corrected radius against load; beside it {loading}radius R_0g of the undeformed pad.",
            _radii,
        ),
    ):
        drawn = [values(rows, one) for rows, one in pairs]
        if not any(len(points["x"]) for points in drawn):
            continue
        lines = [
            Series(name=one.label, colour=colours[one.label], synthetic=one.of.synthetic, **points)
            for points, (_, one) in zip(drawn, pairs, strict=True)
        ]
        figure, (axes,) = new_panels(height_mm=78)
        plot_over_load(axes, lines, label=label, beside=_BESIDE if name == "radius" else ())
        yield Plot(name=f"{prefix}{name}_over_load", figure=figure, caption=caption)


def summary_plots(result: StudyResult, summary: Summary) -> Iterator[Plot]:
    """Draw one finger at one placement."""
    rows = shown_rows(summary)
    (last,) = records(rows[-1:])
    name, at = group_name(summary.key), where(summary.finger, summary.wedge_angle_deg, summary.synthetic)
    synthetic, left_out = rows["synthetic"], ~rows["pooled"]
    has_pad = result.fingers[summary.finger].has_semi_axes
    if has_pad:
        yield from _pad_plots(result, summary, rows, last)
    if np.ptp(rows["load_N"].to_numpy()) > 0:
        exponent = area_exponent(summary.areas)
        yield Plot(
            name=f"{name}_area",
            figure=panel(
                figures.plot_area_against_load,
                rows["load_N"],
                rows["gross_area_mm2"],
                area_std=rows["gross_area_mm2_std"],
                exponent=exponent.value,
                exponent_std=exponent.std,
                synthetic=synthetic,
                left_out=left_out,
            ),
            caption=f"Contact area against load, with the fitted exponent and that of Hertz ({at}). "
            "± of the exponent is from the scatter about the line, over frames from its bends, and from the "
            "contact edge; the check of the model takes in the stated uncertainties of areas and loads.",
        )
    if rows["long_axis"].notna().any():
        across = {"along": 0.0, "across": 90.0}
        angle = rows["orientation_deg"].fillna(rows["long_axis"].map(across)).fillna(0.0)
        yield Plot(
            name=f"{name}_aspect_ratio",
            figure=panel(
                figures.plot_aspect_ratio,
                rows["load_N"],
                rows["aspect_ratio"],
                aspect_ratio_std=_aspect_ratio_std(rows),
                long_axis_angle=np.radians(angle),
                predicted_aspect_ratio=last["predicted_aspect_ratio"],
                predicted_long_axis_angle=np.radians(across.get(last["predicted_long_axis"], 0.0)),
                synthetic=synthetic,
                left_out=left_out,
            ),
            caption="Aspect ratio and direction of the long axis, measured"
            f"{' and predicted' * has_pad} ({at}).",
        )


def _pad_plots(result: StudyResult, summary: Summary, rows: pd.DataFrame, last: Row) -> Iterator[Plot]:
    """Draw contact and corrected radius, which need the pad."""
    name, at = group_name(summary.key), where(summary.finger, summary.wedge_angle_deg, summary.synthetic)
    yield Plot(
        name=f"{name}_pad",
        figure=_pad(result, summary, last),
        caption=(
            f"The pad seen through the platen ({at}; grey: not pad), and the contact "
            f"{last['observation']} drawn flat. Hertz theory gives the shape only."
            + ("" if last["long_axis"] else " The measured ellipse has no direction and is not drawn.")
        ),
    )
    loading = loading_radius(result.curves, summary.finger_and_wedge)
    level = ""
    if loading is not None:
        band = ", with one standard uncertainty (band)" if np.isfinite(loading.std) else ""
        level = f" Dashed: loading data{band}."
    yield Plot(
        name=f"{name}_corrected_radius",
        figure=panel(
            figures.plot_corrected_radius,
            rows["load_N"],
            rows["radius_from_indentation_mm"],
            corrected_radius_std=rows["radius_from_indentation_mm_total_std"],
            fixed_geometry_std=rows["radius_from_indentation_mm_fixed_geometry_std"],
            compliance_radius=rows["radius_from_compliance_mm"],
            measured_radius=loading and loading.value,
            measured_radius_std=loading and loading.std,
            mean_curvature_radius=last["mean_curvature_radius_mm"],
            synthetic=rows["synthetic"],
            left_out=~rows["pooled"],
        ),
        caption=(
            f"Corrected radius against load ({at}); thin bars: one standard uncertainty, of "
            "which contacts share the parts from the pad's geometry and the model; thick bars: without these "
            f"parts, as Dzidek et al. do. Dotted: undeformed pad.{level}"
        ),
    )


def where(finger: str, wedge_angle_deg: float, synthetic: bool) -> str:
    """Return what a figure is of, for its caption."""
    return f"{finger}, wedge {wedge_angle_deg:g}°{'; synthetic' if synthetic else ''}"


def agreement_plots(result: StudyResult) -> Iterator[Plot]:
    """Draw how two persons agree on the areas of the images that both outlined."""
    for found in result.operators:
        if (area := found.gross_area_mm2) is None:
            continue
        pairs = result.compared_pairs(synthetic=found.synthetic)
        yield Plot(
            name="second_operator_synthetic" if found.synthetic else "second_operator",
            figure=panel(
                figures.plot_agreement,
                [one.first["gross_area_mm2"] for one in pairs],
                [one.second["gross_area_mm2"] for one in pairs],
                Agreement(**dict(area)),
                quantity="gross area (mm²)",
                names=[" and ".join(names) for names in (found.first_operators, found.second_operators)],
                synthetic=found.synthetic,
            ),
            caption="Contact areas by two persons, the second without seeing the first's outlines"
            + ("; synthetic images" if found.synthetic else "")
            + ". Line: bias, with its 95 % interval. Dashed: limits of agreement.",
        )


def wedge_plot(result: StudyResult) -> Iterator[Plot]:
    """Draw the corrected radius of every finger against the wedge angle, where angles differ."""
    found = (
        (one, placed.validity.headlines[RADIUS])
        for one, placed in zip(result.summaries, result.placements, strict=True)
        if one.corrected_radius and not one.roll_angle_deg
    )
    yield from by_wedge_plot(
        "corrected_radius_by_wedge",
        (
            ((one.finger,), one.synthetic, one.wedge_angle_deg, radius.value, radius.total_std)
            for one, radius in found
        ),
        list(result.fingers),
        label="corrected radius (mm)",
    )


def by_wedge_plot(
    name: str,
    points: Iterable[tuple[tuple[str, ...], bool, float, float, float]],
    people: Sequence[str],
    means: "Sequence[tuple[float, Mean]]" = (),
    *,
    label: str,
) -> Iterator[Plot]:
    """Draw corrected radii against wedge angle as a separate figure, where angles differ.

    A point has the names of its line, the first of which is that of the person, whether it is synthetic, its
    angle (degrees), its value and standard uncertainty.
    """
    lines: dict[tuple[tuple[str, ...], bool], list[tuple[float, float, float]]] = {}
    for names, synthetic, angle, value, std in sorted(points, key=lambda one: one[2]):
        lines.setdefault((names, synthetic), []).append((angle, value, std))
    if len({angle for line in lines.values() for angle, *_ in line}) < 2:
        return
    colours, series = colours_of(people), []
    for ((person, *_), synthetic), line in lines.items():
        x, values, stds = np.transpose(line)
        series.append(
            Series(name=person, colour=colours[person], x=x, value=values, std=stds, synthetic=synthetic)
        )
    figure, (axes,) = new_panels(width_mm=140, height_mm=95)
    plot_by_wedge(axes, series, means, label=label)
    yield Plot(
        name=name,
        figure=figure,
        caption="Corrected radius against wedge angle, a line for each finger. Where bars are drawn they are "
        "one standard uncertainty, and fingers of one angle stand beside one another. Hollow or dotted: "
        "synthetic.",
    )


def curve_plots(result: StudyResult, curve: CurveResult, number: int) -> Iterator[Plot]:
    """Draw one loading curve, and what simulators make of it."""
    if curve.curve is None or curve.fit is None:
        return
    of, shape = curve.manifest, curve.shape
    name = f"curve{number}_{group_name((of.finger, of.wedge_angle_deg, 0.0, of.synthetic))}"
    yield from loading_plots(
        name,
        curve.curve,
        curve.fit,
        where=f"{curve.name}{'; synthetic' if of.synthetic else ''}",
        cycle=of.cycle,
        geometric_mean_radius=None if shape is None else shape.geometric_mean_radius,
        expected_ratio=None if shape is None else (shape.load, shape.ratio),
        synthetic=of.synthetic,
    )
    yield from simulator_plots(result, curve, name)


def simulator_plots(result: StudyResult, curve: CurveResult, name: str) -> Iterator[Plot]:
    """Draw the law of a curve's finger on its bone, and what simulators make of it.

    With a stated thickness the modulus is that of the curve's highest load; else thickness and modulus are
    those that explain the curve, where they are known.
    """
    of, fit, finger = curve.manifest, curve.fit, result.fingers.get(curve.manifest.finger)
    if fit is None or finger is None or not np.isfinite(finger.semi_axes).all():
        return
    nu = result.study.poisson_ratio
    if (stated := curve_on_layer(result.study, finger, curve)) and not stated.layer_flag:
        modulus = LayerQuantity.of(stated, "youngs_modulus_from_indentation_on_layer")
        tissue = Tissue(modulus.value / KPA_PER_MPA, nu, finger.manifest.effective_thickness_mm or np.inf)
        # Its uncertainty holds that of the thickness.
        stds, moved = {"youngs_modulus": modulus.std / KPA_PER_MPA}, stated.contact_shift_mm
        words = "tissue of the stated thickness on bone"
    elif (layer := curve.layer) and layer.thickness.known and layer.youngs_modulus.known:
        tissue = Tissue(layer.youngs_modulus.value, nu, layer.thickness.value)
        stds = {"youngs_modulus": layer.youngs_modulus.std, "thickness": layer.thickness.std}
        # The layer has its own place of contact, by which the points count here.
        moved = fit.main.values["contact_offset"] - layer.contact_offset.value
        words = "the layer that explains the curve"
    else:
        return
    placement = pad_placement(finger.semi_axes, of.wedge_angle_deg)
    highest = float(fit.load.max())
    try:
        law = simulator_law(placement, tissue, (_LOWEST * highest, highest), stds=stds)
        simulated = law.simulated_loads()
    except GeometryError:  # beyond the law, or too stiff for MuJoCo: `fingerpad simulator` says which
        return
    yield Plot(
        name=f"{name}_simulator",
        figure=panel(
            figures.plot_simulated_load,
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


def velocity_plots(curves: Sequence[CurveResult]) -> Iterator[Plot]:
    """Draw E_0g against velocity for each finger and angle at which there is more than one."""
    groups: dict[tuple[str, float, bool], list[tuple[float, Estimate]]] = {}
    for curve in curves:
        of, initial = curve.manifest, curve.fit.initial_modulus if curve.fit else None
        if initial is not None and initial.known and np.isfinite(curve.velocity):
            groups.setdefault(of.finger_and_wedge, []).append((curve.velocity, initial))
    for (finger, wedge, synthetic), found in groups.items():
        if len({velocity for velocity, _ in found}) < 2:
            continue
        yield Plot(
            name=f"{group_name((finger, wedge, 0.0, synthetic))}_initial_modulus",
            figure=panel(
                figures.plot_initial_modulus,
                [velocity for velocity, _ in found],
                [initial.value for _, initial in found],
                initial_modulus_std=[initial.std for _, initial in found],
                synthetic=np.full(len(found), synthetic),
            ),
            caption=f"Young's modulus at no load against velocity ({where(finger, wedge, synthetic)}).",
        )


def budget_plot(summary: Summary, check: UncertaintyCheckRecord | None) -> Iterator[Plot]:
    """Draw who contributes what to the uncertainty of the highest_load contact's corrected radius."""
    if check is None:
        return
    seen = {name: share for name, share in check.shares.items() if abs(share) >= _LEAST_SHARE}
    small = ", ".join(name for name in check.shares if name not in seen)
    yield Plot(
        name=f"{group_name(summary.key)}_budget",
        figure=panel(figures.plot_uncertainty_budget, seen, total=check.total, synthetic=summary.synthetic),
        caption=f"Shares of the variance of the corrected radius of {check.observation}: of first order, and "
        f"Sobol's total index, which counts interactions.{small and f' Below 0.1 %: {small}.'}",
    )


def sequence_plots(sequence: SequenceResult, frames: pd.DataFrame) -> Iterator[Plot]:
    """Draw the contact in one sequence, and its area against displacement where that was recorded."""
    of, measured = sequence.manifest, frames[frames["semi_major_mm"].notna()]
    if measured.empty:
        return
    synthetic = bool(frames["synthetic"].iloc[0])
    name, label = f"sequence_{file_stem(of.name)}", "_synthetic" if synthetic else ""
    at = f"{of.name}, {where(of.finger, of.wedge_angle_deg, synthetic)}"
    rows = thinned(measured, _MOST_FRAMES)
    figure, axes = new_panels(width_mm=170, height_mm=110, rows=2, columns=2)
    figures.plot_press(
        axes,
        time=rows["time_s"],
        load=rows["load_N"],
        phase=rows["phase"],
        area=rows["gross_area_mm2"],
        semi_major=rows["semi_major_mm"],
        semi_minor=rows["semi_minor_mm"],
        synthetic=synthetic,
    )
    manual = " Phases were set manually." if sequence.phases else ""
    some = "" if len(rows) == len(measured) else f" {len(rows)} of {len(measured)} frames are drawn."
    yield Plot(
        name=f"{name}{label}",
        figure=figure,
        caption=f"Contact area and semi-axes against time and against force ({at}).{manual}{some}",
    )
    displaced = frames[frames["gross_area_mm2"].notna() & frames["measured_indentation_mm"].notna()]
    if displaced.empty:
        return
    rows = thinned(displaced, _MOST_FRAMES)
    yield Plot(
        name=f"{name}_indentation{label}",
        figure=panel(
            figures.plot_area_against_indentation,
            rows["measured_indentation_mm"],
            rows["gross_area_mm2"],
            phase=rows["phase"],
            synthetic=synthetic,
        ),
        caption=f"Contact area against the platen's displacement from the place of contact ({at}); the stage "
        "is taken as rigid.",
    )


def shown_rows(summary: Summary) -> pd.DataFrame:
    """Return the rows to show one by one, by load: single contacts, or where there are none frames."""
    table, places = summary.table, summary.places
    single, pooled = summary.column("frame").isna(), summary.column("pooled")
    shown = next((some for some in (places[single], places[pooled]) if some.size), places)
    # Of all columns only what is shown is copied.
    return table.iloc[shown[evenly(shown.size, MOST_POINTS)]]


def thinned(rows: pd.DataFrame, most: int) -> pd.DataFrame:
    """Return at most so many rows, evenly spaced, with the first and the last."""
    return rows.iloc[evenly(len(rows), most)]


def evenly(count: int, most: int) -> Indices:
    """Return at most so many indices of a count, evenly spaced, with the first and the last."""
    return np.linspace(0, count - 1, min(count, most)).round().astype(np.intp)


def placement_of(result: StudyResult, summary: Summary) -> Placement:
    """Return the pad where it touches."""
    semi_axes = result.fingers[summary.finger].semi_axes
    return pad_placement(semi_axes, summary.wedge_angle_deg, summary.roll_angle_deg)


def _pad(result: StudyResult, summary: Summary, row: Row) -> Figure:
    placement = placement_of(result, summary)
    area = np.pi * row["semi_major_mm"] * row["semi_minor_mm"]
    contact = hertz_contact(placement, Tissue(youngs_modulus=1.0), area=area)
    angle = row["orientation_deg"]
    if angle is None:
        angle = 90.0 * (row["long_axis"] == "across")
    figure, (axes,) = new_panels(height_mm=95)
    figures.plot_pad_with_contact(
        axes,
        placement.ellipsoid,
        wedge_angle=float(placement.wedge_angle),
        roll_angle=float(placement.roll_angle),
        predicted=Ellipse(contact.semi_major, contact.semi_minor),
        measured=Ellipse(row["semi_major_mm"], row["semi_minor_mm"]) if row["long_axis"] else None,
        measured_long_axis_angle=float(np.radians(angle)),
        synthetic=summary.synthetic,
    )
    return figure


def _areas(rows: pd.DataFrame, _: Answer) -> dict[str, Any]:
    return _points(rows, rows["gross_area_mm2"], rows["gross_area_mm2_std"])


def _moduli(rows: pd.DataFrame, found: Answer) -> dict[str, Any]:
    name, std = ("_on_layer_kpa", "std") if found.on_bone else ("_kpa", "total_std")
    kind, marker, _ = _MODULI[found.on_bone]
    points = _points(rows, rows[f"youngs_modulus{name}"], rows[f"youngs_modulus{name}_{std}"])
    return {**points, "kind": kind, "marker": marker}


def _radii(rows: pd.DataFrame, found: Answer) -> dict[str, Any]:
    name, of = "radius_from_indentation_mm", found.of
    levels = [
        (of.loading_radius_mm, of.loading_radius_mm_std),
        (of.mean_curvature_radius_mm, of.mean_curvature_radius_mm_std),
    ]
    return {**_points(rows, rows[name], rows[f"{name}_total_std"]), "beside": levels}


def _points(rows: pd.DataFrame, value: pd.Series, std: pd.Series) -> dict[str, FloatArray]:
    """Return rows as a `Series` has them, without those that have no value or no load."""
    columns = {"x": rows["load_N"], "value": value, "std": std, "left_out": ~rows["pooled"]}
    known = value.notna() & (rows["load_N"] > 0)
    return {name: column[known].to_numpy() for name, column in columns.items()}


def _aspect_ratio_std(rows: pd.DataFrame) -> FloatArray:
    """Return the standard uncertainty of the axes' ratio, from noise and from the place of the edge."""
    major, minor = (
        rows[[name, f"{name}_noise_std"]].to_numpy().T for name in ("semi_major_mm", "semi_minor_mm")
    )
    edge = rows["edge_offset_mm_std"].to_numpy() * (1 / minor[0] - 1 / major[0])
    parts = [major[1] / major[0], minor[1] / minor[0], edge]
    return as_float_array(rows["aspect_ratio"] * np.linalg.norm(parts, axis=0))
