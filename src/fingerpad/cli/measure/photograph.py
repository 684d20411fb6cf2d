"""Measure photographs of a finger's faces."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fingerpad.cli.measure.flags import Overlay, Roi, region_of
from fingerpad.cli.measure.records import overlay_files, print_flags, print_if_exact, record_of
from fingerpad.cli.measure.scale import WAYS, scale_of_flags
from fingerpad.cli.shared import AsJson, Exit, print_folder, print_record, takes
from fingerpad.exceptions import CalibrationError, ImageError

if TYPE_CHECKING:
    from fingerpad.image import Scale


@takes(scale=scale_of_flags)
def measure_photo(
    *,
    image: Annotated[Path, typer.Argument(help="Photograph of one face.", show_default=False)],
    face: Annotated[
        str, typer.Option(help="Face that looks at the camera: palmar, distal, radial or ulnar.")
    ],
    tip: Annotated[str, typer.Option(help="Where the fingertip points: up, down, left or right.")] = "up",
    palmar: Annotated[
        str | None, typer.Option(help="Where the palmar side lies, in views that show it; down by default.")
    ] = None,
    roi_px: Roi = None,
    points: Annotated[
        Path | None,
        typer.Option(help="CSV of points on the pad's outline, with the header row_px,column_px."),
    ] = None,
    overlay_dir: Overlay = None,
    as_json: AsJson = False,
    scale: "Scale | None",
) -> None:
    """Measure two semi-axes of the pad in a photograph of a finger before a plain backdrop."""
    from fingerpad.image import (
        FACE_AXES,
        measure_photograph,
        read_colour_image,
        read_marks,
        write_photograph_overlay,
    )

    if face not in FACE_AXES:
        raise ImageError(f"--face must be one of {', '.join(FACE_AXES)}, found {face!r}")
    for flag, side in (("--tip", tip), ("--palmar", palmar)):
        if side not in {"up", "down", "left", "right", None}:
            raise ImageError(f"{flag} must be up, down, left or right, found {side!r}")
    if scale is None:
        raise CalibrationError(f"photographs need a scale: give {WAYS}")
    window = region_of(roi_px)
    marks = None if points is None else read_marks(points)
    overlays = overlay_files([image], overlay_dir)

    def measured(path: Path) -> dict[str, Any]:
        pixels = read_colour_image(path)
        found = measure_photograph(
            pixels,
            face,  # type: ignore[arg-type]
            scale,
            tip=tip,  # type: ignore[arg-type]
            palmar=palmar,  # type: ignore[arg-type]
            region_of_interest=window,
            points=marks,
        )
        if path in overlays:
            write_photograph_overlay(overlays[path], pixels, found)
        return {
            "semi_axes_mm": found.semi_axes_mm,
            "semi_axes_mm_std": found.semi_axes_mm_std,
            "uncertainty_mm_std": found.uncertainty_mm_std,
            "arc_deg": found.arc_deg,
            "exponent": found.exponent,
            "exponent_std": found.exponent_std,
            "radii": found.side_radii(),
            "outlier_fraction": found.outlier_fraction,
            "flags": sorted(found.flags),
        }

    record = record_of(image, measured)
    # By term it would fill the screen.
    print_record(
        record if as_json else {k: v for k, v in record.items() if k != "uncertainty_mm_std"}, as_json
    )
    if not as_json:
        print_if_exact(None if "error" in record else scale.mm_per_px_std)
        print_flags(record, "photograph", "scale")
    print_folder("Overlays", overlay_dir, as_json)
    if "error" in record:
        raise typer.Exit(Exit.SOME_FAILED)
