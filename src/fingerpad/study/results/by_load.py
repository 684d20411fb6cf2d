"""Contact area and Young's modulus of a finger at each load, pooled over repeats, with its verdict."""

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final

import numpy as np
import pandas as pd
from scipy import special

from fingerpad._arrays import FloatArray, as_float_array
from fingerpad.study.results.layer import LAYER_PART_SOURCES, POOLED_ON_LAYER
from fingerpad.study.results.model import STATED_APART
from fingerpad.study.results.repeats import QUANTITY_COLUMNS, StudyScatter, contact_quantity
from fingerpad.study.results.rows import PLACEMENT, PlacementKey, Rows
from fingerpad.study.results.summary_file import AtLoadRecord, ValidityRecord
from fingerpad.study.results.table import groups, items
from fingerpad.study.results.validity.model_checks import MODULUS, NOT_TESTED
from fingerpad.uncertainty import ScatterComponent
from fingerpad.uncertainty.propagate import NORMAL_97_5
from fingerpad.uncertainty.repeats import ContactRepeatability, nominal_loads
from fingerpad.units import KPA_PER_MPA

_ROUNDING: Final = 1e-9
_ON_LAYER: Final = "youngs_modulus_on_layer"


_ENDS: Final = (
    *("", "_std", "_ci95_low", "_ci95_high"),
    *(f"_{part}_std" for part in ("noise", "repeatability", "session", "edge", "other", "model")),
)


def _mean(
    values: FloatArray,
    parts: Mapping[str, FloatArray],
    total: FloatArray,
    freedom: float,
    sessions: tuple[int, ScatterComponent | None],
    *,
    name: str,
    model: float = math.nan,
) -> dict[str, float]:
    """Return the geometric mean of `name` over contacts of one finger under one load, by keys of a record.

    Values are positive; `parts` are the standard uncertainties of each from noise, repeatability and edge,
    `total` that from all. `freedom` is of the repeatability, infinite where that is not known; `sessions`
    their number and how they scatter; `model` what the model adds, relative to the values. Of no values
    nothing is known.

    Noise (in a modulus with the load's) and the scatter of repeats beyond it are divided by √n, the
    difference between sessions by the root of their number; contacts share the rest. The 95 % interval has
    Student's t for noise, repeatability and sessions where these are known.
    """
    count = values.size
    if not count:
        return dict.fromkeys((f"{name}{end}" for end in _ENDS), math.nan)
    relative = {part: np.nan_to_num(std) / values for part, std in parts.items()}
    apart = sum(each**2 for each in relative.values())
    whole = (np.nan_to_num(total) / values) ** 2
    rest = np.where(whole - apart > _ROUNDING * whole, whole - apart, 0.0)
    other = float(np.mean(np.sqrt(rest)))
    noise, repeat = (
        float(np.sqrt(np.sum(relative[part] ** 2)) / count) for part in ("noise", "repeatability")
    )
    edge = float(np.mean(relative["edge"]))
    number, scatter = sessions
    session = scatter.std / math.sqrt(number) if scatter is not None else math.nan
    own, between, shared = math.hypot(noise, repeat), np.nan_to_num(session), math.hypot(edge, other)
    half = math.hypot(
        _quantile(freedom) * own,
        _quantile(scatter.freedom if scatter is not None else math.inf) * between,
        NORMAL_97_5 * shared,
        NORMAL_97_5 * math.log1p(np.nan_to_num(model)),
    )
    std = math.hypot(own, between, shared, np.nan_to_num(model))
    repeats = math.nan if math.isinf(freedom) else repeat
    factors = (1.0, std, math.exp(-half), math.exp(half), noise, repeats, session, edge, other, model)
    mean = float(np.exp(np.mean(np.log(values))))
    return {f"{name}{end}": mean * factor for end, factor in zip(_ENDS, factors, strict=True)}


def _quantile(freedom: float) -> float:
    """Return the 97.5 % quantile of Student's t."""
    return NORMAL_97_5 if math.isinf(freedom) else float(special.stdtrit(freedom, 0.975))


def pool_by_load(
    rows: Rows,
    repeatability: Mapping[bool, ContactRepeatability],
    scatter: Sequence[StudyScatter] = (),
    validities: Mapping[PlacementKey, ValidityRecord] = MappingProxyType({}),
) -> list[AtLoadRecord]:
    """Pool the contacts that count for each finger, placement and nominal load; frames are left out."""
    between = {(one.quantity, one.synthetic): one.scatter.components["session"] for one in scatter}
    counts = rows.table["pooled"] & rows.table["frame"].isna()
    table = rows.table[list(_COLUMNS)]
    table = table[counts & (table["load_N"] > 0)]
    found = []
    for key, places in groups(table, *PLACEMENT).items():
        group = table.iloc[places].sort_values("load_N", kind="stable")
        load = nominal_loads(group["load_N"].to_numpy())
        found += [
            _at_load(
                rows,
                key,
                group[load == one],
                repeatability=repeatability[bool(key[-1])],
                validity=validities.get(key),
                between=between,
            )
            for one in np.unique(load)
        ]
    return found


def _at_load(
    of: Rows,
    key: PlacementKey,
    rows: pd.DataFrame,
    *,
    repeatability: ContactRepeatability,
    validity: ValidityRecord | None,
    between: Mapping[tuple[str, bool], ScatterComponent],
) -> AtLoadRecord:
    finger, wedge, roll, synthetic = key
    count = len(set(items(rows["session"])))

    def sessions(quantity: str) -> tuple[int, ScatterComponent | None]:
        found = between.get((quantity, synthetic))
        return count, found if found is not None and found.known else None

    freedom = float(repeatability.freedom) if repeatability.known else math.inf
    area = contact_quantity(rows, "contact_area")
    own = {part: rows[f"gross_area_mm2_{part}_std"].to_numpy() for part in ("noise", "edge")}
    by_image = np.isfinite(rows["gross_area_mm2"].to_numpy())
    relative = (rows[f"{axis}_mm_noise_std"] / rows[f"{axis}_mm"] for axis in ("semi_major", "semi_minor"))
    ellipse = area * np.hypot(*(each.to_numpy() for each in relative))
    noise = np.where(by_image, own["noise"], ellipse)
    total = np.where(by_image, rows["gross_area_mm2_std"].to_numpy(), ellipse)
    repeats = area * repeatability.area_std
    of_area = _mean(
        area,
        {"noise": noise, "repeatability": repeats, "edge": np.where(by_image, own["edge"], 0.0)},
        as_float_array(np.hypot(total, repeats)),
        freedom,
        sessions("contact_area"),
        name="contact_area_mm2",
    )
    return AtLoadRecord(
        finger=finger,
        wedge_angle_deg=wedge,
        roll_angle_deg=roll,
        synthetic=synthetic,
        load_N=float(np.mean(rows["load_N"].to_numpy())),
        contacts=len(rows),
        sessions=count,
        **of_area,
        **_by_hertz(rows, freedom, sessions("youngs_modulus"), validity),
        youngs_modulus_kpa_verdict=validity.headlines[MODULUS].verdict if validity else NOT_TESTED,
        **_on_layer(of, rows, freedom, sessions("youngs_modulus")),
        youngs_modulus_on_layer_kpa_verdict=validity.on_layer.verdict
        if validity and validity.on_layer
        else "",
    )


def _by_hertz(
    rows: pd.DataFrame,
    freedom: float,
    sessions: tuple[int, ScatterComponent | None],
    validity: ValidityRecord | None,
) -> dict[str, float]:
    """Pool Young's modulus by Hertz theory; nothing of a finger without semi-axes."""
    rows = rows[:0] if np.isnan(contact_quantity(rows, "youngs_modulus")).any() else rows
    return _mean(
        contact_quantity(rows, "youngs_modulus"),
        {part: rows[f"{MODULUS}_{part}_std"].to_numpy() for part in _PARTS},
        rows[f"{MODULUS}_std"].to_numpy(),
        freedom,
        sessions,
        name=MODULUS,
        model=validity.headlines[MODULUS].model_relative_std if validity else math.nan,
    )


def _on_layer(
    of: Rows, rows: pd.DataFrame, freedom: float, sessions: tuple[int, ScatterComponent | None]
) -> dict[str, float]:
    """Pool Young's modulus on the layer over the rows in the range of its laws."""
    rows = rows[np.isin(rows.index, of.pooled)]
    places, output = np.searchsorted(of.pooled, rows.index.to_numpy()), POOLED_ON_LAYER.index(_ON_LAYER)
    variances = (KPA_PER_MPA * of.layer_parts[places, output]) ** 2
    known = np.isfinite(variances).all(axis=-1)
    return _mean(
        rows[known][f"{_ON_LAYER}_kpa"].to_numpy(),
        {
            part: np.sqrt(variances[known][:, np.isin(LAYER_PART_SOURCES, sources)].sum(axis=-1))
            for part, sources in STATED_APART.items()
        },
        np.sqrt(variances[known].sum(axis=-1)),
        freedom,
        sessions,
        name=f"{_ON_LAYER}_kpa",
    )


_PARTS: Final = ("noise", "repeatability", "edge")
_COLUMNS: Final = (
    *(*PLACEMENT, "session", "load_N", *QUANTITY_COLUMNS),
    *("gross_area_mm2_std", "gross_area_mm2_noise_std", "gross_area_mm2_edge_std"),
    *("semi_major_mm_noise_std", "semi_minor_mm_noise_std", "youngs_modulus_kpa_std"),
    *(f"youngs_modulus_kpa_{part}_std" for part in _PARTS),
    f"{_ON_LAYER}_kpa",
)
