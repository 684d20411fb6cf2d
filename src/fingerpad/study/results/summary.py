"""One summary per finger and placement: its rows, and radii pooled from them."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from fingerpad.study.error_text import counted
from fingerpad.study.results.exponent import items_of
from fingerpad.study.results.layer_summary import LayerSummary
from fingerpad.study.results.model import POOLED_OUTPUTS
from fingerpad.study.results.pooling import PooledRadius
from fingerpad.study.results.rows import PLACEMENT, HighestLoad, PlacementKey, Rows
from fingerpad.study.results.table import Places, groups


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Summary:
    """All good rows of one finger at one placement.

    Attributes
    ----------
    finger, wedge_angle_deg, roll_angle_deg, synthetic
        What the rows have in common.
    table : DataFrame
        All rows of the study, of which `rows` are some.
    places : ndarray of int
        Where `rows` are in it.
    corrected_radius : PooledRadius or None
        Pooled ``radius_from_indentation_mm``, the combined R_g^corr of Dzidek et al. (2017); None without a
        sound row.
    compliance_radius : PooledRadius or None
        Pooled ``radius_from_compliance_mm``, the one to compare with R_g.
    layer : LayerSummary or None
        The same contacts on the finger's layer of tissue; None without a thickness, or without a sound row.
    """

    finger: str
    wedge_angle_deg: float
    roll_angle_deg: float
    synthetic: bool
    table: pd.DataFrame
    places: Places
    corrected_radius: PooledRadius | None
    compliance_radius: PooledRadius | None
    layer: LayerSummary | None

    @property
    def key(self) -> PlacementKey:
        """The values of `PLACEMENT`, which no other summary has."""
        return self.finger, self.wedge_angle_deg, self.roll_angle_deg, self.synthetic

    @property
    def place(self) -> tuple[str, float, bool]:
        """What the rows have in common with loading curves: all but the roll."""
        return self.finger, self.wedge_angle_deg, self.synthetic

    @property
    def rows(self) -> pd.DataFrame:
        """The rows, by load: single contacts and frames of sequences."""
        return self.table.iloc[self.places]

    def column(self, name: str) -> pd.Series:
        """Return one column of `rows`, without a copy of the others."""
        return self.table[name].iloc[self.places]

    @property
    def contacts(self) -> pd.DataFrame:
        """Rows of single contacts, without frames."""
        return self.table.iloc[self.places[self.column("frame").isna()]]

    @property
    def contacts_or_frames(self) -> pd.DataFrame:
        """Rows of single contacts, or those of frames where there are none."""
        contacts = self.contacts
        return self.rows if contacts.empty else contacts

    @property
    def pooled_from(self) -> str:
        """What the pooled radii come from, in words, and of how many observations."""
        pooled, framed = self.column("pooled"), self.column("frame").notna()
        frames = int((pooled & framed).sum())
        sequences = len(set(self.column("sequence")[pooled]) - {None})
        contacts, seen = int(pooled.sum()) - frames, int((~framed).sum())
        singles = counted(contacts, "observation")
        if contacts < seen:
            singles = f"{contacts} of {counted(seen, 'observation')}"
        parts = [singles] if seen or not sequences else []
        if sequences:
            parts.append(f"{counted(frames, 'frame')} of {counted(sequences, 'sequence')}")
        return " and ".join(parts)


def pool_contacts(rows: Rows) -> list[Summary]:
    """Pool the good rows of each finger at each placement; synthetic and real rows never mix."""
    good = np.flatnonzero(rows.table["status"] == "measured")
    found = groups(rows.table[[*PLACEMENT]].iloc[good], *PLACEMENT)
    return [_summary(key, rows, good[places]) for key, places in found.items()]


def _summary(key: PlacementKey, rows: Rows, places: Places) -> Summary:
    table = rows.table
    pooled = table.iloc[places[table["pooled"].to_numpy()[places]]]
    by_load = table["load_N"].iloc[places].sort_values(kind="stable")
    estimate = items_of(pooled)
    corrected, compliance = (
        PooledRadius.of(rows, pooled, estimate, name) if len(pooled) else None for name in POOLED_OUTPUTS
    )
    finger, wedge, roll, synthetic = key
    return Summary(
        finger=finger,
        wedge_angle_deg=wedge,
        roll_angle_deg=roll,
        synthetic=synthetic,
        table=table,
        places=by_load.index.to_numpy(),
        corrected_radius=corrected,
        compliance_radius=compliance,
        layer=LayerSummary.of(rows, pooled, estimate, _highest(rows, key)) if len(pooled) else None,
    )


def _highest(rows: Rows, key: PlacementKey) -> HighestLoad:
    """Return the contact at the highest load that is in the range of the layer's laws, if any is."""
    return rows.highest_on_layer.get(key) or rows.highest_load[key]
