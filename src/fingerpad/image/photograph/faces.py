"""The faces of a finger, their directions in a photograph, and the pad's semi-axes from those they show.

Each face shows two of the three semi-axes: the joint estimate is over-determined. Faces are combined as
logarithms, to which an error of a picture's scale adds the same amount whatever the length: a covariance of
lengths, with the scale's share computed from the measured values, biases the result below all of them
(Peelle's pertinent puzzle).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from scipy import special
from scipy.linalg import block_diag, solve_triangular
from scipy.optimize import brentq

from fingerpad._arrays import (
    ArrayLike,
    BoolArray,
    FloatArray,
    as_float_array,
    non_negative_number,
    real_array,
    set_fields,
)
from fingerpad._display import Displayed
from fingerpad._plausible import LEAST_SEMI_AXIS_MM
from fingerpad.exceptions import FingerpadError, FitError, ImageError

Face: TypeAlias = Literal["palmar", "distal", "radial", "ulnar"]
Direction: TypeAlias = Literal["up", "down", "left", "right"]

SEMI_AXES = ("palmar", "distal", "radial_ulnar")
# The semi-axes that (x, y), that is (across, along), show in a photograph of each face.
FACE_AXES: Mapping[Face, tuple[str, str]] = {
    "palmar": ("radial_ulnar", "distal"),
    "distal": ("radial_ulnar", "palmar"),
    "radial": ("palmar", "distal"),
    "ulnar": ("palmar", "distal"),
}
# One step in each direction, (row, column).
STEPS: Mapping[Direction, tuple[int, int]] = {"up": (-1, 0), "right": (0, 1), "down": (1, 0), "left": (0, -1)}
_TURNS: tuple[Direction, ...] = ("up", "right", "down", "left")

# Semi-axes of any finger pad lie between these.
PLAUSIBLE_SEMI_AXIS_MM = (LEAST_SEMI_AXIS_MM, 40.0)
# Relative standard uncertainty below which no semi-axis of a finger is known: a micrometre.
_MIN_RELATIVE_STD = 1e-4
# Chance of a disagreement below which it is no accident.
_DISAGREE = 0.01
# Relative standard deviation between faces beyond which they cannot be those of one finger.
_MAX_BETWEEN_STD = 0.3


def opposite(direction: Direction) -> Direction:
    """Return the direction half a turn away."""
    return _TURNS[(_TURNS.index(direction) + 2) % 4]


def check_face(face: str, error: type[FingerpadError]) -> None:
    """Refuse what is no face of a finger."""
    if face not in tuple(FACE_AXES):
        raise error(f"face must be one of {', '.join(FACE_AXES)}, found {face!r}")


def palmar_directions(face: Face, tip: Direction, palmar: Direction | None) -> tuple[Direction, ...]:
    """Return the directions that the palmar side may have in the photograph, one if it is known."""
    check_face(face, ImageError)
    for name, direction in (("tip", tip), ("palmar", palmar)):
        if not (direction in tuple(STEPS) or (name == "palmar" and direction is None)):
            raise ImageError(f"{name} must be one of {', '.join(STEPS)}, found {direction!r}")
    across = _TURNS[(_TURNS.index(tip) + 1) % 4], _TURNS[(_TURNS.index(tip) + 3) % 4]
    if palmar is None:
        return {"palmar": (tip,), "distal": ("down",)}.get(face, across)
    if face == "palmar":
        raise ImageError(f"the palmar face looks at the camera: leave palmar out, found {palmar!r}")
    if face != "distal" and palmar not in across:
        raise ImageError(
            f"with the tip {tip} the palmar side is {across[0]} or {across[1]}, found {palmar!r}"
        )
    return (palmar,)


def face_axes(face: Face, tip: Direction, palmar: Direction) -> FloatArray:
    """Return the steps (row, column) of the face's x (across) and y (along), one in each row."""
    along = STEPS[palmar] if face == "distal" else STEPS[tip]
    across = STEPS[palmar] if face in ("radial", "ulnar") else (along[1], -along[0])
    return np.array([across, along], dtype=np.float64)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FaceSemiAxes(Displayed):
    """The two semi-axes that one face shows.

    Attributes
    ----------
    face : Face
        The face that looked at the camera.
    semi_axes : ndarray, shape (2,)
        Semi-axes across and along, in the order of `FACE_AXES`, mm.
    covariance : ndarray, shape (2, 2)
        Their covariance without the scale's contribution, mm².
    relative_scale_std : float
        Relative standard uncertainty of the picture's scale.
    scale : str or None
        Name of the scale: faces of one name share its error; without a name it is the picture's own.
    flags : frozenset of str
        Doubts, by their codes in `fingerpad.flags`.

    Raises
    ------
    FitError
        If the face is unknown, the semi-axes are not two positive lengths, or a covariance or uncertainty is
        not one.

    Examples
    --------
    >>> face = FaceSemiAxes(face="palmar", semi_axes=np.array([11.8, 13.8]), covariance=0.01 * np.eye(2))
    >>> face.scale is None
    True
    """

    face: Face
    semi_axes: FloatArray
    covariance: FloatArray
    relative_scale_std: float = 0.0
    scale: str | None = None
    flags: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        check_face(self.face, FitError)
        scale_std = non_negative_number(self.relative_scale_std, "relative_scale_std", FitError)
        what = f"{self.face} face: "
        lengths = real_array(self.semi_axes, f"{what}semi_axes", FitError)
        if lengths.shape != (2,) or not ((lengths > 0) & np.isfinite(lengths)).all():
            raise FitError(f"{what}semi_axes must be two positive lengths, found {self.semi_axes}")
        covariance = real_array(self.covariance, f"{what}covariance", FitError)
        if covariance.shape != (2, 2) or not np.isfinite(covariance).all():
            raise FitError(f"{what}covariance must be finite, of shape (2, 2), found {covariance}")
        if np.linalg.eigvalsh(covariance).min() < -1e-12 * np.abs(covariance).max():
            raise FitError(f"{what}covariance must have no negative variance, found {covariance}")
        set_fields(self, semi_axes=lengths, covariance=covariance, relative_scale_std=scale_std)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PadSemiAxes(Displayed):
    """Semi-axes of a finger pad from two or more of its faces.

    Attributes
    ----------
    palmar, distal, radial_ulnar : float
        Semi-axes, mm, never sorted.
    covariance : ndarray, shape (3, 3)
        Their covariance in that order, mm², the disagreement between faces included.
    between_relative_std : float
        Relative standard deviation by which the faces differ beyond their stated uncertainties.
    chi_square : float
        Sum of squares of the faces' disagreement, weighted by their stated uncertainties alone; zero when
        nothing is over-determined.
    degrees_of_freedom : int
        Number of semi-axis values beyond the three that are needed.
    p_value : float
        Probability of at least this disagreement if the stated uncertainties are right, NaN without freedom.
    faces : tuple of FaceSemiAxes
        The faces combined.
    """

    palmar: float
    distal: float
    radial_ulnar: float
    covariance: FloatArray
    between_relative_std: float
    chi_square: float
    degrees_of_freedom: int
    p_value: float
    faces: tuple[FaceSemiAxes, ...]

    @property
    def semi_axes(self) -> FloatArray:
        """(palmar, distal, radial_ulnar), mm."""
        return np.array([self.palmar, self.distal, self.radial_ulnar])

    @property
    def disagree(self) -> bool:
        """Whether the faces disagree by more than their stated uncertainties allow: p < 0.01."""
        return self.p_value < _DISAGREE

    @property
    def stds(self) -> FloatArray:
        """Standard uncertainties of (palmar, distal, radial_ulnar), mm."""
        return np.sqrt(np.diagonal(self.covariance))

    @property
    def disagreements(self) -> tuple[dict[str, float], ...]:
        """By how much each face's semi-axes exceed the joint ones, by anatomical name, relative to them."""
        joint = dict(zip(SEMI_AXES, self.semi_axes, strict=True))
        return tuple(
            {
                name: float(value / joint[name] - 1)
                for name, value in zip(FACE_AXES[one.face], one.semi_axes, strict=True)
            }
            for one in self.faces
        )


def implausible_size(semi_axes: ArrayLike) -> BoolArray:
    """Return which semi-axes, mm, no finger pad has, as with a wrong unit or scale."""
    least, most = PLAUSIBLE_SEMI_AXIS_MM
    found = as_float_array(semi_axes)
    return (found < least) | (found > most)


def combine_faces(faces: Iterable[FaceSemiAxes]) -> PadSemiAxes:
    r"""Combine the semi-axes that two or more faces show into the three of the finger pad.

    Generalised least squares of the logarithms :math:`\ln\ell`, with covariance
    :math:`\Sigma_{ij}/(\ell_i\ell_j) + r^2`, the latter between lengths in one scale of relative standard
    uncertainty r. Faces that disagree by more than that allows (p < 0.01), no finger being an ellipsoid, are
    taken to differ by a relative standard deviation τ of their own: τ² is added to each variance so that
    :math:`\chi^2` is its degrees of freedom (Paule and Mandel). No face then counts for much more than the
    others, however small its stated uncertainty. No semi-axis is then surer than the standard error of the
    mean of its own values.

    No semi-axis lies further outside the range of its values in the faces than c of their stated standard
    uncertainties, where c² is χ², or its degrees of freedom where τ is not zero.

    Parameters
    ----------
    faces : iterable of FaceSemiAxes
        Semi-axes by face; a face may come more than once, from several photographs.

    Returns
    -------
    PadSemiAxes

    Raises
    ------
    FitError
        If something else is given, no face shows one of the semi-axes, or the faces contradict each other, as
        where the axes of one are swapped: τ exceeds 0.3.

    Examples
    --------
    >>> def seen(face, *semi_axes):
    ...     return FaceSemiAxes(face=face, semi_axes=np.array(semi_axes), covariance=0.01 * np.eye(2))
    >>> faces = [seen("palmar", 11.8, 13.8), seen("distal", 11.8, 7.9), seen("radial", 8.0, 13.7)]
    >>> found = combine_faces(faces)
    >>> found.semi_axes.round(2), found.stds.round(2), found.degrees_of_freedom, round(found.p_value, 2)
    (array([ 7.95, 13.75, 11.8 ]), array([0.07, 0.07, 0.07]), 3, 0.8)
    """
    faces = (faces,) if isinstance(faces, FaceSemiAxes) else tuple(faces)
    for one in faces:
        if not isinstance(one, FaceSemiAxes):
            raise FitError(f"give face_semi_axes of a measured photograph, found {type(one).__name__}")
    seen = {axis for one in faces for axis in FACE_AXES[one.face]}
    for axis in SEMI_AXES:
        if axis not in seen:
            showing = ", ".join(face for face, axes in FACE_AXES.items() if axis in axes)
            found = ", ".join(one.face for one in faces) or "none"
            raise FitError(f"no face given shows the {axis} semi-axis (given: {found}): add one of {showing}")
    values = np.concatenate([one.semi_axes for one in faces])
    design = np.array([[axis == name for name in SEMI_AXES] for one in faces for axis in FACE_AXES[one.face]])
    # Of the logarithms, with the errors of scales that faces share.
    keys = [place if one.scale is None else one.scale for place, one in enumerate(faces)]
    scale = np.repeat([keys.index(key) for key in keys], 2)
    scale_std = np.repeat([one.relative_scale_std for one in faces], 2)
    stated = block_diag(*(one.covariance for one in faces)) / np.outer(values, values)
    stated += np.where(scale[:, None] == scale, np.outer(scale_std, scale_std), 0.0)
    stated += _MIN_RELATIVE_STD**2 * np.eye(values.size)
    # About the geometric means, that rounding stays small beside the disagreement.
    means = design.T @ np.log(values) / design.sum(axis=0)
    off = np.log(values) - design @ means
    freedom = values.size - len(SEMI_AXES)

    def solved(between_variance: float) -> tuple[FloatArray, FloatArray, float]:
        root = np.linalg.cholesky(stated + between_variance * np.eye(values.size))
        white = solve_triangular(root, np.column_stack([design, off]), lower=True)
        inverse = np.linalg.pinv(white[:, :-1])
        shift = inverse @ white[:, -1]
        left = white[:, -1] - white[:, :-1] @ shift
        return shift, inverse @ inverse.T, float(left @ left)

    between_variance = 0.0
    shift, joint, chi_square = solved(0.0)
    p_value = float(special.chdtrc(freedom, chi_square)) if freedom else math.nan
    if p_value < _DISAGREE:
        most = 2 * float(off @ off) / freedom
        between_variance = brentq(lambda tried: solved(tried)[2] - freedom, 0, most, xtol=1e-15 * most)
        shift, joint, _ = solved(between_variance)
        # One semi-axis may be all that they disagree about: it is no surer than the mean of its own values.
        count = design.sum(axis=0)
        own = design.T @ off**2 / np.maximum(count * (count - 1), 1)
        joint = joint + np.diag(np.maximum(own - np.diagonal(joint), 0))
    between_std = math.sqrt(between_variance)
    if between_std > _MAX_BETWEEN_STD:
        raise FitError(_contradiction(faces, design, off))
    semi_axes = np.exp(means + shift)
    return PadSemiAxes(
        **dict(zip(SEMI_AXES, semi_axes.tolist(), strict=True)),
        covariance=np.asarray(joint * np.outer(semi_axes, semi_axes), dtype=np.float64),
        between_relative_std=between_std,
        chi_square=chi_square if freedom else 0.0,
        degrees_of_freedom=freedom,
        p_value=p_value,
        faces=faces,
    )


def _contradiction(faces: tuple[FaceSemiAxes, ...], design: FloatArray, off: FloatArray) -> str:
    """Return the words that name the semi-axis about which faces disagree most, and its values."""
    axis = SEMI_AXES[int(design[np.argmax(np.abs(off))].argmax())]
    values = ", ".join(
        f"{one.semi_axes[FACE_AXES[one.face].index(axis)]:.3g} mm in the {one.face} face"
        for one in faces
        if axis in FACE_AXES[one.face]
    )
    return (
        f"the faces contradict each other: the {axis} semi-axis is {values}: check that each picture shows "
        "the face given, in the directions and the scale given, or leave one out"
    )
