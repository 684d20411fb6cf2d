"""The uncertainty of one contact by all methods: validity of the linear approximation, and shares."""

from dataclasses import replace
from typing import Final

from fingerpad._arrays import FloatArray
from fingerpad.study.results.summary_file import UncertaintyCheckRecord
from fingerpad.uncertainty import (
    Inputs,
    pad_model,
    propagate,
    run_monte_carlo,
    sobol_indices,
    validate_linear_approximation,
)

_RADIUS: Final = "radius_from_indentation"


def _corrected_radius(**inputs: FloatArray) -> dict[str, FloatArray]:
    return {_RADIUS: pad_model(**inputs)[_RADIUS]}


def check_uncertainty(observation: str, inputs: Inputs) -> UncertaintyCheckRecord:
    """Propagate the inputs of one contact by first order and by Monte Carlo."""
    inputs = _with_independent_groups(inputs)
    first = propagate(_corrected_radius, inputs)
    simulated = run_monte_carlo(_corrected_radius, inputs)
    radius, drawn = first[_RADIUS], simulated[_RADIUS]
    return UncertaintyCheckRecord(
        observation=observation,
        value=float(radius.value),
        std=float(radius.std),
        interval=(float(radius.lower), float(radius.upper)),
        simulated_std=float(drawn.std),
        simulated_interval=(float(drawn.lower), float(drawn.upper)),
        draws=simulated.draws,
        converged=simulated.converged[_RADIUS],
        valid=validate_linear_approximation(first, simulated)[_RADIUS].valid,
        shares={source: float(share) for source, share in first.budget(_RADIUS).items()},
        total=sobol_indices(_corrected_radius, inputs)[_RADIUS].total,
    )


def _with_independent_groups(inputs: Inputs) -> Inputs:
    """Return inputs with semi-axes and scale as one group where the same scale is in both."""
    axes, scale = (inputs.groups[source] for source in ("semi-axes", "image scale"))
    if not inputs.covariance[inputs.places(axes), inputs.places(scale)].any():
        return inputs
    rest = {source: names for source, names in inputs.groups.items() if names not in (axes, scale)}
    return replace(inputs, groups={"semi-axes and scale": axes + scale, **rest})
