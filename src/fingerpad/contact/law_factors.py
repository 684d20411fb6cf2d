r"""Factors on Hertz theory's load and indentation of one contact area: of the layer, and of the ellipsoid.

Those of the layer are, with x = √(A/π)/t and u = x/(1 + x/C),

.. math:: W/W_H = (1 + N)\,e^{(1 - u/C)\,u^3 P(u)}, \qquad \xi/\xi_H = q + (1 - u/C)\,Q(u),

with polynomials P and Q. N and q are those of a thin layer (`thin_layer`), compressible or not. The first
coefficients of P and Q are the series of a thick layer; the others are fitted to solved contacts, as are the
powers of the contact's size, times the numbers of `Gap`, that make the factors of the ellipsoid. For a sphere
these are Sneddon's (1965).
benchmarks/derive/laws.py derives all coefficients, and measures what they leave.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Self

import numpy as np

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.contact import law_coefficients as law
from fingerpad.contact.contact import FLAGS
from fingerpad.contact.elliptic import polynomial

WIDEST: Final = 0.601  # √(A/A_s), A_s being the area of the pad's silhouette seen along the plate's normal
MOST_SKEW: Final = 0.2  # (μ1 a1)² + (μ2 a2)²
MOST_SLENDER: Final = 0.33  # axis ratio in Hertz theory, of a whole ellipsoid
MOST_SLENDER_ON_LAYER: Final = 0.5
THINNEST: Final = 3.01  # √(A/π)/t, 3 with the laws' own error
LOWEST_POISSON_RATIO: Final = 0.3
_LARGEST_MISS = 0.01
_STEPS = 2  # of Newton's method: the first guess is within some per cent
Value = tuple[FloatArray, FloatArray]  # and its slope over the logarithm of the contact's mean radius


def layer_basis(poisson_ratio: FloatArray, slenderness: FloatArray) -> FloatArray:
    """Return the functions of ν and of (1 − k)²/k whose sums are the layer's coefficients."""
    v, s = 10 * (poisson_ratio - 0.4), slenderness
    basis = np.empty((9, *s.shape), dtype=np.result_type(v, s))
    basis[:5] = _powers(v, 5)
    basis[5] = s
    basis[8] = s * s
    np.multiply(s, basis[1:3], out=basis[6:8])
    return basis


def thin_layer(size: FloatArray, poisson_ratio: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    r"""Return the thin layer's W/W_H at equal area, its slope over ln x, and ξ/ξ_H, for a sphere; x = a/t.

    A thin layer is an elastic foundation whose pressure diffuses over the length λ, as the tissue is squeezed
    aside: u = A(p − λ²∇²p). Its exact answer for a paraboloid, Bessel functions of a/λ, is replaced by a root
    that has both limits, compressible and not: ξ/ξ_H = ½ − ¼(1 + (a/λ)²/12)^(−1/2).
    """
    w = 1 / (1 - poisson_ratio)
    stiff = (1 - 2 * poisson_ratio) * w * w
    spread = (3 - 4 * poisson_ratio) * w * w / 3 - stiff * w
    square = size * size
    root = np.sqrt(1 + stiff / (12 * spread) * square)
    load = (np.pi / 64) / spread * square * size / (root * (1 + root))
    return load, load * (1 + (1 + root) / (root * root)), 0.5 - 0.25 / root


def polynomial_slope(coefficients: Sequence[float] | FloatArray, at: FloatArray) -> FloatArray:
    """Return x times the derivative of `polynomial`."""
    value = (len(coefficients) - 1) * coefficients[-1] * at
    for power in range(len(coefficients) - 2, 0, -1):
        value += power * coefficients[power]
        value *= at
    return value


class LayerFactors:
    """Those of a layer, for contacts of mean radius a.

    `slenderness` is (1 − k)²/k, with the axis ratio k of Hertz theory; one ν for all contacts takes less
    time.
    """

    def __init__(self, thickness: FloatArray, poisson_ratio: FloatArray, slenderness: FloatArray) -> None:
        self._thickness, self.poisson_ratio, self._slenderness = thickness, poisson_ratio, slenderness
        self._basis: FloatArray | None = None
        self._known: dict[str, FloatArray] = {}
        # At which the thin layer's values, and u, are known.
        self._radius: FloatArray | None = None
        self._sized: FloatArray | None = None

    @property
    def is_half_space(self) -> BoolArray:
        """Whether there is no base."""
        return np.isinf(self._thickness)

    def ratio(self, radius: FloatArray) -> FloatArray:
        """Return a/t."""
        return radius / self._thickness

    def pressed_through(self, indentation: FloatArray) -> BoolArray:
        """Return whether contacts are indented by the thickness or more, which no layer can be."""
        return indentation.real >= self._thickness.real

    def size(self, radius: FloatArray) -> FloatArray:
        """Return u."""
        if radius is not self._sized:
            ratio = radius / self._thickness
            self._size, self._sized = ratio / (1 + ratio / law.SCALE), radius
        return self._size

    def coefficients(self, table: FloatArray) -> FloatArray:
        """Return the powers of u that a table of coefficients gives, along the first axis."""
        if self._basis is None:
            nu = self.poisson_ratio
            self._basis = layer_basis(nu, self._slenderness) if nu.ndim else _powers(self._slenderness, 3)
        if self.poisson_ratio.ndim:
            return table @ self._basis
        v = np.array([1, 10 * (self.poisson_ratio - 0.4)])
        circle = table[:, :5] @ (v[1] ** np.arange(5))
        slender = table[:, 5:8] @ (v[1] ** np.arange(3))
        return np.stack([circle, slender, table[:, 8]], axis=1) @ self._basis

    def value(self, of: str, radius: FloatArray) -> FloatArray:
        """Return W/W_H or ξ/ξ_H."""
        return self._parts(of, radius)[0]

    def value_and_slope(self, of: str, radius: FloatArray) -> Value:
        """Return W/W_H or ξ/ξ_H, and the slope of its logarithm."""
        value, fitted, u = self._parts(of, radius)
        rest, slope = 1 - u / law.SCALE, polynomial_slope(self._known[of], u)
        load, load_slope, indentation = self._thin
        if of == "load":
            return value, load_slope / (1 + load) + u * u * u * rest * rest * slope + fitted * (4 * rest - 1)
        root = 2 - 4 * indentation  # one over the thin layer's
        thin_slope = 0.25 * root * (1 - root * root)
        return value, (thin_slope + rest * rest * slope - u / law.SCALE * fitted) / value

    def _parts(self, of: str, radius: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the value, what is fitted of it or of its logarithm, and u."""
        if of not in self._known:
            self._known[of] = self.coefficients(law.LAYER[of])
        if radius is not self._radius:
            self._thin = thin_layer(self.ratio(radius), self.poisson_ratio)
            self._radius = radius
        u = self.size(radius)
        fitted = polynomial(self._known[of], u)
        fitted *= 1 - u / law.SCALE
        if of == "indentation":
            return fitted + self._thin[2], fitted, u
        fitted *= u * u * u
        return np.exp(fitted) * (1 + self._thin[0]), fitted, u

    def first_guess(self, of: str, radius: FloatArray) -> FloatArray:
        """Return about ln(a/a_H) at the load or indentation under which Hertz theory gives a_H."""
        ratio = radius / self._thickness
        y = ratio / (ratio + 2)
        v = 10 * (self.poisson_ratio - 0.4)
        even, odd = law.GUESS[of]
        guess: FloatArray = polynomial(even, y) + v * polynomial(odd, y)
        return guess * (y * y * y if of == "load" else y)

    def roundness(self, radius: FloatArray) -> FloatArray:
        """Return the factor on (a1/a2 − a2/a1)/2 of Hertz theory."""
        u = self.size(radius)
        return 1 + u * u * u * polynomial(self.coefficients(law.LAYER_SHAPE), u)

    def peak(self, radius: FloatArray) -> FloatArray:
        """Return the factor on the peak pressure 3W/(2A)."""
        u = self.size(radius)
        return 1 + u**5 * polynomial(self.coefficients(law.LAYER_PEAK), u)


class PadFactors:
    """Those of the ellipsoid, and of both together, for contacts of mean radius a.

    Radii, skewnesses and flatness are the gap's; `stretch` is a1/a2 in Hertz theory, `elongation` is (a1/a2 −
    a2/a1)/2. `whole` tells ellipsoids from paraboloids, whose factors are 1.
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
        skew = first * first_radius + second * second_radius
        # What the powers are of: flatness w, skewness along both axes together p and their difference m, the
        # product of both skewnesses, elongation e, (1 − k)²/k of Hertz theory s, and e m.
        self._w = flatness / np.sqrt(first_radius * second_radius)
        self._oblique = 1 - np.where(skew == 0, 0, skew / flatness)  # a paraboloid has neither
        self.whole: BoolArray = (flatness != 0) | (skew != 0)
        first, second = first * stretch, second / stretch
        self._p, self._m, self._cross = first + second, first - second, 2 * first_skewness * second_skewness
        self._e = elongation
        self._s = stretch + 1 / stretch - 2
        self._em = elongation * self._m
        self._known: dict[str, FloatArray] = {}

    def width(self, radius: FloatArray) -> FloatArray:
        """Return the contact's mean radius over that of the silhouette."""
        return np.asarray(radius * np.sqrt(self._w * self._oblique * np.sqrt(self._oblique)))

    def skewness(self, radius: FloatArray) -> FloatArray:
        """Return (μ1 a1)² + (μ2 a2)²."""
        return self._p * radius * radius

    def value(self, of: str, radius: FloatArray, u: FloatArray | None) -> FloatArray:
        """Return the logarithm of the factor on ``load`` or ``indentation``; u is a beside a thickness."""
        square = radius * radius
        value = polynomial(self._coefficients(of), square)
        if u is not None:
            value = value + u * polynomial(law.BOTH[of] @ self._products(square), u)
        return value

    def slope(self, of: str, radius: FloatArray, u: FloatArray | None) -> FloatArray:
        """Return the slope of `value` over the logarithm of the mean radius, as for it.

        On a layer within some per cent, enough for Newton's steps: its coefficients are all taken to grow as
        the area.
        """
        square = radius * radius
        slope = 2 * polynomial_slope(self._coefficients(of), square)
        if u is not None:
            c, rest = law.BOTH[of] @ self._products(square), 1 - u / law.SCALE
            slope = slope + u * ((2 + rest) * polynomial(c, u) + rest * polynomial_slope(c, u))
        return slope

    def _coefficients(self, of: str) -> FloatArray:
        """Return those of the powers of the mean radius squared, along the first axis."""
        if of not in self._known:
            w, p, s, c = self._w, self._p, self._s, law.PAD[of]
            kind = np.result_type(w, p, s)
            powers = _powers(w.astype(kind), 1 + len(law.SPHERE[of]))
            powers[1:] *= law.SPHERE[of][:, None]
            powers[0] = 0
            powers[1] += p * (c[0] + c[1] * s) + c[2] * self._em + c[3] * w * s
            powers[2] += p * (c[4] * w + c[5] * p)
            powers[3] += p * (c[6] * w * w + p * (c[7] * w + c[8] * p))
            self._known[of] = powers
        return self._known[of]

    def _products(self, square: FloatArray) -> FloatArray:
        w, p, em = self._w * square, self._p * square, self._em * square
        return np.stack([w, p, em, w * w, w * p])

    def elongations(
        self, radius: FloatArray, u: FloatArray | None, along: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return (a/b − b/a)/2 of the contact along the principal directions, and between them.

        `along` is what it is without the factors of the ellipsoid.
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
            value = value + u * polynomial(law.BOTH_PEAK @ self._products(q), u)
        return np.asarray(1 + value)


def _powers(at: FloatArray, count: int) -> FloatArray:
    powers = np.ones((count, *at.shape), dtype=at.dtype)
    for power in range(1, count):
        np.multiply(powers[power - 1], at, out=powers[power])
    return powers


def _has_law(poisson_ratio: FloatArray) -> BoolArray:
    """Return whether ν is one for which a layer has laws."""
    return (poisson_ratio.real >= LOWEST_POISSON_RATIO) & (poisson_ratio.real <= 0.5)


_POWERS: Final = {"load": 3, "indentation": 2, "area": 2}  # of the mean radius, in Hertz theory


@dataclass(frozen=True, slots=True, kw_only=True)
class Laws:
    """The factors that hold for one block of contacts."""

    elongation: FloatArray
    layer: LayerFactors | None
    pad: PadFactors | None

    @classmethod
    def of(
        cls,
        first: FloatArray,
        second: FloatArray,
        k: FloatArray,
        rest: tuple[FloatArray, ...],
        *,
        whole: bool,
        poisson_ratio: FloatArray | None,
        form: bool = False,
    ) -> Self:
        """Take the numbers of the gap, if it is a whole ellipsoid's, then thickness and ν, if any."""
        layer, pad, elongation = None, None, 0 * k
        if whole or form:
            longer_first = first > second  # by their complex steps where they are equal, as k is
            elongation = np.where(longer_first, 0.5, -0.5) * (1 - k * k) / k
        if whole:
            pad = PadFactors(
                first, second, *rest[:3], stretch=np.where(longer_first, 1 / k, k), elongation=elongation
            )
            rest = rest[3:]
        if rest:
            nu = rest[1] if poisson_ratio is None else poisson_ratio
            ignored = np.isinf(rest[0]) & ~_has_law(nu)  # ν matters to a layer alone
            if ignored.any():
                nu = np.where(ignored, 0.5, nu)
            layer = LayerFactors(rest[0], nu, (1 - k) * (1 - k) / k)
        return cls(elongation=elongation, layer=layer, pad=pad)

    def factor(self, of: str, radius: FloatArray) -> FloatArray:
        """Return the factor on load, indentation or area."""
        factor: FloatArray = np.ones(())
        u = None
        if of == "area":
            return factor
        if self.layer is not None:
            u = self.layer.size(radius)
            factor = self.layer.value(of, radius)
        return factor if self.pad is None else factor * np.exp(self.pad.value(of, radius, u))

    def mean_radius(
        self, of: str, value: FloatArray, unit: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the radius √(A/π) of a value, by how much Newton's method missed, and Hertz theory's."""
        power = _POWERS[of]
        ratio = np.where(value.real >= 0, value, np.nan) / unit
        if power == 2:
            hertz = np.sqrt(ratio)
        else:
            hertz = ratio ** (1 / 3) if np.iscomplexobj(ratio) else np.cbrt(ratio)
        change = np.zeros_like(hertz)
        if of == "area" or (self.layer is None and self.pad is None):
            return hertz, change, hertz
        radius = hertz
        if self.layer is not None:
            radius = hertz * np.exp(self.layer.first_guess(of, hertz))
        if self.pad is not None:
            radius = radius * np.exp(self.pad.value(of, radius, None) / -power)
        factor, slope = self._factor_and_slope(of, radius)
        for step in range(_STEPS):
            if step:
                factor = self.factor(of, radius)
            square = radius * radius
            miss = np.log(ratio / (factor * (square if power == 2 else square * radius))) / (power + slope)
            radius = radius * np.exp(miss)
        return radius, miss, hertz

    def _factor_and_slope(self, of: str, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the factor on load or indentation, and the slope of its logarithm."""
        factor, slope, u = np.ones(()), np.zeros(()), None
        if self.layer is not None:
            u = self.layer.size(radius)
            factor, slope = self.layer.value_and_slope(of, radius)
        if self.pad is not None:
            factor = factor * np.exp(self.pad.value(of, radius, u))
            slope = slope + self.pad.slope(of, radius, u)
        return factor, slope

    def axis_ratio(self, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return √(a/b) ≥ 1, and (a/b − b/a)/2 with a sign: positive along the first direction."""
        along, u = self.elongation, None
        if self.layer is not None:
            along, u = along * self.layer.roundness(radius), self.layer.size(radius)
        half = along * np.sign(along.real)
        if self.pad is not None:
            along, turned = self.pad.elongations(radius, u, along)
            half = np.sqrt(along * along + turned * turned)
        return np.sqrt(half + np.sqrt(1 + half * half)), along

    def peak(self, radius: FloatArray) -> FloatArray:
        """Return the factor on the peak pressure 3W/(2A)."""
        factor, u = 1 + 0 * radius, None
        if self.layer is not None:
            factor, u = self.layer.peak(radius), self.layer.size(radius)
        return factor if self.pad is None else factor * self.pad.peak(radius, u)

    def flag(
        self, radius: FloatArray, k: FloatArray, miss: FloatArray, value: FloatArray, hertz: FloatArray
    ) -> FloatArray:
        """Return the indices in `FLAGS`, of radii found for a value of which Hertz theory has others."""
        code = np.zeros(k.shape)
        found = np.isfinite(radius) & (np.abs(miss) < _LARGEST_MISS)
        known, size = found, radius.real
        ranges = []
        if self.layer is not None:
            ratio = self.layer.ratio(radius).real
            thick = found & (ratio >= 0) & (ratio <= THINNEST)
            # Beyond, the laws may have any radius, and the layer is called too thin.
            known, size = np.ones_like(found), np.where(thick, size, hertz.real)
            ranges += [
                ("layer_too_thin", thick),
                ("contact_too_slender", (k.real >= MOST_SLENDER_ON_LAYER) | self.layer.is_half_space),
            ]
        if self.pad is not None:
            ranges += [
                ("contact_too_slender", (k.real >= MOST_SLENDER) | ~self.pad.whole),
                ("contact_too_skew", self.pad.skewness(size).real <= MOST_SKEW),
                ("contact_too_wide", known & (self.pad.width(size).real <= WIDEST)),
            ]
        if self.layer is not None:  # the reason for what the other ranges miss
            ranges.append(("poisson_ratio_out_of_range", _has_law(self.layer.poisson_ratio)))
        ranges.append(("no_contact", (value.real > 0) & np.isfinite(value) & np.isfinite(k)))
        for name, inside in ranges:
            if not inside.all():
                code[~inside] = FLAGS.index(name)
        return code
