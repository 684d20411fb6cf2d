"""Principal curvatures of a tensor."""

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.geometry.curvature import principal_curvatures


@given(st.floats(-5, 5), st.floats(-5, 5), st.floats(-5, 5))
@example(-0.0, -0.0, 1.0)
@example(-0.0, 0.0, -1.0)
def test_principal_curvatures_of_random_tensors(first, second, mixed) -> None:
    curvatures, angle = principal_curvatures(first, second, mixed)
    tensor = np.array([[first, mixed], [mixed, second]])
    assert_allclose(np.sort(curvatures), np.linalg.eigvalsh(tensor), atol=1e-12)
    direction = np.array([np.cos(angle), np.sin(angle)])
    assert_allclose(direction @ tensor @ direction, curvatures[0], atol=1e-12)
    assert abs(angle) <= np.pi / 4 + 1e-12


def test_complex_step_keeps_order() -> None:
    step = 1e-30j
    for first in (1.0, -1.0):
        up, down = (principal_curvatures(first + sign * step, first, 0.5)[0].real for sign in (1, -1))
        assert_allclose(up, [first + 0.5, first - 0.5], rtol=1e-15)
        assert_allclose(down, up, rtol=1e-15)
