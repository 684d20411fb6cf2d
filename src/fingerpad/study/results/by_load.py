"""Contact area and Young's modulus of a finger at each load, pooled over repeats, with its verdict."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Self

import numpy as np
import pandas as pd
from scipy import special

from fingerpad._arrays import FloatArray, as_float_array
from fingerpad.study.results.layer import LAYER_PART_SOURCES, POOLED_ON_LAYER
from fingerpad.study.results.model import STATED_APART
from fingerpad.study.results.repeats import (
    QUANTITY_COLUMNS,
    ContactRepeatability,
    StudyScatter,
    contact_quantity,
    nominal_loads,
)
from fingerpad.study.results.rows import PLACEMENT, PlacementKey, Rows
from fingerpad.study.results.table import groups, items
from fingerpad.study.results.validity.model_checks import MODULUS, NOT_TESTED
from fingerpad.study.results.validity.verdict import Validity
from fingerpad.uncertainty import ScatterComponent
from fingerpad.uncertainty.propagate import NORMAL_97_5
from fingerpad.units import KPA_PER_MPA

_ROUNDING: Final = 1e-9
_ON_LAYER: Final = "youngs_modulus_on_layer"


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadMean:
    """The geometric mean of a quantity over the contacts of one finger under one load."""

    value: float
    std: float  # from all parts together
    # 95 % interval, with Student's t for noise, repeatability and sessions where these are known.
    interval: tuple[float, float]
    # From what no contacts share, divided by √n: noise (in a modulus with the load's), and the scatter of
    # repeats beyond it; NaN where the study has too few repeats.
    noise_std: float
    repeatability_std: float
    # From the difference between sessions, divided by the root of their number; NaN where it is not known.
    session_std: float
    edge_std: float  # from the place of the contact's edge, which all contacts share
    other_std: float  # from what else they share: scale, and in a modulus geometry and Poisson's ratio
    model_std: float  # from the model's discrepancy, which they share too; NaN where nothing tells it

    @classmethod
    def of(
        cls,
        values: FloatArray,
        parts: Mapping[str, FloatArray],
        total: FloatArray,
        freedom: float,
        sessions: tuple[int, ScatterComponent | None],
        *,
        model: float = math.nan,
    ) -> Self:
        """Pool values.

        Values are positive; `parts` are the standard uncertainties of each from noise, repeatability and
        edge, `total` that from all. `freedom` is of the repeatability, infinite where that is not known;
        `sessions` their number and how they scatter; `model` what the model adds, relative to the values.
        """
        count = values.size
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
        mean = float(np.exp(np.mean(np.log(values))))
        half = math.hypot(
            _quantile(freedom) * own,
            _quantile(scatter.freedom if scatter is not None else math.inf) * between,
            NORMAL_97_5 * shared,
            NORMAL_97_5 * math.log1p(np.nan_to_num(model)),
        )
        return cls(
            value=mean,
            std=mean * math.hypot(own, between, shared, np.nan_to_num(model)),
            interval=(mean * math.exp(-half), mean * math.exp(half)),
            noise_std=mean * noise,
            repeatability_std=math.nan if math.isinf(freedom) else mean * repeat,
            session_std=mean * session,
            edge_std=mean * edge,
            other_std=mean * other,
            model_std=mean * model,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class AtLoad:
    """A finger at one placement under one load."""

    finger: str
    wedge_angle_deg: float
    roll_angle_deg: float
    synthetic: bool
    load: float  # mean of their loads, N
    count: int  # of contacts
    sessions: int  # number of those in which they were made
    area: LoadMean  # contact area, mm²
    # Young's modulus from load and area by Hertz theory, kPa; None of a finger without semi-axes.
    modulus: LoadMean | None
    verdict: str
    # Young's modulus on the finger's layer of tissue, kPa, over the contacts in the range of its laws; None
    # without any.
    modulus_on_layer: LoadMean | None
    layer_verdict: str  # whether the layer holds; empty without one


def _quantile(freedom: float) -> float:
    """Return the 97.5 % quantile of Student's t."""
    return NORMAL_97_5 if math.isinf(freedom) else float(special.stdtrit(freedom, 0.975))


def pool_by_load(
    rows: Rows,
    repeatability: Mapping[bool, ContactRepeatability],
    scatter: Sequence[StudyScatter] = (),
    validities: Mapping[PlacementKey, Validity] = MappingProxyType({}),
) -> list[AtLoad]:
    """Pool the contacts that count, for each finger, placement and nominal load.

    Frames of sequences are left out. `repeatability` is by whether contacts are synthetic; `validities` is by
    the values of `PLACEMENT`: not tested where one is missing.
    """
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
    validity: Validity | None,
    between: Mapping[tuple[str, bool], ScatterComponent],
) -> AtLoad:
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
    return AtLoad(
        finger=finger,
        wedge_angle_deg=wedge,
        roll_angle_deg=roll,
        synthetic=synthetic,
        load=float(np.mean(rows["load_N"].to_numpy())),
        count=len(rows),
        sessions=count,
        area=LoadMean.of(
            area,
            {"noise": noise, "repeatability": repeats, "edge": np.where(by_image, own["edge"], 0.0)},
            as_float_array(np.hypot(total, repeats)),
            freedom,
            sessions("contact_area"),
        ),
        modulus=_by_hertz(rows, freedom, sessions("youngs_modulus"), validity),
        verdict=validity.headlines[MODULUS].verdict if validity else NOT_TESTED,
        modulus_on_layer=_on_layer(of, rows, freedom, sessions("youngs_modulus")),
        layer_verdict=validity.layer_verdict if validity and validity.layer_checks else "",
    )


def _by_hertz(
    rows: pd.DataFrame,
    freedom: float,
    sessions: tuple[int, ScatterComponent | None],
    validity: Validity | None,
) -> LoadMean | None:
    """Pool Young's modulus by Hertz theory; None of a finger without semi-axes."""
    values = contact_quantity(rows, "youngs_modulus")
    if np.isnan(values).any():
        return None
    return LoadMean.of(
        values,
        {part: rows[f"youngs_modulus_kpa_{part}_std"].to_numpy() for part in _PARTS},
        rows["youngs_modulus_kpa_std"].to_numpy(),
        freedom,
        sessions,
        model=validity.headlines[MODULUS].model_relative_std if validity else math.nan,
    )


def _on_layer(
    of: Rows, rows: pd.DataFrame, freedom: float, sessions: tuple[int, ScatterComponent | None]
) -> LoadMean | None:
    """Pool Young's modulus on the layer over the rows in the range of its laws; None without any."""
    rows = rows[np.isin(rows.index, of.pooled)]
    if not len(rows):
        return None
    places, output = np.searchsorted(of.pooled, rows.index.to_numpy()), POOLED_ON_LAYER.index(_ON_LAYER)
    variances = (KPA_PER_MPA * of.layer_parts[places, output]) ** 2
    known = np.isfinite(variances).all(axis=-1)
    if not known.any():
        return None
    return LoadMean.of(
        rows[known][f"{_ON_LAYER}_kpa"].to_numpy(),
        {
            part: np.sqrt(variances[known][:, np.isin(LAYER_PART_SOURCES, sources)].sum(axis=-1))
            for part, sources in STATED_APART.items()
        },
        np.sqrt(variances[known].sum(axis=-1)),
        freedom,
        sessions,
    )


_PARTS: Final = ("noise", "repeatability", "edge")
_COLUMNS: Final = (
    *(*PLACEMENT, "session", "load_N", *QUANTITY_COLUMNS),
    *("gross_area_mm2_std", "gross_area_mm2_noise_std", "gross_area_mm2_edge_std"),
    *("semi_major_mm_noise_std", "semi_minor_mm_noise_std", "youngs_modulus_kpa_std"),
    *(f"youngs_modulus_kpa_{part}_std" for part in _PARTS),
    f"{_ON_LAYER}_kpa",
)
