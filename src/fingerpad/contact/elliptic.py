"""Complete elliptic integrals and the functions of the contact ellipse, exact from the circle to the line.

The textbook forms of elliptical Hertz theory hold differences, K − E and E/k² − K, that lose every digit as
the ellipse becomes a circle. Written with

    B = ∫ cos²φ/Δ dφ,   D = ∫ sin²φ/Δ dφ,   K = B + D,   E = B + k²D,   Δ² = cos²φ + k² sin²φ

over a quarter turn they hold none: both tend to π/4. One arithmetic–geometric-mean run on (1, k) yields K
and, as a sum of positive terms, B/K: Gauss' transformation leaves ∫ (α cos²φ + β sin²φ)/Δ unchanged when the
weights α, β are averaged along with the axes. Here k = ℓe/ℓd is the axis ratio of the contact ellipse.
"""

from collections.abc import Sequence

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, apply_blockwise, as_float_array

# Four steps bring the mean to the last digit for k ≥ 7e-5, thirteen for every double.
_FEW_STEPS = 7e-5
_STEPS = 4
_STEPS_NEAR_LINE = 13

# k ≈ P(t)/(Q(t) √(R'/R'')) with t = ln(R'/R''), within 2.4e-7 for R'/R'' ≤ 2e7.
# Exact at the circle; benchmarks/derive/axis_ratio.py fits it. A root costs less than an exponential.
_GUESS_LIMIT = 2e7
_GUESS_NUMERATOR = (1.0, 0.345461202, 0.0737191859, 0.0142863998, 0.000460487795)
_GUESS_DENOMINATOR = (1.0, 0.512132084, 0.145163774, 0.0290864896, 0.0025719441, 1.70218463e-05)


def _mean(k: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
    """Return K and the sum p, from which `_shares` has B and D."""
    arithmetic, geometric = 0.5 * (1 + k), np.sqrt(k)
    total = arithmetic + geometric
    p = geometric / total
    difference = 0.5 - p  # of the two weights, relative to the first step's
    for _ in range(steps - 1):
        geometric = np.sqrt(arithmetic * geometric)
        arithmetic = 0.5 * total
        total = arithmetic + geometric
        weight = geometric / total
        p = p + weight * difference
        weight = 0.5 - weight
        difference = difference * weight
    # What the steps not taken would add, but for sixth powers of the last weight's distance from ½.
    square = weight * weight
    p += difference * (0.5 - 0.25 * square)
    return np.pi / (total * (1 - square * (1 + 1.25 * square))), p


def _shares(k: FloatArray, p: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return B/K, D/K and −(dB/d ln k)/K."""
    q = k / (1 + k)
    b = q + (0.5 - q) * p
    return b, 1 - b, q * q * (1 - p)


def polynomial(coefficients: Sequence[float] | FloatArray, at: FloatArray) -> FloatArray:
    """Return Σ c_j x^j, the coefficients along the first axis."""
    value = coefficients[-1] * at
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= at
    value += coefficients[0]
    return value


def _newton_step(k: FloatArray, ratio: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
    """Return a better k, quadratically convergent in ln k, and K there."""
    integral, p = _mean(k, steps)
    b, d, curvature = _shares(k, p)
    residual = b / (k * k * ratio * d) - 1
    slope = 2 + (curvature - b * b) / (b * d)  # = −d ln(R'/R'')/d ln k
    # ½ is the logarithm's, less what a step along the curve rather than its tangent takes, 0.002 to 0.018.
    change = residual * (1 - 0.49 * residual) / slope
    return k * (1 + change * (1 + 0.5 * change)), integral * (1 - change * (b - 0.5 * change * curvature))


def _fast_log(x: FloatArray) -> FloatArray:
    """Return ln x to seven digits, which do for a first guess, in half the time of all digits."""
    return np.log(x) if np.iscomplexobj(x) else np.log(x.astype(np.float32)).astype(np.float64)


def cube_root(x: FloatArray) -> FloatArray:
    """Return ∛x ≥ 0: Halley's step, which trebles the digits, from one of single precision.

    `numpy.cbrt` takes twice the time where it is not vectorised, as on processors without AVX-512. It is
    called where single precision might not hold a value, zero and NaN included.
    """
    if not (x.min(initial=1) > 1e-30 and x.max(initial=1) < 1e30):
        return np.cbrt(x)
    root = np.exp(np.log(x.astype(np.float32)) * np.float32(1 / 3)).astype(np.float64)
    cube = root * root * root
    root += root * ((x - cube) / (2 * cube + x))
    return root


def _solve(ratio: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return k and K for curvature ratios R'/R'' ≥ 1: one step from the guess, more only near the line."""
    t = _fast_log(ratio)
    k = polynomial(_GUESS_NUMERATOR, t) / (polynomial(_GUESS_DENOMINATOR, t) * np.sqrt(ratio))
    k, integral = _newton_step(k, ratio, _STEPS)
    far = ratio > _GUESS_LIMIT
    if far.any():
        k[far], integral[far] = _solve_near_line(ratio[far])
    return k, integral


def _solve_near_line(ratio: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return k and K for slender contacts, starting from k² R'/R'' ln(4/k) ≈ 1."""
    k = 1 / np.sqrt(ratio * (1 + 0.5 * np.log(ratio)))
    for _ in range(6):
        k, integral = _newton_step(k, ratio, _STEPS_NEAR_LINE)
    return k, integral


def contact_ellipse_kernel(
    first: FloatArray, second: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return k, K and D for one block of relative principal radii, in either order of size."""
    ratio = np.maximum(first, second) / np.minimum(first, second)
    k, integral = _solve(ratio)
    return k, integral, integral / (1 + ratio * k * k)


def solve_contact_ellipse(
    first_radius: ArrayLike, second_radius: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    r"""Return the axis ratio k = ℓe/ℓd ≤ 1 of the contact ellipse and the integrals K and D of its size.

    Solves R'/R'' = B/(k² D) (Johnson 1985, Eq. 4.28, in the form that does not cancel) for relative principal
    radii in either order of size. NaN where they are not positive and finite.
    """
    return apply_blockwise(contact_ellipse_kernel, 3, first_radius, second_radius)  # type: ignore[return-value]


def complete_integrals(axis_ratio: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the complete elliptic integrals K, B and D of modulus e = √(1 − k²), for k = ℓe/ℓd in (0, 1].

    K = B + D, and the integral of the second kind is E = B + k²D.
    """

    def kernel(k: FloatArray) -> tuple[FloatArray, ...]:
        k = np.where((k.real > 0) & (k.real <= 1), k, np.nan)
        integral, p = _mean(k, _STEPS if np.nanmin(k.real, initial=1) >= _FEW_STEPS else _STEPS_NEAR_LINE)
        b, d, _ = _shares(k, p)
        return integral, integral * b, integral * d

    return apply_blockwise(kernel, 3, axis_ratio)  # type: ignore[return-value]


def curvature_ratio(axis_ratio: ArrayLike) -> FloatArray:
    r"""Return the ratio of relative principal radii R'/R'' = B/(k²D) ≥ 1 that a contact ellipse implies.

    Johnson (1985), Eq. 4.28, is (E/k² − K)/(K − E).
    """
    k = as_float_array(axis_ratio)
    _, b, d = complete_integrals(k)
    with np.errstate(all="ignore"):
        return b / (k * k * d)


@np.errstate(all="ignore")
def factor_products(axis_ratio: ArrayLike) -> tuple[FloatArray, FloatArray]:
    r"""Return :math:`F_1^3 = \frac{4}{\pi}\sqrt{kBD}` and :math:`F_1 F_2 = \frac{2}{\pi}\sqrt{k}K`."""
    k = as_float_array(axis_ratio)
    integral, b, d = complete_integrals(k)
    return (4 / np.pi) * np.sqrt(k * b * d), (2 / np.pi) * np.sqrt(k) * integral


def size_factor(axis_ratio: ArrayLike) -> FloatArray:
    r"""Return Johnson's F1: the mean contact radius √(ℓd ℓe) over that of the sphere of radius √(R'R'').

    F1³ = (4/π) √k √(BD) ≤ 1 (Johnson 1985, Eq. 4.29; "F2" in Dzidek et al. 2017).
    """
    return np.cbrt(factor_products(axis_ratio)[0])


def indentation_factor(axis_ratio: ArrayLike) -> FloatArray:
    r"""Return Johnson's F2: the indentation over that of the sphere of radius √(R'R'') at the same load.

    F2 = (2/π) √k K/F1 ≤ 1 (Johnson 1985, Eq. 4.26c). The "F1" of Dzidek et al. (2017) is without (2/π) √k.
    """
    cube, product = factor_products(axis_ratio)
    return product / np.cbrt(cube)
