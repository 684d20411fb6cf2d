"""Constants that were fitted can be fitted again: benchmarks/derive."""

import dataclasses
import importlib
import pkgutil

import numpy as np
import pytest
from benchmarks.derive import laws
from benchmarks.derive.fit import Compared, Problem, fit, meanings, names

import fingerpad
from fingerpad.image.coin import CoinEdge


def calibrated():
    """Return the dataclasses of every module of the library that is called calibration, and of coins."""
    for each in pkgutil.walk_packages(fingerpad.__path__, "fingerpad."):
        if each.name.endswith(".calibration"):
            found = vars(importlib.import_module(each.name)).values()
            yield from (one for one in found if isinstance(one, type) and dataclasses.is_dataclass(one))
    yield CoinEdge


def problems():
    for name in names():
        yield from getattr(importlib.import_module(f"benchmarks.derive.{name}"), "PROBLEMS", ())


def test_every_class_of_fitted_numbers_is_fitted_again():
    modules = [importlib.import_module(f"benchmarks.derive.{name}") for name in names()]
    models = [one.MODEL for one in modules if hasattr(one, "MODEL")]
    models += [problem.model for problem in problems()]
    assert {one.__name__ for one in calibrated()} == {type(model).__name__ for model in models}


@pytest.mark.parametrize("problem", list(problems()), ids=lambda problem: type(problem.model).__name__)
def test_every_field_is_fitted_or_explained(problem):
    fields = [each.name for each in dataclasses.fields(problem.model)]
    assert sorted([*problem.places, *problem.tuned, *problem.stds, *problem.kept]) == sorted(fields)


@dataclasses.dataclass(frozen=True)
class Line:
    slope: float = 1.0  # a unit; slope
    std: float = 1.0  # units; scatter


def test_known_numbers_are_found_within_their_errors():
    def sample(count, seed):
        rng = np.random.default_rng(seed)
        x = rng.uniform(0, 1, count)
        return list(zip(x, 2 * x + rng.normal(0, 0.1, count), strict=True))

    def compare(model, points):
        x, y = np.transpose(points)
        return Compared(model.slope * x - y, np.full(len(x), model.std))

    problem = Problem(model=Line(), of="y", places=("slope",), stds=("std",), sample=sample, compare=compare)
    found = fit(problem, sample(300, 1))
    assert found.model.slope == pytest.approx(2, abs=3 * found.error["slope"])
    assert found.error["slope"] == pytest.approx(0.1 / np.sqrt(300 / 3), rel=0.3)
    assert found.model.std == pytest.approx(0.1, abs=0.012)
    free = fit(dataclasses.replace(problem, places=(), tuned=("slope", "std"), stds=()), sample(300, 1))
    assert free.model.slope == pytest.approx(2, abs=3 * free.error["slope"])
    assert free.model.std == pytest.approx(0.1, abs=0.012)
    assert free.error["slope"] == pytest.approx(0.1 / np.sqrt(300 / 3), rel=0.3)
    assert meanings(Line()) == {"slope": "a unit; slope", "std": "units; scatter"}


@pytest.mark.nightly
def test_solved_contacts_give_the_coefficients_of_the_fast_laws_again(capsys):
    used, found = laws.coefficients(), laws.fitted()
    assert capsys.readouterr().out  # what the known series leave
    for name, value in used.items():
        assert found[name] == pytest.approx(value, abs=1e-6 * np.abs(value).max()), name
