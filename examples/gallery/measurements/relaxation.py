"""
Relaxation under a held displacement
====================================

The load of a held press, fitted with a sum of exponentials. Nothing faster than the ramp is resolved.
Simulated data.
"""

from fingerpad.figures import new_figure, plot_relaxation
from fingerpad.loading import find_cycles, fit_relaxation
from fingerpad.simulate import simulate_loading_curve

curve = simulate_loading_curve(
    points=400, hold=60.0, relaxation=[(0.2, 3.0), (0.15, 20.0)], force_std=0.004, seed=1
)
cycle = find_cycles(curve)[0]
relaxation = fit_relaxation(curve, cycle, contact_offset=1.0)
terms = [term for term in relaxation.terms if term.time.known]  # others are faster than the ramp
for term in terms:
    print(f"{100 * term.share.value:.0f} % within {term.time.value:.1f} ± {term.time.std:.1f} s")

figure, (axes,) = new_figure()
plot_relaxation(
    axes,
    relaxation.time,
    relaxation.load,
    ramp_time=relaxation.ramp_time,
    time_constants=[term.time.value for term in terms],
    synthetic=True,
)
