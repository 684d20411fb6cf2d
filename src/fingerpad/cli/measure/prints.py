"""Measure contact images."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fingerpad.cli.measure.flags import Overlay, contact_options
from fingerpad.cli.measure.records import (
    overlay_files,
    print_flags,
    print_if_exact,
    printed,
    record_of,
    tracked,
)
from fingerpad.cli.measure.scale import WAYS, scale_of_flags
from fingerpad.cli.shared import AsJson, Exit, print_folder, print_text, takes
from fingerpad.exceptions import CalibrationError

if TYPE_CHECKING:
    from fingerpad.image import ContactImageOptions, Picture, Scale


@takes(options=contact_options, scale=scale_of_flags)
def measure_prints(
    *,
    images: Annotated[list[Path], typer.Argument(help="Contact images.", show_default=False)],
    options: "ContactImageOptions",
    overlay_dir: Overlay = None,
    as_json: AsJson = False,
    scale: "Scale | None",
) -> None:
    """Measure the contact region and its ellipse in fingerprint images.

    Without a scale it is the one that each file states. gross_area is that within the outline,
    ridge_area that of the ridges in it; ellipse_iou says how well the ellipse fits the region, 1 being best.
    Contacts without ridges, of silicone or a gel, take --surface smooth; what concerns ridges is then empty.
    """
    from fingerpad.image import measure_contact_image, read_colour_image, read_image, write_overlay

    overlays = overlay_files(images, overlay_dir)

    def measured(path: Path) -> dict[str, Any]:
        picture = read_image(path)
        used = scale or _stated_scale(path, picture)
        pixels = read_colour_image(path) if options["surface"] == "smooth" else picture.pixels
        contact_image = measure_contact_image(pixels, used, **options)
        if path in overlays:
            write_overlay(overlays[path], picture.pixels, contact_image)
        return {
            "mm_per_px": used.mm_per_px,
            "mm_per_px_std": used.mm_per_px_std,
            "scale_from": "option" if scale else "file",
            **contact_image.as_record(),
        }

    def print_block(record: dict[str, Any]) -> None:
        print_text(record)
        print_if_exact(record.get("mm_per_px_std"))
        print_flags(record, "contact", "scale")
        typer.echo()

    records = (record_of(path, measured) for path in tracked(images, len(images)))
    failed = ["error" in record for record in printed(records, as_json, dict, print_block)]
    print_folder("Overlays", overlay_dir, as_json)
    if any(failed):
        raise typer.Exit(Exit.SOME_FAILED)


def _stated_scale(path: Path, picture: "Picture") -> "Scale":
    from fingerpad.image import Scale

    try:
        return Scale.of_picture(picture)
    except CalibrationError as error:
        raise CalibrationError(f"{path}: give {WAYS} ({error})") from error
