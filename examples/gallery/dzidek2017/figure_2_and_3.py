"""
Photographs of the faces with fitted ellipses (Figs 2 and 3)
============================================================

Each face shows two of the three semi-axes. The photographs here are synthetic; those of Dzidek et al.
(2017) are not public. Green: the arc that belongs to the pad. Yellow: the ellipse.
"""

import fingerpad as fp
from fingerpad.figures import new_figure
from fingerpad.image import draw_overlay
from fingerpad.simulate import render_finger

figure, axes = new_figure(width_mm=170, height_mm=80, columns=3)
fits = []
for k, face in enumerate(("palmar", "ulnar", "distal")):
    photograph = render_finger(face, seed=k)
    scale = fp.Scale(photograph.mm_per_px, 0.005 * photograph.mm_per_px)
    fit = fp.measure_photograph(photograph.pixels, face, scale)
    axes[k].imshow(draw_overlay(photograph.pixels, fit))
    axes[k].set(title=f"{face} (synthetic)", xticks=[], yticks=[])
    axes[k].grid(visible=False)
    fits.append(fit)

pad = fp.combine_faces(fit.face_semi_axes for fit in fits)
for name, std in zip(("palmar", "distal", "radial_ulnar"), pad.stds, strict=True):
    print(f"{name}: {getattr(pad, name):.2f} ± {std:.2f} mm")
