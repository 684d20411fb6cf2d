"""The symbols of results, each with what it means: one list for the page and for reports."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Symbol:
    """A symbol and its meaning.

    Attributes
    ----------
    name : str
        Its name in words.
    meaning : str
        What it is, and what it is compared with.
    unit : str
        Its unit, as people see it; empty for pure numbers.
    column : str
        The column of ``results.csv`` that holds it; empty where none does.
    """

    name: str
    meaning: str
    unit: str
    column: str = ""


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
