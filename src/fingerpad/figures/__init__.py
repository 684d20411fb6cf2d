"""All drawing: the figures of Dzidek et al. (2017) and those of a study, on axes that the caller provides.

Every ``plot_*`` draws on Matplotlib axes, or on panels of a figure as data, and returns them. `new_figure`
makes the one without any global state, `new_panels` the other, which `save_figure` and `svg` write.

Matplotlib's figures are imported when something is first drawn on them.
"""

import lazy_loader

from fingerpad.figures.svg import svg as svg  # which is also its module's name: found later, it would be that

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
