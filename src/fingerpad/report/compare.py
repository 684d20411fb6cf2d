"""Comparison of studies as one page and its figures."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from markupsafe import Markup

import fingerpad
from fingerpad._files import explain_write_errors, make_folder
from fingerpad._rounding import two_digits, value_with_uncertainty
from fingerpad._words import capitalized
from fingerpad.figures import new_panels
from fingerpad.figures.compare import colours_of, plot_forest
from fingerpad.report.plot import Plot, save_plots
from fingerpad.report.plots import by_wedge_plot
from fingerpad.report.templates import templates
from fingerpad.report.text import VERDICT_SYMBOLS
from fingerpad.study.compare import QUANTITIES, Comparison, Mean, Value

_LONGEST_LABEL: Final = 38
# More fingers than these make no readable figure: their people are drawn in their place.
_MOST_ROWS: Final = 100
_KEY: Final = ", ".join(f"{verdict} {symbol}" for verdict, symbol in VERDICT_SYMBOLS.items())
_SYMBOLS: Final = {
    "palmar_mm": "ℓ<sub>a</sub>",
    "distal_mm": "ℓ<sub>b</sub>",
    "radial_ulnar_mm": "ℓ<sub>c</sub>",
    "mean_curvature_radius_mm": "R<sub>0g</sub>",
    "radius_from_indentation_mm": "R<sub>g</sub><sup>corr</sup>",
    "highest_area_mm2": "A",
    "youngs_modulus_kpa": "E",
    "youngs_modulus_on_layer_kpa": "E<sub>layer</sub>",
    "initial_modulus_kpa": "E<sub>0g</sub>",
    "load_exponent": "m",
    "curve_area_exponent": "n",
    "area_exponent": "n",
}


def write_comparison_page(comparison: Comparison, out: Path) -> Path:
    """Write ``compare.html`` and ``figures/compare_*`` into `out`, and return the page's path."""
    make_folder(out / "figures")
    path = out / "compare.html"
    with explain_write_errors(path, "make room, or choose another --out"):
        template = templates().get_template("compare.html.jinja")
        page = template.render(
            interval=_interval,
            two=_two_digits,
            comparison=comparison,
            version=fingerpad.__version__,
            quantities=[
                {
                    "name": name,
                    "symbol": Markup(_SYMBOLS[name]),  # noqa: S704 (written here)
                    "unit": kind.unit,
                    "words": kind.words,
                    "values": comparison.of(name)[0],
                    "means": comparison.of(name)[1],
                    "judged": any(value.verdict for value in comparison.of(name)[0]),
                    "figures": save_plots(forest_plot(comparison, name), out / "figures"),
                }
                for name, kind in QUANTITIES.items()
                if comparison.of(name)[0]
            ],
            by_wedge=save_plots(wedge_plot(comparison), out / "figures"),
            synthetic=any(value.synthetic for value in comparison.values),
        )
        path.write_text(page, encoding="utf-8")
    return path


def forest_plot(comparison: Comparison, quantity: str) -> Iterator[Plot]:
    """Yield the forest plot of one quantity: a panel for each placement, a row for each finger."""
    every_value, means = comparison.of(quantity)
    if not every_value:
        return
    kind = QUANTITIES[quantity]
    values = _shown(every_value, means)
    rows, labels, places = _rows(values, means)
    panels = list(dict.fromkeys((value.wedge_angle_deg, value.roll_angle_deg) for value in values))
    figure, every = new_panels(
        width_mm=48 + 52 * len(panels), height_mm=16 + 4.6 * len(labels), columns=len(panels)
    )
    colours = colours_of([value.person.name for value in comparison.values])
    for axes, (wedge, roll) in zip(every, panels, strict=True):
        here = [row for row in rows if (row[1].wedge_angle_deg, row[1].roll_angle_deg) == (wedge, roll)]
        plot_forest(
            axes,
            here,
            colours=colours,
            symbols=VERDICT_SYMBOLS,
            means=[
                (places[mean.synthetic, mean.load], mean)
                for mean in means
                if (mean.wedge_angle_deg, mean.roll_angle_deg) == (wedge, roll) and len(mean.people) > 1
            ],
            title="" if wedge is None else f"wedge {wedge:g}°" + (f", roll {roll:g}°" if roll else ""),
        )
        names = labels if axes is every[0] else [""] * len(labels)
        axes.y = replace(
            axes.y, low=len(labels) - 0.4, high=-0.6, ticks=tuple(range(len(labels))), names=tuple(names)
        )
        axes.x = replace(axes.x, label=f"{kind.symbol} ({kind.unit})" if kind.unit else kind.symbol)
    yield Plot(
        name=f"compare_{quantity}",
        figure=figure,
        caption=f"{capitalized(kind.words)}, with one standard uncertainty"
        + ("; diamonds: means over people with their 95 % interval, which may leave the frame; bar: one "
           "standard deviation between people" if any(len(mean.people) > 1 for mean in means) else "")
        + (". Hollow: synthetic" if any(value.synthetic for value in values) else "")
        + (f". At the right: the model {_KEY}" if any(value.verdict for value in values) else "")
        + ".",
    )  # fmt: skip


def _rows(
    values: Sequence[Value], means: Sequence[Mean]
) -> tuple[list[tuple[int, Value]], list[str], dict[tuple[bool, float | None], int]]:
    """Return the row of each value, the names of rows, and those of means: real, synthetic, at each load."""

    def key(value: Value) -> tuple[bool, str, str, str]:
        return value.synthetic, value.person.name, value.finger, value.study

    order = {each: place for place, each in enumerate(sorted({key(value) for value in values}))}
    fingers = [each[:3] for each in order]
    labels = [_label(*each[:3], each[3] if fingers.count(each[:3]) > 1 else "") for each in order]
    places = {}
    for mean in sorted(means, key=lambda mean: (mean.synthetic, mean.load or 0.0)):
        if len(mean.people) > 1 and (mean.synthetic, mean.load) not in places:
            places[mean.synthetic, mean.load] = len(labels)
            at = "" if mean.load is None else f" at {mean.load:g} N"
            labels.append(f"mean over people{at}{' (synthetic)' if mean.synthetic else ''}")
    return [(order[key(value)], value) for value in values], labels, places


def _shown(values: Sequence[Value], means: Sequence[Mean]) -> Sequence[Value]:
    """Return the values, or the means of people where there are too many fingers for a figure."""
    if len({(value.study, value.finger) for value in values}) <= _MOST_ROWS:
        return values
    return [
        Value(
            quantity=mean.quantity,
            study="",
            person=each.person,
            finger=f"{each.fingers} finger{'s' if each.fingers > 1 else ''}",
            synthetic=mean.synthetic,
            value=each.value,
            std=each.std,
            wedge_angle_deg=mean.wedge_angle_deg,
            roll_angle_deg=mean.roll_angle_deg,
            load=math.nan if mean.load is None else mean.load,
        )
        for mean in means
        for each in mean.people
    ]


def _label(synthetic: bool, person: str, finger: str, study: str) -> str:
    name = finger if finger.startswith(person) else f"{person}, {finger}"
    name = f"{name}, {study}" if study else name
    short = name if len(name) <= _LONGEST_LABEL else f"…{name[1 - _LONGEST_LABEL :]}"
    return f"{short} (synthetic)" if synthetic else short


def wedge_plot(comparison: Comparison) -> Iterator[Plot]:
    """Yield the corrected radius against the wedge angle, a line for each finger, where angles differ."""
    values, means = comparison.of("radius_from_indentation_mm")
    kind = QUANTITIES["radius_from_indentation_mm"]
    yield from by_wedge_plot(
        "compare_radius_by_wedge",
        (
            ((one.person.name, one.study, one.finger), one.synthetic, one.wedge_angle_deg, one.value, one.std)
            for one in values
            if not one.roll_angle_deg and one.wedge_angle_deg is not None
        ),
        [value.person.name for value in comparison.values],
        [
            (mean.wedge_angle_deg or 0.0, mean)
            for mean in means
            if not mean.roll_angle_deg and len(mean.people) > 1
        ],
        label=f"corrected radius {kind.symbol} ({kind.unit})",
    )


def _interval(mean: Mean) -> str:
    """Return the 95 % interval with the digits of the mean."""
    if mean.interval is None:
        return "–"
    low, high = (value_with_uncertainty(end, mean.std).partition(" ±")[0] for end in mean.interval)
    return f"{low} to {high}"


def _two_digits(std: float) -> str:
    return two_digits(std) if std >= 0 else "–"
