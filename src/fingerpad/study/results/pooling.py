"""Contacts of a finger at one placement pooled: radii, quantities on its layer, exponent of the area."""

import math
from dataclasses import asdict, dataclass
from typing import Any, Final, Self

import numpy as np
import numpy.typing as npt
import pandas as pd
from scipy import special

from fingerpad import uncertainty
from fingerpad._arrays import FloatArray, as_float_array
from fingerpad.estimate import Estimate
from fingerpad.study.results import layer, model, summary_file
from fingerpad.study.results.rows import HighestLoad, Rows
from fingerpad.study.results.table import Indices, groups, numbered
from fingerpad.uncertainty.press_slope import PressSlope
from fingerpad.uncertainty.propagate import NORMAL_97_5

# From which exponents and checks of areas follow.
_OF_AREAS: Final = (
    *("observation", "sequence", "scale", "pooled", "load_N", "edge_offset_mm_std"),
    *("semi_major_mm", "semi_minor_mm", "gross_area_mm2", "gross_area_mm2_noise_std"),
)


def area_exponent(rows: pd.DataFrame) -> Estimate:
    """Return the exponent of A ∝ W^n over the pooled of some rows: contacts, or frames of sequences.

    Of contacts two loads give a slope and three its uncertainty, from the scatter about it and the edge; of
    presses it is from their bends, the difference between them and the edge. It is no less than from the
    stated uncertainty of the areas. The interval has Student's t for the scatter.
    """
    sound = rows[[*_OF_AREAS]][rows["pooled"] & (rows["load_N"] > 0)]
    major, minor = sound["semi_major_mm"].to_numpy(), sound["semi_minor_mm"].to_numpy()
    x, y = np.log(sound["load_N"].to_numpy()), np.log(np.pi * major * minor)
    if np.unique(x).size < 2:
        return Estimate.unknown("all that count are at one load")
    presses = PressSlope.of(x, y, area_noise(sound), items_of(sound))
    if presses is None:
        if x.size < 3:
            slope = float(np.polyfit(x, y, 1)[0])
            return Estimate(value=slope, std=math.nan, interval=(math.nan, math.nan))
        (value, _), covariance = np.polyfit(x, y, 1, cov=True)
        weights = np.linalg.pinv(np.vander(x, 2))[0]
        scatter, noise = math.sqrt(covariance[0, 0]), float(np.linalg.norm(weights * area_noise(sound)))
        # A few contacts may lie on a line by chance.
        std = float(np.fmax(scatter, noise))
        half = float(np.fmax(special.stdtrit(x.size - 2, 0.975) * scatter, NORMAL_97_5 * noise))
    else:
        value, weights, std = presses.value, presses.weights, presses.std
        half = NORMAL_97_5 * std
    # An edge further out adds more to the logarithm of a small area: by one line for each device.
    tilts = [float(weights @ edge) for edge in edges_of(sound)]
    value, half = float(value), math.hypot(half, *(NORMAL_97_5 * tilt for tilt in tilts))
    return Estimate(value=value, std=math.hypot(std, *tilts), interval=(value - half, value + half))


def exponent_keys(rows: pd.DataFrame) -> dict[str, Any]:
    """Return `area_exponent` by the keys that records have for it."""
    exponent = area_exponent(rows)
    return {
        "area_exponent": exponent.value,
        "area_exponent_std": exponent.std,
        "area_exponent_ci95": exponent.interval,
    }


def items_of(rows: pd.DataFrame) -> Indices:
    """Return a number for the contact, or the sequence, that each row is of."""
    return numbered(rows["sequence"].where(rows["sequence"].notna(), rows["observation"]))


def edges_of(rows: pd.DataFrame) -> list[FloatArray]:
    """Return what the edge of each device adds to the logarithm of each area."""
    curvature = 1 / rows["semi_major_mm"].to_numpy() + 1 / rows["semi_minor_mm"].to_numpy()
    added, device = rows["edge_offset_mm_std"].to_numpy() * curvature, numbered(rows["scale"])
    return [added * (device == each) for each in np.unique(device)]


def area_noise(rows: pd.DataFrame) -> FloatArray:
    """Return the relative standard uncertainty of the area from errors of its own image."""
    return as_float_array(rows["gross_area_mm2_noise_std"] / rows["gross_area_mm2"])


# Sources that contacts share, parts that a contact shares with no other, and parts of second order.
_SHARED: Final = (*model.OF_THE_PLACEMENT, *model.OF_THE_DEVICE, "thickness")
_OWN: Final = ~np.isin(model.PART_SOURCES, _SHARED)
_SECOND: Final = np.arange(model.PART_SOURCES.size) >= (model.PART_SOURCES.size - len(model.COMMON)) // 2


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PooledRadius(uncertainty.RandomEffects):
    """A radius pooled over contacts, mm, which are taken to have different radii about a mean.

    It counts a sequence as one.
    """

    # its standard uncertainty with semi-axes and angles held exact, as in Dzidek et al. (2017)
    fixed_geometry: float
    # all contacts taken to have one radius; the scatter beyond their uncertainties widens it (Birge)
    fixed: uncertainty.Pooled
    # of contacts under one load (``"repeat"``), and between loads (``"load"``), if only of two
    scatter: uncertainty.NestedScatter
    # share of each source in the variance, with ``"scatter"`` for what the difference between
    # contacts adds
    budget: dict[str, float]

    @property
    def largest_weight(self) -> float:
        """The largest weight of a contact."""
        return float(self.weights.max())

    @property
    def effective_count(self) -> float:
        """Number of contacts of equal weight that would make as much of a mean: 1/Σw²."""
        return float(1 / np.sum(self.weights**2))

    @classmethod
    def of(cls, rows: Rows, pooled: pd.DataFrame, estimate: Indices, output: str) -> Self:
        """Pool one of `POOLED_OUTPUTS`.

        A radius changes with the square of its contact's elongation, and its stated uncertainty with the
        elongation: weights from the stated ones would be largest for contacts that are round by chance, and
        bias the mean. So one slope is used for all contacts; and the pooled radius is that at the mean
        elongation, to second order, without the bias of a mean of squares. The weights contain repeatability
        and the variance between contacts, so that one of little noise does not count for all.

        All of the rows `pooled` must count. `estimate` is one for a single contact, one for all frames of a
        sequence: these show the same skin, pressed once, and their errors are taken to be the same error, so
        that their mean has the uncertainty of one frame, however many there are.
        """
        places = np.searchsorted(rows.pooled, pooled.index.to_numpy())
        parts = rows.parts[places, model.POOLED_OUTPUTS.index(output)]
        elongation_std = rows.elongation_std[places]
        bias = np.sum(parts[:, _OWN & _SECOND], axis=-1) / np.sqrt(2)
        first, second = (np.square(parts[:, _OWN & of]).sum(axis=-1) for of in (~_SECOND, _SECOND))
        variance = np.sum(elongation_std**2)
        slope = first.sum() / variance if variance > 0 else 0.0
        own_std = np.sqrt(slope * elongation_std**2 + second)
        seen = _Estimates(pooled, estimate, own_std, parts, model.PART_SOURCES)
        value, shared = seen.mean(pooled[f"{output}_mm"].to_numpy()), seen.shared
        own = np.maximum(seen.own_std, np.spacing(value))
        value -= (1 - uncertainty.pool_random_effects(value, own).weights) * seen.mean(bias)
        last = estimate.size - 1 - np.unique(estimate[::-1], return_index=True)[1]
        random = uncertainty.pool_random_effects(value, own, shared)
        variances = shared.variances(random.weights)
        exact = sum(variance for source, variance in variances.items() if source not in model.GEOMETRY)
        return cls(
            **asdict(random),
            fixed_geometry=float(np.hypot(random.std, np.sqrt(exact))),
            fixed=uncertainty.pool(value, own, shared),
            scatter=uncertainty.nested_scatter(
                value, {"load": pooled["load_N"].to_numpy()[last]}, least_freedom=(1, 1)
            ),
            budget=seen.budget(random.weights, random.total_std, float(random.weights**2 @ own**2)),
        )


class _Estimates:
    """What is pooled: one estimate of each contact, or of all frames of a sequence."""

    def __init__(
        self,
        rows: pd.DataFrame,
        estimate: Indices,
        own_std: FloatArray,
        parts: FloatArray,
        sources: npt.NDArray[np.str_],
    ) -> None:
        weights = np.where(np.bincount(estimate)[estimate] > 1, own_std**-2.0, 1.0)
        self._estimate, self._weights = estimate, weights / np.bincount(estimate, weights)[estimate]
        self.own_std, parts = self.mean(own_std), np.stack([self.mean(part) for part in parts.T], axis=-1)
        self._variances = {
            source: np.square(parts[:, sources == source]) for source in dict.fromkeys(sources.tolist())
        }
        # Of the placement all share the same, of scale and edge those of one scale or device.
        is_shared, scales = np.isin(sources, _SHARED), rows["scale"].iloc[np.unique(estimate, True)[1]]
        groups = {
            "image scale": numbered((row,) if name is None else name for row, name in enumerate(scales)),
            "contact edge": numbered(scales),
        }
        shared, everything = sources[is_shared].tolist(), np.zeros(len(parts), dtype=np.intp)
        self.shared = uncertainty.SharedErrors(
            sources=tuple(shared),
            parts=parts[:, is_shared],
            groups=np.stack([groups.get(source, everything) for source in shared], axis=-1),
        )

    def mean(self, of: FloatArray) -> FloatArray:
        """Return the mean over the rows of each estimate, weighted by their own errors."""
        return as_float_array(np.bincount(self._estimate, self._weights * of))

    def budget(self, weights: FloatArray, std: float, own_variance: float | None = None) -> dict[str, float]:
        """Return each source's share in a pooled value's variance; `own_variance` is of what none share."""
        variance = {source: float(np.sum(weights**2 @ each)) for source, each in self._variances.items()}
        shared = self.shared.variances(weights)
        total = sum(each for source, each in variance.items() if source not in shared)
        factor = own_variance / total if own_variance is not None and total > 0 else 1.0
        variance = {source: shared.get(source, factor * each) for source, each in variance.items()}
        variance = {source: each for source, each in variance.items() if each or source not in model.COMMON}
        variance["scatter"] = max(0.0, std**2 - sum(variance.values()))
        total = sum(variance.values())
        return {source: each / total if total > 0 else 0.0 for source, each in variance.items()}


def _on_layer(
    rows: Rows, pooled: pd.DataFrame, estimate: Indices, highest: HighestLoad
) -> summary_file.OnLayerRecord | None:
    """Summarise the rows that count at one placement; None where the finger has no thickness.

    `highest` is the contact at the highest load that is in the range of the laws, if any is.
    """
    thickness, std = (
        float(pooled[name].to_numpy()[0]) for name in ("effective_thickness_mm", "effective_thickness_mm_std")
    )
    if math.isnan(thickness):
        return None
    inputs = layer.with_thickness(highest.inputs, [thickness], 0.0 if math.isnan(std) else std)
    found = layer.Layered(inputs, "first_order")
    means: dict[str, Any] = {}
    for name in layer.POOLED_ON_LAYER:
        means |= _pooled_on_layer(rows, pooled, estimate, name)
    return summary_file.OnLayerRecord(
        effective_thickness_mm=thickness,
        effective_thickness_mm_std=std,
        highest_load=summary_file.HighestLoadOnLayer(
            observation=highest.observation,
            load_N=highest.load,
            layer_flag=str(found.flag[0]),
            **layer.outputs_by_key(found.propagated, (*layer.HERTZ_OF, *layer.HERTZ_OF.values())),
        ),
        pooled=summary_file.PooledOnLayerRecord(**means),
    )


def _pooled_on_layer(rows: Rows, pooled: pd.DataFrame, estimate: Indices, output: str) -> dict[str, Any]:
    """Pool one of `POOLED_ON_LAYER` over the contacts in the range of the laws, by keys of the record.

    All are taken to have one value; the uncertainty is widened by their scatter where that exceeds it.
    """
    places = np.searchsorted(rows.pooled, pooled.index.to_numpy())
    of_all = [rows.layer_parts[places, each] for each in range(len(layer.POOLED_ON_LAYER))]
    known = np.asarray(np.isfinite(of_all).all(axis=(0, -1)))  # the same contacts for all outputs
    if not known.any():
        none = layer.as_keys(output, None, None, None)
        return {**none, f"{output}_birge_ratio": None, f"{output}_count": 0}
    unit, factor = layer.unit_of(output)
    pooled, estimate = pooled[known], numbered(estimate[known])
    parts = factor * of_all[layer.POOLED_ON_LAYER.index(output)][known]
    own_std = np.sqrt(np.sum(parts[:, ~np.isin(layer.LAYER_PART_SOURCES, _SHARED)] ** 2, axis=-1))
    seen = _Estimates(pooled, estimate, own_std, parts, layer.LAYER_PART_SOURCES)
    value = seen.mean(pooled[f"{output}_{unit}"].to_numpy())
    found = uncertainty.pool(value, uncertainty.proportional_stds(value, seen.own_std), seen.shared)
    return {
        **layer.as_keys(output, found.value, found.total_std, seen.budget(found.weights, found.total_std)),
        f"{output}_birge_ratio": found.birge_ratio,
        f"{output}_count": found.count,
    }


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Summary:
    """All good rows of one finger at one placement."""

    # What the rows have in common.
    finger: str
    wedge_angle_deg: float
    roll_angle_deg: float
    synthetic: bool
    table: pd.DataFrame  # all rows of the study
    places: Indices  # where its own rows are in it, by load: single contacts and frames of sequences
    # Pooled ``radius_from_indentation_mm``, the combined R_g^corr of Dzidek et al. (2017); None without a row
    # that counts, as the other two.
    corrected_radius: PooledRadius | None
    # Pooled ``radius_from_compliance_mm``, the one to compare with R_g.
    compliance_radius: PooledRadius | None
    # The same contacts on the finger's layer; None also without a thickness.
    on_layer: summary_file.OnLayerRecord | None

    @property
    def key(self) -> summary_file.PlacementKey:
        """The values of `PLACEMENT`, which no other summary has."""
        return self.finger, self.wedge_angle_deg, self.roll_angle_deg, self.synthetic

    @property
    def finger_and_wedge(self) -> tuple[str, float, bool]:
        """What the rows have in common with loading curves: all but the roll."""
        return self.finger, self.wedge_angle_deg, self.synthetic

    @property
    def first(self) -> pd.Series:
        """The row at the lowest load."""
        return self.table.iloc[self.places[0]]

    def column(self, name: str) -> pd.Series:
        """Return one column of its rows, without a copy of the others."""
        return self.table[name].iloc[self.places]

    def where(self, chosen: pd.Series) -> pd.DataFrame:
        """Return those of its rows for which something holds."""
        return self.table.iloc[self.places[chosen]]

    @property
    def areas(self) -> pd.DataFrame:
        """What tells of areas and loads of single contacts, or of frames where there are none."""
        single = self.column("frame").isna()
        return self.table[[*_OF_AREAS]].iloc[self.places[single] if single.any() else self.places]


_POOLED: Final = (
    *("observation", "sequence", "scale", "load_N"),
    *(f"{name}_mm" for name in model.POOLED_OUTPUTS),
    *(f"{name}_{layer.unit_of(name)[0]}" for name in layer.POOLED_ON_LAYER),
    *("effective_thickness_mm", "effective_thickness_mm_std"),
)


def pool_contacts(rows: Rows) -> list[Summary]:
    """Pool the good rows of each finger at each placement; synthetic and real rows never mix."""
    good = np.flatnonzero(rows.table["status"] == "measured")
    found = groups(rows.table[[*summary_file.PLACEMENT]].iloc[good], *summary_file.PLACEMENT)
    return [_summary(key, rows, good[places]) for key, places in found.items()]


def _summary(key: summary_file.PlacementKey, rows: Rows, places: Indices) -> Summary:
    table, on_layer = rows.table, None
    pooled = table[[*_POOLED]].iloc[places[np.isin(places, rows.pooled)]]
    by_load = table["load_N"].iloc[places].sort_values(kind="stable")
    estimate = items_of(pooled)
    corrected, compliance = (
        PooledRadius.of(rows, pooled, estimate, name) if len(pooled) else None
        for name in model.POOLED_OUTPUTS
    )
    if len(pooled):  # of the contacts in the range of the layer's laws, if any is
        highest = rows.highest_on_layer.get(key) or rows.highest_load[key]
        on_layer = _on_layer(rows, pooled, estimate, highest)
    return Summary(
        **dict(zip(summary_file.PLACEMENT, key, strict=True)),
        table=table,
        places=by_load.index.to_numpy(),
        corrected_radius=corrected,
        compliance_radius=compliance,
        on_layer=on_layer,
    )
