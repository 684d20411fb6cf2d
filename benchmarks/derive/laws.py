"""Coefficients of the fast contact laws, from contacts that the solver solved.

``python -m benchmarks.contact_law_data`` solves them, ``python -m benchmarks.contact_laws`` writes the
coefficients. Here they are only compared, and their errors shown on pads and layers that took no part.
"""

from unittest.mock import patch

import numpy as np

from benchmarks import contact_law_errors, contact_laws
from benchmarks.contact_law_data import KEPT
from fingerpad._arrays import FloatArray
from fingerpad.contact import law_coefficients as law


def coefficients() -> dict[str, FloatArray]:
    """Return a copy of all coefficients that the laws use now, by name."""
    values = {name: getattr(law, name) for name in contact_laws._MEANINGS}
    return {
        name: np.concatenate([np.ravel(each) for each in value.values()])
        if isinstance(value, dict)
        else np.array(value).ravel()
        for name, value in values.items()
    }


def fitted() -> dict[str, FloatArray]:
    """Return all coefficients, fitted again; the laws keep theirs."""
    kept = np.load(KEPT)
    with patch.multiple(law, **{name: getattr(law, name) for name in contact_laws._MEANINGS}):
        contact_laws.fit_layer(contact_laws.elliptical(kept["elliptical"]))
        contact_laws.fit_pads(contact_laws.pads(kept["pads"]))
        contact_laws.fit_both(contact_laws.pads(kept["layered"]))
        contact_laws.fit_guesses()
        return coefficients()


def show(images: int, seed: int, other: int) -> None:  # noqa: ARG001 - the solved contacts are kept
    """Print how far the coefficients in the code are from those fitted, and the errors on other contacts."""
    used, now = coefficients(), fitted()
    print(f"    {'coefficients':<14} {'number':>6}   largest difference, of the largest")
    for name, value in used.items():
        print(f"    {name:<14} {value.size:>6}   {np.abs(now[name] - value).max() / np.abs(value).max():.1e}")
    contact_law_errors.report()
