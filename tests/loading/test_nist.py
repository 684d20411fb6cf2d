"""Certified nonlinear regression problems of NIST through the one fitting function."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.exceptions import FitError
from fingerpad.loading.least_squares import fit_least_squares

FOLDER = Path(__file__).parent / "nist"
exp, pi = np.exp, np.pi


def gauss(b, x):
    hill = b[2] * exp(-((x - b[3]) ** 2) / b[4] ** 2) + b[5] * exp(-((x - b[6]) ** 2) / b[7] ** 2)
    return b[0] * exp(-b[1] * x) + hill


def enso(b, x):
    def wave(a, c, period):
        return a * np.cos(2 * pi * x / period) + c * np.sin(2 * pi * x / period)

    return b[0] + wave(b[1], b[2], 12) + wave(b[4], b[5], b[3]) + wave(b[7], b[8], b[6])


def ratio(over: int) -> Callable:
    def model(b, x):
        return np.polyval(b[over - 1 :: -1], x) / (1 + x * np.polyval(b[: over - 1 : -1], x))

    return model


def chwirut(b, x):
    return exp(-b[0] * x) / (b[1] + b[2] * x)


def lanczos(b, x):
    return sum(b[k] * exp(-b[k + 1] * x) for k in (0, 2, 4))


MODELS = {
    "Bennett5": lambda b, x: b[0] * (b[1] + x) ** (-1 / b[2]),
    "BoxBOD": lambda b, x: b[0] * (1 - exp(-b[1] * x)),
    "Chwirut1": chwirut,
    "Chwirut2": chwirut,
    "DanWood": lambda b, x: b[0] * x ** b[1],
    "ENSO": enso,
    "Eckerle4": lambda b, x: b[0] / b[1] * exp(-0.5 * ((x - b[2]) / b[1]) ** 2),
    "Gauss1": gauss,
    "Gauss2": gauss,
    "Gauss3": gauss,
    "Hahn1": ratio(4),
    "Kirby2": ratio(3),
    "Lanczos1": lanczos,
    "Lanczos2": lanczos,
    "Lanczos3": lanczos,
    "MGH09": lambda b, x: b[0] * (x**2 + x * b[1]) / (x**2 + x * b[2] + b[3]),
    "MGH10": lambda b, x: b[0] * exp(b[1] / (x + b[2])),
    "MGH17": lambda b, x: b[0] + b[1] * exp(-x * b[3]) + b[2] * exp(-x * b[4]),
    "Misra1a": lambda b, x: b[0] * (1 - exp(-b[1] * x)),
    "Misra1b": lambda b, x: b[0] * (1 - (1 + b[1] * x / 2) ** -2.0),
    "Misra1c": lambda b, x: b[0] * (1 - (1 + 2 * b[1] * x) ** -0.5),
    "Misra1d": lambda b, x: b[0] * b[1] * x / (1 + b[1] * x),
    "Rat42": lambda b, x: b[0] / (1 + exp(b[1] - b[2] * x)),
    "Rat43": lambda b, x: b[0] / (1 + exp(b[1] - b[2] * x)) ** (1 / b[3]),
    "Roszman1": lambda b, x: b[0] - b[1] * x - np.arctan(b[2] / (x - b[3])) / pi,
    "Thurber": ratio(4),
}


def certified(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return rows (start 1, start 2, value, standard deviation) and data rows (y, x)."""
    text = (FOLDER / f"{name}.dat").read_text(encoding="ascii")
    rows = re.findall(r"^\s*b\d+ =(.*)$", text, re.MULTILINE)
    data = text[re.search(r"^Data: +y +x", text, re.MULTILINE).end() :]
    return np.array([row.split() for row in rows], float), np.array(data.split(), float).reshape(-1, 2)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # trial steps overflow on the way
@pytest.mark.parametrize("start", [1, 2])
@pytest.mark.parametrize("name", MODELS)
def test_certified_values(name: str, start: int) -> None:
    parameters, (y, x) = certified(name)[0], certified(name)[1].T
    values, stds = parameters[:, 2], parameters[:, 3]
    names = [f"b{k + 1}" for k in range(values.size)]

    def residuals(b):
        return MODELS[name](b, x) - y

    if (name, start) == ("BoxBOD", 1):
        # The first step leaps to where the model is flat: no result, rather than a wrong one.
        with pytest.raises(FitError, match="do not depend on b2"):
            fit_least_squares(residuals, parameters[:, 0], names)
        return
    fit = fit_least_squares(residuals, parameters[:, start - 1], names)
    # Data made without noise (1e-13 of the size): what is left of it is rounding, and so are its deviations.
    digits = 1e-6 if name != "Lanczos1" else 1e-5
    assert_allclose(fit.values, values, rtol=digits)
    if name != "Lanczos1":
        assert_allclose(np.sqrt(np.diag(fit.covariance)), stds, rtol=1e-6)
