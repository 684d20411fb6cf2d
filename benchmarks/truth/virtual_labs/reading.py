"""What a run wrote, set beside the truth."""

import csv
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.tables import share

from .lab import Truth

NO_DOUBT = {"", "None", "holds", "not_tested", "not tested"}


@dataclass(frozen=True)
class Comparison:
    """One stated number beside the truth; open ends of intervals and deep tissue are infinite."""

    seed: int
    bone: bool
    shape: str
    where: str
    quantity: str
    value: float
    std: float
    low: float
    high: float
    truth: float
    flags: str

    @property
    def covered(self) -> bool:
        """Whether the 95 % interval holds the truth."""
        return self.low <= self.truth <= self.high

    @property
    def silent(self) -> bool:
        """Whether it misses the truth and nothing beside it says so."""
        return not self.covered and not self.flags

    @property
    def unit(self) -> float:
        """What errors are given in: µm of a place of contact, else % of the truth."""
        return 1e-3 if self.quantity.endswith("(µm)") else self.truth / 100


def _number(value: Any) -> float:
    return math.nan if value is None or value == "" else float(value)


class _Reader:
    """Comparisons of one lab."""

    def __init__(self, truth: Truth) -> None:
        self.truth = truth
        self.found: list[Comparison] = []

    def add(
        self,
        where: str,
        quantity: str,
        record: Mapping[str, Any],
        key: str,
        truth: float,
        *,
        flags: Iterable[Any],
    ) -> None:
        """Add the number ``key`` of a record with its total uncertainty, by whichever keys state it."""
        value, std, total, model, low, high = (
            _number(record.get(key + end))
            for end in ("", "_std", "_total_std", "_model_std", "_ci95_low", "_ci95_high")
        )
        interval = record.get(f"{key}_ci95")
        if interval is not None:
            low = -math.inf if interval[0] is None else interval[0]
            high = math.inf if interval[1] is None else interval[1]
        elif math.isnan(value):
            return
        if math.isnan(total) and model > 0:
            total = math.hypot(std, model)
        std = total if total > 0 else std
        if total > 0 or math.isnan(low):
            low, high = np.fmin(low, value - 1.96 * std), np.fmax(high, value + 1.96 * std)
        named = " ".join(sorted({str(flag) for flag in flags} - NO_DOUBT))
        t = self.truth
        shape = "ellipsoid" if t.kind == "ellipsoid" else "other"
        numbers = value, std, float(low), float(high), truth
        self.found.append(Comparison(t.seed, t.bone, shape, where, quantity, *numbers, named))

    def image(self, row: dict[str, str]) -> None:
        """Compare a row of results.csv."""
        name, truth, flags = row["observation"], self.truth, row["flags"].split()
        xi, layer_flags = truth.indentation[name], [*flags, row["layer_flag"]]
        self.add(name, "contact area", row, "gross_area_mm2", truth.areas[name], flags=flags)
        for key, true in zip(("semi_major_mm", "semi_minor_mm"), truth.axes[name], strict=True):
            self.add(name, "contact semi-axes", row, key, true, flags=flags)
        for quantity, key, true in (
            ("ξ on stated layer", "indentation_on_layer_mm", xi),
            ("A/(πξ) on it", "loading_radius_on_layer_mm", truth.areas[name] / (math.pi * xi)),
            ("E on it, each image", "youngs_modulus_on_layer_kpa", truth.youngs_modulus),
        ):
            self.add(name, quantity, row, key, true, flags=layer_flags)

    def semi_axes(self, finger: dict[str, Any]) -> None:
        """Compare a finger of summary.json."""
        method = finger["finger"].removeprefix("finger").strip("_") or self.truth.method
        for k, axis in enumerate(("palmar", "distal", "radial_ulnar")):
            record = {axis: finger[f"{axis}_mm"], f"{axis}_std": math.sqrt(finger["covariance_mm2"][k][k])}
            true = getattr(self.truth.pad, axis)
            self.add(axis, f"pad semi-axes, {method}", record, axis, true, flags=_finger_flags(finger))

    def summary(self, record: dict[str, Any], pad_flags: list[str]) -> None:
        """Compare a finger at an angle of summary.json."""
        truth, wedge = self.truth, round(record["wedge_angle_deg"])
        where, modulus = f"@{wedge}", truth.youngs_modulus
        true_radius, corrected = truth.mean_radius[wedge], truth.corrected_radius[wedge]
        self.add(where, "R_0g", record, "mean_curvature_radius_mm", true_radius, flags=pad_flags)
        self.add(where, "corrected radius", record, "radius_from_indentation_mm", corrected, flags=pad_flags)
        validity = record["validity"]
        xi = truth.indentation.get(str(validity["observation"]), math.nan)
        for key, quantity, true in (
            ("youngs_modulus_kpa", "E Hertz, headline", modulus),
            ("indentation_mm", "ξ Hertz, headline", xi),
        ):
            headline = validity["headlines"][key]
            stated = {key: headline["value"], f"{key}_std": headline["value_std"]}
            stated[f"{key}_total_std"] = headline["total_std"]
            self.add(where, quantity, stated, key, true, flags=[headline["verdict"]])
        layer = (record.get("on_layer") or {}).get("pooled") or {}
        flags = [(validity.get("on_layer") or {}).get("verdict")]
        for key, quantity, true in (
            ("youngs_modulus_on_layer_kpa", "E on stated layer, pooled", modulus),
            ("loading_radius_on_layer_mm", "A/(πξ) on it, pooled", truth.loading_radius[wedge]),
        ):
            self.add(where, quantity, layer, key, true, flags=flags)

    def load(self, row: dict[str, str]) -> None:
        """Compare a row of by_load.csv."""
        where, true = f"@{round(float(row['wedge_angle_deg']))} {row['load_N']} N", self.truth.youngs_modulus
        words = [row.get(k) for k in ("youngs_modulus_kpa_verdict", "flags", "range_notes")]
        self.add(where, "E in by_load.csv", row, "youngs_modulus_kpa", true, flags=words)
        flags = [row.get("youngs_modulus_on_layer_kpa_verdict"), row.get("layer_flag")]
        self.add(where, "E on layer in by_load.csv", row, "youngs_modulus_on_layer_kpa", true, flags=flags)

    def curve(self, curve: dict[str, Any]) -> None:
        """Compare a loading curve of summary.json."""
        truth, wedge = self.truth, round(curve["wedge_angle_deg"])
        where, offset, modulus = f"@{wedge}", truth.contact_offset[wedge], truth.youngs_modulus
        fit, layer, on_layer = (curve.get(k) or {} for k in ("fit", "layer", "on_layer"))
        flags = list(fit.get("flags") or [])
        radius_key = "loading_radius_mm" if "loading_radius_mm" in fit else "effective_radius_mm"
        for key, quantity, true in (
            (radius_key, "curve: R_g", truth.loading_radius[wedge]),
            ("initial_modulus_kpa", "curve: E_0g, own equation", truth.initial_modulus[wedge]),
            ("initial_modulus_kpa", "curve: E_0g as tissue E", modulus),
            ("contact_offset_mm", "curve: x₀ (µm)", offset),
        ):
            self.add(where, quantity, fit, key, true, flags=flags)
        for key, quantity, true in (
            ("thickness_mm", "layer fit: t", truth.thickness),
            ("youngs_modulus_kpa", "layer fit: E", modulus),
            ("contact_offset_mm", "layer fit: x₀ (µm)", offset),
            ("radius_mm", "layer fit: radius", truth.mean_radius[wedge]),
        ):
            self.add(where, quantity, layer, key, true, flags=layer.get("flags") or [])
        flags = [*flags, on_layer.get("layer_flag")]
        key = "youngs_modulus_from_indentation_on_layer_kpa"
        self.add(where, "E from curve's ξ on layer", on_layer, key, modulus, flags=flags)


def _finger_flags(finger: dict[str, Any]) -> list[str]:
    flags = [flag for item in finger.get("photographs") or [] for flag in item.get("flags") or []]
    disagree = ["faces_disagree"] if (finger.get("p_value") or 1) < 0.01 else []
    return [*flags, *(finger.get("flags") or []), *disagree]


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))


def compare(truth: Truth, results: Path) -> list[Comparison]:
    """Compare all that a run wrote of a lab with the truth."""
    reader, summary = _Reader(truth), json.loads((results / "summary.json").read_text())
    rows = [row for row in _rows(results / "results.csv") if row["status"] == "measured"]
    for row in rows:
        reader.image(row)
    for finger in summary["fingers"]:
        if finger["palmar_mm"] is not None:  # refused, with its reason, where faces contradict each other
            reader.semi_axes(finger)
    flags = next(_finger_flags(f) for f in summary["fingers"] if f["finger"] == "finger")
    for record in summary["summaries"]:
        here = [r for r in rows if float(r["wedge_angle_deg"]) == record["wedge_angle_deg"]]
        notes = {note for r in here for note in r["range_notes"].split()}
        pad_notes = notes & {"curvature_disagrees", "faces_disagree", "implausible_size"}
        reader.summary(record, [*flags, *pad_notes])
    for row in _rows(results / "by_load.csv"):
        reader.load(row)
    for curve in summary["curves"]:
        reader.curve(curve)
    return reader.found


def by_quantity(found: list[Comparison]) -> Iterator[tuple[object, ...]]:
    """Yield a row for each quantity: errors, what was stated, held, flagged, and missed in silence."""
    for quantity in dict.fromkeys(c.quantity for c in found):
        group = [c for c in found if c.quantity == quantity]
        finite = [c for c in group if math.isfinite(c.truth) and c.std > 0]
        e, s = np.array([[(c.value - c.truth) / c.unit, c.std / c.unit] for c in finite]).reshape(-1, 2).T
        numbers = [f"{x:.1f}" for x in (math.sqrt((e**2).mean()), s.mean())] if finite else ["–", "–"]
        shares = [share([c.covered for c in group]), share([bool(c.flags) for c in group])]
        yield quantity, len(group), *numbers, *shares, sum(c.silent for c in group)


def silent_misses(found: list[Comparison]) -> list[str]:
    """Return one line for each number that misses the truth with nothing beside it."""
    return [
        f"seed {c.seed} {c.where}, {c.quantity}: {c.value:.4g} ± {c.std:.2g} "
        f"(95 %: {c.low:.4g} to {c.high:.4g}), true {c.truth:.4g}, {(c.value - c.truth) / c.std:+.1f} std"
        for c in found
        if c.silent
    ]


def verdicts(found: list[Comparison]) -> list[str]:
    """Return how headlines of Hertz theory are judged, by how far they are off, and claims of a thickness."""
    lines = []
    for low, high in ((0, 5), (5, 20), (20, math.inf)):
        words = [
            c.flags or "holds"
            for c in found
            if c.quantity.endswith("headline") and low <= abs(c.value - c.truth) / c.unit < high
        ]
        counts = ", ".join(f"{word} {words.count(word)}" for word in sorted(set(words)))
        lines.append(f"headlines of Hertz theory off by {low} to {high} %: {len(words)} ({counts})")
    deep = [c for c in found if c.quantity == "layer fit: t" and not c.bone]
    claims = [c for c in deep if math.isfinite(c.high)]
    silent, named = [c for c in claims if not c.flags], ", ".join(f"{c.seed}{c.where}" for c in claims)
    lines.append(
        f"deep tissue: a largest thickness in {len(claims)} of {len(deep)}, unflagged {len(silent)} ({named})"
    )
    lines.append(
        f"deep tissue: a thickness as a number in {sum(math.isfinite(c.value) for c in deep)} of {len(deep)}"
    )
    return lines
