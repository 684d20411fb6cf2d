"""One fingertip of a closed hand mesh: silhouettes and vertices.

Mesh: Max Planck Society e.V. via SMPL (Loper et al. 2015), modified by O. Stein (2021), CC BY 4.0.
"""

from pathlib import Path

import cv2
import numpy as np
from scipy.optimize import least_squares
from scipy.sparse import coo_array

MESH = Path(__file__).resolve().parents[3] / "shared" / "data" / "smpl_hand_mesh" / "hand_closed.obj"
WIDTH_MM = 17.0
MM_PER_PX = 0.05
SKIN, GROUND = np.array([205.0, 150, 120]), np.array([52.0, 92, 160])


def middle_finger():
    """Return the middle finger in its own frame: vertices, mm (palmar, distal, across), triangles, which."""
    vertices, faces = [], []
    for line in MESH.read_text().splitlines():
        kind, *rest = line.split() or [""]
        if kind == "v":
            vertices.append([float(value) for value in rest[:3]])
        elif kind == "f":
            faces.append([int(value.split("/")[0]) - 1 for value in rest])
    vertices, faces = np.array(vertices), np.array(faces)
    chosen = (np.abs(vertices[:, 0] - 0.03) < 0.075) & (vertices[:, 1] > 0.72)
    faces = faces[chosen[faces].all(axis=1)]
    for _ in range(2):
        vertices, faces = _subdivided(vertices, faces)
    chosen = np.zeros(len(vertices), dtype=bool)
    chosen[np.unique(faces)] = True
    finger = vertices[chosen]
    along = np.linalg.svd(finger - finger.mean(axis=0), full_matrices=False)[2][0]
    along *= np.sign(along[1])
    # The thumb, and so the palm, is on the side of greater z.
    palmar = np.array([0, 0, 1.0]) - along[2] * along
    palmar /= np.linalg.norm(palmar)
    local = vertices @ np.stack([palmar, along, np.cross(palmar, along)], axis=-1)
    tip = local[chosen, 1].max()
    near = chosen & (local[:, 1] > tip - 0.08)
    size = WIDTH_MM / np.ptp(local[near, 2])
    local = (local - [np.mean(local[near, 0]), tip, np.mean(local[near, 2])]) * size
    return local, faces, chosen


def _subdivided(vertices, faces):
    """Split each triangle into four and smooth (Taubin), so that no flat facets show."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middle = (len(vertices) + inverse.reshape(3, -1)).T
    corners = np.concatenate([vertices, vertices[unique].mean(axis=1)])
    a, b, c = faces.T
    ab, bc, ca = middle.T
    split = np.concatenate(
        [np.stack(t, axis=-1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    )
    links = np.unique(
        np.sort(np.concatenate([split[:, [0, 1]], split[:, [1, 2]], split[:, [2, 0]]]), axis=1), axis=0
    )
    both = np.concatenate([links, links[:, ::-1]]).T
    near = coo_array((np.ones(both.shape[1]), both), shape=(len(corners), len(corners))).tocsr()
    count = near.sum(axis=1)[:, None]
    for share in (0.5, -0.53, 0.5, -0.53, 0.5, -0.53):
        mean = near @ corners / np.maximum(count, 1)
        corners = corners + share * np.where(count > 0, mean - corners, 0)
    return corners, split


def silhouette(local, faces, across, along):
    """Return a photograph of the fingertip: points (x, y), mm, y up in the picture."""
    fine = 3
    rows, columns = 44 / MM_PER_PX, 38 / MM_PER_PX
    x, y = local @ across, local @ along
    row = 8 / MM_PER_PX - (y - y[np.unique(faces)].max()) / MM_PER_PX
    column = columns / 2 + x / MM_PER_PX
    mask = np.zeros((int(rows * fine), int(columns * fine)), np.uint8)
    corners = np.rint((np.stack([column, row], axis=-1) + 0.5) * fine - 0.5).astype(np.int32)
    for face in faces:
        cv2.fillConvexPoly(mask, corners[face], 1)
    cover = cv2.resize(mask.astype(np.float32), (int(columns), int(rows)), interpolation=cv2.INTER_AREA)
    cover = cv2.GaussianBlur(cover, (0, 0), 1.0)[..., None]
    light = cover * (SKIN / 255) ** 2.2 + (1 - cover) * (GROUND / 255) ** 2.2
    noise = np.random.default_rng(1).normal(0, 2, light.shape)
    return np.clip(np.rint(255 * light ** (1 / 2.2) + noise), 0, 255).astype(np.uint8)


def outermost(local, chosen, across, along, wanted):
    """Return marks (row, column), px: outermost at depths below the tip, mm, right (1) or left (-1)."""
    x, y = local @ across, local @ along
    top, marks = y[chosen].max(), []
    for depth, side in wanted:
        near = np.flatnonzero(chosen & (np.abs(y - (top - depth)) < 0.25))
        k = near[np.argmax(side * x[near])]
        marks.append(((8 - (y[k] - top)) / MM_PER_PX, (19 + x[k]) / MM_PER_PX))
    return marks


def pad_ellipsoid(local, chosen):
    """Return semi-axes (palmar, distal, across) of the ellipsoid fitted to the pad's vertices."""
    pad = local[chosen & (local[:, 0] > -1) & (local[:, 1] > -18)]

    def off(values):
        centre, axes = values[:3], values[3:]
        scaled = np.linalg.norm((pad - centre) / axes, axis=1)
        return (scaled - 1) * np.linalg.norm(pad - centre, axis=1) / scaled

    return np.abs(least_squares(off, [0, -13, 0, 8, 13, 8.5]).x[3:])
