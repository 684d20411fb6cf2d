"""Render the synthetic part of this study from known truth: ``python examples/dzidek2017/render.py``.

A Hertzian pad with the semi-axes of Table 1 in Dzidek et al. (2017), ellipse method, is pressed against the
platen; contact images, photographs of its faces and a sequence of one press are rendered with noise. Its
loading curves are those of a viscoelastic sphere of the same A/(πξ) that stiffens with load.
``synthetic/truth.csv`` and ``synthetic/synthetic_press_30deg_truth.csv`` hold the truth of the pictures.
"""

import csv
from pathlib import Path

import numpy as np
from PIL import Image

from fingerpad.contact import Contact, Tissue, hertz_contact
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.simulate import render_contact_image, render_finger, render_sequence, simulate_loading_curve

FOLDER = Path(__file__).parent / "synthetic"
PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
REDUCED_MODULUS = 0.09
LOADS = {30: (0.25, 0.5, 1.0, 2.0, 4.0), 45: (0.5, 1.0, 2.0, 4.0)}
LOOKS = {30: "livescan", 45: "ink"}
PPI = 500.0
MM_PER_PX = 0.05
SEQUENCE_PPI = 240.0
FRAMES_PER_SECOND, FRAMES = 20.0, 24
RATES, HELD_RATE = (0.2, 2.0, 10.0), 2.0


def main() -> None:
    """Write images, photographs, curves, sequence and truth."""
    FOLDER.mkdir(exist_ok=True)
    truth = [row for wedge in LOADS for row in render_images(wedge)]
    with (FOLDER / "truth.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, fieldnames=truth[0])
        table.writeheader()
        table.writerows(truth)
    render_photographs()
    render_curves(30)
    render_press(30)


def hertz(wedge: float, load: float) -> Contact:
    """Return the contact between the pad on its wedge and the platen."""
    placement = Placement(PAD, wedge_angle=np.radians(wedge))
    return hertz_contact(placement, Tissue.of_reduced_modulus(REDUCED_MODULUS), load=load)


def render_images(wedge: int) -> list[dict[str, object]]:
    """Render a contact image for each load and return the truth about it."""
    rows = []
    for number, load in enumerate(LOADS[wedge]):
        contact = hertz(wedge, load)
        picture = render_contact_image(
            semi_major=float(contact.semi_major),
            semi_minor=float(contact.semi_minor),
            orientation=0.0 if contact.along else np.pi / 2,
            ppi=PPI,
            look=LOOKS[wedge],
            seed=100 * wedge + number,
        )
        name = f"synthetic_{wedge}deg_{load:g}N"
        Image.fromarray(picture.pixels).save(FOLDER / f"{name}.png", optimize=True)
        rows.append(
            {
                "observation": name,
                "semi_major_mm": round(float(contact.semi_major), 6),
                "semi_minor_mm": round(float(contact.semi_minor), 6),
                "area_mm2": round(float(contact.area), 6),
                "indentation_mm": round(float(contact.indentation), 6),
                "reduced_modulus_kpa": 1e3 * REDUCED_MODULUS,
            }
        )
    return rows


def render_photographs() -> None:
    """Render a photograph of three faces."""
    axes = {"palmar": (11.8, 13.8), "distal": (11.8, 7.9), "radial": (7.9, 13.8)}
    for seed, (face, semi_axes) in enumerate(axes.items(), start=11):
        photograph = render_finger(face, semi_axes=semi_axes, mm_per_px=MM_PER_PX, seed=seed)
        Image.fromarray(photograph.pixels).save(FOLDER / f"photograph_{face}.jpg", quality=92)


def render_curves(wedge: int) -> None:
    """Simulate presses at three velocities, of a pad that is viscoelastic and stiffens with load."""
    radius = float(hertz(wedge, 1.0).area_over_pi_indentation)
    for seed, rate in enumerate(RATES, start=7):
        curve = simulate_loading_curve(
            loading_radius=radius,
            initial_modulus=0.070,
            load_coefficient=0.005,
            relaxation=((0.12, 0.3), (0.10, 3.0)),
            rate=rate,
            hold=12.0 if rate == HELD_RATE else 0.0,
            unloading=True,
            points=700 if rate == HELD_RATE else 300,
            contact_offset=0.4,
            force_std=0.005,
            correlation_time=0.02,
            displacement_std=0.005,
            area_std=1.0,
            force_offset=0.02,
            force_tilt=0.002,
            seed=seed,
        )
        columns = np.stack([curve.time, curve.load, curve.indentation, curve.area], axis=-1)
        headers = ("time_s", "force_N", "displacement_mm", "area_mm2")
        write(f"curve_{wedge}deg_{rate:g}mm_per_s.csv", headers, columns)


def render_press(wedge: int) -> None:
    """Render a press to 2 N, a hold and the release, with a force whose trigger starts the camera."""
    knots, loads = (0.06, 0.55, 0.75, 1.12), (0.0, 2.0, 2.0, 0.0)
    time = np.arange(FRAMES) / FRAMES_PER_SECOND
    load = np.interp(time, knots, loads)
    # The contact is longest along the larger radius, here across the finger; the renderer draws that upright.
    radii = Placement(PAD, wedge_angle=np.radians(wedge)).curvature.principal_radii
    press = render_sequence(
        load,
        radii=(float(max(radii)), float(min(radii))),
        reduced_modulus=REDUCED_MODULUS,
        ppi=SEQUENCE_PPI,
        noise_std=2.0,
        seed=17,
    )
    name = f"synthetic_press_{wedge}deg"
    first, *others = (Image.fromarray(np.rot90(press.pixels(k))) for k in range(FRAMES))
    first.save(FOLDER / f"{name}.tif", save_all=True, append_images=others, compression="tiff_adobe_deflate")
    axes = np.stack([time, load, press.semi_major, press.semi_minor, press.gross_area], axis=-1)
    write(f"{name}_truth.csv", ("time_s", "load_N", "semi_major_mm", "semi_minor_mm", "gross_area_mm2"), axes)
    clock = np.arange(-0.1, 1.3, 0.01)
    force = np.interp(clock, knots, loads) + np.random.default_rng(8).normal(0, 0.003, clock.size)
    # The trigger rises between two samples, through half of its range at time 0.
    trigger = np.clip(2.5 + 500 * clock, 0, 5)
    write(f"{name}_force.csv", ("time_s", "force_N", "trigger_V"), np.stack([clock, force, trigger], axis=-1))


def write(name: str, header: tuple[str, ...], rows: np.ndarray) -> None:
    """Write a table of numbers."""
    with (FOLDER / name).open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(header)
        table.writerows([f"{value:.4f}" for value in row] for row in rows)


if __name__ == "__main__":
    main()
