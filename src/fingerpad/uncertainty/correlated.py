"""Values with uncertainty from and for the `uncertainties` package, where that is installed."""

from typing import Any

from fingerpad.uncertainty.inputs import Inputs
from fingerpad.uncertainty.outputs import Outputs


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
