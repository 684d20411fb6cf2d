r"""Factors on Hertz theory's load and indentation of one contact area: of the layer, and of the ellipsoid.

Those of the layer are, with x = √(A/π)/t and u = x/(1 + x/C),

.. math:: W/W_H = (1 + N)\,e^{(1 - u/C) P(u)}, \qquad \xi/\xi_H = q + (1 - u/C)\,Q(u).

N and q are those of a thin layer, compressible or not. The first coefficients of P and Q are the series of a
thick layer; the others are fitted to solved contacts, as are the powers of the contact's size, times the
numbers of `PadGap`, that make the factors of the ellipsoid. For a sphere these are Sneddon's (1965).
benchmarks/contact_laws.py derives all coefficients, and measures what they leave.
"""

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.contact import law_coefficients as law

Value = tuple[FloatArray, FloatArray]  # and its slope over the logarithm of the contact's mean radius


def layer_basis(poisson_ratio: FloatArray, slenderness: FloatArray) -> FloatArray:
    """Return the functions of ν and of (1 − k)²/k whose sums are the layer's coefficients."""
    v, s = 10 * (poisson_ratio - 0.4), slenderness
    square = v * v
    return np.stack([np.ones_like(v), v, square, v * square, square * square, s, s * v, s * square, s * s])


def thin_layer(size: FloatArray, poisson_ratio: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    r"""Return the thin layer's W/W_H at equal area, its slope over ln x, and ξ/ξ_H, for a sphere.

    A thin layer is an elastic foundation whose pressure diffuses over the length λ, as the tissue is squeezed
    aside: u = A(p − λ²∇²p). Its exact answer for a paraboloid, Bessel functions of a/λ, is replaced by a root
    that has both limits, compressible and not: ξ/ξ_H = ½ − ¼(1 + (a/λ)²/12)^{−1/2}.

    Parameters
    ----------
    size : ndarray
        x = a/t.
    poisson_ratio : ndarray
        ν.
    """
    w = 1 / (1 - poisson_ratio)
    stiff = (1 - 2 * poisson_ratio) * w * w
    spread = (3 - 4 * poisson_ratio) * w * w / 3 - stiff * w
    square = size * size
    root = np.sqrt(1 + stiff / (12 * spread) * square)
    load = (np.pi / 64) * square * size / (spread * root * (1 + root))
    return load, load * (1 + (1 + root) / (root * root)), 0.5 - 0.25 / root


def polynomial(coefficients: FloatArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return Σ c_j x^j, the coefficients along the first axis, and its derivative."""
    value, slope = coefficients[-1] + 0 * at, 0 * at
    for coefficient in coefficients[-2::-1]:
        slope = slope * at + value
        value = value * at + coefficient
    return value, slope


class LayerFactors:
    """Those of a layer, for contacts of mean radius a.

    Parameters
    ----------
    thickness, poisson_ratio : ndarray
        Of the layer.
    slenderness : ndarray
        (1 − k)²/k, k being the axis ratio in Hertz theory.
    """

    def __init__(self, thickness: FloatArray, poisson_ratio: FloatArray, slenderness: FloatArray) -> None:
        self._thickness, self.poisson_ratio = thickness, poisson_ratio
        rows = (law.LAYER_LOAD, law.LAYER_INDENTATION, law.LAYER_SHAPE, law.LAYER_PEAK)
        ends = np.cumsum([len(each) for each in rows])[:-1]
        coefficients = np.concatenate(rows) @ layer_basis(poisson_ratio, slenderness)
        self._load, self._indentation, self._shape, self._peak = np.split(coefficients, ends)

    def ratio(self, radius: FloatArray) -> FloatArray:
        """Return a/t."""
        return radius / self._thickness

    def size(self, radius: FloatArray) -> FloatArray:
        """Return u."""
        ratio = radius / self._thickness
        return ratio / (1 + ratio / law.SCALE)

    def load(self, radius: FloatArray) -> Value:
        """Return ln(W/W_H), and its slope."""
        u = self.size(radius)
        thin, thin_slope, _ = thin_layer(radius / self._thickness, self.poisson_ratio)
        value, slope = polynomial(self._load, u)
        rest = 1 - u / law.SCALE
        cube = u * u * u
        value, slope = cube * value, cube * (3 * value + u * slope)  # of P, over ln u
        return np.log(1 + thin) + rest * value, thin_slope / (1 + thin) + rest * (
            rest * slope - u / law.SCALE * value
        )

    def indentation(self, radius: FloatArray) -> Value:
        """Return ln(ξ/ξ_H), and about its slope."""
        u = self.size(radius)
        _, _, thin = thin_layer(radius / self._thickness, self.poisson_ratio)
        value, slope = polynomial(self._indentation, u)
        rest = 1 - u / law.SCALE
        ratio = thin + rest * value
        return np.log(ratio), rest * u * (rest * slope - value / law.SCALE) / ratio

    def first_guess(self, of: str, radius: FloatArray) -> FloatArray:
        """Return about ln(a/a_H) at the load or indentation under which Hertz theory gives a_H."""
        ratio = radius / self._thickness
        y = ratio / (ratio + 2)
        v = 10 * (self.poisson_ratio - 0.4)
        even, odd = law.GUESS_LOAD if of == "load" else law.GUESS_INDENTATION
        power = y * y * y if of == "load" else y
        guess: FloatArray = power * (polynomial(even, y)[0] + v * polynomial(odd, y)[0])
        return guess

    def roundness(self, radius: FloatArray) -> FloatArray:
        """Return the factor on (a1/a2 − a2/a1)/2 of Hertz theory."""
        u = self.size(radius)
        factor: FloatArray = 1 + u * u * u * polynomial(self._shape, u)[0]
        return factor

    def peak(self, radius: FloatArray) -> FloatArray:
        """Return the factor on the peak pressure 3W/(2A)."""
        u = self.size(radius)
        factor: FloatArray = 1 + u**5 * polynomial(self._peak, u)[0]
        return factor


class PadFactors:
    """Those of the ellipsoid, and of both together, for contacts of mean radius a.

    Parameters
    ----------
    first_radius, second_radius, first_skewness, second_skewness, flatness : ndarray
        Of the gap.
    stretch : ndarray
        a1/a2 in Hertz theory.
    elongation : ndarray
        (a1/a2 − a2/a1)/2.
    """

    def __init__(
        self,
        first_radius: FloatArray,
        second_radius: FloatArray,
        first_skewness: FloatArray,
        second_skewness: FloatArray,
        flatness: FloatArray,
        *,
        stretch: FloatArray,
        elongation: FloatArray,
    ) -> None:
        first, second = first_skewness * first_skewness, second_skewness * second_skewness
        self._w = flatness / np.sqrt(first_radius * second_radius)
        self._oblique = 1 - (first * first_radius + second * second_radius) / flatness
        first, second = first * stretch, second / stretch
        self._p, self._m, self._cross = first + second, first - second, 2 * first_skewness * second_skewness
        self._e = elongation
        self._s = stretch + 1 / stretch - 2
        self._em = elongation * self._m

    def width(self, radius: FloatArray) -> FloatArray:
        """Return the contact's mean radius over that of the silhouette."""
        width: FloatArray = radius * np.sqrt(self._w * self._oblique * np.sqrt(self._oblique))
        return width

    def skewness(self, radius: FloatArray) -> FloatArray:
        """Return (μ1 a1)² + (μ2 a2)²."""
        skewness: FloatArray = self._p * radius * radius
        return skewness

    def factor(self, of: str, radius: FloatArray, u: FloatArray | None) -> Value:
        """Return the logarithm of the factor on load or indentation, and its slope.

        Parameters
        ----------
        of : str
            load or indentation.
        radius : ndarray
            Mean radius of the contact.
        u : ndarray, optional
            Its size beside a layer's thickness.
        """
        is_load = of == "load"
        sphere, c, both = (
            (law.SPHERE_LOAD, law.PAD_LOAD, law.BOTH_LOAD)
            if is_load
            else (law.SPHERE_INDENTATION, law.PAD_INDENTATION, law.BOTH_INDENTATION)
        )
        w, p = self._w, self._p
        square = radius * radius
        value, slope = polynomial(sphere, w * square)
        value, slope = w * square * value, w * square * (value + w * square * slope)
        powers = np.stack(
            [
                p * (c[0] + c[1] * self._s) + c[2] * self._em + c[3] * w * self._s,
                p * (c[4] * w + c[5] * p),
                p * (c[6] * w * w + p * (c[7] * w + c[8] * p)),
            ]
        )
        more, more_slope = polynomial(powers, square)
        value, slope = value + square * more, slope + square * (more + square * more_slope)
        if u is not None:
            more, more_slope = polynomial(both @ self._products(square), u)
            value = value + u * more
            slope = slope + 0.5 * u * ((3 - u / law.SCALE) * more + (1 - u / law.SCALE) * u * more_slope)
        return value, 2 * slope

    def _products(self, square: FloatArray) -> FloatArray:
        w, p, em = self._w * square, self._p * square, self._em * square
        return np.stack([w, p, em, w * w, w * p])

    def elongations(
        self, radius: FloatArray, u: FloatArray | None, along: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return (a/b − b/a)/2 of the contact along the principal directions, and between them.

        Parameters
        ----------
        radius, u : ndarray
            As for `factor`.
        along : ndarray
            What it is without the factors of the ellipsoid.
        """
        q = radius * radius
        w, p, m, e, s = self._w * q, self._p * q, self._m * q, self._e, self._s
        c = law.PAD_SHAPE
        along = along + m * (c[0] + c[1] * s + w * (c[5] + c[10] * w + c[11] * p) + p * (c[6] + c[12] * p))
        along = along + e * (w * (c[2] + c[3] * s + c[7] * w + c[8] * p) + p * (c[4] + c[9] * p))
        turned = c[0] * self._cross * q
        if u is not None:
            d = law.BOTH_SHAPE
            along = along + u * (e * (w * (d[0] + d[1] * u) + p * (d[2] + d[3] * u)) + m * (d[4] + d[5] * u))
            turned = turned + u * self._cross * q * (d[4] + d[5] * u)
        return along, turned

    def peak(self, radius: FloatArray, u: FloatArray | None) -> FloatArray:
        """Return the factor on the peak pressure 3W/(2A)."""
        q = radius * radius
        w, p, c = self._w * q, self._p * q, law.PAD_PEAK
        value = (
            w * (c[0] + c[2] * self._s + c[3] * w) + p * (c[1] + c[4] * w + c[5] * p) + c[6] * q * self._em
        )
        value = value + p * (c[7] * w * w + p * (c[8] * w + c[9] * p))
        if u is not None:
            value = value + u * polynomial(law.BOTH_PEAK @ self._products(q), u)[0]
        factor: FloatArray = 1 + value
        return factor
