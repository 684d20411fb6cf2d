"""The figures of a study's report, one set for each finger and placement."""

from collections.abc import Iterator, Sequence
from typing import Any, Final

import numpy as np
import pandas as pd

from fingerpad._arrays import FloatArray
from fingerpad._files import file_stem
from fingerpad.contact import Tissue, hertz_contact
from fingerpad.estimate import Estimate
from fingerpad.figures import (
    plot_agreement,
    plot_area_against_indentation,
    plot_area_against_load,
    plot_aspect_ratio,
    plot_corrected_radius,
    plot_initial_modulus,
    plot_pad_with_contact,
    plot_press,
    plot_uncertainty_budget,
)
from fingerpad.figures.compare import (
    MOST_NAMES,
    FingerLine,
    LoadLine,
    MeanMark,
    colours_of,
    plot_by_wedge,
    plot_over_load,
)
from fingerpad.figures.marks import Figure, Marker, new_panels
from fingerpad.geometry import Ellipse, Ellipsoid, Placement
from fingerpad.report.loading import loading_plots
from fingerpad.report.plot import Plot, panel
from fingerpad.report.simulator import simulator_plots
from fingerpad.study.measuring.curves import CurveResult, LoadingRadius, loading_radius
from fingerpad.study.measuring.sequences import SequenceResult
from fingerpad.study.results.output import Answer
from fingerpad.study.results.pooling import Exponent, Summary, area_exponent
from fingerpad.study.results.rows import PlacementKey
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.summary_file import UncertaintyCheckRecord
from fingerpad.study.results.table import Indices, Row, records
from fingerpad.study.results.validity import RADIUS, Headline

# More than these only make a page heavy.
_MOST_FRAMES: Final = 150
MOST_POINTS: Final = 60
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
    moduli = dict.fromkeys("{0} ({2}s)".format(*_MODULI[one.on_bone]) for one in found)
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
        lines = [
            LoadLine(
                name=one.label,
                colour=colours[one.label],
                synthetic=one.of.synthetic,
                **values(rows, one),
            )
            for rows, one in pairs
        ]
        figure, (axes,) = new_panels(height_mm=78)
        plot_over_load(axes, lines, label=label, beside=_BESIDE if name == "radius" else ())
        yield Plot(name=f"{prefix}{name}_over_load", figure=figure, caption=caption)


def summary_plots(result: StudyResult, summary: Summary) -> Iterator[Plot]:
    """Draw one finger at one placement."""
    rows = shown_rows(summary)
    (last,) = records(rows[-1:])
    name = group_name(summary.key)
    label = "; synthetic" if summary.synthetic else ""
    where = f"{summary.finger}, wedge {summary.wedge_angle_deg:g}°{label}"
    yield Plot(
        name=f"{name}_pad",
        figure=_pad(result, summary, last),
        caption=(
            f"The pad seen through the platen ({where}; grey: not pad), and the contact "
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
        figure=_corrected_radius(rows, loading),
        caption=(
            f"Corrected radius against load ({where}); thin bars: one standard uncertainty, of "
            "which contacts share the parts from the pad's geometry and the model; thick bars: without these "
            f"parts, as Dzidek et al. do. Dotted: undeformed pad.{level}"
        ),
    )
    if np.ptp(rows["load_N"].to_numpy()) > 0:
        yield Plot(
            name=f"{name}_area",
            figure=_area(rows, area_exponent(summary.areas)),
            caption=f"Contact area against load, with the fitted exponent and that of Hertz ({where}). "
            "± of the exponent is from the scatter about the line, over frames from its bends, and from the "
            "contact edge; the check of the model takes in the stated uncertainties of areas and loads.",
        )
    if rows["long_axis"].notna().any():
        yield Plot(
            name=f"{name}_aspect_ratio",
            figure=_aspect_ratio(rows),
            caption=f"Aspect ratio and direction of the long axis, measured and predicted ({where}).",
        )


def agreement_plots(result: StudyResult) -> Iterator[Plot]:
    """Draw how two persons agree on the areas of the images that both outlined."""
    for found in result.operators:
        if (area := found.quantities.get("gross_area_mm2")) is None:
            continue
        yield Plot(
            name="second_operator_synthetic" if found.synthetic else "second_operator",
            figure=panel(
                plot_agreement,
                [one.first["gross_area_mm2"] for one in found.pairs],
                [one.second["gross_area_mm2"] for one in found.pairs],
                area,
                quantity="gross area (mm²)",
                names=[" and ".join(names) for names in found.operators],
                synthetic=found.synthetic,
            ),
            caption="Contact areas by two persons, the second without seeing the first's outlines"
            + ("; synthetic images" if found.synthetic else "")
            + ". Line: bias, with its 95 % interval. Dashed: limits of agreement.",
        )


def wedge_plot(result: StudyResult) -> Iterator[Plot]:
    """Draw the corrected radius of every finger against the wedge angle, where angles differ."""
    found = [
        (one, validity.headlines[RADIUS])
        for one, validity in zip(result.summaries, result.validities, strict=True)
        if one.corrected_radius and not one.roll_angle_deg
    ]
    if len({one.wedge_angle_deg for one, _ in found}) < 2:
        return
    lines: dict[tuple[str, bool], list[tuple[float, Headline]]] = {}
    for one, radius in sorted(found, key=lambda each: each[0].wedge_angle_deg):
        lines.setdefault((one.finger, one.synthetic), []).append((one.wedge_angle_deg, radius))
    colours = colours_of(list(result.fingers))
    yield by_wedge_plot(
        "corrected_radius_by_wedge",
        [
            FingerLine(
                person=finger,
                colour=colours[finger],
                wedge_angle_deg=[angle for angle, _ in points],
                value=[radius.value for _, radius in points],
                std=[radius.total_std for _, radius in points],
                synthetic=synthetic,
            )
            for (finger, synthetic), points in lines.items()
        ],
        label="corrected radius (mm)",
    )


def by_wedge_plot(
    name: str, lines: Sequence[FingerLine], means: Sequence[tuple[float, MeanMark]] = (), *, label: str
) -> Plot:
    """Return corrected radii against wedge angle as a separate figure."""
    figure, (axes,) = new_panels(width_mm=140, height_mm=95)
    plot_by_wedge(axes, lines, means, label=label)
    return Plot(
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
        label = "; synthetic" if synthetic else ""
        yield Plot(
            name=f"{group_name((finger, wedge, 0.0, synthetic))}_initial_modulus",
            figure=panel(
                plot_initial_modulus,
                [velocity for velocity, _ in found],
                [initial.value for _, initial in found],
                initial_modulus_std=[initial.std for _, initial in found],
                synthetic=np.full(len(found), synthetic),
            ),
            caption=f"Young's modulus at no load against velocity ({finger}, wedge {wedge:g}°{label}).",
        )


def budget_plot(summary: Summary, check: UncertaintyCheckRecord | None) -> Iterator[Plot]:
    """Draw who contributes what to the uncertainty of the highest_load contact's corrected radius."""
    if check is None:
        return
    yield Plot(
        name=f"{group_name(summary.key)}_budget",
        figure=panel(plot_uncertainty_budget, check.shares, total=check.total, synthetic=summary.synthetic),
        caption=f"Shares of the variance of the corrected radius of {check.observation}: of first order, and "
        "Sobol's total index, which counts interactions.",
    )


def press_plot(sequence: SequenceResult, frames: pd.DataFrame) -> Iterator[Plot]:
    """Draw one sequence."""
    of = sequence.manifest
    seen = frames[frames["semi_major_mm"].notna()]
    if seen.empty:
        return
    rows = thinned(seen, _MOST_FRAMES)
    figure, axes = new_panels(width_mm=170, height_mm=110, rows=2, columns=2)
    synthetic = bool(rows["synthetic"].iloc[0])
    plot_press(
        axes,
        time=rows["time_s"].to_numpy(),
        load=rows["load_N"].to_numpy(),
        phase=rows["phase"].tolist(),
        area=rows["gross_area_mm2"].to_numpy(),
        semi_major=rows["semi_major_mm"].to_numpy(),
        semi_minor=rows["semi_minor_mm"].to_numpy(),
        synthetic=synthetic,
    )
    manual = " Phases were set manually." if sequence.phases else ""
    some = "" if len(rows) == len(seen) else f" {len(rows)} of {len(seen)} frames are drawn."
    yield Plot(
        name=f"sequence_{file_stem(of.name)}{'_synthetic' if synthetic else ''}",
        figure=figure,
        caption=(
            f"Contact area and semi-axes against time and against force ({of.name}, {of.finger}, wedge "
            f"{of.wedge_angle_deg:g}°{'; synthetic' if synthetic else ''}).{manual}{some}"
        ),
    )


def area_indentation_plot(sequence: SequenceResult, frames: pd.DataFrame) -> Iterator[Plot]:
    """Draw area against measured indentation of one sequence, where a displacement was recorded."""
    seen = frames[frames["gross_area_mm2"].notna() & frames["measured_indentation_mm"].notna()]
    if seen.empty:
        return
    of, rows = sequence.manifest, thinned(seen, _MOST_FRAMES)
    synthetic = bool(rows["synthetic"].iloc[0])
    yield Plot(
        name=f"sequence_{file_stem(of.name)}_indentation{'_synthetic' if synthetic else ''}",
        figure=panel(
            plot_area_against_indentation,
            rows["measured_indentation_mm"].to_numpy(),
            rows["gross_area_mm2"].to_numpy(),
            phase=rows["phase"].tolist(),
            synthetic=synthetic,
        ),
        caption=(
            f"Contact area against the platen's displacement from the place of contact ({of.name}, "
            f"{of.finger}, wedge {of.wedge_angle_deg:g}°{'; synthetic' if synthetic else ''}); the stage is "
            "taken as rigid."
        ),
    )


def shown_rows(summary: Summary) -> pd.DataFrame:
    """Return the rows to show one by one, by load: single contacts, or where there are none frames."""
    table, places = summary.table, summary.places
    single, pooled = summary.column("frame").isna(), summary.column("pooled")
    shown = next((some for some in (places[single], places[pooled]) if some.size), places)
    # Of all columns only what is shown is copied.
    return table.iloc[shown[_evenly(shown.size, MOST_POINTS)]]


def thinned(rows: pd.DataFrame, most: int) -> pd.DataFrame:
    """Return at most so many rows, evenly spaced, with the first and the last."""
    return rows.iloc[_evenly(len(rows), most)]


def _evenly(count: int, most: int) -> Indices:
    return np.linspace(0, count - 1, min(count, most)).round().astype(np.intp)


def _pad(result: StudyResult, summary: Summary, row: Row) -> Figure:
    pad = Ellipsoid(*result.fingers[summary.finger].semi_axes)
    wedge, roll = np.radians([summary.wedge_angle_deg, summary.roll_angle_deg])
    placement = Placement(pad, wedge_angle=wedge, roll_angle=roll)
    area = np.pi * row["semi_major_mm"] * row["semi_minor_mm"]
    contact = hertz_contact(placement, Tissue(youngs_modulus=1.0), area=area)
    predicted = Ellipse(contact.semi_major, contact.semi_minor)
    measured = Ellipse(row["semi_major_mm"], row["semi_minor_mm"]) if row["long_axis"] else None
    angle = (
        row["orientation_deg"]
        if row["orientation_deg"] is not None
        else 90.0 * (row["long_axis"] == "across")
    )
    figure, (axes,) = new_panels(height_mm=95)
    plot_pad_with_contact(
        axes,
        pad,
        wedge_angle=float(wedge),
        roll_angle=float(roll),
        predicted=predicted,
        measured=measured,
        measured_long_axis_angle=float(np.radians(angle)),
        synthetic=summary.synthetic,
    )
    return figure


def _areas(rows: pd.DataFrame, _: Answer) -> dict[str, Any]:
    return _points(rows, np.pi * rows["semi_major_mm"] * rows["semi_minor_mm"], rows["gross_area_mm2_std"])


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
    """Return rows as a `LoadLine` has them, without those that have no value or no load."""
    columns = {"load": rows["load_N"], "value": value, "std": std, "left_out": ~rows["pooled"]}
    known = value.notna() & (rows["load_N"] > 0)
    return {name: column[known].to_numpy() for name, column in columns.items()}


def _corrected_radius(rows: pd.DataFrame, loading: LoadingRadius | None) -> Figure:
    return panel(
        plot_corrected_radius,
        rows["load_N"].to_numpy(),
        rows["radius_from_indentation_mm"].to_numpy(),
        corrected_radius_std=rows["radius_from_indentation_mm_total_std"].to_numpy(),
        fixed_geometry_std=rows["radius_from_indentation_mm_fixed_geometry_std"].to_numpy(),
        compliance_radius=rows["radius_from_compliance_mm"].to_numpy(),
        measured_radius=None if loading is None else loading.value,
        measured_radius_std=None if loading is None else loading.std,
        mean_curvature_radius=rows["mean_curvature_radius_mm"].iloc[0],
        synthetic=rows["synthetic"].to_numpy(),
        left_out=~rows["pooled"].to_numpy(),
    )


def _area(rows: pd.DataFrame, exponent: Exponent) -> Figure:
    major, minor = rows["semi_major_mm"].to_numpy(), rows["semi_minor_mm"].to_numpy()
    return panel(
        plot_area_against_load,
        rows["load_N"].to_numpy(),
        np.pi * major * minor,
        area_std=rows["gross_area_mm2_std"].to_numpy(),
        exponent=exponent.value,
        exponent_std=exponent.std,
        synthetic=rows["synthetic"].to_numpy(),
        left_out=~rows["pooled"].to_numpy(),
    )


def _aspect_ratio(rows: pd.DataFrame) -> Figure:
    ratio = rows["aspect_ratio"].to_numpy()
    names = ("semi_major_mm", "semi_minor_mm")
    noise = [rows[f"{name}_noise_std"].to_numpy() / rows[name].to_numpy() for name in names]
    edge = rows["edge_offset_mm_std"].to_numpy() * (
        1 / rows[names[1]].to_numpy() - 1 / rows[names[0]].to_numpy()
    )
    across = np.where(rows["long_axis"].to_numpy() == "across", 90.0, 0.0)
    orientation = rows["orientation_deg"].to_numpy()
    first = rows.iloc[0]
    return panel(
        plot_aspect_ratio,
        rows["load_N"].to_numpy(),
        ratio,
        aspect_ratio_std=ratio * np.linalg.norm([*noise, edge], axis=0),
        long_axis_angle=np.radians(np.where(np.isfinite(orientation), orientation, across)),
        predicted_aspect_ratio=first["predicted_aspect_ratio"],
        predicted_long_axis_angle=np.pi / 2 if first["predicted_long_axis"] == "across" else 0.0,
        synthetic=rows["synthetic"].to_numpy(),
        left_out=~rows["pooled"].to_numpy(),
    )
