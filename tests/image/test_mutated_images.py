"""Damaged copies of every format: read or refused by name, never a traceback."""

import io
import random
import struct
import tempfile
import zlib
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest
import tifffile
from PIL import Image

from fingerpad.exceptions import FingerpadError
from fingerpad.image import (
    Frame,
    Scale,
    measure_contact_image,
    measure_photograph,
    measure_sequence,
    open_frames,
    read_image,
)
from fingerpad.simulate import render_contact_image, render_finger

SCALE = Scale(0.1)
_ODD_NUMBERS = (0, 1, 2, 3, 7, 255, 256, 32767, 65535, 10**5, 10**7, 2**31 - 1, 2**31, 2**32 - 1)


NAMES = (
    *("a.png", "a.jpg", "a.bmp", "a.pgm", "lzw.tif", "deep.png", "face.jpg"),
    *("jpeg.tif", "fax.tif", "palette.png", "tiled.tif", "planes.tif", "stack.tif", "video.avi", "video.mp4"),
)


@cache
def originals() -> dict[str, bytes]:
    """Return whole files by name: every format, and every kind of TIFF."""
    grey = render_contact_image(semi_major=6.0, semi_minor=5.0, ppi=254.0, seed=1).pixels
    deep = grey.astype(np.uint16) * 257
    face = render_finger("palmar", semi_axes=(8.0, 9.0), mm_per_px=0.1, seed=1).pixels
    found: dict[str, bytes] = {}
    for name in NAMES[:7]:
        pixels = np.asarray({"face": face[..., ::-1], "deep": deep}.get(name.split(".", maxsplit=1)[0], grey))
        found[name] = cv2.imencode(Path(name).suffix, pixels)[1].tobytes()
    found["jpeg.tif"] = _saved(Image.fromarray(face), "TIFF", compression="jpeg")
    found["fax.tif"] = _saved(Image.fromarray(grey > 128), "TIFF", compression="group4")
    found["palette.png"] = _saved(Image.fromarray(face).convert("P"), "PNG")
    for name, array, options in (
        ("tiled.tif", grey, {"tile": (64, 64), "compression": "zlib"}),
        ("planes.tif", np.moveaxis(face, 2, 0), {"photometric": "rgb", "planarconfig": "separate"}),
        ("stack.tif", np.stack([grey] * 4), {"photometric": "minisblack", "compression": "zlib"}),
    ):
        file = io.BytesIO()
        tifffile.imwrite(file, array, **options)
        found[name] = file.getvalue()
    for name, codec in (("video.avi", "MJPG"), ("video.mp4", "mp4v")):
        found[name] = _video(grey, name, codec)
    return found


def _saved(image: Image.Image, form: str, **options: object) -> bytes:
    file = io.BytesIO()
    image.save(file, form, **options)
    return file.getvalue()


def _video(grey: np.ndarray[tuple[int, ...], np.dtype[np.uint8]], name: str, codec: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        fourcc = int(cv2.VideoWriter.fourcc(*codec))
        writer = cv2.VideoWriter(str(path), fourcc, 50.0, (grey.shape[1], grey.shape[0]))
        for _ in range(5):
            writer.write(cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR))
        writer.release()
        return path.read_bytes()


def mutated(content: bytes, rng: random.Random) -> bytes:
    """Return a copy with bytes changed, cut, doubled or put in, mostly near its start, where headers are."""
    data = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 4, 16))):
        place = rng.randrange(min(len(data), 400) if rng.random() < 0.6 else len(data))
        kind = rng.randrange(7)
        if kind == 0:
            data[place] = rng.randrange(256)
        elif kind == 1:
            data[place] ^= 1 << rng.randrange(8)
        elif kind == 2:
            order = rng.choice("<>") + rng.choice("HI")
            size = struct.calcsize(order)
            data[place : place + size] = struct.pack(order, rng.choice(_ODD_NUMBERS) % 256**size)
        elif kind == 3:
            del data[place : place + rng.choice((1, 4, 100, 10_000))]
        elif kind == 4:
            data[place:place] = data[place : place + rng.choice((1, 12, 200))]
        elif kind == 5:
            data[place:place] = rng.randbytes(rng.choice((1, 4, 64)))
        else:
            del data[max(place, 1) :]
        if not data:
            break
    return bytes(data)


def use(path: Path, *, as_photograph: bool) -> list[str]:
    """Read a file by every reader and measure what can be read; return "read" or "refused" for each.

    A photograph takes a hundred times as long as a contact image, and is measured if asked for. Errors that
    are not fingerpad's own come through.
    """
    steps = (_use_grey, _use_colour, _use_frames) if as_photograph else (_use_grey, _use_frames)
    return [_outcome(step, path) for step in steps]


def _outcome(step: Callable[[Path], object], path: Path) -> str:
    try:
        step(path)
    except FingerpadError as error:
        if path.name not in str(error):
            raise AssertionError(f"the message does not name the file: {error}") from error
        return "refused"
    return "read"


def _measured(measure: Callable[[], object]) -> None:
    """Measure a picture that could be read, whether it shows a finger or not."""
    with suppress(FingerpadError):
        measure()


def _use_grey(path: Path) -> None:
    pixels = read_image(path).pixels
    _measured(lambda: measure_contact_image(pixels, SCALE))


def _use_colour(path: Path) -> None:
    pixels = read_image(path, colour=True).pixels
    _measured(lambda: measure_photograph(pixels, "palmar", SCALE))


def _use_frames(path: Path) -> None:
    frames: list[Frame] = []
    for frame in open_frames(path):
        frames.append(frame)
        if len(frames) == 6:
            break
    _measured(lambda: list(measure_sequence(frames, SCALE)))


@pytest.mark.parametrize("name", NAMES)
def test_intact_files_are_read(tmp_path, name):
    (tmp_path / name).write_bytes(originals()[name])
    sequence = name in {"video.avi", "video.mp4", "stack.tif"}
    frames = "read" if sequence or name.endswith(".tif") else "refused"
    assert use(tmp_path / name, as_photograph=False) == ["refused" if sequence else "read", frames]


@pytest.mark.parametrize("name", NAMES)
def test_damaged_files_read_or_refused(tmp_path, name):
    rng = random.Random(zlib.crc32(name.encode()))
    for number in range(10):
        (tmp_path / name).write_bytes(mutated(originals()[name], rng))
        assert set(use(tmp_path / name, as_photograph=number == 0)) <= {"read", "refused"}
