"""Measurements as the store keeps them: plain values, to the last digit."""

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from fingerpad.study.measure import Measurement


def measurement_record(measured: Measurement) -> dict[str, Any]:
    """Return a measurement as plain values."""
    return {**asdict(measured), "covariance": measured.covariance.tolist()}


def measurement_from(record: Mapping[str, Any], load: float) -> Measurement:
    """Return a measurement from its record, under the load that the manifest says now."""
    plain = {**record, "covariance": np.array(record["covariance"]), "flags": tuple(record["flags"])}
    return replace(Measurement(**plain), load=load)
