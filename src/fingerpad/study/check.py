"""The uncertainty of one contact looked at closely: does the first order hold, and who contributes what."""

from dataclasses import dataclass
from typing import Final, Self

from fingerpad.study.model import Inputs
from fingerpad.uncertainty import (
    PAD_INPUTS,
    PAD_OUTPUTS,
    PAD_SOURCES,
    pad_model,
    propagate,
    simulate,
    sobol_indices,
    validate_first_order,
    variance_shares,
)

_OUTPUT: Final = PAD_OUTPUTS.index("radius_from_indentation")


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
    settled : bool
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
    settled: bool
    valid: bool
    shares: dict[str, float]
    total: dict[str, float]

    @classmethod
    def of(cls, observation: str, inputs: Inputs) -> Self:
        """Propagate the inputs of one contact in all ways."""
        sources = _independent_sources(inputs)
        first = propagate(pad_model, *inputs)
        simulated = simulate(pad_model, *inputs)
        valid = validate_first_order(first, simulated).valid
        shares = variance_shares(first, inputs.covariance, sources)[_OUTPUT]
        total = sobol_indices(pad_model, *inputs, sources).total[_OUTPUT]
        return cls(
            observation=observation,
            value=float(first.value[_OUTPUT]),
            std=float(first.std[_OUTPUT]),
            interval=(float(first.interval[_OUTPUT, 0]), float(first.interval[_OUTPUT, 1])),
            simulated_std=float(simulated.std[_OUTPUT]),
            simulated_interval=(
                float(simulated.interval[_OUTPUT, 0]),
                float(simulated.interval[_OUTPUT, 1]),
            ),
            draws=simulated.draws,
            settled=bool(simulated.settled[_OUTPUT]),
            valid=bool(valid[_OUTPUT]),
            shares=dict(zip(sources, map(float, shares), strict=True)),
            total=dict(zip(sources, map(float, total), strict=True)),
        )


def _independent_sources(inputs: Inputs) -> dict[str, tuple[int, ...]]:
    """Return the sources, semi-axes and scale as one where the same scale is in both."""
    if not inputs.covariance[:3, PAD_INPUTS.index("image_scale")].any():
        return dict(PAD_SOURCES)
    rest = {name: places for name, places in PAD_SOURCES.items() if name not in {"semi-axes", "image scale"}}
    return {"semi-axes and scale": PAD_SOURCES["semi-axes"] + PAD_SOURCES["image scale"], **rest}
