r"""Relaxation of the force of a held contact.

A pad that is linearly viscoelastic in time has the load
:math:`W(t) = \int g(t - s)\,dW_e(s)`, with the elastic load
:math:`W_e = k\,\xi^{3/2}/(1 - b\,\xi^{3/2})` of the recorded motion and
:math:`g = 1 - \sum_i g_i (1 - e^{-t/\tau_i})`. The ramp is part of the integral.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.estimate import Estimate
from fingerpad.exceptions import FitError
from fingerpad.loading.curve import Cycle, LoadingCurve, moving_average
from fingerpad.loading.least_squares import (
    LeastSquaresFit,
    Residuals,
    effective_count,
    fit_least_squares,
    minimum,
)

# A term that takes off less than this share of the squares ends the search for more.
_MAX_TERMS, _GAIN = 3, 0.995
_FINE = 500
_MAX_ROWS = 600
_PATIENCE = 150
# Of searches whose end is only a start.
_NEAR, _FEW = 1e-6, 50


@dataclass(frozen=True, slots=True, kw_only=True)
class PronyTerm:
    """A term of a Prony series: the share of an instantaneous load that decays, and its time (s)."""

    share: Estimate
    time: Estimate


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Relaxation(Displayed):
    """The relaxation of a held load.

    Attributes
    ----------
    terms : tuple of PronyTerm
        Fastest first; none where the force does not relax.
    ramp_time, hold_time : float
        Durations of loading and hold, s.
    aicc : tuple of float
        Corrected Akaike criterion with no, one, two ... terms.
    fit : LeastSquaresFit
        With the number of terms of the least AICc.
    time, load : ndarray
        Times (s) from contact, at most 600 of them, and the force fitted there (N).
    """

    terms: tuple[PronyTerm, ...]
    ramp_time: float
    hold_time: float
    aicc: tuple[float, ...]
    fit: LeastSquaresFit
    time: FloatArray
    load: FloatArray


def fit_relaxation(curve: LoadingCurve, cycle: Cycle, contact_offset: float) -> Relaxation:
    r"""Fit a Prony series to loading and hold of one cycle; the number of terms is chosen by AICc.

    :math:`W(t) = \int g(t - s)\,dW_e(s)` with :math:`g = 1 - \sum_i g_i (1 - e^{-t/\tau_i})` and the elastic
    load :math:`W_e = k\,\xi^{3/2}/(1 - b\,\xi^{3/2})` of the recorded motion. A time shorter than the ramp or
    longer than the hold is not known.

    Parameters
    ----------
    curve : LoadingCurve
        With times; the force's zero subtracted.
    cycle : Cycle
        With a hold.
    contact_offset : float
        Displacement at contact, mm.

    Returns
    -------
    Relaxation
        Shares g_i and times τ_i.

    Raises
    ------
    FitError
        If there are no times, the cycle has no hold, or the load does not determine the model.

    Examples
    --------
    >>> from fingerpad.loading import find_cycles
    >>> from fingerpad.simulate import simulate_loading_curve
    >>> curve = simulate_loading_curve(points=60, hold=10.0, relaxation=[(0.3, 2.0)], force_std=0.02)
    >>> (term,) = fit_relaxation(curve, find_cycles(curve)[0], contact_offset=1.0).terms
    >>> print(f"{term.share.value:.2f} with {term.time.value:.1f} s")
    0.30 with 2.0 s
    """
    if curve.time is None:
        raise FitError("relaxation needs times: a column time_s")
    if cycle.hold is None or len(cycle.hold) < 5:
        raise FitError(
            "the cycle has no hold of five rows or more; relaxation shows only while the platen rests"
        )
    rows = slice(cycle.loading.start, cycle.hold.stop)
    time, load = curve.time[rows] - curve.time[rows][0], curve.load[rows]
    # Each separately: smoothed across, the end of the ramp would be rounded, which looks like relaxation.
    parts = [moving_average(curve.indentation[part.rows]) for part in (cycle.loading, cycle.hold)]
    depth = np.maximum(np.concatenate(parts) - contact_offset, 0.0)
    ramp, whole = float(time[len(cycle.loading) - 1]), float(time[-1])
    some = np.unique(np.linspace(0, load.size - 1, min(load.size, _MAX_ROWS)).astype(int))
    time, load, depth = time[some], load[some], depth[some]
    fine = np.linspace(0, whole, _FINE)
    motion = np.interp(fine, time, depth / depth.max())
    top = float(load.max())

    def model(p: FloatArray) -> FloatArray:
        elastic = p[0] * motion**1.5 / np.maximum(1 - p[1] * motion**1.5, 0.02)
        relaxed = _relax(fine, elastic, p[2::2], np.exp(np.clip(p[3::2], -15, 15)))
        return np.asarray(np.interp(time, fine, relaxed))

    fits: list[LeastSquaresFit] = []
    start = [0.5 * top, 0.5]
    for count in range(_MAX_TERMS + 1):
        try:
            fits.append(_fit_terms(lambda p: load - model(p), start, count, ramp, whole))
        except FitError:
            break
        start = [*fits[-1].values]
        if count and fits[-1].sum_of_squares > _GAIN * fits[-2].sum_of_squares:
            break
    if not fits:
        raise FitError("loading and hold do not determine even a purely elastic load")
    worth = effective_count(fits[-1].residuals)
    fits = [each.with_effective_count(max(worth, each.values.size + 1.0)) for each in fits]
    best = min(fits, key=lambda each: each.aicc)
    return Relaxation(
        terms=_terms(best, ramp, whole - ramp),
        ramp_time=ramp,
        hold_time=whole - ramp,
        aicc=tuple(each.aicc for each in fits),
        fit=best,
        time=time,
        load=model(best.values),
    )


def _fit_terms(
    residuals: Residuals, start: Sequence[float], count: int, ramp: float, whole: float
) -> LeastSquaresFit:
    """Fit `count` terms from the fit of one fewer, the new one tried at several times."""
    names = ["load", "growth", *(f"{part}{k}" for k in range(count) for part in ("share", "log_time"))]
    if count == 0:
        return fit_least_squares(residuals, start, names, evaluations=_PATIENCE)
    found, last = [], FitError("no start was tried")
    for time in np.geomspace(max(0.3 * ramp, whole / 200), whole, 3):
        try:
            found.append(
                minimum(residuals, [*start, 0.1, np.log(time)], names, tolerance=_NEAR, evaluations=_FEW)
            )
        except FitError as error:
            last = error
    if not found:
        raise last
    nearest, _ = min(found, key=lambda each: float(each[1] @ each[1]))
    return fit_least_squares(residuals, nearest, names, evaluations=_PATIENCE)


def _terms(fit: LeastSquaresFit, ramp: float, hold: float) -> tuple[PronyTerm, ...]:
    terms = []
    for k in range((fit.values.size - 2) // 2):
        time = float(np.exp(fit.value(f"log_time{k}")))
        known = fit.derived(time, time * (np.array(fit.names) == f"log_time{k}"))
        share: Estimate = fit.derived(
            fit.value(f"share{k}"), (np.array(fit.names) == f"share{k}").astype(float)
        )
        seen: Estimate = known
        if time < ramp:
            reason = f"faster than the ramp of {ramp:.3g} s: load the pad faster to see it"
            seen = share = Estimate.unknown(reason)
        elif time > hold:
            reason = f"slower than the hold of {hold:.3g} s: hold for longer to see it"
            seen = share = Estimate.unknown(reason)
        terms.append((time, PronyTerm(share=share, time=seen)))
    return tuple(term for _, term in sorted(terms, key=lambda pair: pair[0]))


def _relax(time: FloatArray, elastic: FloatArray, shares: FloatArray, times: FloatArray) -> FloatArray:
    from scipy import signal  # noqa: PLC0415 (slow to import, not needed for images)

    steps, step = np.diff(elastic, prepend=0.0), time[1] - time[0]
    load = (1 - shares.sum()) * elastic
    for share, tau in zip(shares, times, strict=True):
        kept = np.exp(-step / tau)
        load = load + share * signal.lfilter([tau / step * (1 - kept)], [1.0, -kept], steps)
    return np.asarray(load)
