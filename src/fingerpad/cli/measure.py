"""Commands that measure pictures."""

import itertools
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from fingerpad._files import make_folder
from fingerpad._json import dumps
from fingerpad.cli.shared import AsJson, Exit, plain_errors, print_json, print_record, print_text
from fingerpad.exceptions import CalibrationError, FingerpadError, ImageError

if TYPE_CHECKING:
    from fingerpad.image import Picture, Scale

app = typer.Typer(help="Measure pictures.", no_args_is_help=True)

Ppi: TypeAlias = Annotated[float | None, typer.Option(help="Scale, pixels per inch.")]
MmPerPx: TypeAlias = Annotated[float | None, typer.Option(help="Scale, millimetres per pixel.")]
ScaleStd: TypeAlias = Annotated[float, typer.Option(help="Relative standard uncertainty of the scale.")]
Overlay: TypeAlias = Annotated[Path | None, typer.Option(help="Folder for pictures of the measurement.")]
DarkOnLight: TypeAlias = Annotated[
    bool | None,
    typer.Option("--dark-on-light/--light-on-dark", help="Polarity, where it is not found by itself."),
]
Background: TypeAlias = Annotated[
    Path | None, typer.Option(help="Picture of the empty platen, which is divided out.")
]
Roi: TypeAlias = Annotated[
    str | None, typer.Option(metavar="R0,C0,R1,C1", help="Rows and columns of the part to look at, px.")
]


@app.command("print")
def measure_print(
    images: Annotated[list[Path], typer.Argument(help="Contact images.", show_default=False)],
    ppi: Ppi = None,
    mm_per_px: MmPerPx = None,
    scale_relative_std: ScaleStd = 0.0,
    dark_on_light: DarkOnLight = None,
    background: Background = None,
    seed_px: Annotated[
        str | None, typer.Option(metavar="ROW,COLUMN", help="A point inside the contact that is meant, px.")
    ] = None,
    roi: Roi = None,
    overlay: Overlay = None,
    as_json: AsJson = False,
) -> None:
    """Measure the contact region and its ellipse in fingerprint images.

    Without --ppi or --mm-per-px the scale is the one that each file states.
    """
    from fingerpad.image import measure_imprint, read_image, write_overlay

    with plain_errors():
        given = _scale(ppi, mm_per_px, scale_relative_std)
        ground = None if background is None else read_image(background).pixels
        seed, window = _numbers("--seed-px", seed_px, 2), _numbers("--roi", roi, 4)
        overlays = _overlay_files(images, overlay)

    def measured(path: Path) -> dict[str, Any]:
        picture = read_image(path)
        imprint = measure_imprint(
            picture.pixels,
            given or _stated_scale(path, picture),
            dark_on_light=dark_on_light,
            background=ground,
            seed=None if seed is None else (seed[0], seed[1]),
            region_of_interest=None if window is None else tuple(map(int, window)),  # type: ignore[arg-type]
        )
        if path in overlays:
            write_overlay(overlays[path], picture.pixels, imprint)
        return imprint.as_record()

    _print_all(images, measured, as_json)


@app.command("photo")
def measure_photo(
    image: Annotated[Path, typer.Argument(help="Photograph of one face.", show_default=False)],
    face: Annotated[
        str, typer.Option(help="Face that looks at the camera: palmar, distal, radial or ulnar.")
    ],
    ppi: Ppi = None,
    mm_per_px: MmPerPx = None,
    scale_relative_std: ScaleStd = 0.0,
    tip: Annotated[str, typer.Option(help="Where the fingertip points: up, down, left or right.")] = "up",
    palmar: Annotated[
        str | None, typer.Option(help="Where the palmar side lies, in views that show it; down by default.")
    ] = None,
    roi: Roi = None,
    points: Annotated[
        Path | None,
        typer.Option(help="CSV of points on the pad's outline, with the header row_px,column_px."),
    ] = None,
    overlay: Overlay = None,
    as_json: AsJson = False,
) -> None:
    """Measure two semi-axes of the pad in a photograph of a finger before a plain backdrop."""
    from fingerpad.image import (
        FACE_AXES,
        measure_photograph,
        read_colour_image,
        read_marks,
        write_photograph_overlay,
    )

    with plain_errors():
        if face not in FACE_AXES:
            raise ImageError(f"--face must be one of {', '.join(FACE_AXES)}, found {face!r}")
        for flag, side in (("--tip", tip), ("--palmar", palmar)):
            if side not in {"up", "down", "left", "right", None}:
                raise ImageError(f"{flag} must be up, down, left or right, found {side!r}")
        scale = _scale(ppi, mm_per_px, scale_relative_std)
        if scale is None:
            raise CalibrationError("photographs need a scale: give either --ppi or --mm-per-px")
        window = _numbers("--roi", roi, 4)
        marks = None if points is None else read_marks(points)
        overlays = _overlay_files([image], overlay)

    def measured(path: Path) -> dict[str, Any]:
        pixels = read_colour_image(path)
        found = measure_photograph(
            pixels,
            face,  # type: ignore[arg-type]
            scale,
            tip=tip,  # type: ignore[arg-type]
            palmar=palmar,  # type: ignore[arg-type]
            region_of_interest=None if window is None else (window[0], window[1], window[2], window[3]),
            points=marks,
        )
        if path in overlays:
            write_photograph_overlay(overlays[path], pixels, found)
        return {
            "semi_axes_mm": found.semi_axes_mm,
            "semi_axes_mm_std": found.semi_axes_mm_std,
            "arc_deg": found.arc_deg,
            "outlier_fraction": found.outlier_fraction,
            "flags": sorted(found.flags),
        }

    record = _record(image, measured)
    print_record(record, as_json)
    if "error" in record:
        raise typer.Exit(Exit.SOME_FAILED)


@app.command("sequence")
def measure_frames(
    path: Annotated[Path, typer.Argument(help="Folder, TIFF or video.", show_default=False)],
    ppi: Ppi = None,
    mm_per_px: MmPerPx = None,
    scale_relative_std: ScaleStd = 0.0,
    force: Annotated[Path | None, typer.Option(help="CSV with time_s,force_N.")] = None,
    fps: Annotated[float | None, typer.Option(help="Frames per second, as they were taken.")] = None,
    start_s: Annotated[
        float | None, typer.Option(help="Time of the first frame on the force's clock, s.")
    ] = None,
    contact_load: Annotated[
        float | None,
        typer.Option(help="Load, N, that the force passes in the first-contact frame: aligns the two."),
    ] = None,
    times: Annotated[Path | None, typer.Option(help="CSV of the frames' own times, time_s.")] = None,
    dark_on_light: DarkOnLight = None,
    background: Background = None,
    overlay: Overlay = None,
    as_json: AsJson = False,
) -> None:
    """Measure the contact in every frame of a sequence, against time and force.

    The frames' clock starts at the trigger that the force signal holds, at --start-s, or where the force
    passes --contact-load; without any of them, at the force's own start. --times gives each frame its time.
    """
    from rich.console import Console
    from rich.progress import track

    from fingerpad.image import (
        measure_sequence,
        open_frames,
        read_force_signal,
        read_frame_stamps,
        read_image,
        sequence_summary,
        write_overlay,
    )

    with plain_errors():
        scale = _scale(ppi, mm_per_px, scale_relative_std)
        if scale is None:
            raise CalibrationError("a sequence needs a scale: give either --ppi or --mm-per-px")
        frames = open_frames(path)
        signal = None if force is None else read_force_signal(force)
        clock = (
            read_frame_stamps(times)
            if times
            else _clock(frames.frames_per_second if fps is None else fps, signal, start_s, contact_load)
        )
        if overlay is not None:
            make_folder(overlay)

        def draw(index: int, pixels: Any, imprint: Any) -> None:
            if overlay is not None:
                write_overlay(overlay / f"frame_{index:06d}.png", pixels, imprint, label=f"frame {index}")

        results = measure_sequence(
            frames,
            scale,
            clock=clock,
            force=signal,
            dark_on_light=dark_on_light,
            background=None if background is None else read_image(background).pixels,
            watch=draw,
        )
        shown = track(results, "Measuring", total=len(frames), console=Console(stderr=True), transient=True)
        summary = sequence_summary(_printed(shown, as_json), signal)
    for note in summary.notes:
        typer.echo(f"note: {note}", err=True)
    if summary.failed:
        raise typer.Exit(Exit.SOME_FAILED)


def _printed(results: Iterable[Any], as_json: bool) -> Iterator[Any]:
    """Print each frame as it comes, and hand it on: a sequence may be longer than memory."""
    opening = "["
    for result in results:
        if as_json:
            typer.echo(f"{opening}{dumps(result.as_record())}", nl=False)
            opening = ",\n"
        else:
            record = result.as_record()
            area = record.get("gross_area_mm2")
            seen = record.get("error") if area is None else f"{area:.1f} mm²"
            typer.echo(
                f"frame {result.index}: {result.time:.4f} s, {result.load:.3f} N, {result.phase}, {seen}"
            )
        yield result
    if as_json:
        typer.echo("[]" if opening == "[" else "]")


def _clock(fps: float | None, signal: Any, start_s: float | None, contact_load: float | None) -> Any:
    """Return the frames' clock, or None where no rate is known."""
    from fingerpad.image import FrameRate

    if fps is None:
        return None
    if signal is not None and contact_load is not None:
        return FrameRate.of_contact(fps, signal, contact_load)
    if start_s is None and signal is not None and signal.trigger is not None:
        return FrameRate.of_trigger(fps, signal)
    start = signal.span[0] if start_s is None and signal is not None else start_s or 0.0
    return FrameRate.of(fps, anchor_time=start)


def _scale(ppi: float | None, mm_per_px: float | None, relative_std: float) -> "Scale | None":
    """Return the scale that was given, None for none."""
    from fingerpad.image import Scale

    if ppi is not None and mm_per_px is not None:
        raise CalibrationError("give either --ppi or --mm-per-px, not both")
    if ppi is not None:
        return Scale.of_ppi(ppi, ppi * relative_std)
    return None if mm_per_px is None else Scale.of_mm_per_px(mm_per_px, mm_per_px * relative_std)


def _stated_scale(path: Path, picture: "Picture") -> "Scale":
    from fingerpad.image import Scale

    try:
        return Scale.of_picture(picture)
    except CalibrationError as error:
        raise CalibrationError(f"{path}: give either --ppi or --mm-per-px ({error})") from error


def _numbers(flag: str, text: str | None, count: int) -> list[float] | None:
    """Return the numbers of a flag such as "250,200"."""
    if text is None:
        return None
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != count:
        raise ImageError(f"{flag} takes {count} numbers parted by commas, found {text!r}")
    return numbers


def _record(path: Path, measured: Callable[[Path], dict[str, Any]]) -> dict[str, Any]:
    """Measure one picture; one that cannot be measured costs itself only."""
    try:
        return {"file": str(path), **measured(path)}
    except FingerpadError as error:
        return {"file": str(path), "error": str(error)}


def _print_all(images: list[Path], measured: Callable[[Path], dict[str, Any]], as_json: bool) -> None:
    """Measure and print each picture."""
    records = [_record(path, measured) for path in images]
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
    make_folder(folder)
    files: dict[Path, Path] = {}
    taken = {path.resolve() for path in images}
    for path in images:
        names = (f"{path.stem}_overlay{number}.png" for number in itertools.chain([""], itertools.count(2)))
        files[path] = next(folder / name for name in names if (folder / name).resolve() not in taken)
        taken.add(files[path].resolve())
    return files
