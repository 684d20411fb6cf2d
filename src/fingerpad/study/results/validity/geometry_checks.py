"""The contact's shape against that of Hertz theory, and its size against what the theory can be used for."""

import math
from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.contact.fast_laws import plate_gap, press
from fingerpad.flags import FLAGS
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.study.results.model_checks import ValidityCheck, compare_ratio, known_error
from fingerpad.study.results.validity.place import (
    HEADLINES,
    INDENTATION,
    MODULUS,
    NOTHING_COUNTS,
    RADIUS,
    UNITS,
    Place,
    missing,
)
from fingerpad.uncertainty import pad_model, propagate
from fingerpad.units import KPA_PER_MPA

_SHAPE: Final = "length along the finger over that across, and of Hertz theory for the pad"
_NO_DIRECTION: Final = "the contact's direction is not known: only its aspect ratio is compared"
_BETTER: Final = {
    "half_space": "Hertz theory and the whole pad on a half-space",
    "layer": "Hertz theory and the whole pad on tissue over bone",
}
# A/(πξ) is as wrong as ξ.
_CONCERNS: Final = {MODULUS: ("E", (MODULUS,)), INDENTATION: ("ξ", (INDENTATION, RADIUS))}
# Sizes of the contact, from small to its own, at which the error is known or not.
_SIZES: Final = np.linspace(0.02, 1.0, 50)


class Shape(NamedTuple):
    """ln of the length along the finger over that across, measured and of Hertz theory for the pad.

    Where the direction is not `known`, `measured` is that of the aspect ratio.
    """

    measured: float
    std: float
    predicted: float
    predicted_std: float
    known: bool

    def check(self, name: str, compared: str, quantities: tuple[str, ...], predicted: float) -> ValidityCheck:
        """Compare what was measured with a prediction, which is as uncertain as that of Hertz theory."""
        ratio = math.exp(self.measured if self.known else math.copysign(self.measured, predicted))
        expected = math.exp(predicted)
        return compare_ratio(
            name,
            compared,
            quantities,
            (ratio, ratio * self.std),
            (expected, expected * self.predicted_std),
            note="" if self.known else _NO_DIRECTION,
        )


def measured_shape(place: Place) -> Shape | None:
    """Return the shape of the contact at the highest load; None without one."""
    row = place.highest_row
    if place.highest is None or row is None:
        return None

    def elongations(**inputs: FloatArray) -> dict[str, FloatArray]:
        radius, half = inputs["image_scale"] * inputs["contact_radius"], np.exp(0.5 * inputs["elongation"])
        edge = inputs["edge_offset"]
        return {
            "measured": np.log(radius * half + edge) - np.log(radius / half + edge),
            "predicted": pad_model(**inputs)["predicted_elongation"],
        }

    found = propagate(elongations, place.highest.inputs)
    direction = {"along": 1.0, "across": -1.0}.get(row["long_axis"] or "")
    if row["orientation_deg"] is not None:
        direction = math.cos(2 * math.radians(row["orientation_deg"]))
    return Shape(
        measured=float(found["measured"].value) * (1.0 if direction is None else direction),
        std=float(found["measured"].std),
        predicted=float(found["predicted"].value),
        predicted_std=float(found["predicted"].std),
        known=direction is not None,
    )


def contact_shape_check(place: Place) -> ValidityCheck:
    """Compare the contact's length along the finger over that across with Hertz theory for the pad."""
    shape = measured_shape(place)
    if shape is None:
        return missing("shape", _SHAPE, HEADLINES, NOTHING_COUNTS)
    return shape.check("shape", _SHAPE, HEADLINES, shape.predicted)


def size_checks(place: Place) -> Iterator[ValidityCheck]:
    """Yield the error of Hertz theory for the contact's size, by the laws of the whole pad."""
    row, thickness = place.highest_row, place.pad.effective_thickness or place.pad.pad_thickness
    for kind, words in _BETTER.items():
        if row is None or (kind == "layer" and thickness is None):
            why = NOTHING_COUNTS if row is None else "no thickness of the tissue is stated"
            for name, (symbol, of) in _CONCERNS.items():
                yield missing(f"{name.rsplit('_', 1)[0]}_on_{kind}", f"{symbol} of {words}", of, why)
            continue
        yield from _errors(place, row, kind, thickness if kind == "layer" else None)


def _errors(
    place: Place, row: dict[str, float], kind: str, thickness: float | None
) -> Iterator[ValidityCheck]:
    """Yield the errors of E and ξ at the contact's load and area, or at the largest area with a law."""
    area = math.pi * row["semi_major_mm"] * row["semi_minor_mm"]
    wedge, roll = math.radians(row["wedge_angle_deg"]), math.radians(row["roll_angle_deg"])
    assumed = Placement(Ellipsoid(*place.pad.semi_axes), wedge_angle=wedge, roll_angle=roll)
    # Where the outline shows another radius than the ellipsoid's, the pad is larger as a whole.
    larger = row["geometric_mean_radius_mm"] / float(assumed.curvature.geometric_mean_radius)
    pad = Ellipsoid(*(larger * place.pad.semi_axes))
    better = press(
        plate_gap(Placement(pad, wedge_angle=wedge, roll_angle=roll)),
        reduced_modulus=1.0,
        thickness=thickness,
        poisson_ratio=place.study.poisson_ratio,
        area=area * _SIZES,
    )
    size = f"a/R = {row['contact_radius_ratio']:.2f}"
    if thickness is not None:
        a = math.sqrt(area / math.pi)
        size = f"a/t = {a / thickness:.2f}, ξ/t = {row[INDENTATION] / thickness:.2f}"
    flag = str(better.flags[-1])
    known = np.flatnonzero(better.flag_code == 0)
    for name, (symbol, of) in _CONCERNS.items():
        check, compared = f"{name.rsplit('_', 1)[0]}_on_{kind}", f"{symbol} of {_BETTER[kind]}"
        if not known.size:
            yield missing(check, compared, of, f"{size}; {FLAGS['layer'][flag].words}")
            continue
        last = known[-1]
        power, exact = (-1.5, better.load) if name == MODULUS else (1.0, better.indentation)
        factor = KPA_PER_MPA * (1 - place.study.poisson_ratio**2) * row["load_N"]
        yield known_error(
            check,
            compared,
            of,
            row[name] * _SIZES[last] ** power,
            factor / float(exact[last]) if name == MODULUS else float(exact[last]),
            unit=UNITS[name],
            note=f"{size}: {FLAGS['layer'][flag].words}; {_at_end(row, _SIZES[last])}" if flag else size,
        )


def _at_end(row: dict[str, float], area_share: float) -> str:
    """Return of which contact the values are where the contact's own is out of the range of the laws."""
    ratio = row["contact_radius_ratio"] * math.sqrt(area_share)
    return f"both are of the largest in range, a/R = {ratio:.2f}, under this load, so at least this"
