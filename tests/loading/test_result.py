"""What a fitted loading curve predicts, and what it says."""

import re
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.loading import LoadingFit, fit_loading_curve
from fingerpad.loading.laws import load_dependent
from fingerpad.simulate import simulate_loading_curve

PAD = {"loading_radius": 15.0, "initial_modulus": 0.04, "load_coefficient": 0.02}
DOUBTFUL = {"misfit", "area_offset", "correlated_area"}
NOISE = {"force_std": 0.005, "displacement_std": 0.005, "area_std": 1.0}


@cache
def fit_of(seed: int = 1, **options: object) -> LoadingFit:
    return fit_loading_curve(simulate_loading_curve(points=100, seed=seed, **PAD, **NOISE), **options)


def test_the_band_holds_the_true_load() -> None:
    fits = [fit for seed in (1, 2) if not DOUBTFUL & set((fit := fit_of(seed)).flags)]
    held = []
    for fit in fits:
        depth = np.linspace(0.02, 1, 40) * fit.indentation.max()
        band, truth = fit.predict(depth), load_dependent(depth, **PAD, poisson_ratio=0.5)
        held.append(np.mean((band.lower <= truth) & (truth <= band.upper)))
        assert np.median(band.std / band.value) < 0.05
    assert len(fits) == 2
    assert np.mean(held) >= 0.93


def test_the_prediction_is_the_law_and_zero_before_contact() -> None:
    fit = fit_of()
    depth = np.array([[-0.5, 0.0], [0.4, 1.1]])
    found = fit.predict(depth)
    assert found.value.shape == found.std.shape == found.lower.shape == (2, 2)
    main = fit.models["load_dependent"]
    assert_allclose(found.value, main.load(depth + main.values["contact_offset"]), atol=1e-12)
    assert (found.value[0] == 0).all()
    assert (found.std[0] < 1e-12).all()
    assert (found.lower[1] < found.value[1]).all()
    assert (found.value[1] < found.upper[1]).all()
    assert fit.predict(1.1).std == pytest.approx(found.std[1, 1])


def test_a_stage_that_yields_is_not_indented() -> None:
    fit = fit_of(stage_compliance=0.05, thickness=np.inf)
    assert_allclose(
        fit.rows.displacement - fit.contact_offset.value - fit.indentation,
        0.05 * fit.models["load_dependent"].load(fit.rows.displacement),
        atol=1e-4,
    )


def test_the_report_has_every_quantity_law_explanation_and_flag() -> None:
    fit = fit_of()
    text = fit.summary()
    for name in ("R_g", "E\\*", "E_0g", "β", "x₀", "m, W ∝ ξ\\^m", "n, A ∝ W\\^n"):
        assert re.search(f"  [^\n]*{name}[^\n]* [-\\d.]+ ± [\\d.]+[^\n]* to ", text), name
    weights = [float(found) for found in re.findall(r"(0\.\d{3})$", text, re.MULTILINE)]
    assert sum(weights) == pytest.approx(1, abs=0.005)
    assert text.count("ΔAICc") == 2
    answer = text.splitlines()[2]
    assert re.fullmatch(
        r"  E = [\d.]+ ± [\d.]+ kPa at [\d.]+ N, of a half-space, doubtful: modulus_.*", answer
    )
    assert "flag modulus_depends_on_load: a modulus that grows" in text
    assert text == fit.summary()


def test_the_answer_and_the_exponent_say_what_layer_was_stated() -> None:
    curve = simulate_loading_curve(points=100, seed=1, load_coefficient=0.0, **NOISE)
    thick, endless = (
        fit_loading_curve(curve, thickness=t, stage_compliance=0.0).summary() for t in (20.0, np.inf)
    )
    assert re.search(r"  E = [^\n]* N, on a layer of 20 mm", thick)
    assert "half-space" not in thick
    assert "W ∝ ξ^m × layer's factor" in thick
    assert re.search(r"  E = [^\n]* N, of a half-space\n", endless)
    assert "layer's factor" not in endless


def test_the_report_compares_explanations_with_the_criterion_that_weighs_them() -> None:
    fit = fit_loading_curve(simulate_loading_curve(points=100, seed=2, load_coefficient=0.0, **NOISE))
    hertz, text = fit.models["hertz"].aicc, fit.summary()
    assert hertz < fit.main.aicc - 1  # one modulus explains this curve
    above = fit.alternatives["area_offset"].aicc - hertz
    assert re.search(rf"areas with an offset[^\n]* \+{above:.1f} ", text)
