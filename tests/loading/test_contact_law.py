"""Contact laws of a lab: registered, fitted, compared and drawn like ours."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from tests.loading.options import DEEP
from tests.studies import write_curve

import fingerpad as fp
from fingerpad.exceptions import LoadingError
from fingerpad.loading import ContactLaw, LoadingCurve, contact_law
from fingerpad.loading.law_registry import LAWS, find_law
from fingerpad.loading.laws import AppliedLaw, shape_factors
from fingerpad.simulate import simulate_loading_curve

pytestmark = pytest.mark.usefixtures("own_laws")
GIVEN = {"loading_radius": 15.0, "poisson_ratio": 0.5}
MODULUS = {"parameters": {"youngs_modulus": (0, None)}, "units": {"youngs_modulus": "MPa"}}


def stiffening() -> ContactLaw:
    """Return Hertz's law with a load that grows by (1 + c ξ)."""

    @contact_law(
        parameters={"youngs_modulus": (0, None), "stiffening": (-0.5, 20)},
        units={"youngs_modulus": "MPa", "stiffening": "1/mm"},
    )
    def stiffening(indentation, *, loading_radius, poisson_ratio, youngs_modulus, stiffening):
        modulus = youngs_modulus / (1 - poisson_ratio**2)
        hertz = 4 / 3 * modulus * np.sqrt(loading_radius) * indentation**1.5
        return hertz * (1 + stiffening * indentation)

    return stiffening


def record(
    law: ContactLaw, *, seed: int = 0, rows: int = 150, deepest: float = 2.0, **parameters: float
) -> LoadingCurve:
    rng = np.random.default_rng(seed)
    xi = np.linspace(-0.5, deepest, rows)
    load = law(np.maximum(xi, 0), **GIVEN, **parameters)
    return LoadingCurve(
        time=xi + 0.5,
        load=load + 0.03 + 0.004 * rng.standard_normal(rows),
        indentation=xi + 1.2 + 0.002 * rng.standard_normal(rows),
        area=15 * np.pi * np.maximum(xi, 0) + 0.5 * rng.standard_normal(rows),
    )


def test_own_law_is_fitted_and_preferred() -> None:
    earlier, law = stiffening(), stiffening()  # as of a cell that is run again
    assert LAWS["stiffening"] is law is not earlier
    truth = {"youngs_modulus": 0.04, "stiffening": 2.0}
    fit = fp.fit_loading_curve(record(law, **truth), law="stiffening")
    assert fit.law is not None
    for name, value in truth.items():
        found = fit.law.parameters[name]
        assert found.lower < value < found.upper
        assert abs(found.value - value) < 4 * found.std
        assert found.std < 0.1 * value
    assert fit.law.contact_offset.lower < 1.2 < fit.law.contact_offset.upper
    assert fit.law.loading_radius.lower < 15 < fit.law.loading_radius.upper
    # On the same rows, under the same noise, beside ours.
    assert fit.law.preferred_model == "stiffening"
    assert set(fit.law.models) == {"load_dependent", "hertz", "free_exponent", "stiffening"}
    assert_allclose(sum(fit.law.weights.values()), 1)
    assert "stiffening explains the loading better than" in fit.law.conclusion
    assert fit.law.flags == ()


def test_without_a_radius_nothing_but_the_place_is_known() -> None:
    law = stiffening()
    curve = record(law, youngs_modulus=0.04, stiffening=2.0)
    bare = LoadingCurve(load=curve.load, indentation=curve.indentation, time=curve.time)
    fit = fp.fit_loading_curve(bare, law=law)
    assert fit.law is not None
    assert "loading_radius" in fit.law.parameters["youngs_modulus"].reason
    assert fit.law.contact_offset.known


def test_layer_multiplies_an_own_law() -> None:
    stiffening()
    values = {"loading_radius": 15.0, "youngs_modulus": 0.04, "stiffening": 2.0}
    xi, on_bone = np.linspace(0, 2, 9), {**values, "inverse_thickness": 1 / 8}
    factor, _ = shape_factors("stiffening", on_bone, xi, 0.5)
    assert factor[-1] > 1.5
    layered, deep = (AppliedLaw(law="stiffening", values=at, poisson_ratio=0.5) for at in (on_bone, values))
    assert_allclose(layered.load_at(xi), factor * deep.load_at(xi), rtol=1e-12)


LOAD = "lambda x, *, youngs_modulus: youngs_modulus * "


@pytest.mark.parametrize(
    ("declared", "function", "said"),
    [
        ({}, LOAD + "max(x, 0)", "must work on arrays"),
        ({}, LOAD + "float(x.max())", "shape () as load of 6 indentations"),
        ({}, LOAD + "x / x.max()", "another load for one indentation"),
        ({}, LOAD + "np.log(x)", "gives the load -inf at an indentation of 0 mm"),
        ({}, LOAD + "(1 + x)", "at no indentation, where it must be zero"),
        ({}, LOAD + "0 * x", "gives no load"),
        ({}, LOAD + "1j * x", "must work on arrays"),
        ({}, "lambda x: x", "does not take its parameter youngs_modulus"),
        ({}, "lambda x, *, youngs_modulus, alpha: x", "takes alpha, which is no parameter of it"),
        ({}, "lambda x, **given: x", "must name its arguments"),
        ({}, "lambda: 1", "must take the indentation as its first argument"),
        ({"name": "hertz"}, LOAD + "x", "the contact law hertz exists already"),
        ({"name": "my law"}, LOAD + "x", "needs a name"),
        ({"units": {}}, LOAD + "x", "states no unit of youngs_modulus"),
        ({"start": {"alpha": 2.0}}, LOAD + "x", "has no parameter alpha"),
        ({"start": {"youngs_modulus": -1}}, LOAD + "x", "not between its bounds"),
        ({"parameters": {}}, "lambda x: x", "has no parameters"),
        ({"parameters": {"youngs_modulus": (1, 0)}}, LOAD + "x", "must rise"),
        ({"parameters": {"youngs_modulus": 3}}, LOAD + "x", "must be two numbers"),
        ({"parameters": {"force_zero": (0, 1)}}, "lambda x, *, force_zero: x", "cannot have a parameter"),
        (
            {"parameters": {"alpha": (0, None)}, "units": {"alpha": ""}},
            "lambda x, *, alpha: alpha * x",
            "does not say where to begin with alpha",
        ),
    ],
)
def test_bad_registration(declared, function, said) -> None:
    made = eval(function)
    with pytest.raises(LoadingError, match=re.escape(said)) as fault:
        contact_law(**{**MODULUS, "name": "mine", **declared})(made)
    assert "mine" in str(fault.value) or "bounds of" in str(fault.value) or "name" in declared
    assert "mine" not in LAWS


def test_rubbish_in_the_search_is_a_reason() -> None:
    @contact_law(
        parameters={"youngs_modulus": (0, None), "power": (1, 3)},
        units={"youngs_modulus": "MPa", "power": ""},
    )
    def breaking(indentation, *, youngs_modulus, power):
        if not 1.7 < power < 1.75:
            raise ZeroDivisionError("no such power")
        return youngs_modulus * indentation**power

    curve = simulate_loading_curve(points=60, force_std=0.005, area_std=0.5, seed=1)
    fit = fp.fit_loading_curve(curve, law="breaking", **DEEP)
    assert fit.law is not None
    assert "law_not_fitted" in fit.flags
    reason = fit.law.parameters["power"].reason
    assert "the contact law breaking fails at" in reason
    assert "ZeroDivisionError: no such power" in reason
    assert fit.youngs_modulus.known
    assert fit.law.as_record()["parameters"][0]["value"] is None
    assert fit.law.conclusion.startswith("breaking was not fitted: ")

    @contact_law(**MODULUS)
    def nothing_deep(indentation, *, youngs_modulus):
        return np.where(indentation < 1.2, youngs_modulus * indentation, np.nan)

    fit = fp.fit_loading_curve(curve, law=nothing_deep, **DEEP)
    assert fit.law is not None
    assert not fit.law.parameters["youngs_modulus"].known


def test_parameter_at_its_bound_is_no_result() -> None:
    law = stiffening()
    curve = record(law, youngs_modulus=0.04, stiffening=-0.3)

    @contact_law(
        parameters={"youngs_modulus": (0, None), "growth": (0, 5)},
        units={"youngs_modulus": "MPa", "growth": "1/mm"},
    )
    def only_growing(indentation, *, loading_radius, youngs_modulus, growth):
        return youngs_modulus * np.sqrt(loading_radius) * indentation**1.5 * (1 + growth * indentation)

    fit = fp.fit_loading_curve(curve, law="only_growing", **DEEP).law
    assert fit is not None
    assert "lies at its bound 0" in fit.parameters["growth"].reason
    assert fit.flags == ("law_at_bound", "law_misfit")


def test_law_of_a_file(tmp_path) -> None:
    path = tmp_path / "laws.py"
    path.write_text(
        "import fingerpad as fp\n"
        "@fp.contact_law(parameters={'k': (0, 9)}, units={'k': 'N/mm'})\n"
        "def spring(xi, *, k):\n    return k * xi\n"
    )
    assert find_law(f"{path}:spring").name == "spring"
    assert find_law(f"{path}:spring") is LAWS["spring"]  # read again
    for law, said in (
        (f"{path}:none", "has no contact law 'none'"),
        (f"{tmp_path}/absent.py:law", "no file"),
        ("fingerpad.no_such_module:law", "cannot be imported: ModuleNotFoundError"),
        ("nothing", "known are hertz, load_dependent, exact_sphere, free_exponent, jkr"),
    ):
        with pytest.raises(LoadingError, match=re.escape(said)):
            find_law(law)
    path.write_text("1 / 0\n")
    with pytest.raises(LoadingError, match="cannot be imported: ZeroDivisionError"):
        find_law(f"{path}:spring")


def test_the_how_to_runs(tmp_path, monkeypatch, capsys) -> None:
    page = Path(__file__).parents[2] / "docs" / "how-to" / "fit-your-own-contact-law.md"
    (code,) = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    curve = simulate_loading_curve(points=60, force_std=0.005, area_std=0.5, load_coefficient=0.002, seed=1)
    write_curve(tmp_path / "press.csv", curve)
    monkeypatch.chdir(tmp_path)
    exec(compile(code, str(page), "exec"), {"__name__": "my_laws"})
    value, conclusion = capsys.readouterr().out.splitlines()[:2]
    assert "±" in value
    assert conclusion.startswith("ogden explains the loading")


OWN_FILE = """
import fingerpad as fp
from fingerpad.loading.law_registry import find_law

@fp.contact_law(parameters={"k": (0, None)}, units={"k": "N/mm"}, start={"k": 1.0}, name="own_line")
def line(indentation, *, k):
    return k * indentation

if __name__ == "__main__":
    print(find_law("own_line_law.py:line").name)
"""


def test_a_law_is_found_where_it_is_called_and_from_its_own_file(tmp_path: Path) -> None:
    """As by an installed command, which does not look in its working folder, and as a script of its own."""
    (tmp_path / "own_line_law.py").write_text(OWN_FILE, encoding="utf-8")
    find = "import sys; sys.path.remove(''); from fingerpad.loading.law_registry import find_law; "
    for asked in (["own_line_law.py"], ["-c", find + "print(find_law('own_line_law:line').name)"]):
        done = subprocess.run(
            [sys.executable, *asked], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert done.stdout == "own_line\n", done.stderr
