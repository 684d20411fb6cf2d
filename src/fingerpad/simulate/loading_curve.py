"""Loading curves simulated from a known truth."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.contact import Tissue, hertz_contact
from fingerpad.exceptions import LoadingError
from fingerpad.geometry import Paraboloid
from fingerpad.loading.curve import LoadingCurve

# Time steps in which relaxation is integrated over one record.
_RELAXATION_STEPS = 20_000


def simulate_loading_curve(
    *,
    loading_radius: float = 15.0,
    initial_modulus: float = 0.04,
    load_coefficient: float = 0.02,
    contact_offset: float = 1.0,
    poisson_ratio: float = 0.5,
    top_load: float = 2.0,
    rate: float = 2.0,
    approach: float = 0.6,
    hold: float = 0.0,
    unloading: bool = False,
    hysteresis: float = 0.3,
    cycles: int = 1,
    relaxation: Sequence[tuple[float, float]] = (),
    points: int = 500,
    force_std: float = 0.0,
    correlation_time: float = 0.0,
    displacement_std: float = 0.0,
    area_std: float = 0.0,
    force_offset: float = 0.0,
    force_tilt: float = 0.0,
    with_area: bool = True,
    seed: int = 0,
) -> LoadingCurve:
    """Simulate the record of a pad pressed by a platen that moves at a constant rate.

    The platen starts before contact, moves to where the load is `top_load`, may hold there and go back.
    The elastic load is that of a Hertz contact whose modulus is E_0g + β W, the area π R ξ.

    Parameters
    ----------
    loading_radius, initial_modulus, load_coefficient, poisson_ratio : float
        R_g (mm), E_0g (MPa), β (MPa/N) and ν of the pad.
    contact_offset : float
        Reading of the displacement at contact, mm.
    top_load : float
        Elastic load at the largest indentation, N.
    rate, approach, hold : float
        Speed of the platen (mm/s), distance before contact (mm), and time held at the top (s).
    unloading : bool
        Whether the platen goes back.
    hysteresis : float
        On the way back the load is less by this share times (1 − ξ/ξ_top).
    cycles : int
        Number of presses.
    relaxation : sequence of (share, time)
        Prony terms: of a load applied at once, each share decays with its time, s.
    points : int
        Samples in the record, evenly spaced in time.
    force_std, correlation_time : float
        Standard deviation (N) and correlation time (s) of the noise of the force, a first-order
        autoregression; white where the time is zero.
    displacement_std, area_std : float
        White noise, mm and mm². The area is never reported below zero.
    force_offset, force_tilt : float
        Error of the force's zero at the start (N), and its drift (N/s).
    with_area : bool
        Whether the record has an area.
    seed : int
        Of the noise.

    Returns
    -------
    LoadingCurve
        The record, with noise.

    Raises
    ------
    LoadingError
        If there are fewer than two points or one cycle, or the pad, its rate or its top load is impossible.

    Examples
    --------
    >>> curve = simulate_loading_curve(points=100, force_std=0.005)
    >>> print(f"{curve.load.max():.1f} N, {curve.area.max():.0f} mm²")
    2.0 N, 111 mm²
    """
    stiffest = initial_modulus + load_coefficient * top_load
    positive = (loading_radius, initial_modulus, rate, top_load, stiffest)
    if not (min(positive) > 0 and points >= 2 and cycles >= 1 and sum(s for s, _ in relaxation) < 1):
        raise LoadingError(
            "a simulated curve needs radius, modulus (at all loads), rate and top load above zero, two "
            f"points, one cycle and relaxing shares below one in sum; found {positive}, {points}, "
            f"{cycles}, {relaxation}"
        )
    sphere = Paraboloid(loading_radius, loading_radius)
    top = float(hertz_contact(sphere, Tissue(stiffest, poisson_ratio), load=top_load).indentation)
    way = (top + approach) / rate
    knots = np.cumsum([0.0, way, hold, way if unloading else 0.0])
    heights = [-approach, top, top, -approach if unloading else top]
    time = np.linspace(0, cycles * knots[-1], points)

    def motion(at: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return indentation, negative before contact, and elastic load."""
        phase = np.minimum(at - knots[-1] * np.minimum(at // knots[-1], cycles - 1), knots[-1])
        xi = np.interp(phase, knots, heights)
        loss = np.where(phase > knots[2], hysteresis * (1 - xi / top), 0.0)
        # The load that unit Young's modulus would give: W = (E₀ + β W) times it.
        unit = hertz_contact(sphere, Tissue(1.0, poisson_ratio), indentation=np.maximum(xi, 0)).load
        elastic = initial_modulus * unit / (1 - load_coefficient * unit)
        return xi, elastic * (1 - np.clip(loss, 0, 1))

    xi, load = motion(time)
    if relaxation:
        fine = np.linspace(0, time[-1], _RELAXATION_STEPS)
        load = np.interp(time, fine, _relax(motion(fine)[1], fine[1], relaxation))
    rng = np.random.default_rng(seed)
    area = None
    if with_area:
        # Before contact a picture shows no noise of the area either.
        of_area = np.where(xi > 0, area_std * rng.standard_normal(xi.size), 0.0)
        area = np.maximum(np.pi * loading_radius * np.maximum(xi, 0) + of_area, 0)
    noise = _force_noise(rng, time, force_std, correlation_time)
    return LoadingCurve(
        time=time,
        load=np.maximum(load, 0) + force_offset + force_tilt * time + noise,
        indentation=xi + contact_offset + displacement_std * rng.standard_normal(points),
        area=area,
    )


def save_curve(path: Path, curve: LoadingCurve) -> None:
    """Write a simulated record with time and areas as CSV, as an instrument would leave it."""
    columns = curve.time, curve.load, curve.indentation, curve.area
    table = np.column_stack([np.asarray(column) for column in columns])
    header = "time_s,force_N,displacement_mm,area_mm2"
    np.savetxt(path, table, delimiter=",", header=header, comments="", fmt="%.6g")


def _force_noise(
    rng: np.random.Generator, time: FloatArray, std: float, correlation_time: float
) -> FloatArray:
    white = rng.standard_normal(time.size)
    if not correlation_time > 0:
        return std * white
    from scipy import signal  # noqa: PLC0415 (slow to import, not needed for images)

    kept = np.exp(-(time[1] - time[0]) / correlation_time)
    white[1:] *= np.sqrt(1 - kept**2)
    return std * np.asarray(signal.lfilter([1.0], [1.0, -kept], white))


def _relax(elastic: FloatArray, step: float, terms: Sequence[tuple[float, float]]) -> FloatArray:
    """Return the load of Maxwell arms (share g, time τ) in parallel with a spring, given the elastic load.

    The dashpot of each arm takes off z, with τ dz/dt = g W − z, integrated by the trapezoidal rule.
    """
    from scipy import signal  # noqa: PLC0415 (slow to import, not needed for images)

    load = elastic.copy()
    for share, tau in terms:
        half = step / (2 * tau)
        load -= signal.lfilter([half, half], [1 + half, half - 1], share * elastic)
    return load
