"""A study of smooth contacts: one picture, and a press of a silicone fingertip that grows as Hertz says."""

import math
from pathlib import Path

import cv2
import numpy as np
from PIL import Image
from tests.studies import finger, picture, sequence, write_study

MM_PER_PX = 0.04
SEMI_AXES_PX = (62.0, 47.0)
LOADS = (0.0, 0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 2.0, 2.0, 0.0)


def area_at(load: float) -> float:
    """Return the true area, mm²: that at 2 N times W^(2/3) of Hertz."""
    return math.pi * math.prod(SEMI_AXES_PX) * MM_PER_PX**2 * (load / 2) ** (2 / 3)


def frame(load: float, seed: int, colour: bool = False) -> np.ndarray:
    """Return a frame: a bright ellipse under uneven light with a streak of reflection over its edge.

    One of another colour is as bright as what lies around it.
    """
    rows, columns = np.mgrid[:200, :220].astype(float)
    fine = np.zeros((1600, 1760), np.uint8)
    axes = [round(axis * (load / 2) ** (1 / 3) * 8 * 16) for axis in SEMI_AXES_PX]
    if load:
        cv2.ellipse(fine, (110 * 128, 100 * 128), axes, 20, 0, 360, 255, -1, shift=4)
    inside = cv2.GaussianBlur(cv2.resize(fine, (220, 200), interpolation=cv2.INTER_AREA) / 255, (0, 0), 1.2)
    light = 1 - 0.4 * ((rows - 70) ** 2 + (columns - 140) ** 2) / 200**2
    shine = cv2.GaussianBlur(cv2.line(np.zeros_like(light), (140, 40), (175, 95), 110, 6), (0, 0), 1.5)
    noise = np.random.default_rng(seed).normal(0, 1.5, light.shape)
    level = light * (60 + 90 * inside * (not colour)) + shine + noise
    if colour:  # red in place of green, as much as leaves the luma
        level = level[..., None] + 120 * (light * inside)[..., None] * [0.587, -0.299, 0.0]
    return level.round().clip(0, 255).astype(np.uint8)


def make_smooth_study(folder: Path, surface: str | None = "smooth", *, colour: bool = False) -> Path:
    """Write the study, and return its manifest."""
    (folder / "frames").mkdir(parents=True)
    for number, load in enumerate(LOADS):
        Image.fromarray(frame(load, number, colour)).save(folder / "frames" / f"{number:03d}.png")
    for name, load in (("contact", 2.0), ("empty", 0.0)):
        Image.fromarray(frame(load, 100)).save(folder / f"{name}.png")
    rows = [f"{number / 20},{load}" for number, load in enumerate(LOADS)]
    (folder / "force.csv").write_text("\n".join(["time_s,force_N", *rows]) + "\n")
    scale = {"mm_per_px": MM_PER_PX, "relative_std": 0.0}
    return write_study(
        folder,
        finger(),
        picture("contact", "contact.png", 2.0, background="empty.png", scale=scale),
        sequence("press", "frames", scale=scale, force="force.csv", frames_per_second=20, start_s=0),
        title="Smooth",
        **({"surface": surface} if surface else {}),
    )
