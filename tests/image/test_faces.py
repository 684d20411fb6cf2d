"""Semi-axes from several faces: what they must not depend on, bias, coverage, and faces that disagree."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.claims import pooling
from hypothesis import given
from hypothesis import strategies as st

from fingerpad.exceptions import FitError
from fingerpad.image import FACE_AXES, FaceSemiAxes, Scale, combine_faces, photograph_from_ellipse

TRUTH = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8}
THREE = ("palmar", "distal", "radial")


def face(name, *, factors=(1.0, 1.0), std=0.05, scale_std=0.0, scale=None, correlation=0.0):
    lengths = np.array([TRUTH[axis] for axis in FACE_AXES[name]]) * factors
    covariance = std**2 * np.array([[1.0, correlation], [correlation, 1.0]])
    return FaceSemiAxes(
        face=name, semi_axes=lengths, covariance=covariance, relative_scale_std=scale_std, scale=scale
    )


@pytest.mark.parametrize("names", [("palmar", "radial"), THREE])
@pytest.mark.parametrize(("std", "scale_std"), [(0.0, 0.0), (1e-7, 0.05), (0.1, 0.01)])
def test_consistent_faces(names, std, scale_std):
    found = combine_faces(face(name, std=std, scale_std=scale_std) for name in names)
    assert found.semi_axes == pytest.approx(list(TRUTH.values()), rel=1e-9)
    assert found.chi_square == pytest.approx(0, abs=1e-6)
    assert (found.stds >= scale_std / math.sqrt(3) * found.semi_axes).all()


def test_too_small_uncertainty_of_one_face():
    found = combine_faces([face("palmar"), face("distal", factors=(1.04, 1.04), std=1e-9), face("radial")])
    assert found.disagree
    assert 1.01 < found.radial_ulnar / TRUTH["radial_ulnar"] < 1.03
    assert (found.stds > 0.005 * found.semi_axes).all()


@pytest.mark.parametrize("order", list(itertools.permutations(range(4)))[1::5])
def test_order_of_faces(order):
    faces = [
        face("palmar", factors=(1.02, 0.99), scale_std=0.02, scale="a"),
        face("distal", factors=(0.97, 1.01), std=0.2, correlation=0.9),
        face("radial", factors=(1.01, 1.03), scale_std=0.02, scale="a"),
        face("ulnar", factors=(1.05, 0.98), std=0.01, scale_std=0.01),
    ]
    one, other = combine_faces(faces), combine_faces(faces[k] for k in order)
    assert one.between_relative_std > 0
    np.testing.assert_allclose(other.semi_axes, one.semi_axes, rtol=1e-9)
    np.testing.assert_allclose(other.covariance, one.covariance, rtol=1e-6)
    assert other.chi_square == pytest.approx(one.chi_square, rel=1e-9)


@given(st.floats(1e-3, 1e3), st.integers(0, 10_000))
def test_unit_invariance(unit, seed):
    faces = some_faces(np.random.default_rng(seed))
    one = combine_faces(faces)
    other = combine_faces(
        replace(each, semi_axes=unit * each.semi_axes, covariance=unit**2 * each.covariance) for each in faces
    )
    np.testing.assert_allclose(other.semi_axes, unit * one.semi_axes, rtol=1e-9)
    np.testing.assert_allclose(other.stds, unit * one.stds, rtol=1e-6)


def some_faces(random):
    """Faces off by up to some percent, their uncertainties right or far too small, and correlated."""
    names = random.permutation([*THREE, "ulnar"])[: random.integers(2, 5)]
    if len({axis for name in names for axis in FACE_AXES[name]}) < 3:
        names = THREE
    return [
        face(
            name,
            factors=np.exp(0.04 * random.normal(size=2)),
            std=10 ** random.uniform(-6, 0),
            scale_std=random.choice([0.0, 0.01, 0.05]),
            correlation=random.uniform(-0.99, 0.99),
        )
        for name in names
    ]


def test_scale_shared_by_all_faces():
    factors = {"palmar": (1.01, 0.995), "distal": (0.99, 1.0), "radial": (1.0, 1.008)}
    alone, shared = (
        combine_faces(face(n, factors=f, std=0.1, scale_std=std, scale="camera") for n, f in factors.items())
        for std in (0.0, 0.03)
    )
    np.testing.assert_allclose(shared.semi_axes, alone.semi_axes, rtol=1e-9)
    assert shared.chi_square == pytest.approx(alone.chi_square, rel=1e-6)
    common = 0.03**2 * np.outer(alone.semi_axes, alone.semi_axes)
    np.testing.assert_allclose(shared.covariance, alone.covariance + common, rtol=1e-6)


def test_scale_shared_by_two_faces():
    def std(*scales):
        faces = [face(name, scale_std=0.03, scale=scale) for name, scale in zip(THREE, scales, strict=True)]
        return combine_faces(faces).stds[1]

    assert std(None, None, None) < std("a", None, "a") < std("a", "a", "a")


def test_photographs_measured_with_one_scale_share_its_error():
    def seen(*pitches):
        ellipse = {"centre": (300, 200), "semi_axes": (200, 250)}
        scales = [Scale(pitch, 0.05 * pitch) for pitch in pitches]
        fits = [photograph_from_ellipse(n, s, **ellipse) for n, s in zip(THREE[::2], scales, strict=True)]
        return combine_faces(fit.face_semi_axes for fit in fits)

    one, two = seen(0.05, 0.05), seen(0.05, 0.0501)
    assert (one.stds > 0.05 * one.semi_axes).all()
    assert two.stds[1] < 0.9 * one.stds[1]


@pytest.mark.parametrize(
    ("names", "std", "scale_std"),
    [
        (("palmar", "radial"), 1e-6, 0.02),
        pytest.param(THREE, (0.6, 0.1, 0.2), 0.02, marks=pytest.mark.nightly),
    ],
)
def test_bias_and_coverage(names, std, scale_std):
    found = pooling.score(
        pooling.faces, names, np.broadcast_to(std, 3)[: len(names)], scale_std, repeats=1000
    )
    assert (np.abs(found.bias) < 0.1).all()
    assert (found.covered > 0.93).all()
    assert (found.covered < 0.97).all()


def test_one_face_alone_refused():
    with pytest.raises(FitError, match=r"shows the palmar semi-axis \(given: palmar\)"):
        combine_faces(face("palmar"))


def test_swapped_axes_refused():
    swapped = FaceSemiAxes(face="radial", semi_axes=np.array([13.9, 7.9]), covariance=0.01 * np.eye(2))
    with pytest.raises(FitError, match=r"palmar semi-axis is 7.9 mm in the distal face, 13.9 mm in the rad"):
        combine_faces([face("palmar"), face("distal"), swapped])
    with pytest.raises(FitError, match="directions and the scale"):
        combine_faces([face("palmar"), swapped])


def test_disagreement_widens_result():
    faces = [face("palmar"), face("distal", factors=(1.1, 1.0)), face("radial")]
    found = combine_faces(faces)
    assert found.disagree
    assert 0.03 < found.between_relative_std < 0.08
    assert found.disagreements[1]["radial_ulnar"] - found.disagreements[0]["radial_ulnar"] > 0.09
    assert (found.stds > 3 * combine_faces(map(face, THREE)).stds).all()


def test_the_one_semi_axis_that_faces_disagree_about_is_no_surer_than_its_values():
    found = combine_faces([face("palmar", factors=(1.0, 0.94)), face("distal"), face("radial")])
    assert found.disagree
    assert found.stds[1] > 0.49 * 0.06 * found.distal
