"""Named outputs of a model with their joint covariance."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed, aligned
from fingerpad.estimate import Estimate
from fingerpad.exceptions import UncertaintyError


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Outputs(Displayed):
    """Named outputs of a model with their joint covariance; ``outputs[name]`` is one `Estimate`.

    Attributes
    ----------
    names : tuple of str
        Names of the m outputs.
    value : ndarray, shape (..., m)
        Their values.
    covariance : ndarray, shape (..., m, m)
        Their covariance.
    interval : ndarray, shape (..., m, 2)
        Lower and upper ends of the 95 % interval of each.

    Examples
    --------
    >>> from fingerpad.uncertainty import Inputs, propagate
    >>> outputs = propagate(lambda x: {"double": 2 * x, "square": x**2}, Inputs.of(x=(3.0, 0.1)))
    >>> outputs.names, outputs.covariance.round(3)
    (('double', 'square'), array([[0.04, 0.12],
           [0.12, 0.36]]))
    >>> print(f"{outputs['square']:.1f}")
    9.0 ± 0.6
    """

    names: tuple[str, ...]
    value: FloatArray
    covariance: FloatArray
    interval: FloatArray

    def summary(self) -> str:
        """Return each output with its standard uncertainty.

        Returns
        -------
        str
            One line each.
        """
        return "\n".join([type(self).__name__, *aligned([(name, str(self[name])) for name in self.names])])

    def __str__(self) -> str:
        return self.summary()

    @property
    def std(self) -> FloatArray:
        """Standard uncertainty of each output, shape (..., m)."""
        return np.sqrt(np.diagonal(self.covariance, axis1=-2, axis2=-1))

    def place(self, name: str) -> int:
        """Return the place of an output along the last axis.

        Parameters
        ----------
        name : str
            Its name.

        Returns
        -------
        int

        Raises
        ------
        UncertaintyError
            If there is no output of that name.

        Examples
        --------
        >>> from fingerpad.uncertainty import Inputs, propagate
        >>> propagate(lambda x: {"double": 2 * x, "square": x**2}, Inputs.of(x=3.0)).place("square")
        1
        """
        if name not in self.names:
            raise UncertaintyError(f"no output {name!r}; there are {', '.join(self.names)}")
        return self.names.index(name)

    def __getitem__(self, name: str) -> Estimate:
        place = self.place(name)
        ends = np.moveaxis(self.interval[..., place, :], -1, 0)
        columns: tuple[Any, ...] = (self.value[..., place], self.std[..., place], *ends)
        value, std, lower, upper = (column[()] for column in columns)  # numbers, of one set of inputs
        return Estimate(value=value, std=std, interval=(lower, upper))
