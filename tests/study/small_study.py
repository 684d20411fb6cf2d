"""A small study of pictures, a photograph and a sequence, quick to measure, for what can happen to a run."""

import shutil
from pathlib import Path

import numpy as np
from PIL import Image
from tests.studies import finger, picture, sequence, write_study

from fingerpad.simulate import render_contact_image, render_finger, render_sequence
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.measuring import sequences
from fingerpad.study.pipeline import run_study

PPI = 240
PICTURES = 5
FRAMES = 24
PIECE = 5
# Loading to frame 9, hold to 13, unloading; empty at either end.
LOAD = np.interp(np.arange(FRAMES), [2, 9, 13, 21], [0, 2, 2, 0])


def make(folder: Path) -> Path:
    """Render the study's inputs, write its manifest, and return the manifest."""
    (folder / "frames").mkdir(parents=True, exist_ok=True)
    for number in range(PICTURES):
        truth = render_contact_image(semi_major=4.0 + 0.2 * number, semi_minor=3.2, ppi=PPI, seed=number)
        Image.fromarray(truth.pixels).save(folder / f"o{number}.png")
    press = render_sequence(LOAD, radii=(14.3, 13.0), reduced_modulus=0.09, ppi=PPI, seed=5)
    for k in range(FRAMES):
        Image.fromarray(press.pixels(k)).save(folder / "frames" / f"f{k}.png")
    for face in ("palmar", "distal"):
        drawn = render_finger(face, mm_per_px=0.1, seed=3)
        Image.fromarray(drawn.pixels).save(folder / f"{face}.jpg", quality=92)
    rows = "\n".join(f"{k / 20},{load}" for k, load in enumerate(LOAD))
    (folder / "force.csv").write_text(f"time_s,force_N\n{rows}\n")
    as_drawn = {"scale": {"ppi": PPI}, "synthetic": True}
    photographs = [
        {"face": face, "file": f"{face}.jpg", "scale": {"mm_per_px": 0.1}, "synthetic": True}
        for face in ("palmar", "distal")
    ]
    return write_study(
        folder,
        finger("f"),
        finger("g", photographs=photographs),
        *(picture(f"o{k}", f"o{k}.png", 1.0 + k, **as_drawn) for k in range(PICTURES)),
        sequence("p", "frames", force="force.csv", frames_per_second=20, **as_drawn),
        # Angles known so well that few random draws check the uncertainty.
        uncertainty={"wedge_angle_deg_std": 0.5},
    )


def make_of_tiff(small_study: Path, folder: Path) -> None:
    """Copy the study with its sequence as a TIFF."""
    manifest = copy(small_study, folder)
    manifest.write_text(manifest.read_text().replace('"frames"', '"stack.tif"'))
    pages = [Image.open(folder / "frames" / f"f{k}.png") for k in range(FRAMES)]
    pages[0].save(folder / "stack.tif", save_all=True, append_images=pages[1:])


def copy(made: Path, folder: Path) -> Path:
    """Copy a study, and return the copy's manifest."""
    return Path(shutil.copytree(made.parent, folder)) / "study.toml"


def copy_unfinished(run: Path, folder: Path, *missing: str) -> Path:
    """Copy a study with its results but for the tasks whose names begin so, and return the manifest."""
    manifest = copy(run, folder)
    with Store.writing(folder / "out" / STORE_NAME) as store:
        store.discard([name for name in store.statuses() if name.startswith(missing)])
    return manifest


def run_here(manifest: Path, out: Path, workers: int = 1) -> None:
    """Run a study: what a process that is going to be killed does."""
    sequences._LEAST_PIECE = PIECE
    run_study(manifest, out, workers=workers)
