"""Flags of measurements: what each means, what it keeps out of results, and what to do about it."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final, Literal, TypeAlias

# What is flagged: a contact image, the scale of a picture, a frame of a sequence, a photograph of a face, a
# loading curve, a contact in the model of a layer over bone, and a row of a study's results.
Flagged: TypeAlias = Literal["contact", "scale", "frame", "photograph", "curve", "layer", "row"]
# What a flag keeps a contact out of: pooled results whatever a person says, pooled results until a person has
# accepted or corrected it, or pooled ridge areas alone.
Excludes: TypeAlias = Literal["", "pooling", "pooling unless reviewed", "pooled ridge area"]


@dataclass(frozen=True, slots=True)
class Flag:
    """A doubt about a measurement."""

    code: str
    words: str
    to_do: str
    excludes: Excludes = ""  # what a contact or a curve with it is kept out of


_REVIEW: Final = "look at its outline on the page, and accept or correct it"
_CHECK_UNITS: Final = "check the scale, and the units of what was given"
# With them a layer is fitted to a curve.
GIVE_SEMI_AXES: Final = (
    "give the pad's semi-axes (semi_axes_mm or photographs of the finger in study.toml, or fingerpad fit "
    "--semi-axes-mm)"
)

_CONTACT: Final = (
    Flag(
        "touches_border",
        "the contact is cut by the edge of the picture",
        "take a picture with the whole contact in it, or include it on the page with a reason",
        "pooling",
    ),
    Flag(
        "cut_by_mask",
        "the contact is cut by the mask or region of interest",
        "make the mask or region of interest larger",
        "pooling",
    ),
    Flag(
        "low_contrast",
        "the contact has little contrast with the background",
        f"ink or light it better, or {_REVIEW}",
        "pooling unless reviewed",
    ),
    Flag(
        "several_regions",
        "there are other patches beside the one measured",
        f"state region_of_interest_px, mask_px or seed_px, or {_REVIEW}",
        "pooling unless reviewed",
    ),
    Flag(
        "poor_ellipse", "the contact is not well described by an ellipse", _REVIEW, "pooling unless reviewed"
    ),
    Flag(
        "straight_side",
        "a side of the contact is straight, as where the picture was cut or erased, or the glass ends",
        f"take a picture with the whole contact in it, or {_REVIEW}",
        "pooling unless reviewed",
    ),
    Flag(
        "scale_doubtful",
        "the ridge period is not that of a finger, or the picture is too coarse to show it",
        "check the resolution of the picture",
        "pooling",
    ),
    Flag(
        "not_a_contact_image",
        "no ridges of a finger fill it, or only straight lines evenly spaced",
        "check that the picture shows a contact, and its resolution; of one without ridges, state surface",
        "pooling",
    ),
    Flag(
        "ridges_merge",
        "sweat, ink or a second touch may have joined the ridges: their area is an upper bound",
        "use less ink, or press once on a clean, dry glass; after one touch the other areas and axes hold",
        "pooled ridge area",
    ),
    Flag(
        "printed_marks",
        "letters or marks darker than ridges lie in the contact and are counted in its areas",
        f"take a picture of the contact alone, state background, or {_REVIEW}",
        "pooling unless reviewed",
    ),
    Flag(
        "edge_without_ridges",
        "no ridges, or fainter ones, lie along the outline: a halo, a window or an earlier print may count",
        f"clean and dry the glass, state region_of_interest_px or dark_on_light, or {_REVIEW}",
        "pooling unless reviewed",
    ),
    Flag(
        "edge_hidden",
        "less than 80 % of a smooth contact's edge is seen, or its outline follows a reflection",
        f"keep reflections off the edge, state background, or {_REVIEW}",
        "pooling unless reviewed",
    ),
    Flag(
        "edge_unclear",
        "a second edge, fringes or a soft edge leave open where a smooth contact ends",
        f"let it dry, use light in which the edge is a step, or {_REVIEW}",
        "pooling unless reviewed",
    ),
    Flag(
        "edited_manually",
        "the contact was drawn manually, in part or as a whole",
        "check that the edit follows the contact's edge",
    ),
)
_SCALE: Final = (
    Flag(
        "coin_shadow",
        "a shadow beside the coin may make the scale too small",
        "light the coin from straight above, or mark a line of known length",
    ),
    Flag(
        "coin_tilted",
        "the coin is seen at a slant: lengths across the tilt are too small, which is in its uncertainty",
        "hold the camera square to it, or photograph a grid, which rectifies contact images",
    ),
    Flag(
        "grid_tilted",
        "the grid is tilted: the scale differs with place and direction, which is in its uncertainty",
        "rectify contact images by their grid, or hold the camera square to it",
    ),
    Flag(
        "grid_bent",
        "the grid is not flat, or the lens bends lines, which is in the uncertainty of the scale",
        "lay the grid flat, and photograph it from farther away",
    ),
)
_FRAME: Final = (
    Flag(
        "repeated_picture",
        "the same picture is given for another contact",
        "keep one of them, give each its own picture, or say by region_of_interest_px which part it shows",
        "pooling",
    ),
    Flag(
        "interpolated",
        "the ellipse is interpolated between two key frames",
        "correct this frame itself where the contact changes faster",
    ),
    Flag("no_time", "the frame has no time", "give every frame a time, or state frames per second"),
    Flag(
        "no_force",
        "the force signal does not cover the frame",
        "record the force from before the first frame until after the last, or check the delay",
    ),
    Flag(
        "repeated_frame",
        "the frame is the same picture as one before it, under another force",
        "look why the camera, or what stored its frames, stood still",
        "pooling",
    ),
    Flag(
        "out_of_step",
        "the area does not follow the force, for lost frames or wrong times",
        "give the frames' own times (times), or check frame rate, trigger, force and that no print is left",
        "pooling",
    ),
)
_PHOTOGRAPH: Final = (
    Flag(
        "short_arc",
        "the arc is shorter than 90 degrees: its semi-axes are poorly determined",
        "take a picture that shows more of the pad's outline, or mark points on it",
    ),
    Flag(
        "uncertain",
        "a semi-axis is known to no better than 2 percent",
        "take a sharper picture or more of the outline, or add another face",
    ),
    Flag(
        "many_outliers",
        "more than 15 percent of the arc's points were left out",
        "look at the points left out on the page, and erase what is not the pad",
    ),
    Flag(
        "low_contrast",
        "the finger has little contrast with the backdrop",
        "photograph it before a plain backdrop of another colour",
    ),
    Flag(
        "soft_edges",
        "the edge is blurred over more than 1 percent of the smaller semi-axis",
        "focus on the outline of the pad, and close the aperture",
    ),
    Flag(
        "few_points",
        "too few points to tell whether the outline is an ellipse: each semi-axis by 8 percent",
        "mark more points along the outline",
    ),
    Flag(
        "touches_border",
        "the arc ends where the frame cuts the finger",
        "take a picture with the whole pad in it",
    ),
    Flag(
        "poor_ellipse",
        "the outline departs from the ellipse by more than 1 percent of the smaller semi-axis",
        "erase points on the nail or a crease on the page; if none are, the pad is no ellipse",
    ),
    Flag(
        "not_an_ellipse",
        "the outline is more pointed or blunter than an ellipse",
        "check that the finger is relaxed and seen square; the uncertainty holds the departure",
    ),
    Flag(
        "dorsal_deeper",
        "seen end on, the finger reaches farther on the dorsal side than on the palmar one",
        "check that the palmar side points down, or as palmar says; photograph the tip along the finger",
    ),
    Flag(
        "tilted",
        "the finger is tilted by more than 10 degrees",
        "photograph the finger upright in the picture, square to the face",
    ),
    Flag("implausible_size", "a semi-axis lies outside 2–40 mm", "check the scale"),
    Flag(
        "fitted_manually",
        "the ellipse was placed manually, or points were added or left out",
        "check that the ellipse follows the outline",
    ),
)
_CURVE: Final = (
    Flag(
        "no_baseline",
        "fewer than two rows before contact: the force's zero and drift are the model's, and less certain",
        "record from before the contact",
    ),
    Flag(
        "tilt_unknown",
        "too few rows before contact to estimate a drift of the force",
        "record some 20 rows before the contact",
    ),
    Flag(
        "rounded_force",
        "the force is rounded by more than its noise: equal readings before contact count as one",
        "record the force with more digits, or in a smaller range of the sensor",
    ),
    Flag("saturated_force", "rows at the sensor's limit are left out", "press less, or take a larger sensor"),
    Flag(
        "clipped_area",
        "areas of exactly zero, or at one limit, under load are left out",
        "look at their frames: lost, below a threshold, or larger than the camera sees",
    ),
    Flag("duplicated_time", "rows of one time are spread evenly", "record the time with more digits"),
    Flag(
        "time_gap",
        "rows are missing: one step of time exceeds 10 times the usual one",
        "check the recording for lost rows",
    ),
    Flag(
        "implausible_radius",
        "the loading radius lies beyond any finger pad's: the curve tests nothing",
        "check the units of displacement and area",
        "pooling",
    ),
    Flag(
        "implausible_modulus",
        "the modulus lies beyond any finger pad's: the curve tests none",
        "check the units of force and displacement",
        "pooling",
    ),
    Flag(
        "no_pull_off",
        "the force does not fall below its zero on the way out and come back, as an adhesive law needs",
        "record the way out until the contact is lost, and some rows more",
    ),
    Flag(
        "law_not_fitted",
        "the contact law that was asked for could not be fitted",
        "look at the reason beside its parameters, and give it other start values",
    ),
    Flag(
        "law_at_bound",
        "a parameter of the contact law lies at its bound",
        "widen the bound, or leave the parameter out of the law",
    ),
    Flag(
        "law_misfit",
        "the force departs from the contact law by more than its noise without contact",
        "trust its parameters less than stated; look for a rate, slip, or another law",
    ),
    Flag(
        "law_out_of_range",
        "the contact law says that it does not hold at the parameters found",
        "take a law that does",
    ),
    Flag(
        "radius_contradicts_area",
        "the radius that was given is not the slope of the area",
        "check the radius, and the unit of the area",
    ),
    Flag(
        "modulus_depends_on_load",
        "a modulus that grows with load fits better than one modulus",
        f"state the modulus with the load that it holds at; {GIVE_SEMI_AXES} to fit a layer to a curve with "
        "areas, which may explain it",
    ),
    Flag(
        "modulus_falls_with_load",
        "a modulus that falls with load fits better than one modulus: a pad that relaxes does that, a stage "
        "that yields, or a layer thicker than stated, and no other layer",
        "state the modulus with its load and speed, and the compliance of the stage; record a hold and "
        "the way out",
    ),
    Flag(
        "relaxes",
        "the pad relaxes: its modulus is that of this speed",
        "state the speed with the modulus, press at the same speed in all records, and record a hold and the "
        "way out; `fit_relaxation` fits a hold",
    ),
    Flag(
        "modulus_partly_decreases",
        "the modulus falls over a part of the loads, which is left out",
        "check friction and slip, or state the range of loads to fit",
    ),
    Flag("region_given", "the range of loads to fit was given, not found", "state the range with the result"),
    Flag(
        "misfit",
        "another explanation fits the curve better, or none has the shape of its force",
        "measure or state what it names, such as the stage's compliance; look for a slip",
    ),
    Flag(
        "area_offset",
        "force and area disagree on the place of contact, as with a late camera",
        "synchronise camera and force, or state the delay of the areas",
    ),
    Flag(
        "correlated_area",
        "neighbouring areas lie on the same side of the fit too often",
        "look at the residuals of the area, and at the frames where they change sign",
    ),
    Flag(
        "untested_without_area",
        "without areas a layer on bone or a yielding stage looks like a changing modulus",
        "state the compliance of the stage and the thickness of the layer, inf for a half-space; or record "
        f"areas too, and for a finger {GIVE_SEMI_AXES}",
    ),
    Flag(
        "constraint_assumed",
        "the moduli are divided by an assumed constraint coefficient",
        "state the constraint and its source with the result",
    ),
    Flag(
        "radius_contradicts_curve",
        "the curve asks for another radius than the pad's geometry",
        "check the placement, the scale and the unit of the area",
    ),
    Flag(
        "radius_narrowed",
        "the curve claims to know the radius far better than the geometry does",
        "do not rest on it: some other departure from the model can look like it",
    ),
    Flag(
        "layer_too_thin",
        "the layer may be thinner than a third of the contact's radius",
        "fit lower loads alone",
    ),
    Flag(
        "thicker_than_finger",
        "a layer thicker than a finger hardly differs from a half-space",
        "take the modulus of Hertz theory",
    ),
)
_LAYER: Final = (
    Flag("no_contact", "there is no contact", "check the load's sign and zero"),
    Flag(
        "contact_too_wide",
        "the contact is wider than 0.6 of the pad",
        "take lower loads, or check the scales of contact and pad",
    ),
    Flag(
        "contact_too_skew",
        "the pad curves too differently to either side of the contact",
        "use `fingerpad solve`, which takes the pad's own shape",
    ),
    Flag(
        "contact_too_slender",
        "the contact is too slender",
        "check semi-axes and angle, or use `fingerpad solve`",
    ),
    Flag(
        "layer_too_thin",
        "the contact radius exceeds three times the thickness, or the indentation all of it",
        "take lower loads, or check the thickness",
    ),
    Flag(
        "poisson_ratio_out_of_range", "Poisson's ratio is below 0.3", "state a Poisson's ratio of 0.3 to 0.5"
    ),
    Flag(
        "thickness_ignored",
        "Hertz theory holds for deep tissue: the thickness that was given is ignored",
        "take the fast law, or a solver, for a layer over bone",
    ),
    Flag(
        "uncertainty_out_of_range",
        "a standard uncertainty reaches beyond their range",
        "state the thickness or the semi-axes more exactly",
    ),
)
_ROW: Final = (
    Flag(
        "faces_disagree",
        "the finger's photographs disagree about its semi-axes (p < 0.01)",
        "check scale and face of each photograph",
    ),
    Flag(
        "curvature_disagrees",
        "at the place of contact the outline of the finger's side has another radius of curvature than the "
        "ellipsoid, beyond their uncertainties",
        "check the wedge angle; the radius of the outline is `outline_radius_mm`",
    ),
    Flag(
        "implausible_size",
        "a semi-axis of the pad lies outside 2–40 mm",
        "check the scale of the photographs, or the unit of the semi-axes",
        "pooling",
    ),
    Flag("implausible_modulus", "Young's modulus lies outside 1–5000 kPa", "check load and scale", "pooling"),
    Flag("deeper_than_pad", "the indentation exceeds the palmar semi-axis", _CHECK_UNITS),
    Flag(
        "as_wide_as_pad",
        "the contact is as wide as the finger",
        "check the scale; semi-axes of an ellipse are half its length and width",
    ),
    Flag(
        "layer_out_of_range",
        "the contact is out of the range of the laws for a layer over bone",
        "see `layer_flag` for why",
    ),
)

_BY_KIND: Final[Mapping[Flagged, tuple[Flag, ...]]] = {
    "contact": _CONTACT,
    "scale": _SCALE,
    "frame": _FRAME,
    "photograph": _PHOTOGRAPH,
    "curve": _CURVE,
    "layer": _LAYER,
    "row": _ROW,
}
FLAGS: Final[Mapping[Flagged, Mapping[str, Flag]]] = {
    kind: {flag.code: flag for flag in flags} for kind, flags in _BY_KIND.items()
}


def flags_in(
    codes: str | Iterable[str], *kinds: Flagged, notes: Mapping[str, str] = MappingProxyType({})
) -> Iterator[Flag]:
    """Yield the flags of some codes, in their order.

    Codes may be a cell of a table, separated by spaces. Where two kinds know a code, the first says what it
    means; `notes` hold what a code means in this case.
    """
    for code in codes.split() if isinstance(codes, str) else codes:
        flag = next(FLAGS[kind][code] for kind in kinds if code in FLAGS[kind])
        yield replace(flag, words=notes.get(code, flag.words))


def beside_a_layer(flag: Flag) -> Flag:
    """Return a flag of a curve to which a layer was fitted too, without the words that ask for one."""
    cut = {name: getattr(flag, name).partition(f"; {GIVE_SEMI_AXES}")[0] for name in ("words", "to_do")}
    return replace(flag, **cut)
