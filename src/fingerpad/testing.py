"""Synthetic measurements of known truth, as files: what a laboratory needs to test its own scripts.

Each function writes files as an experiment would leave them, labelled synthetic, and returns where they are
and what is true. A test reads the files, by fingerpad or by a script of its own, and compares.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image, PngImagePlugin

from fingerpad._files import check_new
from fingerpad.contact import Tissue, hertz_contact
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.simulate import render_contact_image, simulate_loading_curve
from fingerpad.simulate.loading_curve import save_curve

__all__ = ["Synthetic", "write_contact_image", "write_loading_curve", "write_study"]

_PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
_FINGER = """[[fingers]]
name = "synthetic_pad"
synthetic = true
semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }
semi_axes_mm_std = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }"""
_AREA_STD, _STAGE_STD, _FORCE_STD = 0.5, 0.003, 0.003


@dataclass(frozen=True, slots=True, kw_only=True)
class Synthetic:
    """A file or a study folder that was simulated, and its truth.

    Attributes
    ----------
    path : Path
        The file, or the manifest of the study.
    truth : mapping of str to float
        True values, by the names of columns of `results.csv` or of values of a fit, with their units.

    Examples
    --------
    >>> Synthetic(path=Path("contact.png"), truth={"gross_area_mm2": 116.2}).truth["gross_area_mm2"]
    116.2
    """

    path: Path
    truth: Mapping[str, float]


def write_contact_image(
    path: str | Path, *, semi_major: float = 7.4, semi_minor: float = 5.0, ppi: float = 500.0, seed: int = 0
) -> Synthetic:
    """Write a rendered contact image as PNG, with its scale and the word synthetic in the file.

    Parameters
    ----------
    path : str or Path
        The file to be written.
    semi_major, semi_minor : float
        Semi-axes of the contact, mm; the major one points up.
    ppi : float
        Pixels per inch.
    seed : int
        Of ridges and noise.

    Returns
    -------
    Synthetic
        The file, with true areas, semi-axes, orientation and scale.

    Raises
    ------
    GeometryError
        If a length is not positive, or the semi-axes are not sorted.

    Examples
    --------
    >>> import tempfile
    >>> import fingerpad as fp
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     image = write_contact_image(Path(folder) / "contact.png", semi_major=5.0, semi_minor=4.0)
    ...     found = fp.measure_contact_image(image.path, fp.Scale.of_ppi(500))
    >>> bool(abs(found.gross_area - image.truth["gross_area_mm2"]) < 3 * found.gross_area_std)
    True
    """
    return _write_image(Path(path), semi_major, semi_minor, ppi=ppi, seed=seed)


def _write_image(
    path: Path, semi_major: float, semi_minor: float, *, ppi: float, seed: int, orientation: float = 0.0
) -> Synthetic:
    render = render_contact_image(
        semi_major=semi_major, semi_minor=semi_minor, orientation=orientation, ppi=ppi, seed=seed
    )
    words = PngImagePlugin.PngInfo()
    words.add_text("Description", "synthetic: rendered by fingerpad.testing")
    Image.fromarray(render.pixels).save(path, dpi=(ppi, ppi), pnginfo=words)
    truth = {
        "gross_area_mm2": render.gross_area,
        "ridge_area_mm2": render.ridge_area,
        "semi_major_mm": semi_major,
        "semi_minor_mm": semi_minor,
        "orientation_deg": float(np.degrees(render.orientation)),
        "mm_per_px": render.mm_per_px,
    }
    return Synthetic(path=path, truth=truth)


def write_loading_curve(
    path: str | Path,
    *,
    loading_radius: float = 15.0,
    youngs_modulus: float = 0.05,
    contact_offset: float = 1.0,
    top_load: float = 2.0,
    seed: int = 0,
) -> Synthetic:
    """Write the record of a pad that obeys Hertz theory as CSV: time, force, displacement and area.

    Parameters
    ----------
    path : str or Path
        The file to be written.
    loading_radius : float
        R_g, mm.
    youngs_modulus : float
        E for ν = 0.5, MPa.
    contact_offset : float
        Reading of the displacement at first contact, mm.
    top_load : float
        Load at the end, N.
    seed : int
        Of the noise.

    Returns
    -------
    Synthetic
        The file, with R_g, E and the place of contact.

    Raises
    ------
    LoadingError
        If the pad or the load is impossible.

    Examples
    --------
    >>> import tempfile
    >>> import fingerpad as fp
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     curve = write_loading_curve(Path(folder) / "curve.csv")
    ...     record = fp.read_loading_curve(curve.path)
    >>> len(record.load), curve.truth["loading_radius_mm"]
    (300, 15.0)
    """
    record = simulate_loading_curve(
        loading_radius=loading_radius,
        initial_modulus=youngs_modulus,
        load_coefficient=0.0,
        contact_offset=contact_offset,
        top_load=top_load,
        points=300,
        force_std=_FORCE_STD,
        displacement_std=_STAGE_STD,
        area_std=_AREA_STD,
        seed=seed,
    )
    save_curve(Path(path), record)
    truth = {
        "loading_radius_mm": loading_radius,
        "youngs_modulus_kpa": 1000 * youngs_modulus,
        "contact_offset_mm": contact_offset,
    }
    return Synthetic(path=Path(path), truth=truth)


def write_study(
    folder: str | Path,
    *,
    loads: Sequence[float] = (0.25, 0.5, 1.0),
    youngs_modulus: float = 0.1,
    wedge_angle: float = np.pi / 6,
    seed: int = 0,
) -> Synthetic:
    """Write a small study: a pad with given semi-axes, a contact image for each load, and a loading curve.

    Contacts are those of elliptical Hertz theory, so that its modulus is the truth.

    Parameters
    ----------
    folder : str or Path
        A new or empty folder.
    loads : sequence of float
        Load of each contact, N.
    youngs_modulus : float
        E for ν = 0.5, MPa.
    wedge_angle : float
        Of the wedge, radians.
    seed : int
        Of ridges and noise.

    Returns
    -------
    Synthetic
        The manifest, with E, 1/H, and the area of each contact as ``contact_0.5N.gross_area_mm2``.

    Raises
    ------
    ManifestError
        If the folder holds anything already.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     study = write_study(folder)
    ...     sorted(file.name for file in study.path.parent.iterdir())
    ['contact_0.25N.png', 'contact_0.5N.png', 'contact_1N.png', 'curve.csv', 'study.toml']
    """
    folder = Path(folder)
    check_new(folder)
    folder.mkdir(parents=True, exist_ok=True)
    place = Placement(_PAD, wedge_angle=wedge_angle)
    radius = float(place.curvature.mean_curvature_radius)
    truth = {"youngs_modulus_kpa": 1000 * youngs_modulus, "mean_curvature_radius_mm": radius}
    where = f'finger = "synthetic_pad"\nwedge_angle_deg = {np.degrees(wedge_angle):g}\nsynthetic = true\n'
    tables = [
        'title = "Synthetic study for tests"',
        "[scales.reader]\nppi = 500",
        "[uncertainty]\nwedge_angle_deg_std = 0.5\nroll_angle_deg_std = 0.5",
        _FINGER,
    ]
    for number, load in enumerate(loads):
        contact = hertz_contact(place, Tissue(youngs_modulus), load=load)
        name = f"contact_{load:g}N"
        image = _write_image(
            folder / f"{name}.png",
            float(contact.semi_major),
            float(contact.semi_minor),
            ppi=500,
            seed=seed + number,
            orientation=0.0 if contact.along else np.pi / 2,
        )
        truth[f"{name}.gross_area_mm2"] = image.truth["gross_area_mm2"]
        seen = f'name = "{name}"\n{where}load_N = {load:g}\nfile = "{name}.png"\nscale = "reader"'
        tables.append(f"[[observations]]\n{seen}")
    write_loading_curve(
        folder / "curve.csv",
        loading_radius=radius,
        youngs_modulus=youngs_modulus,
        top_load=max(loads),
        seed=seed,
    )
    tables.append(f'[[curves]]\n{where}file = "curve.csv"')
    manifest = folder / "study.toml"
    manifest.write_text("\n\n".join(tables) + "\n", encoding="utf-8")
    return Synthetic(path=manifest, truth=truth)
