"""What a run wrote, set beside the truth."""

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import pandas as pd

from benchmarks.tables import share

from .lab import Truth

NO_DOUBT = {"", "None", "holds", "not_tested", "not tested"}
_ENDS = "", "_std", "_total_std", "_model_std", "_ci95_low", "_ci95_high"


# One stated number beside the truth; open ends of intervals and deep tissue are infinite.
COLUMNS = "quantity", "value", "std", "low", "high", "truth", "flags"
Comparison: TypeAlias = tuple[str, float, float, float, float, float, str]


def _read(
    record: Mapping[str, Any], flags: Iterable[Any], *numbers: tuple[str, str, float]
) -> Iterator[Comparison]:
    """Yield numbers of a record, each given as its key, what it is called, and the truth.

    Its total uncertainty is by whichever keys state it.
    """
    words = " ".join(sorted({str(flag) for flag in flags} - NO_DOUBT))
    for key, quantity, truth in numbers:
        stated = (record.get(key + end) for end in _ENDS)
        value, std, total, model, low, high = (math.nan if x in (None, "") else float(x) for x in stated)
        interval = record.get(f"{key}_ci95")
        if interval is not None:
            low = -math.inf if interval[0] is None else interval[0]
            high = math.inf if interval[1] is None else interval[1]
        elif math.isnan(value):
            continue
        if math.isnan(total) and model > 0:
            total = math.hypot(std, model)
        std = total if total > 0 else std
        if total > 0 or math.isnan(low):
            low, high = np.fmin(low, value - 1.96 * std), np.fmax(high, value + 1.96 * std)
        yield quantity, value, std, float(low), float(high), truth, words


def _image(truth: Truth, row: dict[str, str]) -> Iterator[Comparison]:
    """Compare a row of results.csv."""
    name, flags = row["observation"], row["flags"].split()
    area, xi, (major, minor) = truth.areas[name], truth.indentation[name], truth.axes[name]
    axes = ("semi_major_mm", "contact semi-axes", major), ("semi_minor_mm", "contact semi-axes", minor)
    yield from _read(row, flags, ("gross_area_mm2", "contact area", area), *axes)
    yield from _read(
        row,
        [*flags, row["layer_flag"]],
        ("indentation_on_layer_mm", "ξ on stated layer", xi),
        ("loading_radius_on_layer_mm", "A/(πξ) on it", area / (math.pi * xi)),
        ("youngs_modulus_on_layer_kpa", "E on it, each image", truth.youngs_modulus),
    )


def _semi_axes(truth: Truth, finger: dict[str, Any]) -> Iterator[Comparison]:
    """Compare a finger of summary.json."""
    method = finger["finger"].removeprefix("finger").strip("_") or truth.method
    for k, axis in enumerate(("palmar", "distal", "radial_ulnar")):
        record = {axis: finger[f"{axis}_mm"], f"{axis}_std": math.sqrt(finger["covariance_mm2"][k][k])}
        yield from _read(record, _flags(finger), (axis, f"pad semi-axes, {method}", getattr(truth.pad, axis)))


def _summary(truth: Truth, record: dict[str, Any], pad_flags: list[str]) -> Iterator[Comparison]:
    """Compare a finger at an angle of summary.json."""
    wedge, validity, modulus = round(record["wedge_angle_deg"]), record["validity"], truth.youngs_modulus
    yield from _read(
        record,
        pad_flags,
        ("mean_curvature_radius_mm", "R_0g", truth.mean_radius[wedge]),
        ("radius_from_indentation_mm", "corrected radius", truth.corrected_radius[wedge]),
    )
    xi = truth.indentation.get(str(validity["observation"]), math.nan)
    for key, quantity, true in (
        ("youngs_modulus_kpa", "E Hertz, headline", modulus),
        ("indentation_mm", "ξ Hertz, headline", xi),
    ):
        headline = validity["headlines"][key]
        stated = {key: headline["value"], f"{key}_std": headline["value_std"]}
        stated[f"{key}_total_std"] = headline["total_std"]
        yield from _read(stated, [headline["verdict"]], (key, quantity, true))
    yield from _read(
        (record.get("on_layer") or {}).get("pooled") or {},
        [(validity.get("on_layer") or {}).get("verdict")],
        ("youngs_modulus_on_layer_kpa", "E on stated layer, pooled", modulus),
        ("loading_radius_on_layer_mm", "A/(πξ) on it, pooled", truth.loading_radius[wedge]),
    )


def _load(truth: Truth, row: dict[str, str]) -> Iterator[Comparison]:
    """Compare a row of by_load.csv."""
    for key, words, quantity in (
        ("youngs_modulus_kpa", ("flags", "range_notes"), "E in by_load.csv"),
        ("youngs_modulus_on_layer_kpa", ("layer_flag",), "E on layer in by_load.csv"),
    ):
        flags = [row.get(word) for word in (f"{key}_verdict", *words)]
        yield from _read(row, flags, (key, quantity, truth.youngs_modulus))


def _curve(truth: Truth, curve: dict[str, Any]) -> Iterator[Comparison]:
    """Compare a loading curve of summary.json."""
    wedge, modulus = round(curve["wedge_angle_deg"]), truth.youngs_modulus
    fit, layer, on_layer = (curve.get(k) or {} for k in ("fit", "layer", "on_layer"))
    flags, offset = fit.get("flags") or [], truth.contact_offset[wedge]
    yield from _read(
        fit,
        flags,
        ("loading_radius_mm", "curve: R_g", truth.loading_radius[wedge]),
        ("initial_modulus_kpa", "curve: E_0g, own equation", truth.initial_modulus[wedge]),
        ("initial_modulus_kpa", "curve: E_0g as tissue E", modulus),
        ("contact_offset_mm", "curve: x₀ (µm)", offset),
    )
    yield from _read(
        layer,
        layer.get("flags") or [],
        ("thickness_mm", "layer fit: t", truth.thickness),
        ("youngs_modulus_kpa", "layer fit: E", modulus),
        ("contact_offset_mm", "layer fit: x₀ (µm)", offset),
        ("radius_mm", "layer fit: radius", truth.mean_radius[wedge]),
    )
    key = "youngs_modulus_from_indentation_on_layer_kpa"
    words = [*flags, on_layer.get("layer_flag")]
    yield from _read(on_layer, words, (key, "E from curve's ξ on layer", modulus))


def _flags(finger: dict[str, Any]) -> list[str]:
    flags = [flag for item in finger.get("photographs") or [] for flag in item.get("flags") or []]
    disagree = ["faces_disagree"] if (finger.get("p_value") or 1) < 0.01 else []
    return [*flags, *(finger.get("flags") or []), *disagree]


def compare(truth: Truth, results: Path) -> Iterator[Comparison]:
    """Compare all that a run wrote of a lab with the truth."""
    summary = json.loads((results / "summary.json").read_text())
    rows, by_load = (
        pd.read_csv(results / name, dtype=str, na_filter=False).to_dict("records")
        for name in ("results.csv", "by_load.csv")
    )
    rows = [row for row in rows if row["status"] == "measured"]
    for row in rows:
        yield from _image(truth, row)
    for finger in summary["fingers"]:
        if finger["palmar_mm"] is not None:  # refused, with its reason, where faces contradict each other
            yield from _semi_axes(truth, finger)
    flags = next(_flags(f) for f in summary["fingers"] if f["finger"] == "finger")
    for record in summary["summaries"]:
        here = [r for r in rows if float(r["wedge_angle_deg"]) == record["wedge_angle_deg"]]
        notes = {note for r in here for note in r["range_notes"].split()}
        pad_notes = notes & {"curvature_disagrees", "faces_disagree", "implausible_size"}
        yield from _summary(truth, record, [*flags, *pad_notes])
    for row in by_load:
        yield from _load(truth, row)
    for curve in summary["curves"]:
        yield from _curve(truth, curve)


def by_quantity(rows: list[Comparison]) -> Iterator[tuple[object, ...]]:
    """Yield a row for each quantity: errors, what was stated, held, flagged, and missed in silence.

    Errors are in µm of a place of contact, else in % of the truth.
    """
    found = pd.DataFrame(rows, columns=COLUMNS)
    unit = np.where(found["quantity"].str.endswith("(µm)"), 1e-3, found["truth"] / 100)
    found["error"], found["stated"] = (found["value"] - found["truth"]) / unit, found["std"] / unit
    found["held"] = found["truth"].between(found["low"], found["high"])
    found["flagged"] = found["flags"] != ""
    for quantity, group in found.groupby("quantity", sort=False):
        finite = group[np.isfinite(group["truth"]) & (group["std"] > 0)]
        means = math.sqrt((finite["error"] ** 2).mean()), finite["stated"].mean()
        numbers = [f"{x:.1f}" for x in means] if len(finite) else ["–", "–"]
        missed = (~group["held"] & ~group["flagged"]).sum()
        yield quantity, len(group), *numbers, share(group["held"]), share(group["flagged"]), missed
