"""
Pad in three dimensions
=======================

Drag to turn. Colour is the mean-curvature radius 1/H, which :math:`R_{0g}` is at the place of contact
(marked for wedges of 15, 30 and 45°).
"""

# sphinx_gallery_thumbnail_path = 'images/finger_3d.png'

import numpy as np
import plotly.graph_objects as go

import fingerpad as fp

pad = fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
u, v = np.meshgrid(np.radians(np.linspace(-60, 90, 90)), np.radians(np.linspace(10, 170, 90)))
points = pad.point(u, v)
surface = go.Surface(
    x=points[..., 2],
    y=points[..., 1],
    z=points[..., 0],
    surfacecolor=pad.curvature(u, v).mean_curvature_radius,
    colorscale="Viridis",
    colorbar_title="1/H (mm)",
)
places = fp.Placement(pad, wedge_angle=np.radians([15, 30, 45])).point
marks = go.Scatter3d(
    x=places[:, 2], y=places[:, 1], z=places[:, 0], mode="markers", marker={"color": "black", "size": 4}
)
finger = go.Figure([surface, marks])
axis_titles = {"xaxis_title": "across", "yaxis_title": "distal", "zaxis_title": "palmar (mm)"}
finger.update_layout(scene={"aspectmode": "data", **axis_titles}, margin={"l": 0, "r": 0, "t": 0, "b": 0})
