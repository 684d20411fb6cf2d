"""Commands that measure pictures."""

import itertools
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from fingerpad._files import make_folder
from fingerpad.cli.shared import AsJson, Exit, plain_errors, print_json, print_text
from fingerpad.exceptions import CalibrationError, FingerpadError

if TYPE_CHECKING:
    from fingerpad.image import Scale

app = typer.Typer(help="Measure pictures.", no_args_is_help=True)


@app.command("print")
def measure_print(
    images: Annotated[list[Path], typer.Argument(help="Contact images.", show_default=False)],
    ppi: Annotated[float | None, typer.Option(help="Scale, pixels per inch.")] = None,
    mm_per_px: Annotated[float | None, typer.Option(help="Scale, millimetres per pixel.")] = None,
    overlay: Annotated[Path | None, typer.Option(help="Folder for pictures of the measurement.")] = None,
    as_json: AsJson = False,
) -> None:
    """Measure the contact region and its ellipse in fingerprint images."""
    from fingerpad.image import Scale

    with plain_errors():
        if (ppi is None) == (mm_per_px is None):
            raise CalibrationError("the pictures need a scale: give either --ppi or --mm-per-px")
        scale = Scale.of_ppi(ppi) if ppi is not None else Scale.of_mm_per_px(mm_per_px or 0.0)
        if overlay is not None:
            make_folder(overlay)
    overlays = _overlay_files(images, overlay)
    records = [_measured_print(path, scale, overlays.get(path)) for path in images]
    if as_json:
        print_json(records)
    else:
        for record in records:
            print_text(record)
            typer.echo()
    if any("error" in record for record in records):
        raise typer.Exit(Exit.SOME_FAILED)


def _overlay_files(images: list[Path], folder: Path | None) -> dict[Path, Path]:
    """Return a file for each picture's overlay: no two the same, and none of them a picture to measure."""
    if folder is None:
        return {}
    files: dict[Path, Path] = {}
    taken = {path.resolve() for path in images}
    for path in images:
        names = (f"{path.stem}_overlay{number}.png" for number in itertools.chain([""], itertools.count(2)))
        files[path] = next(folder / name for name in names if (folder / name).resolve() not in taken)
        taken.add(files[path].resolve())
    return files


def _measured_print(path: Path, scale: "Scale", overlay: Path | None) -> dict[str, Any]:
    from fingerpad.image import measure_imprint, read_image, write_overlay

    try:
        pixels = read_image(path).pixels
        imprint = measure_imprint(pixels, scale)
        if overlay is not None:
            write_overlay(overlay, pixels, imprint)
    except FingerpadError as error:
        return {"file": str(path), "error": str(error)}
    return {
        "file": str(path),
        "semi_major_mm": imprint.ellipse.semi_major,
        "semi_major_mm_std": imprint.semi_major_std,
        "semi_minor_mm": imprint.ellipse.semi_minor,
        "semi_minor_mm_std": imprint.semi_minor_std,
        "orientation_deg": np.degrees(imprint.orientation),
        "gross_area_mm2": imprint.gross_area,
        "gross_area_mm2_std": imprint.gross_area_std,
        "ridge_area_mm2": imprint.ridge_area,
        "ridge_area_mm2_std": imprint.ridge_area_std,
        "ridge_period_mm": imprint.ridge_period,
        "ellipse_overlap": imprint.overlap,
        "centroid_px": imprint.centroid,
        "flags": imprint.flags,
    }
