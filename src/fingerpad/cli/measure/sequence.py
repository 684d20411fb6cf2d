"""Measure the frames of a sequence."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fingerpad._files import make_folder
from fingerpad._rounding import value_with_uncertainty
from fingerpad.cli.measure.flags import Overlay, contact_options
from fingerpad.cli.measure.records import print_if_exact, printed, tracked
from fingerpad.cli.measure.scale import WAYS, scale_of_flags
from fingerpad.cli.shared import (
    AsJson,
    Columns,
    Exit,
    column_flags,
    columns_of,
    print_folder,
    print_note,
    takes,
)
from fingerpad.exceptions import CalibrationError, LoadingError

if TYPE_CHECKING:
    from fingerpad.image import ContactImageOptions, ForceSignal, FrameClock, FrameResult, Scale


@takes(options=contact_options, scale=scale_of_flags)
def measure_frames(
    *,
    path: Annotated[Path, typer.Argument(help="Folder, TIFF or video.", show_default=False)],
    force: Annotated[Path | None, typer.Option(help="CSV, XLSX, MAT or TDMS with time_s,force_N.")] = None,
    column: Columns = None,
    frames_per_second: Annotated[
        float | None, typer.Option(min=1e-6, help="Frames per second, as they were taken.")
    ] = None,
    start_s: Annotated[
        float | None, typer.Option(help="Time of the first frame on the force's clock, s.")
    ] = None,
    contact_load_n: Annotated[
        float | None,
        typer.Option(help="Load, N, that the force passes in the first-contact frame: aligns the two."),
    ] = None,
    times: Annotated[Path | None, typer.Option(help="CSV of the frames' own times, time_s.")] = None,
    options: "ContactImageOptions",
    overlay_dir: Overlay = None,
    as_json: AsJson = False,
    scale: "Scale | None",
) -> None:
    """Measure the contact in every frame of a sequence, against time and force.

    The frames' clock starts at the trigger that the force signal holds, at --start-s, or where the force
    passes --contact-load-n; without any of them, at the force's own start. --times gives each frame its time.

    Contacts without ridges, of silicone or a gel, take --surface smooth; the first frame, before touch, is
    the background where none is given.
    """
    from fingerpad._columns import columns_named_by, unread_notes
    from fingerpad.image import (
        FrameResult,
        measure_sequence,
        open_frames,
        read_force_signal,
        sequence_summary,
        write_overlay,
    )
    from fingerpad.image.sequence.force import unread_force_columns

    if scale is None:
        raise CalibrationError(f"a sequence needs a scale: give {WAYS}")
    frames = open_frames(path)
    columns = columns_of(column, "time", "force", "trigger", "displacement")
    if columns and force is None:
        raise LoadingError("--column names columns of --force: give it too")
    with columns_named_by(column_flags):
        signal = None if force is None else read_force_signal(force, columns)
    clock = _clock(frames.frames_per_second, frames_per_second, signal, start_s, contact_load_n, times)
    unread = {} if force is None else unread_force_columns(force, columns)
    for note in unread_notes(unread, lambda name, column: f": {column_flags({name: column})}"):
        print_note(note)
    if overlay_dir is not None:
        make_folder(overlay_dir)

    def draw(index: int, pixels: Any, contact_image: Any) -> None:
        if overlay_dir is not None:
            write_overlay(
                overlay_dir / f"frame_{index:06d}.png", pixels, contact_image, label=f"frame {index}"
            )

    results = measure_sequence(
        frames,
        scale,
        clock=clock,
        force=signal,
        watch=draw,
        **options,
    )
    shown = printed(tracked(results, len(frames)), as_json, FrameResult.as_record, _print_frame)
    summary = sequence_summary(shown, signal)
    if not as_json:
        print_if_exact(scale.mm_per_px_std)
    print_folder("Overlays", overlay_dir, as_json)
    for note in summary.notes:
        print_note(note)
    if summary.failed:
        raise typer.Exit(Exit.SOME_FAILED)


def _print_frame(result: "FrameResult") -> None:
    record = result.as_record()
    area = record.get("gross_area_mm2")
    seen = (
        record.get("error")
        if area is None
        else f"{value_with_uncertainty(area, record['gross_area_mm2_std'])} mm²"
    )
    typer.echo(f"frame {result.index}: {result.time:.4f} s, {result.load:.3f} N, {result.phase}, {seen}")


def _clock(
    played: float | None,
    frames_per_second: float | None,
    signal: "ForceSignal | None",
    start_s: float | None,
    contact_load: float | None,
    times: Path | None,
) -> "FrameClock | None":
    """Return the frames' clock, or None where no rate is known."""
    from fingerpad.image import frame_clock, read_frame_stamps

    aligned = {
        "--frames-per-second": frames_per_second,
        "--start-s": start_s,
        "--contact-load-n": contact_load,
    }
    idle = [flag for flag, value in aligned.items() if value is not None]
    if times is not None:
        if idle:
            raise LoadingError(f"--times gives each frame its time: there is no use for {idle[0]} beside it")
        return read_frame_stamps(times)
    rate = played if frames_per_second is None else frames_per_second
    if rate is None:
        if signal is not None:
            raise LoadingError("--force needs the times of the frames: give --frames-per-second or --times")
        return None
    return frame_clock(rate, signal, start_time=start_s, contact_load=contact_load)
