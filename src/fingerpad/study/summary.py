"""One summary per finger and placement: its rows, and radii pooled from them."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import stats

from fingerpad.study.model import POOLED_OUTPUTS
from fingerpad.study.pooling import PooledRadius
from fingerpad.study.rows import Row, Rows


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """All good rows of one finger at one placement.

    Attributes
    ----------
    finger, wedge_angle_deg, roll_angle_deg, synthetic
        What the rows have in common.
    rows : tuple of Row
        The rows, by load: single contacts and frames of sequences.
    corrected_radius : PooledRadius or None
        Pooled ``radius_from_indentation_mm``, the source's combined R_g^corr; None without a sound row.
    compliance_radius : PooledRadius or None
        Pooled ``radius_from_compliance_mm``, the one to compare with R_g.
    """

    finger: str
    wedge_angle_deg: float
    roll_angle_deg: float
    synthetic: bool
    rows: tuple[Row, ...]
    corrected_radius: PooledRadius | None
    compliance_radius: PooledRadius | None

    @property
    def contacts(self) -> tuple[Row, ...]:
        """Rows of single contacts, without frames."""
        return tuple(row for row in self.rows if row["frame"] is None)

    @property
    def pooled_from(self) -> str:
        """What the pooled radii come from, in words."""
        pooled = [row for row in self.rows if row["pooled"]]
        contacts = sum(row["frame"] is None for row in pooled)
        films = len({row["sequence"] for row in pooled} - {None})
        parts = [_counted(contacts, "observation")] if contacts or not films else []
        if films:
            parts.append(f"{_counted(len(pooled) - contacts, 'frame')} of {_counted(films, 'sequence')}")
        return " and ".join(parts)


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def summaries(rows: Rows) -> list[Summary]:
    """Pool the good rows of each finger at each placement; synthetic and real rows never mix."""
    groups: dict[tuple[str, float, float, bool], list[int]] = {}
    for place, index in enumerate(rows.good):
        row = rows.rows[index]
        key = (row["finger"], row["wedge_angle_deg"], row["roll_angle_deg"], row["synthetic"])
        groups.setdefault(key, []).append(place)
    return [_summary(key, rows, places) for key, places in groups.items()]


def _summary(key: tuple[str, float, float, bool], rows: Rows, places: list[int]) -> Summary:
    estimates: dict[str, list[int]] = {}
    for place in places:
        row = rows.rows[rows.good[place]]
        if row["pooled"]:
            estimates.setdefault(row["sequence"] or row["observation"], []).append(place)
    sound = list(estimates.values())
    members = sorted((rows.rows[rows.good[place]] for place in places), key=lambda row: float(row["load_N"]))
    corrected, compliance = (PooledRadius.of(rows, sound, name) if sound else None for name in POOLED_OUTPUTS)
    return Summary(
        finger=key[0],
        wedge_angle_deg=key[1],
        roll_angle_deg=key[2],
        synthetic=key[3],
        rows=tuple(members),
        corrected_radius=corrected,
        compliance_radius=compliance,
    )


class Exponent(NamedTuple):
    """Slope of ln A against ln W, with its standard uncertainty from the scatter; NaN where not known."""

    value: float
    std: float


def area_exponent(rows: Iterable[Row]) -> Exponent:
    """Return the exponent of A ∝ W^n over the pooled of some rows: two loads give a slope, three its std."""
    sound = [row for row in rows if row["pooled"] and row["load_N"] > 0]
    load = np.array([row["load_N"] for row in sound])
    area = np.pi * np.array([row["semi_major_mm"] * row["semi_minor_mm"] for row in sound])
    if np.unique(load).size < 2:
        return Exponent(math.nan, math.nan)
    line = stats.linregress(np.log(load), np.log(area))
    return Exponent(float(line.slope), float(line.stderr) if load.size > 2 else math.nan)
