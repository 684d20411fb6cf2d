"""
Scatter of repeats, sessions and fingers
========================================

Contact areas of eight synthetic fingers, each pressed three times in two sessions, and what they tell of
the scatter at each level, with 95 % intervals.
"""

import numpy as np

from fingerpad.figures import new_figure
from fingerpad.uncertainty import nested_scatter

random = np.random.default_rng(3)
fingers, sessions, repeats = 8, 2, 3
true_std = {"fingers": 0.12, "sessions": 0.05, "repeats": 0.04}  # relative
finger = np.repeat(np.arange(fingers), sessions * repeats)
session = np.repeat(np.arange(fingers * sessions), repeats)
log_area = (
    np.log(110)
    + true_std["fingers"] * random.standard_normal(fingers)[finger]
    + true_std["sessions"] * random.standard_normal(fingers * sessions)[session]
    + true_std["repeats"] * random.standard_normal(finger.size)
)
scatter = nested_scatter(log_area, {"finger": finger, "session": session})

figure, (axes,) = new_figure()
for row, (level, component) in enumerate(scatter.components.items()):
    low, high = component.interval
    axes.plot([100 * low, 100 * high], [row, row], lw=6, alpha=0.4, color="C0")
    axes.plot(100 * component.std, row, "o", color="C0")
    axes.plot(100 * true_std[f"{level}s"], row, "kx")
ticks = (3, 5, 10, 20, 40)
axes.set(xscale="log", xlabel="standard deviation of the area (%)", title="synthetic; crosses: truth")
axes.set_xticks(ticks, [f"{tick}" for tick in ticks])
axes.minorticks_off()
axes.set_yticks(range(len(scatter.components)), scatter.components)
