"""
From an image to a modulus
==========================

From a contact image, a finger's shape and a loading curve to a corrected radius and a modulus. Everything
here is synthetic, so that the true values are known. Angles are in radians, lengths in mm, forces in N,
moduli in MPa.
"""

import numpy as np

import fingerpad as fp
from fingerpad.simulate import render_contact_image, render_finger, simulate_loading_curve

# %%
# The shape of the finger
# -----------------------
# A photograph of a face gives two semi-axes. The third comes from another face.

fits = []
for face in ("palmar", "distal"):
    photograph = render_finger(face, mm_per_px=0.08, seed=1)
    scale = fp.Scale(photograph.mm_per_px, mm_per_px_std=0.0004)
    fits.append(fp.measure_photograph(photograph.pixels, face, scale))
drawing = fp.show(fits[0])

# %%
# Faces that share a semi-axis are combined, and their disagreement is part of the uncertainty.

faces = fp.combine_faces(fit.face_semi_axes for fit in fits)
for name, value, std in zip(("palmar", "distal", "radial-ulnar"), faces.semi_axes, faces.stds, strict=True):
    print(f"{name}: {value:.2f} ± {std:.2f} mm")

# %%
# The place of contact
# --------------------
# On a wedge of 30° the finger touches where its normal is vertical. The principal radii of curvature there:

pad = fp.Ellipsoid(palmar=faces.palmar, distal=faces.distal, radial_ulnar=faces.radial_ulnar)
place = fp.Placement(pad, wedge_angle=np.radians(30))
print(place.summary())
placed = fp.show(place)

# %%
# The contact
# -----------
# One contact image at 2 N. A number with a resolution is a scale.

truth = render_contact_image(semi_major=7.4, semi_minor=5.0, seed=3)
image = fp.measure_contact_image(truth.pixels, fp.Scale(truth.mm_per_px))
print(image.summary())
overlay = fp.show(image)

# %%
# From contact to modulus
# -----------------------
# Load, ellipse and curvature give the indentation, the corrected radius and the modulus by elliptical
# Hertz theory, with
# everything that is uncertain.

result = fp.pad_uncertainty(
    palmar=(faces.palmar, faces.stds[0]),
    distal=(faces.distal, faces.stds[1]),
    radial_ulnar=(faces.radial_ulnar, faces.stds[2]),
    wedge_angle=(np.radians(30), np.radians(3)),
    load=(2, 0.02),
    semi_major=(image.ellipse.semi_major, 0.1),
    semi_minor=(image.ellipse.semi_minor, 0.1),
)
print(f"corrected radius {result['radius_from_indentation']:.2f} mm")
print(f"indentation {result['indentation']:.2f} mm")
print(f"Young's modulus {result['youngs_modulus']:.4f} MPa")
for source, share in result.budget("radius_from_indentation").items():
    if share > 0.0005:
        print(f"{source}: {100 * share:.1f} % of the variance")

# %%
# Beside it, the loading curve
# ----------------------------
# The slope of area against indentation gives the radius of an equivalent sphere, :math:`R_g`; load and
# indentation give the modulus.

curve = simulate_loading_curve(loading_radius=14.0, force_std=0.005, displacement_std=0.005, area_std=1.0)
fit = fp.fit_loading_curve(curve)
print(f"R_g {fit.loading_radius.value:.2f} ± {fit.loading_radius.std:.2f} mm")
fitted = fp.show(fit)

# %%
# The radius to compare with :math:`R_g` is that of the sphere with the same area at the same indentation.

print(f"R_Aξ {result['radius_from_compliance']:.2f} mm")
