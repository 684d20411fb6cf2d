"""Photographs of coins and washers traced by rays: a thick disc of metal on a table or on a glass prism.

Independent of `fingerpad.simulate.coin`: a pinhole camera looks at a cylinder with a rounded edge and
a height map, lit by lamps and surroundings that the metal mirrors; the disc casts shadows and hides some sky.
Lengths are in radii of the disc, its centre the origin and the table z = 0.
"""

import math
from typing import NamedTuple

import cv2
import numpy as np

from benchmarks.arrays import Array, Pixels, Rng
from benchmarks.truth.true_image import eight_bit

UP = np.array([0.0, 0.0, 1.0])
SHAPE = (360, 480)
OVERSAMPLING = 2
KINDS = (
    "plain", "texture", "uneven light", "low contrast", "hard shadow", "partly shadowed",
    "strong relief", "touching a finger", "touching an edge", "oblique", "washer on a prism",
)  # fmt: skip
NOT_ONE_COIN = ("two coins", "cut by the frame", "no coin", "a square")


class Scene(NamedTuple):
    """A photograph, and the true larger semi-axis of the disc's top outline, px."""

    pixels: Pixels
    semi_major: float


class Disc(NamedTuple):
    """Where a disc lies on the table, its thickness, its hole, and what it is made of."""

    thickness: float
    hole: float
    rounding: float
    metal: float
    roughness: float
    relief: float
    letters: int
    seed: int
    x: float = 0.0
    y: float = 0.0
    size: float = 1.0


class Lamps(NamedTuple):
    """Directions to the lamp's parts, its share of the light, the room's bright walls, the table's grey."""

    parts: Array
    direct: float
    walls: Array
    wall_width: float
    table: float


def scene(kind: str, seed: int) -> Scene:
    """Return one photograph of a kind; the same seed gives the same one."""
    rng = np.random.default_rng([seed, (KINDS + NOT_ONE_COIN).index(kind)])
    prism = kind == "washer on a prism"
    distance = rng.uniform(14, 40)
    tilt = rng.uniform(0.25, 0.55) if kind == "oblique" else rng.uniform(0, 0.25)
    tilt = rng.uniform(0.0, 0.75) if prism else tilt
    radius_px = rng.uniform(62, 120)
    offset = rng.uniform(-0.25, 0.25, 2)
    if kind == "two coins":
        radius_px, offset = rng.uniform(62, 75), np.array([rng.uniform(0.9, 1.05), rng.uniform(-0.2, 0.2)])
    if kind == "cut by the frame":
        offset = np.array([rng.choice([-1, 1]) * (SHAPE[1] / 2 / radius_px - rng.uniform(0.3, 0.8)), 0.0])
    origins, rays = _camera(distance, tilt, rng.uniform(0, 2 * math.pi), radius_px, offset)

    disc = _a_disc(kind, rng)
    # The table is dark or pale, and on a prism black or bright.
    tables = ((0.01, 0.06), (0.5, 0.9)) if prism else ((0.04, 0.12), (0.6, 0.95))
    lamps = _lamps(kind, float(rng.choice([rng.uniform(*one) for one in tables])), rng)
    if kind == "low contrast":
        level = 0.25 + float(_mirrored(UP, -UP, lamps, disc.roughness))
        contrast = rng.choice([rng.uniform(0.6, 0.78), rng.uniform(1.25, 1.6)])
        lamps = lamps._replace(table=disc.metal * level * contrast)
    discs = [disc] if kind not in ("no coin", "a square") else []
    if kind == "two coins":
        second = _a_disc(kind, rng)
        x, y, size = -rng.uniform(2.15, 2.4), rng.uniform(-0.3, 0.3), rng.uniform(0.8, 1.1)
        discs.append(second._replace(x=x, y=y, size=size))
    ground_points = origins + rays * (-origins[2] / rays[2])
    light = _ground(kind, ground_points, discs, lamps, rng)
    for each in discs:
        light = _with_disc(light, origins, rays, each, lamps)
    light = _with_neighbours(light, kind, ground_points, rng)
    if kind == "partly shadowed":  # by a hand or telephone held between lamp and table
        turn = rng.uniform(0, 2 * math.pi)
        edge = ground_points[0] * math.cos(turn) + ground_points[1] * math.sin(turn) - rng.uniform(-0.6, 0.6)
        dark = rng.uniform(0.25, 0.65)
        light = light * (1 - dark * (0.5 + 0.5 * np.tanh(edge / rng.uniform(0.02, 0.24))))
    return Scene(_exposed(light, kind, rng), _imaged_circle(origins, disc, rays))


def _camera(
    distance: float, tilt: float, turn: float, radius_px: float, offset: Array
) -> tuple[Array, Array]:
    """Return the camera's place, (3, 1, 1), and the rays through the fine pixels, (3, rows, columns)."""
    rows, columns = (
        ((np.arange(n * OVERSAMPLING) + 0.5) / OVERSAMPLING - 0.5 - (n - 1) / 2) / (radius_px * distance)
        for n in SHAPE
    )
    down, right = np.meshgrid(rows, columns, indexing="ij")
    right, down = right - offset[0] / distance, down - offset[1] / distance
    # Image axes in the world for a camera overhead, tilted about an axis in the table, then turned.
    back = np.array([math.sin(tilt) * math.cos(turn), math.sin(tilt) * math.sin(turn), math.cos(tilt)])
    across = np.array([-math.sin(turn), math.cos(turn), 0.0])
    along = np.cross(back, across)
    spin = -np.array([math.cos(turn), math.sin(turn)])
    x_axis = spin[0] * along + spin[1] * across
    y_axis = np.cross(-back, x_axis)
    rays = -back[:, None, None] + right * x_axis[:, None, None] + down * y_axis[:, None, None]
    return (back * distance)[:, None, None], rays


def _imaged_circle(origin: Array, disc: Disc, rays: Array) -> float:
    """Return the larger semi-axis of the image of the top circle: a conic by its homography."""
    rows, columns = rays.shape[1:]
    # World ray as an affine map of pixel (column, row, 1), from three corners of the fine grid.
    corner, right, down = rays[:, 0, 0], rays[:, 0, -1], rays[:, -1, 0]
    per_column = (right - corner) / (columns - 1) * OVERSAMPLING
    per_row = (down - corner) / (rows - 1) * OVERSAMPLING
    first = (0.5 / OVERSAMPLING) - 0.5
    to_ray = np.column_stack([per_column, per_row, corner - first * (per_column + per_row)])
    height = disc.thickness - disc.rounding
    place = origin[:, 0, 0] - np.array([disc.x, disc.y, height])
    # Ray r meets z = height at x = o_x − o_z r_x / r_z: homogeneous (o_x r_z − o_z r_x, …, r_z).
    to_plane = np.array([[-place[2], 0, place[0]], [0, -place[2], place[1]], [0, 0, 1.0]]) @ to_ray
    conic = to_plane.T @ np.diag([1.0, 1.0, -(disc.size**2)]) @ to_plane
    middle = -np.linalg.solve(conic[:2, :2], conic[:2, 2])
    level = -(conic[2, 2] + conic[2, :2] @ middle)
    return float(np.sqrt(level / np.linalg.eigvalsh(conic[:2, :2])).max())


def _a_disc(kind: str, rng: Rng) -> Disc:
    washer = kind == "washer on a prism" or (kind == "texture" and rng.random() < 0.3)
    return Disc(
        thickness=rng.uniform(0.06, 0.2),
        hole=rng.uniform(0.3, 0.62) if washer else 0.0,
        rounding=rng.uniform(0.01, 0.03) if washer else rng.uniform(0.005, 0.02),
        metal=rng.uniform(0.25, 0.75),
        roughness=rng.uniform(0.12, 0.5),
        relief=0.0 if washer else rng.uniform(2.0, 3.5) if kind == "strong relief" else rng.uniform(0.3, 1.4),
        letters=int(rng.integers(9, 26)),
        seed=int(rng.integers(2**31)),
    )


def _lamps(kind: str, table: float, rng: Rng) -> Lamps:
    hard = kind == "hard shadow"
    polar = rng.uniform(0.7, 1.15) if hard else rng.uniform(0.1, 0.9)
    turn = rng.uniform(0, 2 * math.pi)
    middle = np.array([math.sin(polar) * math.cos(turn), math.sin(polar) * math.sin(turn), math.cos(polar)])
    parts = middle + rng.normal(0, rng.uniform(0.02, 0.08) if hard else rng.uniform(0.1, 0.35), (12, 3))
    parts[:, 2] = np.maximum(parts[:, 2], 0.25)
    walls = rng.normal(0, 1, (3, 3))
    walls[:, 2] = np.abs(walls[:, 2])
    direct = rng.uniform(0.55, 0.85) if hard else rng.uniform(0.15, 0.5)
    return Lamps(_unit(parts.T).T, direct, _unit(walls.T).T, rng.uniform(0.3, 0.8), table)


def _unit(vectors: Array) -> Array:
    return vectors / np.linalg.norm(vectors, axis=0, keepdims=True)


def _mirrored(normal: Array, rays: Array, lamps: Lamps, roughness: float) -> Array:
    """Return what rough metal mirrors: lamps, bright walls, the table, surroundings paler above."""
    way = _unit(rays)
    reflected = way - 2 * np.sum(way * normal, axis=0) * normal
    seen = 0.35 + 0.35 * reflected[2]
    for wall in lamps.walls:
        seen = seen + 0.6 * np.exp((np.tensordot(wall, reflected, 1) - 1) / (lamps.wall_width**2))
    lobe = roughness**2 + 0.01
    for part in lamps.parts:
        glare = np.exp((np.tensordot(part, reflected, 1) - 1) / lobe)
        seen = seen + lamps.direct * 0.35 / lobe**0.5 / len(lamps.parts) * glare
    share = 0.5 - 0.5 * np.tanh(reflected[2] / (0.5 * roughness))
    return (1 - share) * seen + share * 0.4 * lamps.table


def _with_disc(light: Array, origin: Array, rays: Array, disc: Disc, lamps: Lamps) -> Array:
    """Return the picture with a disc: its face, its rounded edge and its wall, where rays meet them."""
    place = origin - np.array([disc.x, disc.y, 0.0])[:, None, None]
    top = disc.thickness - disc.rounding
    x, y = (place[k] + rays[k] * ((top - place[2]) / rays[2]) for k in (0, 1))
    distance = np.hypot(x, y)
    face = (distance <= disc.size) & (distance >= disc.hole)
    left, upper, width, height = cv2.boundingRect(face.astype(np.uint8))
    window = slice(upper, upper + height), slice(left, left + width)
    slopes = _slopes(x[window] / disc.size, y[window] / disc.size, disc)
    slope_x, slope_y = (slope[face[window]] for slope in slopes)
    normal = _unit(np.stack([-slope_x, -slope_y, np.ones_like(slope_x)]))
    seen = light.copy()
    seen[face] = disc.metal * (0.25 + _mirrored(normal, rays[:, face], lamps, disc.roughness))
    # The wall between table and top: the nearer root of |place + ray t| = size.
    a = rays[0] ** 2 + rays[1] ** 2
    b = place[0] * rays[0] + place[1] * rays[1]
    root = b * b - a * (place[0] ** 2 + place[1] ** 2 - disc.size**2)
    t = (-b - np.sqrt(np.maximum(root, 0))) / np.maximum(a, 1e-12)
    height = place[2] + rays[2] * t
    wall = (root > 0) & (height > 0) & (height < top) & ~face & (distance > disc.size)
    on_wall, t = rays[:, wall], t[wall]
    wx, wy = place[0, 0, 0] + on_wall[0] * t, place[1, 0, 0] + on_wall[1] * t
    reeded = 0.25 * np.sin(np.arctan2(wy, wx) * 130)
    outward = _unit(np.stack([wx - reeded * wy, wy + reeded * wx, np.zeros_like(wx)]))
    mirrored = _mirrored(outward, on_wall, lamps, disc.roughness)
    seen[wall] = disc.metal * (0.1 + 0.5 * height[wall] / top) * (0.25 + mirrored)
    return seen


def _slopes(x: Array, y: Array, disc: Disc) -> tuple[Array, Array]:
    """Return the slopes of the face: raised rim, beads, letters, a portrait and the rounded edge."""
    rng = np.random.default_rng(disc.seed)
    n = 512
    grid = np.linspace(-1.05, 1.05, n)
    gx, gy = np.meshgrid(grid, grid)
    r, angle = np.hypot(gx, gy), np.arctan2(gy, gx)
    inner = rng.uniform(0.86, 0.94)
    height = 0.02 / (1 + np.exp(-(r - inner) / 0.006))
    height = height + 0.008 * (np.abs(r - inner + 0.04) < 0.014) * (np.cos(90 * angle) > 0)
    glyph = (rng.random((3, disc.letters * 5)) < 0.55).astype(float)
    column = ((angle / (2 * math.pi) + 0.5) * disc.letters * 5).astype(int) % (disc.letters * 5)
    row = np.clip((r - 0.66) / 0.05, 0, 2.99).astype(int)
    height = height + 0.014 * glyph[row, column] * ((r > 0.66) & (r < 0.81))
    blob = cv2.GaussianBlur(rng.normal(0, 1, (n, n)), (0, 0), 14) * 14
    fine = cv2.GaussianBlur(rng.normal(0, 1, (n, n)), (0, 0), 4) * 4
    height = height + (0.012 * blob + 0.004 * fine) * (r < 0.6)
    height = cv2.GaussianBlur(height, (0, 0), 1.2) * disc.relief
    down, right = np.gradient(height, grid[1] - grid[0])
    at_x, at_y = (((one + 1.05) / (grid[1] - grid[0])).astype(np.float32) for one in (x, y))
    seen = (cv2.remap(s.astype(np.float32), at_x, at_y, cv2.INTER_LINEAR) for s in (right, down))
    along, across = (s.astype(np.float64) for s in seen)
    distance = np.hypot(x, y) + 1e-12
    # The rounded edge falls off as a quarter circle; a washer's hole likewise, inward.
    into = np.clip((distance - 1 + disc.rounding) / disc.rounding, 0, 0.98)
    fall = into / np.sqrt(1 - into**2)
    if disc.hole:
        hole = disc.hole / disc.size
        back = np.clip((hole + disc.rounding - distance) / disc.rounding, 0, 0.98)
        fall = fall - back / np.sqrt(1 - back**2)
        turned = 0.06 * np.sin(distance * 180 + rng.uniform(0, 6))
        fall = fall + turned * (into == 0) * (back == 0)
    return along + fall * x / distance, across + fall * y / distance


def _ground(kind: str, points: Array, discs: list[Disc], lamps: Lamps, rng: Rng) -> Array:
    """Return the lit table: its texture, the fall of light, the discs' shadows."""
    x, y = points[:2]
    uneven, texture = kind in ("uneven light", "washer on a prism"), _texture(kind, x, y, rng)
    slope, turn = rng.uniform(0.3, 0.8) if uneven else rng.uniform(0, 0.15), rng.uniform(0, 2 * math.pi)
    lit = 1 + slope * np.tanh((x * math.cos(turn) + y * math.sin(turn)) / 3.0)
    if uneven:
        spot = rng.uniform(-1.5, 1.5, 2)
        lit = lit * (0.5 + np.exp(-((x - spot[0]) ** 2 + (y - spot[1]) ** 2) / rng.uniform(2, 8)))
    seen = lamps.table * texture * lit
    for disc in discs if kind != "washer on a prism" else []:
        seen = seen * _shaded(x - disc.x, y - disc.y, disc, lamps)
    return seen


def _shaded(x: Array, y: Array, disc: Disc, lamps: Lamps) -> Array:
    """Return the share of light left beside a disc: lamps it hides, and the sky that its wall hides."""
    hidden = np.zeros_like(x)
    shifts = lamps.parts[:, :2] * disc.thickness / lamps.parts[:, 2:]
    distance = np.hypot(x, y)
    reached = distance < disc.size + np.linalg.norm(shifts, axis=1).max()
    gap = np.abs(distance - disc.size)
    x, y, distance = x[reached], y[reached], distance[reached]
    for dx, dy in shifts:
        along = np.clip(-(x * dx + y * dy) / max(dx * dx + dy * dy, 1e-12), 0, 1)
        near = np.hypot(x + along * dx, y + along * dy)
        dark = near < disc.size
        if disc.hole:
            dark &= np.maximum(distance, np.hypot(x + dx, y + dy)) >= disc.hole
        hidden[reached] += dark / len(lamps.parts)
    # A long wall hides half the sky at its foot, and gives back what the metal mirrors of the table.
    sky = 1 - 0.5 * (1 - disc.metal) * (1 - gap / np.hypot(gap, disc.thickness))
    return lamps.direct * (1 - hidden) + (1 - lamps.direct) * sky


def _texture(kind: str, x: Array, y: Array, rng: Rng) -> Array:
    rough = {s: rng.normal(0, 1, x.shape) for s in (1.5, 4.0, 12.0)}
    turn = rng.uniform(0, math.pi)
    weave = rng.uniform(25, 60)
    grain, thread, line = rng.uniform(0.08, 0.25), rng.uniform(0.08, 0.2), rng.uniform(0.2, 0.6)
    names = ("wood", "cloth", "stone", "lined") if kind in ("texture", "no coin") else ("paper",)
    name = str(rng.choice(names))

    def noise(s: float) -> Array:
        return cv2.GaussianBlur(rough[s], (0, 0), s) * s * 3.5

    u, v = x * math.cos(turn) + y * math.sin(turn), y * math.cos(turn) - x * math.sin(turn)
    if name == "paper":
        seen = 1 + 0.02 * noise(1.5) + 0.01 * noise(12.0)
    elif name == "wood":
        slow = noise(12.0)
        seen = 1 + grain * np.sin(9 * v + 0.6 * np.sin(1.3 * u) + 0.5 * slow)
        seen = seen + 0.06 * np.sin(47 * v + 0.8 * slow) + 0.04 * noise(1.5)
    elif name == "cloth":
        seen = 1 + thread * np.sin(weave * u) * np.sin(weave * v) + 0.05 * noise(1.5)
    elif name == "stone":
        seen = 1 + 0.08 * noise(1.5) + 0.08 * noise(4.0) + 0.05 * noise(12.0)
    else:
        seen = 1 + 0.01 * noise(1.5) - line * (np.abs((v * 2) % 1 - 0.5) < 0.02)
    return np.clip(seen, 0.05, 2)


def _with_neighbours(light: Array, kind: str, points: Array, rng: Rng) -> Array:
    """Return the picture with what lies beside the disc: a finger, a card, a contact on the prism."""
    x, y = points[:2]
    turn = rng.uniform(0, 2 * math.pi)
    u, v = x * math.cos(turn) + y * math.sin(turn), y * math.cos(turn) - x * math.sin(turn)
    if kind == "touching a finger":
        width, lean = rng.uniform(0.55, 0.8), rng.uniform(-0.3, 0.3)
        tip = 1 + width - rng.uniform(0.0, 0.06)
        away = np.hypot(np.minimum(u - tip, 0), v - lean * np.maximum(u - tip, 0)) / width
        skin = rng.uniform(0.25, 0.6) * (0.45 + 0.55 * np.sqrt(np.maximum(1 - away**2, 0)))
        ridged = 1 + 0.05 * np.sin(45 * (np.hypot(u - tip, v)))
        return np.where((away < 1) & (np.hypot(x, y) > 1.0), skin * ridged, light)
    if kind == "touching an edge":
        card = rng.choice([rng.uniform(0.05, 0.15), rng.uniform(0.7, 0.95)])
        ticks = np.where((np.abs((v * 6) % 1 - 0.5) < 0.08) & (u < 1.25), 0.3, 1.0)
        return np.where(u > 1 + rng.uniform(-0.01, 0.02), card * ticks, light)
    if kind == "a square":
        side = rng.uniform(0.6, 0.9)
        return np.where(np.maximum(np.abs(u), np.abs(v)) < side, rng.uniform(0.3, 0.6), light)
    if kind == "washer on a prism":
        along, across = rng.uniform(0.8, 1.2), rng.uniform(0.6, 0.9)
        far = np.hypot((u - 1.25 - along) / along, v / across)
        ridges = np.sin(38 * (v + 0.3 * np.sin(1.5 * u))) > rng.uniform(-0.4, 0.2)
        dark = float(np.median(light)) > 0.25
        contact = light * 0.25 if dark else light + 0.35
        wet = np.where((far < 1) & ridges, contact, light)
        ghost = rng.uniform(0.02, 0.08)
        shift = int(rng.integers(6, 18))
        return (1 - ghost) * wet + ghost * np.roll(wet, shift, axis=1)
    return light


def _exposed(light: Array, kind: str, rng: Rng) -> Pixels:
    """Return the photograph: lens, sensor, noise, sRGB's curve and JPEG."""
    lens = cv2.GaussianBlur(light, (0, 0), rng.uniform(0.5, 1.5) * OVERSAMPLING)
    small = cv2.resize(lens, SHAPE[::-1], interpolation=cv2.INTER_AREA)
    level = rng.uniform(0.65, 0.9) / float(np.quantile(small, 0.97))
    exposed = small * level
    grain = rng.uniform(0.002, 0.02)
    exposed = exposed + rng.normal(0, 1, SHAPE) * grain * np.sqrt(np.maximum(exposed, 0) + 0.05)
    coded = np.clip(exposed, 0, 1) ** (1 / 2.2)
    if kind == "washer on a prism" and rng.random() < 0.5:
        coded = np.clip(exposed, 0, 1)  # a machine-vision camera is linear
    return eight_bit(coded, int(rng.integers(60, 96)))
