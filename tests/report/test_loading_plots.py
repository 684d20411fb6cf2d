"""Plots of a loading curve: what is drawn lies where the record is."""

import numpy as np
import pytest

from fingerpad.figures import plot_load_indentation
from fingerpad.loading import fit_loading_curve
from fingerpad.report import loading
from fingerpad.simulate import simulate_loading_curve


def test_every_force_model_is_drawn_from_the_zero_of_the_points(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = []

    def kept(axes, indentation, load, *, phase, fits, **options):
        drawn.append((indentation[phase == "loading"], load[phase == "loading"], fits))
        return plot_load_indentation(axes, indentation, load, phase=phase, fits=fits, **options)

    monkeypatch.setattr(loading.figures, "plot_load_indentation", kept)
    curve = simulate_loading_curve(points=200, force_std=0.004, area_std=0.5, seed=3)
    fit = fit_loading_curve(curve)
    next(loading.loading_plots("press", curve, fit, cycle=0))
    ((indentation, load, lines),) = drawn
    in_contact = indentation > 0.2
    off = {
        name: np.std(load[in_contact] - np.interp(indentation[in_contact], depth, line))
        for name, (depth, line) in lines.items()
    }
    # Where the modulus grows so much a power law and Hertz theory leave 0.02 and 0.08 N.
    assert off["modulus growing with load"] < 0.006
    assert off["free exponent"] < 0.03
    assert off["Hertz"] < 0.1
