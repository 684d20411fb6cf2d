"""
Image sequence
==============

Area and semi-axes of every frame of a synthetic press, against time and against force.
"""

import numpy as np

import fingerpad as fp
from fingerpad.figures import new_figure, plot_press
from fingerpad.image import Frame, FrameRate
from fingerpad.simulate import render_sequence

time = np.linspace(0, 4, 41)  # s
load = np.interp(time, [0, 0.4, 2.0, 2.6, 4.0], [0, 0, 1.5, 1.5, 0])  # N
press = render_sequence(load, seed=2)
frames = [Frame(index=k, pixels=press.pixels(k)) for k in range(time.size)]
results = fp.measure_sequence(
    frames, fp.Scale.of_ppi(press.ppi), clock=FrameRate(10.0), force=fp.ForceSignal(time=time, load=load)
)
seen = [result for result in results if result.measures is not None and result.phase != "baseline"]

figure, axes = new_figure(width_mm=170, height_mm=110, rows=2, columns=2)
plot_press(
    axes,
    time=[result.time for result in seen],
    load=[result.load for result in seen],
    phase=[result.phase for result in seen],
    area=[result.measures["gross_area_mm2"] for result in seen],
    semi_major=[result.measures["semi_major_mm"] for result in seen],
    semi_minor=[result.measures["semi_minor_mm"] for result in seen],
    synthetic=True,
)
