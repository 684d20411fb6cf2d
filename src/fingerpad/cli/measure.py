"""Commands that measure pictures: contact images, photographs of a finger, sequences of frames."""

import itertools
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Final, Literal, TypeAlias, TypeVar

import typer
from typer import Argument, Option

from fingerpad import image
from fingerpad._files import make_folder
from fingerpad._json import dumps
from fingerpad._rounding import value_with_uncertainty
from fingerpad.cli import options, show
from fingerpad.cli.commands import Exit, Group
from fingerpad.cli.scale import WAYS, numbers_of, scale_of_flags
from fingerpad.exceptions import CalibrationError, ImageError, LoadingError, reason_of
from fingerpad.flags import Flagged

Item = TypeVar("Item")
Side: TypeAlias = Literal["up", "down", "left", "right"]
Overlay: TypeAlias = Annotated[Path | None, Option(help="Folder for pictures of the measurement.")]
Roi: TypeAlias = Annotated[
    str | None, Option(metavar="R0,C0,R1,C1", help="Rows and columns of the part to look at, px.")
]

# The quantity of --column that is the time in the table of --times.
_FRAME_TIME: Final = "frame_time"
_EXACT: Final = "scale taken as exact"

app = typer.Typer(cls=Group, rich_markup_mode=None, help="Measure pictures.", no_args_is_help=True)


def contact_options(
    *,
    dark_on_light: Annotated[
        bool | None,
        Option("--dark-on-light/--light-on-dark", help="Polarity, where it is not detected automatically."),
    ] = None,
    background: Annotated[
        Path | None, Option(help="Picture of the empty platen, which is divided out.")
    ] = None,
    surface: Annotated[
        Literal["ridged", "smooth"],
        Option(help="Whether the contact has ridges, or none, as of a silicone fingertip."),
    ] = "ridged",
    seed_px: Annotated[
        str | None, Option(metavar="ROW,COLUMN", help="A point inside the contact that is meant, px.")
    ] = None,
    threshold: Annotated[
        float | None,
        options.positive(
            "Grey levels from background to ridge, instead of half the contrast.", min=1e-6, max=65535
        ),
    ] = None,
    mask: Annotated[
        Path | None, Option(help="CSV of corners round the contact, with the header row_px,column_px.")
    ] = None,
    roi_px: Roi = None,
) -> "image.ContactImageOptions":
    """Return how a contact image is measured."""
    seed = None if seed_px is None else numbers_of("--seed-px", seed_px, 2)
    ground = None
    if background is not None:
        ground = image.read_image(background, colour=surface == "smooth").pixels
    corners = None if mask is None else image.read_marks(mask)
    if corners is not None and len(corners) < 3:
        raise ImageError(f"{mask}: a mask needs three corners or more, found {len(corners)}")
    return {
        "background": ground,
        "seed": None if seed is None else (seed[0], seed[1]),
        "mask": corners,
        "region_of_interest": _region_of(roi_px),
        "dark_on_light": dark_on_light,
        "threshold": threshold,
        "surface": surface,
    }


def _region_of(text: str | None) -> tuple[int, int, int, int] | None:
    """Return the region of interest, in whole pixels."""
    if text is None:
        return None
    row, column, last_row, last_column = map(round, numbers_of("--roi-px", text, 4))
    return row, column, last_row, last_column


@app.command("print")
@options.takes(settings=contact_options, scale=scale_of_flags)
def measure_prints(
    *,
    images: Annotated[list[Path], Argument(help="Contact images.", show_default=False)],
    settings: "image.ContactImageOptions",
    overlay_dir: Overlay = None,
    as_json: options.AsJson = False,
    scale: "image.Scale | None",
) -> None:
    """Measure the contact region and its ellipse in fingerprint images.

    Without a scale it is the one that each file states. gross_area is that within the outline,
    ridge_area that of the ridges in it; ellipse_iou says how well the ellipse fits the region, 1 being best.
    Contacts without ridges, of silicone or a gel, take --surface smooth; what concerns ridges is then empty.
    """
    from fingerpad.image.scale import other_resolution

    overlays = _overlay_files(images, overlay_dir)

    def measured(path: Path) -> dict[str, Any]:
        picture = image.read_image(path, colour=settings["surface"] == "smooth")
        used = scale or _stated_scale(path, picture)
        if words := other_resolution(picture.dots_per_inch, used.mm_per_px):
            show.note(f"{path}: the file {words}")
        contact_image = image.measure_contact_image(picture.pixels, used, **settings)
        if path in overlays:
            image.write_overlay(overlays[path], picture.pixels, contact_image)
        return {
            "mm_per_px": used.mm_per_px,
            "mm_per_px_std": used.mm_per_px_std,
            "scale_from": "option" if scale else "file",
            **contact_image.as_record(),
        }

    def print_block(record: dict[str, Any]) -> None:
        _print_measured(record, "contact", record.get("mm_per_px_std"))
        typer.echo()

    records = (_record_of(path, measured) for path in _tracked(images, len(images)))
    failed = ["error" in record for record in _printed(records, as_json, dict, print_block)]
    show.folder("Overlays", overlay_dir, as_json)
    if any(failed):
        raise typer.Exit(Exit.SOME_FAILED)


def _stated_scale(path: Path, picture: "image.Picture") -> "image.Scale":
    try:
        return image.Scale.of_picture(picture)
    except CalibrationError as error:
        raise CalibrationError(f"{path}: give {WAYS} ({error})") from error


@app.command("photo")
@options.takes(scale=scale_of_flags)
def measure_photo(
    *,
    file: Annotated[Path, Argument(metavar="image", help="Photograph of one face.", show_default=False)],
    face: Annotated[
        Literal["palmar", "distal", "radial", "ulnar"], Option(help="Face that looks at the camera.")
    ],
    tip: Annotated[Side, Option(help="Where the fingertip points.")] = "up",
    palmar: Annotated[
        Side | None, Option(help="Where the palmar side lies, in views that show it; down by default.")
    ] = None,
    roi_px: Roi = None,
    points: Annotated[
        Path | None, Option(help="CSV of points on the pad's outline, with the header row_px,column_px.")
    ] = None,
    overlay_dir: Overlay = None,
    as_json: options.AsJson = False,
    scale: "image.Scale | None",
) -> None:
    """Measure two semi-axes of the pad in a photograph of a finger before a plain backdrop."""
    if scale is None:
        raise CalibrationError(f"photographs need a scale: give {WAYS}")
    window = _region_of(roi_px)
    marks = None if points is None else image.read_marks(points)
    overlays = _overlay_files([file], overlay_dir)

    def measured(path: Path) -> dict[str, Any]:
        pixels = image.read_image(path, colour=True).pixels
        found = image.measure_photograph(
            pixels, face, scale, tip=tip, palmar=palmar, region_of_interest=window, points=marks
        )
        if path in overlays:
            image.write_overlay(overlays[path], pixels, found)
        return found.as_record()

    record = _record_of(file, measured)
    std = None if "error" in record else scale.mm_per_px_std
    show.result(record, as_json, lambda _: _print_measured(record, "photograph", std))
    show.folder("Overlays", overlay_dir, as_json)
    if "error" in record:
        raise typer.Exit(Exit.SOME_FAILED)


@app.command("sequence")
@options.takes(settings=contact_options, scale=scale_of_flags)
def measure_frames(
    *,
    path: Annotated[Path, Argument(help="Folder, TIFF or video.", show_default=False)],
    force: Annotated[Path | None, Option(help="CSV, XLSX, MAT or TDMS with time_s,force_N.")] = None,
    column: options.Columns = None,
    frames_per_second: Annotated[
        float | None, Option(min=1e-6, help="Frames per second, as they were taken.")
    ] = None,
    start_s: Annotated[float | None, Option(help="Time of the first frame on the force's clock, s.")] = None,
    contact_load_n: Annotated[
        float | None,
        Option(help="Load, N, that the force passes in the first-contact frame: aligns the two."),
    ] = None,
    times: Annotated[Path | None, Option(help="CSV of the frames' own times, time_s.")] = None,
    settings: "image.ContactImageOptions",
    overlay_dir: Overlay = None,
    as_json: options.AsJson = False,
    scale: "image.Scale | None",
) -> None:
    """Measure the contact in every frame of a sequence, against time and force.

    The frames' clock starts at the trigger that the force signal holds, at --start-s, or where the force
    passes --contact-load-n; without any of them, at the force's own start. --times gives each frame its time,
    in a column time_s or as --column frame_time=NAME:UNIT says.

    Contacts without ridges, of silicone or a gel, take --surface smooth; the first frame, before touch, is
    the background where none is given.
    """
    from fingerpad._columns import columns_named_by
    from fingerpad.image.sequence.force import unread_force_columns

    if scale is None:
        raise CalibrationError(f"a sequence needs a scale: give {WAYS}")
    frames = image.open_frames(path)
    columns = options.columns_of(column, "time", "force", "trigger", "displacement", _FRAME_TIME)
    frame_time = columns.pop(_FRAME_TIME, None)
    if columns and force is None:
        raise LoadingError("--column names columns of --force: give it too")
    with columns_named_by(options.column_flags):
        signal = None if force is None else image.read_force_signal(force, columns)
    aligned = {"start_s": start_s, "contact_load_n": contact_load_n}
    clock = _clock(frames, signal, times, frame_time, frames_per_second=frames_per_second, **aligned)
    options.note_unread({} if force is None else unread_force_columns(force, columns))
    if overlay_dir is not None:
        make_folder(overlay_dir)

    def draw(index: int, pixels: Any, contact_image: Any) -> None:
        if overlay_dir is not None:
            file = overlay_dir / f"frame_{index:06d}.png"
            image.write_overlay(file, pixels, contact_image, label=f"frame {index}")

    results = image.measure_sequence(frames, scale, clock=clock, force=signal, watch=draw, **settings)
    shown = _printed(_tracked(results, len(frames)), as_json, image.FrameResult.as_record, _print_frame)
    summary = image.sequence_summary(shown, signal, frames=frames, clock=clock)
    if not as_json and scale.mm_per_px_std == 0:
        typer.echo(_EXACT)
    show.folder("Overlays", overlay_dir, as_json)
    for note in summary.notes:
        show.note(note)
    if summary.failed:
        raise typer.Exit(Exit.SOME_FAILED)


def _print_frame(result: "image.FrameResult") -> None:
    record = result.as_record()
    seen, area = record.get("error"), record.get("gross_area_mm2")
    if area is not None:
        seen = f"{value_with_uncertainty(area, record['gross_area_mm2_std'])} mm²"
    typer.echo(f"frame {result.index}: {result.time:.4f} s, {result.load:z.3f} N, {result.phase}, {seen}")


def _clock(
    frames: "image.Frames",
    signal: "image.ForceSignal | None",
    times: Path | None,
    frame_time: str | None,
    **aligned: float | None,
) -> "image.FrameClock | None":
    """Return the frames' clock, or None where no rate is known; --times has no use for what is `aligned`."""
    from fingerpad._columns import columns_named_by
    from fingerpad.image.sequence.frames import played_rate

    idle = [f"--{name.replace('_', '-')}" for name, value in aligned.items() if value is not None]
    if times is not None:
        if idle:
            raise LoadingError(f"--times gives each frame its time: there is no use for {idle[0]} beside it")
        with columns_named_by(lambda found: options.column_flags({_FRAME_TIME: found["time"]})):
            return image.read_frame_stamps(times, None if frame_time is None else {"time": frame_time})
    if frame_time is not None:
        raise LoadingError(f"--column {_FRAME_TIME}=NAME:UNIT names the column of --times: give it too")
    start, load, rate = (aligned[name] for name in ("start_s", "contact_load_n", "frames_per_second"))
    if rate is None:
        rate = frames.frames_per_second
        if rate is not None and signal is not None:
            show.note(played_rate(frames))
    if rate is not None:
        return image.frame_clock(rate, signal, start_time=start, contact_load=load, numbers=frames.numbers)
    if signal is not None:
        raise LoadingError("--force needs the times of the frames: give --frames-per-second or --times")
    return None


def _record_of(path: Path, measured: Callable[[Path], dict[str, Any]]) -> dict[str, Any]:
    """Measure one picture; one that cannot be measured costs itself only."""
    try:
        return {"file": str(path), **measured(path)}
    except Exception as error:  # a picture can be damaged in unforeseen ways
        return {"file": str(path), "error": reason_of(error, f"{path}: cannot be measured")}


def _printed(
    results: Iterable[Item],
    as_json: bool,
    record_of_result: Callable[[Item], Mapping[str, Any]],
    print_one: Callable[[Item], None],
) -> Iterator[Item]:
    """Print each result at once, and yield it: a later error loses none."""
    opening = "["
    try:
        for result in results:
            if as_json:
                typer.echo(f"{opening}{dumps(record_of_result(result))}", nl=False)
                opening = ",\n"
            else:
                print_one(result)
            yield result
    except (Exception, KeyboardInterrupt):
        if opening != "[":
            typer.echo("]")
        raise
    if as_json:
        typer.echo("[]" if opening == "[" else "]")


def _tracked(items: Iterable[Item], count: int) -> Iterator[Item]:
    """Yield items, with a progress bar on stderr if that is a terminal and there are several.

    Where results are printed to a person as they come, a bar would only stand in between.
    """
    if count < 2 or sys.stdout.isatty() or not sys.stderr.isatty():
        yield from items
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True, redirect_stdout=False) as bar:
        yield from bar.track(items, total=count, description="Measuring")


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


def _print_measured(record: Mapping[str, Any], kind: Flagged, mm_per_px_std: float | None) -> None:
    """Print a record, whether its scale is exact, and what its flags mean."""
    # The uncertainty by its terms would fill the screen.
    show.text({key: value for key, value in record.items() if key != "uncertainty_mm_std"})
    if mm_per_px_std == 0:
        typer.echo(_EXACT)
    show.flags(record, kind, "scale")
