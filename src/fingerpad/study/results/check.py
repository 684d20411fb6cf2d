"""The uncertainty of one contact looked at closely: does the first order hold, and who contributes what."""

from dataclasses import dataclass
from typing import Final, Self

from fingerpad._arrays import FloatArray
from fingerpad.study.results.model import Inputs
from fingerpad.uncertainty import (
    PAD_INPUTS,
    PAD_OUTPUTS,
    PAD_SOURCES,
    pad_model,
    propagate,
    run_monte_carlo,
    sobol_indices,
    validate_linear_approximation,
    variance_shares,
)

_OUTPUT: Final = [PAD_OUTPUTS.index("radius_from_indentation")]


def _corrected_radius(inputs: FloatArray) -> FloatArray:
    return pad_model(inputs)[..., _OUTPUT]


@dataclass(frozen=True, slots=True, kw_only=True)
class UncertaintyCheck:
    """The corrected radius of one contact, by first order and by Monte Carlo.

    Attributes
    ----------
    observation : str
        The contact.
    value, std, interval
        Corrected radius, its first-order standard uncertainty and 95 % interval, mm.
    simulated_std, simulated_interval
        The same by Monte Carlo.
    draws : int
        Draws that were made.
    converged : bool
        Whether two digits of the standard uncertainty stand still.
    valid : bool
        Whether the first order agrees with the simulation to one digit of the standard uncertainty.
    shares, total : dict of str to float
        Share of each source in the variance: of first order, and Sobol's total index.
    """

    observation: str
    value: float
    std: float
    interval: tuple[float, float]
    simulated_std: float
    simulated_interval: tuple[float, float]
    draws: int
    converged: bool
    valid: bool
    shares: dict[str, float]
    total: dict[str, float]

    @classmethod
    def of(cls, observation: str, inputs: Inputs) -> Self:
        """Propagate the inputs of one contact in all ways."""
        sources = _independent_sources(inputs)
        first = propagate(_corrected_radius, *inputs)
        simulated = run_monte_carlo(_corrected_radius, *inputs)
        shares = variance_shares(first, inputs.covariance, sources)
        total = sobol_indices(_corrected_radius, *inputs, sources).total
        return cls(
            observation=observation,
            value=float(first.value[0]),
            std=float(first.std[0]),
            interval=_pair(first.interval),
            simulated_std=float(simulated.std[0]),
            simulated_interval=_pair(simulated.interval),
            draws=simulated.draws,
            converged=bool(simulated.converged[0]),
            valid=bool(validate_linear_approximation(first, simulated).valid[0]),
            shares=dict(zip(sources, map(float, shares[0]), strict=True)),
            total=dict(zip(sources, map(float, total[0]), strict=True)),
        )


def _pair(interval: FloatArray) -> tuple[float, float]:
    return float(interval[0, 0]), float(interval[0, 1])


def _independent_sources(inputs: Inputs) -> dict[str, tuple[int, ...]]:
    """Return the sources, semi-axes and scale as one where the same scale is in both."""
    if not inputs.covariance[:3, PAD_INPUTS.index("image_scale")].any():
        return dict(PAD_SOURCES)
    rest = {name: places for name, places in PAD_SOURCES.items() if name not in {"semi-axes", "image scale"}}
    return {"semi-axes and scale": PAD_SOURCES["semi-axes"] + PAD_SOURCES["image scale"], **rest}
