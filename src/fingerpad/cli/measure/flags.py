"""Flags shared by measuring commands, and their parsing."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Literal, TypeAlias

import typer

from fingerpad.cli.shared import require_positive
from fingerpad.exceptions import ImageError

if TYPE_CHECKING:
    from fingerpad._arrays import FloatArray
    from fingerpad.image import ContactImageOptions

# No picture has so many rows or columns; NaN is not below it.
_MOST_PX: Final = 1e9

Overlay: TypeAlias = Annotated[Path | None, typer.Option(help="Folder for pictures of the measurement.")]
Roi: TypeAlias = Annotated[
    str | None, typer.Option(metavar="R0,C0,R1,C1", help="Rows and columns of the part to look at, px.")
]


def numbers_of(flag: str, text: str, count: int) -> list[float]:
    """Return the numbers of a flag such as "250,200"."""
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(abs(number) < _MOST_PX for number in numbers):
        raise ImageError(f"{flag} takes {count} numbers of pixels separated by commas, found {text!r}")
    return numbers


def region_of(text: str | None) -> tuple[int, int, int, int] | None:
    """Return the region of interest, in whole pixels."""
    if text is None:
        return None
    row, column, last_row, last_column = map(round, numbers_of("--roi-px", text, 4))
    return row, column, last_row, last_column


def contact_options(
    *,
    dark_on_light: Annotated[
        bool | None,
        typer.Option(
            "--dark-on-light/--light-on-dark", help="Polarity, where it is not detected automatically."
        ),
    ] = None,
    background: Annotated[
        Path | None, typer.Option(help="Picture of the empty platen, which is divided out.")
    ] = None,
    surface: Annotated[
        Literal["ridged", "smooth"],
        typer.Option(help="Whether the contact has ridges, or none, as of a silicone fingertip."),
    ] = "ridged",
    seed_px: Annotated[
        str | None, typer.Option(metavar="ROW,COLUMN", help="A point inside the contact that is meant, px.")
    ] = None,
    threshold: Annotated[
        float | None,
        typer.Option(
            min=1e-6, max=65535, help="Grey levels from background to ridge, instead of half the contrast."
        ),
    ] = None,
    mask: Annotated[
        Path | None,
        typer.Option(help="CSV of corners round the contact, with the header row_px,column_px."),
    ] = None,
    roi_px: Roi = None,
) -> "ContactImageOptions":
    """Return how a contact image is measured."""
    from fingerpad.image import read_colour_image, read_image

    require_positive("--threshold", threshold)
    seed = None if seed_px is None else numbers_of("--seed-px", seed_px, 2)
    ground = None
    if background is not None:
        ground = read_colour_image(background) if surface == "smooth" else read_image(background).pixels
    return {
        "background": ground,
        "seed": None if seed is None else (seed[0], seed[1]),
        "mask": None if mask is None else _corners(mask),
        "region_of_interest": region_of(roi_px),
        "dark_on_light": dark_on_light,
        "threshold": threshold,
        "surface": surface,
    }


def _corners(path: Path) -> "FloatArray":
    from fingerpad.image import read_marks

    corners = read_marks(path)
    if len(corners) < 3:
        raise ImageError(f"{path}: a mask needs three corners or more, found {len(corners)}")
    return corners
