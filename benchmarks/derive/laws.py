"""Coefficients of the fast laws, from contacts that the solver solved.

``python -m benchmarks.derive.laws`` writes ``fingerpad.contact.law_coefficients`` from them. The series
of thick layers and the limits of thin ones are known; least squares find the rest.
"""

import textwrap
from pathlib import Path
from unittest.mock import patch

import numpy as np

from benchmarks.arrays import Array
from benchmarks.claims import fast_laws
from benchmarks.derive.solved_contacts import AREA_BIAS, KEPT, kept_contacts, kept_pads
from benchmarks.truth.layers import circular_contacts, layer_spectrum
from fingerpad.contact import Tissue, hertz_contact, solve_contact_ellipse
from fingerpad.contact import law_coefficients as law
from fingerpad.contact.elliptic import curvature_ratio
from fingerpad.contact.fast_laws import plate_gap
from fingerpad.contact.law_factors import LayerFactors, PadFactors, layer_basis, thin_layer

_SERIES = 5  # coefficients of a layer's series that are known
_ROUNDS = 15  # of weighting, towards the least largest error
SCALE = 1.75
_SLENDER = 1 - np.linspace(1e-4, 0.54, 40)


class Solved:
    """Kept contacts; load, indentation and peak pressure are over those of Hertz theory of the same area."""

    def __init__(self, rows: Array, *, is_pad: bool) -> None:
        placement, tissue = kept_contacts(rows, is_pad=is_pad)
        load, area, indentation, ratio, peak = rows[:, -5:].T
        area = area / AREA_BIAS
        hertz = hertz_contact(placement, Tissue.of_reduced_modulus(1.0), area=area)
        self.gap, self.radius, self.k = plate_gap(placement), np.sqrt(area / np.pi), 1 / hertz.aspect_ratio
        self.size, self.poisson_ratio = self.radius / tissue.thickness, tissue.poisson_ratio
        self.load, self.indentation = load / hertz.load, indentation / hertz.indentation
        self.peak, self.ratio, self.length = peak * area / (1.5 * load), ratio, (1 / ratio - ratio) / 2
        self.slenderness = (1 - self.k) ** 2 / self.k
        along = np.where(self.gap.first_radius > self.gap.second_radius, 0.5, -0.5)
        self.elongation = along * (1 / self.k - self.k)


def pads(rows: Array) -> Solved:
    """Return kept pads, but for those far beyond the laws' range."""
    k, _, _ = solve_contact_ellipse(*kept_pads(rows).curvature.principal_radii)
    size = np.sqrt(rows[:, 8] / np.pi) / rows[:, 5]
    return Solved(rows[(size < 3.05) & (k > np.where(size > 0, 0.49, 0.32))], is_pad=True)


def circles() -> tuple[Array, ...]:
    """Return a/t, ν and `circular_contacts`' three ratios, over a grid."""
    sizes = np.concatenate([np.geomspace(0.05, 3.2, 40), [4, 6, 10]])
    ratios = 0.4 - 0.1 * np.cos(np.pi * np.arange(13) / 12)
    found = np.concatenate([circular_contacts(sizes, each, 64) for each in ratios])
    return np.tile(sizes, 13), np.repeat(ratios, 43), *found.T


def least_largest(columns: Array, target: Array, weight: Array) -> Array:
    """Return the coefficients of columns that sum to a target, towards the least largest error."""
    scale, rising = np.linalg.norm(columns * weight[:, None], axis=0), weight.copy()
    for _ in range(_ROUNDS):
        solution = np.linalg.lstsq(columns / scale * rising[:, None], target * rising, rcond=1e-12)[0]
        error = np.abs(columns / scale @ solution - target) * weight
        rising *= np.sqrt(0.5 + error / error.max())
    return solution / scale


def _logarithms(eta: Array) -> Array:
    """Return ln W and ln ξ over those of the circle of equal area, and ln k, for ln(κ1/κ2)."""
    larger = np.exp(np.abs(eta) / 2)
    k, integral, D = solve_contact_ellipse(np.exp(eta / 2), np.exp(-eta / 2))
    return np.log([0.25 * np.pi / (larger * D) * k**-1.5, 0.5 * integral / (k * larger * D), k])


def elliptical_parts(k: Array) -> dict[str, Array]:
    """Return what a slender contact changes in the series of a thick layer.

    To the fourth power of x the layer adds one curvature in all directions, and a uniform displacement.
    """
    eta, step = np.log(curvature_ratio(k)), 1e-4
    load, _, _ = _logarithms(eta)
    slope = (_logarithms(eta + step) - _logarithms(eta - step)) / (2 * step)
    added = np.exp(load)  # curvature over the geometric mean's, in units of the circle's
    _, integral, _ = solve_contact_ellipse(curvature_ratio(k), np.ones(k.shape))
    return {
        "curved_load": added * (np.cosh(eta / 2) - 2 * np.sinh(eta / 2) * slope[0]),
        "curved_indentation": added * (np.cosh(eta / 2) - 2 * np.sinh(eta / 2) * slope[1]),
        "uniform": np.pi / (2 * np.sqrt(k) * integral),
        "moment": 0.5 * (k + 1 / k),
    }


def thick_series(poisson_ratio: float) -> tuple[Array, Array]:
    """Return ln W/W_H and ξ/ξ_H at equal area, as powers of x to the fourth, shape (5, slender)."""
    wavenumber, weight = layer_spectrum(poisson_ratio)
    uniform, curved = weight.sum(), -0.25 * weight @ wavenumber**2  # α0 and α2 of Σ α_j (r/t)^j
    parts, one = elliptical_parts(_SLENDER), np.ones(_SLENDER.size)
    first = 4 * uniform / (3 * np.pi) * parts["uniform"]
    added = 8 * curved / (3 * np.pi)
    third = added * parts["curved_indentation"]
    third += 8 * curved / (15 * np.pi) * parts["uniform"] * parts["moment"]
    return (
        np.stack([0 * one, 0 * one, 0 * one, added * parts["curved_load"], 0 * one]),
        np.stack([one, first, 0 * one, third, added * parts["curved_load"] * first]),
    )


def known_coefficients() -> tuple[Array, Array]:
    """Return the first five coefficients of P and Q, each as a row over `layer_basis`, shape (5, 9)."""
    u = 0.3 * np.exp(2j * np.pi * np.arange(32) / 32)[:, None]
    x = u / (1 - u / SCALE)
    s = (1 - _SLENDER) ** 2 / _SLENDER
    bases: list[Array] = []
    load_rows: list[Array] = []
    depth_rows: list[Array] = []
    for nu in np.linspace(0.3, 0.5, 21):
        load, depth = (sum(c * x**j for j, c in enumerate(each)) for each in thick_series(nu))
        thin_load, _, thin_depth = thin_layer(x, np.full(x.shape, nu))
        for rows, values in ((load_rows, load - np.log(1 + thin_load)), (depth_rows, depth - thin_depth)):
            powers = np.fft.fft(values / (1 - u / SCALE), axis=0)[:_SERIES].real / 32
            rows.append(powers / 0.3 ** np.arange(_SERIES)[:, None])
        bases.append(layer_basis(np.full(s.shape, nu), s))
    basis = np.concatenate(bases, axis=1).T
    found: list[Array] = []
    for rows in (load_rows, depth_rows):
        target = np.concatenate(rows, axis=1).T
        found.append(np.asarray(np.linalg.lstsq(basis, target, rcond=None)[0].T, dtype=np.float64))
        left = np.abs(basis @ found[-1].T - target).max(axis=0)
        print("    known coefficients left", " ".join(f"{each:.0e}" for each in left))
    return found[0], found[1]


def fit_layer(slender: Solved) -> None:
    """Find the coefficients of a layer."""
    known_load, known_depth = known_coefficients()
    size, nu, load, depth, peak = circles()
    weight = np.where(size < 3.3, 3.0, 1e-3)
    x, nu = np.concatenate([size, slender.size]), np.concatenate([nu, slender.poisson_ratio])
    s = np.concatenate([np.zeros(size.size), slender.slenderness])
    weight = np.concatenate([weight, np.ones(slender.size.size)])
    load, depth = np.concatenate([load, slender.load]), np.concatenate([depth, slender.indentation])
    peak = np.concatenate([peak, slender.peak])
    basis, u = layer_basis(nu, s), x / (1 + x / SCALE)
    thin_load, _, thin_depth = thin_layer(x, nu)
    lead = 1 - u / SCALE
    found = []
    for known, target, scale in (
        (known_load, np.log(load) - np.log(1 + thin_load), np.ones(x.size)),
        (known_depth, depth - thin_depth, 1 / depth),
    ):
        base = lead * sum((each @ basis) * u**j for j, each in enumerate(known))
        columns = np.concatenate([(lead * u**j * basis).T for j in range(_SERIES, 9)], axis=1)
        solution = least_largest(columns, target - base, weight * scale)
        found.append(np.concatenate([known, solution.reshape(-1, 9)]))
    law.LAYER = {"load": found[0][3:], "indentation": found[1]}
    columns = np.concatenate([(u ** (5 + j) * basis).T for j in range(4)], axis=1)
    law.LAYER_PEAK = least_largest(columns, peak - 1, weight / peak).reshape(4, 9)
    slim = slender.k < 0.95
    ratio = slender.length[slim] / np.abs(slender.elongation[slim])
    basis, u = layer_basis(slender.poisson_ratio[slim], slender.slenderness[slim]), u[size.size :][slim]
    columns = np.concatenate([(u ** (3 + j) * basis).T for j in range(4)], axis=1)
    law.LAYER_SHAPE = least_largest(columns, ratio - 1, np.abs(slender.elongation[slim])).reshape(4, 9)


def pad_numbers(found: Solved) -> tuple[Array, ...]:
    """Return w, p, m and 2μ1μ2 of `PadFactors`, times the mean radius squared, and e·m."""
    gap, q = found.gap, found.radius**2
    stretch = np.where(found.elongation > 0, 1 / found.k, found.k)
    first, second = gap.first_skewness**2 * stretch * q, gap.second_skewness**2 / stretch * q
    w = gap.flatness / np.sqrt(gap.first_radius * gap.second_radius) * q
    m = first - second
    return w, first + second, m, 2 * gap.first_skewness * gap.second_skewness * q, found.elongation * m


def sphere_series() -> tuple[Array, Array]:
    """Return ln W/W_H and ln ξ/ξ_H of Sneddon's sphere over w = (a/R)², as powers of w."""
    w = 0.31 * (1 - np.cos(np.linspace(1e-3, np.pi, 300)))
    a = np.sqrt(w)
    log = np.log((1 + a) / (1 - a))
    load, depth = np.log(0.75 * ((1 + w) * log / 2 - a) / a**3), np.log(log / 2 / a)
    known_load = 2 / 5, 9 / 35 - 0.5 * (2 / 5) ** 2
    known_depth = 1 / 3, 1 / 5 - 0.5 / 9
    found = []
    for target, (one, two) in ((load, known_load), (depth, known_depth)):
        columns = np.stack([w ** (j + 3) for j in range(4)], axis=1)
        rest = least_largest(columns, target - one * w - two * w * w, 1 / (w + 0.01))
        found.append(np.array([one, two, *rest]))
    return found[0], found[1]


def fit_pads(found: Solved) -> None:
    """Find the coefficients of the ellipsoid, from contacts on deep tissue."""
    w, p, m, cross, M = pad_numbers(found)
    s, e = found.slenderness, found.elongation
    one = np.ones(w.size)
    law.SPHERE = dict(zip(("load", "indentation"), sphere_series(), strict=True))
    law.PAD = {}
    columns = np.stack([p, p * s, M, w * s, w * p, p * p, w * w * p, w * p * p, p**3], axis=1)
    for of, ratio in (("load", found.load), ("indentation", found.indentation)):
        sphere = sum(c * w ** (j + 1) for j, c in enumerate(law.SPHERE[of]))
        law.PAD[of] = least_largest(columns, np.log(ratio) - sphere, one)
    terms = w, p, w * s, w * w, w * p, p * p, M, w * w * p, w * p * p, p**3
    law.PAD_PEAK = least_largest(np.stack(terms, axis=1), found.peak - 1, one)
    terms = m, m * s, e * w, e * w * s, e * p, m * w, m * p, e * w * w, e * w * p, e * p * p
    columns = np.stack([*terms, m * w * w, m * w * p, m * p * p], axis=1)
    law.PAD_SHAPE = np.zeros(13)
    for _ in range(40):
        along, turned = e + columns @ law.PAD_SHAPE, law.PAD_SHAPE[0] * cross
        target = np.sign(along) * np.sqrt(np.maximum(found.length**2 - turned**2, 0)) - e
        law.PAD_SHAPE = np.linalg.lstsq(columns, target, rcond=None)[0]


def fit_both(found: Solved) -> None:
    """Find what the ellipsoid and the layer change in each other."""
    w, p, m, _, M = pad_numbers(found)
    law.BOTH, law.BOTH_SHAPE = {}, np.zeros(6)
    s, e, x = found.slenderness, found.elongation, found.size
    layer = LayerFactors(np.ones(x.size), found.poisson_ratio, s)
    u, one = layer.size(x), np.ones(x.size)
    gap, stretch = found.gap, np.where(e > 0, 1 / found.k, found.k)
    skewness = gap.first_skewness, gap.second_skewness
    pad = PadFactors(
        gap.first_radius, gap.second_radius, *skewness, gap.flatness, stretch=stretch, elongation=e
    )
    products = np.stack([each * u ** (j + 1) for j in range(3) for each in (w, p, M, w * w, w * p)], axis=1)
    for of, target in (("load", found.load), ("indentation", found.indentation)):
        rest = np.log(target / layer.value(of, x)) - pad.value(of, found.radius, None)
        law.BOTH[of] = least_largest(products, rest, one).reshape(3, 5)
    flat = e * layer.roundness(x)
    columns = np.stack([e * w * u, e * w * u * u, e * p * u, e * p * u * u, m * u, m * u * u], axis=1)
    for _ in range(20):
        along, turned = pad.elongations(found.radius, u, flat)
        bare, _ = pad.elongations(found.radius, None, flat)
        target = np.sign(along) * np.sqrt(np.maximum(found.length**2 - turned**2, 0)) - bare
        law.BOTH_SHAPE = np.linalg.lstsq(columns, target, rcond=None)[0]
    rest = found.peak / layer.peak(x) - pad.peak(found.radius, None)
    law.BOTH_PEAK = least_largest(products, rest, one).reshape(3, 5)


def fit_guesses() -> None:
    """Find where Newton's method begins."""
    every = np.array(circles())
    size, nu, load, depth, _ = every[:, every[0] < 3.5]
    law.GUESS = {}
    for name, factor, power, first in (("load", load, 3, 3), ("indentation", depth, 2, 1)):
        hertz = size * factor ** (1 / power)
        y, v = hertz / (hertz + 2), 10 * (nu - 0.4)
        columns = np.stack([y ** (first + j) * each for each in (y**0, v) for j in range(4)], axis=1)
        guess = least_largest(columns, np.log(size / hertz), np.ones(size.size))
        left = np.abs(columns @ guess - np.log(size / hertz)).max()
        print(f"    first guess from {name} within {left:.1e}")
        law.GUESS[name] = guess.reshape(2, 4)


_MEANINGS = {
    "LAYER": "rows: powers of u, of the load from the third; columns: `layer_basis`",
    "LAYER_SHAPE": "rows: powers of u from the third; columns: `layer_basis`",
    "LAYER_PEAK": "rows: powers of u from the fifth; columns: `layer_basis`",
    "SPHERE": "powers of w from the first",
    "PAD": "p, p s, e m, w s, w p, p², w² p, w p², p³",
    "PAD_SHAPE": "m, m s, e w, e w s, e p, m w, m p, e w², e w p, e p², m w², m w p, m p²",
    "PAD_PEAK": "w, p, w s, w², w p, p², e m, w² p, w p², p³",
    "BOTH": "rows: powers of u from the first; columns: w, p, e m, w², w p",
    "BOTH_SHAPE": "e w u, e w u², e p u, e p u², m u, m u²",
    "BOTH_PEAK": "rows: powers of u from the first; columns: w, p, e m, w², w p",
    "GUESS": "powers of y, of the load from the third, else from the first; the same times 10 (ν − 0.4)",
}


def write() -> None:
    """Write the coefficients as a module."""
    lines = [
        '"""Coefficients of the laws of `law_factors`, written by benchmarks/derive/laws.py."""\n',
        "import numpy as np\n",
        "# fmt: off",
        f"SCALE = {SCALE}",
    ]
    for name, meaning in _MEANINGS.items():
        value = getattr(law, name)
        if isinstance(value, dict):
            parts = "".join(f'    "{of}": {_text(each, "    ")},\n' for of, each in value.items())
            text = f"{{\n{parts}}}"
        else:
            text = _text(value, "")
        lines += [f"# {meaning}", f"{name} = {text}"]
    Path(law.__file__).write_text("\n".join(lines) + "\n", encoding="utf-8")


def _text(value: Array, indent: str) -> str:
    texts = [", ".join(f"{each:.9g}" for each in row) for row in np.atleast_2d(value)]
    inner = texts[0] if value.ndim == 1 else ", ".join(f"[{text}]" for text in texts)
    inside = f"{indent}    "
    wrapped = textwrap.fill(inner, 100, initial_indent=inside, subsequent_indent=inside)
    return f"np.array([\n{wrapped}\n{indent}])"


def coefficients() -> dict[str, Array]:
    """Return a copy of all coefficients that the laws use now, by name."""
    values = {name: getattr(law, name) for name in _MEANINGS}
    parts = {name: [*one.values()] if isinstance(one, dict) else [one] for name, one in values.items()}
    return {name: np.concatenate([np.ravel(each) for each in some]) for name, some in parts.items()}


def fit_all() -> None:
    """Fit all coefficients, and put them in place of those in use."""
    kept = np.load(KEPT)
    fit_layer(Solved(kept["elliptical"], is_pad=False))
    fit_pads(pads(kept["pads"]))
    fit_both(pads(kept["layered"]))
    fit_guesses()


def fitted() -> dict[str, Array]:
    """Return all coefficients, fitted again; the laws keep theirs."""
    with patch.multiple(law, **{name: getattr(law, name) for name in _MEANINGS}):
        fit_all()
        return coefficients()


def show(images: int, seed: int, other: int) -> None:  # noqa: ARG001 - the solved contacts are kept
    """Print how far the coefficients in the code are from those fitted, and the errors on other contacts."""
    used, now = coefficients(), fitted()
    print(f"    {'coefficients':<14} {'number':>6}   largest difference, of the largest")
    for name, value in used.items():
        print(f"    {name:<14} {value.size:>6}   {np.abs(now[name] - value).max() / np.abs(value).max():.1e}")
    fast_laws.report()


if __name__ == "__main__":
    fit_all()
    write()
