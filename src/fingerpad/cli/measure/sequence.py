"""Measure the frames of a sequence."""

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fingerpad._files import make_folder
from fingerpad._json import dumps
from fingerpad.cli.measure.flags import (
    Background,
    DarkOnLight,
    Mask,
    Overlay,
    Roi,
    Seed,
    Threshold,
    measurement_region,
)
from fingerpad.cli.measure.records import tracked
from fingerpad.cli.measure.scale import WAYS, takes_scale
from fingerpad.cli.shared import AsJson, Exit, plain_errors, require_positive
from fingerpad.exceptions import CalibrationError, LoadingError

if TYPE_CHECKING:
    from fingerpad.image import ForceSignal, FrameClock, FrameResult, Scale


@takes_scale
def measure_frames(
    *,
    path: Annotated[Path, typer.Argument(help="Folder, TIFF or video.", show_default=False)],
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
    seed_px: Seed = None,
    threshold: Threshold = None,
    mask: Mask = None,
    roi: Roi = None,
    overlay: Overlay = None,
    as_json: AsJson = False,
    scale: "Scale | None",
) -> None:
    """Measure the contact in every frame of a sequence, against time and force.

    The frames' clock starts at the trigger that the force signal holds, at --start-s, or where the force
    passes --contact-load; without any of them, at the force's own start. --times gives each frame its time.
    """
    from fingerpad.image import (
        measure_sequence,
        open_frames,
        read_force_signal,
        sequence_summary,
        write_overlay,
    )

    with plain_errors():
        if scale is None:
            raise CalibrationError(f"a sequence needs a scale: give {WAYS}")
        require_positive("--threshold", threshold)
        frames = open_frames(path)
        signal = None if force is None else read_force_signal(force)
        clock = _clock(frames.frames_per_second, fps, signal, start_s, contact_load, times)
        place = measurement_region(background, seed_px, mask, roi)
        if overlay is not None:
            make_folder(overlay)

        def draw(index: int, pixels: Any, contact_image: Any) -> None:
            if overlay is not None:
                write_overlay(
                    overlay / f"frame_{index:06d}.png", pixels, contact_image, label=f"frame {index}"
                )

        results = measure_sequence(
            frames,
            scale,
            clock=clock,
            force=signal,
            dark_on_light=dark_on_light,
            threshold=threshold,
            watch=draw,
            **place,
        )
        # Where frames are printed to a person as they come, a bar would only stand in between.
        shown = results if sys.stdout.isatty() else tracked(results, len(frames))
        summary = sequence_summary(_printed(shown, as_json), signal)
    for note in summary.notes:
        typer.echo(f"note: {note}", err=True)
    if summary.failed:
        raise typer.Exit(Exit.SOME_FAILED)


def _printed(results: "Iterable[FrameResult]", as_json: bool) -> "Iterator[FrameResult]":
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


def _clock(
    played: float | None,
    fps: float | None,
    signal: "ForceSignal | None",
    start_s: float | None,
    contact_load: float | None,
    times: Path | None,
) -> "FrameClock | None":
    """Return the frames' clock, or None where no rate is known."""
    from fingerpad.image import frame_clock, read_frame_stamps

    aligned = {"--fps": fps, "--start-s": start_s, "--contact-load": contact_load}
    idle = [flag for flag, value in aligned.items() if value is not None]
    if times is not None:
        if idle:
            raise LoadingError(f"--times gives each frame its time: there is no use for {idle[0]} beside it")
        return read_frame_stamps(times)
    rate = played if fps is None else fps
    if rate is None:
        if signal is not None:
            raise LoadingError("--force needs the times of the frames: give --fps or --times")
        return None
    return frame_clock(rate, signal, start_time=start_s, contact_load=contact_load)
