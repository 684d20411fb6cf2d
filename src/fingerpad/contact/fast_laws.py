"""The contact of whole ellipsoids on a layer, by laws in closed form, as fast as Hertz theory."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, apply_blockwise, as_float_array, check_shapes
from fingerpad.contact.contact import (
    FLAGS,
    AnyPlacement,
    Contact,
    Form,
    Tissue,
    check_placement,
    check_pressed,
    from_reduced_modulus,
    only_given,
)
from fingerpad.contact.hertz import hertz_units
from fingerpad.contact.law_factors import Laws
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Gap

ERROR_OF_PAD: Final = (
    0.002  # largest relative error of load, area and indentation; of a layer alone twice this
)
ERROR_OF_BOTH: Final = 0.03  # a load at an indentation; of the rest 0.012


def fast_contact(
    placement: AnyPlacement,
    tissue: Tissue,
    *,
    load: ArrayLike | None = None,
    area: ArrayLike | None = None,
    indentation: ArrayLike | None = None,
) -> Contact:
    """Press whole pads against a plate, by laws that agree with the solved contact within 0.5 %.

    They hold for contacts up to 0.6 of the silhouette's mean radius, thicknesses from a third of the
    contact's mean radius and above the indentation, ν of a layer from 0.3 to 0.5, and axis ratios of Hertz
    theory down to 0.5 on a layer and to 0.33 elsewhere; beyond, they give NaN and a flag. Of whole pads on a
    layer, a load at an indentation is within 1 %; where a contact nears both 0.6 of the silhouette and three
    times the thickness, it is up to 3 % too low, and the rest 1 % off. Not pressed at all, load, area and
    indentation are 0, with the flag ``no_contact``.

    Parameters
    ----------
    placement : Placement or Paraboloid
        Where the pads touch a flat plate, or radii of curvature in place of the pads.
    tissue : Tissue
        What is pressed: deep, or a layer bonded to rigid bone.
    load, area, indentation : array_like
        Exactly one of normal force W, contact area A and mutual approach ξ.

    Returns
    -------
    Contact
        Shapes broadcast.

    Raises
    ------
    GeometryError
        If not exactly one of load, area and indentation is given, an argument is of another type, the
        shapes do not broadcast, or the pads touch a curved body.

    Examples
    --------
    The pad of Dzidek et al. (2017) at 2 N, on deep tissue and on 8 mm of it over bone:

    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> place = Placement(Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8), wedge_angle=np.radians(30))
    >>> contact = fast_contact(place, Tissue(youngs_modulus=0.1024, thickness=[np.inf, 8.0]), load=2.0)
    >>> contact.area.round(1), contact.indentation.round(2)
    (array([83.9, 77.3]), array([2.1 , 1.25]))
    >>> str(fast_contact(place, Tissue(youngs_modulus=0.1024, thickness=0.5), load=2.0).flags)
    'layer_too_thin'
    """
    name, value = check_pressed(placement, tissue, load=load, area=area, indentation=indentation)
    return press(
        plate_gap(placement),
        reduced_modulus=tissue.reduced_modulus,
        thickness=None if tissue.is_deep else tissue.thickness,
        poisson_ratio=tissue.poisson_ratio,
        **{name: value},
    )


def youngs_modulus(
    placement: AnyPlacement,
    *,
    load: ArrayLike,
    area: ArrayLike | None = None,
    indentation: ArrayLike | None = None,
    thickness: ArrayLike = math.inf,
    poisson_ratio: ArrayLike = 0.5,
) -> FloatArray:
    """Return Young's modulus with which whole pads under a load have an area or an indentation.

    The inverse of `fast_contact`, within its range.

    Parameters
    ----------
    placement : Placement or Paraboloid
        Where the pads touch a flat plate, or radii of curvature in place of the pads.
    load : array_like
        Normal force W.
    area, indentation : array_like
        Exactly one of contact area A and mutual approach ξ.
    thickness : array_like
        Of the tissue over bone; infinite for deep tissue.
    poisson_ratio : array_like
        ν of the tissue.

    Returns
    -------
    ndarray
        E; NaN beyond the range of the laws: `fast_contact` at that area or indentation says why.

    Raises
    ------
    GeometryError
        If not exactly one of area and indentation is given, or an argument is not possible.

    Examples
    --------
    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> place = Placement(Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8), wedge_angle=np.radians(30))
    >>> for thickness in (np.inf, 8.0):
    ...     modulus = youngs_modulus(place, load=2.0, area=116.3, thickness=thickness)
    ...     print(f"{1000 * modulus:.0f} kPa")
    61 kPa
    49 kPa
    """
    tissue = Tissue(1.0, poisson_ratio, thickness)  # or refuse the values
    gap = plate_gap(placement)
    name, value = only_given(area=area, indentation=indentation)
    load = as_float_array(load, "load")
    check_shapes(placement=placement.shape, tissue=tissue.shape, load=load.shape, **{name: value.shape})
    modulus, _ = find_modulus(
        gap,
        load=load,
        **{name: value},
        thickness=None if tissue.is_deep else tissue.thickness,
        poisson_ratio=tissue.poisson_ratio,
    )
    return from_reduced_modulus(modulus, tissue.poisson_ratio)


def plate_gap(placement: AnyPlacement) -> Gap:
    """Return the gap of placements where pads touch a flat plate; refuse a curved body."""
    check_placement(placement)
    gap = placement.gap
    if not isinstance(gap, Gap):
        raise GeometryError("the laws hold against a flat plate: leave the counterface out, or solve_contact")
    return gap


# `fast_contact` and `youngs_modulus` check what they are given, and then call `press` and `find_modulus`.
# Draws of a Monte Carlo and complex steps call these two themselves: a draw that no tissue has (a thickness
# below zero) gives NaN beside the others, where `Tissue` refuses them all. Fits of a loading curve vary the
# five numbers of a gap, for which there is no `Placement`.


def press(
    gap: Gap,
    *,
    reduced_modulus: ArrayLike,
    thickness: ArrayLike | None = None,
    poisson_ratio: ArrayLike = 0.5,
    load: ArrayLike | None = None,
    area: ArrayLike | None = None,
    indentation: ArrayLike | None = None,
) -> Contact:
    """Return `fast_contact` of gaps; nothing is checked, and complex steps give derivatives.

    A half-space where no thickness is given.
    """
    name, value = only_given(load=load, area=area, indentation=indentation)
    modulus = as_float_array(reduced_modulus)
    value = value / modulus if name == "load" else value
    force, size, depth, code = _apply(partial(_sizes, of=name), gap, value, thickness, poisson_ratio)
    return Contact(
        load=modulus * force,
        area=size,
        indentation=depth,
        flag_code=np.real(code).astype(np.int8)[()],
        _find_form=partial(law_form, gap, size, thickness=thickness, poisson_ratio=poisson_ratio),
    )


def law_form(
    gap: Gap, area: ArrayLike, *, thickness: ArrayLike | None = None, poisson_ratio: ArrayLike = 0.5
) -> Form:
    """Return the form of contacts of known area; NaN beyond the range of the laws."""
    major, minor, along, peak = _apply(_form, gap, area, thickness, poisson_ratio)
    return Form(semi_major=major, semi_minor=minor, along=np.real(along) >= 0, peak_over_mean_pressure=peak)


@np.errstate(all="ignore")
def find_modulus(
    gap: Gap,
    *,
    load: ArrayLike,
    area: ArrayLike | None = None,
    indentation: ArrayLike | None = None,
    thickness: ArrayLike | None = None,
    poisson_ratio: ArrayLike = 0.5,
) -> tuple[FloatArray, Contact]:
    """Return E* with which a load gives an area or an indentation, and the contact; nothing is checked."""
    only_given(area=area, indentation=indentation)
    load = as_float_array(load)
    unit = press(
        gap,
        reduced_modulus=1.0,
        thickness=thickness,
        poisson_ratio=poisson_ratio,
        area=area,
        indentation=indentation,
    )
    pressed = load.real > 0
    modulus = np.where(pressed & (unit.flag_code == 0), load, np.nan) / unit.load
    contact = replace(
        unit,
        load=np.where(np.isnan(modulus), np.nan, load)[()],
        area=np.where(pressed, unit.area, np.nan)[()],
        indentation=np.where(pressed, unit.indentation, np.nan)[()],
        flag_code=np.where(pressed, unit.flag_code, np.int8(FLAGS.index("no_contact")))[()],
    )
    return modulus, contact


def _apply(
    kernel: Callable[..., tuple[FloatArray, ...]],
    gap: Gap,
    value: ArrayLike,
    thickness: ArrayLike | None,
    poisson_ratio: ArrayLike,
) -> tuple[FloatArray, ...]:
    """Apply a kernel of four results blockwise; one ν for all contacts is passed as a number."""
    shape = gap.first_skewness, gap.second_skewness, gap.flatness
    whole = not gap.is_paraboloid
    return apply_blockwise(
        partial(
            kernel,
            whole=whole,
            poisson_ratio=as_float_array(poisson_ratio) if np.ndim(poisson_ratio) == 0 else None,
        ),
        4,
        *(gap.first_radius, gap.second_radius, value),
        *(shape if whole else ()),
        *(() if thickness is None else (thickness, poisson_ratio)),
    )


def _sizes(
    first: FloatArray,
    second: FloatArray,
    value: FloatArray,
    *rest: FloatArray,
    of: str,
    whole: bool,
    poisson_ratio: FloatArray | None,
) -> tuple[FloatArray, ...]:
    """Return load over E*, area, indentation and flag of one block."""
    k, unit_load, unit_depth = hertz_units(first, second)
    laws = Laws.of(first, second, k, rest, whole=whole, poisson_ratio=poisson_ratio)
    hertz = {
        "load": unit_load,
        "indentation": unit_depth,
        "area": np.array(np.pi),
    }
    a, miss, hertz_a = laws.mean_radius(of, value, hertz[of])
    square = a * a
    powers = {"load": square * a, "area": square, "indentation": square}
    results = [
        value if name == of else hertz[name] * power * laws.factor(name, a) for name, power in powers.items()
    ]
    code = laws.flag(a, k, miss, value, hertz_a)
    if laws.layer is not None:
        code[(code == 0) & laws.layer.pressed_through(results[2])] = FLAGS.index("layer_too_thin")
    if code.any():
        without = np.where(value == 0, 0 * k, np.nan)  # a pad that is not pressed has no contact
        results = [np.where(code == 0, each, without) for each in results]
    return *results, code


def _form(
    first: FloatArray,
    second: FloatArray,
    area: FloatArray,
    *rest: FloatArray,
    whole: bool,
    poisson_ratio: FloatArray | None,
) -> tuple[FloatArray, ...]:
    """Return semi-axes, elongation along the first direction and peak over mean pressure of one block."""
    k = hertz_units(first, second)[0]
    laws = Laws.of(first, second, k, rest, whole=whole, poisson_ratio=poisson_ratio, form=True)
    a, miss, hertz_a = laws.mean_radius("area", area, np.array(np.pi))
    ratio, along = laws.axis_ratio(a)
    results = a * ratio, a / ratio, along, 1.5 * laws.peak(a)
    inside = (laws.flag(a, k, miss, area, hertz_a) == 0) | (area == 0)
    return tuple(np.where(inside, each, np.nan) for each in results)
