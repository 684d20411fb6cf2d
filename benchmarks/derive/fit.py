"""What all refits share: least squares for places, likelihood for uncertainty, errors by resampling."""

import dataclasses
import inspect
import pkgutil
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares, minimize

from benchmarks.arrays import Array, Rng

_ROUNDS, _STEP, _RESAMPLED = 8, 0.1, 60
_CLIMBS, _SMALL_STEP = 30, 0.01
_LEAST_STD = 1e-6
_T_SCALE = 0.815  # of the Student t of 4 degrees of freedom nearest to a normal distribution of std 1
_OUTLIER = 3.0  # robust standard deviations beyond which an error counts less


class Compared(NamedTuple):
    """Errors of a sample, and the standard deviations stated for them."""

    errors: Array
    stds: Array


@dataclass(frozen=True)
class Problem:
    """A calibrated model, and the images that its numbers are fitted to."""

    model: Any  # with the values in use
    of: str  # what the errors are, with their unit
    sample: Callable[[int, int], Sequence[Any]]  # of so many images of each condition, and a seed
    compare: Callable[[Any, Sequence[Any]], Compared]  # of a sample under a model
    places: tuple[str, ...] = ()  # fields that move the result, by least squares of the errors
    tuned: tuple[str, ...] = ()  # fields by likelihood, whatever they change
    stds: tuple[str, ...] = ()  # standard deviations of effects, which change only what is stated
    kept: Mapping[str, str] = field(default_factory=dict)  # why each other field is not fitted


@dataclass(frozen=True, kw_only=True)
class Fitted:
    """A model with its fields fitted, and the bootstrap error of each."""

    model: Any
    error: dict[str, float]


def names() -> list[str]:
    """Return the names of what can be fitted again."""
    modules = (each.name for each in pkgutil.iter_modules([str(Path(__file__).parent)]))
    return sorted(name for name in modules if name not in {"fit", "solved_contacts", "__main__"})


def meanings(model: Any) -> dict[str, str]:
    """Return the comment behind each field of a model: its unit and meaning."""
    return dict(re.findall(r"^    (\w+): .*?  # (.*)$", inspect.getsource(type(model)), re.MULTILINE))


def fit(problem: Problem, sample: Sequence[Any], seed: int = 0) -> Fitted:
    """Fit the fields of a model to a sample; resample its images for the errors of the values."""
    model, error = problem.model, dict[str, float]()
    rng = np.random.default_rng(seed)
    ways = (problem.places, _least_squares), (problem.tuned, _scoring), (problem.stds, _likelihood)
    for fields, method in ways:
        if fields:
            start = np.array([getattr(model, each) for each in fields], dtype=np.float64)
            values, spread = method(partial(_compared, problem, sample, model, fields), start, rng)
            model = changed(model, fields, values)
            error |= dict(zip(fields, spread.tolist(), strict=True))
    return Fitted(model=model, error=error)


def changed(model: Any, fields: tuple[str, ...], values: Array) -> Any:
    """Return a model with other values in some fields."""
    return replace(model, **dict(zip(fields, values.tolist(), strict=True)))


def _compared(
    problem: Problem, sample: Sequence[Any], model: Any, fields: tuple[str, ...], values: Array
) -> Compared:
    return problem.compare(changed(model, fields, values), sample)


def _least_squares(compared: Callable[[Array], Compared], start: Array, rng: Rng) -> tuple[Array, Array]:
    """Move values until the errors are least, outliers weighted down; return also the values' errors.

    Pixels are counted: steps of a tenth of a value show the slope, where tiny ones show none.
    """
    size, lowest = _scaled(start)

    def errors_of(at: Array) -> Array:
        return compared(start + (at - 1) * size).errors

    at = np.ones(len(start))
    spread = 1.4826 * float(np.median(np.abs(errors_of(at)))) + 1e-12
    at = least_squares(
        errors_of, at, bounds=(lowest, np.inf), diff_step=_STEP, loss="huber", f_scale=_OUTLIER * spread,
        ftol=1e-3, max_nfev=_ROUNDS,
    ).x  # fmt: skip
    errors = errors_of(at)
    slope = np.stack([errors_of(at + step) - errors for step in _STEP * np.eye(len(at))], axis=1) / _STEP
    weight = np.sqrt(np.minimum(1, _OUTLIER * spread / np.maximum(np.abs(errors), 1e-12)))
    slope, errors = slope * weight[:, None], errors * weight
    draws = rng.integers(len(errors), size=(_RESAMPLED, len(errors)))
    moved = [np.linalg.lstsq(slope[each], -errors[each], rcond=1e-6)[0] for each in draws]
    return start + (at - 1) * size, np.std(moved, axis=0) * size


def _scaled(start: Array) -> tuple[Array, Array]:
    """Return the unit of a change of each value, and how low each may go from 1 in these units."""
    size = np.maximum(np.abs(start), 0.05)
    return size, np.where(start > 0, 1 - start / size, -np.inf)


def _costs(errors: Array, variance: Array) -> Array:
    """Return the negative log-likelihood of each error.

    By Student's t of few degrees of freedom: single failures do not set the deviation of all.
    """
    variance = np.maximum(variance, _LEAST_STD**2)
    return np.log(variance) / 2 + 2.5 * np.log1p(errors**2 / variance / _T_SCALE**2 / 4)


def _scoring(compared: Callable[[Array], Compared], start: Array, _: Rng) -> tuple[Array, Array]:
    """Move values until the errors are likeliest; the scores of single errors give those of the values."""
    size, lowest = _scaled(start)

    def costs_at(at: Array) -> Array:
        errors, stds = compared(start + (at - 1) * size)
        return _costs(errors, stds**2)

    at = minimize(
        lambda at: costs_at(at).sum(), np.ones(len(start)), method="L-BFGS-B", jac="3-point",
        bounds=[(low, None) for low in lowest],
        options={"finite_diff_rel_step": _SMALL_STEP, "maxiter": _CLIMBS, "ftol": 1e-4},
    ).x  # fmt: skip
    slopes = [costs_at(at + step) - costs_at(at - step) for step in _SMALL_STEP * np.eye(len(at))]
    scores = np.stack(slopes, axis=1) / (2 * _SMALL_STEP)
    inverse = np.linalg.pinv(scores.T @ scores, rcond=1e-6, hermitian=True)
    return start + (at - 1) * size, np.sqrt(np.diagonal(inverse)) * size


def _likelihood(compared: Callable[[Array], Compared], start: Array, rng: Rng) -> tuple[Array, Array]:
    """Find the standard deviations, none below 0, under which the errors are likeliest.

    They are of independent effects: the variance stated is linear in the square of each.
    """
    (size, _), errors = _scaled(start), compared(start).errors
    rest, *alone = (compared(at).stds ** 2 for at in (np.zeros(len(start)), *np.diag(size)))
    effects = np.stack([each - rest for each in alone], axis=1)

    def found(chosen: Array) -> Array:
        def cost(at: Array) -> float:
            return float(np.sum(_costs(errors[chosen], (rest + effects @ at**2)[chosen])))

        best = minimize(cost, start / size, method="L-BFGS-B", bounds=[(0, 20)] * len(start))
        return best.x * size

    draws = rng.integers(len(errors), size=(_RESAMPLED, len(errors)))
    return found(np.arange(len(errors))), np.std([found(each) for each in draws], axis=0)


def show(problem: Problem, images: int, seed: int, other: int) -> Fitted:
    """Fit a problem and print the table of its fields, and how well both models do on other images."""
    fitted = fit(problem, problem.sample(images, seed))
    comments = meanings(problem.model)
    print(f"\n{type(problem.model).__name__}, {images} images of each condition of seed {seed}")
    print(f"    {'field':<20} {'in the code':>12} {'fitted':>18}   unit; meaning")
    for each in dataclasses.fields(problem.model):
        used, now = getattr(problem.model, each.name), getattr(fitted.model, each.name)
        text = f"kept: {problem.kept.get(each.name, 'no reason given')}"
        if each.name in fitted.error:
            error = fitted.error[each.name]
            text = "no effect seen" if now == used and error < 1e-9 else f"{now:.3g} ± {error:.2g}"
        print(f"    {each.name:<20} {used!s:>12} {text:>18}   {comments.get(each.name, '')}")
    sample = problem.sample(images, other)
    print(f"    on {len(sample)} images of seed {other}, {problem.of}:")
    for words, model in (("in the code", problem.model), ("fitted", fitted.model)):
        errors, stds = problem.compare(model, sample)
        held = np.abs(errors) < 1.96 * stds
        rms = np.sqrt(np.mean(errors**2))
        print(f"    {words:<12} mean {errors.mean():+.4f}, rms {rms:.4f},", end=" ")
        print(f"median size {np.median(np.abs(errors)):.4f}, 95 % intervals hold {held.mean():.0%}")
    return fitted
