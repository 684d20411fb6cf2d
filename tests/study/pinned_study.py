"""The study whose numbers are pinned: each kind of measurement, of drawn and rendered pictures."""

import shutil
from pathlib import Path

import cv2
import numpy as np
from PIL import Image
from tests.studies import correct, curve, finger, picture, sequence, write_study

from fingerpad.simulate import render_coin

DEMO = Path(__file__).parents[2] / "examples" / "dzidek2017" / "synthetic"
SCALES = {
    "camera": {"mm_per_px": 0.05, "relative_std": 0.002},
    "reader": {"ppi": 500},
    "coin": {"coin": "coin.png", "diameter_mm": 20},
    "board": {"grid": "board.png", "points": [5, 6], "spacing_mm": 2},
}
OBSERVATIONS = {"contact": "reader", "corrected": "reader", "by_coin": "coin", "by_grid": "board"}
THICK = {"effective_thickness_mm": 7.9, "effective_thickness_mm_std": 1.1}
IMAGE, FORCE = "synthetic_30deg_2N.png", "synthetic_press_30deg_force.csv"
CORRECTION = {"region_of_interest_px": [60, 60, 420, 330]}


def make_pinned(folder: Path) -> Path:
    """Write the study and what it measures; return its manifest."""
    shutil.copytree(DEMO, folder, dirs_exist_ok=True)
    Image.fromarray(render_coin(seed=1).pixels).save(folder / "coin.png")
    board = 60 + 120 * np.pad(
        np.kron(np.indices((6, 7)).sum(axis=0) % 2, np.ones((40, 40))), 40, constant_values=1
    )
    cv2.imwrite(str(folder / "board.png"), cv2.GaussianBlur(board, (0, 0), 1.2).astype(np.uint8))
    # A picture that is given twice would count once.
    for level, name in enumerate(OBSERVATIONS):
        Image.open(folder / IMAGE).save(folder / f"{name}.png", compress_level=1 + level)
    drawn = {"finger": "pad", "synthetic": True}
    photographs = [
        {"face": face, "file": f"photograph_{face}.jpg", "scale": "camera", "synthetic": True}
        for face in ("palmar", "distal")
    ]
    press = {"scale": {"ppi": 240, "relative_std": 0.002}, "frames_per_second": 20}
    manifest = write_study(
        folder,
        finger("pad", photographs=photographs, synthetic=True, **THICK),
        sequence("press", "synthetic_press_30deg.tif", force=FORCE, **press, **drawn),
        curve(file="curve_30deg_2mm_per_s.csv", **drawn),
        *(picture(name, f"{name}.png", scale=scale, **drawn) for name, scale in OBSERVATIONS.items()),
        title="Pinned numbers",
        uncertainty={"wedge_angle_deg_std": 0.5, "load_relative_std": 0.01},
        scales=SCALES,
    )
    correct(folder, "corrected", CORRECTION)
    return manifest
