"""Derive the rational first guess of `fingerpad.contact.elliptic` and print its coefficients.

Iteratively reweighted linear least squares on ln k = t P(t)/Q(t), t = ln(R'/R''), until the largest error
stops falling. Run it with ``python benchmarks/axis_ratio_guess.py``.
"""

import numpy as np

from fingerpad.contact.elliptic import curvature_ratio

DEGREES = (5, 4)
ROUNDS = 200


def main() -> None:
    """Print the numerator, the denominator and the largest error in ln k."""
    largest = 9.6  # −ln k at R'/R'' = 2e7
    log_k = -largest * (1 - np.cos(np.linspace(0, np.pi, 6001)))[1:] / 2
    t = np.log(curvature_ratio(np.exp(log_k)))
    scaled, target = t / 8, log_k / t
    numerator = np.vander(scaled, DEGREES[0] + 1, increasing=True)
    denominator = np.vander(scaled, DEGREES[1] + 1, increasing=True)
    weight, balance, best = np.ones_like(t), t + 0.02, (np.inf, np.empty(0), np.empty(0))
    for _ in range(ROUNDS):
        system = np.hstack([numerator, -target[:, None] * denominator[:, 1:]]) * (weight * balance)[:, None]
        solution = np.linalg.lstsq(system, target * weight * balance, rcond=None)[0]
        p, q = solution[: DEGREES[0] + 1], np.append(1, solution[DEGREES[0] + 1 :])
        error = np.abs((numerator @ p) / (denominator @ q) - target) * t
        if error.max() < best[0]:
            best = (error.max(), p / 8.0 ** np.arange(p.size), q / 8.0 ** np.arange(q.size))
        weight = 1 / np.abs(denominator @ q)
        balance *= np.sqrt(0.3 + error / error.max())
        balance /= balance.max()
    print(f"largest error in ln k: {best[0]:.2g} up to a curvature ratio of {np.exp(t.max()):.3g}")
    print("numerator  ", tuple(float(f"{c:.9g}") for c in best[1]))
    print("denominator", tuple(float(f"{c:.9g}") for c in best[2]))


if __name__ == "__main__":
    main()
