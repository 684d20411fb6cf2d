"""Broadcasting and domain checks of arrays."""

import math
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad.exceptions import FingerpadError, GeometryError

FloatArray: TypeAlias = npt.NDArray[np.float64]
Float32Array: TypeAlias = npt.NDArray[np.float32]
BoolArray: TypeAlias = npt.NDArray[np.bool_]
IndexArray: TypeAlias = npt.NDArray[np.intp]
ArrayLike: TypeAlias = npt.ArrayLike


def as_float_array(
    value: ArrayLike, name: str | None = None, error: type[FingerpadError] = GeometryError
) -> FloatArray:
    """Return `value` as an array of doubles, integers included.

    Complex numbers stay complex: the kernels carry the complex steps by which derivatives are taken.
    Masked entries become NaN, so that kernels give NaN for them and checks refuse them. With a name, what
    holds no numbers is refused by `error`, text such as "7.9" included.
    """
    if isinstance(value, np.ma.MaskedArray):
        value = np.ma.filled(value.astype(np.result_type(value, np.float64)), np.nan)
    try:
        array = np.asarray(value)
        if np.iscomplexobj(array):
            return array
        strict = name is not None and array.dtype != object
        return array.astype(np.float64, copy=False, casting="same_kind" if strict else "unsafe")
    except (TypeError, ValueError, OverflowError) as fault:
        if name is None:
            raise
        raise error(f"{name} must be numeric, found {value!r:.100}") from fault


def real_array(value: ArrayLike | None, name: str, error: type[FingerpadError]) -> FloatArray:
    """Return real numbers as an array of doubles, None as NaN, and refuse anything else by `error`."""
    array = as_float_array(np.nan if value is None else value, name, error)
    if np.iscomplexobj(array):
        raise error(f"{name} must be real numbers, found {value!r:.100}")
    return array


def real_number(value: ArrayLike, name: str, error: type[FingerpadError]) -> float:
    """Return one real number, NaN included, and refuse anything else by `error`."""
    if isinstance(value, float):  # the usual case, at no cost
        return float(value)
    array = real_array(value, name, error)
    if array.ndim:
        raise error(f"{name} must be one number, found shape {array.shape}")
    return float(array)


def finite_number(value: ArrayLike, name: str, error: type[FingerpadError]) -> float:
    """Return one finite number, and refuse anything else by `error`."""
    number = real_number(value, name, error)
    if not math.isfinite(number):
        raise error(f"{name} must be finite, found {number:g}")
    return number


def positive_number(value: ArrayLike, name: str, error: type[FingerpadError]) -> float:
    """Return one positive and finite number, and refuse anything else by `error`."""
    number = real_number(value, name, error)
    if not 0 < number < math.inf:
        raise error(f"{name} must be positive and finite, found {number:g}")
    return number


def non_negative_number(value: ArrayLike, name: str, error: type[FingerpadError]) -> float:
    """Return one finite number that is not negative, as a standard uncertainty, or refuse it by `error`."""
    number = real_number(value, name, error)
    if not 0 <= number < math.inf:
        raise error(f"{name} must be zero or positive, and finite, found {number:g}")
    return number


def finite_pair(value: ArrayLike, name: str, error: type[FingerpadError]) -> tuple[float, float]:
    """Return two finite numbers, as a place or two lengths, and refuse anything else by `error`."""
    pair = real_array(value, name, error)
    if pair.shape != (2,) or not np.isfinite(pair).all():
        raise error(f"{name} must be two finite numbers, found {value!r:.100}")
    return float(pair[0]), float(pair[1])


def as_float32(value: ArrayLike) -> Float32Array:
    """Return `value` as an array of single precision, which pictures are worked in."""
    return np.asarray(value, dtype=np.float32)


def hypotenuse(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return √(a² + b²), as `np.hypot` does for doubles, with its derivative for complex steps."""
    if np.iscomplexobj(first) or np.iscomplexobj(second):
        return np.sqrt(first * first + second * second)
    return np.hypot(first, second)


def broadcast(*values: ArrayLike) -> tuple[FloatArray, ...]:
    """Return `values` as arrays of doubles of one common shape."""
    return tuple(np.broadcast_arrays(*(as_float_array(value) for value in values)))


def broadcast_named(**values: ArrayLike) -> tuple[FloatArray, ...]:
    """Return `broadcast` of arguments, and refuse by their names what are no numbers or do not broadcast."""
    arrays = [as_float_array(value, name) for name, value in values.items()]
    check_shapes(**{name: array.shape for name, array in zip(values, arrays, strict=True)})
    return tuple(np.broadcast_arrays(*arrays))


def check_shapes(**shapes: tuple[int, ...]) -> None:
    """Refuse by their names arguments of shapes that do not broadcast."""
    try:
        np.broadcast_shapes(*shapes.values())
    except ValueError as fault:
        found = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise GeometryError(f"shapes must broadcast, found {found}") from fault


def check_all(
    good: npt.NDArray[np.bool_] | np.bool_ | bool,
    name: str,
    value: ArrayLike,
    expected: str,
    error: type[FingerpadError],
) -> None:
    """Raise `error` with the first offending element of `value` unless `good` holds everywhere."""
    good = np.asarray(good)
    if good.all():
        return
    first = np.argwhere(~good)[0]
    values = np.broadcast_to(as_float_array(value), good.shape)
    place = f" at index {', '.join(map(str, first))}" if first.size else ""
    raise error(f"{name} must be {expected}, found {values[tuple(first)]:g}{place}")


def check_positive(name: str, value: FloatArray, error: type[FingerpadError]) -> None:
    """Raise `error` unless all are positive and finite."""
    # Two reductions take a fraction of the time of the comparisons, which find the first offender.
    if not value.size or (value.min() > 0 and value.max() < math.inf):
        return
    check_all((value > 0) & np.isfinite(value), name, value, "positive and finite", error)


IN_RADIANS = "angles are in radians; for degrees use np.radians(30)"


def check_radians(name: str, angle: ArrayLike) -> FloatArray:
    """Return `angle` as an array, and refuse what lies beyond a full turn, as degrees do. NaN passes."""
    values = as_float_array(angle, name)
    expected = f"a number of radians between -2π and 2π ({IN_RADIANS})"
    check_all(~(np.abs(values.real) > 2 * np.pi), name, values.real, expected, GeometryError)
    return values


def finite_angle(name: str, angle: ArrayLike) -> float:
    """Return one angle, and refuse what `check_radians` refuses and what is not finite."""
    value = finite_number(angle, name, GeometryError)
    if abs(value) > 2 * math.pi:
        check_radians(name, value)
    return value


def set_fields(frozen: object, **values: object) -> None:
    """Set the fields of a frozen dataclass from its own ``__init__``.

    Arrays are copied, and cannot be written to; those without axes become numbers.
    """
    for name, value in values.items():
        if isinstance(value, np.ndarray):
            value = np.array(value)[()]  # noqa: PLW2901
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
        object.__setattr__(frozen, name, value)


# Small enough that a kernel's temporaries stay in cache, large enough to hide the cost of each call.
_BLOCK = 16_000


def apply_blockwise(
    kernel: Callable[..., tuple[FloatArray, ...]], outputs: int, *values: ArrayLike
) -> tuple[FloatArray, ...]:
    """Apply an elementwise kernel to `values` block by block, silently.

    It is given one-dimensional arrays, and returns so many `outputs` of their length.
    A kernel of many steps over a large array is limited by memory; over blocks that fit the cache it is
    limited by arithmetic, and runs three to five times faster.
    """
    arrays = broadcast(*values)
    shape = arrays[0].shape
    flat = [array.reshape(-1) for array in arrays]
    kind = np.result_type(*flat)
    results = np.empty((outputs, flat[0].size), dtype=kind)
    with np.errstate(all="ignore"):
        for start in range(0, flat[0].size, _BLOCK):
            block = slice(start, start + _BLOCK)
            for result, part in zip(results, kernel(*(array[block] for array in flat)), strict=True):
                result[block] = part
    return tuple(result.reshape(shape)[()] for result in results)


def robust_std(off: npt.NDArray[np.floating]) -> float:
    """Return the standard deviation of normal values about zero, by the median of their sizes."""
    return 1.4826 * float(np.median(np.abs(off)))
