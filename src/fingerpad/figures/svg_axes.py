"""Axes of SVG drawings: ranges of the data, scales, and labels of ticks."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.figures.panels import Call, Panel, numbers


@dataclass(slots=True)
class AxisScale:
    """From data to points along one axis."""

    low: float
    high: float
    log: bool
    begin: float = 0.0
    end: float = 1.0

    def __call__(self, values: Any) -> Any:
        """Return places on paper."""
        low, high = self.low, self.high
        if self.log:
            with np.errstate(all="ignore"):
                values, low, high = np.log10(values), math.log10(low), math.log10(high)
        return self.begin + (values - low) / (high - low) * (self.end - self.begin)


class Limits:
    """Ranges of the data of a panel, and what was asked of its axes."""

    def __init__(self, panel: Panel, by_name: dict[str, list[Call]]) -> None:
        self.calls = by_name
        self.values: dict[str, list[FloatArray]] = {"x": [], "y": []}
        for call in panel.calls:
            for axis, values in _extent(call):
                self.values[axis].append(np.ravel(values))

    def scale(self, axis: str) -> AxisScale:
        """Return the scale of an axis: as asked, else round the data with a margin."""
        log = any(call.args[0] == "log" for call in self.calls.get(f"set_{axis}scale", ()))
        every = np.concatenate([*self.values[axis], np.empty(0)])
        every = every[np.isfinite(every) & ((every > 0) | (not log))]
        low, high = (
            (float(every.min()), float(every.max())) if every.size else (1.0, 10.0) if log else (0.0, 1.0)
        )
        if low == high:
            low, high = (
                (low / 2, 2 * high) if log else (low - (0.05 * abs(low) or 1), high + (0.05 * abs(low) or 1))
            )
        room = 0.05
        for call in self.calls.get("margins", ()):
            room = call.options.get(axis, room)
        if log:
            factor = (high / low) ** room
            low, high = low / factor, high * factor
        else:
            low, high = low - room * (high - low), high + room * (high - low)
        for call in self.calls.get(f"set_{axis}ticks", ()):
            low, high = min(low, *call.args[0]), max(high, *call.args[0])
        names = ("left", "right") if axis == "x" else ("bottom", "top")
        for call in self.calls.get(f"set_{axis}lim", ()):
            given = dict(zip(names, call.args, strict=False)) | call.options
            low, high = given.get(names[0], low), given.get(names[1], high)
        return AxisScale(low, high, log)


def _extent(call: Call) -> Iterator[tuple[str, FloatArray]]:
    """Yield the data that the axes have to hold."""
    match call.name:
        case "plot" | "errorbar":
            x, y = numbers(call.args[0]), numbers(call.args[1])
            for axis, values, name in (("x", x, "xerr"), ("y", y, "yerr")):
                std = np.nan_to_num(numbers(call.options[name])) if name in call.options else 0.0
                yield axis, values - std
                yield axis, values + std
        case "fill_between":
            yield "x", numbers(call.args[0])
            for values in call.args[1:]:
                yield "y", numbers(values)
        case "barh":
            half = call.options.get("height", 0.8) / 2
            yield "x", np.append(numbers(call.args[1]), 0.0)
            yield "y", np.add.outer((-half, half), numbers(call.args[0]))
        case "axhline" | "axhspan":
            yield "y", numbers(list(call.args))
        case "axvline" | "axvspan":
            yield "x", numbers(list(call.args))
        case _:
            return


def decimal_labels(places: Iterable[float]) -> list[str]:
    """Return numbers with as many decimals as the finest of them needs."""
    every = list(places)
    for decimals in range(8):
        words = [f"{place + 0.0:.{decimals}f}" for place in every]
        step = abs(every[1] - every[0]) if len(every) > 1 else 1.0
        if all(abs(float(word) - place) <= 1e-3 * step for word, place in zip(words, every, strict=True)):
            break
    return [word.replace("-", "−") if float(word) else word.lstrip("-") for word in words]
