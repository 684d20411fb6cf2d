"""Arrays as they come in: masked entries are missing everywhere."""

import numpy as np
import pytest

from fingerpad._arrays import as_float_array
from fingerpad.contact import Tissue, hertz_contact
from fingerpad.exceptions import GeometryError, LoadingError, UncertaintyError
from fingerpad.geometry import Ellipsoid, Paraboloid, Placement
from fingerpad.loading import LoadingCurve
from fingerpad.uncertainty import Inputs, pool, pool_random_effects

MASKED = np.ma.masked_array([10.0, 999.0, 12.0], mask=[False, True, False])


@pytest.mark.parametrize("kind", [int, np.uint8, np.float32, float, complex])
def test_masked_entries_become_nan(kind) -> None:
    values = np.ma.masked_array([1, 2, 3], mask=[False, True, False], dtype=kind)
    found = as_float_array(values)
    assert not isinstance(found, np.ma.MaskedArray)
    assert found.dtype == (complex if kind is complex else float)
    np.testing.assert_array_equal(found, [1, np.nan, 3])
    np.testing.assert_array_equal(values, [1, 2, 3])  # the array given stays as it was
    assert np.isnan(as_float_array(np.ma.masked))


def test_kernels_with_masked_entries() -> None:
    contact = hertz_contact(Paraboloid(10.0, 10.0), Tissue(0.1), load=MASKED)
    assert np.isnan(contact.indentation).tolist() == [False, True, False]


def test_masked_values_refused() -> None:
    with pytest.raises(UncertaintyError, match="value to pool must be finite, found nan at index 1"):
        pool(MASKED, [0.1, 0.1, 0.1])
    with pytest.raises(UncertaintyError, match="standard uncertainty must be .*, found nan at index 1"):
        pool_random_effects([10.0, 11.0, 12.0], MASKED)
    with pytest.raises(GeometryError, match="found nan"):
        Ellipsoid(MASKED, 12.0, 13.0)
    with pytest.raises(GeometryError, match="found nan"):
        Tissue(MASKED)
    with pytest.raises(LoadingError, match="load is not finite in row 2"):
        LoadingCurve(load=MASKED, indentation=np.arange(3.0))


@pytest.mark.parametrize(
    ("make", "of"),
    [
        (lambda a: Paraboloid(a, 14.0), "first_radius"),
        (lambda a: Paraboloid(a, 14.0).gap, "first_radius"),
        (Tissue, "youngs_modulus"),
        (lambda a: Ellipsoid(a, 13.8, 11.8), "palmar"),
        (lambda a: Placement(Ellipsoid(7.9, 13.8, 11.8), wedge_angle=a / 100), "wedge_angle"),
        (lambda a: LoadingCurve(load=a, indentation=a), "load"),
        (lambda a: Inputs(names=("a", "b"), mean=a, covariance=np.eye(2), groups={}), "mean"),
    ],
)
def test_frozen_objects_keep_their_own_values(make, of: str) -> None:
    given = np.array([12.0, 13.0])
    kept = make(given)
    before = getattr(kept, of).copy()
    given[:] = 1.0
    np.testing.assert_array_equal(getattr(kept, of), before)
    with pytest.raises(ValueError, match="read-only"):
        getattr(kept, of)[:] = 1.0
