"""Studies to start from: a commented manifest, and a small synthetic study that runs as it is."""

import json
from importlib.resources import files
from pathlib import Path
from typing import Final

import numpy as np
from PIL import Image

from fingerpad._files import check_new, explain_write_errors
from fingerpad.contact import Tissue, equivalent_radius_from_compliance, hertz_contact
from fingerpad.exceptions import ManifestError
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.image import FACE_AXES, Face
from fingerpad.simulate import render_contact_image, render_finger, simulate_loading_curve
from fingerpad.simulate.loading_curve import save_curve
from fingerpad.study.manifest.load import STUDY_NAME
from fingerpad.study.manifest.models import Study

SCHEMA_NAME = "study.schema.json"


def write_template(folder: Path) -> Path:
    """Write ``study.toml`` and its JSON schema into a folder and return the manifest's path."""
    return write_manifest(folder, _text_of("template.toml"))


def _text_of(file: str) -> str:
    return files("fingerpad.study.editing").joinpath(file).read_text(encoding="utf-8")


def write_manifest(folder: Path, text: str) -> Path:
    """Write a manifest and its schema into a folder, overwriting nothing; errors as for `write_template`."""
    content = manifest_files(text)
    with explain_write_errors(folder, error=ManifestError):
        folder.mkdir(parents=True, exist_ok=True)
        for path in (folder / name for name in content):
            if path.exists():
                raise ManifestError(f"{path}: is there already; name another folder")
        for name, lines in content.items():
            with (folder / name).open("x", encoding="utf-8") as file:
                file.write(lines)
    return folder / STUDY_NAME


def manifest_files(text: str) -> dict[str, str]:
    """Return a manifest that begins with the line of its JSON schema, and the schema, by file name."""
    return {SCHEMA_NAME: manifest_schema(), STUDY_NAME: f"#:schema ./{SCHEMA_NAME}\n{text}"}


def manifest_schema() -> str:
    """Return the JSON schema of a manifest."""
    return json.dumps(Study.model_json_schema(), indent=1, ensure_ascii=False) + "\n"


# As ``example.toml`` states them.
_PAD: Final = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
_FACES: Final[tuple[Face, ...]] = ("palmar", "distal", "radial")
_LOADS: Final = (0.5, 1.0, 2.0)


def write_example(folder: Path) -> Path:
    """Write a small synthetic study into a new or empty folder and return its manifest's path."""
    check_new(folder)
    manifest = write_manifest(folder, _text_of("example.toml"))
    for seed, face in enumerate(_FACES):
        across, along = (float(getattr(_PAD, axis)) for axis in FACE_AXES[face])
        photograph = render_finger(face, semi_axes=(across, along), mm_per_px=0.1, seed=seed)
        Image.fromarray(photograph.pixels).save(folder / f"photograph_{face}.jpg", quality=92)
    placement = Placement(_PAD, wedge_angle=np.radians(30))
    for seed, load in enumerate(_LOADS):
        contact = hertz_contact(placement, Tissue.of_reduced_modulus(0.09), load=load)
        image = render_contact_image(
            semi_major=float(contact.semi_major),
            semi_minor=float(contact.semi_minor),
            orientation=0.0 if contact.along else np.pi / 2,
            ppi=500,
            seed=seed,
        )
        Image.fromarray(image.pixels).save(folder / f"contact_{load:g}N.png")
    radius = placement.curvature.geometric_mean_radius
    loading = simulate_loading_curve(
        loading_radius=float(equivalent_radius_from_compliance(radius, 1 / contact.aspect_ratio)),
        initial_modulus=0.07,
        load_coefficient=0.005,
        contact_offset=0.4,
        force_std=0.005,
        displacement_std=0.005,
        area_std=1.0,
        points=300,
        seed=1,
    )
    save_curve(folder / "loading_curve.csv", loading)
    return manifest
