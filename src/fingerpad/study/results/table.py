"""The table of results: a pandas DataFrame of `COLUMNS`, with one row per contact or frame.

Text is of dtype object, with None where nothing is known; the number of a frame is Int64; the rest is bool
and float64. Some rows of a table keep their index, which is their place in the whole.
"""

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import nan
from typing import Any, Final, Literal, TypeAlias

import numpy as np
import numpy.typing as npt
import pandas as pd

ColumnArray: TypeAlias = npt.NDArray[Any]
DType: TypeAlias = Literal["text", "bool", "int", "float"]

_NUMPY: Final[Mapping[DType, type]] = {"text": object, "bool": bool, "int": np.int64, "float": np.float64}
# What an array holds where nothing is known.
_UNKNOWN: Final[Mapping[DType, Any]] = {"text": None, "bool": False, "int": -1, "float": nan}


@dataclass(frozen=True, slots=True)
class Column:
    """A column of the results."""

    name: str  # as in ``results.csv``
    # what it holds. As an array: objects, with None for what is not known; truths; int64 with −1; float64
    # with NaN. In a table whole numbers are Int64
    dtype: DType
    unit: str  # its unit: empty for text and truths, ``1`` for pure numbers and counts
    meaning: str
    group: str = ""
    default: bool = True  # whether ``results.csv`` has it without ``--all-columns``

    def array(self, items: Iterable[Any]) -> ColumnArray:
        """Return items as an array; None is what is not known."""
        unknown = _UNKNOWN[self.dtype]
        listed = [unknown if item is None else item for item in items]
        array: ColumnArray = np.empty(len(listed), dtype=_NUMPY[self.dtype])
        array[:] = listed
        return array

    def unknown(self, size: int) -> ColumnArray:
        """Return an array in which nothing is known; truths are false."""
        return np.full(size, _UNKNOWN[self.dtype], dtype=_NUMPY[self.dtype])

    def is_unknown(self, array: ColumnArray) -> bool:
        """Return whether an array tells nothing."""
        missing = np.isnan(array) if self.dtype == "float" else array == _UNKNOWN[self.dtype]
        return bool(missing.all())

    def series(self, array: ColumnArray, index: pd.Index | None = None) -> pd.Series:
        """Return an array as a column of a table, whose index it may share."""
        if self.dtype == "int":
            return pd.Series(pd.arrays.IntegerArray(array, array == _UNKNOWN["int"]), index=index)
        return pd.Series(array, index=index, dtype=array.dtype, copy=False)


def _text(name: str, meaning: str) -> Column:
    return Column(name, "text", "", meaning)


def _number(name: str, unit: str, meaning: str, *, default: bool = True) -> Column:
    return Column(name, "float", unit, meaning, default=default)


def _with_std(name: str, unit: str, meaning: str, *, default: bool = True) -> tuple[Column, Column]:
    """Return a column and that of its standard uncertainty."""
    std = _number(f"{name}_std", unit, f"standard uncertainty of {name}", default=default)
    return _number(name, unit, meaning, default=default), std


def _part(name: str, unit: str, part: str) -> Column:
    """Return the column of what one source adds to the standard uncertainty of another column."""
    words = {"edge": "the contact's edge", "repeatability": "repeatability"}[part]
    return _number(f"{name}_{part}_std", unit, f"the same from {words} alone", default=False)


# Quantities with a verdict on the model.
_JUDGED: Final = (
    ("radius_from_indentation_mm", "mm"),
    ("youngs_modulus_kpa", "kPa"),
    ("indentation_mm", "mm"),
)
_GROUPS: Final[Mapping[str, Sequence[Column]]] = {
    "observation": (
        _text("observation", "name of the observation; of a frame sequence#number"),
        _text("finger", "name of the finger"),
        _text("status", "measured, rejected manually, or failed"),
        _text("reason", "why the row failed or was rejected"),
        Column("synthetic", "bool", "", "whether image, ellipse or finger was rendered or simulated"),
        _text("flags", "doubts about the image, separated by spaces"),
        _text("measured_by", "automatic, corrected (with manual corrections), or manual (a given ellipse)"),
        _text("reviewed", "accepted, corrected or rejected manually; empty if not reviewed"),
        _text("reviewed_by", "who reviewed it"),
        Column(
            "pooled",
            "bool",
            "",
            "whether the row counts in pooled radii: as corrected, or else not if a flag excludes it "
            "(see the guide's table of flags); of a sequence only loading frames of a large enough ellipse",
        ),
        _text(
            "excluding_flags",
            "flags and range notes that keep it out of pooled radii unless a person includes it",
        ),
        _text("pooling_corrected_by", "who corrected whether it is pooled; empty where its flags decide"),
        _text("pooling_reason", "why they corrected it"),
        _text("range_notes", "doubts about values, separated by spaces"),
    ),
    "placement": (
        _number("wedge_angle_deg", "deg", "angle of the wedge on which the finger rests"),
        _number("roll_angle_deg", "deg", "roll of the finger about its own long axis"),
        _number("load_N", "N", "normal force W"),
        _text("session", "session in which the contact was made, as the manifest names it"),
    ),
    "sequence": (
        _text("sequence", "name of the sequence of which this is a frame; empty for single observations"),
        Column("frame", "int", "1", "number of the frame, from 0"),
        _number("time_s", "s", "time of the frame on the clock of its force"),
        _text("phase", "loading, hold or unloading, by the force or as a person set it"),
        _text("phase_corrected_by", "who set the phases of the sequence; empty where the force gives them"),
        _number(
            "measured_indentation_mm",
            "mm",
            "displacement of the platen from the place of contact, where the sequence's force table has it; "
            "the stage is taken as rigid",
        ),
    ),
    "image": (
        _text("file", "contact image or sequence measured; empty where the ellipse was given"),
        _text("scale", "name of the scale, whose error its rows share; empty for a scale of its own"),
        *_with_std("mm_per_px", "mm/px", "scale of the image"),
    ),
    "ellipse": (
        *_with_std("semi_major_mm", "mm", "semi-major axis of the contact ellipse"),
        *_with_std("semi_minor_mm", "mm", "semi-minor axis of the contact ellipse"),
        _number(
            "semi_major_mm_noise_std", "mm", "the same of semi_major_mm without edge and scale", default=False
        ),
        _number(
            "semi_minor_mm_noise_std", "mm", "the same of semi_minor_mm without edge and scale", default=False
        ),
        _number(
            "edge_offset_mm_std",
            "mm",
            "standard uncertainty of the place of the contact's edge, which displaces both semi-axes alike; "
            "rows of one scale share it",
        ),
        _number("automatic_semi_major_mm", "mm", "semi-major axis as measured automatically", default=False),
        _number("automatic_semi_minor_mm", "mm", "semi-minor axis as measured automatically", default=False),
        _number("aspect_ratio", "1", "semi-major over semi-minor axis"),
        _text("long_axis", "along or across the finger"),
        _number("predicted_aspect_ratio", "1", "of elliptical Hertz theory for the undeformed pad"),
        _text("predicted_long_axis", "along or across the finger, of elliptical Hertz theory"),
        _number("orientation_deg", "deg", "long axis from the finger's axis, counter-clockwise"),
    ),
    "region": (
        *_with_std("gross_area_mm2", "mm2", "area inside the outline of the contact"),
        _number(
            "gross_area_mm2_noise_std",
            "mm2",
            "the same from errors that no other image shares",
            default=False,
        ),
        _number("gross_area_mm2_edge_std", "mm2", "the same from the place of the edge alone", default=False),
        _number(
            "gross_area_mm2_repeatability_std",
            "mm2",
            "standard deviation of other impressions under the same load, from the study's repeats, beyond "
            "noise; not part of gross_area_mm2_std",
            default=False,
        ),
        *_with_std("ridge_area_mm2", "mm2", "area of the ridges in contact, with sweat or ink beside them"),
        _number("ridge_border_mm", "mm", "length of the borders of these ridges"),
        _number("ridge_period_mm", "mm", "median distance between ridges"),
        _number("ellipse_iou", "1", "intersection over union of ellipse and contact region"),
        _number("centroid_row_px", "px", "row of the contact's centroid", default=False),
        _number("centroid_column_px", "px", "column of the contact's centroid", default=False),
    ),
    "pad": (
        _number("u_deg", "deg", "parametric angle u of the place of contact"),
        _number("v_deg", "deg", "parametric angle v of the place of contact"),
        _number("in_plane_radius_mm", "mm", "principal radius along the finger at the place of contact"),
        *_with_std(
            "outline_radius_mm", "mm", "the same from the outline of the side faces there, not the ellipsoid"
        ),
        _number("transverse_radius_mm", "mm", "principal radius across the finger at the place of contact"),
        *_with_std("mean_curvature_radius_mm", "mm", "R_0g = 1/H of the undeformed pad"),
        *_with_std("geometric_mean_radius_mm", "mm", "R_e = sqrt(R'R'') of the undeformed pad"),
    ),
    "radius": (
        *_with_std("radius_from_indentation_mm", "mm", "R_0g F2^-3, R_g^corr of Dzidek et al. (2017)"),
        _number("radius_from_indentation_mm_fixed_geometry_std", "mm", "the same with R_0g exact"),
        _part("radius_from_indentation_mm", "mm", "edge"),
        _part("radius_from_indentation_mm", "mm", "repeatability"),
        *_with_std("radius_from_area_mm", "mm", "sphere of the same area, R_0g F1^3", default=False),
        *_with_std(
            "radius_from_compliance_mm", "mm", "sphere of the same A/(pi xi), R_0g F1^2/F2: compare with R_g"
        ),
        *_with_std("geometric_radius_from_indentation_mm", "mm", "R_e F2^-3", default=False),
        *_with_std("geometric_radius_from_area_mm", "mm", "R_e F1^3", default=False),
        *_with_std("geometric_radius_from_compliance_mm", "mm", "R_e F1^2/F2"),
    ),
    "hertz": (
        *_with_std("indentation_mm", "mm", "xi of elliptical Hertz theory from the observed ellipse"),
        _part("indentation_mm", "mm", "repeatability"),
        *_with_std("reduced_modulus_kpa", "kPa", "E* of elliptical Hertz theory from load and ellipse"),
        *_with_std("youngs_modulus_kpa", "kPa", "E = E*(1 - nu^2)"),
        _part("youngs_modulus_kpa", "kPa", "edge"),
        _number(
            "youngs_modulus_kpa_noise_std",
            "kPa",
            "the same from the ellipse's noise and the load alone",
            default=False,
        ),
        _part("youngs_modulus_kpa", "kPa", "repeatability"),
        *_with_std("mean_pressure_kpa", "kPa", "W over the area of the ellipse"),
    ),
    "layer": (
        *_with_std("effective_thickness_mm", "mm", "effective thickness of the tissue over bone, as stated"),
        *_with_std(
            "reduced_modulus_on_layer_kpa", "kPa", "E* of the whole pad on that layer, from load and area"
        ),
        *_with_std("youngs_modulus_on_layer_kpa", "kPa", "E = E*(1 - nu^2) of the whole pad on that layer"),
        *_with_std("indentation_on_layer_mm", "mm", "xi of the whole pad on that layer, from the area"),
        *_with_std(
            "loading_radius_on_layer_mm", "mm", "A/(pi xi) of the whole pad on that layer: compare with R_g"
        ),
        _text("layer_flag", "why the columns of the layer are empty, or without uncertainty"),
    ),
    "validity": (
        _number("contact_radius_ratio", "1", "sqrt(l_d l_e)/R_e, which Hertz theory takes to be small"),
        _number("indentation_over_thickness", "1", "indentation over the given thickness of the pad"),
        _text(
            "model_verdict",
            "whether Hertz theory holds for the finger at the angle: holds, strained, fails or not tested",
        ),
        *(
            _number(
                f"{name}_model_std",
                unit,
                f"what the model's discrepancy adds to {name}_std; empty where no loading data tell it",
            )
            for name, unit in _JUDGED
        ),
        *(
            _number(f"{name}_total_std", unit, f"standard uncertainty of {name}, with {name}_model_std")
            for name, unit in _JUDGED
        ),
    ),
    "output": (_text("overlay", "image of the measurement"),),
}
# What a contact comes to stands first.
_FIRST: Final = (
    *("observation", "finger", "wedge_angle_deg", "load_N"),
    *("gross_area_mm2", "gross_area_mm2_std"),
    *("semi_major_mm", "semi_major_mm_std", "semi_minor_mm", "semi_minor_mm_std"),
    *("radius_from_indentation_mm", "radius_from_indentation_mm_total_std"),
    *("youngs_modulus_kpa", "youngs_modulus_kpa_total_std", "model_verdict"),
)
_BY_GROUP: Final = {
    column.name: replace(column, group=group) for group, columns in _GROUPS.items() for column in columns
}
COLUMNS: Final[Mapping[str, Column]] = {name: _BY_GROUP[name] for name in (*_FIRST, *_BY_GROUP)}
DEFAULT_COLUMNS: Final = tuple(name for name, column in COLUMNS.items() if column.default)


Row: TypeAlias = dict[str, Any]
Indices: TypeAlias = npt.NDArray[np.intp]

_AT_ONCE: Final = 500


def table_of(
    batches: Iterable[Mapping[str, ColumnArray]],
    names: Iterable[str] = COLUMNS,
    *,
    read_only: bool = False,
    capacity: int = 0,
) -> pd.DataFrame:
    """Return a table of batches of rows, given by column; a column that is not given is not known.

    One that is read only takes half of the memory in most studies: what all rows share is held once.
    """
    size, words = 0, dict[str | None, str | None]()
    growing = {name: GrowingArray(column.unknown(0), capacity) for name, column in COLUMNS.items()}
    for batch in batches:
        more = len(next(iter(batch.values())))
        for name, column in COLUMNS.items():
            array = batch.get(name)
            if array is None or column.is_unknown(array):
                array = column.unknown(more)
            elif column.dtype == "text" and name != "observation":  # each word is kept once
                array = column.array(words.setdefault(word, word) for word in array)
            growing[name].add(array)
        size += more
    # With one index, pandas need not align the columns, which takes longer than the model of a contact.
    index = pd.RangeIndex(size)
    columns = {}
    for name in names:
        array = growing[name].array
        columns[name] = COLUMNS[name].series(array if read_only else np.require(array, None, "W"), index)
    return pd.DataFrame(columns, index=index, copy=False)


def with_areas(rows: pd.DataFrame) -> pd.DataFrame:
    """Return rows with the area of the ellipse where it was given in place of an image."""
    axes = rows[["semi_major_mm", "semi_minor_mm"]].to_numpy()
    area = np.pi * axes.prod(axis=1)
    relative = np.hypot(*(rows[["semi_major_mm_std", "semi_minor_mm_std"]].to_numpy() / axes).T)
    given = {"gross_area_mm2": area, "gross_area_mm2_std": area * relative}
    return rows.assign(**{name: rows[name].fillna(pd.Series(of, rows.index)) for name, of in given.items()})


class GrowingArray:
    """An array that is added to at its end, in place: lists of parts would be held twice when joined.

    As long as all its items are the same, it holds one. Room for `capacity` items is set aside when they are
    not; what is not used of it takes no memory.
    """

    def __init__(self, empty: ColumnArray, capacity: int = 0) -> None:
        self._array, self._size, self._capacity = empty, 0, capacity

    def add(self, more: ColumnArray) -> None:
        """Add items."""
        before, self._size = self._size, self._size + len(more)
        if before == 0:
            self._array = more[:1].copy()
        if len(self._array) <= 1:
            if _all_are(more, self._array):
                return
            same, room = self._array, max(self._size, self._capacity)
            self._array = np.empty((room, *more.shape[1:]), dtype=more.dtype)
            self._array[:before] = same
        elif self._size > len(self._array):
            room = max(self._size, len(self._array) * 5 // 4)
            self._array.resize((room, *more.shape[1:]), refcheck=False)
        self._array[before : self._size] = more

    @property
    def array(self) -> ColumnArray:
        """All items, read only where they are the same; nothing can be added to them any more."""
        shape = (self._size, *self._array.shape[1:])
        if len(self._array) <= 1:
            return np.broadcast_to(self._array, shape)
        self._array.resize(shape, refcheck=False)
        return self._array


def _all_are(array: ColumnArray, one: ColumnArray) -> bool:
    """Return whether all items are the same, to the bit: 0 and −0 are not, NaN and NaN are."""
    if array.dtype == float:
        array, one = array.view(np.int64), one.view(np.int64)
    return bool((array == one).all())


def items(column: pd.Series) -> list[Any]:
    """Return a column as plain values, None for what is not known."""
    values: list[Any] = column.tolist()
    if column.dtype in (bool, object):
        return values
    return [None if missing else item for item, missing in zip(values, column.isna().tolist(), strict=True)]


def records(table: pd.DataFrame, *names: str) -> Iterator[Row]:
    """Yield rows as dicts, of some columns or of all."""
    chosen = names or tuple(table)
    for batch in batches(table):
        for values in zip(*(items(batch[name]) for name in chosen), strict=True):
            yield dict(zip(chosen, values, strict=True))


def batches(table: pd.DataFrame) -> Iterator[pd.DataFrame]:
    """Yield all rows, some at a time."""
    for start in range(0, len(table), _AT_ONCE):
        yield table.iloc[start : start + _AT_ONCE]


def first_record(table: pd.DataFrame) -> Row | None:
    """Return the first row as a dict, None of an empty table."""
    if table.empty:
        return None
    values = (value.item() if isinstance(value, np.generic) else value for value in table.iloc[0].array)
    return {name: None if pd.isna(value) else value for name, value in zip(table, values, strict=True)}


def groups(table: pd.DataFrame, *names: str) -> dict[tuple[Any, ...], Indices]:
    """Return the places of rows with the same values in some columns, in the order of coming."""
    number = table.groupby([*names], sort=False, dropna=False).ngroup().to_numpy()
    order = np.argsort(number, kind="stable")
    places = np.split(order, np.flatnonzero(np.diff(number[order])) + 1) if len(table) else []
    firsts = records(table.iloc[[some[0] for some in places]], *names)
    return {tuple(first.values()): some for first, some in zip(firsts, places, strict=True)}


def numbered(items: Iterable[Hashable]) -> Indices:
    """Return a number for each item, the same for the same, counted from 0 in the order of coming."""
    numbers: dict[Hashable, int] = {}
    return np.array([numbers.setdefault(item, len(numbers)) for item in items], dtype=np.intp)


@dataclass(frozen=True, slots=True)
class Symbol:
    """A symbol and its meaning."""

    name: str
    meaning: str  # what it is, and what it is compared with
    unit: str  # its unit, as people see it; empty for pure numbers
    column: str = ""  # the column of ``results.csv`` that holds it; empty where none does


# By the symbol as plain text: a letter, then _subscript and ^superscript.
GLOSSARY: Final[Mapping[str, Symbol]] = {
    "R_0g": Symbol(
        "mean-curvature radius",
        "1/H of the undeformed pad at the place of contact, where 2H is the sum of its principal curvatures",
        "mm",
        "mean_curvature_radius_mm",
    ),
    "R_e": Symbol(
        "geometric mean radius",
        "square root of the product of the undeformed pad's principal radii at the place of contact: the "
        "radius of exact Hertz theory",
        "mm",
        "geometric_mean_radius_mm",
    ),
    "R_g^corr": Symbol(
        "corrected radius",
        "radius of the sphere that the same load indents as deep as the pad: R_0g corrected for the "
        "contact's elongation, as in Dzidek et al. (2017)",
        "mm",
        "radius_from_indentation_mm",
    ),
    "R_Aξ": Symbol(
        "equivalent radius from area and indentation",
        "radius of the sphere with the same contact area at the same indentation: compare it with R_g",
        "mm",
        "radius_from_compliance_mm",
    ),
    "R_g": Symbol(
        "radius from loading data",
        "slope of the contact area against π times the indentation in a loading curve",
        "mm",
    ),
    "ξ": Symbol(
        "indentation",
        "how far pad and plate approach each other, from the contact's ellipse by Hertz theory",
        "mm",
        "indentation_mm",
    ),
    "E": Symbol(
        "Young's modulus",
        "of the pad, from load and contact ellipse by Hertz theory: E* (1 − ν²), with Poisson's ratio ν",
        "kPa",
        "youngs_modulus_kpa",
    ),
    "E*": Symbol(
        "reduced modulus",
        "E / (1 − ν²): the modulus in Hertz theory, with Poisson's ratio ν",
        "kPa",
        "reduced_modulus_kpa",
    ),
    "ℓ_d": Symbol(
        "semi-major axis", "half the length of the ellipse with the contact's area", "mm", "semi_major_mm"
    ),
    "ℓ_e": Symbol(
        "semi-minor axis", "half the width of the ellipse with the contact's area", "mm", "semi_minor_mm"
    ),
    "ℓ_d/ℓ_e": Symbol("aspect ratio", "semi-major over semi-minor axis of the contact", "", "aspect_ratio"),
    "W": Symbol("normal load", "force that presses the finger against the plate", "N", "load_N"),
    "θ": Symbol(
        "wedge angle", "angle of the wedge on which the finger rests, from the plate", "°", "wedge_angle_deg"
    ),
    "φ": Symbol("roll angle", "roll of the finger about its own long axis", "°", "roll_angle_deg"),
    "u": Symbol(
        "parametric angle u",
        "where the pad touches along the finger: 90° at the tip, 0° on the palmar face",
        "°",
        "u_deg",
    ),
    "v": Symbol(
        "parametric angle v", "where the pad touches across the finger: 90° without roll", "°", "v_deg"
    ),
    "a/R": Symbol(
        "contact size",
        "square root of ℓ_d ℓ_e over R_e, which Hertz theory takes to be small",
        "",
        "contact_radius_ratio",
    ),
    "IoU": Symbol(
        "intersection over union",
        "common area of ellipse and contact region over the area that either covers: 1 is a perfect match",
        "",
        "ellipse_iou",
    ),
    "χ²": Symbol(
        "chi-square",
        "squared deviations of the faces from all together over their uncertainties; about its degrees of "
        "freedom if the faces agree",
        "",
    ),
}
