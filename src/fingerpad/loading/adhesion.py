r"""Adhesion: the law of Johnson, Kendall and Roberts, and the way out of a record, up to the pull-off.

With the contact's radius a, the reduced modulus E* and the work of adhesion w (Johnson et al. 1971)

.. math::

    W = \frac{4 E^* a^3}{3R} - \sqrt{8 \pi w E^* a^3}, \qquad
    \xi = \frac{a^2}{R} - \sqrt{\frac{2\pi w a}{E^*}}.

The contact is lost where dξ/da = 0, at :math:`a_f^3 = \pi w R^2/(8E^*)`. With :math:`a = a_f t^2`,
:math:`\xi = a_f^2 (t^4 - 4t)/R` and :math:`W = \pi w R (t^6/6 - t^3)`. The stable branch is t ≥ 1, and there
:math:`t^4 - 4t + 3 = u^2 (u^2 + 4u + 6)` with u = t − 1, whose root grows with u without a turning point.
"""

from collections.abc import Mapping
from typing import Any, Final, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array
from fingerpad.estimate import Estimate
from fingerpad.exceptions import FitError
from fingerpad.loading.curve import LoadingCurve
from fingerpad.loading.cycles import choose_cycle, moving_average, saturated_rows
from fingerpad.loading.joint import FitData
from fingerpad.loading.laws import contact_law
from fingerpad.loading.press import Press

IntArray: TypeAlias = npt.NDArray[np.intp]

# Range of the forces of adhesion, mm, for Tabor's parameter: the distance of atoms in contact.
RANGE_OF_ADHESION: Final = 0.3e-6
# Tabor's parameter above which the theory of JKR holds, and below which that of DMT does.
JKR_ABOVE, DMT_BELOW = 5.0, 0.1
_NEWTON: Final = 8
# No work of adhesion at all is as good as this share of E* R.
_NONE: Final = 1e-30
# A pull-off is that many deviations of the noise deep, and ends where less than this share of it is left.
_DEVIATIONS, _TORN = 6.0, 0.35
_WINDOWS: Final = (1, 5, 15)
_FEWEST_FREE, _FEWEST_ATTACHED = 4, 8
NO_PULL_OFF: Final = (
    "no pull-off in the record: on the way out the force does not fall below its zero by more than its noise "
    "and come back to it; record the way out until the contact is lost, and some rows more"
)


def _scales(
    loading_radius: float, poisson_ratio: float, youngs_modulus: float, work_of_adhesion: float
) -> tuple[float, float]:
    """Return the work of adhesion, above zero, and the radius a_f at which contact is lost."""
    modulus = max(youngs_modulus, 1e-300) / (1 - poisson_ratio**2)
    work = max(work_of_adhesion, _NONE * modulus * loading_radius)
    return work, float((np.pi * work * loading_radius**2 / (8 * modulus)) ** (1 / 3))


def _root(indentation: ArrayLike, radius: float, lost: float) -> FloatArray:
    """Return t of the stable branch; NaN without contact."""
    xi = as_float_array(indentation)
    rest = xi * radius / lost**2 + 3
    wanted = np.sqrt(np.where(rest >= 0, rest, np.nan))
    u = wanted / np.sqrt(6 + wanted)
    for _ in range(_NEWTON):
        root = np.sqrt(u * u + 4 * u + 6)
        u = u - (u * root - wanted) / (root + u * (u + 2) / root)
    return np.asarray(1 + u)


def _area(
    indentation: ArrayLike,
    *,
    loading_radius: float,
    poisson_ratio: float,
    youngs_modulus: float,
    work_of_adhesion: float,
) -> Any:
    """Return π a², zero without contact."""
    _, lost = _scales(loading_radius, poisson_ratio, youngs_modulus, work_of_adhesion)
    t = _root(indentation, loading_radius, lost)
    return np.nan_to_num(np.pi * lost**2 * t**4)


def _pull_off(
    *, loading_radius: float, poisson_ratio: float, youngs_modulus: float, work_of_adhesion: float
) -> float:
    """Return the indentation −3 a_f²/R at which contact is lost."""
    _, lost = _scales(loading_radius, poisson_ratio, youngs_modulus, work_of_adhesion)
    return -3 * lost**2 / loading_radius


def _pull_off_load(*, loading_radius: float, youngs_modulus: float, work_of_adhesion: float) -> float:  # noqa: ARG001
    """Return the largest pull, 3/2 π w R."""
    return 1.5 * np.pi * work_of_adhesion * loading_radius


def tabor_parameter(
    *,
    loading_radius: float,
    youngs_modulus: float,
    work_of_adhesion: float,
    poisson_ratio: float = 0.5,
    range_of_adhesion: float = RANGE_OF_ADHESION,
) -> float:
    """Return Tabor's parameter μ = (R w²/(E*² z₀³))^(1/3) (Tabor 1977).

    Where it exceeds 5 the theory of Johnson, Kendall and Roberts holds, and below 0.1 that of Derjaguin,
    Muller and Toporov (Johnson and Greenwood 1997).

    Parameters
    ----------
    loading_radius, youngs_modulus, work_of_adhesion : float
        R (mm), E (MPa) and w (mJ/mm²).
    poisson_ratio : float
        ν.
    range_of_adhesion : float
        z₀, mm; 0.3 nm, the distance of atoms, without it.

    Returns
    -------
    float
        μ.

    Examples
    --------
    A soft pad of 10 mm, E = 40 kPa and w = 50 mJ/m²:

    >>> print(f"{tabor_parameter(loading_radius=10, youngs_modulus=0.04, work_of_adhesion=50e-6):.2g}")
    6.9e+04
    """
    modulus = youngs_modulus / (1 - poisson_ratio**2)
    return float((loading_radius * work_of_adhesion**2 / (modulus**2 * range_of_adhesion**3)) ** (1 / 3))


def _verdict(
    *, loading_radius: float, poisson_ratio: float, youngs_modulus: float, work_of_adhesion: float
) -> tuple[bool, str]:
    mu = tabor_parameter(
        loading_radius=loading_radius,
        youngs_modulus=youngs_modulus,
        work_of_adhesion=work_of_adhesion,
        poisson_ratio=poisson_ratio,
    )
    said = f"Tabor's parameter is {mu:.2g} with adhesion that reaches {1e6 * RANGE_OF_ADHESION:g} nm: "
    if mu > JKR_ABOVE:
        return True, f"{said}above {JKR_ABOVE:g}, so that JKR holds"
    if mu < DMT_BELOW:
        return (
            False,
            f"{said}below {DMT_BELOW:g}, where DMT holds and w is the pull-off over 2 π R, not 3/2 π R",
        )
    return (
        False,
        f"{said}between {DMT_BELOW:g} and {JKR_ABOVE:g}, where w lies between that of JKR and of DMT",
    )


@contact_law(
    parameters={"youngs_modulus": (0, None), "work_of_adhesion": (0, None)},
    units={
        "youngs_modulus": "MPa",
        "work_of_adhesion": "mJ/mm²",
        "pull_off_load": "N",
        "tabor_parameter": "",
    },
    label="JKR",
    area=_area,
    pull_off=_pull_off,
    derived={"pull_off_load": _pull_off_load, "tabor_parameter": tabor_parameter},
    verdict=_verdict,
)
def jkr(
    indentation: ArrayLike,
    *,
    loading_radius: float,
    poisson_ratio: float,
    youngs_modulus: float,
    work_of_adhesion: float,
) -> Any:
    """Return the load of an adhesive sphere, negative under tension; 0 where the contact is lost."""
    work, lost = _scales(loading_radius, poisson_ratio, youngs_modulus, work_of_adhesion)
    cube = _root(indentation, loading_radius, lost) ** 3
    return np.nan_to_num(np.pi * work * loading_radius * (cube**2 / 6 - cube))


def prepare_retraction(curve: LoadingCurve, poisson_ratio: float, cycle: int) -> Press:
    """Choose the rows on the way out, up to the pull-off, and those without contact before and after it.

    Raises
    ------
    FitError
        If the record has no way out, no pull-off, or ends before the contact is lost.
    """
    cycles, chosen = choose_cycle(curve, cycle)
    if chosen.unloading is None:
        raise FitError("the record has no way out, and adhesion is seen where the contact tears off")
    out = np.arange(chosen.unloading.start, chosen.unloading.stop)
    displacement = moving_average(curve.indentation[out])
    # Before contact no row is in touch that lies farther out than where the contact tore off.
    begin = chosen.baseline.start if chosen.baseline else chosen.loading.start
    before = np.arange(begin, chosen.loading.start)
    smooth_before = moving_average(curve.indentation[before]) if before.size else np.zeros(0)
    drift = _drift(curve.clock, curve.load, before, out)
    last, unsure = _last_attached(curve.load[out] - drift * curve.clock[out])
    free = smooth_before < displacement[last]
    # Of the two rows about the jump one may be half of it.
    kept = np.append(np.arange(last - unsure), np.arange(last + unsure + 2, out.size))
    full = saturated_rows(curve, chosen.unloading)
    kept = kept[~full[kept]]
    rows = np.concatenate([before[free], out[kept]])
    attached = np.concatenate([np.zeros(int(free.sum()), dtype=bool), kept < last])
    if np.count_nonzero(attached) < _FEWEST_ATTACHED:
        raise FitError(
            f"{np.count_nonzero(attached)} rows on the way out to the pull-off; {_FEWEST_ATTACHED} needed"
        )
    with_area: BoolArray = attached & (curve.area is not None)
    if curve.area is not None:
        with_area = attached & (curve.area[rows] > 0)
    record = FitData(
        clock=curve.clock[rows] - curve.clock[rows[0]],
        load=curve.load[rows],
        displacement=curve.indentation[rows],
        smooth_displacement=np.concatenate([smooth_before[free], displacement[kept]]),
        area=np.zeros(0) if curve.area is None else curve.area[rows][with_area],
        with_area=with_area,
        poisson_ratio=poisson_ratio,
        attached=attached,
    )
    return Press(
        record=record,
        cycles=cycles,
        baseline_rows=int(np.count_nonzero(~attached)),
        flags=(*(("saturated_force",) if full.any() else ()), *curve.doubts),
    )


def start_on_way_out(record: FitData, held: Mapping[str, Estimate]) -> dict[str, float]:
    """Return where a search of an adhesive law may begin, from the pull-off and where the force passes zero.

    With JKR the pull-off lies at −3 a_f²/R, and the zero of the force (t³ = 6) at 3.634 a_f²/R.
    """
    assert record.attached is not None  # of a way out
    x, load = record.smooth_displacement[record.attached], record.load[record.attached]
    zero = float(record.load[~record.attached].mean())
    pull = max(zero - float(load.min()), 1e-6 * float(np.ptp(load)))
    lost = float(x.min())
    pulled = x[load < zero]
    apart = max(float(pulled.max(initial=lost)) - lost, 0.02 * (float(x.max()) - lost))
    place = lost + 3 / 6.634 * apart
    depth = max(float(x.max()) - place, 1e-9)
    if "loading_radius" in held:
        radius = held["loading_radius"].value
    else:
        radius = float(record.area.max()) / (np.pi * (depth + 2 * apart))
    work = pull / (1.5 * np.pi * radius)
    modulus = np.pi * work * radius**2 / (8 * (apart * radius / 6.634) ** 1.5) * (1 - record.poisson_ratio**2)
    start = {
        "contact_offset": place,
        "loading_radius": radius,
        "youngs_modulus": float(modulus),
        "work_of_adhesion": work,
        "force_zero": zero,
        "force_tilt": 0.0,
    }
    return {name: value for name, value in start.items() if name not in held}


def _drift(clock: FloatArray, load: FloatArray, before: IntArray, out: IntArray) -> float:
    """Return the drift of the force from before contact to the end of the way out; 0 where it is unknown."""
    end = out[-max(out.size // 10, _FEWEST_FREE) :]
    if before.size < _FEWEST_FREE:
        return 0.0
    return float(np.mean(load[end]) - np.mean(load[before])) / float(
        np.mean(clock[end]) - np.mean(clock[before])
    )


def _last_attached(load: FloatArray) -> tuple[int, int]:
    """Return the last row on the way out that the force still pulls in, and how many rows it may be off.

    A pull that is weak beside the noise is looked for in means of a few rows.
    """
    for window in _WINDOWS:
        mean = np.convolve(load, np.full(window, 1 / window), mode="valid")
        lowest = int(np.argmin(mean)) + window // 2
        zero = float(np.median(load[lowest + (load.size - lowest) // 2 :]))
        depth = zero - float(mean.min())
        # The likeliest row at which a pull of two thirds of its depth gives way to none.
        last = lowest + int(np.argmax(np.cumsum(zero - _TORN * depth - load[lowest:])))
        after = mean[last + window :]
        enough = load.size - last >= _FEWEST_FREE + 2 and after.size >= _FEWEST_FREE
        if enough and depth > _DEVIATIONS * float(np.std(after, ddof=1)):
            return last, window // 2
    raise FitError(NO_PULL_OFF)
