"""Named quantities with their joint covariance: the inputs of a model, and its outputs."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, Self, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import (
    ArrayLike,
    BoolArray,
    FloatArray,
    as_float_array,
    check_all,
    check_radians,
    check_shapes,
    set_fields,
)
from fingerpad._display import Displayed, titled_lines
from fingerpad.estimate import Estimate
from fingerpad.exceptions import UncertaintyError

# Named arrays to named arrays, elementwise.
Model: TypeAlias = Callable[..., Mapping[str, FloatArray]]

# An exact number, or a value and its standard uncertainty; arrays only in such tuples.
Given: TypeAlias = float | tuple[ArrayLike, ArrayLike] | Estimate

Groups: TypeAlias = Mapping[str, tuple[str, ...]]

# Rounding may leave the smallest eigenvalue of a correlation matrix below zero by this much.
_ROUNDING: Final = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Inputs(Displayed):
    """Best estimates of the named inputs of a model, with their joint covariance.

    Leading axes are sets of inputs, as those of several contacts.

    Attributes
    ----------
    names : tuple of str
        Names of the n inputs, which are the model's keyword arguments.
    mean : ndarray, shape (..., n)
        Best estimates.
    covariance : ndarray, shape (..., n, n)
        Their covariance.
    groups : mapping
        From the name of a source of uncertainty to the names of its inputs, for budgets.

    Raises
    ------
    UncertaintyError
        If a name stands twice, the shapes do not fit the names, or a group has an input that there is not.

    Examples
    --------
    >>> axes = Inputs.of(semi_major=(7.4, 0.1), semi_minor=(5.0, 0.2))
    >>> axes.names, axes.mean, axes.std
    (('semi_major', 'semi_minor'), array([7.4, 5. ]), array([0.1, 0.2]))
    """

    names: tuple[str, ...]
    mean: FloatArray
    covariance: FloatArray
    groups: Groups

    def __post_init__(self) -> None:
        set_fields(self, mean=as_float_array(self.mean), covariance=as_float_array(self.covariance))
        count = len(self.names)
        if len(set(self.names)) < count:
            raise UncertaintyError(f"each input must have a name of its own, found {', '.join(self.names)}")
        if np.shape(self.mean)[-1:] != (count,) or np.shape(self.covariance)[-2:] != (count, count):
            raise UncertaintyError(
                f"{count} inputs need a mean of shape (..., {count}) and a covariance of shape "
                f"(..., {count}, {count}), found {np.shape(self.mean)} and {np.shape(self.covariance)}"
            )
        self.places(name for names in self.groups.values() for name in names)

    @classmethod
    def of(
        cls, *, correlations: Mapping[tuple[str, str], ArrayLike] | None = None, **quantities: Given
    ) -> Self:
        """Return inputs from values that broadcast; each input is a separate source.

        Parameters
        ----------
        correlations : mapping, optional
            From pairs of names to correlation coefficients; other pairs are uncorrelated.
        **quantities : float, Estimate, or tuple of array_like
            An exact number, an `Estimate`, or a tuple of a value and its standard uncertainty, either of
            which may be an array. Arrays and lists are refused, since they could be several values, or a
            value and its uncertainty.

        Returns
        -------
        Inputs

        Raises
        ------
        UncertaintyError
            If a quantity is an array, a list, no number or an unknown `Estimate`, a standard uncertainty is
            negative or not finite, a correlation lies outside [−1, 1], is not that of two of the inputs or is
            given twice, or nothing is given.
        GeometryError
            If the shapes do not broadcast.

        Examples
        --------
        >>> axes = Inputs.of(
        ...     semi_major=(7.4, 0.1), semi_minor=(5.0, 0.2), correlations={("semi_major", "semi_minor"): 0.5}
        ... )
        >>> axes.covariance
        array([[0.01, 0.01],
               [0.01, 0.04]])
        """
        if not quantities:
            raise UncertaintyError("no inputs: give each by name, as load=(2, 0.02)")
        pairs = [_value_and_std(name, quantity) for name, quantity in quantities.items()]
        shapes = {name: np.broadcast(*pair).shape for name, pair in zip(quantities, pairs, strict=True)}
        check_shapes(**{name: shape for name, shape in shapes.items() if shape})
        arrays = np.broadcast_arrays(*(array for pair in pairs for array in pair))
        mean, std = np.stack(arrays[::2], axis=-1), np.stack(arrays[1::2], axis=-1)
        names = tuple(quantities)
        covariance = std[..., :, None] ** 2 * np.eye(len(names))
        uncorrelated = cls(
            names=names, mean=mean, covariance=covariance, groups={name: (name,) for name in names}
        )
        for pair in correlations or {}:
            value = _correlation(pair, correlations or {})
            one, other = uncorrelated.places(pair)
            product = value * std[..., one] * std[..., other]
            covariance[..., [one, other], [other, one]] = product[..., None]
        return replace(uncorrelated, covariance=covariance)

    @property
    def std(self) -> FloatArray:
        """Standard uncertainty of each input, shape (..., n)."""
        return np.sqrt(np.diagonal(self.covariance, axis1=-2, axis2=-1))

    def places(self, names: Iterable[str]) -> list[int]:
        """Return the places of some inputs along the last axis.

        Parameters
        ----------
        names : iterable of str
            Their names.

        Returns
        -------
        list of int

        Raises
        ------
        UncertaintyError
            If there is no input of that name.

        Examples
        --------
        >>> Inputs.of(load=2.0, semi_major=7.4).places(["semi_major"])
        [1]
        """
        wanted = list(names)
        for name in wanted:
            if name not in self.names:
                raise UncertaintyError(f"no input {name!r}; there are {', '.join(self.names)}")
        return [self.names.index(name) for name in wanted]

    def at(self, index: int | slice | BoolArray | npt.NDArray[np.intp]) -> Self:
        """Return some of several sets of inputs.

        Parameters
        ----------
        index : int, slice or ndarray
            Into the first axis.

        Returns
        -------
        Inputs
            A copy, which keeps none of the others alive.

        Examples
        --------
        >>> Inputs.of(load=([1.0, 2.0], 0.02)).at(1).mean
        array([2.])
        """
        return replace(self, mean=self.mean[index].copy(), covariance=self.covariance[index].copy())

    def with_covariance(self, names: Iterable[str], covariance: ArrayLike) -> Self:
        """Return the inputs with the covariance of some of them replaced.

        Parameters
        ----------
        names : iterable of str
            Names of k inputs.
        covariance : array_like, shape (..., k, k)
            Their covariance, in the order of `names`.

        Returns
        -------
        Inputs

        Raises
        ------
        UncertaintyError
            If there is no input of that name, or `covariance` is not k × k.

        Examples
        --------
        >>> axes = Inputs.of(semi_major=7.4, semi_minor=5.0)
        >>> axes.with_covariance(["semi_major", "semi_minor"], [[0.04, 0.01], [0.01, 0.09]]).std
        array([0.2, 0.3])
        """
        places, block = self.places(names), as_float_array(covariance)
        if block.shape[-2:] != (len(places), len(places)):
            raise UncertaintyError(
                f"the covariance of {len(places)} inputs must be square, found the shape {block.shape}"
            )
        whole = self.covariance.copy()
        whole[..., np.array(places)[:, None], places] = block
        return replace(self, covariance=whole)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Outputs(Displayed):
    """Named outputs of a model (..., m) with their joint covariance; ``outputs[name]`` is one `Estimate`.

    `interval` (..., m, 2) are the ends of the 95 % interval of each.
    """

    names: tuple[str, ...]
    value: FloatArray
    covariance: FloatArray
    interval: FloatArray

    def summary(self) -> str:
        """Return each output with its standard uncertainty, one line each."""
        return titled_lines(type(self).__name__, {name: str(self[name]) for name in self.names})

    def __str__(self) -> str:
        return self.summary()

    @property
    def std(self) -> FloatArray:
        """Standard uncertainty of each output, shape (..., m)."""
        return np.sqrt(np.diagonal(self.covariance, axis1=-2, axis2=-1))

    def place(self, name: str) -> int:
        """Return the index of an output along the last axis."""
        if name not in self.names:
            raise UncertaintyError(f"no output {name!r}; there are {', '.join(self.names)}")
        return self.names.index(name)

    def __getitem__(self, name: str) -> Estimate:
        place = self.place(name)
        ends = np.moveaxis(self.interval[..., place, :], -1, 0)
        columns: tuple[Any, ...] = (self.value[..., place], self.std[..., place], *ends)
        value, std, lower, upper = columns if self.value.ndim > 1 else map(float, columns)
        if self.value.ndim == 1 and np.isnan(value):
            return Estimate.unknown("the model has no finite value for these inputs")
        return Estimate(value=value, std=std, interval=(lower, upper))


def covariance_of(value: ArrayLike) -> FloatArray:
    """Return `value` as covariance matrices (..., n, n), validated."""
    covariance = as_float_array(value)
    if covariance.ndim < 2 or covariance.shape[-1] != covariance.shape[-2]:
        raise UncertaintyError(f"a covariance must be square, found the shape {covariance.shape}")
    variance = np.diagonal(covariance, axis1=-2, axis2=-1)
    check_all(np.isfinite(covariance), "covariance", covariance, "finite", UncertaintyError)
    check_all(variance >= 0, "variance", variance, "positive or zero", UncertaintyError)
    std = np.sqrt(variance)
    scale = std[..., :, None] * std[..., None, :]
    other = np.swapaxes(covariance, -1, -2)
    symmetric = np.abs(covariance - other) <= _ROUNDING * (scale + np.abs(covariance))
    check_all(symmetric, "covariance", covariance, "symmetric", UncertaintyError)
    correlation = np.divide(covariance, scale, out=np.where(covariance == 0, 0.0, np.inf), where=scale > 0)
    check_all(
        np.abs(correlation) <= 1 + _ROUNDING, "correlation", correlation, "within [-1, 1]", UncertaintyError
    )
    smallest = np.linalg.eigvalsh(correlation)[..., :1]
    check_all(
        smallest >= -_ROUNDING * covariance.shape[-1],
        "smallest eigenvalue of the correlations",
        smallest,
        "positive or zero (a covariance is positive semidefinite)",
        UncertaintyError,
    )
    return covariance


def covariance_root(covariance: FloatArray) -> FloatArray:
    """Return F with F Fᵀ = `covariance` (..., n, n), which may be singular; NaN where a matrix is not finite.

    In units of the standard deviations F is the symmetric root, which does not depend on the order of the
    inputs. Negative eigenvalues are taken to be zero, as those that rounding leaves.
    """
    finite = np.isfinite(covariance).all(axis=(-2, -1), keepdims=True)
    clean = np.where(finite, covariance, 0.0)
    variance = np.diagonal(clean, axis1=-2, axis2=-1)
    unit = np.sqrt(np.where(variance > 0, variance, 1.0))
    size, direction = np.linalg.eigh(clean / (unit[..., :, None] * unit[..., None, :]))
    root = direction * np.sqrt(np.maximum(size, 0))[..., None, :] @ np.swapaxes(direction, -1, -2)
    return np.where(finite, unit[..., :, None] * root, np.nan)


def evaluate(model: Model, names: tuple[str, ...], points: FloatArray) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names of a model's m outputs and their values (..., m) at points of shape (..., n).

    Complex points ask for derivatives, and outputs that lose them are refused.
    """
    outputs = model(**dict(zip(names, np.moveaxis(points, -1, 0), strict=True)))
    if not isinstance(outputs, Mapping):
        found = type(outputs).__name__
        raise UncertaintyError(f"the model must return a mapping from names to outputs, found {found}")
    real = [name for name, output in outputs.items() if not np.iscomplexobj(output)]
    if real and np.iscomplexobj(points):
        raise UncertaintyError(
            f"the model returns real numbers for complex steps in {', '.join(real)}: "
            "leave out abs, real and rounding, or propagate by Monte Carlo"
        )
    shape = points.shape[:-1]
    return tuple(outputs), np.stack([np.broadcast_to(each, shape) for each in outputs.values()], axis=-1)


def check_inputs(model: Model, inputs: Inputs) -> None:
    """Refuse inputs that a model does not take, and angles in degrees."""
    try:
        inspect.signature(model).bind(**dict.fromkeys(inputs.names))
    except ValueError:  # some compiled functions have no signature
        pass
    except TypeError as error:
        given = ", ".join(inputs.names)
        raise UncertaintyError(f"the model takes other inputs: {error}; given are {given}") from error
    for place, name in enumerate(inputs.names):
        if name.endswith("_angle"):
            check_radians(name, inputs.mean[..., place])


def _correlation(pair: Any, correlations: Mapping[tuple[str, str], ArrayLike]) -> FloatArray:
    """Return the correlation of two inputs, which may stand in both orders."""
    if isinstance(pair, str) or len(pair) != 2:
        raise UncertaintyError(f"a correlation is that of two inputs, as ('a', 'b'), found {pair!r}")
    first, second = pair
    if first == second:
        raise UncertaintyError(f"a correlation is that of two inputs, found {first} with itself")
    what = f"correlation of {first} and {second}"
    given = correlations[pair], correlations.get((second, first), correlations[pair])
    value, again = (as_float_array(each, what, UncertaintyError) for each in given)
    check_all(np.abs(value) <= 1, what, value, "within [-1, 1]", UncertaintyError)
    if not np.array_equal(value, again):
        raise UncertaintyError(f"{what} is given twice, found {value} and {again}")
    return value


def _value_and_std(name: str, quantity: Any) -> tuple[FloatArray, FloatArray]:
    """Return a quantity as its value and standard uncertainty, zero where it is exact."""
    if isinstance(quantity, Estimate):
        if not quantity.known:
            raise UncertaintyError(f"{name} is not known: {quantity.reason}")
        quantity = quantity.value, quantity.std
    pair = isinstance(quantity, tuple)
    if not pair and np.ndim(quantity) == 0:
        return as_float_array(quantity, name, UncertaintyError), np.zeros(())
    if not pair or len(quantity) != 2:
        kind = "list" if isinstance(quantity, list) else "tuple" if pair else "array"
        raise UncertaintyError(
            f"{name}: give a number or a tuple (value, standard uncertainty), exact arrays as (values, 0); "
            f"found {'an' if kind == 'array' else 'a'} {kind} of {len(quantity)}"
        )
    what = f"standard uncertainty of {name}"
    value, std = (
        as_float_array(each, of, UncertaintyError) for each, of in zip(quantity, (name, what), strict=True)
    )
    check_all(~(std < 0), what, std, "positive or zero", UncertaintyError)
    check_all(np.isfinite(std), what, std, "finite", UncertaintyError)
    check_shapes(**{name: value.shape, what: std.shape})
    return value, std


def inputs_from_ufloats(**values: Any) -> Inputs:
    """Return inputs from numbers, some of which may be objects of `uncertainties`.

    Correlations between the objects are kept; a plain number is exact.

    Parameters
    ----------
    **values : float or uncertainties.UFloat
        One number each: `uncertainties.ufloat` and what was computed from them, or a plain number.

    Returns
    -------
    Inputs

    Examples
    --------
    >>> from uncertainties import ufloat
    >>> scale = ufloat(1.0, 0.01)
    >>> inputs = inputs_from_ufloats(semi_major=7.4 * scale, semi_minor=5.0 * scale, load=2.0)
    >>> print(inputs.mean, inputs.covariance[0, 1].round(6))
    [7.4 5.  2. ] 0.0037
    """
    from uncertainties import UFloat, covariance_matrix, nominal_value

    inputs = Inputs.of(**{name: nominal_value(value) for name, value in values.items()})
    uncertain = {name: value for name, value in values.items() if isinstance(value, UFloat)}
    if not uncertain:
        return inputs
    return inputs.with_covariance(uncertain, covariance_matrix(list(uncertain.values())))


def correlated_values(outputs: Outputs) -> dict[str, Any]:
    """Return outputs as objects of `uncertainties` that keep their correlations.

    Parameters
    ----------
    outputs : Propagated or MonteCarloResult
        From one set of inputs.

    Returns
    -------
    dict of str to uncertainties.UFloat

    Examples
    --------
    >>> from fingerpad.uncertainty import propagate
    >>> axes = Inputs.of(semi_major=(7.4, 0.1), semi_minor=(5.0, 0.1))
    >>> values = correlated_values(
    ...     propagate(lambda semi_major, semi_minor: {"a": semi_major, "b": semi_minor}, axes)
    ... )
    >>> print(f"{values['a'] / values['b']:.1u}")
    1.48+/-0.04
    """
    import uncertainties

    pairs = uncertainties.correlated_values(outputs.value, outputs.covariance)
    return dict(zip(outputs.names, pairs, strict=True))
