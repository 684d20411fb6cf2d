"""Rational first guess of `fingerpad.contact.elliptic`.

Iteratively reweighted linear least squares on k √(R'/R'') = P(t)/Q(t), t = ln(R'/R''), until the largest
error stops falling. P and Q are 1 at the circle, so that the guess is exact there.
"""

import numpy as np

from fingerpad.contact.elliptic import curvature_ratio

DEGREES = (4, 5)
ROUNDS = 2000


def show(images: int, seed: int, other: int) -> None:  # noqa: ARG001 - no images
    """Print the numerator, the denominator and the largest relative error of k."""
    largest = 9.6  # −ln k at R'/R'' = 2e7
    k = np.exp(-largest * (1 - np.cos(np.linspace(0, np.pi, 6001)))[1:] / 2)
    ratio = curvature_ratio(k)
    t, target = np.log(ratio), k * np.sqrt(ratio)
    numerator, denominator = (np.vander(t / 8, degree + 1, increasing=True)[:, 1:] for degree in DEGREES)
    weight, balance, best = np.ones_like(t), np.ones_like(t), (np.inf, np.empty(0), np.empty(0))
    for _ in range(ROUNDS):
        weighted = weight * balance
        system = np.hstack([numerator / target[:, None], -denominator]) * weighted[:, None]
        solution = np.linalg.lstsq(system, (1 - 1 / target) * weighted, rcond=None)[0]
        p, q = np.split(solution, [DEGREES[0]])
        error = np.abs((1 + numerator @ p) / (1 + denominator @ q) / target - 1)
        if error.max() < best[0]:
            best = (error.max(), *(np.append(1, c) / 8.0 ** np.arange(c.size + 1) for c in (p, q)))
        weight = 1 / np.abs(1 + denominator @ q)
        balance *= np.sqrt(0.3 + error / error.max())
        balance /= balance.max()
    print(f"largest relative error of k: {best[0]:.2g} up to a curvature ratio of {np.exp(t.max()):.3g}")
    print("numerator  ", tuple(float(f"{c:.9g}") for c in best[1]))
    print("denominator", tuple(float(f"{c:.9g}") for c in best[2]))
